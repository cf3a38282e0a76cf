"""The script by which LAMMPS takes up a saved packing by itself."""

from __future__ import annotations

from ..model.laws import Law
from ..model.packing import Packing
from .films import Films, film_commands
from .lammps_commands import law_commands, setup_commands, wall_commands
from .run_folder import DATA, SCRIPT, SPECIES

# Of the motion that the comments of a script propose [energy].
TEMPERATURE = 1e-8

_SCRIPT = """
# A packing saved by lammps-deformable. Run it in this folder: lmp -in {script}
# Later saves replace this file: copy it before you change it.
{setup}
read_data {data}
{law}
thermo_style custom step pe ke press
thermo_modify norm no format float %.16g
run 0

# To relax it:
# minimize 0 1e-12 10000 20000

# To let it move at constant energy (not with deformable/sector):
# timestep {moving!r}
{velocity}# fix move all nve
# fix plane all enforce2d
# thermo 100
# run 1000
"""


def script(
    packing: Packing,
    law: Law,
    timestep: float,
    moving: float,
    moves: bool = False,
    films: Films | None = None,
) -> str:
    """Text of a LAMMPS script that reads a saved packing and evaluates it.

    Args:
        packing: what is saved.
        law: its contact law.
        timestep: of a minimization [time].
        moving: time step of a motion at the temperature `TEMPERATURE` [time].
        moves: whether the saved particles have velocities.
        films: that there are, if particles stick.
    """
    commands = law_commands(packing, law, SPECIES) + wall_commands(packing.walls)
    commands += film_commands(law, packing.walls, films)
    commands += f"timestep {timestep!r}\n"
    setup = setup_commands(packing)
    velocity = "" if moves else f"# velocity all create {TEMPERATURE!r} 12345\n"
    motion = {"moving": moving, "velocity": velocity}
    return _SCRIPT.format(script=SCRIPT, setup=setup, data=DATA, law=commands, **motion).lstrip()
