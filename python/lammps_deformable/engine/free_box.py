"""Boxes that follow: relaxation at a pressure, and the size of a box for a packing fraction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.checks import positive, shown
from ..common.errors import LammpsError, ParameterError, UnjammedWarning, collected, warn
from ..particles.laws import excess_phi, natural_pressure, root, sticks
from ..particles.polygons import DeformablePolygon
from ..particles.walls import kind_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..particles.friction import Friction
    from ..particles.walls import Wall
    from ..state.state import State
    from .simulation import Simulation

# A target is reached when the value differs by at most this part, the pressure 0 when it is this
# part of the natural one.
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


def reach(sim: Simulation, name: str, target: float, relax: Callable[[], State]) -> State:
    """Scale box, walls and centers until the relaxed state has this phi or pressure.

    The secant method on y(c), where c is the packing fraction of the undeformed particles and y is
    phi itself, or for a pressure phi - phi_J as `excess_phi` has it: dy/dc is near 1 from the
    start. A step is at most 0.02 long, and a step back half as long as the one before, so that a
    packing that rearranges does not lead to and fro. Nothing but the packing counts: a search that
    begins at the same one gives the same. Particles that stick have pressures of either sign and no
    onset: there y is the pressure over the natural one.

    Args:
        sim: ends in the state that is returned.
        name: `phi` or `pressure`.
        target: of the state, above 0; the pressure of particles that stick may be 0.
        relax: relaxes `sim` in its box.

    Raises:
        ParameterError: it cannot be reached; the message has what was.
    """
    state = relax()
    y, slope, last, stalls = _ordinate(name, getattr(state, name), state), 1.0, 0.0, 0
    goal = _ordinate(name, target, state)
    for _ in range(_RELAXATIONS):
        if is_reached(name, target, state):
            return state
        stalls = stalls + 1 if not state.converged and abs(last) < _LONGEST else 0
        if stalls == STALLS:
            raise _unreached(name, target, state, STALLED)
        change = (goal - y) / slope
        if name == "pressure" and state.pressure <= 0.0 and not _stick(state):
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
        if (before > 0.0 or _stick(state)) and (y - before) * change > 0.0:
            slope = float(np.clip((y - before) / change, _FLATTEST, _STEEPEST))
    raise _unreached(name, target, state, f"{_RELAXATIONS} relaxations were not enough")


def is_reached(name: str, target: float, state: State) -> bool:
    """Whether a state has this phi or pressure."""
    return abs(getattr(state, name) - target) <= REACHED[name] * _scale(target, state)


def _ordinate(name: str, value: float, state: State) -> float:
    """y of this value."""
    if name == "phi":
        return value
    packing, law = state.packing, state.law
    natural = value / natural_pressure(packing, law)
    return natural if _stick(state) else excess_phi(natural, packing, law)


def _scale(target: float, state: State) -> float:
    """Beside which a difference from a target counts: the target, or of 0 the natural pressure."""
    return target or natural_pressure(state.packing, state.law)


def _stick(state: State) -> bool:
    """Whether particles stick, so that films may pull the box together."""
    return sticks(state.law, state.packing.walls)


def _unreached(name: str, target: float, state: State, why: str) -> UnreachedError:
    return UnreachedError(
        f"{name} = {target:.10g} was not reached, but {getattr(state, name):.10g} at phi = "
        f"{state.phi:.6f}: {why}"
    )


def told_at_the_end(
    search: Callable[[Callable[[], State]], State], relax: Callable[[], State]
) -> State:
    """Search with many relaxations, and give the warnings of the last one alone.

    That a packing has lost its rigidity on the way is told if the last state is loose.
    """
    told: list[Warning] = []

    def quiet() -> State:
        nonlocal told
        with collected() as found:
            state = relax()
        told = [each for each in told if isinstance(each, UnjammedWarning)] + found
        return state

    state = search(quiet)
    for each in told:
        if not isinstance(each, UnjammedWarning) or not state.coordination:
            warn(each)
    return state


Floats = NDArray[np.float64]

# What is free: all strains along the sides together, each by itself, and with the shears that tilt
# the box, e_xy, in space e_xz and e_yz too.
FREE = ("iso", "aniso", "tri")

# Relaxations of one search. Ten to twenty are usual, more where a packing rearranges.
_BOX_RELAXATIONS = 400

# A step ends where the slope along it has fallen to this part, or has become as steep again; it is
# shortened so many times at most, as a packing that rearranges has no slope to find.
_FLAT, _SHORTER = 0.5, 6

# A packing whose pressure falls below this part of the one applied has rearranged.
_LOST = 0.5

# Pairs of strain and stress with less curvature than this part are none of a stable packing.
_CURVED = 1e-3


def refuse_polygons(law: object) -> None:
    """Refuse polygons where a pressure is the target."""
    if isinstance(law, DeformablePolygon):
        raise ParameterError("polygons have no target pressure: compress to a strain or phi")


def check_free(
    free: str,
    walls: tuple[Wall, ...],
    pressure: float | None,
    law: Any,
    friction: Friction | None = None,
) -> None:
    """Refuse what cannot be free, and a pressure that cannot be.

    Raises:
        ParameterError: there is no such word, or walls cannot follow; or the pressure is missing or
            not above 0, or 0 of particles that do not stick.
    """
    if pressure is not None:
        refuse_polygons(law)
        if pressure != 0.0 or not sticks(law, walls):
            positive("pressure", pressure)
        if friction:
            raise ParameterError(
                "with friction a packing depends on its way to a pressure, and relax goes to and "
                "fro: take run(steps, pressure=)"
            )
    if not isinstance(free, str) or free not in FREE:
        raise ParameterError(f"free must be iso, aniso or tri, not {shown(free)}")
    if pressure is None and free != "iso":
        raise ParameterError(f"free='{free}' needs a pressure to relax at: give pressure too")
    if walls and free != "iso":
        raise ParameterError(
            f"free='{free}' is not for walls, and there are {len(walls)}, the first a "
            f"{kind_of(walls[0])}: take free='iso', which scales them with the box"
        )


def relax_free_box(
    sim: Simulation, pressure: float, free: str, relax: Callable[[], State]
) -> State:
    """Relax centers and box at a pressure p: the enthalpy E + p A is least, with the
    volume in the place of the area A in space.

    A strain e of the box changes it by -A (stress - p 1) : e. The size is scaled first, see
    `reach`. Then the BFGS method finds the strains at which the stress of the relaxed packing is p
    in all free directions. Where a packing rearranges, its enthalpy falls, and the search goes on.

    Args:
        sim: ends in the state that is returned.
        pressure: p, 0 or above [energy/length^d].
        free: what is free, see `FREE`.
        relax: relaxes `sim` in its box.

    Raises:
        ParameterError: it cannot be reached; the message has what was.

    Source: BFGS: Nocedal, Wright, Numerical Optimization (2006), chapter 6.
    """

    def search(relax: Callable[[], State]) -> State:
        state = reach(sim, "pressure", pressure, relax)
        return state if free == "iso" else _stress_free(sim, pressure, free, relax, state)

    return told_at_the_end(search, relax)


def _stress_free(
    sim: Simulation, pressure: float, words: str, relax: Callable[[], State], state: State
) -> State:
    """A state whose stress is the pressure in all free directions, from one at this pressure."""
    relaxations, stalls = 0, 0
    dimension = state.packing.dimension
    free = dimension if words == "aniso" else dimension * (dimension + 1) // 2

    def strained(strain: Floats) -> State:
        nonlocal relaxations, stalls
        try:
            sim.deform(_strained(sim.box, strain))
            found = relax()
        except LammpsError as error:
            raise _pressure_unreached(state, pressure, free, str(error)) from None
        relaxations, stalls = relaxations + 1, stalls + 1 if not found.converged else 0
        if stalls == STALLS:
            raise _pressure_unreached(found, pressure, free, STALLED)
        if relaxations == _BOX_RELAXATIONS:
            why = f"{_BOX_RELAXATIONS} relaxations were not enough: relax at higher pressures first"
            raise _pressure_unreached(found, pressure, free, why)
        return found

    def slopes_of(state: State) -> Floats:
        return _slopes(state, pressure, free)

    inverse, longest = _first_inverse(state, pressure, free)
    slopes = slopes_of(state)
    while np.abs(slopes).max() > REACHED["pressure"]:
        step = -_times(inverse, slopes)
        step *= min(1.0, longest / _length(step))
        state, part = _downhill(strained, slopes_of, step, float(np.sum(slopes * step)))
        longest = (2.0 if part == 1.0 else part) * _length(step)
        inverse = _updated(inverse, part * step, slopes_of(state) - slopes)
        if pressure and state.pressure < _LOST * pressure:
            state = reach(sim, "pressure", pressure, relax)
        slopes = slopes_of(state)
    return state


def _downhill(
    strained: Callable[[Floats], State],
    slopes_of: Callable[[State], Floats],
    step: Floats,
    slope: float,
) -> tuple[State, float]:
    """Go a step, or a part of it where the enthalpy rises again; returns the state and the part.

    Args:
        strained: the state after a further strain.
        slopes_of: derivatives of the enthalpy in a state.
        step: strains of the whole step.
        slope: derivative of the enthalpy along the step at its start, below 0.
    """
    done, part = 0.0, 1.0
    for _ in range(_SHORTER):
        state = strained((part - done) * step)
        done, along = part, float(np.sum(slopes_of(state) * step))
        if along <= _FLAT * abs(slope):
            break
        part = done * slope / (slope - along)  # where a straight line between both is zero
    return state, done


def _slopes(state: State, pressure: float, free: int) -> Floats:
    """Derivatives of the enthalpy by the free strains, over `_scale` p and A, shape (free,)."""
    dimension, scale = len(state.pressure_tensor), _scale(pressure, state)
    excess = state.pressure_tensor / scale - pressure / scale * np.eye(dimension)
    return -excess[_components(dimension)][:free]


def _components(dimension: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows and columns of the strains: those along the sides, then the shears."""
    sides, (row, column) = np.arange(dimension), np.triu_indices(dimension, 1)
    return np.append(sides, row), np.append(sides, column)


