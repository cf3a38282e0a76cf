"""Quasistatic compression: shrink the box a little, relax, again."""

from __future__ import annotations

from collections.abc import Iterator

from .errors import ParameterError
from .progress import progress
from .simulation import Simulation
from .state import State


def compress(
    sim: Simulation, strain: float, steps: int, tolerance: float = 1e-6
) -> Iterator[State]:
    """Compress isotropically in equal steps, relaxing after each one.

    After step n each length of the box is 1 - strain n / steps of what it was at the call.

    Args:
        sim: the simulation; it ends in the last state.
        strain: linear strain in all, below 1; negative expands.
        steps: number of steps.
        tolerance: of each relaxation, see `Simulation.relax`.

    Yields:
        The relaxed state after each step.

    Raises:
        ParameterError: a value is out of range.
    """
    check_protocol(strain, steps)
    return _compress(sim, strain, steps, tolerance)


def check_protocol(strain: float, steps: int) -> None:
    """Refuse what `compress` cannot do."""
    if not -1.0 < strain < 1.0:
        raise ParameterError(f"strain must lie between -1 and 1, not {strain}")
    if steps < 1:
        raise ParameterError(f"steps must be at least 1, not {steps}")


def _compress(sim: Simulation, strain: float, steps: int, tolerance: float) -> Iterator[State]:
    box = sim.box
    with progress("compressing", unit="step", total=steps) as bar:
        for n in range(1, steps + 1):
            sim.deform(box * (1.0 - strain * n / steps))
            state = sim.relax(tolerance)
            bar.set_postfix(phi=f"{state.phi:.4f}", pressure=f"{state.pressure:.3g}")
            bar.update()
            yield state
