"""Small, tilted and replicated boxes."""

from itertools import product

import numpy as np
import pytest
from closed_forms import polygon_stiffness
from contact_rows import of_compute_pair
from laws import DIRECT, EXACT, RADICAL, RING_LAWS, laws, two_laws
from parallel import finished
from scene import BOX, PACKINGS, SPECIES, Scene
from test_refusals import refuses
from turns import in_turn


@laws
def test_a_particle_that_touches_its_own_images(law):
    """One particle in a square cell: S = K a^2 of the square, a quarter of the overlap a side."""
    a, kA, radius = 0.01, 1.0, 0.5
    length = 2 * (radius - a)
    state = Scene(np.array([[0.2, 0.3]]), ["small"], (0, length, 0, length), EXACT[law])
    deficit = polygon_stiffness(4) * a**2
    assert state.evaluate().energy == pytest.approx(0.5 * kA * deficit**2, rel=1e-12)


SMALL_CELLS = {
    "two images of one neighbor": (np.array([[0.3, 0.3], [0.8, 1.1]]), (0, 0.98, 0, 1.68), 0.0),
    "two particles, tilted cell": (np.array([[0.3, 0.3], [0.7, 1.1]]), (0, 0.98, 0, 1.68), -0.2),
}


@pytest.mark.parametrize(("cell", "law"), in_turn(SMALL_CELLS, ["radical", "balanced"]))
def test_cells_smaller_than_their_particles(cell, law):
    """Neighbors that are images of the particle or of one other: the same as 2 x 2 cells."""
    (x, box, tilt), style = SMALL_CELLS[cell], EXACT[law]
    small = Scene(x, ["small"] * len(x), box, style, tilt=tilt).evaluate()
    across, up = np.array([box[1], 0]), np.array([tilt, box[3]])
    x4 = np.vstack([x + k * across + m * up for k in (0, 1) for m in (0, 1)])
    box4 = (0, 2 * box[1], 0, 2 * box[3])
    large = Scene(x4, ["small"] * len(x4), box4, style, tilt=2 * tilt).evaluate()
    assert small.energy > 1e-5
    # coordinates of the larger box are rounded to 4e-16, indentations are 0.01, U ~ a^4; a force
    # is a sum of several that balance to 1e-12
    assert large.energy == pytest.approx(4 * small.energy, rel=1e-12)
    np.testing.assert_allclose(large.atom_energy, np.tile(small.atom_energy, 4), rtol=1e-12)
    atol = (1e-12 if law in DIRECT else 1e-11) * np.abs(small.atom_virial).max()
    np.testing.assert_allclose(large.force, np.tile(small.force, (4, 1)), rtol=0, atol=atol)
    np.testing.assert_allclose(large.virial, 4 * small.virial, rtol=0, atol=atol)


SOFT = "harmonic/cut"


@two_laws
def test_types_of_another_style_have_no_results(law):
    """Also if the particle was of a type of this style before."""
    case, style = PACKINGS[0], EXACT[law]
    scene = Scene.packing(
        case,
        f"hybrid {style} {SOFT}",
        coeff=(
            f"pair_coeff * * {style.split()[0]} {SPECIES} small NULL\n"
            f"pair_coeff * 2 {SOFT} 0.02 1.2"
        ),
    )
    assert scene.evaluate().shape["area"][0] > 0
    scene.run("set atom 1 type 2")
    for values in scene.evaluate().shape.values():
        assert values[0] == 0


def test_species_without_particles_do_not_narrow_the_reach(tmp_path):
    """A tiny species without particles does not reduce the depth that a reach covers."""
    file = tmp_path / "species"
    file.write_text("# UNITS: lj\nunit 1 1 inf\ntiny 0.01 1 inf\n")
    x, species = np.array([[0.0, 0.0], [1.9, 0.0]]), ["unit", "unit"]
    bulges = []
    for types, names in ((1, "unit"), (2, "unit tiny")):
        scene = Scene(x, species, BOX, RADICAL)
        scene.run(
            "clear\nunits lj\ndimension 2\nregion box block -3 3 -3 3 -0.5 0.5\n"
            f"create_box {types} box\nmass * 1\ncreate_atoms 1 single 0 0 0\n"
            f"create_atoms 1 single 1.9 0 0\npair_style {RADICAL}\n"
            f"pair_coeff * * {file} {names}\ncompute pair all pair deformable/ring\n"
            "thermo_style custom step pe c_pair[1] c_pair[2]\nrun 0"
        )
        bulges.append(scene.vector("pair", 2)[1])
    assert bulges[0] == bulges[1] > 0


