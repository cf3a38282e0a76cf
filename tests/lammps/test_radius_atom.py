"""Radii of atom_style sphere: pair_style deformable/... radius atom."""

import numpy as np
import pytest
from combinations import Packing
from contact_rows import CONTACTS, contacts
from laws import EXACT, LAWS, RADICAL, two_laws
from materials import MATERIALS, radii_of, spread
from scene import BOX, FOUR, PACKINGS, ROOM_OF_FOUR, SPECIES, Scene
from test_refusals import refuses, two_particles

BALANCED = "deformable/ring contact balanced reach 0.3 balance 1e-12 100"
styles = pytest.mark.parametrize("style", [RADICAL, BALANCED])


def by_atom(case, style, radii, species=("any", "any"), **options):
    return Scene.packing(case, f"{style} radius atom", species, radii=radii, **options)


def assert_alike(found, expected, tolerance, style=""):
    """Two states agree to `tolerance` of the largest value of each kind; 0: to the last bit.

    Counts of contacts may differ otherwise: some forces are tiny. Forces of balanced contacts are
    known to 1e-12 of the largest. They go as the cube of the length, so that lengths may be off by
    the cube root of that.
    """
    for name in ("energy", "virial", "force", "atom_energy", "atom_virial", "bulge"):
        a, b = (np.asarray(getattr(state, name)) for state in (found, expected))
        np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * np.abs(b).max(), err_msg=name)
    for name, values in expected.shape.items():
        if name == "contacts" and tolerance > 0.0:
            continue
        atol = (1e-4 if style == BALANCED else tolerance) * np.abs(values).max()
        np.testing.assert_allclose(found.shape[name], values, rtol=0, atol=atol, err_msg=name)


# ---- a mixture of types is one of atoms ----

PAIRS = [
    (LAWS["sector"], "area conserved"),
    (RADICAL, "finite stiffness"),
    (BALANCED, "a skin beside kP = inf"),
]


@pytest.mark.parametrize(("style", "material"), PAIRS)
def test_radii_of_the_types(style, material):
    """The same cutoffs and thus the same sums, to the last bit."""
    case, species = PACKINGS[1], MATERIALS[material]
    expected = Scene.packing(case, style, species, commands=CONTACTS)
    found = by_atom(case, style, radii_of(case), species, commands=CONTACTS)
    assert_alike(found.evaluate(), expected.evaluate(), 0.0)
    rows, known = contacts(found), contacts(expected)
    for name, column in known.items():
        np.testing.assert_array_equal(rows[name], column)


@styles
def test_one_type_for_all(style):
    """The cutoff is larger, and neighbors come in another order.

    Indentations of 0.01 are known to 1e-14 of themselves, sums of canceling forces to 1e-13.
    """
    case = PACKINGS[1]
    expected = Scene.packing(case, style).evaluate()
    found = by_atom(case, style, radii_of(case)).evaluate()
    assert_alike(found, expected, 1e-10 if style == BALANCED else 1e-12, style)


def test_small_atoms_narrow_the_reach():
    """A tiny particle far away, by type, by atom, and none."""
    x = np.array([[0.0, 0.0], [1.36, 0.0], [0.5, 2.0]])
    bulges = [
        Scene(x, species, BOX, f"{RADICAL}{words}", radii=radii).evaluate().bulge
        for words, species, radii in (
            ("", ["large", "large", "tiny"], None),
            (" radius atom", ["any"] * 3, [0.7, 0.7, 0.12]),
            (" radius atom", ["any"] * 3, [0.7, 0.7, 0.7]),
        )
    ]
    assert bulges[0] == bulges[1] > bulges[2] > 0


@styles
def test_walls(style):
    """Four particles of four sizes that touch each other and the wall."""
    radii = np.array([0.5, 0.49, 0.505, 0.497])
    options = {"boundary": "f f p", "commands": ROOM_OF_FOUR + CONTACTS, "radii": radii}
    found = contacts(Scene(FOUR, ["any"] * 4, BOX, f"{style} radius atom", **options))
    wall = found["partner"] < 0
    assert wall.sum() == 8
    i, turn = found["atom"][wall].astype(int) - 1, np.rint(found["angle"][wall] / (np.pi / 2))
    side = turn.astype(int) % 4  # right, up, left, down
    height = np.array([0.97, 0.967, 0.965, 0.96])[side] - np.abs(FOUR[i, side % 2])
    np.testing.assert_allclose(found["indentation"][wall], radii[i] - height, rtol=0, atol=1e-15)


# ---- beside others ----


def test_types_of_another_style_need_no_radius():
    case, style = PACKINGS[0], RADICAL
    coeff = (
        f"pair_coeff * * {style.split()[0]} {SPECIES} {{}} NULL\n"
        f"pair_coeff * 2 harmonic/cut 0.02 1.2"
    )
    expected, found = (
        Scene.packing(
            case, f"hybrid {style} {words} harmonic/cut", coeff=coeff.format(name), radii=radii
        ).evaluate()
        for words, name, radii in (
            ("", "small", None),
            ("radius atom", "any", np.where(np.array(case["type"]) == 1, 0.5, 0.0)),
        )
    )
    assert_alike(found, expected, 1e-12)


