"""The calls of the table of twenty tasks in the cookbook do what they say."""

import math
import re
import warnings
from pathlib import Path

import lammps_deformable as ld
import networkx
import numpy as np
import pytest

PAGE = Path(__file__).parents[1] / "docs" / "cookbook.md"
ROW = re.compile(r"^\| \[(?P<task>[^]]+)\]\([^)]+\) \| (?P<calls>`.+`) \|$", re.MULTILINE)
ROWS = ROW.findall(PAGE.read_text().partition("## Twenty tasks")[2])
SMALLER = {
    "bidisperse(64": "bidisperse(16",
    "BoxWall((12, 12))": "BoxWall((6, 6))",
    "r_max=3.0": "r_max=1.5",
}


def smaller(call: str) -> str:
    """The same of 16 particles."""
    for large, small in SMALLER.items():
        call = call.replace(large, small)
    return call


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> dict[str, object]:
    """What the text above the table begins with, in a folder of its own."""
    folder = tmp_path_factory.mktemp("tasks")
    jammed = ld.jam(ld.bidisperse(16, seed=1)).packing.at(0.87)
    jammed.to_file(folder / "start.dump")
    with ld.Simulation(jammed, ld.Ring()) as sim:
        state = sim.relax()
        sim.shear(0.02, record=folder / "run")
    run = ld.Run(folder / "run")
    given = {"folder": folder, "jammed": jammed, "state": state, "run": run}
    public = {name: getattr(ld, name) for name in ld.__all__}
    return {**public, "networkx": networkx, "numpy": np, "math": math, **given}


def test_tasks(names: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    """Each call in turn; a failure shows the call."""
    assert len(ROWS) == 20
    monkeypatch.chdir(names["folder"])
    for _, calls in ROWS:
        space = dict(names)
        with ld.Simulation(names["state"], ld.Ring()) as space["sim"]:
            for call in map(smaller, re.findall(r"`([^`]+)`", calls)):
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", ld.UnjammedWarning)
                    exec(compile(call, call, "exec"), space)
