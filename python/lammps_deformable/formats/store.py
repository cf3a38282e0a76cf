"""A saved state and a recorded run on disk: their files, written and read.

A state is a LAMMPS data file, a species file, a LAMMPS script and a summary. A run has a row in the
series and a frame in the trajectory for each state besides. Nothing is replaced unasked. What is in
the files stands in docs/run_folder.md; another FORMAT needs a row there.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.box import half_thickness
from ..common.checks import expect
from ..common.errors import FileError, ParameterError
from ..common.files import (
    as_json,
    at_home,
    from_json,
    make_folder,
    reading,
    refuse_present,
    write_whole,
    writing,
)
from ..common.versions import versions
from ..core import unit_vectors
from ..particles.commands import (
    Films,
    as_films,
    atom_style,
    film_commands,
    film_lines,
    films_in,
    law_commands,
    setup_commands,
    soft_commands,
    wall_commands,
)
from ..particles.containers import closed
from ..particles.friction import (
    Friction,
    Rubbing,
    friction_commands,
    rubbing_as_json,
    rubbing_from_json,
    rubbing_in,
    rubbing_lines,
    spring_commands,
)
from ..particles.gravity import Floats, gravity_commands
from ..particles.laws import ALL_LAWS, AnyLaw, SoftContact
from ..particles.packing import Packing, packing_of_species
from ..particles.species_file import species_file
from ..particles.walls import SHAPES, Wall
from .data_files import data_file, read_data_file, sphere_columns
from .dump_files import dump_frame, frame_texts, read_dump_frame

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

# What particles carry with them in motion, as columns of a trajectory and comments of a data file.
_DIRECTION, _ELEVATION, _LABEL, _CLONE = "direction", "elevation", "label", "clone"


def as_columns(motion: Motion) -> dict[str, NDArray[Any]]:
    """Columns of a trajectory: angles of directions, labels, clones; none without.

    A direction has an angle to the x axis in the xy plane, and in space one above this plane.
    """
    found: dict[str, NDArray[Any]] = {}
    if motion.directions is not None:
        x, y, *z = motion.directions.T
        found[_DIRECTION] = np.arctan2(y, x)
        if z:
            found[_ELEVATION] = np.arctan2(z[0], np.hypot(x, y))
    if motion.labels is not None:
        found[_LABEL] = motion.labels
    if motion.clones is not None:
        found[_CLONE] = motion.clones
    return found


def from_columns(columns: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """The inverse of `as_columns`: what a motion has of it."""
    found: dict[str, Any] = {}
    if _DIRECTION in columns:
        directions = unit_vectors(columns[_DIRECTION])
        if _ELEVATION in columns:
            flat, height = unit_vectors(columns[_ELEVATION]).T
            directions = np.column_stack([flat[:, None] * directions, height])
        found["directions"] = directions
    if _LABEL in columns:
        found["labels"] = columns[_LABEL].astype(np.int64)
    if _CLONE in columns:
        found["clones"] = columns[_CLONE].astype(np.int64)
    return found


def carried_lines(motion: Motion) -> str:
    """Comments at the end of a data file, in the order of IDs; none without columns."""
    lines = [
        f"# {name} {value!r}\n"
        for name, values in as_columns(motion).items()
        for value in values.tolist()
    ]
    return "\n" * bool(lines) + "".join(lines)


def carried_in(text: str, number: int) -> dict[str, Any]:
    """What the comments of a data file of so many atoms have, see `from_columns`.

    Raises:
        ValueError: they are damaged.
    """
    columns = {}
    for name in (_DIRECTION, _ELEVATION, _LABEL, _CLONE):
        values = re.findall(rf"^# {name} (.+)$", text, re.MULTILINE)
        if len(values) not in (0, number):
            raise ValueError(f"it has {name}s of {len(values)} of {number} atoms")
        if values:
            columns[name] = np.array(values, np.float64)
    return from_columns(columns)


class Motion(NamedTuple):
    """How far a simulation has come, beside its packing.

    Attributes:
        velocities: of the particles, shape (N, d) [length/time].
        time: of the motion so far [time].
        strain: shear strain so far; None without shear.
        films: those that there are, see `commands.Films`; None if nothing sticks.
        directions: in which particles propel themselves, shape (N, d); None if they do not.
        rubbing: spins, and what contacts that rub remember; None if they do not.
        images: how often particles have left the box through each side, shape (N, d); None: never.
        lost: energy that films have lost so far [energy].
        labels: number that each particle keeps where others vanish or are born, shape (N,); None
            as long as none do.
        clones: label of the first ancestor of each particle, shape (N,); None if none divided.
    """

    velocities: NDArray[np.float64]
    time: float = 0.0
    strain: float | None = None
    films: Films | None = None
    directions: NDArray[np.float64] | None = None
    rubbing: Rubbing | None = None
    images: NDArray[np.int64] | None = None
    lost: float = 0.0
    labels: NDArray[np.int64] | None = None
    clones: NDArray[np.int64] | None = None

    @property
    def moves(self) -> bool:
        """Whether any particle moves or spins."""
        spins = self.rubbing is not None and self.rubbing.spins.any()
        return bool(self.velocities.any() or spins)


def packing_file(packing: Packing, motion: Motion, frames: int | None) -> str:
    """A packing as a LAMMPS data file.

    Its title has time, strain and the energy lost by films where these are not 0, and the number of
    recorded frames, if given. Films, directions, labels and springs of contacts are comments at its
    end.
    """
    style = atom_style(packing)
    space = "two" if packing.dimension == 2 else "three"
    title = f"LAMMPS data file by lammps-deformable, units lj, atom_style {style}, "
    title += f"{space}-dimensional"
    columns: list[NDArray[Any]] = [packing.species + 1]
    if packing.own_radii:
        columns += sphere_columns(packing.radii)
    if motion.time:
        title += f", time {motion.time!r}"
    if motion.strain is not None:
        title += f", strain {motion.strain!r}"
    if motion.lost:
        title += f", lost {motion.lost!r}"
    text = data_file(
        title if frames is None else f"{title}, {frames} frames",
        style,
        packing.box,
        len(packing.species_radii),
        columns,
        packing.positions,
        origin=packing.origin.tolist(),
        velocities=motion.velocities if motion.moves else None,
        spins=motion.rubbing.spins if motion.rubbing else None,
        images=motion.images,
        half=half_thickness(float(packing.species_radii.max())),
    )
    memory = film_lines(motion.films) + rubbing_lines(motion.rubbing)
    return text + memory + carried_lines(motion)


def packing_in(text: str, radii: list[float], dimension: int) -> Packing:
    """The packing in a data file, which LAMMPS itself would round while it reads it.

    Args:
        text: of the file, as `packing_file` or LAMMPS' `write_data` writes it.
        radii: of the species [length].
        dimension: 2, or 3 in space.

    Raises:
        ValueError: the text is no such file, or lacks atoms.
    """
    found = read_data_file(text)
    if not np.array_equal(found.ids, np.arange(1, len(found.ids) + 1)):
        raise ValueError(f"atom IDs must be 1 to {len(found.ids)}")
    own = "diameter" in found.columns
    return packing_of_species(
        found.places(dimension),
        found.species,
        radii,
        found.lattice(dimension),
        found.radius("diameter") if own else None,
    )


def motion_in(text: str, number: int, dimension: int) -> Motion:
    """The motion in a data file of so many atoms, as `packing_file` or `write_data` writes it.

    Args:
        text: of the file.
        number: of atoms.
        dimension: 2, or 3 in space.

    Raises:
        ValueError: velocities, directions or labels are missing or damaged.
    """
    title, _, body = text.partition("\n")
    time, strain, lost = (
        re.search(rf", {name} ([^,]+)", title) for name in ("time", "strain", "lost")
    )
    velocities = np.zeros((number, dimension))
    spins = np.zeros(number if dimension == 2 else (number, 3))
    _, _, section = body.partition("\nVelocities\n\n")
    rows = [row.split() for row in section.partition("\n\n")[0].splitlines()]
    if rows:
        ids, vx, vy, vz, *turn = np.array(rows, dtype=np.float64).T
        if sorted(ids) != list(range(1, number + 1)):
            raise ValueError(f"it has velocities of {len(ids)} of {number} atoms")
        order = ids.astype(np.int64) - 1
        velocities[order] = np.column_stack([vx, vy, vz][:dimension])
        if turn:
            spins[order] = turn[2] if dimension == 2 else np.column_stack(turn)
    return Motion(
        velocities,
        float(time[1]) if time else 0.0,
        float(strain[1]) if strain else None,
        films=films_in(text),
        rubbing=rubbing_in(text, spins),
        images=images_in(read_data_file(text).columns, dimension),
        lost=float(lost[1]) if lost else 0.0,
        **carried_in(text, number),
    )


def images_in(
    columns: Mapping[str, NDArray[np.float64]], dimension: int
) -> NDArray[np.int64] | None:
    """The image flags among the columns of a file, shape (N, d); None without."""
    names = ("ix", "iy", "iz")[:dimension]
    if not all(name in columns for name in names):
        return None
    return np.column_stack([columns[name] for name in names]).astype(np.int64)


# Of the motion that the comments of a script propose [energy].
TEMPERATURE = 1e-8

_SCRIPT = """
# A packing saved by lammps-deformable. Run it in this folder: lmp -in {script}
# Later saves replace this file: copy it before you change it.
{setup}
read_data {data}
{law}
thermo_style custom step pe ke press
thermo_modify norm no format float %.16g
run 0

