"""Simple shear: quasistatic, tilt the box a little, relax, again; or at a rate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.progress import progress
from ..common.steps import Steps
from ..common.validate import count, expect, finite, positive
from ..engine.disks import Disks
from ..engine.droplet_simulation import DropletSimulation
from ..engine.simulation import Simulation
from ..engine.spheres import Spheres
from ..model.walls import Wall
from ..state.disk_state import DiskState
from ..state.droplet_state import DropletState
from ..state.sphere_state import SphereState
from ..state.state import State
from .flow import flow, flow_command, flow_dynamics, leans, refuse_without_flow
from .tilt import sheared, straighten

S = TypeVar("S", bound=State | DiskState | SphereState | DropletState)
S_co = TypeVar("S_co", bound=State | DiskState | SphereState | DropletState, covariant=True)


class Shearable(Protocol[S_co]):
    """A simulation in a periodic box: `Simulation`, `Disks` or `Spheres`."""

    @property
    def lmp(self) -> Any: ...
    @property
    def box(self) -> NDArray[np.float64]: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...

    strain: float | None

    def deform(self, box: NDArray[np.float64]) -> None: ...
    def relax(self, tolerance: float = ...) -> S_co: ...
    def state(self) -> S_co: ...


def shear(
    sim: Shearable[S],
    strain: float,
    steps: int = 10,
    tolerance: float | None = None,
    rate: float | None = None,
    friction: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> Iterator[S]:
    """Shear in equal steps, relaxing after each one, or at a rate; the size of the box stays.

    After step n the upper side of the box has moved along x by strain n / steps times its height.
    A state has the `shear_stress` that resists, and the `strain` of all calls of `shear` for one
    simulation. A box whose tilt exceeds half its width is replaced by the
    equivalent box with the smallest tilt, so that strains may be large.

    With a rate particles are overdamped, with a friction against the mean flow u = rate y along x,

        friction (dr/dt - u) = F + sqrt(2 friction temperature) noise

    as bubbles in Durian's model. LAMMPS' *fix deform* with *remap x* moves the box and the
    particles in it, *fix brownian* adds the rest. Velocities are 0 in all states.

    Args:
        sim: a `Simulation`, `Disks` or `Spheres`; it ends in the last state.
        strain: total shear strain gamma; negative shears in the other direction.
        steps: number of steps, of which each yields a state.
        tolerance: of each relaxation; by default that of `sim.relax`.
        rate: strain per time, above 0 [1/time]; if not given, the shear is quasistatic. The law of
            flows is `Ring` or `Droplet`, and the next arguments belong to them.
        friction: force over velocity relative to the mean flow [1/time], as masses are 1.
        temperature: of the noise [energy]; without, there is none.
        timestep: length of a time step [time]; if not given it follows from the contacts, as in
            `move`, and is at most 5e-4/rate.
        seed: of the noise, as in `move`.

    Yields:
        The state after each step, with its `strain`; without a rate it is relaxed, with a rate it
        has a `time`.

    Raises:
        ParameterError: a value is out of range, or the simulation has walls; or see `move`.
        LammpsError: see `move`.

    Source: drag: Durian, Phys. Rev. Lett. 75, 4780 (1995).
    """
    expect("sim", sim, Simulation, DropletSimulation, Disks, Spheres)
    check_shear(sim, strain, steps)
    before, strain, steps = sim.strain or 0.0, float(strain), int(steps)
    flowing = {"friction": friction, "temperature": temperature, "timestep": timestep}
    states: Iterator[S]
    if rate is None:
        refuse_without_flow("rate", **flowing, seed=seed)
        states = shear_steps(sim, before, strain, steps, 0, tolerance)
    else:
        rate = positive("rate", rate)
        flows, dynamics = flow_dynamics(sim, **flowing, tolerance=tolerance, seed=seed)
        along = math.copysign(rate, strain)
        yz = leans(flows)
        course = flow_command(f"erate {along!r}", f"vel {along * yz!r}" if yz else "")
        strains = [before + n * strain / steps for n in range(1, steps + 1)]
        duration = abs(strain) / rate / steps
        flowed = flow(flows, dynamics, rate, duration, strains, lambda _: course, seed)
        states = cast(Iterator[S], flowed)
    return Steps("shear", states, lambda: replace(sim.state(), strain=before))


def check_shear(sim: Shearable[Any], strain: float, steps: int) -> None:
    """Refuse what `shear` cannot do."""
    count("steps", steps)
    if finite("strain", strain) == 0.0:
        raise ParameterError("strain must not be 0: relax the simulation instead")
    refuse_walls(sim)


def refuse_walls(sim: Shearable[Any]) -> None:
    """Refuse walls, which do not follow a shear.

    Raises:
        ParameterError: there are some.
    """
    if sim.walls:
        raise ParameterError(
            f"walls are not sheared, and this simulation has {len(sim.walls)}, the first a "
            f"{sim.walls[0].kind}: shear needs a periodic box without walls"
        )


def shear_steps(
    sim: Shearable[S],
    before: float,
    strain: float,
    steps: int,
    done: int,
    tolerance: float | None,
) -> Iterator[S]:
    """The remaining steps of a shear, after the steps done and the strain before the first one."""
    with progress("shearing", unit="step", total=steps, initial=done) as bar:
        for n in range(done + 1, steps + 1):
            state = sheared_state(sim, strain / steps, before + strain * n / steps, tolerance)
            bar.set_postfix(stress=f"{state.shear_stress:.3g}")
            bar.update()
            yield state


def sheared_state(sim: Shearable[S], by: float, strain: float, tolerance: float | None) -> S:
    """The relaxed state after a further strain, which leads to this one in all."""
    straighten(sim)
    sim.deform(sheared(sim.box, by))
    sim.strain = strain
    return sim.relax() if tolerance is None else sim.relax(tolerance)
