"""Columns of a table of states that a user adds.

MDAnalysis' reader of LAMMPS dumps, for recorded runs. Imports MDAnalysis.

Recorded runs for other programs: MDAnalysis, pandas, ParaView, OVITO.

A table of states, without a record of them.

Shapes of the particles in a file of another program, such as a LAMMPS dump.

Recorded runs: folders that are written as a run goes on, opened again, and gone on with.

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
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Sized
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from MDAnalysis.coordinates.LAMMPS import DumpReader
from MDAnalysis.coordinates.timestep import Timestep
from MDAnalysis.lib.util import store_init_arguments
from mpi4py import MPI

from . import movies, potentials, store
from ._checks import expect, shown
from ._files import from_json, make_folder, reading, refuse_present, write_whole
from .engines import go_on
from .errors import FileError, ParameterError, StalledWarning
from .files import UNTYPED, box_in_space, in_space, read_particles
from .lammps import communicator
from .laws import ALL_LAWS, AnyLaw, Droplet, Ring
from .packing import Packing
from .progress import Steps, progress, start_of, waits_for_all
from .ranks import world
from .recording import begin, compression, expect_states, shear_protocol, steps_of, write
from .relax import TOLERANCE
from .shapes import collection
from .shearing import check_shear
from .simulation import Simulation
from .species import read_species, species_names
from .state import State
from .store import (
    SERIES,
    SUMMARY,
    TRAJECTORY,
    append_row,
    check_frames,
    clock_of,
    columns_in,
    frames_in,
    holds,
    keep_rows,
    read,
    read_motion,
    read_setup,
    recorded,
    refuse,
    refuse_foreign,
    rows_in,
    series_in,
    summary_in,
)
from .versions import optional

if TYPE_CHECKING:
    from MDAnalysis import Universe


Column = Callable[[Any], Any]


def check_columns(columns: Mapping[str, Column], others: Iterable[str]) -> None:
    """Refuse columns that are no functions, or have the name of another."""
    for name, column in columns.items():
        if not callable(column):
            raise ParameterError(
                f"column {name} must be a function of a state, such as "
                f"lambda state: state.arc_radius.min(), not {shown(column)}"
            )
    for name in columns.keys() & {"frame", *others}:
        raise ParameterError(f"each table has a column {name}: give yours another name")


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


def universe(folder: Path) -> Universe:
    """A Universe of MDAnalysis of a recorded run, see `Run.universe`."""
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
            frames=frames_in(folder),
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


def table(folder: Path, states: Iterable[State], columns: Mapping[str, Column]) -> Any:
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
    states: Iterable[State], path: str | Path, forces: bool = False, overwrite: bool = False
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
        expect("a state that is exported", state, State)
        names.append(f"{path.stem}_{number:04d}.vtp")
        times.append(state.time)
        if state.root and number == 0:
            refuse_present(path, overwrite)
        state.export(path.with_name(names[-1]), forces, overwrite)
        if state.root:
            write_whole(path, collection(names, times))
    if not names:
        raise ParameterError("a series of shapes needs at least one state")


_APPEND = "go on with append=True"


def log(
    states: Iterable[State],
    path: str | Path,
    append: bool = False,
    overwrite: bool = False,
    **columns: Column,
) -> Iterator[State]:
    """Write a row of numbers for each state as it comes, into a CSV file.

        steps = ld.compress(sim, 0.01, 10)
        for state in ld.log(steps, "log.csv", weakest=lambda state: state.arc_radius.min()):
            print(state.phi)

    The columns are `frame` and those of `Run.table`; `series.csv` of `record` is the same. Each row
    is in the file once its state is yielded. Row 0 is the state before the first step, as frame 0
    of a record. Rank 0 writes.

    Args:
        states: e.g. from `compress`; what knows a state
            before is told at `record`.
        path: of the file; folders are made if missing.
        append: go on with the log that is there, if any: frames are counted on, and half a row at
            its end is removed.
        overwrite: replace the log that is there, when the first state comes.
        columns: further ones: functions that return a number for a state.

    Yields:
        The states, unchanged; without the one before the first step.

    Raises:
        ParameterError: these are no states, or a column is no function, has the name of another or
            no single number, or `append` and `overwrite` are given.
        FileError: there is a log, and neither `append` nor `overwrite` is given; or the file cannot
            be written, is no log, or has other columns.
    """
    expect("states", states, Iterable)
    expect("path", path, str, Path)
    expect("append", append, bool)
    if append and overwrite:
        raise ParameterError("give one of append and overwrite")
    path = Path(path)
    if not path.name:
        raise ParameterError(f"path must name a file, such as log.csv, not {str(path)!r}")
    check_columns(columns, ())
    refuse_foreign(path)
    if waits_for_all(states):
        refuse_present(path, append or overwrite, _APPEND)
    start = start_of(states)
    return Steps("log", _logged(states, start, path, append, overwrite, columns), start)


def _whole_rows(path: Path) -> int:
    """Number of rows that are complete."""
    torn = path.exists() and not path.read_bytes().endswith(b"\n")
    return max(len(rows_in(path)) - torn, 0)


def _logged(
    states: Iterable[State],
    start: Callable[[], State | None],
    path: Path,
    append: bool,
    overwrite: bool,
    columns: Mapping[str, Column],
) -> Iterator[State]:
    """Write the rows. Only the rank that writes knows how many there are already."""
    before, number = start(), -1
    for state in chain([before] if before else [], states):
        expect("a state that is logged", state, State)
        numbers = state.numbers()
        check_columns(columns, numbers)
        row = numbers | {name: _cell(name, column(state)) for name, column in columns.items()}
        if getattr(state, "root", world().rank == 0):
            if number < 0:
                refuse_present(path, append or overwrite, _APPEND)
                number = _begin(path, append, ["frame", *row])
            if number == 0 or state is not before:
                append_row(path, number, row)
                number += 1
        if state is not before:
            yield state


def _cell(name: str, value: Any) -> Any:
    """The value, if it fits into a cell of a table."""
    if isinstance(value, Sized) and not isinstance(value, str) and getattr(value, "ndim", 1) > 0:
        raise ParameterError(
            f"column {name} must have one number for each state, such as a mean, not a "
            f"{type(value).__name__} of {len(value)}"
        )
    return value


def _begin(path: Path, append: bool, columns: list[str]) -> int:
    """Keep the complete rows of a log to go on with, if it has these columns; their number."""
    make_folder(path.parent)
    first, former = _whole_rows(path) if append else 0, columns_in(path)
    if first and set(former) != set(columns):
        differ = ", ".join(sorted({*former} ^ {*columns}))
        raise FileError(
            f"{path} has other columns, the difference is {differ}: take the same ones, or another "
            "file"
        )
    keep_rows(path, first)
    return first


# The law of files that do not tell.
_UNTOLD = "balanced"


def state_in_file(
    path: str | Path,
    species: str | Path,
    law: str | None = None,
    types: Sequence[str] | None = None,
    frame: int = -1,
    radii: str | None = None,
) -> State:
    """The state of particles whose centers are in a file: outlines, energy, stress, contacts.

        ld.state_in_file("shapes.dump", "mixture.deformable").export("shapes.vtp")

    Positions are those of the file; nothing moves. They must be periodic and, but for droplets, of
    one plane.
    Velocities are left out. Particles with an adhesion stick where their circles overlap. A file
    does not tell of the stiffnesses of single particles, *kA atom*: they are those of the species.

    Args:
        path: a LAMMPS dump, or what else `Packing.from_file` reads.
        species: the species file of pair_coeff, or the name of one that comes with the package.
        law: `balanced`, `curved`, `radical`, `sector` or, in three dimensions, `droplet`. If not
            given that of the run in whose folder the file is, or the species file; LAMMPS' own
            files do not tell, and have `balanced`, the default of the pair style.
        types: names of species, one for each atom type, as in pair_coeff; by default those of the
            file in their order.
        frame: number of the frame, from 0, or from the end if negative.
        radii: name of a column with the radius of each particle, as with `radius atom`; by default
            the radii are those of the species.

    Raises:
        FileError: a file cannot be read.
        ParameterError: an argument is out of range, or there are more atom types than species.
        LammpsError: LAMMPS refuses the species, or the packing: contacts leave no room, say.
    """
    expect("path", path, str, Path)
    expect("species", species, str, Path)
    expect("radii", radii, str, type(None))
    told = law_of_run(path, species, frame) if law is None else None
    law = law or (told.name if told else _UNTOLD)
    if law not in ALL_LAWS:
        raise ParameterError(f"law must be {', '.join(ALL_LAWS)}, not {law}")
    file = Path(species)
    if not file.exists() and (potentials / file).exists():
        file = potentials / file
    if not file.exists():
        raise FileError(f"there is no species file '{species}'")
    names = list(species_names(file) if types is None else types)
    own, dimension = 1.0 if radii is None else radii, ALL_LAWS[law].dimension
    packing = Packing.from_file(path, radii=own, frame=frame, dimension=dimension)
    number = len(packing._species_radii)
    if number > len(names):
        raise ParameterError(
            f"'{path}' has particles of type {number}, but the species of {len(names)} types are "
            f"named: {', '.join(names)}"
        )
    if number == 1 < len(names) and not read_particles(Path(path), frame).typed:
        raise FileError(f"'{path}': {UNTYPED}, or the one species of all, such as {names[0]}")
    sizes, chosen = read_species(file, names[:number], law)
    if isinstance(told, (Ring, Droplet)):  # no species file has the reach
        reach: dict[str, Any] = {"reach": told.reach}
        chosen = replace(chosen, **reach)
    if radii is None:
        packing = Packing._of_species(packing.positions, packing.species, sizes, packing.box)
    with Simulation(packing, chosen, comm=MPI.COMM_SELF) as sim:
        return sim.state()


def law_of_run(path: str | Path, species: str | Path, frame: int) -> AnyLaw | None:
    """The law of the run to which the file of particles or the species file belongs, if any.

    Args:
        path: of the particles.
        species: of the species file.
        frame: number of the frame: laws may change in a run.

    Raises:
        FileError: the run is damaged.
    """
    for file in (Path(path), Path(species)):
        if not (file.exists() and (file.parent / SUMMARY).exists()):
            continue
        if holds(folder := file.parent) != "compression":
            continue
        saved = summary_in(folder)
        if file.name == TRAJECTORY:
            number = frame if frame >= 0 else store.frames_in(folder) + frame
            saved = store.setup_of(store.setups_in(folder), max(number, 0))
        with reading(folder / SUMMARY):
            return read_setup(saved).law
    return None


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
        return store.frames_in(self.folder)

    def __iter__(self) -> Iterator[State]:
        return self._states(self._numbers())

    @overload
    def __getitem__(self, index: int) -> State: ...
    @overload
    def __getitem__(self, index: slice) -> list[State]: ...
    def __getitem__(self, index: int | slice) -> State | list[State]:
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

    def _states(self, numbers: Iterable[int]) -> Iterator[State]:
        """States of these frames, from 0."""
        numbers = list(numbers)
        if not numbers:
            return
        texts, setups = store.texts_of(self.folder), store.setups_in(self.folder)
        clock, stalled = store.clock_of(self.folder), store.stalled_in(self.folder)
        with progress("replaying", unit="state", total=len(numbers)) as bar:
            for number in numbers:
                with reading(f"frame {number} of {self.folder / store.TRAJECTORY}"):
                    saved = store.setup_of(setups, number)
                    law, radii, walls, friction = read_setup(saved)
                    if number >= len(texts):
                        raise LookupError("it is missing")
                    now = clock[number] if number < len(clock) else (0.0, None)
                    packing, motion = store.read_frame(
                        texts[number], radii, saved, now, law.dimension
                    )
                    packing = packing.replace(walls=walls)
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

    def simulation(self, comm: MPI.Comm | None = None) -> Simulation:
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

    def _simulation(self, comm: MPI.Comm | None) -> Simulation:
        packing, law, friction = read(self.folder)
        motion = read_motion(self.folder, packing)
        sim = Simulation(packing, law, comm=comm, friction=friction)
        go_on(sim, motion)
        return sim

    def append(
        self, states: Iterable[State], parameters: Mapping[str, Any] | None = None
    ) -> Iterator[State]:
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
    ) -> Iterator[State]:
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
    ) -> Iterator[State]:
        """Shear the last state: as `shear_in`, behind the states of the run.

        Raises:
            FileError: the run is interrupted, see `resume`, or lacks frames.
        """
        protocol = shear_protocol(strain, steps, tolerance)
        return self._go_on("Run.shear", protocol, parameters, comm)

    def resume(self, comm: MPI.Comm | None = None) -> Iterator[State]:
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
        store.check_frames(self.folder)
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
        movies.movie(self, path, **settings)

    def export(self, path: str | Path, forces: bool = False, overwrite: bool = False) -> None:
        """Write the shapes of the states for ParaView and OVITO, see `ld.export`."""
        export(self, path, forces, overwrite)

    def table(self, **columns: Callable[[State], Any]) -> Any:
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
        return table(self.folder, self, columns)

    def universe(self) -> Universe:
        """A Universe of MDAnalysis.

            for frame in ld.Run("run").universe().trajectory:
                print(frame.time, frame.data["area"].mean())

        Particles and frames are those of `State.to_mdanalysis`. `time` is that of a motion whose
        states are equally far apart, and the number of the frame in all other runs.

        Raises:
            FileError: the number of particles changes, which MDAnalysis does not know.
        """
        return universe(self.folder)

    def _before(self) -> dict[str, Any]:
        """The parameters of the run, for the summary of the next one."""
        store.check_frames(self.folder)
        return {"before": self.parameters}

    def _go_on(
        self,
        name: str,
        protocol: Mapping[str, Any],
        parameters: Mapping[str, Any] | None,
        comm: MPI.Comm | None,
    ) -> Iterator[State]:
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
