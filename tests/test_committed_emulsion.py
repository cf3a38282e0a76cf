"""What examples/emulsion/README.md says of 512 droplets follows from the committed measurements."""

import importlib.util
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from programs import program

pytest.importorskip("matplotlib")

FOLDER = Path(__file__).parents[1] / "examples" / "emulsion"
README = (FOLDER / "README.md").read_text()
spec = importlib.util.spec_from_file_location("fits", FOLDER / "fits.py")
assert spec is not None
assert spec.loader is not None
fits = importlib.util.module_from_spec(spec)
spec.loader.exec_module(fits)


def read(name: str) -> dict:
    return json.loads((FOLDER / f"{name}.json").read_text())


RESULT = read("emulsion_512")
SUMMARY = fits.summary(RESULT)


def test_it_is_an_ensemble() -> None:
    packings = RESULT["packings"]
    assert RESULT["number"] == 512
    assert [packing["seed"] for packing in packings] == list(range(1, len(packings) + 1))
    assert f"--number 512 --seeds {len(packings)}\n" in README
    assert len(packings) >= 5
    for packing in packings:
        assert max(packing["residual"]) < 1e-7
        assert not any(packing["beyond"])


def test_the_page_has_the_table_and_the_fits() -> None:
    for line in fits.table(RESULT):
        assert line in README
    for name, value in SUMMARY.items():
        terms = (
            zip(value["coefficients"], value["errors"], strict=True)
            if isinstance(value, dict)
            else [value]
        )
        assert all(fits.with_error(*term) in README for term in terms), name


def test_a_single_packing_has_values_without_errors(capsys: pytest.CaptureFixture[str]) -> None:
    fits.show(RESULT | {"packings": RESULT["packings"][:1]})
    printed = capsys.readouterr().out
    assert "nan" not in printed
    assert f"phi_J: {RESULT['packings'][0]['phi_J']:.4g}\n" in printed
    assert "| 0.95 | " in printed


def test_fits_alone_need_no_packing(tmp_path: Path) -> None:
    """The command of the page, in a folder as it is committed."""
    for name in ("fits.py", "emulsion_512.json"):
        shutil.copy(FOLDER / name, tmp_path)
    result = program("python", "fits.py", "emulsion_512.json", cwd=tmp_path)
    assert (result.returncode, len(result.stderr.splitlines())) == (0, 1)
    assert "packing_512" in result.stderr
    assert next(fits.table(RESULT)) in result.stdout


def test_droplets_jam_where_disks_do() -> None:
    """At 0.84; disks of the same number and sizes at 0.8399 +- 0.0006 (docs/jamming.md)."""
    onset, error = SUMMARY["phi_J"]
    assert abs(onset - 0.8399) < 2.0 * np.hypot(error, 0.0006)
    at_onset = [packing["excess_contacts"] for packing in RESULT["packings"]]
    assert min(at_onset) == 0


def test_pressure_rises_linearly() -> None:
    """The exponent is a little above 1, because contacts are added on the way."""
    power, error = SUMMARY["exponent of pressure"]
    assert abs(power - 1.0) < 0.1
    assert error < 0.05
    bulk, error = SUMMARY["exponent of bulk_modulus"]
    assert abs(bulk - (power - 1.0)) < 3.0 * error + 0.05


def test_contacts_rise_as_a_square_root_first_and_linearly_then() -> None:
    def chi2(shape: str, widest: float) -> float:
        return SUMMARY[f"contacts, {shape}, up to {widest}"]["chi2"]

    assert chi2("square root", fits.CLOSE) < chi2("linear", fits.CLOSE)
    for shape in ("square root", "linear"):
        assert chi2("both", fits.WIDE) < 0.5 * chi2(shape, fits.WIDE)


def test_dense_droplets_have_the_pressure_of_hexagonal_arrays() -> None:
    packings = RESULT["packings"]
    phi = fits.column(packings, "phi")[0]
    dense = phi > 0.96
    pressure = fits.column(packings, "pressure").mean(axis=0)[dense]
    assert pressure == pytest.approx(fits.princen(phi[dense]), rel=0.1)
    assert (fits.column(packings, "coordination")[:, phi > 0.985] == 6.0).all()