{relaxing}# To let it move at constant energy{but}:
# timestep {moving!r}
{velocity}# fix move all {integrator}
{plane}# thermo 100
# run 1000
"""


# For soft contacts Python computes the forces of walls.
_WITHOUT_WALLS = "# LAMMPS has no walls for soft contacts: these are left out\n"

_RELAXING = """# To relax it:
# minimize 0 1e-12 10000 20000

"""


def script(
    packing: Packing,
    law: AnyLaw | SoftContact,
    timestep: float,
    moving: float,
    motion: Motion,
    friction: Friction | None,
    gravity: Floats | None,
) -> str:
    """Text of a LAMMPS script that reads a saved packing and evaluates it.

    Args:
        packing: what is saved.
        law: its contact law.
        timestep: of a minimization [time].
        moving: time step of a motion at the temperature `TEMPERATURE` [time].
        motion: of the saved particles, with films and springs of contacts.
        friction: of the contacts, if they rub.
        gravity: of the particles, if there is one.
    """
    if isinstance(law, SoftContact):
        commands = _WITHOUT_WALLS * bool(packing.walls) + soft_commands(packing, law.k)
    else:
        commands = law_commands(packing, law, SPECIES) + wall_commands(packing.walls)
        commands += film_commands(law, packing.walls, motion.films)
    commands += friction_commands(friction, len(packing.species_radii)) + spring_commands(
        friction, motion.rubbing
    )
    commands += gravity_commands(gravity) + f"timestep {timestep!r}\n"
    setup = setup_commands(packing)
    velocity = "" if motion.moves else f"# velocity all create {TEMPERATURE!r} 12345\n"
    sphere = "nve/sphere disc" if packing.dimension == 2 else "nve/sphere"
    integrator = sphere if friction else "nve"
    relaxing = "" if friction else _RELAXING  # minimizers pass over friction
    proposed = {
        "but": " (not with deformable/sector)" if packing.dimension == 2 else "",
        "moving": moving,
        "velocity": velocity,
        "integrator": integrator,
        "relaxing": relaxing,
        "plane": "# fix plane all enforce2d\n" if packing.dimension == 2 else "",
    }
    return _SCRIPT.format(script=SCRIPT, setup=setup, data=DATA, law=commands, **proposed).lstrip()


# Version of the format, which is raised where older versions of this package misread new files.
FORMAT = 1

# Files of a run, see `recording`.
DATA, SUMMARY = "packing.data", "summary.json"
SERIES, TRAJECTORY, SETUPS = "series.csv", "trajectory.lammpstrj", "setups.jsonl"
SPECIES, SCRIPT = "species.deformable", "in.lammps"

# Results that are kept for an interrupted report.
PARTS = "*parts/*/joblib"

Kind = Literal["run", "report"]


def holds(folder: str | Path) -> Kind | None:
    """Kind of results in a folder, or None if it has none."""
    folder = at_home(folder)
    if any((folder / name).exists() for name in (DATA, SERIES, TRAJECTORY)):
        return "run"
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
    folder = at_home(folder)
    with writing(folder):  # names may be too long
        for place in (folder, *folder.parents):
            if place.exists() and not place.is_dir():
                raise FileError(f"'{place}' is a file, not a folder: name another folder")
        found = holds(folder)
    if found is not None and found != but:
        ways_out = (*(ways if found == "run" else ()), "name another folder")
        raise FileError(f"'{folder}' holds a {found}: {', or '.join(ways_out)}")
    return folder


def refuse_run(
    folder: str | Path, replaces: bool, ways: tuple[str, ...] = ("replace it with mode='w'",)
) -> Path:
    """Raise an error unless a folder is free for a new run.

    Args:
        folder: may be missing.
        replaces: or goes on with a run in it.
        ways: ways out to name in the error if it holds one.

    Returns:
        The folder.

    Raises:
        FileError: as `refuse`, or it has a file of the name of one of a run.
    """
    place = refuse(folder, "run" if replaces else None, ways)
    for name in (SUMMARY, SPECIES, SCRIPT, SETUPS):
        refuse_present(place / name, replaces)
    return place


def rows_in(path: Path) -> list[dict[str, str]]:
    """The rows of a table; none without the file."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def columns_in(path: Path) -> list[str]:
    """The columns that a table began with; none without the file."""
    if not path.exists():
        return []
    with path.open(newline="", errors="replace") as file:
        return next(csv.reader(file), [])


