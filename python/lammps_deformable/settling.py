"""Rest at a pressure by damped motion: for contacts that rub, which minimizers pass over."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ._checks import count, expect, positive
from .box import refuse_space
from .errors import ParameterError, StalledWarning
from .lammps import gather, rub_and_spin, run
from .motion import advance, dynamics_of, moving
from .progress import progress
from .simulation import Simulation

if TYPE_CHECKING:
    from .state import State

# d(ln L)/dt = gain (P - p) of both sides L, with P the pressure of states.
_BOX = """
fix deformable_box all deform/pressure 1 box pressure {pressure!r} {gain!r} remap x
fix_modify deformable_box press deformable_virial
"""

# Rate at which velocities decay over sqrt(p/m), and the part of the pressure that this drag bears
# at most: where the box closes in, it pushes N particles together by N m rate drag/8 per area.
_DRAG, _BORNE = 2.0, 0.02

# Part of the longest stable time step: nothing needs to be accurate on the way to rest.
_OF_LONGEST = 0.5

# Time steps between looks at the forces.
_LOOK = 2000


def settle(
    sim: Simulation,
    pressure: float,
    tolerance: float = 1e-4,
    inertial_number: float = 1e-3,
    steps: int = 4_000_000,
    timestep: float | None = None,
) -> State:
    """Let particles of mass 1 come to rest at a pressure p, by damped motion in a box that follows.

    The box keeps its shape; the rate of its sides L is proportional to what is missing in the
    pressure P of the contacts,

        d(ln L)/dt = - I sqrt(p/m) (1 - P/p),

    so that a loose packing is compressed at the inertial number I = |d(ln L)/dt| sqrt(m/p), and no
    faster later. Velocities and spins decay at the rate min(2, 0.16/(I N)) sqrt(p/m), or faster
    where contacts damp. Contacts that rub, by the `friction` of the simulation, make a packing
    depend on its way: from a loose start it jams where this compression first bears the pressure.
    Further calls at higher or lower pressures go on from there, springs of contacts included.

    Args:
        sim: of the law `Ring`, without walls; e.g. at the packing fraction 0.7 after `push_off`. It
            ends in the state that is returned.
        pressure: p, of the state [energy/length^2].
        tolerance: largest force on a particle, and largest torque on it over its radius, over the
            mean contact force; and the largest relative error of the pressure.
        inertial_number: I; the smaller, the slower is the compression. Packings of 64 at 0.01 were
            those at 0.002 within errors, see validation/frictional_jamming.
        steps: number of time steps at most.
        timestep: length of a step; if not given half of the longest stable one of contacts that
            bear the pressure [time].

    Returns:
        The state at rest; its `stalled` is true if it did not come to rest.

    Raises:
        ParameterError: a value is out of range, there are walls, the law is `Sector`, or a `move`
            of this simulation has not ended.
        LammpsError: see `move`.

    Warns:
        StalledWarning: it did not come to rest in these steps.

    Source: two-dimensional packings that rub by damped motion at a pressure: Somfai et al., Phys.
    Rev. E 75, 020301 (2007); inertial number: GDR MiDi, Eur. Phys. J. E 14, 341 (2004).
    """
    expect("sim", sim, Simulation)
    refuse_space("settle", sim.dimension, "take relax(pressure=), or move(friction=)")
    if sim.walls:
        raise ParameterError(
            f"walls do not follow a box that settles, and there are {len(sim.walls)}, the first a "
            f"{sim.walls[0].kind}: move(friction=) comes to rest between walls"
        )
    pressure = positive("pressure", pressure)
    positive("tolerance", tolerance)
    inertial_number = positive("inertial_number", inertial_number)
    steps = count("steps", steps)
    rate = math.sqrt(pressure)
    drag = rate * min(_DRAG, 8.0 * _BORNE / (inertial_number * sim.lmp.get_natoms()))
    dynamics = dynamics_of(sim, None, drag, True, timestep, None)
    # a loose packing does not tell how stiff contacts become
    contact = 2.0 * pressure * float(sim.state().packing.radii.max())
    dynamics = replace(dynamics, drive=contact)
    box = _BOX.format(pressure=pressure, gain=inertial_number / rate).strip()
    state, at_rest = sim.state(), False
    with (
        moving(sim, dynamics, seed=1),
        progress("settling", unit="step", total=steps) as bar,
    ):
        run(sim.lmp, box)
        try:
            for done in range(0, steps, _LOOK):
                longest = dynamics.longest_step(state)
                if sim.friction:
                    longest = min(longest, sim.friction.longest_step)
                dt = dynamics.timestep or _OF_LONGEST * longest
                dynamics.check(state, dt)
                if dt > longest:
                    raise ParameterError(
                        f"timestep = {dt:g} is too long for contacts at the pressure {pressure:g}: "
                        f"take at most {longest:.2g}, or leave it out"
                    )
                advance(sim, dynamics, min(_LOOK, steps - done), dt)
                state = sim.state()
                error = max(abs(state.pressure / pressure - 1.0), _residual(sim, state))
                bar.set_postfix(phi=f"{state.phi:.4f}", error=f"{error:.1e}")
                bar.update(_LOOK)
                if at_rest := error <= tolerance:
                    break
        finally:
            if not sim.closed:
                run(sim.lmp, "unfix deformable_box")
    if not at_rest:
        warnings.warn(
            f"the particles did not come to rest at the pressure {pressure:g} in {steps} steps: "
            f"forces, torques or the pressure are off by {error:.2g}, not {tolerance:g}; call "
            "again to go on",
            StalledWarning,
            stacklevel=2,
        )
    return replace(state, stalled=not at_rest)


def _residual(sim: Simulation, state: State) -> float:
    """Largest force, or torque over the radius, over the mean contact force."""
    if not state.contacts.any():
        return math.inf
    force = np.linalg.norm(gather(sim.lmp, "f", 3), axis=1)
    largest = float(force.max())
    if rub_and_spin(sim.lmp):
        torque = gather(sim.lmp, "torque", 3)[:, 2] / state.packing.radii
        largest = max(largest, float(np.abs(torque).max()))
    return largest / float(state.contact_table["force"].mean())
