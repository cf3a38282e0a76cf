"""The size of the box at which a relaxed packing has a given packing fraction or pressure."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..common.errors import LammpsError, ParameterError, UnjammedWarning
from ..model.filled import root
from ..model.onset import excess_phi, natural_pressure
from ..model.packing import Packing

# A target is reached when the value differs by at most this part.
REACHED = {"phi": 1e-9, "pressure": 1e-6}

# Relaxations of one search, of which some four to eight are needed; those near the target that may
# stall in a row.
_RELAXATIONS, STALLS = 100, 5
STALLED = f"{STALLS} relaxations in a row stalled: take a larger tolerance, or a strain"

# Step of packing fraction at most: longer ones may lead to overlaps that no outlines have.
_LONGEST = 0.02

# The slope that two points tell counts between these: a packing that rearranges tells any.
_FLATTEST, _STEEPEST = 0.1, 10.0


class UnreachedError(ParameterError):
    """A target for which no box was found."""


class Relaxed(Protocol):
    """A relaxed state."""

    @property
    def packing(self) -> Packing: ...
    @property
    def stalled(self) -> bool: ...
    @property
    def phi(self) -> float: ...
    @property
    def pressure(self) -> float: ...
    @property
    def coordination(self) -> float: ...


class Scalable(Protocol):
    """A simulation whose box can be changed."""

    @property
    def box(self) -> NDArray[np.float64]: ...
    def deform(self, box: NDArray[np.float64]) -> None: ...


S = TypeVar("S", bound=Relaxed)


def reach(sim: Scalable, name: str, target: float, relax: Callable[[], S]) -> S:
    """Scale box, walls and centers until the relaxed state has this phi or pressure.

    The secant method on y(c), where c is the packing fraction of the undeformed particles and y is
    phi itself, or for a pressure phi - phi_J as `excess_phi` has it: dy/dc is near 1 from the
    start. A step is at most 0.02 long, and a step back half as long as the one before, so that a
    packing that rearranges does not lead to and fro. Nothing but the packing counts: a search that
    begins at the same one gives the same.

    Args:
        sim: ends in the state that is returned.
        name: `phi` or `pressure`.
        target: of the state, above 0.
        relax: relaxes `sim` in its box.

    Raises:
        ParameterError: it cannot be reached; the message has what was.
    """
    state = relax()
    y, slope, last, stalls = _ordinate(name, getattr(state, name), state), 1.0, 0.0, 0
    goal = _ordinate(name, target, state)
    for _ in range(_RELAXATIONS):
        found = getattr(state, name)
        if abs(found - target) <= REACHED[name] * target:
            return state
        stalls = stalls + 1 if state.stalled and abs(last) < _LONGEST else 0
        if stalls == STALLS:
            raise _unreached(name, target, state, STALLED)
        change = (goal - y) / slope
        if name == "pressure" and found <= 0.0:
            change = max(goal, 2.0 * last)  # nothing tells how far the onset is
        longest = min(_LONGEST, abs(last) / 2.0 if change * last < 0.0 else np.inf)
        change = float(np.clip(change, -longest, longest))
        phi = state.packing.phi
        try:
            sim.deform(sim.box * root(phi / (phi + change), state.packing.dimension))
            state = relax()
        except LammpsError as error:
            raise _unreached(name, target, state, str(error)) from None
        before, y, last = y, _ordinate(name, getattr(state, name), state), change
        if before > 0.0 and (y - before) * change > 0.0:
            slope = float(np.clip((y - before) / change, _FLATTEST, _STEEPEST))
    raise _unreached(name, target, state, f"{_RELAXATIONS} relaxations were not enough")


def _ordinate(name: str, value: float, state: Any) -> float:
    """y of this value."""
    if name == "phi":
        return value
    packing, law = state.packing, state.law
    return excess_phi(value / natural_pressure(packing, law), packing, law)


def _unreached(name: str, target: float, state: Relaxed, why: str) -> UnreachedError:
    return UnreachedError(
        f"{name} = {target:.10g} was not reached, but {getattr(state, name):.10g} at phi = "
        f"{state.phi:.6f}: {why}"
    )


def told_at_the_end(
    search: Callable[[Callable[[], S]], S], relax: Callable[[], S], stacklevel: int
) -> S:
    """Search with many relaxations, and give the warnings of the last one alone.

    That a packing has lost its rigidity on the way is told if the last state is loose.
    """
    told: list[warnings.WarningMessage] = []

    def quiet() -> S:
        nonlocal told
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            state = relax()
        told = [each for each in told if each.category is UnjammedWarning] + caught
        return state

    state = search(quiet)
    for each in told:
        if each.category is not UnjammedWarning or not state.coordination:
            warnings.warn(each.message, stacklevel=stacklevel)
    return state
