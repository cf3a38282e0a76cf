"""The calls of the table of twenty tasks in the cookbook do what they say."""

import math
import re
import warnings
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import networkx
import numpy as np
import pytest

PAGE = Path(__file__).parents[1] / "docs" / "cookbook.md"
ROW = re.compile(r"^\| \[(?P<task>[^]]+)\]\([^)]+\) \| (?P<calls>`.+`) \|$", re.MULTILINE)
TASKS = PAGE.read_text().partition("## Twenty tasks")[2]
ROWS = ROW.findall(TASKS)
FIRST = TASKS.partition("```python\n")[2].partition("```")[0]
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
def names(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the lines above the table make, in a folder of their own."""
    folder = tmp_path_factory.mktemp("tasks")
    space = {name: getattr(ld, name) for name in ld.__all__}
    space |= {"networkx": networkx, "numpy": np, "math": math, "folder": folder}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        exec(compile(smaller(FIRST), str(PAGE), "exec"), space)
    space["jammed"].export(folder / "start.dump")
    return space


def test_tasks_start_above_the_onset(names: dict[str, Any]) -> None:
    """Where moduli and stresses are numbers, and not rounding."""
    assert names["state"].pressure > 1e-6
    assert names["state"].moduli().shear_modulus > 1e-5


def test_tasks(names: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
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
