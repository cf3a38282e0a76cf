"""What validation/emulsion_3d/README.md says follows from the committed measurements."""

import numpy as np
import pytest

from validation.emulsion_3d import __main__ as emulsion
from validation.emulsion_3d import own_weight as weight
from validation.emulsion_3d import yielding
from validation.emulsion_3d.documented import (
    PACKINGS,
    PHI,
    at_phi,
    rows,
    strained,
    yield_strains,
)

pytest.importorskip("matplotlib")
NEARLY, POLYDISPERSE = emulsion.KINDS


def test_yield_strains() -> None:
    """They rise from the onset, as those of foams; the largest stress is twice that of flow."""
    flow, largest = yield_strains(1), yield_strains(2)
    assert (np.diff(largest) > 0.0).all()
    over = np.array(largest) / [yielding.measured(phi) for phi in yielding.PHI]
    assert 0.58 < over.min() < over.max() < 0.88
    assert np.array(largest) / flow == pytest.approx(1.9, abs=0.15)


def test_what_the_page_says_of_the_numbers() -> None:
    for kind in emulsion.KINDS:
        for name in ("pressure", "bulk", "excess", "load"):
            assert (np.diff(at_phi(kind, name)) > 0.0).all()
        near, error = emulsion.exponent(PACKINGS, kind, "bulk", emulsion.NEAR)
        assert 0.0 < near - 2.0 * error < near + 2.0 * error < 0.5
        # of contacts whose stiffness is F^(1/L): 1/2 over 1 + 1/L, and for the modulus 1/L more
        for name, least, most in (("shear", 0.56, 0.59), ("excess", 0.43, 0.45)):
            near, error = emulsion.exponent(PACKINGS, kind, name, emulsion.NEAR)
            assert least - 3.0 * error < near < most + 3.0 * error
    # strains are halved until two values agree to 1 %, so that each is known to about that
    assert all(strain == pytest.approx(linear, rel=0.012) for strain, linear in strained())
    assert max(row["largest"] for row in rows()) < 0.4
    assert max(row["order"] for row in rows()) < 0.46


def test_the_height_balances_the_weight() -> None:
    """dp = -phi dz between all points."""
    pressure = at_phi(NEARLY, "pressure")
    height, phi = emulsion.height(PHI, pressure, 0.63)
    lifted = 0.5 * (phi[1:] + phi[:-1]) * -np.diff(height)
    assert lifted == pytest.approx(np.diff(np.append(0.0, pressure)))
    assert height[-1] == 0.0


def test_a_small_packing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 16 droplets, at few phi: pressures as those of 512, to the scatter of so few."""
    monkeypatch.setattr(emulsion, "ABOVE", (0.01,))
    monkeypatch.setattr(emulsion, "PHI", (0.76, 0.82))
    found = emulsion.measure(POLYDISPERSE, 16, 1)
    near, first, last = found["rows"]
    assert near["phi"] == pytest.approx(found["phi_J"] + 0.01)
    assert [first["pressure"], last["pressure"]] == pytest.approx([0.079, 0.186], rel=0.4)
    assert first["sheared"] == pytest.approx(first["simple"], rel=0.02, abs=1e-3)


def test_a_short_column(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ceiling bears all weight, and phi and stress rise to it."""
    monkeypatch.setattr(weight, "SLABS", 2)
    low, high = weight.column(40, 1)["rows"]
    assert 0.0 < low[1] < high[1] < weight.HIGHEST
    assert low[2] < high[2]
    assert [low[3], high[3]] == pytest.approx([low[1], high[1]], rel=0.5)


def test_volume_below_a_height() -> None:
    whole = 4.0 / 3.0 * np.pi * 8.0
    for edge, part in ((0.0, 0.0), (3.0, 0.5), (6.0, 1.0)):
        found = weight.volume_below(edge, np.array([3.0]), np.array([2.0]))
        assert found == pytest.approx(part * whole)