def append_row(path: Path, number: int, numbers: Mapping[str, Any]) -> None:
    """Append a row, which is in the file when this returns; later rows keep the first columns.

    Args:
        path: of the table.
        number: of the frame; 0 begins the table.
        numbers: values by column.
    """
    row = io.StringIO()
    names = (columns_in(path) if number else []) or ["frame", *numbers]
    writer = csv.DictWriter(row, names, extrasaction="ignore")
    if number == 0:
        writer.writeheader()
    writer.writerow({"frame": number} | dict(numbers))
    append(path, row.getvalue())


def keep_rows(path: Path, count: int) -> None:
    """Cut a table after its first rows; without rows it has no columns either."""
    if path.exists():
        with path.open("rb") as file:
            for _ in range(count + 1 if count > 0 else 0):
                file.readline()
            cut(path, file.tell())


def refuse_foreign(path: Path) -> None:
    """Raise an error if there is a file that is no table of states."""
    with writing(path):  # names may be too long
        columns = columns_in(path)
    if columns and "phi" not in columns:
        raise FileError(f"{path} is no series of states: take another name")


def append(path: Path, text: str) -> None:
    """Append text to a file."""
    with writing(path), path.open("a", newline="") as file:
        file.write(text)


def cut(path: Path, end: int) -> None:
    """Cut a file after so many bytes, if it has more."""
    with writing(path):
        if path.stat().st_size > end:
            os.truncate(path, end)


