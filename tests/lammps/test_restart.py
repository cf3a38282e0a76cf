"""Runs that continue from a file."""

import numpy as np
import pytest
from lammps import lammps
from laws import DIRECT, EXACT, LAWS
from materials import packing, spread
from parallel import in_process
from scene import HEADER, MEASURE, PACKINGS, SPECIES, Scene
from turns import in_turn

FILES = {
    "restart": ("write_restart {file}", "read_restart {file}"),
    "data": ("write_data {file} nofix", HEADER.format(boundary="p p p") + "read_data {file}"),
}
RUN = "neighbor 0.3 bin\nfix move all nve\ntimestep 0.02"
SPECIES_OF = {
    "perimeter conserved": "small large",
    "droplets": "drop droplarge",
    "radii of atoms": "any",
}
CASES = [(law, kind) for law in LAWS for kind in SPECIES_OF if law != "sector" or kind[0] != "d"]


class Continued(Scene):
    """A scene from a file."""

    def __init__(self, read, style, species="small large"):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(read)
        self.run(f"pair_style {style}\npair_coeff * * {SPECIES} {species}\n{RUN}")
        self.run(MEASURE.format(style=style.split()[0]))


@pytest.mark.parametrize(("law", "material", "kind"), in_turn(CASES, FILES))
def test_round_trip(law, material, kind, tmp_path):
    (write, read), file, case, style = FILES[kind], tmp_path / "file", PACKINGS[0], EXACT[law]
    scene = packing(case, style, material, commands=RUN)
    scene.run("velocity all create 1e-4 4711 loop all\nrun 20")
    scene.run(write.format(file=file))
    scene.run("run 20")
    species = SPECIES_OF[material]
    if species == "any":
        style, read = f"{style} radius atom", read.replace("atomic", "sphere")
    continued = Continued(read.format(file=file), style, species)
    if species == "any":  # LAMMPS writes 16 digits into data files
        np.testing.assert_allclose(continued.radii, spread(case), rtol=1e-15)
    continued.run("run 20")
    expected, found = scene.evaluate(), continued.evaluate()
    # both files hold every digit; the order of neighbors, and so of sums, is new. Balanced forces
    # are known to 1e-12 of the largest, and droplets are stiff.
    atol = 1e-13 if law in DIRECT and material != "droplets" else 1e-11
    np.testing.assert_allclose(continued.x, scene.x, rtol=0, atol=atol)
    assert found.energy == pytest.approx(expected.energy, rel=1e-11)
    atol = 100 * atol * np.abs(expected.force).max()
    np.testing.assert_allclose(found.force, expected.force, rtol=0, atol=atol)


def test_coefficients_are_not_kept(tmp_path):
    """A restart file holds no parameters: without pair_coeff the run stops."""
    file, law = tmp_path / "file", "radical"
    Scene.packing(PACKINGS[0], LAWS[law]).run(f"run 0\nwrite_restart {file}")
    again = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    again.commands_string(f"read_restart {file}\npair_style {LAWS[law]}")
    with pytest.raises(Exception, match=r"pair_coeff|[Pp]air coeffs"):
        again.command("run 0")


BEGIN = """units lj
dimension 2
atom_style sphere
boundary p f p
region box block 0 8 -1 8 -0.5 0.5
create_box 1 box
create_atoms 1 single 4 2 0
create_atoms 1 single 4 5 0
set group all diameter 2.0
set group all mass 1.0
"""
PROBLEM = """
pair_style deformable/ring contact curved
pair_coeff * * species drop
fix floor all deformable/wall plane 0 0 0 1
fix move all nve/sphere disc
fix rub all deformable/friction 0.5 1 0
"""
# what is written otherwise after read_restart, and what the warning says
OTHERWISE = {
    "law": (
        *("contact curved", "contact curved radius atom"),
        "law of type 1 was 'deformable/ring contact curved', is "
        "'deformable/ring contact curved radius atom'",
    ),
    "file": (
        *("* species", "* other"),
        "adhesion of types 1 and 1 was '0.2', is 'none'; type 1 was "
        "'drop radius 1 kA 2 kP 0 skin 0 tension 1', is 'drop radius 1 kA 3 kP 0 skin 0 tension 1'",
    ),
    "friction": (
        *("0.5 1 0", "0.4 1 0"),
        "fix rub all deformable/friction was '0.5 1 0', is '0.4 1 0'",
    ),
    "wall": (
        *("plane 0 0 0 1", "plane 0 0.1 0 1"),
        "fix floor all deformable/wall was 'plane 0 0 0 1', is 'plane 0 0.1 0 1'",
    ),
    "no wall": (
        *("fix floor", "# fix floor"),
        "fix floor all deformable/wall was 'plane 0 0 0 1', is 'none'",
    ),
    "group": (
        *("fix rub all", "group some id 1\nfix rub some"),
        "fix rub all deformable/friction was '0.5 1 0', is 'none'; "
        "fix rub some deformable/friction was 'none', is '0.5 1 0'",
    ),
    "spelling": ("0.5 1 0", "0.50 1.0 0e0", ""),
}


def test_another_problem_is_told(tmp_path):
    """Once, in the first run after read_restart; nothing about the same problem."""
    (tmp_path / "species").write_text("drop 1.0 2.0 0 tension 1\nadhesion drop drop 0.2\n")
    (tmp_path / "other").write_text("drop 1.0 3.0 0 tension 1\n")
    in_process(BEGIN + PROBLEM + "run 1\nwrite_restart file\n", tmp_path)
    for now, otherwise, differences in [("", "", ""), *OTHERWISE.values()]:
        problem = PROBLEM.replace(now, otherwise) if now else PROBLEM
        output = in_process(f"read_restart file\n{problem}\nrun 1\nrun 1\n", tmp_path)
        told = [line for line in output.splitlines() if "another problem" in line]
        assert len(told) == bool(differences)
        assert all(f"another problem: {differences} (src" in line for line in told)


def test_atoms_deleted_after_read_restart(tmp_path):
    """LAMMPS mixes up what atoms remember if they are deleted before it knows who remembers."""
    (tmp_path / "species").write_text("drop 1.0 2.0 0 tension 1\nadhesion drop drop 0.2\n")
    in_process(BEGIN + PROBLEM + "run 1\nwrite_restart file\n", tmp_path)
    delete, run = (
        "group gone id 1\ndelete_atoms group gone\n",
        "thermo_style custom step pe\nrun 1\n",
    )
    in_process(f"read_restart file\n{PROBLEM}{delete}{run}", tmp_path)
    message = "the restart file has 2 atoms, but there are 1. .*: create and delete atoms after"
    with pytest.raises(Exception, match=message):
        in_process(f"read_restart file\n{delete}{PROBLEM}{run}", tmp_path)
