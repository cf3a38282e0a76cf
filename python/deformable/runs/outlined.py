"""Shapes of the particles in a file of another program, such as a LAMMPS dump."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from mpi4py import MPI

from ..common.errors import FileError, ParameterError
from ..common.validate import expect
from ..engine.simulation import Simulation
from ..engine.species import read_species, species_names
from ..model.droplet import ALL_LAWS
from ..model.packing import Packing
from ..plugin import potentials
from ..state.droplet_state import DeformedState


def state_in_file(
    path: str | Path,
    species: str | Path,
    law: str = "balanced",
    types: Sequence[str] | None = None,
    frame: int = -1,
    radii: str | None = None,
) -> DeformedState:
    """The state of particles whose centers are in a file: outlines, energy, stress, contacts.

        deformable.state_in_file("shapes.dump", "mixture.deformable").export("shapes.vtp")

    Positions are those of the file; nothing moves. They must be periodic and, but for droplets, of
    one plane.
    Velocities are left out. Particles with an adhesion stick where their circles overlap. A file
    does not tell of the stiffnesses of single particles, *kA atom*: they are those of the species.

    Args:
        path: a LAMMPS dump, or what else `Packing.from_file` reads.
        species: the species file of pair_coeff, or the name of one that comes with the package.
        law: `balanced`, `curved`, `radical`, `sector` or, in three dimensions, `droplet`.
        types: names of species, one for each atom type, as in pair_coeff; by default those of the
            file in their order.
        frame: number of the frame, from 0, or from the end if negative.
        radii: name of a column with the radius of each particle, as with `radius atom`; by default
            the radii are those of the species.

    Raises:
        FileError: a file cannot be read.
        ParameterError: an argument is out of range, or there are more atom types than species.
        LammpsError: LAMMPS refuses the species, or the packing: contacts leave no room, say.
    """
    expect("path", path, str, Path)
    expect("species", species, str, Path)
    expect("radii", radii, str, type(None))
    if law not in ALL_LAWS:
        raise ParameterError(f"law must be {', '.join(ALL_LAWS)}, not {law}")
    file = Path(species)
    if not file.exists() and (Path(potentials()) / file).exists():
        file = Path(potentials()) / file
    if not file.exists():
        raise FileError(f"there is no species file '{species}'")
    names = list(species_names(file) if types is None else types)
    own, dimension = 1.0 if radii is None else radii, ALL_LAWS[law].dimension
    packing = Packing.from_file(path, own, frame, dimension=dimension)
    number = len(packing.radii)
    if number > len(names):
        raise ParameterError(
            f"'{path}' has particles of type {number}, but the species of {len(names)} types are "
            f"named: {', '.join(names)}"
        )
    sizes, chosen = read_species(file, names[:number], law)
    if radii is None:
        packing = replace(packing, radii=sizes)
    with Simulation(packing, chosen, MPI.COMM_SELF) as sim:
        return sim.state()