def frames_in(folder: Path) -> int:
    """Number of recorded frames up to the saved state in a folder, in its title or its series."""
    if (folder / DATA).exists():
        with (folder / DATA).open(errors="replace") as file:
            title = file.readline().rstrip("\n")
        counted = re.search(r", (\d+) frames$", title)
        if counted:
            return int(counted[1])
    return len(series_in(folder))


def series_in(folder: Path) -> list[dict[str, str]]:
    """The rows of the series in a folder; none without a series."""
    return rows_in(folder / SERIES)


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
        (folder / TRAJECTORY, (name for name, _ in _frames_of_trajectory(folder / TRAJECTORY))),
        (folder / SERIES, (row.get("frame") for row in series_in(folder))),
    ):
        for n in range(count):
            if next(numbers, None) != str(n):
                raise FileError(
                    f"{path} lacks frame {n} of {count} recorded frames: restore the file, or name "
                    "another folder"
                )


def _frames_of_trajectory(path: Path) -> Iterator[tuple[str, int]]:
    """Numbers of the frames, and where each ends [byte], up to the first incomplete frame."""
    if not path.exists():
        return
    with path.open("rb") as file:
        while True:
            head = [file.readline().strip() for _ in range(9)]
            if head[0] != b"ITEM: TIMESTEP" or not (head[1].isdigit() and head[3].isdigit()):
                return
            rows = [file.readline() for _ in range(int(head[3]))]
            if not all(row.endswith(b"\n") for row in rows):
                return
            yield head[1].decode(), file.tell()


