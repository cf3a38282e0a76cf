"""No tuned constant of the solver changes forces: each at a tenth and at ten times its value."""

import re
from pathlib import Path

import numpy as np
import pytest
from droplets import CASES, Droplets
from laws import BALANCES
from parallel import lmp
from scene import PACKINGS, Scene

TOLERANCE = 1e-8
HEADER = Path(__file__).parents[2] / "src" / "solver" / "tuning.h"
# members and their values, which tuning.cpp reads by these names
TUNED = {
    name: float(value)
    for name, value in re.findall(r"^  double (\w+) = ([\d.e]+);", HEADER.read_text(), re.MULTILINE)
}
MOTION = "fix move all nve\nvelocity all create 1e-4 4711 loop all\ntimestep 0.02\nrun 12 post no"


def rings(style):
    scene = Scene.packing(PACKINGS[0], f"{style} balance {TOLERANCE} 1000 reach 0.8")
    scene.run(MOTION)
    return scene.gather("x", 3), scene.gather("f", 3)


def droplets(folder):
    scene = Droplets(CASES[0], folder, style=f"deformable/droplet balance {TOLERANCE} 1000")
    scene.run(MOTION)
    return scene.x, scene.force


def law(name, folder):
    return droplets(folder) if name == "droplet" else rings(BALANCES[name])


def test_all_members_have_names():
    source = HEADER.with_suffix(".cpp").read_text()
    assert set(re.findall(r"&t\.(\w+)", source)) == set(TUNED)
    assert len(TUNED) > 15


@pytest.mark.parametrize("name", ["balanced", "curved", "droplet"])
def test_extremes(name, tmp_path, monkeypatch):
    """Positions after a few steps too: an error of the forces moves particles by less.

    Net forces of droplets are a tenth of those of their contacts.
    """
    x, force = law(name, tmp_path)
    scale = np.abs(force).max() * (10 if name == "droplet" else 1)
    for member, value in TUNED.items():
        for extreme in (0.0,) if value == 1.0 else (0.1 * value, 10 * value):  # 1: a switch
            monkeypatch.setenv("DEFORMABLE_TUNING", f"{member}={extreme}")
            other_x, other = law(name, tmp_path)
            assert other == pytest.approx(force, abs=10 * TOLERANCE * scale), (member, extreme)
            assert other_x == pytest.approx(x, abs=10 * TOLERANCE), (member, extreme)


@pytest.mark.parametrize("words", ["margins=1", "margin", "margin=", "margin=large"])
def test_a_wrong_word(words, monkeypatch):
    monkeypatch.setenv("DEFORMABLE_TUNING", words)
    with pytest.raises(Exception, match=f"DEFORMABLE_TUNING: '{words}' is no name=number"):
        rings(BALANCES["balanced"])


PAIR = """
units lj
dimension 2
region box block 0 4 0 4 -0.5 0.5
create_box 1 box
create_atoms 1 single 1.3 2 0 units box
create_atoms 1 single 2.2 2 0 units box
mass 1 1.0
pair_style deformable/ring
pair_coeff * * species small
fix move all nve
run 2
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_trace(ranks, tmp_path, monkeypatch):
    """A row for each evaluation, until the imbalance is below the tolerance."""
    (tmp_path / "species").write_text("small 0.5 1.0 inf\n")
    monkeypatch.setenv("DEFORMABLE_TRACE", "1")
    row = (
        r"Trace: step (\d) evaluation (\d+) predicted imbalance (\S+) of lines 0 force (\S+) ?(\w*)"
    )
    rows = re.findall(f"^{row}$", lmp(ranks, PAIR, tmp_path).stdout, re.MULTILINE)
    numbers = [(int(row[0]), int(row[1])) for row in rows]
    assert numbers == sorted(set(numbers))  # of one rank
    assert {row[0] for row in rows} == {"0", "1", "2"}
    assert {row[4] for row in rows} == {"", "taken"}
    last = {step: (float(imbalance), float(force)) for step, _, imbalance, force, _ in rows}
    assert all(imbalance <= TOLERANCE * force for imbalance, force in last.values())
    monkeypatch.delenv("DEFORMABLE_TRACE")
    assert "Trace" not in lmp(ranks, PAIR, tmp_path).stdout
