"""The frames on record in a folder of a run: how many there are, and whether they are all there."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from ..common.errors import FileError
from ..common.files import write_whole
from ..model.packing import Packing
from .run_folder import DATA, SERIES, TRAJECTORY


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


def keep_frames(folder: Path, first: int) -> None:
    """Leave the first frames of the series and the trajectory; a killed run may have left more."""
    _keep(folder / TRAJECTORY, first, r"(?=ITEM: TIMESTEP\n)")
    _keep(folder / SERIES, first + 1 if first > 0 else 0, r"(?<=\n)")


def append_frame(
    folder: Path,
    number: int,
    packing: Packing,
    columns: Mapping[str, NDArray[Any]],
    numbers: Mapping[str, Any],
) -> None:
    """Append a state to the trajectory and the series.

    Args:
        folder: of the run.
        number: of the frame, from 0.
        packing: of the state.
        columns: values of the particles by name, arrays of shape (N,).
        numbers: the state in numbers.
    """
    row = io.StringIO()
    writer = csv.DictWriter(row, ["frame", *numbers])
    if number == 0:
        writer.writeheader()
    writer.writerow({"frame": number} | dict(numbers))
    _append(folder / TRAJECTORY, _dump_frame(number, packing, columns))
    _append(folder / SERIES, row.getvalue())


def _append(path: Path, text: str) -> None:
    with path.open("a", newline="") as file:
        file.write(text)


def _keep(path: Path, count: int, boundary: str) -> None:
    """Leave the first parts of a file; a killed run may have left more, or a part of one."""
    text = path.read_bytes().decode() if path.exists() else ""
    parts = [part for part in re.split(boundary, text) if part]
    if len(parts) > count:
        write_whole(path, "".join(parts[:count]))


def _dump_frame(number: int, packing: Packing, columns: Mapping[str, NDArray[Any]]) -> str:
    (lx, _), (xy, ly) = packing.box.tolist()
    # LAMMPS gives the bounding box of a tilted cell and the tilts beside it.
    box = (
        ["ITEM: BOX BOUNDS pp pp pp", f"0 {lx!r}", f"0 {ly!r}", "-0.5 0.5"]
        if xy == 0.0
        else [
            "ITEM: BOX BOUNDS xy xz yz pp pp pp",
            f"{min(0.0, xy)!r} {lx + max(0.0, xy)!r} {xy!r}",
            f"0 {ly!r} 0",
            "-0.5 0.5 0",
        ]
    )
    lines = ["ITEM: TIMESTEP", str(number), "ITEM: NUMBER OF ATOMS", str(len(packing)), *box]
    lines.append("ITEM: ATOMS id type x y z " + " ".join(columns))
    rows = zip(
        packing.species.tolist(),
        packing.positions.tolist(),
        *(column.tolist() for column in columns.values()),
        strict=True,
    )
    for n, (kind, (x, y), *values) in enumerate(rows, start=1):
        lines.append(f"{n} {kind + 1} {x!r} {y!r} 0 " + " ".join(map(repr, values)))
    return "\n".join(lines) + "\n"
