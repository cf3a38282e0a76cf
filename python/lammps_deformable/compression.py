"""Quasistatic compression: shrink the box a little, relax, again."""

from __future__ import annotations

import warnings
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._checks import count, expect, finite, positive
from .errors import ParameterError, UnjammedWarning
from .free_box import UnreachedError, reach, told_at_the_end
from .laws import SoftContact
from .polygons import DeformablePolygon
from .progress import Steps, progress
from .ranks import world
from .simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from .state import State


def compress(
    sim: Simulation,
    strain: float | None = None,
    steps: int = 10,
    tolerance: float | None = None,
    phi: float | None = None,
    pressure: float | None = None,
) -> Iterator[State]:
    """Compress isotropically in equal steps, relaxing after each one.

    Give one of strain, phi and pressure. After step n of a strain the box lengths are those at the
    call times 1 - strain n / steps. With a phi or a pressure its value after step n lies n / steps
    of the way from that of the relaxed start to the target; a packing that is loose has none, and
    is compressed until it has. Such a step takes some four relaxations. Where the start has the
    target already, the packing stays as it is in all steps. Walls are scaled with the box.

    Args:
        sim: it ends in the last state.
        strain: total linear strain, not 0, below 1; negative expands.
        steps: number of steps.
        tolerance: of each relaxation; by default that of `sim.relax`.
        phi: packing fraction of the last state, `state.phi`, reached to 1e-9 of it; that of
            deformable particles is below 1.
        pressure: of the last state, reached to 1e-6 of it [energy/length^d]; not with polygons.

    Yields:
        The relaxed state after each step. A step is done when its state is asked for.

    Raises:
        ParameterError: a value is out of range, or a target cannot be reached, and the message has
            what was.

    Warns:
        UnjammedWarning: an expansion has taken the packing apart; once, after the first such step.
    """
    expect("sim", sim, Simulation)
    name, target = check_target(sim, steps, strain=strain, phi=phi, pressure=pressure)
    if name == "strain":
        states = remaining_steps(sim, sim.box, target, int(steps), 0, tolerance)
        return Steps("compress", states, sim.state)
    start = cache(lambda: sim.relax(**_given(tolerance)))
    return Steps("compress", _towards(sim, name, start, target, int(steps), tolerance), start)


def check_target(sim: Simulation | None, steps: int, **targets: float | None) -> tuple[str, float]:
    """The one target that is given, and its name.

    Args:
        sim: that is compressed; a `Simulation` if None.
        steps: number of steps.
        targets: by name; those that are not given are None.

    Raises:
        ParameterError: none or several are given, or one that no packing has.
    """
    count("steps", steps)
    given = {name: value for name, value in targets.items() if value is not None}
    if len(given) != 1:
        raise ParameterError(
            f"give one of {', '.join(targets)}, not {' and '.join(given) or 'none of them'}"
        )
    ((name, target),) = given.items()
    if name == "strain":
        check_strain_and_steps(target, steps)
        return name, float(target)
    law = sim.law if sim else None
    if name == "pressure" and isinstance(law, DeformablePolygon):
        raise ParameterError("polygons have no target pressure: give strain or phi")
    if positive(name, target) >= 1.0 and name == "phi" and not isinstance(law, SoftContact):
        raise ParameterError(
            f"phi must be below 1, where particles that deform fill the whole box, not {target}"
        )
    return name, float(target)


def check_strain_and_steps(strain: float, steps: int) -> None:
    """Refuse a strain or a number of steps that `compress` cannot take."""
    if not -1.0 < finite("strain", strain) < 1.0:
        raise ParameterError(f"strain must lie between -1 and 1 (1 % is 0.01), not {strain}")
    if strain == 0.0:
        raise ParameterError("strain must not be 0: relax the simulation instead")
    count("steps", steps)


def remaining_steps(
    sim: Simulation,
    box: NDArray[np.float64],
    strain: float,
    steps: int,
    done: int,
    tolerance: float | None,
) -> Iterator[State]:
    """The remaining steps of a compression that started at this box, after the steps done."""

    def step(n: int) -> State:
        sim.deform(box * (1.0 - strain * n / steps))
        return sim.relax(**_given(tolerance))

    return _stepped(step, steps, done, expands=strain < 0.0)


def _given(tolerance: float | None) -> dict[str, Any]:
    """Arguments of `relax`, which has a tolerance of its own."""
    return {} if tolerance is None else {"tolerance": tolerance}


def _towards(
    sim: Simulation,
    name: str,
    start: Callable[[], State],
    target: float,
    steps: int,
    tolerance: float | None,
) -> Iterator[State]:
    """The steps to a phi or pressure from that of the relaxed start."""
    begin = getattr(start(), name)
    yield from steps_towards(sim, name, begin, target, steps, 0, tolerance)


def steps_towards(
    sim: Simulation,
    name: str,
    start: float,
    target: float,
    steps: int,
    done: int,
    tolerance: float | None,
) -> Iterator[State]:
    """The remaining steps from a phi or pressure to a target, after the steps done."""
    start = max(start, 0.0)
    given = _given(tolerance)

    def reached(goal: float) -> State:
        if name == "pressure":
            return sim.relax(pressure=goal, **given)
        return told_at_the_end(
            lambda relax: reach(sim, name, goal, relax), lambda: sim.relax(**given), stacklevel=6
        )

    def step(n: int) -> State:
        if n == steps:
            return reached(target)
        try:
            return reached(start + (target - start) * n / steps)
        except UnreachedError as error:
            raise UnreachedError(
                f"{name} = {target:.10g} was not reached: in step {n} of {steps}, {error}"
            ) from None

    return _stepped(step, steps, done, expands=target < start)


def _stepped(step: Callable[[int], State], steps: int, done: int, expands: bool) -> Iterator[State]:
    """The states after the steps that remain."""
    apart = not expands  # then `relax` warns if a packing becomes loose
    with progress("compressing", unit="step", total=steps, initial=done) as bar:
        for n in range(done + 1, steps + 1):
            state = step(n)
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
