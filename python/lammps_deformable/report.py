"""Whole compressions: each contact law, and other polygons, against smooth polygons.

Smooth polygons (docs/theory.md, "Smooth polygons") come to rest where smooth particles do. Bead
polygons have friction: they interlock, and their energy depends on the way.
"""

from __future__ import annotations

import time
import warnings
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .comparison import predict, shape_errors
from .compression import compress
from .core import angles, norm
from .errors import ParameterError
from .jamming import jam
from .matching import centers_rms, finite_ratio, is_unjammed, matching, matching_laws
from .polygon_simulation import PolygonSimulation
from .polygons import PolygonModel
from .random import bidisperse
from .simulation import Simulation
from .state import PolygonState, State

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from .laws import Law
    from .packing import Packing

S = TypeVar("S", State, PolygonState)
Path = list[tuple[S, float]]

# Laws without a continuous energy do not come to rest.
_RESTLESS = {"sector"}

# Directions in which outlines of polygons are compared.
_DIRECTIONS = 2.0 * np.pi * np.arange(720) / 720


def standard_polygons(count: int, kP: float = 6.0, smooth: bool = True) -> PolygonModel:
    """Polygons for the measurements, of kA = 1 and contacts of range c = 0.05 and stiffness 10.

    With radii of 0.5 and 0.7 contacts give way by less than 1 % of the indentation.

    Args:
        count: N_v, of the smallest polygons.
        kP: stiffness of their perimeter [energy/length^2].
        smooth: whether they are smooth, else bead polygons.
    """
    return PolygonModel(vertices=count, radius=0.025, kL=kP * count, kr=10.0, smooth=smooth)


def smooth_rows(
    number: int,
    seed: int,
    count: int,
    strain: float = 0.05,
    steps: int = 10,
    rivals: Sequence[PolygonModel] = (),
    model: PolygonModel | None = None,
) -> list[dict[str, Any]]:
    """A bidisperse packing compressed from jamming: every law against smooth polygons.

    Polygons and laws start from the same jammed disks and relax on their own after each step. The
    result does not depend on the process: `parallel_map` may share the seeds, and keep their rows.

    Args:
        number: of particles.
        seed: of the random start.
        count: N_v of the reference, vertices of a small polygon, see `standard_polygons`.
        strain: total linear strain.
        steps: number of steps.
        rivals: other smooth or bead polygons to compare with the reference. All stand for the same
            particles: bead polygons have the laws' radii as effective ones, see `matching`.
        model: of the reference, with `count` vertices; `standard_polygons` if not given.

    Returns:
        Rows for each step, in the order of the steps. Their keys:

        n, seed, strain, n_v: of the reference.
        law: name of a law, see `matching_laws`, or `smooth` or `bead` for rivals.
        vertices: N_v of a rival, else None.
        own: true if the law relaxed on its own, false if its particles have the centers of the
            reference. Rivals, and no row of the sector law, are on their own.
        energy_ratio, pressure_ratio: over those of the reference; None where one is unjammed.
        S_rms: root mean square difference of the area deficits over their root mean square.
        I: mean distance of the outlines over the radius, each about its own center; None if an
            outline of a law folds.
        distance: root mean square distance of the centers over the mean radius, see `centers_rms`;
            0 at given centers.
        residual: of the reference, see `PolygonState.residual`. Above 1e-6 the reference has not
            converged: it is loose, or nearly so, and the row says nothing about the law.
        law_residual: of the law or rival; None at given centers.
        seconds: processor time of the law's or rival's relaxation; None at given centers.
        seconds_polygons: that of the reference's relaxation.
    """
    start = jam(bidisperse(number, seed=seed))
    model = model or standard_polygons(count)
    laws = matching_laws(model, model.polygons(start.radii))
    reference = polygon_path(start, model, strain, steps)
    own: dict[str, Path[State]] = {
        name: law_path(start, law, strain, steps)
        for name, law in laws.items()
        if name not in _RESTLESS
    }
    others = [
        (rival, polygon_path(matching(start, rival), rival, strain, steps)) for rival in rivals
    ]
    rows: list[dict[str, Any]] = []
    for n, (exact, seconds) in enumerate(reference):
        common = {
            "n": number,
            "seed": seed,
            "strain": strain * (n + 1) / steps,
            "n_v": count,
            "residual": exact.residual,
            "seconds_polygons": seconds,
        }
        for name, law in laws.items():
            there = predict(exact, law, MPI.COMM_SELF)
            none = {"law": name, "vertices": None}
            if name in own:
                state, spent = own[name][n]
                rows.append(common | none | {"own": True} | _against(exact, state, spent))
            rows.append(common | none | {"own": False} | _against(exact, there, None))
        for rival, path in others:
            name = "smooth" if rival.smooth else "bead"
            rows.append(
                common
                | {"law": name, "vertices": int(path[n][0].polygons.number.min()), "own": True}
                | _against(exact, *path[n])
            )
    return rows


def polygon_path(
    start: Packing, model: PolygonModel, strain: float, steps: int
) -> Path[PolygonState]:
    """Polygons compressed from jamming: states, and seconds of processor time, of the steps."""
    with PolygonSimulation(start, model, comm=MPI.COMM_SELF) as polygons, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the rows have the residuals
        return list(timed(compress(polygons, strain, steps)))


def law_path(start: Packing, law: Law, strain: float, steps: int) -> Path[State]:
    """As `polygon_path`, for the particles of a law."""
    with Simulation(start, law, MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the rows have the residuals
        return list(timed(compress(sim, strain, steps)))


T = TypeVar("T")


def timed(results: Iterable[T]) -> Iterator[tuple[T, float]]:
    """Each result with its seconds of processor time."""
    began = time.process_time()
    for result in results:
        yield result, time.process_time() - began
        began = time.process_time()


def _against(
    exact: PolygonState, other: State | PolygonState, seconds: float | None
) -> dict[str, Any]:
    """The errors of a law, or of other polygons, see `smooth_rows`."""
    loose = is_unjammed(other, exact)
    wrong = norm(other.area_deficit - exact.area_deficit)
    return {
        "energy_ratio": None if loose else _over(other.energy, exact.energy),
        "pressure_ratio": None if loose else _over(other.pressure, exact.pressure),
        "S_rms": _over(wrong, norm(exact.area_deficit)),
        "I": _shape_error(exact, other),
        "distance": 0.0 if seconds is None else centers_rms(exact, other),
        "law_residual": None if seconds is None else other.residual,
        "seconds": seconds,
    }


def _over(value: float, exact: float) -> float | None:
    return finite_ratio(value / exact) if exact else None


def _shape_error(exact: PolygonState, other: State | PolygonState) -> float | None:
    if isinstance(other, State):
        try:
            return float(shape_errors(exact, other).mean())
        except ParameterError:  # an outline folds
            return None
    radius = exact.packing.radius
    return float(np.mean(np.abs(_dents(exact) - _dents(other)) / radius[:, None]))


def _dents(state: PolygonState) -> NDArray[np.float64]:
    """Distance of each polygon inward from its circle at rest, shape (N, directions) [length]."""
    found = []
    for polygon, center, kind in zip(
        state.outlines, state.packing.positions, state.packing.species, strict=True
    ):
        out = polygon - center
        inward = state.polygons.radius[kind] - np.hypot(*out.T)
        found.append(np.interp(_DIRECTIONS, angles(out), inward, period=2.0 * np.pi))
    return np.array(found)
