"""The report in its smallest form: every list with its keys, every picture that the page shows."""

import json
import re

import pytest
from deformable import Beads, report

SMALLEST = report.Plan(
    ablation={"number": 64, "steps": 2, "repeats": 1},
    pareto={"number": 8, "seed": 1, "strain": 0.03, "bead_numbers": [20, 25]},
    large=(8, 1, 0.03, Beads(number=16)),
    packings=[(8, 2, 0.03, Beads(number=16))],
    shapes={"indentations": (0.02,), "number": 24, "kL": 100.0},
    stiffness={"indentations": (0.01, 0.02), "number": 24, "kL": (1.0, 100.0)},
    number={"indentations": (0.02,), "numbers": (16, 24), "kP": (1.0,)},
    limits=[(6, 0.05, (16, 24), (5.0, 10.0))],
)

KEYS = {
    "single": "sides walls beads kL a_over_R I_sector I_ring S_dp S_sector S_ring seconds_dp "
    "seconds_model",
    "packing": "n strain beads seed model I S_rms energy_ratio pressure_ratio seconds",
    "pareto": "method error seconds",
    "ablation": "law option on",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "QUICK", SMALLEST)
        report.write_report(folder, quick=True)
    return folder


def test_json(folder):
    rows = json.loads((folder / "report.json").read_text())
    for name, keys in KEYS.items():
        assert rows[name]
        for row in rows[name]:
            assert set(keys.split()) <= set(row)
    assert {row["model"] for row in rows["packing"]} == {"disk", "sector", "ring", "soft ring"}
    assert [row["method"] for row in rows["pareto"]] == [
        *("disk", "sector", "ring", "soft ring"),
        *("beads", "beads"),
    ]
    assert {row["walls"] for row in rows["single"]} == {"stick", "slip"}
    assert {row["sides"] for row in rows["single"]} == {3, 4, 5, 6}
    assert rows["machine"]["cores"] >= 1
    assert "lammps" in rows["versions"]
    disk = next(row for row in rows["pareto"] if row["method"] == "disk")
    assert disk["error"] == 1.0  # S = 0
    for row in (*rows["pareto"], *rows["packing"]):
        assert row["seconds"] > 0.0


def test_page(folder):
    page = (folder / "index.html").read_text()
    pictures = re.findall(r'<img src="([^"]+)"', page)
    assert sorted(pictures) == sorted(path.name for path in folder.glob("*.png"))
    assert page.count("<h2>") == 6
    assert "nan" not in re.sub(r"<[^>]+>", " ", page).split()


def test_no_matplotlib(tmp_path, monkeypatch):
    monkeypatch.setattr(report.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(report.ParameterError, match=r"pip install lammps-deformable\[plot\]"):
        report.write_report(tmp_path / "none")
    assert not (tmp_path / "none").exists()
