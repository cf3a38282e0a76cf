"""The last state of a run in its folder: data file, species, LAMMPS script and summary."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..common.errors import FileError
from ..common.files import write_whole
from ..common.versions import versions
from ..model.laws import Law, Ring, Sector
from ..model.packing import Packing
from .lammps_commands import species_file
from .lammps_files import SCRIPT, SPECIES, data_file, packing_in, script
from .run_folder import DATA, SUMMARY, refuse

_LAWS: dict[str, type[Ring] | type[Sector]] = {"Ring": Ring, "Sector": Sector}


def save(
    folder: str | Path,
    packing: Packing,
    law: Law,
    timestep: float,
    numbers: Mapping[str, Any],
    parameters: Mapping[str, Any] | None = None,
    frames: int | None = None,
) -> None:
    """Write a state. Only one process may call this.

    Args:
        folder: made if missing; an older state there is replaced.
        packing: of the state.
        law: its contact law.
        timestep: for the LAMMPS script [time].
        numbers: the state in numbers, for the summary.
        parameters: anything JSON that belongs into the summary.
        frames: on record up to this state, if any.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    summary = {
        "state": dict(numbers),
        "law": {"name": type(law).__name__}
        | {name: _strict(value) for name, value in asdict(law).items()},
        "radii": packing.radii.tolist(),
        "parameters": {name: _strict(value) for name, value in (parameters or {}).items()},
        "versions": versions(),
    }
    write_whole(folder / SPECIES, species_file(law, packing.radii.tolist()))
    write_whole(folder / SCRIPT, script(packing, law, timestep))
    write_whole(folder / SUMMARY, json.dumps(summary, indent=2, default=str) + "\n")
    write_whole(folder / DATA, data_file(packing, frames))


def _strict(value: Any) -> Any:
    """JSON has no infinity; `float` reads it back from a string."""
    if isinstance(value, tuple):
        return [_strict(each) for each in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def summary_in(folder: Path) -> dict[str, Any]:
    """What `summary.json` says."""
    path = folder / SUMMARY
    try:
        return dict(json.loads(_text(path, folder)))
    except (ValueError, TypeError) as error:
        raise FileError(f"{path} cannot be read: {error}") from None


def _text(path: Path, folder: Path) -> str:
    try:
        return path.read_text()
    except FileNotFoundError:
        raise FileError(f"no saved run in '{folder}': {path} is missing") from None
    except OSError as error:
        raise FileError(f"{path} cannot be read: {error.strerror}") from None


def _setting(value: Any) -> Any:
    """A word, a number, or numbers, as `_strict` has written them."""
    if isinstance(value, list):
        return [_setting(each) for each in value]
    try:
        return float(value)
    except ValueError:
        return value


def read(folder: Path) -> tuple[Packing, Law]:
    """The packing in a folder, to the last digit, and its model."""
    summary, path = summary_in(refuse(folder, but="compression")), folder / SUMMARY
    try:
        settings = dict(summary.get("law") or summary["model"])  # its name in version 0.1
        name = settings.pop("name")
        if name not in _LAWS:
            raise ValueError(f"there is no law {name!r}")
        law: Law = _LAWS[name](**{key: _setting(value) for key, value in settings.items()})
        radii = summary["radii"]
        path = folder / DATA
        return packing_in(_text(path, folder), radii), law
    except KeyError as error:
        raise FileError(f"{path} cannot be read: it does not tell {error}") from None
    except (ValueError, TypeError) as error:
        raise FileError(f"{path} cannot be read: {error}") from None
