"""Whole compressions: bead rings and the contact laws from the same start, each relaxed alone.

Their ways differ for two reasons that are no error of a law. A barely stable packing rearranges,
and two nearly equal packings need not do so at the same strain. Rings of beads are rough: they have
friction, and come to rest where smooth particles would slide on.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI

from ..engine.bead_reference import BeadReference
from ..engine.simulation import Simulation
from ..model.beads import Beads
from ..model.laws import Law
from ..model.packing import Packing, bidisperse
from ..protocols.compression import compress
from ..protocols.jamming import jam
from ..state.bead_state import BeadState
from ..state.state import State
from ..studies.comparison import Comparison, predict
from ..studies.matching import centers_rms, finite_ratio, matching_laws

S = TypeVar("S")


def compression_rows(
    number: int, seed: int, beads: Beads, strain: float, steps: int
) -> list[dict[str, Any]]:
    """A bidisperse packing compressed from jamming, as rings of beads and by the ring laws.

    Args:
        number: of particles.
        seed: of the random start.
        beads: of the rings.
        strain: total linear strain.
        steps: number of steps.

    Returns:
        A row for each step and law: the values of `_against`, and the seconds of processor time
        of the step.
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


def _compressed(start: Packing, law: Law, strain: float, steps: int) -> list[tuple[State, float]]:
    """The states of a law, and the seconds of processor time of each step."""
    with Simulation(start, law, MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the rows have the numbers
        return list(_timed(compress(sim, strain, steps)))


def _timed(states: Iterable[S]) -> Iterator[tuple[S, float]]:
    """Each state with its seconds of processor time."""
    began = time.process_time()
    for state in states:
        yield state, time.process_time() - began
        began = time.process_time()


def _against(exact: BeadState, own: State, strain: float) -> dict[str, Any]:
    """A law's own state against rings of beads.

    Energy and pressure over the beads'; the energy of the law at the beads' centers over theirs;
    `S_rms`, the rms difference of the area deficits over the rms of the beads'; and the values of
    `centers_rms`, `same_branch` and `net_force`.
    """
    distance = centers_rms(exact, own)
    no_shapes = np.empty(0)  # shapes about different centers do not compare
    alone = Comparison(exact, own, no_shapes)
    there = Comparison(exact, predict(exact, own.law, MPI.COMM_SELF), no_shapes)
    return {
        "energy_ratio": finite_ratio(alone.energy_ratio),
        "pressure_ratio": finite_ratio(alone.pressure_ratio),
        "energy_ratio_at_centers": finite_ratio(there.energy_ratio),
        "centers_rms": distance,
        "S_rms": finite_ratio(alone.area_deficit_error),
        "same_branch": same_branch(distance, strain),
        "net_force": net_force(exact),
    }


def same_branch(distance: float | None, strain: float) -> bool:
    """Whether the distance of the centers is at most the mean overlap, 2 strain R.

    A particle that moves by more than its overlaps loses contacts or gains others.
    """
    return distance is not None and distance <= 2.0 * strain


def net_force(state: BeadState) -> float:
    """Largest total force on a ring over the mean contact force; 0 without contacts.

    This is `State.residual` of a law: small forces on many beads may add up.
    """
    force = np.zeros((len(state.packing), 2))
    np.add.at(force, state.contacts.i, state.contacts.force)
    np.add.at(force, state.contacts.j, -state.contacts.force)
    total = np.linalg.norm(state.contacts.force, axis=1).sum()
    largest = np.linalg.norm(force, axis=1).max()
    return float(largest * len(state.contacts.i) / total) if total else 0.0
