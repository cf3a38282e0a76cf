"""Whole compressions: bead rings and the contact laws from the same start, each on its own.

What they go through differs for two reasons that are no error of a law. A packing rearranges where
it is barely stable, and two that are nearly alike need not do so together. And rings of beads are
rough: they catch in each other, as if there were friction, short of where smooth ones would slide.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterable, Iterator, Sequence
from ctypes import c_double, c_int
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..engine.bead_reference import BeadReference
from ..engine.simulation import Simulation
from ..model.beads import Beads
from ..model.laws import Law
from ..model.packing import Packing, bidisperse
from ..protocols.compression import compress
from ..protocols.jamming import jam
from ..state.bead_state import BeadState
from ..state.contact_network import without_rattlers
from ..state.state import State
from ..studies.comparison import Comparison, predict
from .packings import _UNJAMMED, _finite, matching_laws
from .pareto import matching

S = TypeVar("S")

# Largest forces on beads, over what one in a contact bears, down to which rings relax.
_TOLERANCES = (1e-1, 1e-2, 1e-3)

# Corners of the outlines along which beads are placed: many more than beads.
_POINTS = 5000


def compression_rows(
    number: int, seed: int, beads: Beads, strain: float, steps: int
) -> list[dict[str, Any]]:
    """A bidisperse packing compressed from jamming, as rings of beads and by the ring laws.

    Args:
        number: of particles.
        seed: of the random start.
        beads: what the rings are made of.
        strain: linear strain in all.
        steps: number of steps.

    Returns:
        A row for each step and law: what `_against` says, and the seconds of processor time of
        the step.
    """
    start = jam(bidisperse(number, seed=seed))
    rows = []
    with BeadReference(start, beads, comm=MPI.COMM_SELF) as rings:
        laws = matching_laws(beads, rings.rings)
        del laws["sector"]  # it does not converge
        smooth = replace(start, radii=rings.rings.effective_radius)
        paths = {name: _compressed(smooth, law, strain, steps) for name, law in laws.items()}
        for n, (exact, seconds_beads) in enumerate(_timed(compress(rings, strain, steps))):
            common = {
                "n": number,
                "seed": seed,
                "beads": int(rings.rings.number.min()),
                "strain": strain * (n + 1) / steps,
            }
            for name, path in paths.items():
                own, seconds = path[n]
                rows.append(
                    common
                    | {"law": name}
                    | _against(exact, own, common["strain"])
                    | {"seconds": seconds, "seconds_beads": seconds_beads}
                )
    return rows


def catching_rows(
    number: int, seed: int, strain: float, bead_numbers: Sequence[int], kP: float = 6.0
) -> list[dict[str, Any]]:
    """How far rings of more and more beads stay from where smooth ones come to rest.

    All stand for the same smooth particles, as in `pareto_rows`. Twice they relax at the strain:
    `strained` from jamming in one step, and `placed` along the outlines of the balanced law where
    that has come to rest. Each time they relax further and further.

    Args:
        number: of particles.
        seed: of the random start.
        strain: linear strain.
        bead_numbers: N_v of the small particles.
        kP: stiffness of the perimeter of a small ring [energy/length^2].

    Returns:
        A row for each number of beads, `start` and `tolerance`: what `_against` says, `slide_rms`
        as below, and the seconds of processor time since the start.
    """
    jammed = jam(bidisperse(number, seed=seed))
    rows = []
    for count in bead_numbers:
        beads = Beads(number=count, kL=kP * count)
        with BeadReference(matching(jammed, beads), beads, comm=MPI.COMM_SELF) as rings:
            smooth = replace(jammed, radii=rings.rings.effective_radius)
            ((own, _),) = _compressed(
                smooth, matching_laws(beads, rings.rings)["balanced"], strain, 1
            )
            common = {"n": number, "seed": seed, "beads": count, "strain": strain}
            for start in ("strained", "placed"):
                if start == "strained":
                    rings.deform(own.packing.box)
                else:
                    place(rings, own)
                seconds = 0.0
                for tolerance in _TOLERANCES:
                    began = time.process_time()
                    exact = rings.relax(tolerance)
                    seconds += time.process_time() - began
                    rows.append(
                        common
                        | {"start": start, "tolerance": tolerance}
                        | _against(exact, own, strain)
                        | {"slide_rms": slide_rms(exact, own), "seconds_beads": seconds}
                    )
    return rows


def _compressed(start: Packing, law: Law, strain: float, steps: int) -> list[tuple[State, float]]:
    """The states of a law, and the seconds of processor time of each step."""
    with Simulation(start, law, MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what a law cannot do shows in its rows
        return list(_timed(compress(sim, strain, steps)))


def _timed(states: Iterable[S]) -> Iterator[tuple[S, float]]:
    """Each state with the seconds of processor time that it took."""
    began = time.process_time()
    for state in states:
        yield state, time.process_time() - began
        began = time.process_time()


def _against(exact: BeadState, own: State, strain: float) -> dict[str, Any]:
    """A law's own state against rings of beads.

    Energy and pressure over the beads'; `S_rms`, the rms difference of the area deficits over
    the rms of the beads'; the law's energy over theirs at their own centers; what `centers_rms`,
    `same_branch` and `net_force` say.
    """
    distance = centers_rms(exact, own)
    unseen = np.empty(0)  # shapes, which say little about different centers
    alone = Comparison(exact, own, unseen)
    there = Comparison(exact, predict(exact, own.law, MPI.COMM_SELF), unseen)
    return {
        "energy_ratio": _finite(alone.energy_ratio),
        "pressure_ratio": _finite(alone.pressure_ratio),
        "energy_ratio_at_centers": _finite(there.energy_ratio),
        "centers_rms": distance,
        "S_rms": _finite(alone.area_deficit_error),
        "same_branch": same_branch(distance, strain),
        "net_force": net_force(exact),
    }


def centers_rms(exact: BeadState, own: State) -> float | None:
    """Root mean square distance of the centers over the mean radius; None if the law's are loose.

    Only particles count that are rattlers in neither. A drift of all of them is taken out.
    """
    if own.pressure <= _UNJAMMED * exact.pressure:
        return None
    i, j = exact.contacts.i, exact.contacts.j
    i, j = np.concatenate([i, j]), np.concatenate([j, i])
    held = np.bincount(i[without_rattlers(i, j, len(own.packing))], minlength=len(own.packing)) > 0
    return _rms(exact.packing, own.packing, held & ~own.rattlers)


def slide_rms(exact: BeadState, own: State) -> float | None:
    """The same for where the law's particles slide to from the rings' centers; None if loose."""
    there = replace(exact.packing, radii=own.packing.radii)
    with Simulation(there, own.law, MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        smooth = sim.relax()
    if smooth.pressure <= _UNJAMMED * own.pressure:
        return None
    return _rms(smooth.packing, own.packing, ~smooth.rattlers & ~own.rattlers)


def _rms(a: Packing, b: Packing, held: NDArray[np.bool_]) -> float | None:
    if not held.any():
        return None
    apart = (b.positions - a.positions)[held] @ np.linalg.inv(b.box)
    apart -= apart[0]  # so that the nearest image does not depend on the drift
    apart = (apart - np.rint(apart)) @ b.box
    apart -= apart.mean(axis=0)
    return float(np.sqrt(np.mean(np.sum(apart**2, axis=1))) / b.radius.mean())


def same_branch(distance: float | None, strain: float) -> bool:
    """Whether centers are no further apart than particles overlap, 2 strain R on the average.

    A particle that is moved by more than its overlaps loses contacts or finds others.
    """
    return distance is not None and distance <= 2.0 * strain


def net_force(state: BeadState) -> float:
    """Largest force on a ring as a whole over the mean contact force; 0 without contacts.

    It is what a law's `State.residual` is: forces on beads may be small and add up.
    """
    force = np.zeros((len(state.packing), 2))
    np.add.at(force, state.contacts.i, state.contacts.force)
    np.add.at(force, state.contacts.j, -state.contacts.force)
    total = np.linalg.norm(state.contacts.force, axis=1).sum()
    largest = np.linalg.norm(force, axis=1).max()
    return float(largest * len(state.contacts.i) / total) if total else 0.0


def place(rings: BeadReference, state: State) -> None:
    """Put the beads evenly along the outlines of a law's state, in its box."""
    box = state.packing.box
    rings.deform(box)
    kinds = state.packing.species
    lines = state.parallels(state.packing.radius - rings.rings.radius[kinds], _POINTS)
    beads = np.vstack(
        [
            center + _evenly(line, rings.rings.number[kind])
            for center, line, kind in zip(state.packing.positions, lines, kinds, strict=True)
        ]
    )
    fraction = beads @ np.linalg.inv(box)
    image = np.floor(fraction).astype(np.int64)
    x, flags = np.zeros((2, len(beads), 3))
    x[:, :2], flags[:, :2] = (fraction - image) @ box, image
    rings.lmp.scatter("x", 1, 3, (c_double * x.size)(*x.ravel()))
    rings.lmp.scatter("image", 0, 3, (c_int * x.size)(*flags.ravel().astype(int)))


def _evenly(line: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Points at equal distances along a closed polygon, shape (count, 2) [length]."""
    closed = np.vstack([line, line[:1]])
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    at = length[-1] * np.arange(count) / count
    return np.column_stack([np.interp(at, length, column) for column in closed.T])