def clock_of(folder: Path) -> list[tuple[float, float | None]]:
    """Time and shear strain of each frame in the series; None without shear."""
    return [_clock(row) for row in series_in(folder)]


def _clock(row: Mapping[str, str]) -> tuple[float, float | None]:
    strain = row.get("shear_strain") or None
    return float(row.get("time") or 0.0), None if strain is None else float(strain)


def keep_frames(folder: Path, first: int) -> None:
    """Cut series, trajectory and setups after their first frames: a killed run may have more."""
    ends = [0, *(end for _, end in islice(_frames_of_trajectory(folder / TRAJECTORY), first))]
    if (folder / TRAJECTORY).exists():
        cut(folder / TRAJECTORY, ends[-1])
    keep_rows(folder / SERIES, first)
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
            append(folder / SETUPS, line)


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


class Frames:
    """The recorded frames in a folder, of which one at a time is read.

    Args:
        folder: of the run.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._kept: dict[str, tuple[object, Any]] = {}

    def rows(self) -> list[dict[str, str]]:
        """The rows of the series."""
        return self._read(SERIES, rows_in)

    def setup(self, number: int) -> dict[str, Any]:
        """What a frame is made of besides its particles.

        Raises:
            LookupError: there is none.
        """
        return setup_of(self._read(SETUPS, lambda _: setups_in(self._folder)), number)

    def text(self, number: int) -> str:
        """A frame of the trajectory, without its first line.

        Raises:
            FileError: there is no trajectory.
            LookupError: the frame is missing.
        """
        path = recorded(self._folder, TRAJECTORY)
        places = self._read(TRAJECTORY, frame_texts)
        if number >= len(places):
            raise LookupError("it is missing")
        with path.open("rb") as file:
            file.seek(places[number].start)
            found = file.read(places[number].stop - places[number].start)
        return found.decode().partition("\n")[2]

    def _read(self, name: str, read: Callable[[Path], Any]) -> Any:
        """What there is to know of a file, found again where it has changed."""
        path = self._folder / name
        now = path.stat() if path.exists() else None
        stamp = now and (now.st_mtime_ns, now.st_size, now.st_ino)
        if name not in self._kept or self._kept[name][0] != stamp:
            self._kept[name] = stamp, read(path)
        return self._kept[name][1]


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
    append(folder / TRAJECTORY, _dump_frame(number, packing, columns))
    append_row(folder / SERIES, number, numbers)


def _dump_frame(number: int, packing: Packing, columns: Mapping[str, NDArray[Any]]) -> str:
    return dump_frame(
        number,
        packing.box,
        packing.species,
        packing.positions,
        columns,
        packing.origin.tolist(),
        closed(packing.walls, packing.dimension),
        half_thickness(float(packing.species_radii.max())),
    )


def read_frame(
    frame: str,
    radii: Sequence[float],
    saved: Mapping[str, Any],
    row: Mapping[str, str],
    dimension: int,
) -> tuple[Packing, Motion, dict[str, NDArray[Any]]]:
    """A packing, its motion, and the columns of a frame as a protocol writes it.

    Particles may have been added or deleted and their radii and species changed since. They have
    radii of their own where these are others than those of their species.

    Args:
        frame: its text, without the first line.
        radii: of the species.
        saved: its setup, with films and springs of contacts.
        row: of the series.
        dimension: 2, or 3 in space.
    """
    found = read_dump_frame(frame)
    values, species, largest = found.columns, found.species, np.array(radii)
    own = bool((values["radius"] != largest[species]).any())
    np.maximum.at(largest, species, values["radius"])
    packing = packing_of_species(
        found.places(dimension),
        species,
        largest,
        found.lattice(dimension),
        values["radius"] if own else None,
    )
    velocities = np.column_stack([values[name] for name in ("vx", "vy", "vz")[:dimension]])
    motion = Motion(
        velocities,
        *_clock(row),
        films=as_films(saved.get("films")),
        rubbing=rubbing_from_json(saved, values),
        images=images_in(values, dimension),
        **from_columns(values),
    )
    return packing, motion, dict(values)


def save(
    folder: str | Path,
    packing: Packing,
    law: AnyLaw | SoftContact,
    timesteps: tuple[float, float],
    numbers: Mapping[str, Any],
    motion: Motion,
    parameters: Mapping[str, Any] | None = None,
    frames: int | None = None,
    friction: Friction | None = None,
    gravity: Floats | None = None,
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
        gravity: of its particles, if there is one.
    """
    folder = make_folder(folder)
    summary = {
        "format": FORMAT,
        "state": as_json("state", numbers),
        **setup(packing, law, friction, gravity),
        "parameters": as_json("parameters", parameters or {}),
        "versions": versions(),
    }
    if not isinstance(law, SoftContact):  # LAMMPS' own pair styles have no species file
        write_whole(folder / SPECIES, species_file(law, packing.species_radii))
    write_whole(folder / SCRIPT, script(packing, law, *timesteps, motion, friction, gravity))
    write_whole(folder / SUMMARY, json.dumps(summary, indent=2, allow_nan=False) + "\n")
    # last: it completes the state
    write_whole(folder / DATA, packing_file(packing, motion, frames))


