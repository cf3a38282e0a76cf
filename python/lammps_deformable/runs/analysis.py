"""Recorded runs for other programs: MDAnalysis, pandas, ParaView, OVITO."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..common.errors import FileError, ParameterError
from ..common.files import refuse_present, write_whole
from ..common.optional import optional
from ..common.validate import expect
from ..io.frames import check_frames, clock_of, frames_in, recorded, series_in
from ..io.run_folder import SERIES, TRAJECTORY
from ..io.store import read
from ..io.vtk_files import collection
from ..state.droplet_state import DeformedState
from ..state.exports import Exports
from .columns import Column, check_columns

if TYPE_CHECKING:
    from MDAnalysis import Universe


def universe(folder: Path) -> Universe:
    """A Universe of MDAnalysis of a recorded run, see `Run.universe`."""
    import MDAnalysis

    from .frame_reader import FrameReader

    packing, *_ = read(folder)
    check_frames(folder)
    trajectory = recorded(folder, TRAJECTORY)
    times = [time for time, _ in clock_of(folder)]
    counts = [int(row.get("particles") or 0) for row in series_in(folder)]
    if len(set(counts)) > 1:
        raise FileError(
            f"the run in '{folder}' has {min(counts)} to {max(counts)} particles, but those of a "
            "Universe of MDAnalysis are always the same: iterate over the Run"
        )
    start, step = _clock(times)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # masses are 1: that is no guess
        found = MDAnalysis.Universe(
            str(trajectory),
            format=FrameReader,
            topology_format="LAMMPSDUMP",
            additional_columns=_columns(trajectory),
            dt=step,
            time_offset=start,
            dimension=packing.dimension,
            frames=frames_in(folder),
        )
    found.add_TopologyAttr("radii", packing.radius)
    return found


def _columns(trajectory: Path) -> list[str]:
    """Names of the values in a trajectory, beside id, type and position."""
    with trajectory.open() as file:
        head = next(line for line in file if line.startswith("ITEM: ATOMS"))
    return head.split()[7:]


def _clock(times: list[float]) -> tuple[float, float]:
    """Time of the first frame, and from one to the next: the frames' numbers if that varies."""
    steps = np.diff(times)
    if len(steps) and steps[0] > 0.0 and np.allclose(steps, steps[0], rtol=1e-6):
        return times[0], float(np.mean(steps))
    return 0.0, 1.0


def table(folder: Path, states: Iterable[DeformedState], columns: Mapping[str, Column]) -> Any:
    """The numbers of a recorded run as a DataFrame of pandas, see `Run.table`."""
    pandas = optional("pandas", "pandas")
    check_columns(columns, ())
    found = pandas.read_csv(recorded(folder, SERIES), index_col="frame")
    check_columns(columns, found.columns)
    found = found[found.index < frames_in(folder)]
    if not columns:
        return found
    check_frames(folder)
    rows = [{name: column(state) for name, column in columns.items()} for state in states]
    return found.assign(**pandas.DataFrame(rows, index=found.index, columns=list(columns)))


def export(
    states: Iterable[Exports], path: str | Path, forces: bool = False, overwrite: bool = False
) -> None:
    """Write the shapes of several states for ParaView and OVITO, see `State.export`.

    Args:
        states: e.g. from `compress`, or a `Run`.
        path: `NAME.pvd`, which lists the files NAME_0000.vtp, NAME_0001.vtp, ... beside it, with
            the times of a motion, or with their numbers.
        forces: write the networks of forces in the place of shapes.
        overwrite: replace files that are there.

    Raises:
        ParameterError: the suffix is another, or there are no states.
        FileError: there is a file and `overwrite` is not given, or it cannot be written.
    """
    expect("states", states, Iterable)
    expect("path", path, str, Path)
    path = Path(path)
    if path.suffix != ".pvd":
        raise ParameterError(f"a series of shapes is a .pvd, not '{path}'")
    names, times = [], []
    for number, state in enumerate(states):
        expect("a state that is exported", state, Exports)
        names.append(f"{path.stem}_{number:04d}.vtp")
        times.append(state.time)
        if state.root and number == 0:
            refuse_present(path, overwrite)
        state.export(path.with_name(names[-1]), forces, overwrite)
        if state.root:
            write_whole(path, collection(names, times))
    if not names:
        raise ParameterError("a series of shapes needs at least one state")
