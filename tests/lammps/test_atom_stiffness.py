"""Stiffness and tension of single particles, d_kA and d_tension of fix property/atom."""

import numpy as np
import pytest
from combinations import Packing
from combinations import assert_same as assert_same_results
from laws import CURVED, EXACT, RADICAL, ring_laws, two_laws
from materials import pushed
from parallel import TWO, assert_same, on_grids, report, reported
from scene import BOX, PACKINGS, Scene
from test_refusals import refuses

CASE = PACKINGS[0]
SMALL = np.array(CASE["type"]) == 1
# those of half of the small particles, and of the others, of which b has the radius of a
SPECIES = """
a  0.5 1.0 0.3 tension 0.02
b  0.5 3.0 0.3 tension 0.05
large 0.7 1.0 0.3 tension 0.03
"""
OF_SPECIES = {"a": (1.0, 0.02), "b": (3.0, 0.05), "large": (1.0, 0.03)}
NAMES = ["large" if not small else "ab"[n % 2] for n, small in enumerate(SMALL)]
FIX = "fix values all property/atom d_kA d_tension"


def set_values(lines):
    """Commands that give atoms 1, 2, ... these kA and tensions."""
    rows = enumerate(lines, start=1)
    return "\n".join(f"set atom {n} d_kA {kA!r} d_tension {t!r}" for n, (kA, t) in rows)


def scene(tmp_path, style, names, text=SPECIES, commands=""):
    file = tmp_path / "species.txt"
    file.write_text("# for tests" + text)
    types = " ".join(dict.fromkeys(names))
    box = (0, CASE["L"], 0, CASE["L"])
    coeff = f"pair_coeff * * {file} {types}"
    return Scene(CASE["x"], names, box, style, coeff=coeff, commands=commands)


def by_atom(tmp_path, style, commands="", values=None):
    """All small ones are of one species, whose own values are others."""
    names = ["a" if small else "large" for small in SMALL]
    values = [OF_SPECIES[name] for name in NAMES] if values is None else values
    return scene(
        tmp_path,
        f"{style} kA atom tension atom",
        names,
        SPECIES.replace("1.0", "7.0").replace("0.02", "0.3"),
        f"{FIX}\n{set_values(values)}\n{commands}",
    )


def assert_equal(found, expected, digits):
    scale = np.abs(expected.force).max()
    assert found.energy == pytest.approx(expected.energy, rel=digits)
    np.testing.assert_allclose(found.force, expected.force, rtol=0, atol=digits * scale)
    for name, values in expected.shape.items():
        np.testing.assert_allclose(found.shape[name], values, rtol=1e3 * digits, atol=1e-14)


@ring_laws
def test_values_of_types(law, tmp_path):
    """Particles with the values of two species are as those of these species."""
    x = pushed(CASE)
    expected = scene(tmp_path, EXACT[law], NAMES).evaluate(x)
    assert_equal(by_atom(tmp_path, EXACT[law]).evaluate(x), expected, 1e-11)


@two_laws
def test_values_are_followed(law, tmp_path):
    """Within a run: forces of its last step are those of a new scene with the last values."""
    moving = "fix move all nve\ntimestep 0.02\nvelocity all create 1e-4 4711 loop all"
    some = by_atom(tmp_path, EXACT[law], moving)
    values = np.array([OF_SPECIES[name] for name in NAMES]) * [1.3, 0.8]
    some.run("run 5")
    before = some.gather("f", 3)[:, :2]
    some.run(set_values(values.tolist()) + "\nrun 1 pre no")
    force, x = some.gather("f", 3)[:, :2], some.x
    expected = by_atom(tmp_path, EXACT[law], values=values.tolist()).evaluate(x).force
    scale = np.abs(expected).max()
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-10 * scale)
    assert np.abs(before - force).max() > 0.05 * scale


def test_infinite_stiffness(tmp_path):
    """By the library: such particles conserve their area."""
    some = by_atom(tmp_path, RADICAL)
    some.lmp.numpy.extract_atom("d_kA")[: len(SMALL)] = np.inf
    areas = some.evaluate(pushed(CASE)).shape["area"]
    np.testing.assert_allclose(areas, np.pi * np.where(SMALL, 0.5, 0.7) ** 2, rtol=1e-12)


SCRIPT = """
units lj
dimension 2
atom_modify map yes
processors {grid}
read_data {data}
{fix}
pair_style {style} kA atom tension atom
pair_coeff * * {species} a large
variable kA atom 1+id%3
variable tension atom 0.02+0.01*(id%4)
set group all d_kA v_kA d_tension v_tension
fix move all nve
timestep 0.02
neighbor 0.05 bin
velocity all set 3.0 2.0 0.0 sum yes
"""


