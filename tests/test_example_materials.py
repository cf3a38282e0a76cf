"""Materials of the examples: the physics that their pages claim."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from test_example_scripts import EXAMPLES, text


def part_of(script: Path, folder: Path, **values: object) -> None:
    """A copy of a script with other values of its constants."""
    lines = script.read_text()
    for name, value in values.items():
        lines, count = re.subn(rf"^{name} = .*", f"{name} = {value}", lines, flags=re.MULTILINE)
        assert count == 1, name
    (folder / script.name).write_text(lines)


def check_foam(printed: str, first: int) -> None:
    rows = np.array(
        [re.findall(r"\d[\d.]*", line) for line in re.findall("^time .*", printed, re.M)], float
    )
    _, bubbles, radius, spread, pressure, gas = rows.T
    assert bubbles[0] == first
    assert (np.diff(bubbles) <= 0).all()
    assert gas == pytest.approx(gas[0], rel=1e-6)  # printed with so many digits
    assert radius[-1] > 1.25 * radius[0]
    (left,) = re.findall(r"^square .* to (\S+)% of the last", printed, re.M)
    assert float(left) < 8
    assert (spread[len(spread) // 2 :] > 0.3).all()
    # pressures scale with tension over radius
    assert 0 < pressure[-1] < 0.8 * pressure[0]
    growth = re.findall(r"^phi (\S+)  growth (\S+) \(n - (\S+)\)", printed, re.M)
    phi, steepness, zero = np.array(growth, float).T
    assert len(phi) == 4
    assert (np.diff(steepness) > 0).all()
    assert steepness[0] < 0.5
    assert ((zero > 4.5) & (zero < 6.3)).all()
    assert zero[-1] == pytest.approx(6, abs=0.01)  # the mean number of neighbors, as all gas stays
    ((limit, exact),) = re.findall(r"without liquid (\S+), von Neumann (\S+)", printed)
    assert float(exact) == pytest.approx(2 * np.pi / 3, abs=1e-3)
    assert float(limit) == pytest.approx(float(exact), rel=0.1)


def test_foam(tmp_path: Path) -> None:
    """Gas is conserved, bubbles vanish and grow; von Neumann's law is the limit of dry foams."""
    pytest.importorskip("matplotlib")
    folder = EXAMPLES / "foam"
    check_foam((folder / "foam.log").read_text(), 400)
    part_of(folder / "foam.py", tmp_path, NUMBER=100, LAST=40)
    check_foam(text("python", "foam.py", cwd=tmp_path), 100)
    assert (tmp_path / "foam.png").stat().st_size > 10_000


def check_clones(printed: str, death: float) -> None:
    row = re.findall(r"^time (\S+)  cells (\S+)  phi (\S+)  pressure (\S+)$", printed, re.M)
    time, cells, phi, pressure = np.array(row, float).T
    # free cells grow by the rate, but for chance, and the dish fills
    free = (phi < 0.5) & (cells > 20)
    assert free.any()
    assert np.log(cells[free] / 12) == pytest.approx((1 - death) * time[free], abs=0.4)
    assert (np.abs(cells[phi > 0.9] / cells[-1] - 1) < 0.1).all()
    assert (pressure[phi < 0.6] == 0).all()
    assert (pressure[phi > 0.9] > 0.3).all()
    (clones,) = re.findall(r"^cells of each clone (.*)$", printed, re.M)
    sizes = np.array(clones.split(), int)
    assert sizes.sum() == cells[-1]
    assert len(sizes) <= 12


@pytest.mark.slow
def test_clones(tmp_path: Path) -> None:
    """Growth by the rate, then a steady state under pressure."""
    pytest.importorskip("matplotlib")
    folder = EXAMPLES / "clones"
    check_clones((folder / "clones.log").read_text(), 0.3)
    part_of(folder / "clones.py", tmp_path, **{"TIME, STATES": "8.0, 40", "DEATH": 0.0})
    check_clones(text("python", "clones.py", cwd=tmp_path), 0.0)
    assert (tmp_path / "clones.png").stat().st_size > 10_000


def test_page_of_clones_has_the_numbers_of_its_log() -> None:
    page, log = ((EXAMPLES / "clones" / name).read_text() for name in ("README.md", "clones.log"))
    late = list(re.findall(r"^time (\S+)  cells (\S+) .* (\S+)$", log, re.M))[3:]
    numbers = [int(cells) for _, cells, _ in late]
    assert f"{min(numbers)} to {max(numbers)} of them" in page
    pressures = [float(pressure) for *_, pressure in late]
    assert f"{min(pressures):.2f} to {max(pressures):.2f}" in page
    sizes = [int(n) for n in re.findall(r"clone (.*)$", log, re.M)[0].split()]
    assert f"largest of them has {max(sizes)} cells, the smallest {min(sizes)}" in page


