"""The states of a recorded run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..common.errors import FileError
from ..common.progress import progress
from ..engine.simulation import Simulation
from ..io.run_folder import TRAJECTORY
from ..model.room import stretched
from ..state.state import State
from .record import load


def replay(folder: str | Path) -> Iterator[State]:
    """The states of a recorded run, evaluated again from the recorded positions.

    Args:
        folder: of `record`.

    Yields:
        Each state as it was, but never `stalled`, and without `time`.

    Raises:
        FileError: a file is missing or cannot be read.
    """
    with load(folder) as sim:
        packing, law = sim.state().packing, sim.law
    path = Path(folder, TRAJECTORY)
    if not path.exists():
        raise FileError(f"no recorded run in '{folder}': {path} is missing")
    frames = path.read_text().split("ITEM: TIMESTEP\n")[1:]
    with progress("replaying", unit="state", total=len(frames)) as bar:
        for number, frame in enumerate(frames):
            try:
                box, positions, velocities = _read_frame(frame)
                walls = stretched(packing.walls, packing.box, box)
                recorded = replace(packing, positions=positions, box=box, walls=walls)
            except (ValueError, LookupError) as error:
                raise FileError(f"frame {number} of {path} cannot be read: {error}") from None
            with Simulation(recorded, law) as sim:
                yield replace(sim.state(), velocities=velocities)
            bar.update()


def _read_frame(
    frame: str,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Box, positions and velocities of a frame as `record` writes it."""
    lines = frame.splitlines()
    x, y, _ = (np.array(line.split(), dtype=float) for line in lines[4:7])
    xy = x[2] if len(x) == 3 else 0.0
    box = np.array([[x[1] - x[0] - abs(xy), 0.0], [xy, y[1] - y[0]]])
    names = lines[7].split()[2:]
    values = dict(zip(names, np.loadtxt(lines[8:], ndmin=2).T, strict=True))
    at_rest = np.zeros(len(values["x"]))  # runs of version 0.1 lack velocities
    return (
        box,
        np.column_stack([values["x"], values["y"]]),
        np.column_stack([values.get("vx", at_rest), values.get("vy", at_rest)]),
    )
