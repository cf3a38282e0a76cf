"""Rings of any stiffness in a packing and between walls."""

import numpy as np
import pytest
from closed_forms import polygon_stiffness
from laws import RADICAL
from materials import packing, species_of
from scene import BOX, PACKINGS, Scene, polygon_walls


def test_stiff_species_beside_soft_ones():
    """The energy of species that conserve the perimeter does not depend on other species."""
    case = PACKINGS[0]
    stiff = Scene.packing(case, RADICAL).evaluate()
    state, species = packing(case).evaluate(), species_of(case)
    alike = [i for i, name in enumerate(species) if name in ("small", "large", "thick")]
    np.testing.assert_array_equal(state.atom_energy[alike], stiff.atom_energy[alike])
    thick = species.index("thick")
    inner = np.pi * 0.4**2
    lost = np.pi * 0.5**2 - stiff.shape["area"][thick]
    assert state.shape["area"][thick] == pytest.approx(inner - lost, rel=1e-13)
    assert state.shape["perimeter"][thick] == pytest.approx(2 * np.pi * 0.4, rel=1e-15)


@pytest.mark.parametrize("n", [3, 6])
def test_regular_polygon(n):
    """Laplace's law, p q = kP (P - P0), for the results of the pair style."""
    a, radius, kP = 0.01, 0.5, 1.0
    options = {"boundary": "f f p", "commands": polygon_walls(n, radius - a)}
    scene = Scene([[0, 0]], ["both"], BOX, RADICAL, **options)
    shape = {name: values[0] for name, values in scene.evaluate().shape.items()}
    stretch = shape["perimeter"] - 2 * np.pi * radius
    delta = stretch / (2 * np.pi)
    assert delta > 4e-5
    # the perimeter is a sum of 3, which leaves the stretch of 3e-4 to 4e-16/3e-4
    length = 2 * polygon_stiffness(n) * (a + delta)
    assert shape["contact_length"] == pytest.approx(length, rel=1e-11)
    q = radius + delta - length / (2 * np.pi)
    assert shape["arc_radius"] == pytest.approx(q, rel=1e-11)
    assert shape["pressure"] * q == pytest.approx(kP * stretch, rel=1e-11)
    deficit = np.pi * radius**2 - shape["area"]
    assert shape["pressure"] == pytest.approx(deficit, rel=1e-11)


def test_reach_includes_the_expansion():
    """A ring that expands far out of its circle needs a reach that covers that."""
    walls = "region walls block -0.4 0.4 -2 2 -0.5 0.5\nfix walls all deformable/wall walls"
    ratios = []
    for species in ("small", "fixed"):
        scene = Scene([[0, 0]], [species], BOX, f"{RADICAL} reach 0.5", commands=walls)
        ratios.append(scene.evaluate().bulge)
    # between walls 2 h apart the outline ends in half circles of radius h: pi h^2 + 4 h b = pi R^2
    # keeps the area, 2 pi h + 4 b = 2 pi R the perimeter, and it bulges by h + b - R
    h, radius = 0.4, 0.5
    bulge = [
        h + np.pi * (radius - h) / 2 - radius,
        h + np.pi * (radius**2 - h**2) / (4 * h) - radius,
    ]
    np.testing.assert_allclose(ratios, np.array(bulge) / (0.5 * radius), rtol=1e-9)
