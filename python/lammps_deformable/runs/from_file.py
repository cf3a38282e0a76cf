"""States of particles in a dump of LAMMPS, with the species file of its pair style."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import potentials
from ..common.checks import expect, shown, whole
from ..common.errors import FileError, LackingWarning, ParameterError, warn
from ..common.files import at_home, reading
from ..common.ranks import alone
from ..engine.lammps import close_lammps, run, silent_lammps
from ..engine.simulation import Simulation
from ..formats.particle_files import read_particles
from ..formats.store import (
    SUMMARY,
    TRAJECTORY,
    frames_in,
    holds,
    read_setup,
    setup_of,
    setups_in,
    summary_in,
)
from ..particles.columns import UNTYPED, Particles
from ..particles.laws import ALL_LAWS, AnyLaw, Droplet, Ring, Sector, SoftContact, SpeciesParameters
from ..particles.packing import packing_of_particles, packing_of_species

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..particles.walls import Wall
    from ..state.state import State

# Part of the mean overlap that rounding of positions may change without a warning.
_ROUNDED = 0.01

# The law of files that do not tell.
_UNTOLD = "balanced"


def state_in_file(
    path: str | Path,
    species: str | Path,
    law: str | None = None,
    types: Sequence[str] | Mapping[Any, str] | None = None,
    frame: int = -1,
    radii: str | None = None,
    walls: Wall | Sequence[Wall] = (),
    box: ArrayLike | None = None,
) -> State:
    """See `State.from_file`."""
    expect("path", path, str, Path)
    expect("species", species, str, Path)
    path, species = at_home(path), at_home(species)
    expect("radii", radii, str, type(None))
    expect("law", law, str, type(None))
    frame = whole("frame", frame)
    given = types.values() if isinstance(types, Mapping) else [] if types is None else types
    if not isinstance(given, Iterable) or not all(isinstance(name, str) for name in given):
        raise ParameterError(f"types must be names of species, not {shown(types)}")
    told = law_of_run(path, species, frame) if law is None else None
    law = law or (told.name if told else _UNTOLD)
    if law not in ALL_LAWS:
        raise ParameterError(f"law must be {', '.join(ALL_LAWS)}, not {law}")
    file = species
    if not file.exists() and (potentials / file).exists():
        file = potentials / file
    if not file.exists() or file.is_dir():
        there = file.parent
        hint = f": ld.Run('{there}') has the states of its run" if holds(there) == "run" else ""
        raise FileError(f"there is no species file '{species}'{hint}")
    own, dimension = 1.0 if radii is None else radii, ALL_LAWS[law].dimension
    found = read_particles(path, frame, None, () if radii is None else (radii,))
    found, names = with_species(found, path, file, types)
    packing = packing_of_particles(found, path, own, walls, box, dimension)
    number = len(packing.species_radii)
    if number > len(names):
        raise ParameterError(
            f"'{path}' has particles of type {number}, but the species of {len(names)} types are "
            f"named: {', '.join(names)}"
        )
    if number == 1 < len(names) and not found.typed:
        raise FileError(f"'{path}': {UNTYPED}, or the one species of all, such as {names[0]}")
    sizes, chosen = read_species(file, names[:number], law)
    if isinstance(told, Ring) and isinstance(chosen, Ring):  # no species file has the reach
        chosen = replace(chosen, reach=told.reach)
    if radii is None:
        packing = packing_of_species(
            packing.positions, packing.species, sizes, packing.box, walls=packing.walls
        )
    missing = int(found.ids.max()) - len(found.ids)
    if missing > 0:
        warn(
            f"'{path}' has {len(found.ids)} particles, whose IDs go up to {found.ids.max()}: "
            "contacts with those that are left out, as in a dump of a group, are not in the state",
            LackingWarning,
        )
    with Simulation(packing, chosen, comm=alone()) as sim:
        state = sim.state()
    warn_of_digits(state, path, found.step)
    return state


def with_species(
    found: Particles,
    path: str | Path,
    file: Path,
    types: Sequence[str] | Mapping[Any, str] | None,
) -> tuple[Particles, list[str]]:
    """The particles with the numbers of species as types, and the names of these species.

    Args:
        found: what is in the file of particles.
        path: of this file.
        file: a species file.
        types: see `State.from_file`.

    Raises:
        ParameterError: it is unknown which type has which species.
        FileError: the species file cannot be read.
    """
    if types is not None and not isinstance(types, Mapping):
        names = [types] if isinstance(types, str) else list(types)
    else:
        names = species_names(file)
    told = sorted({*found.types.tolist()}, key=str) if found.typed else []
    if types is None and found.names and {*told} <= {*names}:
        types = {name: name for name in names}
    if isinstance(types, Mapping):
        given = {str(kind): species for kind, species in types.items()}
        lacking = [kind for kind in told if str(kind) not in given]
        if lacking:
            raise ParameterError(
                f"'{path}' has particles of type {lacking[0]}, and types has "
                f"{', '.join(given) or 'none'} only"
            )
        names = list(dict.fromkeys(given.values()))
        number = {kind: names.index(species) + 1 for kind, species in given.items()}
        numbers = [number[str(kind)] for kind in found.types.tolist()]
        return replace(found, types=np.array(numbers), names=(), count=0), names
    if found.names and not found.numbered and not (len(told) == 1 == len(names)):
        example = ", ".join(f"{kind!r}: ..." for kind in told)
        raise ParameterError(
            f"'{path}' has names of types, {', '.join(told)}, and which species they are is not "
            f"known: give one of {', '.join(species_names(file))} for each, types={{{example}}}"
        )
    return found, names


def warn_of_digits(state: State, path: str | Path, step: float) -> None:
    """Warn of a file whose positions have fewer digits than the overlaps need.

    Distances of centers, whose coordinates are rounded to multiples of h, are wrong by h/sqrt(6),
    root mean square.

    Args:
        state: of the particles in the file.
        path: of the file.
        step: h, 0 if nothing is rounded [length].
    """
    table = state.contacts
    if step == 0.0 or len(table) == 0:
        return
    radii = np.append(state.packing.radii, 0.0)  # of walls
    overlap = radii[table["i"]] + radii[np.maximum(table["j"], -1)] - table["distance"]
    mean, error = float(np.abs(overlap).mean()), step / np.sqrt(6.0)
    if error > _ROUNDED * mean:
        warn(
            f"'{path}' has positions rounded to {step:.0e}, and overlaps are {mean:.1e}: these and "
            f"single forces are off by {100.0 * error / mean:.2g} %. Write more digits, in LAMMPS "
            "by dump_modify ID format float %20.15g",
            LackingWarning,
        )


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
        if holds(folder := file.parent) != "run":
            continue
        saved = summary_in(folder)
        if file.name == TRAJECTORY:
            number = frame if frame >= 0 else frames_in(folder) + frame
            saved = setup_of(setups_in(folder), max(number, 0))
        with reading(folder / SUMMARY):
            law = read_setup(saved).law
            return None if isinstance(law, SoftContact) else law
    return None


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
    lmp = silent_lammps(alone())
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
