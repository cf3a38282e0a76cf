"""Quasistatic compression, and growth of the particles: a small change, relax, again.

`Simulation.compress` scales the box, walls and centers, `Simulation.grow` the radii.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..common.checks import count, expect, finite, positive
from ..common.errors import ParameterError, UnjammedWarning, warn
from ..common.ranks import world
from ..engine.free_box import UnreachedError, check_free, is_reached, reach, told_at_the_end
from ..particles.laws import Droplet, Ring, Sector, SoftContact
from .protocol import Protocol, check_tolerance

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from ..engine.simulation import Simulation
    from ..particles.walls import Wall
    from ..state.state import State


def check_fraction(law: object, target: float) -> None:
    """Refuse a phi that no packing has.

    Raises:
        ParameterError: it is not above 0, or is 1 or more.
    """
    if positive("phi", target) >= 1.0 and not isinstance(law, SoftContact):
        raise ParameterError(
            f"phi must be below 1, where particles that deform fill the whole box, not {target}"
        )


def _one_of(targets: Mapping[str, float | None]) -> tuple[str, float]:
    given = {name: value for name, value in targets.items() if value is not None}
    if len(given) != 1:
        raise ParameterError(
            f"give one of {', '.join(targets)}, not {' and '.join(given) or 'none of them'}"
        )
    return given.popitem()


def _relaxing(sim: Simulation, tolerance: float | None) -> Callable[..., State]:
    """Relaxes the simulation, whose tolerance is its own if none is given."""
    return sim.relax if tolerance is None else partial(sim.relax, tolerance)


def _begun(
    sim: Simulation, name: str, target: float, steps: int, tolerance: float | None
) -> tuple[State, dict[str, Any]]:
    """The present state, or the relaxed one where a phi or a pressure is to be reached."""
    start = {"box": sim.box.tolist(), "strain": sim.shear_strain, "states": steps}
    if name in ("strain", "factor"):
        return sim.state(), start
    state = _relaxing(sim, tolerance)()
    if is_reached(name, target, state):
        start["states"] = 0
    return state, start | {name: getattr(state, name)}


@dataclass(frozen=True, kw_only=True)
class Compress(Protocol):
    """See `Simulation.compress`."""

    strain: float | None = None
    phi: float | None = None
    pressure: float | None = None
    tolerance: float | None = None

    @property
    def _target(self) -> tuple[str, float]:
        """The one target that is given, and its name."""
        return _one_of({"strain": self.strain, "phi": self.phi, "pressure": self.pressure})

    def check_for(self, law: object, walls: tuple[Wall, ...], recorded: bool) -> Compress:
        """The protocol for particles of a law between walls, before there is a simulation.

        Raises:
            ParameterError: none or several targets are given, or one that no packing has.
        """
        count("steps", self.steps)
        name, target = self._target
        if name == "strain":
            if not -1.0 < finite("strain", target) < 1.0:
                raise ParameterError(
                    f"strain must lie between -1 and 1 (1 % is 0.01), not {target}"
                )
            if target == 0.0:
                raise ParameterError("strain must not be 0: relax the simulation instead")
        elif name == "pressure":
            check_free("iso", walls, target, law)
        else:
            check_fraction(law, target)
        settings: dict[str, Any] = {name: float(target)}
        return replace(self, **settings, tolerance=check_tolerance(self.tolerance, recorded))

    def check(self, sim: Simulation, recorded: bool) -> Compress:
        return self.check_for(sim.law, sim.walls, recorded)

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        return _begun(sim, *self._target, self.steps, self.tolerance)

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        (name, target), steps = self._target, self.steps
        relax = _relaxing(sim, self.tolerance)
        if name == "strain":
            box = np.array(start["box"])

            def step(n: int) -> State:
                sim.deform(box * (1.0 - target * n / steps))
                return relax()

            return _told_if_apart(sim, step, steps, done, before, expands=target < 0.0)

        def reached(goal: float) -> State:
            if name == "pressure":
                return relax(pressure=goal)
            return told_at_the_end(lambda each: reach(sim, name, goal, each), relax)

        return _towards(sim, name, target, steps, start, done, before, reached)


def _towards(
    sim: Simulation,
    name: str,
    target: float,
    steps: int,
    start: Mapping[str, Any],
    done: int,
    before: State | None,
    reached: Callable[[float], State],
) -> Iterator[State]:
    """The states at equal steps from the value of the start to the target."""
    begin = max(start[name], 0.0)

    def step(n: int) -> State:
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
    sim: Simulation,
    step: Callable[[int], State],
    steps: int,
    done: int,
    before: State | None,
    expands: bool,
) -> Iterator[State]:
    """The states after the steps that remain; a warning where an expansion has parted them."""
    if expands and before is None:
        before = sim.state()
    for n in range(done + 1, steps + 1):
        state = step(n)
        # `relax` itself warns of a packing that becomes loose in a compression
        if (
            expands
            and before
            and before.coordination
            and not state.coordination
            and world().rank == 0
        ):
            warn(
                f"the packing has come apart at step {n}, phi = {state.phi:.5f}: from here "
                "on no contacts hold it, and its numbers are those of loose particles",
                UnjammedWarning,
            )
        before = state
        yield state


@dataclass(frozen=True, kw_only=True)
class Grow(Protocol):
    """See `Simulation.grow`."""

    factor: float | None = None
    phi: float | None = None
    tolerance: float | None = None

    @property
    def _target(self) -> tuple[str, float]:
        return _one_of({"factor": self.factor, "phi": self.phi})

    def check(self, sim: Simulation, recorded: bool) -> Grow:
        expect("the law of a simulation that grows", sim.law, Ring, Sector, Droplet)
        name, target = self._target
        if name == "phi":
            check_fraction(sim.law, target)
        elif positive("factor", target) == 1.0:
            raise ParameterError("factor must not be 1: relax the simulation instead")
        count("steps", self.steps)
        settings: dict[str, Any] = {name: float(target)}
        return replace(self, **settings, tolerance=check_tolerance(self.tolerance, recorded))

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        return _begun(sim, *self._target, self.steps, self.tolerance)

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        (name, target), steps = self._target, self.steps
        relax = _relaxing(sim, self.tolerance)
        if name == "factor":

            def step(_: int) -> State:
                scale_radii(sim, target ** (1.0 / steps))
                return relax()

            return _told_if_apart(sim, step, steps, done, before, expands=target < 1.0)
        # in a box of the size 1 / factor of the radii
        growing: Any = SimpleNamespace(box=1.0, deform=lambda size: scale_radii(sim, 1.0 / size))

        def reached(goal: float) -> State:
            return told_at_the_end(lambda each: reach(growing, name, goal, each), relax)

        return _towards(sim, name, target, steps, start, done, before, reached)


def scale_radii(sim: Simulation, factor: float) -> None:
    """Multiply the radii of all particles, which stay where they are."""
    state = sim.state()
    grown = state.packing.replace(radii=state.packing.radii * factor)
    sim.reset(replace(state, packing=grown))
