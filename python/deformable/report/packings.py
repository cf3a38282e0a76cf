"""Packings of bead rings against the contact laws, at the rings' own centres and relaxed alone."""

from __future__ import annotations

import time
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..bead_reference import BeadReference
from ..bead_state import BeadState
from ..beads import Beads, Rings
from ..comparison import Comparison, compare
from ..engine import run
from ..jamming import jam, open_disks
from ..models import Model, Ring, Sector
from ..packing import Packing, bidisperse
from ..shape_error import shape_error
from ..simulation import Simulation
from ..state import State

# Corners of the circle that a disk is compared as.
_POINTS = 1440


def laws(beads: Beads, rings: Rings) -> dict[str, Model]:
    """The contact laws that stand in for rings of such beads, by name.

    `ring` keeps perimeters as the paper does; `soft ring` has the rings' own stiffness kP =
    kL/N_v, and their beads as a rigid skin.
    """
    return {
        "sector": Sector(beads.kA),
        "ring": Ring(beads.kA),
        "soft ring": Ring(
            beads.kA,
            kP=(beads.kL / rings.number).tolist(),
            skin=(rings.effective_radius - rings.radius).tolist(),
        ),
    }


def strain_beads(
    start: Packing, beads: Beads, strain: float, tolerance: float = 1e-3
) -> tuple[BeadState, float]:
    """Rings after one strain step from jamming, and the seconds of processor time it took."""
    with BeadReference(start, beads, comm=MPI.COMM_SELF) as rings:
        rings.deform(rings.box * (1.0 - strain))
        began = time.process_time()
        state = rings.relax(tolerance)
        return state, time.process_time() - began


def strain_law(start: Packing, model: Model, strain: float) -> tuple[State, float]:
    """Particles after one strain step from jamming, and the seconds of processor time it took."""
    with Simulation(start, model, MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what a law cannot do shows in its row
        sim.deform(sim.box * (1.0 - strain))
        began = time.process_time()
        state = sim.relax()
        return state, time.process_time() - began


def strain_disks(start: Packing, strain: float) -> float:
    """Seconds of processor time of soft disks for the same step, relaxed as far as particles."""
    lmp = open_disks(start.at(start.phi / (1.0 - strain) ** 2))
    force = 1e-6 * strain * 2.0 * float(start.radius.mean())  # of the overlap, stiffness 1
    began = time.process_time()
    run(lmp, f"minimize 0 {force!r} 1000000 2000000")
    seconds = time.process_time() - began
    lmp.close()
    return seconds


def undeformed(beads: BeadState) -> list[NDArray[np.float64]]:
    """The circles through the beads at rest, about each particle's own centre, arrays (m, 2)."""
    turn = 2.0 * np.pi * np.arange(_POINTS) / _POINTS
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    return [radius * circle for radius in beads.rings.radius[beads.packing.species]]


def packing_rows(
    number: int, seed: int, strain: float, beads: Beads
) -> tuple[list[dict[str, Any]], list[Comparison]]:
    """One bidisperse packing of rings, strained from jamming in one step, against every law.

    Args:
        number: of particles.
        seed: of the random start.
        strain: linear strain.
        beads: what the rings are made of.

    Returns:
        A row for each law, with the error of its shapes and areas, its energy and its pressure
        over the beads', all at the beads' centres; its `own_` energy and pressure are those of the
        packing that it relaxes to itself from the same start. And the comparisons.
    """
    start = jam(bidisperse(number, seed=seed))
    rings, seconds_beads = strain_beads(start, beads, strain)
    common: dict[str, Any] = {
        "n": number,
        "strain": strain,
        "beads": int(rings.rings.number.min()),
        "seed": seed,
        "seconds_beads": seconds_beads,
        "residual_beads": rings.residual,
    }
    circle = [
        shape_error(ring - centre, outline, radius)
        for ring, centre, outline, radius in zip(
            rings.outlines,
            rings.packing.positions,
            undeformed(rings),
            rings.packing.radius,
            strict=True,
        )
    ]
    disk: dict[str, Any] = {
        "model": "disk",
        "I": float(np.mean(circle)),
        "S_rms": 1.0,  # a disk keeps its area, S = 0
        "energy_ratio": None,  # its stiffness is a free parameter
        "pressure_ratio": None,
        "own_energy_ratio": None,
        "own_pressure_ratio": None,
        "residual": None,
        "seconds": strain_disks(start, strain),
    }
    rows: list[dict[str, Any]] = [common | disk]
    smooth = replace(start, radii=rings.rings.effective_radius)
    comparisons = []
    for name, model in laws(beads, rings.rings).items():
        comparison = compare(rings, model, MPI.COMM_SELF)
        comparisons.append(comparison)
        own, seconds = strain_law(smooth, model, strain)
        rows.append(
            common
            | {
                "model": name,
                "I": float(comparison.shape_error.mean()),
                "S_rms": comparison.area_deficit_error,
                "energy_ratio": comparison.energy_ratio,
                "pressure_ratio": comparison.pressure_ratio,
                "own_energy_ratio": own.energy / rings.energy,
                "own_pressure_ratio": own.pressure / rings.pressure,
                "residual": own.residual,
                "seconds": seconds,
            }
        )
    for row in rows:
        row["speed_up"] = seconds_beads / row["seconds"]
    return rows, comparisons
