"""Flow at a rate: LAMMPS shears the box, and friction holds particles to the mean flow."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from ..common.errors import ParameterError
from ..common.progress import progress
from ..common.validate import count
from ..engine.close_balance import balanced_to, imbalance_under
from ..engine.deforming import Deforming, S
from ..engine.droplet_simulation import DropletSimulation
from ..engine.lammps import run
from ..engine.simulation import Simulation
from .dynamics import Dynamics, advance, dynamics_of, moving, refuse_restarted, seeds
from .tilt import straighten, straightened

# Strain of a time step at most, as forces follow the box with a delay of one step; and strain after
# which the time step is chosen anew.
_OF_A_STEP, _OF_A_PIECE = 5e-4, 0.02


def flow_dynamics(
    sim: object,
    friction: float | None,
    temperature: float | None,
    timestep: float | None,
    tolerance: float | None,
    seed: int | None,
) -> tuple[Deforming[Any], Dynamics]:
    """What flows, and overdamped motion relative to the mean flow.

    Raises:
        ParameterError: a value is out of range, the friction is missing, a tolerance is given, or
            these are `Disks` or `Spheres`.
    """
    if not isinstance(sim, (Simulation, DropletSimulation)):
        kind = type(sim).__name__
        raise ParameterError(f"{kind} are sheared without a rate only: take Simulation")
    if friction is None:
        raise ParameterError("a flow needs the friction of particles against it: give friction")
    if tolerance is not None:
        raise ParameterError("states of a flow are not relaxed: leave tolerance out")
    return sim, dynamics_of(sim, temperature, friction, False, timestep, seed)


def refuse_without_flow(name: str, **given: object) -> None:
    """Refuse what belongs to a flow, where the value of this name that makes one is missing.

    Raises:
        ParameterError: some of it is given.
    """
    for other, value in given.items():
        if value is not None:
            raise ParameterError(
                f"{other} has no meaning without a {name}, where each state is relaxed: give a "
                f"{name}, or leave it out"
            )


def flow(
    sim: Deforming[S],
    dynamics: Dynamics,
    rate: float,
    duration: float,
    strains: Sequence[float | None],
    course: Callable[[float], str],
    seed: int | None,
) -> Iterator[S]:
    """Shear the box, and yield the state after equal times.

    Args:
        sim: ends in the last state.
        dynamics: of the particles.
        rate: the largest one of the flow [1/time].
        duration: from a state to the next one [time].
        strains: of the states; None where the box tells it.
        course: commands for a run that begins so long after the first one, of which the last is a
            `flow_command`.
        seed: of the noise.
    """
    lmp, state = sim.lmp, sim.state()
    _, of_noise = seeds(sim, seed)
    with (
        balanced_to(sim, state.packing, imbalance_under(rate * duration)),
        moving(sim, dynamics, of_noise),
    ):
        drag = dynamics.friction * rate * 2.0 * float(state.packing.radius.max())
        limit = min(dynamics.limit, _OF_A_STEP / rate)
        dynamics = replace(dynamics, drive=drag, limit=limit)
        pieces = math.ceil(rate * duration / _OF_A_PIECE)
        with progress("shearing", unit="state", total=len(strains)) as bar:
            for n, strain in enumerate(strains):
                for k in range(pieces):
                    begin = duration * (n + k / pieces)
                    state = _piece(sim, dynamics, duration / pieces, course(begin), state)
                if strain is not None:
                    sim.strain = strain
                state = replace(state, strain=sim.strain)
                bar.set_postfix(stress=f"{state.shear_stress:.3g}")
                bar.update()
                yield state
                refuse_restarted(sim, lmp)


def flow_command(xy: str, xz: str = "") -> str:
    """*fix deform*, which shears the box with the particles in it.

    Args:
        xy: how the tilt changes.
        xz: how the other tilt along x does, by the part yz/ly of that, in a box that leans along y:
            without it the flow would have a gradient along z too.
    """
    return f"fix deformable_flow all deform 1 xy {xy} {xz and f'xz {xz} '}remap x"


def leans(sim: Any) -> float:
    """Tilt yz of the straightened box, which a shear along x leaves as it is; 0 in the plane."""
    return float(straightened(sim.box)[2, 1]) if sim.dimension == 3 else 0.0


def _piece(sim: Deforming[S], dynamics: Dynamics, duration: float, course: str, state: S) -> S:
    """The state after a flow with one time step, from the state before."""
    longest = dynamics.timestep or dynamics.default_step(state)
    steps = count("number of time steps to a state", math.ceil(duration / longest))
    dynamics.check(state, duration / steps)
    straighten(sim)
    tilt = float(sim.box[1, 0])
    run(sim.lmp, course)
    try:
        advance(sim, dynamics, steps, duration / steps)
    finally:
        run(sim.lmp, "unfix deformable_flow")
        sim.strain = (sim.strain or 0.0) + _strain_since(sim, tilt)
    return sim.state()


def _strain_since(sim: Deforming[S], tilt: float) -> float:
    """The smallest strain from a tilt of the box to that of now, as LAMMPS may have flipped it."""
    lx, xy, ly = sim.box[[0, 1, 1], [0, 0, 1]].tolist()
    widths = (xy - tilt) / lx
    return float(widths - round(widths)) * lx / ly
