"""The table of docs/choosing.md, what each law can do: each cell is tried."""

import re
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest

PAGE = (Path(__file__).parents[1] / "docs" / "choosing.md").read_text()
TABLE = PAGE.partition("**What each can do:**")[2].partition("**Where")[0]
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")] for line in TABLE.strip().splitlines()
]
LAWS: dict[str, type] = {name: getattr(ld, name) for name in ROWS[0][1:]}
FLUID: dict[str, Any] = {"kA": np.inf, "kP": 0.0, "tension": 1.0}


@cache
def packing(dimension: int) -> ld.Packing:
    jammed = ld.jam(ld.bidisperse(24, dimension=dimension, seed=1)).packing
    return jammed.at(jammed.phi + 0.03)


def sim(law: Any, **words: Any) -> ld.Simulation:
    return ld.Simulation(packing(3 if isinstance(law, ld.Droplet) else 2), law, **words)


def relaxed(law: Any) -> ld.State:
    with sim(law) as found:
        return found.relax()


def rubbed(law: Any) -> None:
    with sim(law, friction=ld.Friction(0.3, kt=0.1)) as found:
        assert len(found.run(20)[-1].spins) == 24


def moved(law: Any) -> None:
    with sim(law) as found:
        found.run(20)
        found.run(20, temperature=1e-6, drag=0.01)
        found.shear(1e-3, rate=1e-2, drag=1.0)


def propelled(law: Any) -> None:
    with sim(law) as found:
        found.run(20, propulsion=1e-5, persistence=100.0, drag=1.0, inertia=False)


def proliferated(law: Any) -> None:
    with sim(law) as found:
        found.coarsen(1e-3, time=1e-3)
        found.proliferate(1e-3, division=10.0, time=1e-3)


def sticky(law: Any) -> None:
    kind = type(law)
    kind(adhesion=0.1) if kind is not ld.Ring else kind(**FLUID, adhesion=0.1)


def stiffness(law: Any) -> None:
    state = relaxed(law)
    state.moduli()
    state.modes(3)


def walled(law: Any) -> None:
    dimension = law.dimension if hasattr(law, "dimension") else 2
    scene = ld.BoxWall((12.0,) * dimension)
    start = ld.bidisperse(8, dimension=dimension, seed=1).between(scene).push_off()
    with ld.Simulation(start, law) as found:
        assert len(found.state().wall_forces) == 2 * dimension


TRIED: dict[str, Callable[[Any], object]] = {
    "motion, heat bath, flow": moved,
    "friction, spins": rubbed,
    "adhesion": sticky,
    "walls": walled,
    "moduli, modes": stiffness,
    "propulsion": propelled,
    "coarsening, growth and division": proliferated,
}
CELLS = [
    (row[0], law, said)
    for row in ROWS[2:]
    if row[0] in TRIED
    for law, said in zip(LAWS, row[1:], strict=True)
]


def test_all_rows_are_tried() -> None:
    assert {row[0] for row in ROWS[2:]} == {"relaxation", *TRIED}


@pytest.mark.parametrize("law", LAWS)
def test_relaxation(law: str) -> None:
    said = ROWS[2][1 + list(LAWS).index(law)]
    stalls = "stalls" in said
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        state = relaxed(LAWS[law]())
    assert said.replace("-", "").lower().startswith(str(state.minimizer))
    assert any(warning.category is ld.StalledWarning for warning in found) == stalls


@pytest.mark.parametrize(("row", "law", "said"), CELLS)
@pytest.mark.filterwarnings("ignore::lammps_deformable.StalledWarning")
def test_cells(row: str, law: str, said: str) -> None:
    """`no` is an error of the package, or of a word that does not exist; `yes` is done."""
    kind = LAWS[law]
    if re.match("no\\b", said):
        with pytest.raises((ld.ParameterError, TypeError)):
            TRIED[row](kind())
    elif said == "`curved`":
        with pytest.raises(ld.ParameterError, match="contact='curved'"):
            TRIED[row](kind())
        assert kind(**FLUID, contact="curved", adhesion=0.1).sticks
    elif said == "without films":
        TRIED[row](kind())
        with pytest.raises(ld.ParameterError):
            TRIED[row](kind(**FLUID, contact="curved", adhesion=0.1))
    else:
        assert said == "yes"
        TRIED[row](kind())
