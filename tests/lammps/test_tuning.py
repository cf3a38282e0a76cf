"""No tuned constant of the solver changes forces: each at a tenth and at ten times its value."""

import re
from pathlib import Path

import numpy as np
import pytest
from droplets import CASES, Droplets
from laws import BALANCES
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
