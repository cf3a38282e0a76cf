"""States of particles that move in time, and the folders that keep them."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import UnsavedWarning
from ..common.strict_json import check_parameters
from ..io.data_file import Motion
from ..io.frames import drop_frames, frames_in
from ..io.lammps_script import TEMPERATURE
from ..io.run_folder import refuse_run
from ..io.store import save
from ..model.droplet import AnyLaw
from ..model.friction import Friction
from ..model.packing import Packing
from ..model.timestep import accurate_step


class Saved(ABC):
    """A state of a simulation in the plane or of droplets, which has a motion and can be saved."""

    packing: Packing
    law: Any
    velocities: NDArray[np.float64]
    root: bool
    time: float = 0.0
    strain: float | None = None
    friction: Friction | None = None
    unsaved: str = ""

    @abstractmethod
    def numbers(self) -> dict[str, Any]:
        """The state in numbers, by name."""

    @property
    @abstractmethod
    def squeezed(self) -> tuple[str, NDArray[np.float64]]:
        """What limits time steps, see `longest_step`: its name, and values of the particles."""

    @property
    def kinetic_energy(self) -> float:
        """Sum of v^2/2, as masses are 1; with friction also of R^2 w^2/4 for spins w [energy]."""
        return float(np.sum(self.velocities**2) / 2.0)

    @property
    def temperature(self) -> float:
        """Temperature of the motion, sum (v - mean v)^2 / (d N - d) in d dimensions [energy].

        Masses and k_B are 1.
        """
        relative = self.velocities - self.velocities.mean(axis=0)
        number, dimension = relative.shape
        return float(np.sum(relative**2) / (dimension * max(number - 1, 1)))

    @property
    def motion(self) -> Motion:
        """What goes on with a simulation from this state, beside the packing."""
        return Motion(self.velocities, self.time, self.strain)

    def step_limits(self) -> tuple[Packing, AnyLaw, float, float]:
        """The arguments of `longest_step` and `accurate_step`."""
        return self.packing, self.law, float(self.squeezed[1].max()), self.temperature

    def save(
        self,
        folder: str | Path,
        parameters: Mapping[str, Any] | None = None,
        overwrite: bool = False,
    ) -> None:
        """Write the state for `ld.Run`, and for LAMMPS with the script `in.lammps`.

        Args:
            folder: made if missing.
            parameters: for the summary, e.g. seed and protocol: what JSON can hold.
            overwrite: replace a state or a run that is there.

        Raises:
            ParameterError: an argument is of another kind.
            FileError: the folder has a state or a run and `overwrite` is not given, or it holds
                something else, or a file cannot be written.

        Warns:
            UnsavedWarning: the files lack what `unsaved` names.
        """
        check_parameters(parameters)
        if not self.root:
            return
        place = refuse_run(folder, overwrite)
        if frames_in(place):
            drop_frames(place)
        if self.unsaved:
            warnings.warn(
                f"'{folder}' has the particles and the law, but not the {self.unsaved} that were "
                "given to lmp",
                UnsavedWarning,
                stacklevel=2,
            )
        self._write(place, parameters)

    def _write(
        self, folder: Path, parameters: Mapping[str, Any] | None, frames: int | None = None
    ) -> None:
        """Write the state behind so many recorded frames up to it, if any."""
        packing, law, squeeze, now = self.step_limits()
        longest = self.friction.accurate_step if self.friction else np.inf
        steps = (
            min(accurate_step(packing, law, squeeze, now), longest),
            min(accurate_step(packing, law, squeeze, max(now, TEMPERATURE)), longest),
        )
        numbers = self.numbers()
        save(folder, packing, law, steps, numbers, self.motion, parameters, frames, self.friction)