class Setup(NamedTuple):
    """What a state is made of besides its particles."""

    law: AnyLaw | SoftContact
    radii: list[float]
    walls: tuple[Wall, ...]
    friction: Friction | None
    gravity: Floats | None
    dimension: int


def setup(
    packing: Packing,
    law: AnyLaw | SoftContact,
    friction: Friction | None,
    gravity: Floats | None,
) -> dict[str, Any]:
    """Law, radii of species, walls, friction if contacts rub, and gravity, as JSON."""
    settings = {name: value for name, value in asdict(law).items() if name != "contact"}
    return {
        "law": {"name": law.name} | as_json("law", settings),
        "dimension": packing.dimension,
        "radii": packing.species_radii.tolist(),
        "walls": [{"shape": type(wall).__name__, **asdict(wall)} for wall in packing.walls],
        **({} if friction is None else {"friction": as_json("friction", asdict(friction))}),
        **({} if gravity is None else {"gravity": gravity.tolist()}),
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
    laws = {**ALL_LAWS, "soft": SoftContact()}
    if name not in laws:
        raise ValueError(f"there is no law {name!r}")
    law = replace(laws[name], **from_json(settings))
    walls = tuple(_wall(**each) for each in saved.get("walls", []))
    friction = _friction(saved["friction"]) if "friction" in saved else None
    gravity = np.array(saved["gravity"], np.float64) if "gravity" in saved else None
    return Setup(law, saved["radii"], walls, friction, gravity, int(saved["dimension"]))


def summary_in(folder: Path) -> dict[str, Any]:
    """Content of `summary.json`.

    Raises:
        FileError: the file is missing or damaged.
    """
    with reading(folder / SUMMARY):
        summary = dict(json.loads(_text(folder / SUMMARY, folder)))
        if int(summary.get("format", 1)) > FORMAT:  # without it is of 0.1.0
            raise FileError(
                f"'{folder}' has the format {summary['format']}, and this version of "
                f"lammps-deformable reads up to {FORMAT}: install a newer one"
            )
    return summary


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
    if shape not in SHAPES:
        raise ValueError(f"there is no wall {shape!r}")
    return SHAPES[shape](**values)


def read(folder: Path) -> tuple[Packing, Setup]:
    """The packing in a folder, with every digit, and what it is made of besides.

    Raises:
        FileError: a file is missing or damaged, or the folder holds other results.
    """
    summary = summary_in(refuse(folder, but="run"))
    with reading(folder / SUMMARY):
        made_of = read_setup(summary)
    with reading(folder / DATA):
        text = _text(folder / DATA, folder)
        packing = packing_in(text, made_of.radii, made_of.dimension)
        return (packing.replace(walls=made_of.walls) if made_of.walls else packing), made_of


def read_motion(folder: Path, packing: Packing) -> Motion:
    """The motion of the packing in a folder.

    Raises:
        FileError: the file is missing or damaged.
    """
    with reading(folder / DATA):
        return motion_in(_text(folder / DATA, folder), len(packing), packing.dimension)
