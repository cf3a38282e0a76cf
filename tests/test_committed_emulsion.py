"""What examples/emulsion/README.md says follows from the committed measurements."""

import json
from pathlib import Path

import numpy as np
import pytest
from example_modules import example

pytest.importorskip("matplotlib")

FOLDER = Path(__file__).parents[1] / "examples" / "emulsion"
README = (FOLDER / "README.md").read_text()
PACKINGS = json.loads((FOLDER / "emulsion.json").read_text())
emulsion = example("emulsion", "emulsion")


def test_the_page_has_the_table_and_the_log() -> None:
    onset, *table = emulsion.table(PACKINGS)
    assert (FOLDER / "emulsion.log").read_text().splitlines() == [onset, *table]
    assert "\n".join(table) in README
    assert onset in README
    assert len(PACKINGS) == len(emulsion.SEEDS)


def test_dense_droplets_are_a_hexagonal_array() -> None:
    """Of mean size: pressure and shear modulus as the page says, and six contacts each."""
    (pressure, z, shear, _, _), _ = (each.T for each in emulsion.means(PACKINGS))
    phi = np.array(emulsion.PHI)
    expected = emulsion.princen(phi[phi >= 0.98])
    assert (z[phi >= 0.98] == 6.0).all()
    assert pressure[phi >= 0.98] == pytest.approx(expected[0], rel=0.03)
    assert shear[phi >= 0.98] == pytest.approx(expected[1], rel=0.06)


def test_pressure_begins_with_the_bulk_modulus() -> None:
    """p is about K (phi - phi_J) near the onset, with K between that there and the one measured."""
    onset = np.mean([packing["phi_J"] for packing in PACKINGS])
    (pressure, _, _, bulk, _), _ = (each.T for each in emulsion.means(PACKINGS))
    slope = pressure[:2] / (np.array(emulsion.PHI[:2]) - onset)
    assert (slope > 0.8).all()
    assert (slope < bulk[:2]).all()
