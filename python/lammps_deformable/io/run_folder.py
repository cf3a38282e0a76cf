"""The files of a folder of results, and checks so that nothing is replaced unasked."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from ..common.errors import FileError, ParameterError
from ..common.files import refuse_present, writing
from ..common.validate import expect

# Files of a run, see `runs.record`.
DATA, SUMMARY = "packing.data", "summary.json"
SERIES, TRAJECTORY, SETUPS = "series.csv", "trajectory.lammpstrj", "setups.jsonl"
SPECIES, SCRIPT = "species.deformable", "in.lammps"

# Results that are kept for an interrupted report.
PARTS = "*parts/*/joblib"

Kind = Literal["compression", "report"]

_SHOWN: dict[Kind, str] = {
    "compression": "a run",
    "report": "a report",
}


def holds(folder: str | Path) -> Kind | None:
    """Kind of results in a folder, or None if it has none."""
    folder = Path(folder)
    if any((folder / name).exists() for name in (DATA, SERIES, TRAJECTORY)):
        return "compression"
    if (folder / "report.json").exists() or any(folder.glob(PARTS)):
        return "report"
    return None


def refuse(folder: str | Path, but: Kind | None = None, ways: tuple[str, ...] = ()) -> Path:
    """Raise an error unless a folder is free for new results.

    Args:
        folder: may be missing.
        but: kind of results that it may hold.
        ways: ways out to name in the error if it holds a run.

    Returns:
        The folder.

    Raises:
        ParameterError: its name is empty.
        FileError: it is a file or within one, or it holds other results.
    """
    expect("folder", folder, str, Path)
    if str(folder) == "":
        raise ParameterError("a folder needs a name, not '': for this one give '.'")
    folder = Path(folder)
    with writing(folder):  # names may be too long
        for place in (folder, *folder.parents):
            if place.exists() and not place.is_dir():
                raise FileError(f"'{place}' is a file, not a folder: name another folder")
        found = holds(folder)
    if found is not None and found != but:
        ways_out = (*(ways if found == "compression" else ()), "name another folder")
        raise FileError(f"'{folder}' holds {_SHOWN[found]}: {', or '.join(ways_out)}")
    return folder


def refuse_run(folder: str | Path, overwrite: bool, ways: tuple[str, ...] = ()) -> Path:
    """Raise an error unless a folder is free for a new run.

    Args:
        folder: may be missing.
        overwrite: replace a run in it.
        ways: further ways out to name in the error if it holds one.

    Returns:
        The folder.

    Raises:
        FileError: as `refuse`, or it has a file of the name of one of a run.
    """
    expect("overwrite", overwrite, bool)
    ways = (*ways, "replace it with overwrite=True")
    place = refuse(folder, "compression" if overwrite else None, ways)
    for name in (SUMMARY, SPECIES, SCRIPT, SETUPS):
        refuse_present(place / name, overwrite)
    return place
