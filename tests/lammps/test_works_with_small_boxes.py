"""A particle in a box smaller than itself: right, or refused."""

from itertools import product

import numpy as np
import pytest
from contact_rows import of_compute_pair
from laws import EXACT, RING_LAWS, two_laws
from parallel import finished
from scene import SPECIES, Scene
from test_refusals import refuses
from turns import in_turn

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
    come to balance either: the energy is off by the square of what is left.
    """
    scenes = [cells(law, length, shape, copies) for copies in (1, 2)]
    one, four = (scene.evaluate() for scene in scenes)
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
