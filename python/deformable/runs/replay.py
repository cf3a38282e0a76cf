"""The states of a recorded run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FileError, ParameterError
from ..common.progress import progress
from ..common.validate import whole
from ..engine.simulation import Simulation
from ..io.frames import clock_of, setup_of, setups_in
from ..io.run_folder import TRAJECTORY
from ..io.store import read, read_setup
from ..model.packing import Packing
from ..state.state import State


def replay(folder: str | Path, frame: int | None = None) -> Iterator[State]:
    """The states of a recorded run, evaluated again from the recorded positions.

    Args:
        folder: of `record`.
        frame: only the state of this number, from 0; negative numbers count from the end.

    Yields:
        Each state as it was, but never `stalled`.

    Raises:
        ParameterError: there is no such frame.
        FileError: a file is missing or cannot be read.
    """
    folder = Path(folder)
    read(folder)  # or say why it is none
    setups = setups_in(folder)
    path = folder / TRAJECTORY
    if not path.exists():
        raise FileError(f"no recorded run in '{folder}': {path} is missing")
    frames = path.read_text().split("ITEM: TIMESTEP\n")[1:]
    if not frames:
        raise FileError(f"{path} has no state: it is empty, or no trajectory of a recorded run")
    clock = clock_of(folder)
    chosen = range(len(frames)) if frame is None else [_number(frame, len(frames))]
    with progress("replaying", unit="state", total=len(chosen)) as bar:
        for number in chosen:
            try:
                law, radii, walls = read_setup(setup_of(setups, number))
                recorded, velocities = _read_frame(frames[number], radii)
                recorded = replace(recorded, walls=walls)
                time, strain = clock[number] if number < len(clock) else (0.0, None)
            except (ValueError, TypeError, LookupError) as error:
                reason = str(error).split(";")[0]  # what follows is advice on NumPy
                raise FileError(f"frame {number} of {path} cannot be read: {reason}") from None
            with Simulation(recorded, law) as sim:
                yield replace(sim.state(), velocities=velocities, time=time, strain=strain)
            bar.update()


def _number(frame: int, count: int) -> int:
    """Number of a frame, from 0."""
    if not -count <= whole("frame", frame) < count:
        raise ParameterError(f"frame must lie between {-count} and {count - 1}, not {frame}")
    return int(frame) % count


def _read_frame(frame: str, radii: Sequence[float]) -> tuple[Packing, NDArray[np.float64]]:
    """Packing and velocities of a frame as `record` writes it.

    Particles may have been added or deleted and their radii and species changed since. They have
    radii of their own where these are others than those of their species.

    Args:
        frame: its text, without the first line.
        radii: of the species.
    """
    lines = frame.splitlines()
    x, y, _ = (np.array(line.split(), dtype=float) for line in lines[4:7])
    xy = x[2] if len(x) == 3 else 0.0
    box = np.array([[x[1] - x[0] - abs(xy), 0.0], [xy, y[1] - y[0]]])
    names = lines[7].split()[2:]
    values = dict(zip(names, np.loadtxt(lines[8:], ndmin=2).T, strict=True))
    if len(values["x"]) != int(lines[2]):
        raise ValueError(f"it has {len(values['x'])} of {lines[2]} particles")
    species, largest = values["type"].astype(np.int64) - 1, np.array(radii)
    own = bool((values["radius"] != largest[species]).any())
    np.maximum.at(largest, species, values["radius"])
    places = np.column_stack([values["x"], values["y"]])
    packing = Packing(places, species, largest, box, values["radius"] if own else None)
    return packing, np.column_stack([values["vx"], values["vy"]])
