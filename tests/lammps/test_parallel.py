"""Any number of ranks, in any grid, gives the same answers from the same data file."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scene import HEADER, MEASURE, PACKINGS, SPECIES, Scene

STYLES = {
    "sector": ("deformable/sector", "small large"),
    "radical": ("deformable/ring contact radical reach 0.3", "small large"),
    "radical, any stiffness": ("deformable/ring contact radical reach 0.3", "fixed skinned"),
}
GRIDS = {1: ["1 1 1"], 2: ["2 1 1", "1 2 1"], 4: ["2 2 1", "4 1 1"]}
# Waiting ranks give way: without it, more ranks than cores take a hundred times as long.
PATIENT = {
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE": "1",
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT": "16",
}
KINDS = {"scalars": 0, "atoms": 9}  # lines of their headers

SCRIPT = (
    HEADER.format(boundary="{boundary}").replace("atomic", "{atoms}")
    + """
processors {grid}
read_data {data}
pair_style {style}
pair_coeff * * {species}
neighbor 0.3 bin
{commands}
"""
    + MEASURE.replace("{style}", "{name}")
    + """
fix move all nve
timestep 0.02
"""
)

REPORT = """
run {steps}
print "$(pe:%.17g) $(c_virial[1]:%.17g) $(c_virial[2]:%.17g) $(c_virial[4]:%.17g) &
$(c_pair[1]:%.17g) $(c_pair[2]:%.17g)" file {out}.scalars
write_dump all custom {out}.atoms id x y fx fy c_energy c_stress[1] c_stress[2] c_stress[4] &
f_shape[*] modify sort id format float %.17g
"""


def lmp(ranks, script, folder):
    """Run `lmp` on an input script; its standard output."""
    (folder / "in.script").write_text(script)
    bin_folder = Path(sys.executable).parent
    command = [bin_folder / "lmp", "-in", "in.script", "-log", "none"]
    if ranks > 1:
        command = [bin_folder / "mpiexec", "-n", str(ranks), *command]
    return subprocess.run(
        command,
        cwd=folder,
        env=os.environ | PATIENT,
        capture_output=True,
        text=True,
        timeout=120,
    )


def run(ranks, grid, folder, atoms="atomic", **fields):
    folder.mkdir()
    steps = "".join(REPORT.format(steps=s, out=f"after{s}") for s in (0, 20))
    result = lmp(ranks, SCRIPT.format(grid=grid, atoms=atoms, **fields) + steps, folder)
    assert result.returncode == 0, result.stdout + result.stderr
    return {
        s: [np.loadtxt(folder / f"after{s}.{kind}", skiprows=skip) for kind, skip in KINDS.items()]
        for s in (0, 20)
    }


EDGE = PACKINGS[0]["L"] + 0.55  # a room a little larger than the packing's box
SCENES = {
    "dense": ("p p p", ""),
    # most particles that touch have one contact, some of them across the border of two ranks
    "loose": ("p p p", "change_box all x scale 1.05 y scale 1.05 remap"),
    "walls": (
        "f f p",
        f"""
change_box all x final -0.55 {EDGE} y final -0.55 {EDGE}
region walls block -0.55 {EDGE} -0.55 {EDGE} -0.5 0.5
fix walls all deformable/wall walls
fix_modify walls virial yes
""",
    ),
}


@pytest.mark.parametrize(("style", "names"), STYLES.values(), ids=STYLES)
@pytest.mark.parametrize(("boundary", "commands"), SCENES.values(), ids=SCENES)
def test_ranks_and_grids(style, names, boundary, commands, tmp_path):
    fields = {
        "style": style,
        "name": style.split()[0],
        "species": f"{SPECIES} {names}",
        "data": tmp_path / "data",
        "boundary": boundary,
        "commands": commands,
    }
    scene = Scene.packing(PACKINGS[0], style, boundary=boundary)
    scene.run("velocity all create 1e-4 4711 loop all")
    scene.run(f"write_data {fields['data']} nofix")
    runs = {
        (ranks, grid): run(ranks, grid, tmp_path / grid.replace(" ", ""), **fields)
        for ranks, grids in GRIDS.items()
        for grid in grids
    }
    reference = runs.pop((1, "1 1 1"))
    assert reference[0][0][0] > 1e-6
    for grid, found in runs.items():
        for steps, (scalars, atoms) in reference.items():
            name = f"{grid} after {steps} steps"
            np.testing.assert_allclose(found[steps][0], scalars, rtol=1e-12, err_msg=name)
            scale = 1e-12 * np.abs(atoms).max(axis=0)
            assert (np.abs(found[steps][1] - atoms) <= scale).all(), name


def test_errors_end_all_ranks(tmp_path):
    """A species file is read by one rank: all of them stop where it is missing."""
    data = tmp_path / "data"
    Scene.packing(PACKINGS[0], "deformable/ring contact radical").run(f"write_data {data} nofix")
    script = SCRIPT.format(
        atoms="atomic",
        boundary="p p p",
        grid="2 1 1",
        data=data,
        style="deformable/ring contact radical",
        name="deformable/ring",
        species="nowhere.txt small large",
        commands="",
    )
    result = lmp(2, script, tmp_path)
    assert result.returncode != 0
    assert "Cannot open the species file 'nowhere.txt'" in result.stdout + result.stderr
