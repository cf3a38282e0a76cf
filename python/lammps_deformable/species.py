"""The species of a parameter file, as LAMMPS reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ._files import reading
from .errors import FileError, ParameterError
from .lammps import close_lammps, run, silent_lammps
from .laws import ALL_LAWS, AnyLaw, Droplet, Ring, Sector, SpeciesParameters

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

_COMMANDS = """
dimension {dimension}
region box block 0 1 0 1 -0.5 0.5
create_box {types} box
pair_style deformable/{style}
"""


def species_names(path: Path) -> list[str]:
    """Names of the species in a file, in its order.

    Raises:
        FileError: the file cannot be read, or has no species.
    """
    with reading(f"'{path}'"):
        words = [line.partition("#")[0].split() for line in path.read_text().splitlines()]
        rows = [row for row in words if row and row[0] != "adhesion"]
        names = [name for name, *numbers in rows if float(numbers[0])]
    if not names:
        raise FileError(f"'{path}' has no species: a line each, as name radius kA kP")
    return names


def read_species(path: Path, names: Sequence[str], law: str) -> tuple[NDArray[np.float64], AnyLaw]:
    """Radii of these species, shape (species,) [length], and the law with their parameters.

    Args:
        path: a species file, see pair_style deformable/ring and deformable/droplet.
        names: of species, one for each type.
        law: name of one.

    Raises:
        ParameterError: the law is `sector`, and species differ.
        LammpsError: LAMMPS refuses the file or a name, in its words.
    """
    kind = ALL_LAWS[law]
    style = f"ring contact {law}" if isinstance(kind, Ring) else law
    lmp = silent_lammps(MPI.COMM_SELF)
    try:
        run(lmp, _COMMANDS.format(types=len(names), style=style, dimension=kind.dimension))
        run(lmp, f'pair_coeff * * "{path}" {" ".join(names)}')
        radii, *values = (
            lmp.extract_pair(f"species {name}")[1:]
            for name in ("radius", *SpeciesParameters._fields)
        )
        found: dict[str, Any] = dict(zip(SpeciesParameters._fields, values, strict=True))
        if isinstance(kind, Droplet):
            return np.array(radii), Droplet(tuple(found["tension"]))
        if isinstance(kind, Sector):
            return np.array(radii), Sector(kA=_one("kA", found), kP=_one("kP", found))
        adhesion = np.array(lmp.extract_pair("adhesion"))[1:, 1:]
        sticky = tuple(map(tuple, adhesion.tolist())) if adhesion.any() else 0.0
        return np.array(radii), Ring(contact=law, adhesion=sticky, **found)
    finally:
        close_lammps(lmp)


def _one(name: str, found: Mapping[str, Sequence[float]]) -> float:
    """The value that all species have: the law `sector` has no others in Python."""
    if len({*found[name]}) > 1:
        raise ParameterError(
            f"with the law sector all species must have one {name}, not {found[name]}"
        )
    return found[name][0]
