"""Jamming with friction: what holds for every packing, and what the page says."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from programs import study

from validation.frictional_jamming import __main__ as jamming

FOLDER = Path(jamming.__file__).parent
DIGITS = {"phi": 3, "z": 2}


def test_jamming_of_droplets_that_rub() -> None:
    """At rest within Coulomb's bound, with as many forces as balance needs.

    Forces f and f_t of contacts are as many unknowns; those of fully mobilized ones are one. N'
    particles have 3 N' equations, less two for the motion of all, and one for the pressure; without
    friction 2 N'.
    """
    smooth, rough = (jamming.jammed(32, mu, 3, (1e-3,), 0.01)["states"][0] for mu in (0.0, 10.0))
    for state in (smooth, rough):
        assert state["at_rest"]
        assert state["pressure"] == pytest.approx(1e-3, rel=1e-4)
        assert max(state["force"], state["torque"]) < 1.1e-4
        assert state["coulomb"] <= 1e-12
    assert smooth["contacts"] >= 2 * smooth["rigid"] - 1
    assert 2 * rough["contacts"] - rough["mobilized"] >= 3 * rough["rigid"] - 1
    assert rough["z"] < smooth["z"] - 0.2  # of 1, more than five times the scatter of packings


def test_numbers_of_frictional_jamming() -> None:
    """The log and the page have those of the packings on record."""
    page = (FOLDER / "README.md").read_text()
    for file in (FOLDER / "small.json", FOLDER / "large.json"):
        found = json.loads(file.read_text())
        logged = file.with_suffix(".log").read_text().splitlines()[2:]
        for row, line in zip(jamming.table(found), logged, strict=False):
            mu, *cells = re.findall(r"\d[.\d]*", line)
            exact = np.ravel([row[name] for name in jamming.MEANS])
            digits = np.repeat([10.0**-n for n in jamming.MEANS.values()], 2)
            assert float(mu) == row["mu"]
            assert (np.abs(np.array(cells, float) - exact) < 0.51 * digits).all()
            if file.stem == "large":
                told = " | ".join(" ± ".join(cells[n : n + 2]) for n in (0, 2, 4))
                assert f"| {mu} | {told} |\n" in page
                assert row["packings"] == 20
        states = [state for each in found["packings"] for state in each["states"]]
        assert all(state["at_rest"] and state["coulomb"] <= 1e-6 for state in states)
        assert max(max(state["force"], state["torque"]) for state in states) < 1.1e-4


def test_limits_of_frictional_jamming() -> None:
    """Isostatic without friction and with much; the onset of soft disks without."""
    page = " ".join((FOLDER / "README.md").read_text().split())
    first, *_, last = rows = jamming.table(json.loads((FOLDER / "large.json").read_text()))
    fall = {name: [f"{row[name][0]:.{n}f}" for row in (first, last)] for name, n in DIGITS.items()}
    assert (
        f"phi_J falls from {fall['phi'][0]} to {fall['phi'][1]} and the number of contacts z from "
        f"{fall['z'][0]} to {fall['z'][1]}"
    ) in page
    most = max(row["mobilized"][0] for row in rows)
    told = "At rest few contacts are fully mobilized, with 99.9 % of their friction: at the lowest"
    assert f"{told} pressure at most {most:.3f} for each particle." in page
    for row, equations, constant in ((first, 4.0, 2.0), (last, 3.0, 1.0)):
        rigid = 64.0 - row["rattlers"][0]
        assert row["z"][0] == pytest.approx(equations - constant / rigid, abs=0.03)
    onsets = json.loads((FOLDER.parent / "jamming" / "summary.json").read_text())["onset"]
    (disks,) = (row for row in onsets if (row["law"], row["number"]) == ("disk", 64))
    (phi, error), other = first["phi"], disks["phi_error"]
    assert abs(phi - disks["phi"]) < 2.0 * np.hypot(error, other)


def test_friction_of_beads_on_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Log and page have those of the packings; mu is where rings have as many contacts."""
    found = json.loads((FOLDER / "beads.json").read_text())
    monkeypatch.chdir(tmp_path)
    jamming.write_beads(found)
    page = (FOLDER / "README.md").read_text()
    lines, again = (
        [re.findall(r"\d[.\d]*", line) for line in (place / "beads.log").read_text().splitlines()]
        for place in (FOLDER, tmp_path)
    )
    for line, other in zip(lines[1:], again[1:], strict=True):
        for cell, exact in zip(line, other, strict=True):
            last = 10.0 ** -len(cell.partition(".")[2])
            assert abs(float(cell) - float(exact)) < 1.01 * last
        if len(line) == 10:
            number, hollow, *pairs = line
            told = " | ".join(" ± ".join(pairs[n : n + 2]) for n in (0, 2, 4, 6))
            assert f"| {number} | {hollow} | {told} |" in page
    rings = [
        {"mu": mu, "z": z, "seed": 1}
        for mu, z in zip(jamming.FRICTION, range(9, 3, -1), strict=True)
    ]
    assert jamming.friction_of([{"z": 6.0}], rings, "z") == pytest.approx(0.3)
    assert jamming.friction_of([{"z": 6.5}], rings, "z") == pytest.approx(np.sqrt(0.1 * 0.3))


@pytest.mark.slow
def test_frictional_jamming_as_it_stands(tmp_path: Path) -> None:
    """The numbers on record are those of a run, within errors: other digits jam otherwise."""
    recorded = json.loads((FOLDER / "small.json").read_text())
    study("frictional_jamming", cwd=tmp_path)
    again = json.loads((tmp_path / "small.json").read_text())
    for old, new in zip(jamming.table(recorded), jamming.table(again), strict=True):
        for name in ("phi", "z"):
            apart, error = old[name][0] - new[name][0], np.hypot(old[name][1], new[name][1])
            assert abs(apart) < 4.0 * error + 0.002
