"""How adhesion reaches the pair style: species file, matrix by types, fix adapt, walls."""

import numpy as np
import pytest
from laws import BALANCED, CURVED, EXACT, LAWS, RADICAL, straight_laws, two_laws
from scene import FOUR, ROOM_OF_FOUR, Scene
from test_refusals import refuses

SPECIES = """\
small 0.5 inf 0 tension 0.2
large 0.7 inf 0 tension 0.3
firm  0.5 2 0.1 tension 0.03
skin  0.5 inf 0 tension 1 skin 0.01
ring  0.5 1 inf
soft  0.5 1 0.5
"""
APART = np.array([[-1.5, 0.0], [0.0, 0.0], [1.5, 0.0]])  # no two touch


def scene(tmp_path, text, *, species=("small", "large"), style=CURVED, x=APART, **options):
    """Particles of these species, far from each other."""
    file = tmp_path / "species.txt"
    file.write_text(text)
    types = list(dict.fromkeys(species))
    kinds = [types[k % len(types)] for k in range(len(x))]
    options.setdefault("coeff", f"pair_coeff * * {file} {' '.join(types)}")
    return Scene(x, kinds, (-4, 4, -4, 4), style, **options)


def matrix(some):
    """The array that fix adapt writes to, without its row and column of type 0."""
    return np.array(some.lmp.extract_pair("adhesion"))[1:, 1:]


# ---- the species file ----


@pytest.mark.parametrize("before", [True, False], ids=["before the species", "after them"])
def test_matrix(before, tmp_path):
    """Names in any order, in lines anywhere; types of one species share its value."""
    lines = "adhesion large small 0.1  # films\nadhesion small small 0.3\n"
    text = lines + SPECIES if before else SPECIES + lines
    some = scene(tmp_path, text)
    assert some.lmp.extract_pair_dimension("adhesion") == 2
    np.testing.assert_array_equal(matrix(some), [[0.3, 0.1], [0.1, 0.0]])
    file = tmp_path / "species.txt"
    some.run(f"pair_coeff * * {file} small small\nrun 0")
    np.testing.assert_array_equal(matrix(some), np.full((2, 2), 0.3))
    some.run(f"pair_coeff * * {file} firm large")
    np.testing.assert_array_equal(matrix(some), np.zeros((2, 2)))


MALFORMED = {
    "no value": (
        "adhesion small large",
        "line 1: expected 'adhesion species species value', got 3",
    ),
    "a species": ("adhesion 0.5 inf 0", "species 0.5 is not defined.*can be called adhesion"),
    "no number": (
        "adhesion small large sticky",
        "adhesion of small and large is 'sticky', .*number",
    ),
    "unknown": (
        "adhesion small huge 0.1",
        "line 1: adhesion of small and huge: species huge is not",
    ),
    "twice": (
        "adhesion small large 0.1\nadhesion large small 0.1",
        "line 2: adhesion of large and small: it is given twice, in line 1 too",
    ),
    "negative": (
        "adhesion small large -0.1",
        "adhesion must be 0 or positive and finite, not -0.1",
    ),
    "engulfed": (
        "adhesion large small 0.4",
        "species small: adhesion 0.4 needs a tension above half of it, 0.2, not 0.2: .*engulfs",
    ),
    "skin": ("adhesion small skin 0.1", "species skin: .*needs a skin of 0, not 0.01: films"),
    "perimeter": (
        "adhesion ring ring 0.1",
        "species ring: .*finite kP and a tension, not kP = inf",
    ),
    "no tension": ("adhesion soft small 0.1", "species soft: .*above .* 0.05, not 0: .*no contact"),
}


def test_malformed_lines(tmp_path):
    some, file = scene(tmp_path, SPECIES), tmp_path / "species.txt"
    for lines, message in MALFORMED.values():
        file.write_text(f"{lines}\n{SPECIES}")
        with refuses(f"Species file '.*species.txt'.*{message}"):
            some.run(f"pair_coeff * * {file} small large")


def test_largest_adhesion(tmp_path):
    """Any below twice the weaker tension, beside a finite kP too."""
    scene(tmp_path, SPECIES + "adhesion small large 0.399\nadhesion firm firm 0.059\n")


# ---- laws ----


@straight_laws
def test_laws_that_cannot_stick(law, tmp_path):
    """Their walls neither; what no type has is no matter."""
    text = SPECIES + "adhesion small large 0.1\n"
    if law != "sector":  # which refuses any tension
        with refuses("Species: adhesion needs contact lines that bend.*'.*contact curved'"):
            scene(tmp_path, text, style=LAWS[law])
    some = scene(tmp_path, text, species=["ring"], style=LAWS[law])
    some.run("run 0\nfix w all deformable/wall plane -3 0 1 0 adhesion 0.1")
    with refuses("Fix w deformable/wall: adhesion needs contact lines that bend"):
        some.run("run 0")


def test_a_run_after_it_was_refused(tmp_path):
    """The caller has caught the error: all is as it was."""
    some = scene(tmp_path, SPECIES, style=BALANCED)
    some.run("run 0")
    file = tmp_path / "species.txt"
    file.write_text(SPECIES + "adhesion small large 0.1\n")
    with refuses("Species: adhesion needs contact lines that bend"):
        some.run(f"pair_coeff * * {file} small large")
    some.run("run 0")


def test_another_law_afterwards(tmp_path):
    some = scene(tmp_path, SPECIES + "adhesion small large 0.1\n")
    some.run(f"run 0\npair_style {RADICAL}")
    with refuses("Species: adhesion needs contact lines that bend"):
        some.run("run 0")


