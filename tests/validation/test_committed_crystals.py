"""What docs/disordered_crystals.md says follows from the committed measurements."""

import json

import numpy as np
import pytest

from validation.disordered_crystals import __main__ as crystals
from validation.disordered_crystals.documented import (
    FOLDER,
    GROUPS,
    LAWS,
    RESULT,
    apart,
    half,
    of,
)

pytest.importorskip("matplotlib")
LEVELS = (0.7, 0.6, 0.4)  # of psi_6, beside 1/2
SHOWN = {"full": RESULT, "quick": json.loads((FOLDER / "quick.json").read_text())}


def test_they_are_all_that_the_script_measures() -> None:
    names = {"ramps": ("law", "number", "phi", "seed"), "impurities": ("law", "number", "phi")}
    names["compressions"] = ("law", "number", "eta", "seed")
    for kind, keys in names.items():
        assert [tuple(row[key] for key in keys) for row in RESULT[kind]] == crystals.FULL[kind]
    for ramp in RESULT["ramps"]:
        assert tuple(ramp["up"]["eta"]) == crystals.UP
        assert tuple(ramp["down"]["eta"]) == crystals.DOWN
        for way in ("up", "down"):
            assert max(ramp[way]["residual"]) <= crystals.TOLERANCE
            assert not any(ramp[way]["beyond"])


def test_droplets_with_six_contacts_have_the_pressure_of_the_crystal() -> None:
    """To the tolerance of the relaxation; where psi_6 falls, neighbors have changed at z = 6."""
    compared = 0
    for (law, *_), ramps in GROUPS.items():
        for ramp in ramps if law == "droplets" else ():
            up = ramp["up"]
            left = (np.array(up["z"]) < 6.0) | (np.array(up["psi6"]) < 0.98)
            intact = int(np.argmax(left))
            assert up["pressure"][:intact] == pytest.approx(up["pressure"][:1] * intact, rel=2e-4)
            compared += intact
    assert compared > 100


def test_small_spreads_are_those_of_linear_response() -> None:
    for (_, phi, number), ramps in GROUPS.items():
        linear = [ramp["linear_u2"] for ramp in ramps]
        ratio = crystals.column(ramps, "u2")[:, 1] / 0.01**2 / linear
        assert ratio == pytest.approx(1.0, rel=0.02 if phi > 0.93 else 0.2), (phi, number)
    exact = {(row["law"], row["number"]): row["u2"] for row in RESULT["impurities"]}
    for law in LAWS:
        found, error = crystals.mean([ramp["linear_u2"] for ramp in of(law, 0.94, 256)])
        assert abs(found - exact[law, 256]) < 4.0 * error


def test_contacts_are_lost_long_before_order() -> None:
    compared = dict.fromkeys(LAWS, 0)
    for (law, *_), ramps in GROUPS.items():
        contacts = np.array(crystals.line(ramps, "z", crystals.LOST))
        order = np.array(crystals.line(ramps, "psi6", crystals.HALF))
        if np.isfinite(contacts).all():  # near confluence some keep six
            assert max(contacts) < np.nanmin(order)
            compared[law] += 1
    assert min(compared.values()) >= 4
    for law in ("soft rings", "droplets"):
        assert min(crystals.column(of(law, 0.99, 256), "psi6").min(axis=0)) > crystals.HALF


def test_deformable_particles_keep_their_order_longer() -> None:
    for number in (256, 1024, 4096):
        difference, error = apart("droplets", "disks", 0.94, number)
        assert difference > 3.0 * error, number


def test_the_order_of_the_laws_does_not_depend_on_the_level() -> None:
    for number in (256, 1024, 4096):
        for level in (crystals.HALF, *LEVELS):
            found = [half(law, 0.94, number, level) for law in LAWS]
            assert found == sorted(found), (number, level)


@pytest.mark.parametrize("name", SHOWN)
def test_the_log_has_all_tables(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    crystals.show(SHOWN[name])
    assert capsys.readouterr().out == (FOLDER / f"{name}.log").read_text()