@pytest.mark.parametrize("style", [RADICAL, f"{CURVED} balance 1e-12 1000"])
def test_ranks(style, tmp_path):
    """Values go with particles to other ranks."""
    some = scene(tmp_path, RADICAL, ["a" if small else "large" for small in SMALL])
    some.run(f"write_data {tmp_path / 'data'} nofix nocoeff")
    fields = {"data": tmp_path / "data", "species": tmp_path / "species.txt", "fix": FIX}
    script = SCRIPT + report(0, "pe", "fx fy") + report(20, "pe", "x y fx fy d_kA d_tension")
    folders = on_grids(script, tmp_path, TWO, style=style, **fields)
    for steps in (0, 20):
        assert_same(reported(folders, steps), 1e-10)


def test_restart(tmp_path):
    """The fix keeps the values in restart files; pair_style is repeated with its keywords."""
    style = f"{RADICAL} kA atom tension atom"
    some = by_atom(tmp_path, RADICAL)
    expected = some.energy()
    some.run(f"write_restart {tmp_path / 'restart'}")
    some.run(f"clear\nread_restart {tmp_path / 'restart'}\n{FIX}")
    some.run(f"pair_style {style}\npair_coeff * * {tmp_path / 'species.txt'} a large\nrun 0")
    assert some.lmp.get_thermo("pe") == pytest.approx(expected / len(SMALL), rel=1e-12)


@two_laws
def test_as_a_fresh_run(law, tmp_path):
    """Motion conserves the energy; a new LAMMPS takes the particles of a data file, and values."""
    packing = Packing(f"{EXACT[law]} kA atom")
    values = f"{FIX}\nvariable kA atom 1+id%3\nset group all d_kA v_kA\n"
    packing.run(f"{values}fix move all nve\nrun 0")
    before = packing.value("etotal")
    packing.run("run 200")
    # benchmarks/nve.py: 1e-5 at larger time steps
    assert packing.value("etotal") == pytest.approx(before, abs=1e-4 * packing.value("ke"))
    assert_same_results(packing.results(), packing.fresh(tmp_path, values).results())


def two(tmp_path, keywords, commands, text="\na 0.5 1.0 0.3 tension 0.02\n", law=RADICAL):
    file = tmp_path / "species.txt"
    file.write_text("# for tests" + text)
    places = np.array([[0.0, 0.0], [0.95, 0.0]])
    coeff = f"pair_coeff * * {file} a"
    return Scene(places, ["a"] * 2, BOX, f"{law} {keywords}", coeff=coeff, commands=commands)


@pytest.mark.parametrize(
    ("keywords", "commands", "message"),
    [
        ("kA atom", "", "kA atom needs.*fix ID all property/atom d_kA"),
        ("tension atom", "fix v all property/atom i_tension", "property/atom d_tension"),
        ("kA atom", "fix v all property/atom d_kA", "Atom 1 of species a: kA must be positive.*0 "),
        ("kA atom", f"{FIX}\nset atom 1 d_kA 1\nset atom 2 d_kA -2", "Atom 2 .*kA.* not -2 .*d_kA"),
        ("tension atom", f"{FIX}\nset group all d_tension 5", "Atom 1 .*tension 5 makes a free"),
        ("kA atom tension atom", f"{FIX}\nset group all d_kA 1 d_tension -1", "d_kA and d_tension"),
    ],
)
def test_values_that_are_none(keywords, commands, message, tmp_path):
    with refuses(message):
        two(tmp_path, keywords, commands).energy()


def test_numbers_that_are_none(tmp_path):
    some = two(tmp_path, "kA atom", f"{FIX}\nset group all d_kA 1")
    some.energy()
    some.lmp.numpy.extract_atom("d_kA")[1] = np.nan
    with refuses("Atom 2 of species a: kA must be positive or inf, not nan"):
        some.energy()


def test_words_and_ramps(tmp_path):
    with refuses("kA 'group' is neither 'type' nor 'atom'"):
        two(tmp_path, "kA group", "")
    some = two(tmp_path, "kA atom", f"{FIX}\nset group all d_kA 1")
    with refuses("kA"):  # those of species have no effect
        some.run("variable v equal 2\nfix r all adapt 1 pair deformable/ring kA 1 1 v_v\nrun 0")


def test_adhesion_and_tension_of_each(tmp_path):
    text = "\na 0.5 inf 0 tension 1\nadhesion a a 0.5\n"
    some = two(tmp_path, "tension atom", f"{FIX}\nset group all d_tension 1", text, CURVED)
    some.energy()
    some.run("set atom 2 d_tension 0.2")
    with refuses("Atom 2 .*adhesion 0.5 needs a tension above half"):
        some.energy()
