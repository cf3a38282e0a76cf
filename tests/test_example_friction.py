"""Examples whose contacts rub: what their pages claim."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from example_modules import example
from programs import output
from test_example_scripts import EXAMPLES


def tables(printed: str) -> list[np.ndarray]:
    """The numbers of both tables."""
    return [
        np.array([row.split() for row in re.findall(r"^\d\.\d +.*$", part, re.M)], float)
        for part in printed.split("\n\n")
    ]


def rows(printed: str) -> np.ndarray:
    """The columns of a table below its head."""
    return np.array([re.findall(r"\d[.\d]*", row) for row in printed.splitlines()[1:]], float).T


def test_restitution(tmp_path: Path) -> None:
    """Restitution and sliding in closed form; energies balance; the log is that of a run."""
    pytest.importorskip("matplotlib")
    folder = shutil.copytree(EXAMPLES / "restitution", tmp_path / "restitution")
    (folder / "restitution.png").unlink()
    head_on, off_center = tables(output("python", "restitution.py", cwd=folder, MPLBACKEND="agg"))
    assert (folder / "restitution.png").stat().st_size > 10_000
    _, found, expected, error = head_on.T
    np.testing.assert_allclose(found, expected, rtol=0, atol=4.1e-4)
    assert np.abs(error).max() < 1e-5
    mu, before, after, slid, error = off_center.T
    slides = before > 4 * mu  # fast enough
    np.testing.assert_allclose(after[slides], slid[slides], rtol=0, atol=0.03)
    assert (after[~slides] > slid[~slides]).all()
    assert after[(mu == 0.3) & (before == 0.5)] < -0.3  # the spring throws it back
    assert np.abs(error).max() < 1e-5
    logged = tables((EXAMPLES / "restitution" / "restitution.log").read_text())
    np.testing.assert_allclose(logged[0][:, :3], head_on[:, :3], rtol=0, atol=2e-4)
    np.testing.assert_allclose(logged[1][:, :4], off_center[:, :4], rtol=0, atol=2e-3)


@pytest.mark.slow
def test_heap(tmp_path: Path) -> None:
    """The angle grows with the friction of contacts; the log is that of a run."""
    pytest.importorskip("matplotlib")
    folder = shutil.copytree(EXAMPLES / "heap", tmp_path / "heap")
    _, angle, error, stay, used = rows(output("python", "heap.py", cwd=folder, MPLBACKEND="agg"))
    assert angle[-1] > angle[0] + 2 * np.hypot(error[0], error[-1])
    assert stay[-1] > stay[0]
    assert (used < 0.6).all()  # at rest
    _, logged, uncertain, *_ = rows((EXAMPLES / "heap" / "heap.log").read_text())
    # other last digits make other heaps
    assert (np.abs(logged - angle) < 4 * np.hypot(uncertain, error) + 1).all()


def test_jamming_of_droplets_that_rub() -> None:
    """At rest within Coulomb's bound, with as many forces as balance needs.

    Forces f and f_t of contacts are as many unknowns; those of fully mobilized ones are one. N'
    particles have 3 N' equations, less two for the motion of all, and one for the pressure; without
    friction 2 N'.
    """
    pytest.importorskip("matplotlib")
    jamming = example("frictional_jamming", "frictional_jamming")
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
    pytest.importorskip("matplotlib")
    results = example("frictional_jamming", "frictional_jamming").results
    folder = EXAMPLES / "frictional_jamming"
    page = (folder / "README.md").read_text()
    for file in (folder / "small.json", folder / "large.json"):
        found = json.loads(file.read_text())
        logged = file.with_suffix(".log").read_text().splitlines()[2:]
        for row, line in zip(results.table(found), logged, strict=False):
            mu, *cells = re.findall(r"\d[.\d]*", line)
            exact = np.ravel([row[name] for name in results.MEANS])
            digits = np.repeat([10.0**-n for n in results.MEANS.values()], 2)
            assert float(mu) == row["mu"]
            assert (np.abs(np.array(cells, float) - exact) < 0.51 * digits).all()
            told = " | ".join(" ± ".join(cells[n : n + 2]) for n in (0, 2, 4))
            assert f"| {mu} | {told} |" in page
        states = [state for each in found["packings"] for state in each["states"]]
        assert all(state["at_rest"] and state["coulomb"] <= 1e-6 for state in states)
        assert max(max(state["force"], state["torque"]) for state in states) < 1.1e-4


def test_friction_of_beads_on_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Log and page have those of the packings; mu is where rings have as many contacts."""
    pytest.importorskip("matplotlib")
    folder = EXAMPLES / "frictional_jamming"
    beads = example("frictional_jamming", "beads")
    found = json.loads((folder / "beads.json").read_text())
    monkeypatch.chdir(tmp_path)
    beads.results.write_beads(found, beads.with_error)
    page = (folder / "README.md").read_text()
    lines, again = (
        [re.findall(r"\d[.\d]*", line) for line in (place / "beads.log").read_text().splitlines()]
        for place in (folder, tmp_path)
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
        {"mu": mu, "z": z, "seed": 1} for mu, z in zip(beads.FRICTION, range(9, 3, -1), strict=True)
    ]
    assert beads.friction_of([{"z": 6.0}], rings, "z") == pytest.approx(0.3)
    assert beads.friction_of([{"z": 6.5}], rings, "z") == pytest.approx(np.sqrt(0.1 * 0.3))


@pytest.mark.slow
def test_frictional_jamming_as_it_stands(tmp_path: Path) -> None:
    """The numbers on record are those of a run, within errors: other digits jam otherwise."""
    pytest.importorskip("matplotlib")
    folder = shutil.copytree(EXAMPLES / "frictional_jamming", tmp_path / "jamming")
    recorded = json.loads((folder / "small.json").read_text())
    output("python", "frictional_jamming.py", cwd=folder, MPLBACKEND="agg")
    results = example("frictional_jamming", "frictional_jamming").results
    again = json.loads((folder / "small.json").read_text())
    for old, new in zip(results.table(recorded), results.table(again), strict=True):
        for name in ("phi", "z"):
            apart, error = old[name][0] - new[name][0], np.hypot(old[name][1], new[name][1])
            assert abs(apart) < 4.0 * error + 0.002
