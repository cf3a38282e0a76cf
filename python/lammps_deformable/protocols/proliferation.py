"""Cells that grow, divide and die.

The volume V_i of a cell at rest (its area in the plane) grows at a rate, the slower the more others
press on it,

    dV_i/dt = rate V_i max(0, 1 - p_i/pressure),    p_i = sum f h/(d V_i)

over its contacts: f is the force, h the distance of the contact line, or facet, from the center,
and d the dimension; cells cease to grow at `pressure` (Shraiman 2005; Basan et al. 2009). A cell
that has reached a size divides in two, of shares that are drawn, side by side along an axis; each
cell may die at any time. The tissue is at rest all the time.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.checks import count, expect, positive, shown, zero_or_more
from ..common.errors import LammpsError, ParameterError
from ..particles.laws import Droplet, Ring, one_or_each, per_species, volumes
from ..state.labels import divided, labels_of, remaining
from .motion import drawn_seed
from .recording import Protocol, at_rest, check_tolerance, next_time, steps_so_far

Floats = NDArray[np.float64]

# Growth of a volume from one relaxation to the next.
_GROWTH = 0.05

# Packing fraction of undeformed cells that leave no room to grow.
_FULL = 0.9

_AXES = ("random", "long", "stress")


def _settings(sim: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    expect("the law of cells", sim.law, Ring, Droplet)
    if sim.friction:
        raise ParameterError("cells slip: leave friction out of a simulation that proliferates")
    rate = one_or_each("rate", given["rate"])
    for value in np.atleast_1d(rate).tolist():
        zero_or_more("rate", value)
    axis, dimension = given["axis"], sim.dimension
    if axis not in _AXES:
        raise ParameterError(f"axis must be {', '.join(_AXES[:-1])} or stress, not {shown(axis)}")
    if axis == "long" and dimension == 3:
        raise ParameterError("axis 'long' is for cells in the plane: take 'stress' or 'random'")
    asymmetry = zero_or_more("asymmetry", given["asymmetry"])
    if asymmetry >= 1.0:
        raise ParameterError(f"asymmetry must be below 1, not {asymmetry}")
    pressure = given["pressure"]
    recorded = given["record"] is not None
    return {
        "rate": list(rate) if isinstance(rate, tuple) else rate,
        "division": float(positive("division", given["division"])),
        "time": float(positive("time", given["time"])),
        "steps": count("steps", given["steps"]),
        "axis": axis,
        "asymmetry": float(asymmetry),
        "pressure": math.inf if pressure is None else float(positive("pressure", pressure)),
        "death": float(zero_or_more("death", given["death"])),
        "tolerance": check_tolerance(given["tolerance"], recorded),
        "seed": drawn_seed(sim, given["seed"]),
    }


def _begin(sim: Any, settings: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The relaxed start, and what its cells are called."""
    per_species(settings["rate"], len(sim.packing.species_radii))
    state = at_rest(sim, settings)
    return state, {
        "time": sim.time,
        "step": steps_so_far(sim),
        "label": int(labels_of(state).max()) + 1,
        "states": settings["steps"],
    }


def _proliferated(
    sim: Any, settings: Mapping[str, Any], start: dict[str, Any], done: int, before: Any
) -> Iterator[Any]:
    """The states that remain."""
    state = at_rest(sim, settings) if before is None else before
    for n in range(done + 1, settings["steps"] + 1):
        rng = np.random.default_rng([settings["seed"], start["step"], n])
        end = start["time"] + settings["time"] * n / settings["steps"]
        while state.time < end:
            rate = growth(state, settings["rate"], settings["pressure"])
            fastest = max(float(rate.max()), settings["death"])
            step, later = next_time(state.time, end, _GROWTH, fastest)
            radii = state.radii * np.exp(rate * step / sim.dimension)
            grown = divide(state, radii, settings, start, rng)
            sim.reset(replace(die(grown, settings["death"] * step, rng), time=later))
            try:
                state = at_rest(sim, settings)
            except LammpsError:
                if state.packing.phi < _FULL:
                    raise
                raise ParameterError(
                    f"the cells have no room to grow at time {state.time:.3g}, where they fill "
                    f"{state.phi:.3g} of the box: give a pressure at which growth ceases, or end "
                    "sooner"
                ) from None
        yield state


def growth(state: Any, rate: Any, pressure: float) -> Floats:
    """Rate of growth of each cell, shape (N,) [1/time]."""
    species = np.array(per_species(rate, len(state.packing.species_radii)))
    moments = np.trace(state.particle_stress, axis1=1, axis2=2) * state.volumes  # sum f h
    d = state.packing.dimension
    pressed = moments / (d * volumes(state.radii, d))
    return core.growth_rate(species[state.packing.species], pressed, pressure)


def die(state: Any, chance: float, rng: np.random.Generator) -> Any:
    """The state without the cells that die, each with a chance; one stays."""
    if chance == 0.0:
        return state
    left = rng.uniform(size=len(state.packing)) >= -math.expm1(-chance)
    if not left.any():
        left[0] = True
    return remaining(state, left)


def divide(
    state: Any,
    radii: Floats,
    settings: Mapping[str, Any],
    start: dict[str, Any],
    rng: np.random.Generator,
) -> Any:
    """The state with these radii, in which cells of a size have divided, not relaxed.

    Axes are those of the shapes and stresses of the relaxed state.
    """
    grown = replace(state, packing=state.packing.replace(radii=radii))
    mothers = np.flatnonzero(volumes(radii, state.packing.dimension) >= settings["division"])
    if not mothers.size:
        return grown
    share = core.first_share(settings["asymmetry"], rng.uniform(-1.0, 1.0, mothers.size))
    axes = np.zeros((len(mothers), state.packing.dimension))
    if settings["axis"] != "random":
        axes = (long_axes if settings["axis"] == "long" else stretched_axes)(state, mothers)
    free = (axes == 0.0).all(axis=1)  # no direction is different: any
    drawn = rng.normal(size=(free.sum(), state.packing.dimension))
    axes[free] = drawn / np.linalg.norm(drawn, axis=1)[:, None]
    label = start["label"]
    start["label"] += len(mothers)
    return divided(grown, mothers, axes, share, label)


def stretched_axes(state: Any, cells: NDArray[np.int64]) -> Floats:
    """Along which a cell is pressed least, or pulled most, shape (M, d); 0 where nothing tells."""
    return core.stretched_axes(state.particle_stress[cells])


def long_axes(state: Any, cells: NDArray[np.int64]) -> Floats:
    """The long axes of outlines (Hertwig's rule), shape (M, 2); 0 of those that are round."""
    return np.array([core.long_axis(state.outlines[i] - state.positions[i]) for i in cells])


PROLIFERATE = Protocol(_settings, _begin, _proliferated)
