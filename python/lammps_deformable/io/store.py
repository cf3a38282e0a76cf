"""A saved state: data file, species file, LAMMPS script and summary in one folder."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, NamedTuple

from ..common.errors import FileError
from ..common.files import make_folder, reading, write_whole
from ..common.strict_json import as_json, from_json
from ..common.versions import versions
from ..model.droplet import ALL_LAWS, AnyLaw
from ..model.friction import Friction
from ..model.packing import Packing
from ..model.walls import KINDS, Wall
from .data_file import Motion, motion_in, packing_file, packing_in
from .lammps_commands import species_file
from .lammps_script import script
from .rubbing import rubbing_as_json
from .run_folder import DATA, SCRIPT, SPECIES, SUMMARY, refuse


def save(
    folder: str | Path,
    packing: Packing,
    law: AnyLaw,
    timesteps: tuple[float, float],
    numbers: Mapping[str, Any],
    motion: Motion,
    parameters: Mapping[str, Any] | None = None,
    frames: int | None = None,
    friction: Friction | None = None,
) -> None:
    """Write a state. Only one rank may call this.

    Args:
        folder: made if missing; a state there is replaced.
        packing: of the state.
        law: its contact law.
        timesteps: of the LAMMPS script, see there [time].
        numbers: the state in numbers, for the summary.
        motion: of its particles.
        parameters: for the summary, what JSON can hold.
        frames: number of recorded frames up to this state, if any.
        friction: of its contacts, if they rub.
    """
    folder = make_folder(folder)
    summary = {
        "state": as_json("state", numbers),
        **setup(packing, law, friction),
        "parameters": as_json("parameters", parameters or {}),
        "versions": versions(),
    }
    write_whole(folder / SPECIES, species_file(law, packing.radii))
    write_whole(folder / SCRIPT, script(packing, law, *timesteps, motion, friction))
    write_whole(folder / SUMMARY, json.dumps(summary, indent=2, allow_nan=False) + "\n")
    # last: it completes the state
    write_whole(folder / DATA, packing_file(packing, motion, frames))


class Setup(NamedTuple):
    """What a state is made of besides its particles."""

    law: AnyLaw
    radii: list[float]
    walls: tuple[Wall, ...]
    friction: Friction | None


def setup(packing: Packing, law: AnyLaw, friction: Friction | None) -> dict[str, Any]:
    """Law, radii of species, walls, and friction if contacts rub, as JSON."""
    settings = {name: value for name, value in asdict(law).items() if name != "contact"}
    return {
        "law": {"name": law.name} | as_json("law", settings),
        "radii": packing.radii.tolist(),
        "walls": [{"shape": wall.kind, **asdict(wall)} for wall in packing.walls],
        **({} if friction is None else {"friction": as_json("friction", asdict(friction))}),
    }


def memory(motion: Motion) -> dict[str, Any]:
    """Films, and springs of contacts, as JSON; nothing without."""
    films = {} if motion.films is None else {"films": motion.films.tolist()}
    return films | rubbing_as_json(motion.rubbing)


def read_setup(saved: Mapping[str, Any]) -> Setup:
    """The inverse of `setup`.

    Raises:
        KeyError, ValueError, TypeError: it is damaged.
    """
    settings = dict(saved["law"])
    name: str = settings.pop("name")
    if name not in ALL_LAWS:
        raise ValueError(f"there is no law {name!r}")
    law = replace(ALL_LAWS[name], **from_json(settings))
    walls = tuple(_wall(**each) for each in saved.get("walls", []))
    friction = _friction(saved["friction"]) if "friction" in saved else None
    return Setup(law, saved["radii"], walls, friction)


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


def _friction(saved: Mapping[str, Any]) -> Friction:
    settings, walls = from_json(saved), saved["walls"]
    return Friction(**settings | {"walls": None if walls is None else _friction(walls)})


def _wall(shape: str, **values: Any) -> Wall:
    """A wall of the summary."""
    if shape not in KINDS:
        raise ValueError(f"there is no wall {shape!r}")
    return KINDS[shape](**values)


def read(folder: Path) -> tuple[Packing, AnyLaw, Friction | None]:
    """The packing in a folder, with every digit, its contact law, and friction if contacts rub.

    Raises:
        FileError: a file is missing or damaged, or the folder holds other results.
    """
    summary = summary_in(refuse(folder, but="compression"))
    with reading(folder / SUMMARY):
        law, radii, walls, friction = read_setup(summary)
    with reading(folder / DATA):
        packing = packing_in(_text(folder / DATA, folder), radii, law.dimension)
        return (replace(packing, walls=walls) if walls else packing), law, friction


def read_motion(folder: Path, packing: Packing) -> Motion:
    """The motion of the packing in a folder.

    Raises:
        FileError: the file is missing or damaged.
    """
    with reading(folder / DATA):
        return motion_in(_text(folder / DATA, folder), len(packing), packing.dimension)
