"""The script by which LAMMPS takes up a saved packing by itself."""

from __future__ import annotations

from ..model.droplet import AnyLaw
from ..model.friction import Friction
from ..model.packing import Packing
from .data_file import Motion
from .films import film_commands
from .lammps_commands import law_commands, setup_commands, wall_commands
from .rubbing import friction_commands, spring_commands
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

{relaxing}# To let it move at constant energy{but}:
# timestep {moving!r}
{velocity}# fix move all {integrator}
{plane}# thermo 100
# run 1000
"""


_RELAXING = """# To relax it:
# minimize 0 1e-12 10000 20000

"""


def script(
    packing: Packing,
    law: AnyLaw,
    timestep: float,
    moving: float,
    motion: Motion,
    friction: Friction | None,
) -> str:
    """Text of a LAMMPS script that reads a saved packing and evaluates it.

    Args:
        packing: what is saved.
        law: its contact law.
        timestep: of a minimization [time].
        moving: time step of a motion at the temperature `TEMPERATURE` [time].
        motion: of the saved particles, with films and springs of contacts.
        friction: of the contacts, if they rub.
    """
    commands = law_commands(packing, law, SPECIES) + wall_commands(packing.walls)
    commands += film_commands(law, packing.walls, motion.films)
    commands += friction_commands(friction, len(packing.radii)) + spring_commands(motion.rubbing)
    commands += f"timestep {timestep!r}\n"
    setup = setup_commands(packing)
    velocity = "" if motion.moves else f"# velocity all create {TEMPERATURE!r} 12345\n"
    integrator = "nve/sphere disc" if friction else "nve"
    relaxing = "" if friction else _RELAXING  # minimizers pass over friction
    proposed = {
        "but": " (not with deformable/sector)" if packing.dimension == 2 else "",
        "moving": moving,
        "velocity": velocity,
        "integrator": integrator,
        "relaxing": relaxing,
        "plane": "# fix plane all enforce2d\n" if packing.dimension == 2 else "",
    }
    return _SCRIPT.format(script=SCRIPT, setup=setup, data=DATA, law=commands, **proposed).lstrip()
