"""Any arguments of public functions, and damaged files: an error of one line, or a result."""

import json
import re

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lammps_deformable.particles.polygons import Walls
from lammps_deformable.protocols.compression import Compress

# Valid numbers, invalid ones, and other objects. Large counts would only take long.
FLOATS = st.one_of(st.floats(), st.floats(0.1, 2.0), st.integers(-3, 30))
ANYTHING = st.one_of(
    FLOATS,
    st.sampled_from(
        [None, True, "", "1", "inf", b"1", 1j, {}, [], (), object(), 10**400, -(10**30), {1: 2}]
    ),
    st.lists(st.one_of(FLOATS, st.none(), st.text(max_size=3)), max_size=3),
    st.sampled_from(
        [np.array(1.0), np.array([1.0, 2.0]), np.array([[1.0]]), np.array(["a"]), np.array([None])]
    ),
    st.lists(st.lists(FLOATS, max_size=3), max_size=3),
)
BUILDERS = {
    "bidisperse": (
        ld.bidisperse,
        {"number": 6, "sizes": (0.5, 0.7), "fraction_large": 0.5, "phi": 0.3, "aspect": 1.0}
        | {"tilt": 0.0, "seed": 1},
    ),
    "polydisperse": (
        ld.polydisperse,
        {"number": 3, "radii": [0.5, 0.6, 0.7], "phi": 0.3, "aspect": 1.0, "tilt": 0.0, "seed": 1},
    ),
    "bidisperse in space": (
        ld.bidisperse,
        {"number": 6, "phi": 0.3, "aspect": 1.0, "tilt": 0.0, "seed": 1, "dimension": 3},
    ),
    "Droplet": (ld.Droplet, {"tension": 1.0}),
    "Packing in space": (
        ld.Packing,
        {"positions": [[0.0, 0.0, 0.0], [1.0, 0.0, 2.0]], "species": [0, 1], "radii": [0.5, 0.6]}
        | {"box": [[4.0, 0.0, 0.0], [0.1, 4.0, 0.0], [0.2, 0.3, 5.0]]},
    ),
    "Ring": (
        ld.Ring,
        {"kA": 1.0, "reach": 0.3, "kP": 1.0, "skin": 0.1, "contact": "radical"},
    ),
    "Sector": (ld.Sector, {"kA": 1.0, "kP": float("inf")}),
    "Friction": (ld.Friction, {"mu": 0.5, "kt": 1.0, "gt": 0.1, "damping": 0.1}),
    "DeformablePolygon": (
        ld.DeformablePolygon,
        {"vertices": 50, "radius": 0.05, "kL": 1.0, "kA": 1.0, "kr": 1.0},
    ),
    "Walls": (Walls, {"angle": [0.0, 2.0, 4.0], "height": [1.0, 1.0, 1.0]}),
    "Packing": (
        ld.Packing,
        {"positions": [[0.0, 0.0], [1.0, 0.0]], "species": [0, 1], "radii": [0.5, 0.6]}
        | {"box": [[4.0, 0.0], [0.1, 4.0]]},
    ),
}


def is_large(number):
    """Whether so many particles only take much time and memory."""
    return isinstance(number, (int, float)) and 1e4 < number < 2**31


def refuses_or_works(call, refused=ld.ParameterError):
    """What a call returns, or nothing if it is refused by one line."""
    try:
        return call()
    except refused as error:
        line = str(error)
        assert 10 < len(line) < 1000
        assert "\n" not in line
        return None


LAWS = {2: ld.Ring(contact="radical"), 3: ld.Droplet()}


@pytest.fixture(scope="module", params=LAWS)
def packing(request):
    start = ld.bidisperse(8, dimension=request.param, seed=1)
    return ld.jam(start).packing.at(0.86 if request.param == 2 else 0.7)


@pytest.fixture(scope="module")
def sim(packing):
    with ld.Simulation(packing, LAWS[packing.dimension]) as sim:
        yield sim


FEW = [60, pytest.param(4000, marks=pytest.mark.slow)]


@pytest.mark.parametrize("examples", FEW)
@pytest.mark.parametrize("name", BUILDERS)
def test_builders(name, examples):
    build, right = BUILDERS[name]
    some = st.dictionaries(st.sampled_from(list(right)), ANYTHING, min_size=1, max_size=2).filter(
        lambda wrong: not is_large(wrong.get("number", wrong.get("vertices")))
    )

    @settings(max_examples=examples, deadline=None)
    @given(some)
    def answers(wrong):
        refuses_or_works(lambda: build(**right | wrong))

    answers()


