"""The frames on record in a folder of a run: how many there are, and whether they are all there."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from pathlib import Path

from .errors import FileError
from .folders import DATA, SERIES, TRAJECTORY


def frames_in(folder: Path) -> int:
    """Frames on record up to the state in a folder; all of them if `State.save` has written it."""
    if (folder / DATA).exists():
        title = (folder / DATA).read_text(errors="replace").partition("\n")[0]
        counted = re.search(r", (\d+) frames$", title)
        if counted:
            return int(counted[1])
    if not (folder / SERIES).exists():
        return 0
    with (folder / SERIES).open(newline="") as file:
        return sum(1 for _ in csv.DictReader(file))


def check_frames(folder: Path) -> None:
    """Refuse a series or a trajectory that lacks states on record; both may have more."""
    count = frames_in(folder)
    for path, numbers in (
        (folder / TRAJECTORY, _frames_of_trajectory(folder / TRAJECTORY)),
        (folder / SERIES, _frames_of_series(folder / SERIES)),
    ):
        for n in range(count):
            if next(numbers, None) != n:
                raise FileError(
                    f"{path} lacks frame {n}, of the {count} frames on record: restore the file, "
                    "or begin in another folder"
                )


def _frames_of_series(path: Path) -> Iterator[int]:
    """Numbers of the frames that have a row."""
    if path.exists():
        with path.open(newline="") as file:
            for row in csv.DictReader(file):
                yield int(row["frame"]) if str(row.get("frame")).isdigit() else -1


def _frames_of_trajectory(path: Path) -> Iterator[int]:
    """Numbers of the frames, up to the first one that is not whole."""
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
            yield int(head[1])
