"""Packings of polygons against the contact laws: at the polygons' centers, and relaxed alone."""

from __future__ import annotations

import math
import statistics
import time
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI

from . import core
from .comparison import Comparison, compare
from .jamming import jam
from .lammps import run
from .laws import Law, per_species
from .matching import finite_ratio, is_unjammed, matching_laws
from .polygon_simulation import PolygonSimulation
from .polygons import PolygonModel
from .random import bidisperse
from .relax import TOLERANCE, minimize_command
from .shape_error import shape_error
from .simulation import Simulation
from .soft_disks import open_disks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .packing import Packing
    from .state import PolygonState, State

# Runs of a law or of disks, which take milliseconds; the time is their median.
_REPEATS = 5

# kP/(kA R^2) of polygons that stand for inextensible ones: the springs lower S by kA q^2/kP, below
# a tenth. The time of a relaxation grows as the root of the stiffness.
_STIFF = 10.0

# Radius of the beads of mixtures, and the stiffness of contacts over the largest kA, as for
# `report.standard_polygons`.
_SKIN, _CONTACT = 0.025, 10.0


def strain_polygons(
    start: Packing, model: PolygonModel, strain: float
) -> tuple[PolygonState, float]:
    """Polygons after one strain step from jamming, and the seconds of processor time."""
    with PolygonSimulation(start, model, comm=MPI.COMM_SELF) as polygons:
        polygons.deform(polygons.box * (1.0 - strain))
        began = time.process_time()
        state = polygons.relax()
        return state, time.process_time() - began


def strain_law(start: Packing, law: Law, strain: float) -> tuple[State, float]:
    """Particles after one strain step from jamming, and the seconds of processor time."""
    seconds = []
    for _ in range(_REPEATS):
        with Simulation(start, law, MPI.COMM_SELF) as sim, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the row has the residual
            sim.deform(sim.box * (1.0 - strain))
            began = time.process_time()
            state = sim.relax()
            seconds.append(time.process_time() - began)
    return state, statistics.median(seconds)


def strain_disks(start: Packing, strain: float) -> float:
    """Seconds of processor time of soft disks for the same step, to the tolerance of the laws."""
    force = TOLERANCE * strain * 2.0 * float(start.radius.mean())  # of the overlap, stiffness 1
    seconds = []
    for _ in range(_REPEATS):
        lmp = open_disks(start.at(start.phi / (1.0 - strain) ** 2))
        began = time.process_time()
        run(lmp, minimize_command(force, 1_000_000))
        seconds.append(time.process_time() - began)
        lmp.close()
    return statistics.median(seconds)


def mixed_rows(
    number: int, seed: int, strain: float, count: int, kA: Sequence[float], kP: Sequence[float]
) -> list[dict[str, Any]]:
    """As `packing_rows`, for smooth polygons whose species differ in stiffness.

    Args:
        number: of particles.
        seed: of the random start.
        strain: linear strain.
        count: N_v, of the small particles.
        kA: stiffness of the area of the small and of the large particles [energy/length^4].
        kP: stiffness of their perimeters [energy/length^2]. Where it is infinite, polygons have a
            large one instead, because no spring is rigid; `balanced, kP inf` is the law with the
            infinite value.
    """
    radii = bidisperse(number).radii
    polygons = PolygonModel(vertices=count, radius=_SKIN, smooth=True).polygons(radii)
    rigid = np.isinf(kP)
    springs = polygons.number * np.where(rigid, _STIFF * np.array(kA) * radii**2, kP)
    model = PolygonModel(count, _SKIN, springs.tolist(), kA, kr=_CONTACT * max(kA), smooth=True)
    rows, _ = packing_rows(number, seed, strain, model, rigid.tolist())
    return rows


def packing_rows(
    number: int,
    seed: int,
    strain: float,
    model: PolygonModel,
    rigid: Sequence[bool] = (),
) -> tuple[list[dict[str, Any]], dict[str, Comparison]]:
    """One bidisperse packing of polygons, strained from jamming in one step, against every law.

    Args:
        number: of particles.
        seed: of the random start.
        strain: linear strain.
        model: of the polygons.
        rigid: as for `matching_laws`.

    Returns:
        A row for each law, and the comparisons by the law's name. A row has the errors of the
        law's shapes and areas, and its energy and pressure over the beads', all at the beads'
        centers. Its `own_` energy and pressure are those of the packing that the law itself
        relaxes to from the same start, None if that is `unjammed`.
    """
    start = jam(bidisperse(number, seed=seed))
    polygons, seconds_polygons = strain_polygons(start, model, strain)
    common: dict[str, Any] = {
        "n": number,
        "strain": strain,
        "n_v": int(polygons.polygons.number.min()),
        "kA": polygons.polygons.kA.tolist(),
        "kP": polygons.polygons.kP.tolist(),
        "seed": seed,
        "seconds_polygons": seconds_polygons,
        "residual_polygons": polygons.residual,
    }
    disk: dict[str, Any] = {
        "law": "disk",
        "kP_law": None,
        "I": _error_of_disks(polygons),
        "S_rms": 1.0,  # a disk keeps its area, S = 0
        "energy_ratio": None,  # the stiffness of a disk is a free parameter
        "pressure_ratio": None,
        "own_energy_ratio": None,
        "own_pressure_ratio": None,
        "unjammed": False,
        "residual": None,
        "seconds": strain_disks(start, strain),
    }
    rows: list[dict[str, Any]] = [common | disk]
    smooth = replace(start, radii=polygons.polygons.effective_radius)
    comparisons = {}
    for name, law in matching_laws(model, polygons.polygons, rigid).items():
        comparison = comparisons[name] = compare(polygons, law, MPI.COMM_SELF)
        own, seconds = strain_law(smooth, law, strain)
        unjammed = is_unjammed(own, polygons)
        rows.append(
            common
            | {
                "law": name,
                "kP_law": [
                    k if math.isfinite(k) else "inf" for k in per_species(law.kP, len(start.radii))
                ],
                "I": float(comparison.shape_error.mean()),
                "S_rms": finite_ratio(comparison.area_deficit_error),
                "energy_ratio": finite_ratio(comparison.energy_ratio),
                "pressure_ratio": finite_ratio(comparison.pressure_ratio),
                "own_energy_ratio": None if unjammed else own.energy / polygons.energy,
                "own_pressure_ratio": None if unjammed else own.pressure / polygons.pressure,
                "unjammed": unjammed,
                "residual": own.residual,
                "seconds": seconds,
            }
        )
    return rows, comparisons


def _error_of_disks(reference: PolygonState) -> float:
    """Mean shape error of the circles through the beads at rest."""
    errors = []
    for polygon, center, kind in zip(
        reference.outlines, reference.packing.positions, reference.packing.species, strict=True
    ):
        circle = core.outline("ring", reference.polygons.radius[kind], [], [], 1440)
        errors.append(shape_error(polygon - center, circle, reference.packing.radii[kind]))
    return float(np.mean(errors))
