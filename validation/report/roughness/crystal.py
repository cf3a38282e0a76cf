"""Smooth polygons on a triangular lattice, where the energy of particles is known exactly."""

from __future__ import annotations

from typing import Any

import numpy as np
from lammps_deformable.comparison import predict
from lammps_deformable.matching import matching_laws
from lammps_deformable.packing import Packing
from lammps_deformable.polygons import PolygonModel
from lammps_deformable.report import polygon_path
from mpi4py import MPI

_RADIUS, _SIDE = 0.5, 4


def crystal_row(model: PolygonModel, indentation: float) -> dict[str, Any]:
    """Equal polygons pressed into hexagons, against the exact shape.

    Each polygon is a regular hexagon with round corners, for which the ring laws are exact (docs/
    theory.md, "Regular polygons").

    Args:
        model: of the polygons.
        indentation: a/R.

    Returns:
        `n_v`, `indentation`; `energy_ratio`, of the polygons over the exact one; `residual`.
    """
    ((state, _),) = polygon_path(_touching(), model, indentation, 1)
    law = matching_laws(model, state.polygons)["balanced"]
    return {
        "n_v": int(state.polygons.number[0]),
        "indentation": indentation,
        "energy_ratio": state.energy / predict(state, law, MPI.COMM_SELF).energy,
        "residual": state.residual,
    }


def _touching() -> Packing:
    """Circles of one size that touch their six neighbors, in a rectangular box."""
    row, column = (index.ravel() for index in np.indices((_SIDE, _SIDE)))
    step, height = 2.0 * _RADIUS, np.sqrt(3.0) * _RADIUS
    return Packing(
        np.column_stack([(column + 0.5 * (row % 2)) * step, row * height]),
        np.zeros(_SIDE**2, np.int64),
        np.array([_RADIUS]),
        np.diag([_SIDE * step, _SIDE * height]),
    )
