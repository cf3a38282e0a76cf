"""A table of states, without a record of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sized
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

from ..common.errors import FileError, ParameterError
from ..common.files import make_folder, refuse_present
from ..common.ranks import world
from ..common.steps import Steps, start_of, waits_for_all
from ..common.validate import expect
from ..io.series import append_row, columns_in, keep_rows, refuse_foreign, rows_in
from ..state.disk_state import DiskState
from ..state.droplet_state import DropletState
from ..state.sphere_state import SphereState
from ..state.state import State
from .columns import Column, check_columns

_APPEND = "go on with append=True"

S = TypeVar("S", bound=State | DropletState | DiskState | SphereState)


def log(
    states: Iterable[S],
    path: str | Path,
    append: bool = False,
    overwrite: bool = False,
    **columns: Column,
) -> Iterator[S]:
    """Write a row of numbers for each state as it comes, into a CSV file.

        steps = ld.compress(sim, 0.01, 10)
        for state in ld.log(steps, "log.csv", weakest=lambda state: state.arc_radius.min()):
            print(state.phi)

    The columns are `frame` and those of `Run.table`; `series.csv` of `record` is the same. Each row
    is in the file once its state is yielded. Row 0 is the state before the first step, as frame 0
    of a record. Rank 0 writes.

    Args:
        states: of `Simulation`, `Disks` or `Spheres`, e.g. from `compress`; what knows a state
            before is told at `record`.
        path: of the file; folders are made if missing.
        append: go on with the log that is there, if any: frames are counted on, and half a row at
            its end is removed.
        overwrite: replace the log that is there, when the first state comes.
        columns: further ones: functions that return a number for a state.

    Yields:
        The states, unchanged; without the one before the first step.

    Raises:
        ParameterError: these are no states, or a column is no function, has the name of another or
            no single number, or `append` and `overwrite` are given.
        FileError: there is a log, and neither `append` nor `overwrite` is given; or the file cannot
            be written, is no log, or has other columns.
    """
    expect("states", states, Iterable)
    expect("path", path, str, Path)
    expect("append", append, bool)
    if append and overwrite:
        raise ParameterError("give one of append and overwrite")
    path = Path(path)
    if not path.name:
        raise ParameterError(f"path must name a file, such as log.csv, not {str(path)!r}")
    check_columns(columns, ())
    refuse_foreign(path)
    if waits_for_all(states):
        refuse_present(path, append or overwrite, _APPEND)
    start = start_of(states)
    return Steps("log", _logged(states, start, path, append, overwrite, columns), start)


def _whole_rows(path: Path) -> int:
    """Number of rows that are complete."""
    torn = path.exists() and not path.read_bytes().endswith(b"\n")
    return max(len(rows_in(path)) - torn, 0)


def _logged(
    states: Iterable[S],
    start: Callable[[], S | None],
    path: Path,
    append: bool,
    overwrite: bool,
    columns: Mapping[str, Column],
) -> Iterator[S]:
    """Write the rows. Only the rank that writes knows how many there are already."""
    before, number = start(), -1
    for state in chain([before] if before else [], states):
        expect("a state that is logged", state, State, DropletState, DiskState, SphereState)
        numbers = state.numbers()
        check_columns(columns, numbers)
        row = numbers | {name: _cell(name, column(state)) for name, column in columns.items()}
        if getattr(state, "root", world().rank == 0):
            if number < 0:
                refuse_present(path, append or overwrite, _APPEND)
                number = _begin(path, append, ["frame", *row])
            if number == 0 or state is not before:
                append_row(path, number, row)
                number += 1
        if state is not before:
            yield state


def _cell(name: str, value: Any) -> Any:
    """The value, if it fits into a cell of a table."""
    if isinstance(value, Sized) and not isinstance(value, str) and getattr(value, "ndim", 1) > 0:
        raise ParameterError(
            f"column {name} must have one number for each state, such as a mean, not a "
            f"{type(value).__name__} of {len(value)}"
        )
    return value


def _begin(path: Path, append: bool, columns: list[str]) -> int:
    """Keep the complete rows of a log to go on with, if it has these columns; their number."""
    make_folder(path.parent)
    first, former = _whole_rows(path) if append else 0, columns_in(path)
    if first and set(former) != set(columns):
        differ = ", ".join(sorted({*former} ^ {*columns}))
        raise FileError(
            f"{path} has other columns, the difference is {differ}: take the same ones, or another "
            "file"
        )
    keep_rows(path, first)
    return first
