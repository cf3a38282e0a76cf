"""What a folder of results holds, so that nothing is written over by what is something else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Literal

from ..common.errors import FileError, ParameterError

# Of a run, see `files`; `deformable jam` has a summary of another kind, and a table before it.
DATA, SUMMARY, TABLE = "packing.data", "summary.json", "table.csv"
SERIES, TRAJECTORY = "series.csv", "trajectory.lammpstrj"

Kind = Literal["compression", "jamming", "report"]

_SHOWN: dict[Kind, str] = {
    "compression": "a run",
    "jamming": "onsets of jamming from `deformable jam`",
    "report": "a report",
}


def holds(folder: str | Path) -> Kind | None:
    """What has been written into a folder, if anything: as far as it is worth keeping."""
    folder = Path(folder)
    try:
        summary = json.loads((folder / SUMMARY).read_text())
    except (OSError, ValueError):
        summary = None
    begun = summary is None and (folder / TABLE).exists()
    if begun or (isinstance(summary, dict) and "onset" in summary):
        return "jamming"
    if any((folder / name).exists() for name in (DATA, SERIES, TRAJECTORY)):
        return "compression"
    if (folder / "report.json").exists() or any(folder.glob("parts/*.pickle")):
        return "report"
    return None


def refuse(folder: str | Path, but: Kind | None = None, ways: tuple[str, ...] = ()) -> Path:
    """Refuse what is no folder, and one that holds something.

    Args:
        folder: may be missing.
        but: what it may hold nevertheless.
        ways: out where it holds a run, beside another folder.

    Returns:
        The folder.

    Raises:
        ParameterError: its name is empty.
        FileError: it is a file or within one, or it holds something else.
    """
    if str(folder) == "":
        raise ParameterError("a folder needs a name, not '': for this one give '.'")
    folder = Path(folder)
    for place in (folder, *folder.parents):
        if place.exists() and not place.is_dir():
            raise FileError(f"'{place}' is a file, not a folder: name another folder")
    found = holds(folder)
    if found is not None and found != but:
        out = (*(ways if found == "compression" else ()), "name another folder")
        raise FileError(f"'{folder}' holds {_SHOWN[found]}: {', or '.join(out)}")
    return folder
