"""Recorded runs: folders that are written as a run goes on, opened again, and gone on with.

    packing.data            last state, LAMMPS data file
    species.deformable      its species, for the pair style
    in.lammps               LAMMPS script that reads these two
    summary.json            numbers of the last state, law, parameters and versions
    series.csv              one row per state
    trajectory.lammpstrj    LAMMPS dump for OVITO and MDAnalysis
    setups.jsonl            law, radii and walls of the frames: a line for each change

`State.save` writes the first four, `record` all of them while a run goes on. A run may be
interrupted at any moment: the packing is written last and atomically, with the number of recorded
frames. Frames beyond it are removed when the run goes on.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from mpi4py import MPI

from ..common.errors import FileError, StalledWarning
from ..common.files import reading
from ..common.progress import progress
from ..common.ranks import world
from ..common.steps import Steps, start_of
from ..common.strict_json import from_json
from ..common.validate import expect
from ..engine.deforming import Deforming
from ..engine.lammps import communicator
from ..engine.opening import go_on
from ..engine.relaxation import TOLERANCE
from ..engine.simulation import Simulation
from ..io import frames
from ..io.run_folder import SUMMARY, refuse
from ..io.store import read, read_motion, read_setup, summary_in
from ..protocols.shear import check_shear
from ..state.droplet_state import DeformedState
from ..state.state import State
from . import analysis, movie
from .recording import begin, compression, expect_states, shear_protocol, steps_of, write

if TYPE_CHECKING:
    from MDAnalysis import Universe


class Run:
    """A run in a folder, or a saved state, which is a run without frames.

        run = ld.Run("run")
        run[-1].plot()
        for state in run:
            print(state.phi)

    `len(run)` is the number of recorded states, `run[3]` and `run[-1]` are states, `run[0]` is the
    one before the first step, and `run[2:5]` is a list of them. States are evaluated again from the
    recorded positions, with the law, radii and walls that they had, and are `stalled` if they were.
    The files are read when they are needed. All MPI ranks must ask for the same.

    Attributes:
        folder: of the run.

    Raises:
        FileError: the folder has no run, or a file is missing or cannot be read. On several ranks,
            of which one may still be writing, this is told when files are needed.
        IndexError: there is no such state.
    """

    def __init__(self, folder: str | Path) -> None:
        expect("folder", folder, str, Path)
        self.folder = Path(folder)
        if world().size == 1:
            self._check()

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r})"

    def _check(self) -> None:
        """Say what is missing."""
        summary_in(refuse(self.folder, but="compression"))

    def __len__(self) -> int:
        self._check()
        return frames.frames_in(self.folder)

    def __iter__(self) -> Iterator[DeformedState]:
        return self._states(self._numbers())

    @overload
    def __getitem__(self, index: int) -> DeformedState: ...
    @overload
    def __getitem__(self, index: slice) -> list[DeformedState]: ...
    def __getitem__(self, index: int | slice) -> DeformedState | list[DeformedState]:
        numbers = self._numbers()
        if isinstance(index, slice):
            return list(self._states(numbers[index]))
        expect("the number of a state", index, int, np.integer)
        last = len(numbers) - 1
        if last < 0:
            raise IndexError(
                f"'{self.folder}' has one saved state and no recorded ones: take Run.simulation()"
            )
        if not -last - 1 <= index <= last:
            raise IndexError(
                f"'{self.folder}' has {last + 1} states, and no state {index}: give 0 to {last}, "
                f"or -1 to {-last - 1} from the end"
            )
        (state,) = self._states([numbers[index]])
        return state

    def _numbers(self) -> range:
        """Of all states."""
        communicator(None).barrier()  # rank 0 may still be writing
        return range(len(self))

    def _states(self, numbers: Iterable[int]) -> Iterator[DeformedState]:
        """States of these frames, from 0."""
        numbers = list(numbers)
        if not numbers:
            return
        texts, setups = frames.texts_of(self.folder), frames.setups_in(self.folder)
        clock, stalled = frames.clock_of(self.folder), frames.stalled_in(self.folder)
        with progress("replaying", unit="state", total=len(numbers)) as bar:
            for number in numbers:
                with reading(f"frame {number} of {self.folder / frames.TRAJECTORY}"):
                    saved = frames.setup_of(setups, number)
                    law, radii, walls, friction = read_setup(saved)
                    if number >= len(texts):
                        raise LookupError("it is missing")
                    now = clock[number] if number < len(clock) else (0.0, None)
                    packing, motion = frames.read_frame(
                        texts[number], radii, saved, now, law.dimension
                    )
                    packing = replace(packing, walls=walls)
                with Simulation(packing, law, friction=friction) as sim:
                    go_on(sim, motion)
                    state = sim.state()
                if motion.directions is not None and isinstance(state, State):
                    state = replace(state, directions=motion.directions)
                yield replace(state, stalled=number < len(stalled) and stalled[number])
                bar.update()

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters in the summary; those of what was done before have the key `before`."""
        with reading(self.folder / SUMMARY):
            return dict(from_json(summary_in(self.folder).get("parameters") or {}))

    def simulation(self, comm: MPI.Comm | None = None) -> Deforming[Any]:
        """A simulation of the last state: the same particles, box and law.

        Velocities, spins, films, springs of contacts, directions, time and shear strain go on from
        those of the state.

        Args:
            comm: as for `Simulation`.

        Warns:
            StalledWarning: the relaxation of that state had stalled.
        """
        communicator(comm).barrier()  # rank 0 may still be writing
        last = summary_in(self.folder).get("state")
        if isinstance(last, dict) and last.get("stalled"):
            warnings.warn(
                f"the relaxation of the state in '{self.folder}' had stalled, at a residual of "
                f"{last.get('residual')}: relax the simulation before you measure",
                StalledWarning,
                stacklevel=2,
            )
        return self._simulation(comm)

    def _simulation(self, comm: MPI.Comm | None) -> Deforming[Any]:
        packing, law, friction = read(self.folder)
        motion = read_motion(self.folder, packing)
        sim = Simulation(packing, law, comm, friction=friction)
        go_on(sim, motion)
        return sim

    def append(
        self, states: Iterable[DeformedState], parameters: Mapping[str, Any] | None = None
    ) -> Iterator[DeformedState]:
        """Go on with the run: as `record`, behind the states that it has."""
        expect_states(states, parameters)
        parameters, start = {**(parameters or {}), **self._before()}, start_of(states)
        written = write(states, self.folder, parameters, len(self._numbers()), start)
        return Steps("append", written, start)

    def compress(
        self,
        strain: float | None = None,
        steps: int = 10,
        tolerance: float = TOLERANCE,
        parameters: Mapping[str, Any] | None = None,
        comm: MPI.Comm | None = None,
        phi: float | None = None,
        pressure: float | None = None,
    ) -> Iterator[DeformedState]:
        """Compress the last state further: as `compress_in`, behind the states of the run.

        Raises:
            FileError: the run is interrupted, see `resume`, or lacks frames.
        """
        protocol = compression(steps, tolerance, strain=strain, phi=phi, pressure=pressure)
        return self._go_on("Run.compress", protocol, parameters, comm)

    def shear(
        self,
        strain: float,
        steps: int = 10,
        tolerance: float = TOLERANCE,
        parameters: Mapping[str, Any] | None = None,
        comm: MPI.Comm | None = None,
    ) -> Iterator[DeformedState]:
        """Shear the last state: as `shear_in`, behind the states of the run.

        Raises:
            FileError: the run is interrupted, see `resume`, or lacks frames.
        """
        protocol = shear_protocol(strain, steps, tolerance)
        return self._go_on("Run.shear", protocol, parameters, comm)

    def resume(self, comm: MPI.Comm | None = None) -> Iterator[DeformedState]:
        """Finish an interrupted `compress_in` or `shear_in`, with the numbers of a whole one.

        The files of an unfinished step are removed.

        Args:
            comm: as for `Simulation`.

        Yields:
            The states that are missing; none if the run is complete.

        Raises:
            FileError: the run is another one, or its files cannot be read.
        """
        communicator(comm).barrier()  # rank 0 may still be writing
        packing, *_ = read(self.folder)
        motion = read_motion(self.folder, packing)
        parameters, done = self.parameters, self.steps_done
        if done is None:
            raise FileError(
                f"the run in '{self.folder}' cannot be resumed, as its last states are none of "
                "compress_in or shear_in: go on with Run.compress (in the shell: --append), or "
                "with Run.append of a protocol, such as move, of Run.simulation()"
            )
        communicator(comm).barrier()  # all ranks have read the folder
        if done >= parameters["steps"]:
            return iter(())
        frames.check_frames(self.folder)
        sim = self._simulation(comm)
        if done > 0:
            sim.relax(np.finfo(float).max)  # relaxed already: this only finds whether it is rigid
        return Steps("Run.resume", steps_of(sim, packing, motion, self.folder, parameters, done))

    @property
    def steps_done(self) -> int | None:
        """Recorded steps of the last `compress_in` or `shear_in`; None if there is none."""
        parameters = self.parameters
        return len(self) - int(parameters["start"]["frame"]) if "start" in parameters else None

    def movie(self, path: str | Path, **settings: Any) -> None:
        """Draw the states as a movie, see `ld.movie`."""
        movie.movie(self, path, **settings)

    def export(self, path: str | Path, forces: bool = False, overwrite: bool = False) -> None:
        """Write the shapes of the states for ParaView and OVITO, see `ld.export`."""
        analysis.export(self, path, forces, overwrite)

    def table(self, **columns: Callable[[DeformedState], Any]) -> Any:
        """The numbers of the states as a DataFrame of pandas, with the frames as index.

            run.table()[["phi", "pressure"]]
            run.table(order=lambda state: abs(state.hexatic()).mean())

        It has the box, `strain`, `phi`, `pressure`, `shear_stress`, `energy`, `temperature`,
        `time`, `coordination`, the numbers of `rattlers` and of particles `beyond` the model, the
        mean `shape_parameter`, or `load` of droplets in space, `residual` and `stalled`, as they
        were recorded.

        Args:
            columns: further ones: functions that return a number for a state. The states are
                evaluated again for them.

        Raises:
            ParameterError: a column is no function, or has the name of another.
            ImportError: pandas is missing (`pip install 'lammps-deformable[pandas]'`).
        """
        return analysis.table(self.folder, self, columns)

    def universe(self) -> Universe:
        """A Universe of MDAnalysis.

            for frame in ld.Run("run").universe().trajectory:
                print(frame.time, frame.data["area"].mean())

        Particles and frames are those of `State.to_mdanalysis`. `time` is that of a motion whose
        states are equally far apart, and the number of the frame in all other runs.

        Raises:
            FileError: the number of particles changes, which MDAnalysis does not know.
        """
        return analysis.universe(self.folder)

    def _before(self) -> dict[str, Any]:
        """The parameters of the run, for the summary of the next one."""
        frames.check_frames(self.folder)
        return {"before": self.parameters}

    def _go_on(
        self,
        name: str,
        protocol: Mapping[str, Any],
        parameters: Mapping[str, Any] | None,
        comm: MPI.Comm | None,
    ) -> Iterator[DeformedState]:
        expect_states((), parameters)
        sim = self.simulation(comm)
        if "protocol" in protocol:
            check_shear(sim, protocol["strain"], protocol["steps"])
        done, whole = self.steps_done, self.parameters.get("steps", 0)
        if done is not None and done < whole:
            raise FileError(
                f"the run in '{self.folder}' is interrupted at step {done} of {whole}: finish it "
                "first with --resume (in Python: Run.resume)"
            )
        return begin(name, sim, self.folder, protocol, parameters, self._before(), len(self))
