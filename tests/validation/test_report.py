"""The report in its smallest form: report.json, the page, and a report that goes on."""

import json
import math
import re
from html.parser import HTMLParser

import pytest
from lammps_deformable import FileError, ParameterError, PolygonModel
from lammps_deformable.report import standard_polygons
from validation.report.plan import Plan

from validation.report import __main__ as writing
from validation.report import results
from validation.report import section as numbers
from validation.report.__main__ import write_report
from validation.report.page import page
from validation.report.section import Column, Picture, Section, Table

MODELS = [standard_polygons(40, smooth=kind) for kind in (True, False)]
SMALLEST = Plan(
    ablation={"number": 64, "steps": 2, "repeats": 1},
    pareto=[(8, 1, 57, 0.015, 1, (38,), (38,))],
    smooth=[(8, 1, 38, 0.015, 1)],
    friction=[(MODELS[0], 0.04, 2), (MODELS[1], 0.04, 2, 1e-2)],
    hysteresis=[(4, 2, model, 0.03, 2) for model in MODELS],
    crystal=[(MODELS[0], 0.03)],
    large=(8, 3, 0.03, PolygonModel(vertices=16)),
    mixtures=[(8, 1, 0.03, 38, (1.0, 10.0), (0.1, math.inf))],
    shapes={"indentations": (0.02,), "number": 24, "kL": 100.0},
    stiffness={"indentations": (0.01, 0.02), "number": 24, "kL": (1.0, 100.0)},
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
        patch.setattr(writing, "QUICK", SMALLEST)
        patch.setattr("os.sched_getaffinity", lambda _: {0})  # calls stay in this process
        lines = []
        write_report(folder, quick=True, print_once=lines.append)
    assert len(lines) == 12
    return folder


def test_json(folder):
    rows = json.loads((folder / "report.json").read_text())
    assert set(rows) == {*KEYS, "limit", "machine", "versions", "quick"}
    for name, keys in KEYS.items():
        assert rows[name]
        for row in rows[name]:
            assert set(keys.split()) <= set(row)
    assert {row["law"] for row in rows["packing"]} == {"disk", *LAWS}
    methods = [row["method"] for row in rows["pareto"]]
    assert methods == ["disk", *LAWS, "smooth", "bead", "reference"]
    assert {row["law"] for row in rows["ablation"]} == {"disk", *LAWS} - {"curved"}
    assert {row["law"] for row in rows["smooth"]} == {*LAWS}
    assert {row["law"] for row in rows["smooth"] if row["own"]} == {*LAWS} - {"sector"}
    assert {row["walls"] for row in rows["single"]} == {"stick", "slip"}
    assert {row["sides"] for row in rows["single"]} == {3, 4, 5, 6}
    assert rows["machine"]["cores"] >= 1
    assert "lammps" in rows["versions"]
    for row in (*rows["pareto"], *rows["packing"]):
        assert row["seconds"] is None if row.get("method") == "sector" else row["seconds"] > 0.0


def test_files(folder):
    page = (folder / "index.html").read_text()
    pictures = re.findall(r'<img src="([^"]+)"', page)
    expected = {"index.html", "report.json", *pictures}
    assert {path.name for path in folder.iterdir()} == expected
    assert len(pictures) == 11


class Reader(HTMLParser):
    """Tags that are not closed, targets of links, cells, and pictures without a description."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.cells, self.silent = [], set(), [], [], []

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)
        self.ids.add(attrs.get("id"))
        if tag == "a":
            self.links.append(attrs["href"].removeprefix("#"))
        if tag == "img" and not attrs.get("alt"):
            self.silent.append(attrs["src"])
        if tag in ("td", "th"):
            self.cells.append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "td" in self.open or "th" in self.open:
            self.cells[-1] += data


def test_page(folder):
    """A table of contents, described pictures, words instead of keys, and no raw values."""
    text = (folder / "index.html").read_text()
    reader = Reader()
    reader.feed(text)
    assert reader.open == []
    assert len(reader.links) == text.count("<h2 ") == 12
    assert set(reader.links) <= reader.ids
    assert reader.silent == []
    assert not {"nan", "inf", "True", "False", "None", ""} & set(reader.cells)
    assert not [cell for cell in reader.cells if "_" in cell or len(cell) > 60]
    assert "balanced, kP inf" in reader.cells
    assert "0.10 | 49" in reader.cells  # kP of a mixture
    assert "∞" not in re.sub(r"<td.*?</td>", "", text)


def test_numbers_of_the_page_are_those_of_the_rows(folder):
    rows = json.loads((folder / "report.json").read_text())
    text = (folder / "index.html").read_text()
    (balanced,) = (row for row in rows["pareto"] if row["method"] == "balanced")
    for key in ("error", "energy_error", "seconds"):
        assert f"<td>{numbers.show(balanced[key])}</td>" in text
    kept = sum(row["ok"] for row in rows["stability"])
    assert f"{kept} of {len(rows['stability'])} measurements" in text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (True, "yes"),
        (False, "no"),
        (3, "3"),
        (0.0, "0"),
        (10.0, "10"),
        (1e-6, "10⁻⁶"),
        (1.0, "1"),
        (0.0123, "0.012"),
        (-0.5, "−0.50"),
        (123.4, "123"),
        (1.26e-4, "1.3\u00a0×\u00a010⁻⁴"),
        (2.5e12, "2.5\u00a0×\u00a010¹²"),
        (["inf", 6.0], "∞, 6"),
    ],
)
def test_values_for_a_reader(value, text):
    assert numbers.show(value) == text


def test_ranges():
    assert numbers.span([0.7123, None, 0.82]) == "0.71 to 0.82"
    assert numbers.span([0.7123, 0.7124]) == "0.71"
    assert numbers.span([None]) == "–"
    assert numbers.listed(["a"]) == "a"
    assert numbers.listed(["a", "b", "c"]) == "a, b and c"


def test_text_of_a_page_is_escaped():
    table = Table("a < b", [Column("x", "x & y", 'say "x"', "s")], [{"x": "<i>"}], folded=True)
    section = Section("1 < 2", ["a & b"], {"<": ">"}, [Picture("a.png", "<p>", '"')], [table])
    text = page("<t>", "<l>", [section])
    Reader().feed(text)
    for raw in ("<i>", "<l>", "<t>", "1 < 2", "a < b", "a & b", "x & y"):
        assert raw not in text


def test_an_interrupted_report_goes_on(tmp_path, monkeypatch):
    """Parts that are there are used, and never discarded without asking."""
    monkeypatch.setattr(writing, "QUICK", SMALLEST)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0})  # calls stay in this process
    measured = []

    def stand_in(name):
        def measure(*arguments, **settings):
            measured.append(name)
            if name == "stability_rows":
                raise KeyboardInterrupt
            return name

        measure.__name__ = measure.__qualname__ = name
        return measure

    rows = ("cost_rows", "pareto_rows", "packing_rows", "smooth_rows", "sliding", "hysteresis")
    rows += ("crystal_row", "mixed_rows")
    for name in (*rows, "stability_rows"):
        monkeypatch.setattr(results, name, stand_in(name))
    for name in ("shapes", "stiffness_sweep", "limit"):
        monkeypatch.setattr(results.paper, name, stand_in(name))
    with pytest.raises(ParameterError, match="nothing to resume"):
        write_report(tmp_path, quick=True, resume=True)
    assert not list(tmp_path.iterdir())

    def interrupted(**how):
        measured.clear()
        with pytest.raises(KeyboardInterrupt):
            write_report(tmp_path, **how)
        return list(measured)

    def refused(kind, *words, **how):
        before = {path: path.read_bytes() for path in tmp_path.rglob("*.pkl")}
        measured.clear()
        with pytest.raises(kind) as error:
            write_report(tmp_path, **how)
        assert [word for word in words if word not in str(error.value)] == []
        assert measured == []
        assert {path: path.read_bytes() for path in tmp_path.rglob("*.pkl")} == before != {}

    calls = len(rows) + 2 + 3 + 1  # friction and hysteresis of both kinds of polygons
    assert len(interrupted(quick=True)) == calls
    for quick in (True, False):
        refused(FileError, str(tmp_path), "--resume", "--overwrite", quick=quick)
    refused(ParameterError, "--resume", "--overwrite", resume=True, overwrite=True)
    assert interrupted(quick=True, resume=True) == ["stability_rows"]
    assert interrupted(resume=True) == ["stability_rows"]  # still the quick one
    assert len(interrupted(quick=True, overwrite=True)) == calls
    assert len(interrupted(overwrite=True)) > 30
    assert interrupted(resume=True) == ["stability_rows"]
    refused(ParameterError, "--quick", "--overwrite", quick=True, resume=True)
    assert [path.name for path in tmp_path.iterdir()] == ["parts"]


def test_a_complete_report_is_not_replaced_without_asking(folder):
    before = (folder / "report.json").read_bytes()
    with pytest.raises(FileError, match=f"'{folder}' holds a report: .*--overwrite"):
        write_report(folder, quick=True)
    assert (folder / "report.json").read_bytes() == before


def test_no_matplotlib(tmp_path, monkeypatch):
    monkeypatch.setattr(writing.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ParameterError, match=r"pip install lammps-deformable\[plot\]"):
        write_report(tmp_path / "none")
    assert not (tmp_path / "none").exists()


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
