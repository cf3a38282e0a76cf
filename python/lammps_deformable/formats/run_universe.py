"""A Universe of MDAnalysis for a recorded run: MDAnalysis takes seconds to load."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from MDAnalysis.coordinates.LAMMPS import DumpReader
from MDAnalysis.coordinates.timestep import Timestep
from MDAnalysis.lib.util import store_init_arguments

from ..common.box import in_space
from ..common.errors import FileError
from .store import TRAJECTORY, check_frames, clock_of, frames_in, read, recorded, series_in
from .universe import box_in_space

if TYPE_CHECKING:
    from MDAnalysis import Universe


class FrameReader(DumpReader):  # type: ignore[misc]
    """Frames as those of `State.to_mdanalysis`: MDAnalysis' own reads no vx without vz.

    It is no transformation, because a trajectory takes transformations only once, and these are for
    the user.

    Args:
        filename: of the trajectory.
        dimension: of the packings, 2 or 3.
        frames: numbers of those that count; a killed run may have half a frame beyond them.
        kwargs: of MDAnalysis' reader.
    """

    @store_init_arguments  # type: ignore[untyped-decorator]
    def __init__(self, filename: str, dimension: int, frames: range, **kwargs: Any) -> None:
        self._plane = dimension == 2
        self._chosen = frames
        super().__init__(filename, **kwargs)

    @property
    def n_frames(self) -> int:
        _ = super().n_frames  # finds the offsets of all frames
        return len(self._chosen)

    def _read_frame(self, frame: int) -> Timestep:
        self.ts.frame = frame - 1
        return self._read_next_timestep()

    def _read_next_timestep(self) -> Timestep:
        following = self.ts.frame + 1
        if following >= len(self):
            raise EOFError
        self._file.seek(self._offsets[self._chosen[following]])
        frame = super()._read_next_timestep()
        if self._plane:
            frame.dimensions = box_in_space(frame.triclinic_dimensions[:2, :2].astype(np.float64))
            frame.positions[:, 2] = 0.0
            frame.velocities = in_space(np.column_stack([frame.data["vx"], frame.data["vy"]]))
        return frame


def universe(folder: Path, frames: range | None = None) -> Universe:
    """A Universe of MDAnalysis of a recorded run, see `Run.to_mdanalysis`.

    Args:
        folder: of the run.
        frames: numbers of its frames; all if not given.
    """
    import MDAnalysis

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
            frames=range(frames_in(folder)) if frames is None else frames,
        )
    found.add_TopologyAttr("radii", packing.radii)
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