def is_positive(value):
    number = isinstance(value, (int, float, np.ndarray)) and np.size(value) == 1
    return number and isinstance(np.asarray(value).item(), (int, float)) and value > 0


NOT_POSITIVE = ANYTHING.filter(lambda value: not is_positive(value))
# a box has two or three sides, as many numbers or vectors
NO_BOX = NOT_POSITIVE.filter(
    lambda value: np.asarray(value, dtype=object).shape[:1] not in ((2,), (3,))
)


@pytest.mark.parametrize("examples", FEW)
def test_protocols(sim, packing, examples):
    """Wrong values are refused, and the simulation does not change."""
    energy = sim.state().energy

    @settings(max_examples=examples, deadline=None)
    @given(NOT_POSITIVE, NO_BOX, ANYTHING)
    def answers(wrong, no_box, other):
        for call in (
            packing.at,
            lambda value: sim.relax(0.0 if value is None else value),  # None: that of the law
            lambda _: sim.deform(no_box),
            lambda value: ld.jam(packing, pressure=0.0 if value is None else value).packing,
            lambda value: ld.jam(packing, step=value).packing,
            lambda value: sim.compress(strain=0.1, steps=value),
        ):
            with pytest.raises(ld.ParameterError, match=r"\A[^\n]{10,1000}\Z"):
                call(wrong)
        refuses_or_works(lambda: Compress(strain=other).check(sim, False))

    answers()
    # Balanced anew; its error is of second order in what is left of that. Indentations of
    # droplets are right to a tenth of the balance, and their energy is of first order in them.
    digits = 1e-11 if packing.dimension == 2 else 1e-9
    assert sim.state().energy == pytest.approx(energy, rel=digits)


# ---- damaged files ----

# A file that can be read may still have a packing that LAMMPS cannot evaluate.
REFUSED = r"(File|Parameter|Lammps)Error: [^\n]{10,1000}$"


def check(answer):
    if "error" in answer:
        assert re.match(REFUSED, answer["error"])
    else:
        assert answer["finite"]


@pytest.fixture(scope="module")
def saved(packing, tmp_path_factory):
    """Texts of a saved run by file name; a character is a byte."""
    folder = tmp_path_factory.mktemp("saved")
    with ld.Simulation(packing, LAWS[packing.dimension]) as sim:
        sim.state().save(folder)
    return {file.name: file.read_bytes().decode("latin-1") for file in folder.iterdir()}


def damages(text):
    """A text with a part cut out, doubled or replaced."""
    places = st.integers(0, len(text))
    parts = st.one_of(
        st.sampled_from(
            ["", "\0", "nan", "-1", "1e400", "0", "9999999999", "{", '"', "\n", "\xff"]
        ),
        st.text(st.characters(max_codepoint=255), max_size=5),
        st.tuples(places, places).map(lambda ends: text[min(ends) : max(ends)]),
    )
    return st.tuples(places, st.integers(0, 20), parts).map(
        lambda d: text[: d[0]] + d[2] + text[d[0] + d[1] :]
    )


@pytest.mark.parametrize("examples", [60, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ["summary.json", "packing.data"])
def test_damaged_files(host, saved, name, examples):
    @settings(max_examples=examples, deadline=None)
    @given(damages(saved[name]))
    def answers(text):
        check(host.answer([], saved | {name: text}))

    answers()


@pytest.mark.parametrize("examples", [60, pytest.param(3000, marks=pytest.mark.slow)])
def test_other_values(host, saved, examples):
    """Whole JSON, with values of another kind."""
    summary = json.loads(saved["summary.json"])
    values = st.recursive(
        st.one_of(st.none(), st.booleans(), st.floats(), st.integers(), st.text(max_size=5)),
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
        max_leaves=5,
    )
    places = [("radii",), ("law",), ("state",), *(("law", key) for key in summary["law"])]

    @settings(max_examples=examples, deadline=None)
    @given(st.sampled_from(places), values)
    def answers(place, value):
        whole = json.loads(saved["summary.json"])
        inner = whole[place[0]] if len(place) == 2 else whole
        inner[place[-1]] = value
        check(host.answer([], saved | {"summary.json": json.dumps(whole)}))

    answers()