def test_radii_of_types_are_the_default():
    """atom_style sphere alone changes nothing."""
    case = PACKINGS[0]
    expected = Scene.packing(case, RADICAL).evaluate()
    for words in ("", " radius type"):
        scene = Scene.packing(case, f"{RADICAL}{words}", radii=np.full(case["N"], 0.1))
        assert_alike(scene.evaluate(), expected, 0.0)
    scene.run(f"pair_style {RADICAL} radius atom")
    scene.run(f"pair_coeff * * {SPECIES} small large")
    assert scene.energy() == 0.0
    scene.run(f"pair_style {RADICAL}\npair_coeff * * {SPECIES} small large")
    assert scene.energy() == expected.energy


# ---- radii that change ----


@styles
def test_radii_set_between_runs(style):
    case = PACKINGS[1]
    scene = by_atom(case, style, spread(case))
    scene.evaluate()
    scene.run("\n".join(f"set atom {n} diameter {2 * r}" for n, r in enumerate(radii_of(case), 1)))
    expected = by_atom(case, style, radii_of(case)).evaluate()
    # what a balanced call begins with is not the same
    assert_alike(scene.evaluate(), expected, 1e-10 if style == BALANCED else 1e-14, style)


GROWTH = """
variable growth equal 1+0.001*step
fix grow all adapt 1 atom diameter v_growth scale yes
run 10 post no
"""


@styles
def test_radii_that_grow(style):
    """fix adapt: every step sees the radii of that step, also those of ghosts."""
    case, start = PACKINGS[0], 0.99 * radii_of(PACKINGS[0])
    scene = by_atom(case, style, start)
    scene.run(GROWTH)
    energy, force = scene.lmp.get_thermo("pe"), scene.gather("f", 3)[:, :2]
    expected = by_atom(case, style, 1.01 * start).evaluate()
    assert energy == pytest.approx(expected.energy, rel=1e-10)
    atol = 1e-10 * np.abs(force).max()
    np.testing.assert_allclose(force, expected.force, rtol=0, atol=atol)


def test_radii_that_outgrow_their_species():
    """The error comes in the second step, when the radius is too large."""
    scene = by_atom(PACKINGS[0], RADICAL, np.where(np.arange(24) == 16, 0.799, 0.2))
    with refuses("Atom 17 .*0.800598.*species any.*0.8 at most"):
        scene.run(GROWTH)
    assert scene.lmp.get_thermo("step") == 2


# ---- radii that are not allowed ----


def test_atoms_without_radii():
    lmp = two_particles()
    lmp.command(f"pair_style {RADICAL} radius atom")
    lmp.command(f"pair_coeff * * {SPECIES} any any")
    with refuses("'radius atom'.*atomic"):
        lmp.command("run 0")


@styles
def test_radii_that_are_none(style):
    x = np.array([[0.0, 0.0], [1.1, 0.0]])
    for radius, message in (
        (0.0, "Atom 2 .*radius of 0:"),
        (-0.1, "Atom 2 .*radius of -0.1:"),
        (np.nan, "Atom 2 .*radius of nan:"),
        (np.inf, "Atom 2 .*radius of inf.*species any"),
        (0.81, "Atom 2 .*radius of 0.81.*species any.*0.8"),
    ):
        scene = Scene(x, ["any"] * 2, BOX, f"{style} radius atom", radii=[0.5, radius])
        with refuses(message):
            scene.energy()


def test_largest_radius_is_named_and_rounding_allowed():
    """0.8 may be read back as slightly more."""
    x = np.array([[-1.5, 0.0], [0.0, 0.0], [1.6, 0.0]])

    def scene(radii):
        return Scene(x, ["any"] * 3, BOX, f"{RADICAL} radius atom", radii=radii)

    with refuses("Atom 2 .*0.9"):
        scene([0.81, 0.9, 0.85]).energy()
    scene([0.5, np.nextafter(0.8, 1.0), 0.5]).energy()


def test_radius_within_the_skin():
    x = np.array([[0.0, 0.0], [1.1, 0.0]])
    scene = Scene(x, ["anysoft"] * 2, BOX, f"{RADICAL} radius atom", radii=[0.5, 0.05])
    with refuses("Atom 2 .*0.05.*skin of species anysoft"):
        scene.energy()


# ---- radii that the pair style does not take: one warning ----


UNUSED = "another radius than its species"
GROW = """
variable grow equal 1+0.01*step
fix grow all adapt 1 atom diameter v_grow scale yes
neigh_modify every 1 delay 0 check no
run 3
run 3
"""


def logged(law, words, tmp_path, commands):
    log = tmp_path / "log"
    species = "any any" if words else "small large"
    packing = Packing(EXACT[law] + words, species=species, atoms="sphere 1", log=log)
    packing.run(commands)
    return packing.results()["energy"], log.read_text()


@two_laws
def test_growth_without_effect(law, tmp_path):
    """fix adapt and `radius type`; with `radius atom` particles grow."""
    start = logged(law, "", tmp_path, "run 0")
    assert UNUSED not in start[1]
    same, said = logged(law, "", tmp_path, GROW)
    assert same == pytest.approx(start[0], rel=1e-9)
    assert said.count(UNUSED) == 1
    grown, said = logged(law, " radius atom", tmp_path, GROW)
    assert grown > 2 * start[0]
    assert UNUSED not in said


def test_names_the_atom(tmp_path):
    assert PACKINGS[0]["type"][8] == 1
    said = logged("balanced", "", tmp_path, "set atom 9 diameter 1.01\nrun 0")[1]
    assert f"Atom 9 has {UNUSED}" in said
