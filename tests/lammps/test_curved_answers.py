"""Curved lines answer corrections of forces: a call takes few evaluations."""

import itertools

import numpy as np
import pytest
from contact_rows import of_compute_pair
from curved import CASES, known
from laws import CURVED

STYLE = f"{CURVED} balance 1e-8 1000"
NAMED = {case["name"]: case for case in CASES}
STICKY = NAMED["adhesive droplets 1"]
CELLS = STICKY | {"kA": [20] * 12, "kP": [0.5] * 12, "adhesion": 0.1}
STIFFER = CELLS | {"kP": [5] * 12}
# what moves, its temperature, and evaluations of a call: the mean and a tenth more. Films of
# droplets come and go
MOVING = {
    "droplets": (NAMED["droplets 1"], 1e-3, 4.6),
    "bubbles": (NAMED["bubbles of unequal tension 1"], 1e-3, 4.7),
    "soft and stiff rings": (NAMED["soft and stiff rings 1"], 1e-3, 5.1),
    "rings": (NAMED["rings 1"], 1e-3, 4.7),
    "inextensible rings": (NAMED["inextensible rings 1"], 1e-3, 4.5),
    "droplets that stick": (STICKY, 1e-3, 9.3),
    "droplets that stick, slow": (STICKY, 1e-5, 7.5),
    "cells that stick": (CELLS, 1e-3, 9.0),
    "stiffer cells that stick": (STIFFER, 1e-3, 12.9),
}


def tiled(case, times):
    """The case times x times side by side."""
    box = np.array(case["box"])
    shifts = np.array(list(itertools.product(range(times), repeat=2))) * box
    x = (np.array(case["x"]) + shifts[:, None]).reshape(-1, 2)
    rows = {name: case[name] * len(shifts) for name in ("radius", "kA", "kP", "skin", "tension")}
    return case | rows | {"x": x.tolist(), "box": (times * box).tolist()}


@pytest.mark.parametrize(("case", "temperature", "most"), MOVING.values(), ids=list(MOVING))
def test_few_evaluations_in_motion(case, temperature, most, tmp_path):
    """Lines that do not answer, or wrongly, leave more of each correction."""
    scene = known(tiled(case, 3), tmp_path, STYLE)
    scene.run(
        f"velocity all create {temperature} 4711 loop all\nfix move all nve\ntimestep 0.02\nrun 20"
    )
    found = []
    for _ in range(60):
        scene.run("run 1 pre no post no")
        evaluations, imbalance = of_compute_pair(scene)
        assert imbalance <= 1e-8
        found.append(evaluations)
    assert np.mean(found) <= most


@pytest.mark.parametrize("name", ["soft and stiff rings 1", "rings 1"])
def test_no_balance_beyond_the_model(name, tmp_path):
    """Compressed by 13 %: the solver ends, and says why."""
    log, most = tmp_path / "log", 3000
    style = f"{CURVED} balance 1e-8 {most} reach 1"
    scene = known(NAMED[name], tmp_path, style, 0.87, log=log)
    scene.energy()
    assert of_compute_pair(scene)[0] < most
    (line,) = [line for line in log.read_text().splitlines() if "not balanced" in line]
    assert "Further evaluations do not reduce that" in line
