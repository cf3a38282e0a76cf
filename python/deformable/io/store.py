"""A saved state: data file, species file, LAMMPS script and summary in one folder."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ..common.errors import FileError
from ..common.files import make_folder, reading, write_whole
from ..common.versions import versions
from ..model.laws import LAWS, Law
from ..model.packing import Packing
from ..model.walls import KINDS, Wall
from .data_file import Motion, motion_in, packing_file, packing_in
from .films import Films, as_films
from .lammps_commands import species_file
from .lammps_script import script
from .run_folder import DATA, SCRIPT, SPECIES, SUMMARY, refuse


def save(
    folder: str | Path,
    packing: Packing,
    law: Law,
    timesteps: tuple[float, float],
    numbers: Mapping[str, Any],
    motion: Motion,
    parameters: Mapping[str, Any] | None = None,
    frames: int | None = None,
) -> None:
    """Write a state. Only one rank may call this.

    Args:
        folder: made if missing; an older state there is replaced.
        packing: of the state.
        law: its contact law.
        timesteps: of the LAMMPS script, see there [time].
        numbers: the state in numbers, for the summary.
        motion: of its particles.
        parameters: anything JSON for the summary.
        frames: number of recorded frames up to this state, if any.
    """
    folder = make_folder(folder)
    summary = {
        "state": dict(numbers),
        **setup(packing, law),
        "parameters": {name: _strict(value) for name, value in (parameters or {}).items()},
        "versions": versions(),
    }
    write_whole(folder / SPECIES, species_file(law, packing.radii))
    moves = bool(motion.velocities.any())
    write_whole(folder / SCRIPT, script(packing, law, *timesteps, moves, motion.films))
    write_whole(folder / SUMMARY, json.dumps(summary, indent=2, default=str) + "\n")
    # last: it completes the state
    write_whole(folder / DATA, packing_file(packing, motion, frames))


def setup(packing: Packing, law: Law, films: Films | None = None) -> dict[str, Any]:
    """What a state is made of besides its particles: law, radii of species, walls, and films."""
    settings = {name: _strict(value) for name, value in asdict(law).items() if name != "contact"}
    return {
        "law": {"name": law.name} | settings,
        "radii": packing.radii.tolist(),
        "walls": [{"shape": wall.kind, **asdict(wall)} for wall in packing.walls],
        **({} if films is None else {"films": films.tolist()}),
    }


def read_setup(
    saved: Mapping[str, Any],
) -> tuple[Law, list[float], tuple[Wall, ...], Films | None]:
    """The inverse of `setup`.

    Raises:
        KeyError, ValueError, TypeError: it is damaged.
    """
    settings = dict(saved["law"])
    name: str = settings.pop("name")
    if name not in LAWS:
        raise ValueError(f"there is no law {name!r}")
    law = replace(LAWS[name], **{key: _setting(value) for key, value in settings.items()})
    walls = tuple(_wall(**each) for each in saved.get("walls", []))
    return law, saved["radii"], walls, as_films(saved.get("films"))


def _strict(value: Any) -> Any:
    """Infinity as a string, because JSON has none."""
    if isinstance(value, tuple):
        return [_strict(each) for each in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def summary_in(folder: Path) -> dict[str, Any]:
    """Content of `summary.json`.

    Raises:
        FileError: the file is missing or damaged.
    """
    with reading(folder / SUMMARY):
        return dict(json.loads(_text(folder / SUMMARY, folder)))


def _text(path: Path, folder: Path) -> str:
    try:
        return path.read_text()
    except FileNotFoundError:
        raise FileError(
            f"no saved run in '{folder}': {path} is missing. Name another folder, or begin a run "
            "there, as with deformable compress --out"
        ) from None
    except NotADirectoryError:
        raise FileError(f"'{folder}' is a file, not a folder: name another folder") from None
    except OSError as error:
        raise FileError(f"{path} cannot be read: {error.strerror}") from None


def _setting(value: Any) -> Any:
    """Inverse of `_strict`: numbers as floats, words unchanged."""
    if isinstance(value, list):
        return [_setting(each) for each in value]
    try:
        return float(value)
    except ValueError:
        return value


def _wall(shape: str, **values: Any) -> Wall:
    """A wall of the summary."""
    if shape not in KINDS:
        raise ValueError(f"there is no wall {shape!r}")
    return KINDS[shape](**values)


def read(folder: Path) -> tuple[Packing, Law]:
    """The packing in a folder, with every digit, and its contact law.

    Raises:
        FileError: a file is missing or damaged, or the folder holds other results.
    """
    summary = summary_in(refuse(folder, but="compression"))
    with reading(folder / SUMMARY):
        law, radii, walls, _ = read_setup(summary)
    with reading(folder / DATA):
        packing = packing_in(_text(folder / DATA, folder), radii)
        return (replace(packing, walls=walls) if walls else packing), law


def read_motion(folder: Path, number: int) -> Motion:
    """The motion of the packing in a folder, of so many particles.

    Raises:
        FileError: the file is missing or damaged.
    """
    with reading(folder / DATA):
        return motion_in(_text(folder / DATA, folder), number)