@two_laws
def test_none_changes_no_digit(law, tmp_path):
    def forces(line, words):
        room = ROOM_OF_FOUR.rstrip() + f" {words}"
        some = scene(
            tmp_path, SPECIES + line, species=["ring"], style=EXACT[law], x=FOUR, commands=room
        )
        found = some.evaluate()
        return np.append(found.force, found.energy)

    plain = forces("", "")
    assert np.abs(plain).max() > 0.0
    np.testing.assert_array_equal(plain, forces("adhesion ring ring 0", "adhesion 0"))


# ---- ramps ----


def ramp(some, types, value, name="adhesion", fix="ramp", more=""):
    some.run(
        f"variable {fix} equal {value}\n"
        f"fix {fix} all adapt 1 pair deformable/ring {name} {types} v_{fix} {more}"
    )


def test_ramp(tmp_path):
    """Of one pair of types, symmetric at each step."""
    some = scene(tmp_path, SPECIES + "adhesion small small 0.1\n")
    ramp(some, "2 1", "0.01*step")
    for steps in 3, 5:
        some.run(f"run {steps}")
        value = 0.01 * some.lmp.get_thermo("step")
        np.testing.assert_allclose(matrix(some), [[0.1, value], [value, 0.0]], rtol=1e-14)
    some.run("unfix ramp")
    ramp(some, "* *", 0.2, fix="all")
    some.run("run 0")
    np.testing.assert_array_equal(matrix(some), np.full((2, 2), 0.2))


def test_scaled_ramp_and_reset(tmp_path):
    some = scene(tmp_path, SPECIES + "adhesion small large 0.1\n")
    ramp(some, "1 2", 2.0, more="scale yes reset yes")
    before = some.lmp.extract_pair("definition")
    some.run("run 1")
    assert some.lmp.extract_pair("definition") > before  # for Python, whose states are of one law
    np.testing.assert_array_equal(matrix(some), [[0.0, 0.1], [0.1, 0.0]])


def test_ramp_below_a_hybrid_style(tmp_path):
    coeff = f"pair_coeff * * deformable/ring {tmp_path / 'species.txt'} small NULL\n"
    style = f"hybrid/overlay {CURVED} zero 1.0"
    some = scene(tmp_path, SPECIES, style=style, coeff=coeff + "pair_coeff * * zero")
    ramp(some, "1 1", 0.3)
    some.run("run 0\nunfix ramp")
    ramp(some, "1 1", 0.4)
    with refuses("Types 1 and 1: species small: adhesion 0.4 needs a tension above"):
        some.run("run 0")


BAD_RAMPS = {
    "negative": ("1 2", "adhesion", -0.1, "Types 1 and 2: adhesion must be .*not -0.1"),
    "too strong": ("1 2", "adhesion", 0.5, "Types 1 and 2: species small: .*0.25, not 0.2"),
    "too tense": ("2 2", "tension", 0.05, "Types 1 and 2: species large: .*0.05, not 0.05"),
}


@pytest.mark.parametrize(("types", "name", "value", "message"), BAD_RAMPS.values(), ids=BAD_RAMPS)
def test_ramps_beyond_the_rules(types, name, value, message, tmp_path):
    """Also at the next try, after an error that the caller has caught."""
    some = scene(tmp_path, SPECIES + "adhesion small large 0.1\n")
    ramp(some, types, value, name)
    for _ in range(2):
        with refuses(f"Adhesion in a run: {message}"):
            some.run("run 0")


def test_ramp_of_a_law_that_cannot_stick(tmp_path):
    some = scene(tmp_path, SPECIES, style=RADICAL)
    ramp(some, "1 2", 0.0)
    some.run("run 0\nunfix ramp")
    ramp(some, "1 2", 0.1)
    with refuses("Species: adhesion needs contact lines that bend"):
        some.run("run 0")


# ---- walls ----

WALL = "fix w {} deformable/wall plane -3 0 1 0 adhesion {}"


def test_walls_ask_the_species_of_their_group(tmp_path):
    some = scene(tmp_path, SPECIES, species=["small", "ring", "large"])
    some.run("group tense type 1 3\n" + WALL.format("tense", 0.3) + "\nrun 0\nunfix w")
    some.run(WALL.format("all", 0.3))
    with refuses("Fix w deformable/wall: atom 2 of species ring: .*not kP = inf"):
        some.run("run 0")
    some.run("unfix w\n" + WALL.format("tense", 0.4))
    with refuses("Fix w deformable/wall: atom 1 of species small: .*above .* 0.2, not 0.2"):
        some.run("run 0")


def test_walls_in_a_ramp(tmp_path):
    """A tension that falls below half of the wall's adhesion stops the run at that step."""
    some = scene(tmp_path, SPECIES)
    some.run(WALL.format("all", 0.1))
    ramp(some, "2 2", "0.3-0.09*step", "tension")
    with refuses("Fix w deformable/wall: atom 2 of species large: .*above .* 0.05, not"):
        some.run("run 10")
    assert some.lmp.get_thermo("step") == 3


def test_region_with_the_name_of_the_keyword(tmp_path):
    some = scene(tmp_path, SPECIES)
    some.run("region adhesion block -3 3 -3 3 INF INF")
    some.run("fix w all deformable/wall adhesion\nrun 0\nunfix w")
    some.run("fix w all deformable/wall adhesion adhesion 0.1\nrun 0")
