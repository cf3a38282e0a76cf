"""Quasistatic compression, and growth of the particles: a small change, relax, again.

`Simulation.compress` scales the box, walls and centers, `Simulation.grow` the radii.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..common.checks import count, expect, finite, positive
from ..common.errors import ParameterError, UnjammedWarning, warn
from ..common.ranks import world
from ..engine.free_box import REACHED, UnreachedError, reach, refuse_polygons, told_at_the_end
from ..particles.laws import Droplet, Ring, Sector, SoftContact
from .recording import Protocol, check_tolerance

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


def _compress_settings(sim: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    targets = {each: given[each] for each in ("strain", "phi", "pressure")}
    name, target = check_target(sim.law, given["steps"], **targets)
    return {name: target} | _steps(given)


def _steps(given: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of steps and relaxations."""
    recorded = given["record"] is not None
    return {
        "steps": count("steps", given["steps"]),
        "tolerance": check_tolerance(given["tolerance"], recorded),
    }


def check_target(law: object, steps: int, **targets: float | None) -> tuple[str, float]:
    """The one target that is given, and its name.

    Args:
        law: of the particles.
        steps: number of steps.
        targets: by name; those that are not given are None.

    Raises:
        ParameterError: none or several are given, or one that no packing has.
    """
    count("steps", steps)
    name, target = _one_of(targets)
    if name == "strain":
        if not -1.0 < finite("strain", target) < 1.0:
            raise ParameterError(f"strain must lie between -1 and 1 (1 % is 0.01), not {target}")
        if target == 0.0:
            raise ParameterError("strain must not be 0: relax the simulation instead")
        return name, float(target)
    if name == "pressure":
        refuse_polygons(law)
    if positive(name, target) >= 1.0 and name == "phi" and not isinstance(law, SoftContact):
        raise ParameterError(
            f"phi must be below 1, where particles that deform fill the whole box, not {target}"
        )
    return name, float(target)


def _one_of(targets: Mapping[str, float | None]) -> tuple[str, float]:
    given = {name: value for name, value in targets.items() if value is not None}
    if len(given) != 1:
        raise ParameterError(
            f"give one of {', '.join(targets)}, not {' and '.join(given) or 'none of them'}"
        )
    return given.popitem()


def _relaxing(sim: Any, settings: Mapping[str, Any]) -> Callable[..., Any]:
    """Relaxes the simulation, whose tolerance is its own if none is given."""
    tolerance = settings.get("tolerance")
    return sim.relax if tolerance is None else partial(sim.relax, tolerance)


def _target_of(settings: Mapping[str, Any]) -> tuple[str, float]:
    names = ("strain", "phi", "pressure", "factor")
    return next((name, settings[name]) for name in names if settings.get(name) is not None)


def _begin(sim: Any, settings: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The present state, or the relaxed one where a phi or a pressure is to be reached."""
    name, target = _target_of(settings)
    start = {"box": sim.box.tolist(), "strain": sim.shear_strain, "states": settings["steps"]}
    if name in ("strain", "factor"):
        return sim.state(), start
    state = _relaxing(sim, settings)()
    value = getattr(state, name)
    if abs(value - target) <= REACHED[name] * target:
        start["states"] = 0
    return state, start | {name: value}


def _compressed(
    sim: Any, settings: Mapping[str, Any], start: Mapping[str, Any], done: int, before: Any
) -> Iterator[Any]:
    (name, target), steps = _target_of(settings), settings["steps"]
    relax = _relaxing(sim, settings)
    if name == "strain":
        box = np.array(start["box"])

        def step(n: int) -> Any:
            sim.deform(box * (1.0 - target * n / steps))
            return relax()

        return _told_if_apart(sim, step, steps, done, before, expands=target < 0.0)

    def reached(goal: float) -> Any:
        if name == "pressure":
            return relax(pressure=goal)
        return told_at_the_end(lambda each: reach(sim, name, goal, each), relax)

    return _towards(sim, name, target, steps, start, done, before, reached)


def _towards(
    sim: Any,
    name: str,
    target: float,
    steps: int,
    start: Mapping[str, Any],
    done: int,
    before: Any,
    reached: Callable[[float], Any],
) -> Iterator[Any]:
    """The states at equal steps from the value of the start to the target."""
    begin = max(start[name], 0.0)

    def step(n: int) -> Any:
        if n == steps:
            return reached(target)
        try:
            return reached(begin + (target - begin) * n / steps)
        except UnreachedError as error:
            raise UnreachedError(
                f"{name} = {target:.10g} was not reached: in step {n} of {steps}, {error}"
            ) from None

    return _told_if_apart(sim, step, steps, done, before, expands=target < begin)


def _told_if_apart(
    sim: Any, step: Callable[[int], Any], steps: int, done: int, before: Any, expands: bool
) -> Iterator[Any]:
    """The states after the steps that remain; a warning where an expansion has parted them."""
    if expands and before is None:
        before = sim.state()
    for n in range(done + 1, steps + 1):
        state = step(n)
        # `relax` itself warns of a packing that becomes loose in a compression
        if expands and before.coordination and not state.coordination and world().rank == 0:
            warn(
                f"the packing has come apart at step {n}, phi = {state.phi:.5f}: from here "
                "on no contacts hold it, and its numbers are those of loose particles",
                UnjammedWarning,
            )
        before = state
        yield state


COMPRESS = Protocol(_compress_settings, _begin, _compressed)


def _grow_settings(sim: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    expect("the law of a simulation that grows", sim.law, Ring, Sector, Droplet)
    name, target = _one_of({each: given[each] for each in ("factor", "phi")})
    if name == "phi":
        check_target(sim.law, given["steps"], phi=target)
    elif positive("factor", target) == 1.0:
        raise ParameterError("factor must not be 1: relax the simulation instead")
    return {name: float(target)} | _steps(given)


def _grown(
    sim: Any, settings: Mapping[str, Any], start: Mapping[str, Any], done: int, before: Any
) -> Iterator[Any]:
    (name, target), steps = _target_of(settings), settings["steps"]
    relax = _relaxing(sim, settings)
    if name == "factor":

        def step(_: int) -> Any:
            scale_radii(sim, target ** (1.0 / steps))
            return relax()

        return _told_if_apart(sim, step, steps, done, before, expands=target < 1.0)
    # in a box of the size 1 / factor of the radii
    growing: Any = SimpleNamespace(box=1.0, deform=lambda size: scale_radii(sim, 1.0 / size))

    def reached(goal: float) -> Any:
        return told_at_the_end(lambda each: reach(growing, name, goal, each), relax)

    return _towards(sim, name, target, steps, start, done, before, reached)


def scale_radii(sim: Any, factor: float) -> None:
    """Multiply the radii of all particles, which stay where they are."""
    state = sim.state()
    grown = state.packing.replace(radii=state.packing.radii * factor)
    sim.reset(replace(state, packing=grown))


GROW = Protocol(_grow_settings, _begin, _grown)
