"""Quasistatic compression: shrink the box a little, relax, again."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError, UnjammedWarning
from ..common.progress import progress
from ..common.ranks import world
from ..common.steps import Steps
from ..common.validate import count, expect, finite
from ..engine.disks import Disks
from ..engine.polygon_simulation import PolygonSimulation
from ..engine.simulation import Simulation


class Snapshot(Protocol):
    """A state whose numbers are shown, and that may have come apart."""

    @property
    def phi(self) -> float: ...
    @property
    def pressure(self) -> float: ...
    @property
    def coordination(self) -> float: ...


S = TypeVar("S", bound=Snapshot)
S_co = TypeVar("S_co", bound=Snapshot, covariant=True)


class Compressible(Protocol[S_co]):
    """A simulation in a periodic box: `Simulation`, `Disks` or `PolygonSimulation`."""

    @property
    def box(self) -> NDArray[np.float64]: ...
    def deform(self, box: NDArray[np.float64]) -> None: ...
    def relax(self, tolerance: float = ...) -> S_co: ...


def compress(
    sim: Compressible[S], strain: float, steps: int, tolerance: float | None = None
) -> Iterator[S]:
    """Compress isotropically in equal steps, relaxing after each one.

    After step n the box lengths are those at the call times 1 - strain n / steps. Walls are scaled
    with the box.

    Args:
        sim: a `Simulation`, `Disks` or a `PolygonSimulation`; it ends in the last state.
        strain: total linear strain, not 0, below 1; negative expands.
        steps: number of steps.
        tolerance: of each relaxation; by default that of `sim.relax`.

    Yields:
        The relaxed state after each step. A step is done when its state is asked for.

    Raises:
        ParameterError: a value is out of range.

    Warns:
        UnjammedWarning: an expansion has taken the packing apart; once, after the first such step.
    """
    expect("sim", sim, Simulation, Disks, PolygonSimulation)
    check_strain_and_steps(strain, steps)
    return Steps("compress", remaining_steps(sim, sim.box, strain, int(steps), 0, tolerance))


def check_strain_and_steps(strain: float, steps: int) -> None:
    """Refuse a strain or a number of steps that `compress` cannot take."""
    if not -1.0 < finite("strain", strain) < 1.0:
        raise ParameterError(f"strain must lie between -1 and 1 (1 % is 0.01), not {strain}")
    if strain == 0.0:
        raise ParameterError("strain must not be 0: relax the simulation instead")
    count("steps", steps)


def remaining_steps(
    sim: Compressible[S],
    box: NDArray[np.float64],
    strain: float,
    steps: int,
    done: int,
    tolerance: float | None,
) -> Iterator[S]:
    """The remaining steps of a compression that started at this box, after the steps done."""
    apart = strain > 0.0  # then `relax` warns if a packing becomes loose
    with progress("compressing", unit="step", total=steps, initial=done) as bar:
        for n in range(done + 1, steps + 1):
            sim.deform(box * (1.0 - strain * n / steps))
            state = sim.relax() if tolerance is None else sim.relax(tolerance)
            bar.set_postfix(phi=f"{state.phi:.4f}", pressure=f"{state.pressure:.3g}")
            bar.update()
            if not (apart or state.coordination):
                apart = True
                if world().rank == 0:
                    warnings.warn(
                        f"the packing has come apart at step {n}, phi = {state.phi:.5f}: from here "
                        "on no contacts hold it, and its numbers are those of loose particles",
                        UnjammedWarning,
                        stacklevel=3,
                    )
            yield state
