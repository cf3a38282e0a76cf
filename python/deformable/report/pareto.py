"""Error against run time: every method on the same packings, against the limit of many beads.

Rings of different numbers of beads N_v stand for the same smooth particles: their effective radii
are the same, and kL = N_v kP. The reference is their limit for many beads, extrapolated in 1/N_v^2,
the order of a polygon's error, from the two largest N_v.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.beads import Beads
from ..model.packing import bidisperse
from ..protocols.jamming import jam
from ..state.bead_state import BeadState
from ..studies.matching import matching, matching_laws
from ..studies.shape_error import radial_distance
from .packings import strain_beads, strain_disks, strain_law

# Directions in which outlines are compared.
_DIRECTIONS = 2.0 * np.pi * np.arange(720) / 720


def pareto_rows(
    number: int, seeds: Sequence[int], strain: float, bead_numbers: Sequence[int], kP: float = 6.0
) -> list[dict[str, Any]]:
    """Error and processor time of one strain step from jamming, on one core, of every method.

    Args:
        number: of particles.
        seeds: of the random starts; errors and times are means over the packings.
        strain: linear strain.
        bead_numbers: N_v of the small particles in rising order, at least two.
        kP: stiffness of the perimeter of a small ring [energy/length^2].

    Returns:
        A row for each method: `error`, the root mean square error of the area deficits over their
        root mean square; `shape_error`, the mean over particles and directions of the error of
        the outline over the radius, each about its own center; `seconds`; `residual`, the largest
        of the laws' relaxations; for beads N_v as `beads`, and `reference` for the two of which
        the reference is made: their errors follow from the extrapolation.
    """
    found = [_one_packing(number, seed, strain, bead_numbers, kP) for seed in seeds]
    common = {"n": number, "seeds": list(seeds), "strain": strain}
    rows = []
    for same in zip(*found, strict=True):
        means = {
            key: float(np.mean([row[key] for row in same]))
            for key in ("error", "shape_error", "seconds")
        }
        if "residual" in same[0]:
            means["residual"] = max(row["residual"] for row in same)
        rows.append(same[0] | means | common)
    return rows


def _one_packing(
    number: int, seed: int, strain: float, bead_numbers: Sequence[int], kP: float
) -> list[dict[str, Any]]:
    start = jam(bidisperse(number, seed=seed))
    runs = []
    for count in bead_numbers:
        beads = Beads(number=count, kL=kP * count)
        runs.append((count, *strain_beads(matching(start, beads), beads, strain)))
    (n1, coarse, _), (n2, fine, _) = runs[-2:]
    deficit = extrapolated(n1, coarse.area_deficit, n2, fine.area_deficit)
    dents = extrapolated(n1, _dents(coarse), n2, _dents(fine))

    def row(
        method: str, area_deficit: NDArray[np.float64], shape_error: float, seconds: float
    ) -> dict[str, Any]:
        return {
            "method": method,
            "error": float(np.linalg.norm(area_deficit - deficit) / np.linalg.norm(deficit)),
            "shape_error": shape_error,
            "seconds": seconds,
        }

    def off(found: NDArray[np.float64]) -> float:
        return float(np.mean(np.abs(found - dents) / start.radius[:, None]))

    rows = [row("disk", 0.0 * deficit, off(0.0 * dents), strain_disks(start, strain))]
    for name, law in matching_laws(beads, fine.rings).items():
        state, seconds = strain_law(start, law, strain)
        outlines = state.parallels(points=2 * len(_DIRECTIONS))
        found = np.array(
            [
                radius - radial_distance(outline, _DIRECTIONS)
                for radius, outline in zip(start.radius, outlines, strict=True)
            ]
        )
        rows.append(
            row(name, state.area_deficit, off(found), seconds) | {"residual": state.residual}
        )
    for count, rings, seconds in runs:
        error = _error_of_beads(rings, dents)
        rows.append(
            row("beads", rings.area_deficit, error, seconds)
            | {"beads": count, "reference": count in (n1, n2)}
        )
    return rows


def extrapolated(
    n1: int, coarse: NDArray[np.float64], n2: int, fine: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The limit of values whose error falls as 1/N^2, from those at N = n1 and n2."""
    return fine + n1**2 / (n2**2 - n1**2) * (fine - coarse)


def _dents(state: BeadState) -> NDArray[np.float64]:
    """Distance from each ring outward to its circle at rest, shape (N, directions) [length].

    Straight lines between beads lie within the arcs by the order 1/N_v^2, which the extrapolation
    removes.
    """
    radii = state.rings.radius[state.packing.species]
    return np.array(
        [
            radius - radial_distance(ring - center, _DIRECTIONS)
            for ring, center, radius in zip(
                state.outlines, state.packing.positions, radii, strict=True
            )
        ]
    )


def _error_of_beads(state: BeadState, dents: NDArray[np.float64]) -> float:
    """The shape error of rings at their beads."""
    errors = []
    for ring, center, kind, exact in zip(
        state.outlines, state.packing.positions, state.packing.species, dents, strict=True
    ):
        x, y = (ring - center).T
        expected = np.interp(np.arctan2(y, x), _DIRECTIONS, exact, period=2.0 * np.pi)
        found = state.rings.radius[kind] - np.hypot(x, y)
        errors.append(np.mean(np.abs(found - expected)) / state.packing.radii[kind])
    return float(np.mean(errors))
