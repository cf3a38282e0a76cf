"""Recorded frames of a run: each has a row in the series and a frame in the trajectory."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FileError
from ..common.files import reading, write_whole
from ..formats.lammps_dump import dump_frame, read_dump_frame
from ..model.packing import Packing
from ..model.room import closed
from . import series
from .data_file import Motion
from .directions import from_columns
from .films import as_films
from .rubbing import rubbing_from_json
from .run_folder import DATA, SERIES, SETUPS, TRAJECTORY


def frames_in(folder: Path) -> int:
    """Number of recorded frames up to the saved state in a folder, in its title or its series."""
    if (folder / DATA).exists():
        title = (folder / DATA).read_text(errors="replace").partition("\n")[0]
        counted = re.search(r", (\d+) frames$", title)
        if counted:
            return int(counted[1])
    return len(series_in(folder))


def series_in(folder: Path) -> list[dict[str, str]]:
    """The rows of the series in a folder; none without a series."""
    return series.rows_in(folder / SERIES)


def recorded(folder: Path, name: str) -> Path:
    """The file of this name of a recorded run.

    Raises:
        FileError: there is none.
    """
    if not (folder / name).exists():
        raise FileError(f"no recorded run in '{folder}': {folder / name} is missing")
    return folder / name


def check_frames(folder: Path) -> None:
    """Raise an error if the series or the trajectory lacks a frame; both may have more frames."""
    count = frames_in(folder)
    for path, numbers in (
        (folder / TRAJECTORY, _frames_of_trajectory(folder / TRAJECTORY)),
        (folder / SERIES, (row.get("frame") for row in series_in(folder))),
    ):
        for n in range(count):
            if next(numbers, None) != str(n):
                raise FileError(
                    f"{path} lacks frame {n} of {count} recorded frames: restore the file, or name "
                    "another folder"
                )


def _frames_of_trajectory(path: Path) -> Iterator[str]:
    """Frame numbers, up to the first incomplete frame."""
    if not path.exists():
        return
    with path.open() as file:
        while True:
            head = [file.readline().strip() for _ in range(9)]
            if head[0] != "ITEM: TIMESTEP" or not (head[1].isdigit() and head[3].isdigit()):
                return
            rows = [file.readline() for _ in range(int(head[3]))]
            if not all(row.endswith("\n") for row in rows):
                return
            yield head[1]


def clock_of(folder: Path) -> list[tuple[float, float | None]]:
    """Time and shear strain of each frame in the series; None without shear."""
    rows = series_in(folder)
    given = [(row.get("time") or 0.0, row.get("strain") or None) for row in rows]
    return [(float(time), None if strain is None else float(strain)) for time, strain in given]


def stalled_in(folder: Path) -> list[bool]:
    """Whether the relaxation of each frame in the series had stalled."""
    return [row.get("stalled") == str(True) for row in series_in(folder)]


def keep_frames(folder: Path, first: int) -> None:
    """Cut series, trajectory and setups after their first frames: a killed run may have more."""
    series.keep(folder / TRAJECTORY, first, r"(?=ITEM: TIMESTEP\n)")
    series.keep_rows(folder / SERIES, first)
    former = [setup for setup in setups_in(folder) if setup["frame"] < first]
    text = "".join(json.dumps(setup) + "\n" for setup in former)
    if (folder / SETUPS).exists() and (folder / SETUPS).read_text() != text:
        write_whole(folder / SETUPS, text)


def drop_frames(folder: Path) -> None:
    """Make place for another run: without its packing first, so that a half is never a whole."""
    for name in (DATA, SERIES, TRAJECTORY, SETUPS):
        (folder / name).unlink(missing_ok=True)


def append_setup(folder: Path, number: int, setup: Mapping[str, Any]) -> None:
    """Append what a frame is made of besides its particles, if the frame before had another."""
    line = json.dumps({"frame": number} | dict(setup), allow_nan=False) + "\n"
    # the last one is that of the frame before, as `keep_frames` has cut what came later
    last = _last_line(folder / SETUPS)
    with reading(folder / SETUPS):
        if not last or json.loads(line) != dict(json.loads(last)) | {"frame": number}:
            series.append(folder / SETUPS, line)


def _last_line(path: Path) -> bytes:
    """The last whole line of a file, empty without: springs make such files long."""
    if not path.exists():
        return b""
    with path.open("rb") as file:
        size, block = file.seek(0, 2), 1 << 16
        while True:
            file.seek(max(size - block, 0))
            whole, end, _ = file.read().rpartition(b"\n")
            _, begin, last = whole.rpartition(b"\n")
            if block >= size or (begin and end):
                return last if end else b""
            block *= 4


def setup_of(setups: list[dict[str, Any]], number: int) -> dict[str, Any]:
    """That of a frame among those of its run.

    Raises:
        LookupError: there is none.
    """
    for setup in reversed(setups):
        if setup["frame"] <= number:
            return setup
    raise LookupError(f"{SETUPS} lacks it")


def setups_in(folder: Path) -> list[dict[str, Any]]:
    """What frames are made of besides their particles, each with the number of its first frame.

    A killed run may have a part of a line at the end, which is left out.

    Raises:
        FileError: the file is damaged.
    """
    path = folder / SETUPS
    lines = path.read_text().split("\n")[:-1] if path.exists() else []
    with reading(path):
        setups = [dict(json.loads(line)) for line in lines]
        return [setup | {"frame": int(setup["frame"])} for setup in setups]


def texts_of(folder: Path) -> list[str]:
    """The frames of the trajectory as text, each without its first line.

    Raises:
        FileError: there is no trajectory.
    """
    return recorded(folder, TRAJECTORY).read_text().split("ITEM: TIMESTEP\n")[1:]


def append_frame(
    folder: Path,
    number: int,
    packing: Packing,
    columns: Mapping[str, NDArray[Any]],
    numbers: Mapping[str, Any],
) -> None:
    """Append a state to the trajectory, then to the series, whose rows count complete frames.

    Args:
        folder: of the run.
        number: of the frame, from 0.
        packing: of the state.
        columns: values of the particles by name, arrays of shape (N,).
        numbers: the state in numbers.
    """
    series.append(folder / TRAJECTORY, _dump_frame(number, packing, columns))
    series.append_row(folder / SERIES, number, numbers)


def _dump_frame(number: int, packing: Packing, columns: Mapping[str, NDArray[Any]]) -> str:
    return dump_frame(
        number,
        packing.box,
        packing.species,
        packing.positions,
        columns,
        packing.origin.tolist(),
        closed(packing.walls, packing.dimension),
    )


def read_frame(
    frame: str,
    radii: Sequence[float],
    saved: Mapping[str, Any],
    clock: tuple[float, float | None],
    dimension: int,
) -> tuple[Packing, Motion]:
    """A packing and its motion from a frame as `record` writes it.

    Particles may have been added or deleted and their radii and species changed since. They have
    radii of their own where these are others than those of their species.

    Args:
        frame: its text, without the first line.
        radii: of the species.
        saved: its setup, with films and springs of contacts.
        clock: time and strain.
        dimension: 2, or 3 in space.
    """
    found = read_dump_frame(frame)
    values, species, largest = found.columns, found.species, np.array(radii)
    own = bool((values["radius"] != largest[species]).any())
    np.maximum.at(largest, species, values["radius"])
    packing = Packing(
        found.places(dimension),
        species,
        largest,
        found.lattice(dimension),
        values["radius"] if own else None,
    )
    velocities = np.column_stack([values[name] for name in ("vx", "vy", "vz")[:dimension]])
    films, directions = as_films(saved.get("films")), from_columns(values)
    rubbing = rubbing_from_json(saved, values)
    return packing, Motion(velocities, *clock, films, directions, rubbing)
