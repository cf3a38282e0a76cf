"""Species files, as the pair styles read them: names, radii and parameters of species."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .laws import AnyLaw, Droplet, Ring, SpeciesParameters, pair_matrix

if TYPE_CHECKING:
    from collections.abc import Sequence


def species_file(law: AnyLaw, radii: Sequence[float] | NDArray[np.float64]) -> str:
    """Text of the species file for species of these radii [length], named s1, s2, ...

    Raises:
        ParameterError: see `Ring.species_parameters`.
    """
    columns = np.column_stack([radii, *law.species_parameters(radii)])
    units = "kA[energy/length^4] kP[energy/length^2] skin[length]"
    if isinstance(law, Droplet):
        units = "kA kP skin (inf 0 0: constant volume) tension[energy/length^2]"
    lines = [
        "# UNITS: lj CONTRIBUTOR: written by lammps-deformable",
        f"# name radius[length] {units}",
    ]
    for n, row in enumerate(columns.tolist(), start=1):
        words = [f"s{n}", *map(repr, row[:4])]
        for name, value in zip(SpeciesParameters._fields[3:], row[4:], strict=True):
            words += [name, repr(value)] * (value != 0.0)
        lines.append(" ".join(words))
    if isinstance(law, Ring) and law.sticks:
        matrix = pair_matrix("adhesion", law.adhesion, len(radii)).tolist()
        lines += [
            f"adhesion s{i + 1} s{j + 1} {matrix[i][j]!r}"
            for i, j in zip(*np.triu_indices(len(radii)), strict=True)
            if matrix[i][j] > 0.0
        ]
    return "\n".join(lines) + "\n"
