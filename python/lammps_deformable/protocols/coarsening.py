"""Coarsening of foams: gas flows from bubbles of higher pressure, and small ones vanish.

The volumes V_i of bubbles (areas in the plane), those of the undeformed radii, follow

    dV_i/dt = -permeability [sum_j S_ij (p_i - p_j) + border S_i (p_i - p)/R_i]

with the film between two bubbles S_ij (its length, or its area in space), their pressures p_i, and
the free surface S_i. Gas in the liquid has the pressure p that keeps the sum of all volumes
(Lemlich 1978). It crosses distances of about R_i there, in the place of the thickness of films,
which is `border`. The foam is at rest all the time. Films alone let radii grow as t^(1/2), the
liquid alone as t^(1/3) (Lifshitz and Slyozov; Wagner 1961). In the dry limit of the plane films of
the tension g meet at 120 degrees, so that a bubble with n neighbors has

    dV_i/dt = permeability g (pi/3) (n - 6)                            (von Neumann 1952)

with twice the line tension of an outline for g.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.checks import count, expect, positive, zero_or_more
from ..common.errors import ParameterError
from ..particles.laws import Droplet, Ring, volumes
from ..state.labels import remaining
from .protocol import Protocol, check_tolerance
from .recording import at_rest, next_time

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..engine.simulation import Simulation
    from ..state.state import State

Floats = NDArray[np.float64]

# Over the mean volume: the change of a volume in a step at most, and the volume at which a bubble
# vanishes, or over that of its largest neighbor. The number of bubbles does not tell steps of 0.02
# from 0.05 in a foam of 256. With 0.02 for the smallest, lines lie behind centers in dry foams
# (0.01 to 0.05 were tried).
_CHANGE, _SMALLEST = 0.05, 0.04


def gas_flow(state: State, permeability: float, border: float = 0.0) -> Floats:
    """dV/dt of each bubble, shape (N,) [length^d/time]."""
    table, pressure = state.contacts, state.pressures
    pair = table["j"] >= 0
    i, j, film = table["i"][pair], table["j"][pair], films_in(table)[pair]
    flow = np.zeros(len(pressure))
    through = 0.5 * film * (pressure[i] - pressure[j])  # half by each side, whose films may differ
    np.add.at(flow, i, -through)
    np.add.at(flow, j, through)
    if border:
        free = free_surface(state) / state.radii
        liquid = np.sum(free * pressure) / max(np.sum(free), np.finfo(float).tiny)
        flow -= border * free * (pressure - liquid)
    return permeability * flow


def films_in(table: NDArray[np.void]) -> Floats:
    """Length of the film on each side of a contact; in space its area [length^(d-1)]."""
    if "length" in (table.dtype.names or ()):
        return np.asarray(table["length"], np.float64)
    return np.asarray(np.pi * table["facet_radius"] ** 2, np.float64)


def free_surface(state: State) -> Floats:
    """The part of each outline or surface that no contact covers, shape (N,) [length^(d-1)]."""
    if state.packing.dimension == 3:
        return np.maximum(state.surface_areas - state.contact_areas, 0.0)
    covered = np.zeros(len(state.packing))
    np.add.at(covered, state.contacts["i"], state.contacts["length"])
    return np.maximum(state.perimeters - covered, 0.0)


@dataclass(frozen=True, kw_only=True)
class Coarsen(Protocol):
    """See `Simulation.coarsen`."""

    permeability: float
    time: float
    border: float = 0.0
    tolerance: float | None = None

    def check(self, sim: Simulation, recorded: bool) -> Coarsen:
        expect("the law of bubbles", sim.law, Ring, Droplet)
        if sim.friction:
            raise ParameterError("bubbles slip: leave friction out of a simulation that coarsens")
        return Coarsen(
            permeability=float(positive("permeability", self.permeability)),
            time=float(positive("time", self.time)),
            border=float(zero_or_more("border", self.border)),
            steps=count("steps", self.steps),
            tolerance=check_tolerance(self.tolerance, recorded),
        )

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        """The relaxed start."""
        return at_rest(sim, self.tolerance), {"time": sim.time, "states": self.steps}

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        state = at_rest(sim, self.tolerance) if before is None else before
        for n in range(done + 1, self.steps + 1):
            end = start["time"] + self.time * n / self.steps
            while state.time < end:
                flow = gas_flow(state, self.permeability, self.border)
                change = _CHANGE * float(volumes(state.radii, sim.dimension).mean())
                step, later = next_time(state.time, end, change, float(np.abs(flow).max()))
                sim.reset(replace(after(state, flow * step), time=later))
                state = at_rest(sim, self.tolerance)
            yield state


def after(state: State, change: Floats) -> State:
    """The state after these changes of volumes, not relaxed.

    A bubble vanishes that is smaller than a part of the mean, or of its largest neighbor: beside
    much larger ones lines may lie behind its center. Its neighbors share what it has, or lacks, by
    their films with it; all bubbles by their volumes, where it has none.
    """
    dimension = state.packing.dimension
    volume = volumes(state.radii, dimension)
    largest = np.full(len(volume), volume.mean())
    table, left = state.contacts, np.ones(len(volume), np.bool_)
    pair = table["j"] >= 0
    i, j, film = table["i"][pair], table["j"][pair], films_in(table)[pair]
    np.maximum.at(largest, i, volume[j])
    volume += change
    while left.sum() > 1:
        gone = int(np.argmin(np.where(left, volume / largest, np.inf)))
        if volume[gone] >= _SMALLEST * largest[gone]:
            break
        left[gone] = False
        share = np.zeros(len(volume))
        np.add.at(share, j[i == gone], film[i == gone])
        share *= left
        if not share.any():
            share = np.maximum(volume, 0.0) * left
        volume += volume[gone] * share / share.sum()
    volume[~left] = 1.0  # of those that are gone, whose radii are cut out
    radii = np.cbrt(0.75 * volume / math.pi) if dimension == 3 else np.sqrt(volume / math.pi)
    state = replace(state, packing=state.packing.replace(radii=radii))
    return remaining(state, left)