def _strained(box: Floats, strain: Floats) -> Floats:
    """The lattice vectors of a box after a strain of its free directions."""
    change, (row, column) = np.eye(len(box)), _components(len(box))
    change[row[: len(strain)], column[: len(strain)]] += strain
    strained: Floats = np.sum(box[:, None, :] * change, axis=2)
    return strained


def _first_inverse(state: State, pressure: float, free: int) -> tuple[Floats, float]:
    """A first inverse of the second derivatives of the enthalpy over p A, and a first step.

    At x = phi - phi_J a packing has about K = p phi/x and G = K sqrt(x). Contacts change at strains
    of about x.

    Source: O'Hern, Silbert, Liu, Nagel, Phys. Rev. E 68, 011306 (2003).
    """
    packing, law = state.packing, state.law
    x = excess_phi(_scale(pressure, state) / natural_pressure(packing, law), packing, law)
    bulk = state.phi / x
    shear = bulk * float(np.sqrt(x))
    dimension = packing.dimension
    inverse = np.eye(free) / shear
    inverse[:dimension, :dimension] = 1.0 / (dimension**2 * bulk)
    inverse[:dimension, :dimension] += (np.eye(dimension) - 1.0 / dimension) / (2.0 * shear)
    return inverse, x


def _updated(inverse: Floats, step: Floats, change: Floats) -> Floats:
    """The inverse of second derivatives after a step has changed the slopes, by BFGS."""
    curvature = float(np.sum(step * change))
    if curvature <= _CURVED * _length(step) * _length(change):
        return inverse
    moved = _times(inverse, change)
    both = np.outer(step, moved) + np.outer(moved, step)
    stretch = 1.0 + float(np.sum(change * moved)) / curvature
    updated: Floats = inverse + (stretch * np.outer(step, step) - both) / curvature
    return updated


def _times(matrix: Floats, vector: Floats) -> Floats:
    """Their product, by sums that have the same digits on every processor."""
    product: Floats = np.sum(matrix * vector, axis=1)
    return product


def _length(vector: Floats) -> float:
    return float(np.sqrt(np.sum(vector * vector)))


def _pressure_unreached(state: State, pressure: float, free: int, why: str) -> ParameterError:
    excess = float(np.abs(_slopes(state, pressure, free)).max())
    return ParameterError(
        f"pressure = {pressure:.10g} was not reached in all free directions of the box, the "
        f"largest difference is {excess:.2g} of it at phi = {state.phi:.6f}: {why}"
    )
