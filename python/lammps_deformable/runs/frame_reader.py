"""MDAnalysis' reader of LAMMPS dumps, for recorded runs. Imports MDAnalysis."""

from __future__ import annotations

from typing import Any

import numpy as np
from MDAnalysis.coordinates.LAMMPS import DumpReader
from MDAnalysis.coordinates.timestep import Timestep
from MDAnalysis.lib.util import store_init_arguments

from ..formats.universes import box_in_space, in_space


class FrameReader(DumpReader):  # type: ignore[misc]
    """Frames as those of `State.to_mdanalysis`: MDAnalysis' own reads no vx without vz.

    It is no transformation, because a trajectory takes transformations only once, and these are for
    the user.

    Args:
        filename: of the trajectory.
        dimension: of the packings, 2 or 3.
        frames: number of recorded frames; a killed run may have half a frame beyond them.
        kwargs: of MDAnalysis' reader.
    """

    @store_init_arguments  # type: ignore[untyped-decorator]
    def __init__(self, filename: str, dimension: int, frames: int, **kwargs: Any) -> None:
        self._plane = dimension == 2
        self._recorded = frames
        super().__init__(filename, **kwargs)

    @property
    def n_frames(self) -> int:
        return int(min(super().n_frames, self._recorded))

    def _read_next_timestep(self) -> Timestep:
        frame = super()._read_next_timestep()
        if self._plane:
            frame.dimensions = box_in_space(frame.triclinic_dimensions[:2, :2].astype(np.float64))
            frame.positions[:, 2] = 0.0
            frame.velocities = in_space(np.column_stack([frame.data["vx"], frame.data["vy"]]))
        return frame
