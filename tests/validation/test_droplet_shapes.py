"""Exact shapes of a droplet between planes, on coarse meshes."""

import json
from pathlib import Path

import numpy as np
import pytest

from validation import droplet_shapes
from validation.droplet_shapes import shape
from validation.droplet_shapes.__main__ import exact

FILE = Path(__file__).parents[1] / "data" / "droplet_cages.json"
CAGES = {cage["name"]: cage for cage in json.loads(FILE.read_text())["cages"]}


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(droplet_shapes, "_NODES", 400)
    monkeypatch.setattr(droplet_shapes, "_GRADED", 2)


@pytest.mark.parametrize("name", ["plates_0.05", "mono_1_0.74_16"])
def test_another_program_finds_the_same(name: str) -> None:
    cage = CAGES[name]
    found = shape(cage["normals"], cage["a"])
    mean = np.mean(cage["f"])
    np.testing.assert_allclose(found.forces, cage["f"], atol=2e-3 * mean)
    assert found.pressure == pytest.approx(cage["pressure"], abs=1e-4)
    assert found.energy == pytest.approx(cage["energy"], rel=2e-2)
    assert found.energy_error < 0.05 * found.energy
    assert found.force_error < 0.01 * mean


@pytest.mark.slow
def test_forces_are_derivatives_of_the_energy() -> None:
    """And the shape knows no direction."""
    normals = np.array([(1.0, 0.0, 0.0), (-0.6, 0.8, 0.0), (-0.6, -0.8, 0.0)])
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    a, step = np.array([0.06, 0.05, 0.04]), 0.01
    middle = shape(normals, a)
    turned = shape(normals @ turn.T, a)
    np.testing.assert_allclose(turned.forces, middle.forces, rtol=3e-3)
    change = shape(normals, a + step).energy - shape(normals, a - step).energy
    assert change / (2.0 * step) == pytest.approx(middle.forces.sum(), rel=1e-2)


@pytest.mark.slow
def test_crystals() -> None:
    """fcc at phi = 0.81, as docs/theory.md has it."""
    assert exact("fcc", 0.81)["exact"] == pytest.approx(0.1206, rel=2e-3)


def test_bad_input() -> None:
    with pytest.raises(ValueError, match="levels must be 3 or more, not 2"):
        shape([(0.0, 0.0, 1.0)], [0.1], levels=2)
    with pytest.raises(ValueError, match=r"planes must be beyond the origin, .* not 1.5"):
        shape([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)], [1.5, -2.0])


def test_no_shape(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(droplet_shapes, "_ITERATIONS", 1)
    with pytest.raises(ArithmeticError, match="no shape was found in 1 iterations"):
        shape([(0.0, 0.0, 1.0)], [0.1])
