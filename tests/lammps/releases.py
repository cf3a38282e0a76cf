"""Three scenes for any LAMMPS, and what they must give.

`python tests/lammps/releases.py` computes that anew, with the LAMMPS of this environment.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from programs import PATIENT

DATA = Path(__file__).parents[1] / "data"
EXPECTED = DATA / "release_cases.json"
PACKING = json.loads((DATA / "packing_cases.json").read_text())[0]
STATES = {"start": 0, "end": 200}  # steps before each

EDGE = PACKING["L"] + 0.55  # a room a little larger than the packing's box
PARTICLES = "\npair_coeff * * bubbles.deformable small large"  # a file of the package, by its name
STYLES = {
    # a tolerance so small that the way of the iteration does not show
    "packing": f"pair_style deformable/ring balance 1e-13 100{PARTICLES}\nvariable length equal 0",
    "container": f"""
pair_style deformable/ring contact radical{PARTICLES}
region walls block -0.55 {EDGE} -0.55 {EDGE} -0.5 0.5
fix walls all deformable/wall walls
compute contacts all deformable/contact
compute lengths all reduce sum c_contacts[4] inputs local
thermo_style custom step pe ke c_lengths
variable length equal c_lengths
""",
    "rings": """
pair_style deformable/edge 0.4
pair_coeff * * 3.0 0.15
bond_style harmonic
bond_coeff * 1.5 0.33
special_bonds lj 1 1 1
neigh_modify exclude molecule/intra all
comm_modify cutoff 1.6
fix area all deformable/polygon 2.0
variable length equal 0
""",
}
SCRIPT = """
units lj
dimension 2
boundary {boundary}
atom_style {atoms}
newton on
read_data {scene}.data
{styles}
neighbor 0.3 bin
thermo_modify norm no
fix move all nve
fix plane all enforce2d
timestep 0.02
"""
REPORT = """
run {steps}
print "$(pe:%.17g) $(ke:%.17g) $(v_length:%.17g)" file {scene}.{state}.energy
write_dump all custom {scene}.{state}.atoms x y fx fy modify sort id format float %.17g
"""


def polygon(vertices, radius, center):
    angle = 2 * np.pi * np.arange(vertices) / vertices
    return center + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def data_file(scene, first_id=1):
    """Text of a data file; the first atom and the first molecule have `first_id`."""
    if scene == "rings":
        rings = [polygon(11, 0.6, (1.2, 2.0)), polygon(17, 0.9, (2.66, 2.47))]
        x = np.concatenate(rings)
        molecules = [k for k, ring in enumerate(rings) for _ in ring]
        types, low, high = [1] * len(x), 0.0, 4.0
        start = np.cumsum([0, *map(len, rings)])
        bonds = [
            (start[k] + i, start[k] + (i + 1) % len(ring))
            for k, ring in enumerate(rings)
            for i in range(len(ring))
        ]
    else:
        x, types, molecules, bonds = np.array(PACKING["x"]), PACKING["type"], [], []
        low, high = (-0.55, EDGE) if scene == "container" else (0.0, PACKING["L"])
    lines = [f"{scene}\n", f"{len(x)} atoms", f"{max(types)} atom types"]
    if bonds:
        lines += [f"{len(bonds)} bonds", "1 bond types", "2 extra bond per atom"]
    lines += [f"{low!r} {high!r} {axis}lo {axis}hi" for axis in "xy"]
    lines += ["-0.5 0.5 zlo zhi", "\nMasses\n", *(f"{t} 1.0" for t in sorted(set(types)))]
    lines.append("\nAtoms\n")
    for i, (px, py) in enumerate(x.tolist()):
        molecule = f"{first_id + molecules[i]} " if molecules else ""
        lines.append(f"{first_id + i} {molecule}{types[i]} {px!r} {py!r} 0.0")
    lines.append("\nVelocities\n")
    lines += [
        f"{first_id + i} {0.01 * math.sin(i)!r} {0.01 * math.cos(2 * i)!r} 0.0"
        for i in range(len(x))
    ]
    if bonds:
        lines.append("\nBonds\n")
        lines += [f"{n} 1 {first_id + i} {first_id + j}" for n, (i, j) in enumerate(bonds, 1)]
    return "\n".join(lines) + "\n"


def evaluate(lmp, folder, *, first_id=1, before="", **environment):
    """Energies, positions and forces of all scenes with a program.

    lmp: its command line. before: the first command of the inputs.
    """
    folder.mkdir(exist_ok=True)
    found = {}
    for scene, styles in STYLES.items():
        (folder / f"{scene}.data").write_text(data_file(scene, first_id))
        script = before + SCRIPT.format(
            scene=scene,
            styles=styles,
            boundary="f f p" if scene == "container" else "p p p",
            atoms="bond" if scene == "rings" else "atomic",
        )
        for state, steps in STATES.items():
            script += REPORT.format(scene=scene, state=state, steps=steps)
        (folder / f"in.{scene}").write_text(script)
        done = subprocess.run(
            [*map(str, lmp), "-in", f"in.{scene}", "-log", "none"],
            cwd=folder,
            env=os.environ | PATIENT | environment,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        for state in STATES:
            energy = np.loadtxt(folder / f"{scene}.{state}.energy")
            atoms = np.loadtxt(folder / f"{scene}.{state}.atoms", skiprows=9)
            found[f"{scene}, {state}"] = {"energy": energy.tolist(), "atoms": atoms.tolist()}
    return found


def assert_same(found):
    """To 1e-12 of the largest number of each kind: energies, total contact length, x, y, fx, fy."""
    expected = json.loads(EXPECTED.read_text())
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        for kind, numbers in values.items():
            wanted, got = np.array(numbers), np.array(found[name][kind])
            scale = np.abs(np.atleast_2d(wanted)).max(axis=0)
            assert got.shape == wanted.shape, name
            error = np.abs(got - wanted) / np.where(scale > 0, scale, 1.0)
            assert error.max() < 1e-12, f"{name}, {kind}: {error.max():.1e}"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        results = evaluate([Path(sys.executable).parent / "lmp"], Path(folder))
    EXPECTED.write_text(json.dumps(results, indent=0) + "\n")
