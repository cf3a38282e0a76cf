"""Small, tilted and replicated boxes; hybrid pair styles."""

import numpy as np
import pytest
from closed_forms import polygon_stiffness
from laws import DIRECT, EXACT, RADICAL, laws, two_laws
from scene import BOX, PACKINGS, SPECIES, Scene


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


@two_laws
@pytest.mark.parametrize(("x", "box", "tilt"), SMALL_CELLS.values(), ids=SMALL_CELLS)
def test_cells_smaller_than_their_particles(law, x, box, tilt):
    """Neighbors that are images of the particle or of one other: the same as 2 x 2 cells."""
    style = EXACT[law]
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


@two_laws
def test_a_cell_tilted_by_its_width_is_the_same_lattice(law):
    case = PACKINGS[0]
    upright = Scene.packing(case, EXACT[law]).evaluate()
    tilted = Scene.packing(case, EXACT[law], tilt=case["L"]).evaluate()
    # the tilt rounds coordinates to 1e-15 and so indentations of 0.01 to 1e-13
    assert tilted.energy == pytest.approx(upright.energy, rel=1e-12)
    atol = 1e-12 * np.abs(upright.force).max()
    np.testing.assert_allclose(tilted.force, upright.force, rtol=0, atol=atol)
    np.testing.assert_allclose(tilted.virial, upright.virial, rtol=1e-11)


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
