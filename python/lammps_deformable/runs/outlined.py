"""Shapes of the particles in a file of another program, such as a LAMMPS dump."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from mpi4py import MPI

from .. import potentials
from ..common.errors import FileError, ParameterError
from ..common.files import reading
from ..common.validate import expect
from ..engine.simulation import Simulation
from ..engine.species import read_species, species_names
from ..formats.files import read_particles
from ..formats.particles import UNTYPED
from ..io import frames
from ..io.run_folder import SUMMARY, TRAJECTORY, holds
from ..io.store import read_setup, summary_in
from ..model.droplet import ALL_LAWS, AnyLaw, Droplet
from ..model.laws import Ring
from ..model.packing import Packing
from ..state.droplet_state import DeformedState

# The law of files that do not tell.
_UNTOLD = "balanced"


def state_in_file(
    path: str | Path,
    species: str | Path,
    law: str | None = None,
    types: Sequence[str] | None = None,
    frame: int = -1,
    radii: str | None = None,
) -> DeformedState:
    """The state of particles whose centers are in a file: outlines, energy, stress, contacts.

        ld.state_in_file("shapes.dump", "mixture.deformable").export("shapes.vtp")

    Positions are those of the file; nothing moves. They must be periodic and, but for droplets, of
    one plane.
    Velocities are left out. Particles with an adhesion stick where their circles overlap. A file
    does not tell of the stiffnesses of single particles, *kA atom*: they are those of the species.

    Args:
        path: a LAMMPS dump, or what else `Packing.from_file` reads.
        species: the species file of pair_coeff, or the name of one that comes with the package.
        law: `balanced`, `curved`, `radical`, `sector` or, in three dimensions, `droplet`. If not
            given that of the run in whose folder the file is, or the species file; LAMMPS' own
            files do not tell, and have `balanced`, the default of the pair style.
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
    told = law_of_run(path, species, frame) if law is None else None
    law = law or (told.name if told else _UNTOLD)
    if law not in ALL_LAWS:
        raise ParameterError(f"law must be {', '.join(ALL_LAWS)}, not {law}")
    file = Path(species)
    if not file.exists() and (potentials / file).exists():
        file = potentials / file
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
    if number == 1 < len(names) and not read_particles(Path(path), frame).typed:
        raise FileError(f"'{path}': {UNTYPED}, or the one species of all, such as {names[0]}")
    sizes, chosen = read_species(file, names[:number], law)
    if isinstance(told, (Ring, Droplet)):  # no species file has the reach
        reach: dict[str, Any] = {"reach": told.reach}
        chosen = replace(chosen, **reach)
    if radii is None:
        packing = replace(packing, radii=sizes)
    with Simulation(packing, chosen, MPI.COMM_SELF) as sim:
        return sim.state()


def law_of_run(path: str | Path, species: str | Path, frame: int) -> AnyLaw | None:
    """The law of the run to which the file of particles or the species file belongs, if any.

    Args:
        path: of the particles.
        species: of the species file.
        frame: number of the frame: laws may change in a run.

    Raises:
        FileError: the run is damaged.
    """
    for file in (Path(path), Path(species)):
        if not (file.exists() and (file.parent / SUMMARY).exists()):
            continue
        if holds(folder := file.parent) != "compression":
            continue
        saved = summary_in(folder)
        if file.name == TRAJECTORY:
            number = frame if frame >= 0 else frames.frames_in(folder) + frame
            saved = frames.setup_of(frames.setups_in(folder), max(number, 0))
        with reading(folder / SUMMARY):
            return read_setup(saved).law
    return None
