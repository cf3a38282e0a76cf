"""A log: one row for each state, in a table that other programs read."""

import csv
from collections.abc import Iterator
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from ranks import python


@pytest.fixture
def sim(jammed: ld.Packing) -> Iterator[ld.Simulation]:
    with ld.Simulation(jammed.at(0.88), ld.Ring()) as sim:
        yield sim


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_rows_are_those_of_a_series(sim: ld.Simulation, tmp_path: Path) -> None:
    """With the state before the first step, in the file before the state is yielded."""
    path = tmp_path / "folder" / "log.csv"
    steps = ld.log(sim.shear(0.01, steps=2)[1:], path, largest=lambda s: s.area.max())
    for number, state in enumerate(ld.record(steps, tmp_path / "run"), start=1):
        last = rows(path)[-1]
        assert int(last["frame"]) == number
        assert float(last["energy"]) == state.energy
        assert float(last["largest"]) == state.area.max()
    found, series = rows(path), rows(tmp_path / "run" / "series.csv")
    assert [float(row["strain"]) for row in found] == [0.0, 0.005, 0.01]
    assert [dict(list(row.items())[:-1]) for row in found] == series
    table = np.genfromtxt(path, delimiter=",", names=True)
    assert table["phi"].shape == (3,)


def test_is_gone_on_with(sim: ld.Simulation, tmp_path: Path) -> None:
    """After an interruption within a row; a new log replaces the old one."""
    path = tmp_path / "log.csv"
    next(ld.log(sim.compress(strain=0.01, steps=5)[1:], path, append=True))
    assert len(rows(path)) == 2
    path.write_text(path.read_text() + "2,32,6.1")
    list(ld.log(sim.compress(strain=0.002)[1:], path, append=True))
    assert [row["frame"] for row in rows(path)] == ["0", "1", "2"]
    assert float(rows(path)[2]["phi"]) > float(rows(path)[1]["phi"])
    with pytest.raises(ld.FileError, match="already: go on with append=True, replace it"):
        ld.log([sim.state()], path)
    assert [row["frame"] for row in rows(path)] == ["0", "1", "2"]
    list(ld.log([sim.state()], path, overwrite=True))
    assert [row["frame"] for row in rows(path)] == ["0"]


def test_of_disks(jammed: ld.Packing, tmp_path: Path) -> None:
    with ld.Disks(jammed) as disks:
        *_, last = ld.log(disks.compress(strain=0.01, steps=2)[1:], tmp_path / "log.csv")
    found = rows(tmp_path / "log.csv")
    assert [float(row["pressure"]) > 1e-4 for row in found] == [False, True, True]
    assert float(found[-1]["coordination"]) == last.coordination


SCRIPT = """
import lammps_deformable as ld
sim = ld.Simulation(ld.crystal("hex", (4, 2), phi=0.92), ld.Ring())
for _ in range(2):
    steps = ld.compress(sim, 0.01, 1, tolerance=0.01)
    list(ld.log(steps, "log.csv", append=True))
"""


def test_one_rank_writes(tmp_path: Path) -> None:
    python(SCRIPT, cwd=tmp_path, ranks=2)
    assert [row["frame"] for row in rows(tmp_path / "log.csv")] == ["0", "1", "2"]


def test_what_cannot_be_a_log(state: ld.State, tmp_path: Path) -> None:
    def refused(kind: type[Exception], told: str, *given: object, **how: object) -> None:
        with pytest.raises(kind, match=told):
            list(ld.log(*given, **how))

    path = tmp_path / "log.csv"
    wrong, broken = ld.ParameterError, ld.FileError
    refused(wrong, "states must be", state, path)
    refused(wrong, "a state that is logged must be", [state.packing], path)
    refused(wrong, "path must be", [state], 3)
    refused(wrong, "path must name a file, such as .*, not '.'", [state], "")
    refused(wrong, "append must be", [state], path, append=1)
    refused(wrong, "column low must be a function of a state", [state], path, low="area")
    refused(wrong, "has a column phi: give", [state], path, phi=lambda state: state.phi)
    refused(wrong, "has a column frame: give", [state], path, frame=lambda state: 3)
    one = "column area must have one number for each state, .* not a ndarray of"
    refused(wrong, one, [state], path, area=lambda state: state.area)
    refused(wrong, "pair must .* not a tuple of 2", [state], path, pair=lambda state: (1, 2))
    assert not path.exists()
    refused(broken, "cannot be written", [state], tmp_path)
    refused(broken, "cannot be written", [state], f"{tmp_path}/{'n' * 300}.csv")
    list(ld.log([state], path, area=lambda state: state.area.max()))
    kept = path.read_text()
    refused(broken, "other columns, the difference is area: take the same", [state], path, True)
    refused(broken, "cannot be written", [state], path / "log.csv")
    (tmp_path / "prices.csv").write_text("year,price\n1999,3\n")
    for append in (False, True):
        refused(broken, "is no series of states", [state], tmp_path / "prices.csv", append)
    assert path.read_text() == kept
    assert "1999" in (tmp_path / "prices.csv").read_text()
