"""The report of the site in its smallest form: report.json, its pictures, and its page."""

import json
import math
import re
from pathlib import Path

import pytest
from lammps_deformable import DeformablePolygon
from lammps_deformable.reference.comparison import standard_polygons

from validation.report import __main__ as report
from validation.report import section as numbers
from validation.report.__main__ import Plan
from validation.report.page import page, sections

MODELS = [standard_polygons(40, smooth=kind) for kind in (True, False)]
SMALLEST = Plan(
    ablation={"number": 64, "steps": 2, "repeats": 1},
    pareto=[(8, 1, 57, 0.015, 1, (19, 38), (38,))],
    smooth=[(8, 1, 38, 0.015, 1)],
    friction=[(MODELS[0], 0.04, 2), (MODELS[1], 0.04, 2, 1e-2)],
    hysteresis=[(4, 2, model, 0.03, 2) for model in MODELS],
    crystal=[(MODELS[0], 0.03)],
    large=(8, 3, 0.03, DeformablePolygon(16, smooth=False)),
    mixtures=[(8, 1, 0.03, 38, (1.0, 10.0), (0.1, math.inf))],
    shapes={"indentations": (0.02,), "number": 24, "kL": 100.0},
    stiffness={"indentations": (0.01, 0.02), "number": 30, "kL": (1.0, 100.0)},
    limits=[(6, 0.05, (16, 24), (5.0, 10.0))],
    stability={"packings": 1, "steps": 400, "densest": 0.92},
)

KEYS = {
    "single": "sides walls n_v kL a_over_R I_sector I_ring_kP_inf I_ring S_dp S_sector "
    "S_ring_kP_inf S_ring seconds_dp seconds_law",
    "packing": "n strain n_v seed law I S_rms energy_ratio pressure_ratio seconds",
    "smooth": "n seed strain n_v law own energy_ratio pressure_ratio S_rms I distance residual",
    "stiffness_packing": "n strain n_v kA kP seed law kP_law I S_rms energy_ratio "
    "pressure_ratio own_energy_ratio own_pressure_ratio seconds",
    "pareto": "method vertices energy_error error seconds",
    "friction": "n_v smooth friction residual",
    "hysteresis": "n_v smooth strain ratio",
    "crystal": "n_v indentation energy_ratio residual",
    "ablation": "law option on",
    "stability": "case law quantity value limit ok reason",
}
LAWS = ["sector", "radical, kP inf", "radical", "balanced", "curved"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "QUICK", SMALLEST)
        patch.setattr("os.sched_getaffinity", lambda _: {0})  # calls stay in this process
        report.report(folder, quick=True, overwrite=False)
    return folder


@pytest.mark.slow
def test_json(folder):
    rows = json.loads((folder / "report.json").read_text())
    assert set(rows) == {*KEYS, "limit", "machine", "versions", "quick"}
    for name, keys in KEYS.items():
        assert rows[name]
        for row in rows[name]:
            assert set(keys.split()) <= set(row)
    assert {row["law"] for row in rows["packing"]} == {"disk", *LAWS}
    methods = [row["method"] for row in rows["pareto"]]
    assert methods == ["disk", *LAWS, "smooth", "smooth", "bead", "reference"]
    assert {row["law"] for row in rows["ablation"]} == {"disk", *LAWS} - {"curved"}
    assert {row["law"] for row in rows["smooth"]} == {*LAWS}
    assert {row["law"] for row in rows["smooth"] if row["own"]} == {*LAWS} - {"sector"}
    assert {row["walls"] for row in rows["single"]} == {"stick", "slip"}
    assert {row["sides"] for row in rows["single"]} == {3, 4, 5, 6}
    assert rows["machine"]["cores"] >= 1
    assert "lammps" in rows["versions"]
    for row in (*rows["pareto"], *rows["packing"]):
        assert row["seconds"] is None if row.get("method") == "sector" else row["seconds"] > 0.0


@pytest.mark.slow
def test_pictures_are_those_of_the_page(folder):
    text = page(json.loads((folder / "report.json").read_text()))
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", text)
    assert len(pictures) == 11
    assert {path.name for path in folder.iterdir()} == {"report.json", *pictures}
    with pytest.raises(SystemExit, match="holds a report: give --overwrite"):
        report.report(folder, quick=True, overwrite=False)


def test_page_of_the_committed_report():
    """Described pictures that are there, words instead of keys, and no raw values."""
    folder = Path(report.__file__).parent
    content = json.loads((folder / "report.json").read_text())
    text = page(content)
    assert len(re.findall("^## ", text, re.M)) == len(sections(content)) == 12
    for picture in re.findall(r"!\[[^]]+\]\(([^)]+)\)", text):
        assert (folder / picture).is_file()
    cells = re.findall("<t[dh]>(.*?)</t[dh]>", text)
    assert not {"nan", "NaN", "inf", "True", "False", "None", ""} & set(cells)
    assert not [cell for cell in cells if "_" in cell or len(cell) > 60]
    assert "balanced, kP inf" in cells
    assert "0.10 | 49" in cells  # kP of a mixture
    (balanced,) = (row for row in content["pareto"] if row["method"] == "balanced")
    for key in ("error", "energy_error", "seconds"):
        assert f"<td>{numbers.show(balanced[key])}</td>" in text
    kept = sum(row["ok"] for row in content["stability"])
    assert f"{kept} of {len(content['stability'])} measurements" in text


def test_values_for_a_reader():
    for value, text in (
        (None, "–"),
        (True, "yes"),
        (3, "3"),
        (0.0, "0"),
        (10.0, "10"),
        (1e-6, "10⁻⁶"),
        (0.0123, "0.012"),
        (-0.5, "−0.50"),
        (123.4, "123"),
        (1.26e-4, "1.3\u00a0×\u00a010⁻⁴"),
        (2.5e12, "2.5\u00a0×\u00a010¹²"),
        (["inf", 6.0], "∞, 6"),
    ):
        assert numbers.show(value) == text


def test_ranges():
    assert numbers.span([0.7123, None, 0.82]) == "0.71 to 0.82"
    assert numbers.span([0.7123, 0.7124]) == "0.71"
    assert numbers.span([None]) == "–"
    assert numbers.listed(["a"]) == "a"
    assert numbers.listed(["a", "b", "c"]) == "a, b and c"


@pytest.mark.slow
def test_stability(folder):
    """Ring laws pass up to confluence; failures of the sector law have reasons."""
    rows = json.loads((folder / "report.json").read_text())["stability"]
    assert {row["law"] for row in rows} == {"radical", "balanced", "curved", "sector"}
    missed = [row for row in rows if not row["ok"]]
    assert {row["law"] for row in missed} == {"sector"}
    assert {row["quantity"] for row in missed} >= {
        "residual of FIRE",
        "relative change of S",
        "order of the energy error, distance from 2",
    }
    assert all(row["reason"] for row in missed)
