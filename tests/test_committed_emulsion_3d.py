"""What examples/emulsion_3d/README.md says follows from the committed measurements."""

import json
from pathlib import Path

import numpy as np
import pytest
from example_modules import example

pytest.importorskip("matplotlib")

FOLDER = Path(__file__).parents[1] / "examples" / "emulsion_3d"
README = (FOLDER / "README.md").read_text()
PACKINGS = json.loads((FOLDER / "emulsion_3d_512.json").read_text())
emulsion = example("emulsion_3d", "emulsion_3d")


def test_the_page_has_the_table_and_the_log() -> None:
    onset, *table = emulsion.table(PACKINGS, 512)
    assert (FOLDER / "emulsion_3d_512.log").read_text().splitlines() == [onset, *table]
    assert "\n".join(table) in README
    assert onset in README


def test_what_the_page_says_of_the_numbers() -> None:
    pressure, z, shear, _, largest = emulsion.means(PACKINGS)[0].T
    phi = np.array(emulsion.PHI)
    assert 1.0 - pressure[-1] / emulsion.master_curve(0.85) == pytest.approx(0.24, abs=0.01)
    assert (np.diff(pressure) > 0.0).all()
    assert (np.diff(z) > 0.0).all()
    softer = 1.0 - shear[phi > 0.7] / emulsion.mason(phi[phi > 0.7])
    assert [softer.min(), softer.max()] == pytest.approx([0.17, 0.26], abs=0.01)
    left_out = [
        (phi[n], row[2]) for p in PACKINGS for n, row in enumerate(p["rows"]) if row[2] <= 0
    ]
    assert sorted(at for at, _ in left_out) == [0.66, 0.76]
    assert max(row[4] for packing in PACKINGS for row in packing["rows"]) < 0.4
    assert largest.max() < 0.4


def test_the_height_balances_the_weight() -> None:
    """dp = -phi dz between all points."""
    pressure = emulsion.means(PACKINGS)[0].T[0]
    height, phi = emulsion.height(emulsion.PHI, pressure, 0.63)
    weight = 0.5 * (phi[1:] + phi[:-1]) * -np.diff(height)
    assert weight == pytest.approx(np.diff(np.append(0.0, pressure)))
    assert height[-1] == 0.0


def test_a_small_packing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 16 droplets, at two phi: pressures as those of 512, to the scatter of so few."""
    monkeypatch.setattr(emulsion, "PHI", (0.76, 0.82))
    (first, last) = emulsion.measure(16, 1)["rows"]
    assert [first[0], last[0]] == pytest.approx([0.079, 0.186], rel=0.4)
    assert first[2] > 0.0
