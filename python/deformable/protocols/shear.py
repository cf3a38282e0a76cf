"""Quasistatic simple shear: tilt the box a little, relax, again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.progress import progress
from ..common.steps import Steps
from ..common.validate import count, expect, finite
from ..engine.disks import Disks
from ..engine.lammps import run
from ..engine.simulation import Simulation
from ..state.disk_state import DiskState
from ..state.state import State

S = TypeVar("S", bound=State | DiskState)
S_co = TypeVar("S_co", bound=State | DiskState, covariant=True)


class Shearable(Protocol[S_co]):
    """A simulation in a periodic box: `Simulation` or `Disks`."""

    @property
    def lmp(self) -> Any: ...
    @property
    def box(self) -> NDArray[np.float64]: ...

    strain: float | None

    def deform(self, box: NDArray[np.float64]) -> None: ...
    def relax(self, tolerance: float = ...) -> S_co: ...


def shear(
    sim: Simulation | Disks, strain: float, steps: int, tolerance: float | None = None
) -> Iterator[State | DiskState]:
    """Shear in equal steps, relaxing after each one; the area of the box stays.

    After step n the upper side of the box has moved along x by strain n / steps times its height.
    The shear stress that resists is -stress[0, 1] of the state, whose `strain` counts all calls of
    `shear` for one simulation. A box whose tilt exceeds half its width is replaced by the
    equivalent box with the smallest tilt, so that strains may be large.

    Args:
        sim: a `Simulation` or `Disks`; it ends in the last state.
        strain: total shear strain gamma; negative shears in the other direction.
        steps: number of steps.
        tolerance: of each relaxation; by default that of `sim.relax`.

    Yields:
        The relaxed state after each step, with its `strain`.

    Raises:
        ParameterError: a value is out of range, or the simulation has walls.
    """
    expect("sim", sim, Simulation, Disks)
    check_shear(sim, strain, steps)
    before = sim.strain or 0.0
    states = shear_steps(sim, before, float(strain), int(steps), 0, tolerance)
    return Steps("shear", states, lambda: replace(sim.state(), strain=before))


def check_shear(sim: Simulation | Disks, strain: float, steps: int) -> None:
    """Refuse what `shear` cannot do."""
    count("steps", steps)
    if finite("strain", strain) == 0.0:
        raise ParameterError("strain must not be 0: relax the simulation instead")
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
            straighten(sim)
            sim.deform(sheared(sim.box, strain / steps))
            sim.strain = before + strain * n / steps
            state = sim.relax() if tolerance is None else sim.relax(tolerance)
            bar.set_postfix(stress=f"{-state.stress[0, 1]:.3g}")
            bar.update()
            yield state


def sheared(points: NDArray[np.float64], strain: float) -> NDArray[np.float64]:
    """Points, or the rows of a box, after simple shear along x, shape (n, 2) [length]."""
    x, y = points.T
    return np.column_stack([x + strain * y, y])


def straighten(sim: Shearable[Any]) -> None:
    """Replace the box by the equivalent one with the smallest tilt; the particles stay."""
    (lx, _), (xy, _) = sim.box.tolist()
    widths = round(xy / lx)
    if widths:
        run(sim.lmp, f"change_box all xy final {xy - widths * lx!r} units box")