# ---- a particle in a box smaller than itself: right, or refused ----


CELLS = {"square": (1, (0.0, 0.0)), "tilted": (1, (0.3, 0.0)), "long": (3, (0.0, 0.0))}


def cells(law, length, shape="square", copies=1, species="small"):
    """One particle of diameter 1 in a periodic cell, or copies^2 such cells."""
    ratio, (tilt, _) = CELLS[shape]
    width, height = length, ratio * length
    x = [
        [(0.2 + i) * width + tilt * j * width, (0.3 + j) * height]
        for i in range(copies)
        for j in range(copies)
    ]
    box = (0, copies * width, 0, copies * height)
    # outlines whose lines tilt bulge further in cells far beyond confluence
    style = f"{EXACT[law]} reach 0.5" if (law, length) == ("curved", 0.72) else EXACT[law]
    return Scene(x, [species] * len(x), box, style, tilt=copies * tilt * width)


CASES = in_turn(product(RING_LAWS, [0.99, 0.9, 0.8, 0.72]), CELLS)


@pytest.mark.parametrize(("law", "length", "shape"), [*CASES, ("balanced", 1.35, "tilted")])
def test_same_as_four_cells(law, shape, length):
    """Energy, forces and stress of images are those of particles of their own.

    Beyond confluence lines that tilt differently in the four cells may take less energy: whether
    they leave the symmetric state, which is a saddle then, depends on the last digits. They may not
    come to balance either: the energy is off by the square of what is left, or refused.
    """
    scenes = [cells(law, length, shape, copies) for copies in (1, 2)]
    one = scenes[0].evaluate()
    if law == "curved" and length == 0.8:
        try:
            four = scenes[1].evaluate()
        except Exception as error:
            if "Contacts are not balanced" not in str(error):
                raise
            return
    four = scenes[1].evaluate()
    assert (one.energy > 0) == (length < 1)
    if law == "curved" and length < 0.9:
        imbalance = of_compute_pair(scenes[1])[1]
        assert 0 < four.energy <= 4 * one.energy * (1 + 1e-11 + 10 * imbalance**2)
        return
    assert four.energy == pytest.approx(4 * one.energy, rel=1e-11)
    atol = 1e-11 * max(np.abs(one.virial).max(), 1e-20)
    np.testing.assert_allclose(four.virial, 4 * one.virial, rtol=0, atol=atol)
    np.testing.assert_allclose(four.force, 0, rtol=0, atol=atol)


def test_an_image_at_the_end_of_the_neighbor_list():
    """0.8 x 2 = 1.3 + 0.3: of the two images at that distance only one is in the list."""
    assert cells("balanced", 0.8, "tilted").evaluate().energy == pytest.approx(
        cells("radical", 0.8, "tilted").evaluate().energy, rel=1e-12
    )


@two_laws
def test_no_area_left(law):
    """The area of the ring would be negative: -1.22 of the box at a length of 0.6."""
    with refuses("Atom 1 of radius 0.5 .*own images.*0.6 x 0.6"):
        cells(law, 0.6).energy()


@two_laws
def test_others_may_be_beyond_the_model(law):
    """Past confluence the energy is finite, and the style warns, as it does in larger boxes."""
    state = cells(law, 0.7).evaluate()
    assert state.beyond == 1
    assert 0 < state.shape["area"][0] < 0.7**2


@two_laws
def test_ranks(law, tmp_path):
    """The images of a particle belong to its own rank or to the other one."""
    energies = [
        float(
            finished(ranks, SCRIPT.format(style=EXACT[law]), tmp_path)
            .split("energy ")[1]
            .split()[0]
        )
        for ranks in (1, 2)
    ]
    assert energies[0] > 1e-6
    assert energies[1] == pytest.approx(energies[0], rel=1e-11)


SCRIPT = f"""
units lj
dimension 2
newton on
atom_modify map yes
region box block 0 0.98 0 1.68 -0.5 0.5
create_box 2 box
create_atoms 1 single 0.3 0.3 0
create_atoms 2 single 0.8 1.15 0
mass * 1.0
pair_style {{style}}
pair_coeff * * {SPECIES} small weak
neighbor 0.3 bin
thermo_modify norm no
run 0
variable energy equal pe
print "energy $(v_energy:%.17g)" screen yes
"""