def check_tissue(printed: str) -> None:
    rows: dict[str, list[list[float]]] = {}
    for name, values in re.findall(r"^(\S.*?) +time +(.*)$", printed, re.M):
        rows.setdefault(name, []).append([float(n) for n in re.findall(r"[\d.]+", values)])
    both, crawl, grow = (np.array(each).T for each in rows.values())
    for time, cells, uncovered, phi in (both, crawl, grow):
        assert len(time) >= 6
        assert cells[0] == crawl[1, 0] > 150
        assert uncovered[0] > 0.9
        assert phi[0] == pytest.approx(0.55, abs=0.03)
    # cells that only crawl spread until the scratch is as empty as all the rest, 1 - phi
    assert (crawl[1] == crawl[1, 0]).all()
    assert crawl[2, -3:].mean() == pytest.approx(1 - crawl[3, -1], abs=0.15)
    # growth closes it, and ends by itself
    for _, cells, uncovered, phi in (both, grow):
        assert cells[-1] > 1.5 * cells[0]
        assert cells[-1] - cells[-3] < 0.25 * (cells[-3] - cells[0])
        assert uncovered[-1] < 0.2
        assert 0.85 < phi[-1] < 0.97


@pytest.mark.slow
def test_tissue(tmp_path: Path) -> None:
    """Crawling spreads cells, growth and division close the scratch."""
    pytest.importorskip("matplotlib")
    folder = EXAMPLES / "tissue"
    check_tissue((folder / "tissue.log").read_text())
    for name in ("in.tissue", "tissue.deformable"):
        shutil.copy(folder / name, tmp_path)
    part_of(folder / "tissue.py", tmp_path, ROUNDS=25)
    check_tissue(text("python", "tissue.py", cwd=tmp_path))
    assert (tmp_path / "tissue.png").stat().st_size > 10_000
    log = text("lmp", "-in", "in.tissue", "-log", "none", cwd=tmp_path)
    inside = re.findall(r"^ +\d+ +171 +(\d+) ", log, re.M)
    assert len(inside) == 11
    assert int(inside[0]) == 0
    assert int(inside[-1]) > 30


def check_clogging(printed: str, trials: int) -> None:
    pattern = r"^weight (\S+)  width (\S+)  clogged (\d+) of (\d+)  passed (\S+)$"
    weight, width, clogged, of, passed = np.array(re.findall(pattern, printed, re.M), float).T
    assert (of == trials).all()
    # no droplet passes or hangs by chance: all have passed where nothing clogs
    assert (passed[clogged == 0] == 80).all()
    assert (passed[clogged == trials] < 70).all()
    light, heavy = weight == weight.min(), weight == weight.max()
    narrow, wide = width == width.min(), width == width.max()
    assert (clogged[light & narrow] == trials).all()
    assert (clogged[heavy & wide] == 0).all()
    assert clogged[light].sum() > clogged[heavy].sum() + 1
    halves = re.findall(r"^weight (\S+)  half of the trials clog at (\S+) ", printed, re.M)
    at = [float(width) for _, width in halves]
    assert at == sorted(at, reverse=True)
    assert len(at) == len(set(weight))


@pytest.mark.slow
def test_clogging(tmp_path: Path) -> None:
    """Light droplets, which are stiff, clog slits that heavy ones pass."""
    pytest.importorskip("matplotlib")
    folder = EXAMPLES / "clogging"
    check_clogging((folder / "clogging.log").read_text(), 12)
    smaller = {"WEIGHTS": (0.01, 0.1), "WIDTHS": (0.8, 1.5), "SEEDS": 2}
    part_of(folder / "clogging.py", tmp_path, **smaller)
    check_clogging(text("python", "clogging.py", cwd=tmp_path), 2)
    assert (tmp_path / "clogging.png").stat().st_size > 10_000


def test_pages_have_the_numbers_of_the_logs() -> None:
    page, log = (
        (EXAMPLES / "clogging" / name).read_text() for name in ("README.md", "clogging.log")
    )
    found = re.findall(r"^weight (\S+)  half of the trials clog at (.*)$", log, re.M)
    assert re.findall(r"^\| (\d\S*) \| (.*) \|$", page, re.M) == found
    page, log = ((EXAMPLES / "foam" / name).read_text() for name in ("README.md", "foam.log"))
    growth = [float(n) for n in re.findall(r"  growth (\S+) ", log)]
    limits = re.findall(r"without liquid (\S+), von Neumann (\S+)", log)[0]
    (left,) = re.findall(r", to (\S+)% of the last", log)
    for number in (growth[0], growth[-1], *map(float, limits)):
        assert f"{number:.2f}" in page
    assert f"{left} %" in page
