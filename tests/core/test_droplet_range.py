"""How far the law of droplets holds: forces of few contacts beside exact shapes, and the page."""

import re
from pathlib import Path

import numpy as np
import pytest
from lammps_deformable import core
from lammps_deformable.particles import laws
from polyhedra import FACES
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from test_droplet_kernel import between_plates

PAGE = Path(__file__).parents[2] / "docs" / "theory" / "droplets.md"
ONE = np.array([[0.0, 0.0, 1.0]])
LARGEST_LOAD, LARGEST_FACET = 0.4, 0.05

# Mean force of equal contacts by finite elements of the surface, to 2e-3: names of FACES, a/R.
ELEMENTS = {
    ("tetrahedron", 0.1): 0.52643,
    ("sc", 0.1): 0.84589,
    ("bcc", 0.08): 0.69629,
    ("bcc", 0.1): 1.19083,
    ("fcc", 0.05): 0.43428,
    ("fcc", 0.06): 0.66997,
    ("fcc", 0.08): 1.77635,
}
NAMES = {
    "1 plate, below its weight": "weight",
    "2 plates": "plates",
    "4, a tetrahedron": "tetrahedron",
    "6, a cube": "sc",
    "8, an octahedron": "bcc",
    "12, a rhombic dodecahedron": "fcc",
}


def of_law(normals, indentation):
    """The droplet between equal contacts of this indentation, and their force."""

    def pressed(f):
        return core.droplet(normals, np.full(len(normals), f))

    tried = np.linspace(1e-9, 3.0, 300)  # the least force: beyond the model there may be several
    first = next(f for f in tried if pressed(f).indentation[0] > indentation)
    before = first - tried[1]
    f = brentq(lambda f: pressed(f).indentation[0] - indentation, before, first)
    return pressed(f), f


def plates(indentation):
    """Exact force between two plates."""
    width = brentq(lambda width: between_plates(width)[0] - indentation, 0.01, 0.95)
    return between_plates(width)[1]


def own_weight(indentation):
    """Exact force of one plate on a droplet by its weight, whose center is so much lower than R.

    The outline from the top, where its curvature is 1/b, down to the facet: with its slope s,
    ds/dl = 2/b + B z - sin(s)/r, where B is the weight over the volume. V and its moment grow on
    the way.
    """

    def outline(b, B):
        def slopes(_, y):
            r, z, s = y[:3]
            grows = np.pi * r * r * np.sin(s)
            bend = 2 / b + B * z - (np.sin(s) / r if r > 1e-9 else 1 / b)
            return [np.cos(s), np.sin(s), bend, grows, grows * z]

        def flat(_, y):
            return y[2] - np.pi

        flat.terminal = True
        return solve_ivp(slopes, [0, 20], np.zeros(5), events=flat, rtol=1e-7, atol=1e-9).y[:, -1]

    volume = 4 * np.pi / 3

    def lowered(B):
        b = brentq(lambda b: outline(b, B)[3] - volume, 0.5, 20, xtol=1e-7)
        _, z, _, V, moment = outline(b, B)
        return 1 - (z - moment / V)

    return volume * brentq(lambda B: lowered(B) - indentation, 1e-3, 3, xtol=1e-5)


def exact(name, indentation):
    if name == "weight":
        return own_weight(indentation)
    return plates(indentation) if name == "plates" else ELEMENTS[name, indentation]


def rows_of_page():
    """Of the table of the page: contacts, a/R, y, x, force over the exact one."""
    table = PAGE.read_text().split("| contacts | a/R | y | x |")[1].split("\n\n")[0]
    for line in table.splitlines()[2:]:
        name, *numbers = [cell.strip() for cell in line.strip("|").split("|")]
        yield NAMES[name], *map(float, numbers)


def test_table_of_the_page():
    """Its figures, and that it has all that is known."""
    rows = list(rows_of_page())
    for name, a, facet, load, ratio in rows:
        found, f = of_law(ONE if name == "weight" else FACES[name], a)
        assert found.facet == pytest.approx(facet, abs=6e-4)
        assert found.load == pytest.approx(load, abs=6e-4)
        assert f / exact(name, a) == pytest.approx(ratio, abs=6e-4)
    assert set(ELEMENTS) <= {row[:2] for row in rows}


def test_measures_tell_where_the_law_fails():
    """Within both measures forces are right to 7 %, beyond them they may be off by a third."""
    within = {True: [], False: []}
    for _, _, facet, load, ratio in rows_of_page():
        within[facet <= LARGEST_FACET and load <= LARGEST_LOAD].append(abs(ratio - 1))
    assert max(within[True]) == pytest.approx(0.07, abs=0.001)
    assert max(within[False]) > 0.3
    text = PAGE.read_text()
    assert f"`x > {LARGEST_LOAD:g}`" in text
    assert f"`y > {LARGEST_FACET:g}`" in text


def test_facet_is_the_mean_weighted_by_force():
    f = np.array([0.3, 0.02, 0.1, 0.0])
    normals = np.vstack([FACES["plates"], [[1, 0, 0], [0, 1, 0]]])
    found = core.droplet(normals, f * 3.0 * 0.7, radius=3.0, tension=0.7)
    assert found.facet == pytest.approx((f**2).sum() / (8 * np.pi * f.sum()), rel=1e-14)
    assert core.droplet(ONE, [0.0]).facet == 0.0


def test_page_and_source_name_the_same_limits():
    source = (PAGE.parents[2] / "src" / "laws" / "droplet.h").read_text()
    for name, value in (("LOAD", LARGEST_LOAD), ("FACET", LARGEST_FACET)):
        assert re.search(rf"LARGEST_{name} = {value:g};", source)
        assert getattr(laws, f"LARGEST_{name}") == value
