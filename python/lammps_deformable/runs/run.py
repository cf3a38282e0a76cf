"""Runs: states one after the other, in memory or in a folder that is written as a run goes on.

    packing.data            last state, LAMMPS data file
    species.deformable      its species, for the pair style
    in.lammps               LAMMPS script that reads these two
    summary.json            numbers of the last state, law, parameters and versions
    series.csv              one row per state
    trajectory.lammpstrj    LAMMPS dump for OVITO and MDAnalysis
    setups.jsonl            law, radii and walls of the frames: a line for each change

`State.save` writes the first four, a protocol with `record` all of them while it goes on. It may be
interrupted at any moment: the packing is written last and atomically, with the number of recorded
frames. Frames beyond it are removed when the run goes on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from ..common.checks import expect, shown
from ..common.errors import FileError, ParameterError, StalledWarning, warn
from ..common.files import (
    alone_in,
    at_home,
    from_json,
    reading,
    refuse_present,
    replaces,
    write_whole,
)
from ..common.ranks import alone, wait_for_all, world
from ..common.versions import optional
from ..engine.lammps import communicator
from ..engine.simulation import Simulation
from ..formats import store
from ..formats.store import (
    SERIES,
    SUMMARY,
    TRAJECTORY,
    columns_in,
    read,
    read_motion,
    read_setup,
    recorded,
    refuse,
    summary_in,
)
from ..particles.laws import AnyLaw, Droplet, SoftContact
from ..particles.packing import Packing
from ..pictures.vtk import collection
from ..protocols import recording
from ..protocols.recording import recorded_numbers
from ..protocols.shearing import DynamicModulus, harmonic
from ..state.displacements import mean_squared_displacement, unwrapped
from ..state.events import changes
from ..state.recorded import COLUMNS, SAVED
from ..state.state import State, writes

if TYPE_CHECKING:
    from MDAnalysis import Universe
    from mpi4py import MPI

    from ..formats.store import Motion, Setup


Column = Callable[[State], Any]


class Table(dict[str, NDArray[Any]]):
    """Columns of numbers by name, arrays with a number for each state."""

    def __missing__(self, name: object) -> NDArray[Any]:
        raise KeyError(f"no column {name!r}: there are {', '.join(self)}")

    def to_pandas(self) -> Any:
        """A DataFrame of pandas, with the frames as index.

        Raises:
            ImportError: pandas is missing (`pip install 'lammps-deformable[pandas]'`).
        """
        return optional("pandas", "pandas").DataFrame(dict(self)).set_index("frame")


def _column(words: Sequence[str | None]) -> NDArray[Any]:
    """The column of a series: truth values, whole numbers, numbers, nan where missing, or words."""
    if words and all(word in ("True", "False") for word in words):
        return np.array([word == "True" for word in words])
    with suppress(ValueError):
        return np.array([int(word or "") for word in words], dtype=np.int64)
    with suppress(ValueError):
        return np.array([float(word) if word else np.nan for word in words], dtype=np.float64)
    return np.array(words)


# Results of a law, in the order of columns.
_RINGS = ("area", "perimeters", "pressures", "n_contacts", "arc_radii")
_DROPLETS = ("surface_areas", "pressures", "loads", "contact_areas", "n_contacts")


def _results_of(law: AnyLaw | SoftContact) -> tuple[str, ...]:
    """Names of what the law computes for each particle."""
    if isinstance(law, SoftContact):  # they follow from the centers
        return ()
    return _DROPLETS if isinstance(law, Droplet) else _RINGS


def _recorded_state(
    packing: Packing,
    made_of: Setup,
    motion: Motion,
    columns: Mapping[str, NDArray[Any]],
    row: Mapping[str, str],
) -> State:
    """A state as it was recorded; what was not is evaluated when it is asked for."""
    law = made_of.law
    results = {
        name: columns[COLUMNS.get(name, name)].astype(
            np.int64 if name == "n_contacts" else np.float64
        )
        for name in _results_of(law)
    }
    minimizer = row.get("minimizer", "none")
    known: dict[str, Any] = {
        "results": results,
        "velocities": motion.velocities,
        "time": motion.time,
        "shear_strain": motion.strain,
        "_root": world().rank == 0,
        "images": motion.images,
        "energy": float(row["energy"]),
        "residual": float(row["residual"]),
        "converged": row["stalled"] != str(True),
        "minimizer": None if minimizer == "none" else minimizer,
        "iterations": int(row["iterations"]) if row.get("iterations") else None,
        "beyond": int(row.get("beyond") or 0),
        "pressure_tensor": _stress_in(row, packing.dimension),
        "lost_energy": float(row.get("lost_energy") or 0.0),
        "films": motion.films,
        "directions": motion.directions,
        "labels": motion.labels,
        "clones": motion.clones,
        "gravity": made_of.gravity,
    }
    if isinstance(law, SoftContact):
        return State(packing, law, **known)
    evaluate = partial(_evaluated, packing, made_of, motion)
    if made_of.friction is None:
        return State(packing, law, **known, _evaluate=evaluate)
    return replace(evaluate(), **known)  # forces along contacts are not in the frame


def _stress_in(row: Mapping[str, str], dimension: int) -> NDArray[np.float64]:
    """The pressure tensor in a row of the series."""
    stress = np.empty((dimension, dimension))
    for k, n in zip(*np.triu_indices(dimension), strict=True):
        stress[k, n] = stress[n, k] = float(row[f"p{'xyz'[k]}{'xyz'[n]}"])
    return stress


def _evaluated(packing: Packing, made_of: Setup, motion: Motion) -> State:
    """The state of recorded particles, on this rank alone."""
    with _simulation_of(packing, made_of, alone()) as sim:
        sim.engine.go_on(sim, motion)
        return sim.state()


def _simulation_of(
    packing: Packing, made_of: Setup, comm: MPI.Comm | None, minimizer: str | None = None
) -> Simulation:
    """A simulation of what was saved."""
    forces: dict[str, Any] = {"friction": made_of.friction, "gravity": made_of.gravity}
    return Simulation(packing, made_of.law, comm=comm, minimizer=minimizer, **forces)


def _shown(part: range) -> str:
    """The slice that gives a part of a run."""
    stop = "" if part.stop < 0 else part.stop
    return f"[{part.start}:{stop}" + ("]" if part.step == 1 else f":{part.step}]")


def _same(one: Any, other: Any) -> bool:
    """Whether both are the same object, or states of the same moment to the last digit."""
    if not (isinstance(one, State) and isinstance(other, State)) or one is other:
        return one is other
    numbers = [(each.law, each.energy, each.time, each.shear_strain) for each in (one, other)]
    mine, others = (np.vstack([each.box, each.positions]) for each in (one, other))
    return numbers[0] == numbers[1] and np.array_equal(mine, others)


class Run(Sequence[State]):
    """States one after the other, in memory or in a folder: what every protocol returns.

        run = sim.compress(strain=0.01, steps=10, record="run")
        run = ld.Run("run")
        run[-1].plot()
        for state in run:
            print(state.phi)

    `len(run)` is the number of states, `run[0]` is the one before the first step, `run[-1]` the
    last one, and `run[2:5]` is a Run of three. A folder is read a frame at a time, and a state has
    what was recorded: energy, stress, `stalled`, what particles have lost. Contacts are evaluated
    again, with the law, radii and walls that they had, when they are asked for. All MPI ranks must
    ask for the same.

    Args:
        source: folder of a run, or of a saved state, which is a run without frames; or states.
        parameters: of states in memory: what the protocol was called with.

    Attributes:
        folder: of the run, an absolute path; None in memory.

    Raises:
        FileError: the folder has no run, or a file is missing or cannot be read. On several ranks,
            of which one may still be writing, this is told when files are needed.
        IndexError: there is no such state.
    """

    def __init__(
        self,
        source: str | Path | Iterable[State],
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        expect("source", source, str, Path, Iterable)
        expect("parameters", parameters, Mapping, type(None))
        self.folder: Path | None = None
        self._range: range | None = None  # of frames or states; None: all, as many as there are now
        if isinstance(source, (str, Path)):
            self.folder = at_home(source)
            if world().size == 1:
                self._check()
            self.folder = self.folder.absolute()  # whatever the working folder becomes
            self._frames = store.Frames(self.folder)
        else:
            self._states = list(source)
            self._parameters = dict(parameters or {})

    @staticmethod
    def exists(folder: str | Path) -> bool:
        """Whether the folder has a run, which may be interrupted: see `resume`."""
        expect("folder", folder, str, Path)
        return all((at_home(folder) / name).exists() for name in (store.DATA, SUMMARY))

    def __repr__(self) -> str:
        if self.folder is None:
            return f"<Run: {len(self)} states>"
        return f"Run({str(self.folder)!r})" + ("" if self._range is None else _shown(self._range))

    def _check(self) -> None:
        """Say what is missing."""
        if self.folder is not None:
            summary_in(refuse(self.folder, but="run"))

    def __len__(self) -> int:
        if self.folder is None:
            return len(self._states if self._range is None else self._range)
        self._check()
        return store.frames_in(self.folder) if self._range is None else len(self._range)

    def __contains__(self, state: object) -> bool:
        """Whether a state is one of these; a folder gives equal ones each time."""
        return any(_same(each, state) for each in self)

    def index(self, value: Any, start: int = 0, stop: int | None = None) -> int:
        """Place of the first state that is this one, as that of a list.

        Raises:
            ValueError: there is none.
        """
        for number in range(len(self))[start:stop]:
            if _same(self[number], value):
                return number
        raise ValueError(f"{shown(value)} is no state of {self!r}")

    def count(self, value: Any) -> int:
        """How many states are this one."""
        return sum(_same(each, value) for each in self)

    def _numbers(self) -> range:
        """Of the frames in the folder, or of the states in memory."""
        if self._range is not None:
            return self._range
        if self.folder is not None:
            wait_for_all()  # rank 0 may still be writing
        return range(len(self))

    def __iter__(self) -> Iterator[State]:
        return (self._state(number) for number in self._numbers())

    @overload
    def __getitem__(self, index: int) -> State: ...
    @overload
    def __getitem__(self, index: slice) -> Run: ...
    def __getitem__(self, index: int | slice) -> State | Run:
        numbers = self._numbers()
        if isinstance(index, slice):
            part = copy(self)
            part._range = numbers[index]
            return part
        expect("the number of a state", index, int, np.integer)
        last, name = len(numbers) - 1, f"'{self.folder}'" if self.folder else "this run"
        if last < 0 and self.folder is not None and self._range is None:
            raise IndexError(
                f"{name} has one saved state and no recorded ones: take Run.simulation()"
            )
        if not -last - 1 <= index <= last:
            raise IndexError(
                f"{name} has {last + 1} states, and no state {index}: give 0 to {last}, "
                f"or -1 to {-last - 1} from the end"
            )
        return self._state(numbers[index])

    def _state(self, number: int) -> State:
        """The state of a frame, from 0."""
        if self.folder is None:
            return self._states[number]
        with reading(f"frame {number} of {self.folder / TRAJECTORY}"):
            saved, text = self._frames.setup(number), self._frames.text(number)
            made_of = read_setup(saved)
            rows = self._frames.rows()
            if number >= len(rows):
                raise LookupError(f"its row in {SERIES}")
            packing, motion, columns = store.read_frame(
                text, made_of.radii, saved, rows[number], made_of.dimension
            )
            packing = packing.replace(walls=made_of.walls)
            return _recorded_state(packing, made_of, motion, columns, rows[number])

    @property
    def parameters(self) -> dict[str, Any]:
        """What the protocol was called with, its name, and what it knows of its start.

        Those of a run before that it goes on with have the key `before`.
        """
        if self.folder is None:
            return dict(self._parameters)
        with reading(self.folder / SUMMARY):
            return dict(from_json(summary_in(self.folder).get("parameters") or {}))

    @property
    def steps_done(self) -> int | None:
        """Recorded steps of the last protocol; None if it cannot be resumed."""
        parameters = self.parameters
        if self.folder is None or "start" not in parameters:
            return None
        return store.frames_in(self.folder) - int(parameters["start"]["frame"])

    def simulation(self, comm: MPI.Comm | None = None) -> Simulation:
        """A simulation of the last state: the same particles, box and law.

        Velocities, spins, films, springs of contacts, directions, time and shear strain go on from
        those of the state.

        Args:
            comm: as for `Simulation`.

        Warns:
            StalledWarning: the relaxation of that state had stalled.
        """
        if self.folder is None or self._range is not None:
            state = self[-1]
            return Simulation(state, state.law, comm=communicator(comm))
        communicator(comm).barrier()  # rank 0 may still be writing
        last = summary_in(self.folder).get("state")
        if isinstance(last, dict) and last.get("stalled"):
            warn(
                f"the relaxation of the state in '{self.folder}' had stalled, at a residual of "
                f"{last.get('residual')}: relax the simulation before you measure",
                StalledWarning,
            )
        return self._simulation(self.folder, comm)

    def _simulation(self, folder: Path, comm: MPI.Comm | None) -> Simulation:
        packing, made_of = read(folder)
        motion = read_motion(folder, packing)
        sim = _simulation_of(packing, made_of, comm, self.parameters.get("minimizer"))
        sim.engine.go_on(sim, motion)
        return sim

    def resume(
        self, *, callback: Callable[[State], object] | None = None, comm: MPI.Comm | None = None
    ) -> Run:
        """Finish an interrupted protocol in the folder, with the numbers of a whole one.

            run = ld.Run(f).resume() if ld.Run.exists(f) else sim.shear(0.1, steps=100, record=f)

        The files of an unfinished step are removed. Nothing is done if no step is missing.

        Args:
            callback: as of the protocol, for the states that are missing.
            comm: as for `Simulation`.

        Returns:
            This run, with all its states; of a slice the run that it is of.

        Raises:
            FileError: the protocol cannot be resumed, as commands of a user were given to its
                `lmp`; its files cannot be read; or another process is writing the run.
        """
        recording.check_callback(callback)
        if self.folder is None:
            return self
        communicator(comm).barrier()  # rank 0 may still be writing
        packing, *_ = read(self.folder)
        read_motion(self.folder, packing)
        parameters, done = self.parameters, self.steps_done
        if done is None:
            raise FileError(
                f"the run in '{self.folder}' cannot be resumed: it is a saved state, or commands "
                "were given to its lmp, which the folder lacks. Go on with Run.simulation(), and a "
                "protocol with mode='a' (in the shell: --append)"
            )
        communicator(comm).barrier()  # all ranks have read the folder
        if done < parameters["start"]["states"]:
            with self._simulation(self.folder, comm) as sim:
                recording.resume(self, sim, done, callback)
        return self if self._range is None else Run(self.folder)

    def table(self, **columns: Column) -> Table:
        """The numbers of the states, by name: arrays, and `to_pandas()` of them all.

            run.table()["pressure"]
            run.table(order=lambda state: abs(state.hexatic()).mean()).to_pandas()

        There are `frame`, the box, `shear_strain`, `phi`, `pressure`, `shear_stress`, the pressure
        tensor `pxx`, `pxy`, ..., `energy`, `lost_energy`, `temperature`, `time`, `coordination`,
        the numbers of `rattlers` and of particles `beyond` the model, the mean `shape_parameter`,
        or `load` of droplets in space, `residual` and `stalled`, and `minimizer` and `iterations`
        of relaxations, as they were recorded.

        Args:
            columns: further ones: functions that return a number for a state.

        Raises:
            ParameterError: a column is no function, or has the name of another.
        """
        numbers = self._numbers()
        found = Table(frame=np.arange(numbers.start, numbers.stop, numbers.step))
        if self.folder is None:
            rows = []
            for state in self._states:  # a part has the types of the whole
                expect("a state of a table", state, State)
                rows.append(recorded_numbers(state))
            for name in dict.fromkeys(name for row in rows for name in row):
                values = [row.get(name) for row in rows]  # states of other laws have others
                known = np.array([np.nan if each is None else each for each in values])
                found[name] = known[list(numbers)]
        else:
            recorded(self.folder, SERIES)
            texts = self._frames.rows()
            with reading(self.folder / SERIES):
                found |= {
                    name: _column([text[name] for text in texts])[list(numbers)]
                    for name in columns_in(self.folder / SERIES)
                    if name != "frame"
                }
        for name, column in columns.items():
            if not callable(column):
                raise ParameterError(
                    f"column {name} must be a function of a state, such as "
                    f"lambda state: state.arc_radii.min(), not {shown(column)}"
                )
            if name in found:
                raise ParameterError(f"each table has a column {name}: give yours another name")
        if columns:
            more = [[column(state) for column in columns.values()] for state in self]
            for n, name in enumerate(columns):
                found[name] = np.array([row[n] for row in more])
        return found

    def unwrapped(self) -> NDArray[np.float64]:
        """Positions of particles that are followed across the boundaries of the box.

        Each state counts how often its particles have left the box: frames may be as far apart as
        you like.

        Returns:
            Shape (number of states, N, d) [length]. Where particles come and go N is that of all
            labels, in their order, and nan stands where a particle is not there.

        Raises:
            ParameterError: there are no states, or one has other numbers of particles, without
                labels.

        Warns:
            JumpWarning: states that count nothing, of soft disks, are too far apart.
            AbsentWarning: not all particles are in all states.
        """
        return unwrapped(self)

    def msd(
        self, lags: Sequence[int] | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mean squared displacement <|r(t0 + t) - r(t0)|^2> over particles and starts t0.

        Where particles come and go, over those that are there both times.

        Args:
            lags: numbers of frames; by default all up to half of the run.

        Returns:
            The times t of these lags, or the lags themselves where no time passes, and the mean
            squared displacements [length^2], shape (number of lags,) each.

        Raises:
            ParameterError: a lag is out of range, or times are not equally far apart.
        """
        return mean_squared_displacement(self, lags)

    def events(self) -> Table:
        """Contacts that form and break from each state to the next, and T1 events.

            events = run.events()
            rate = np.sum(events["event"] == "forms") / (run[-1].time - run[0].time)
            events.to_pandas().to_csv("events.csv")

        A row is a change since the state before. Contacts that form and break again in between are
        not seen: take states near to each other. In the plane two particles that part, and two of
        their common neighbors, before or afterwards, that meet, are a T1. Of a dump by LAMMPS the
        states are `Run(State.from_file(dump, species, frame=n) for n in range(100))`.

        Returns:
            Columns: `frame`, that of the later state, and its `time`; `event`, one of `forms`,
            `breaks`, `vanishes` and `is born`; the particles `i` and `j` by their labels, or -1 - k
            for wall k, equal for a single one; `t1`, the number of the T1 to which both its
            contacts belong, from 0, or -1.
        """
        found = Table(changes(self))
        found["frame"] = np.array(self._numbers(), dtype=np.int64)[found["frame"]]
        return found

    def radial_distribution(
        self, bins: int, r_max: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The mean of `State.radial_distribution` over the states.

        Args:
            bins: number of intervals of the distance.
            r_max: largest distance [length].

        Returns:
            Distances r [length], and the mean of g(r), both of shape (bins,).

        Raises:
            ParameterError: a value is out of range, or there are no states.
            ImportError: freud is missing (`pip install 'lammps-deformable[freud]'`).
        """
        return self._mean(lambda state: state.radial_distribution(bins, r_max))

    def structure_factor(
        self, bins: int, k_max: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The mean of `State.structure_factor` over the states.

        Args:
            bins: number of intervals of the wave number.
            k_max: largest wave number [1/length].

        Returns:
            Wave numbers k [1/length], and the mean of S(k) over the states whose boxes have wave
            vectors there, both of shape (bins,).

        Raises:
            ParameterError: a value is out of range, or walls close a direction, or there are no
                states.
        """
        return self._mean(lambda state: state.structure_factor(bins, k_max))

    def _mean(
        self, function: Callable[[State], tuple[NDArray[np.float64], NDArray[np.float64]]]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Abscissae, and the mean of the values that are no nan."""
        found = [function(state) for state in self]
        if not found:
            raise ParameterError("there are no states to average over")
        values = np.array([each for _, each in found])
        with np.errstate(invalid="ignore"):  # nan where no state has a value
            mean = np.nansum(values, axis=0) / np.sum(~np.isnan(values), axis=0)
        return found[0][0], mean

    def complex_modulus(self, skip: int = 1) -> DynamicModulus:
        """G' and G'' of a run of `oscillate`, from the first harmonic of the stress.

        The stress sigma of a cycle of n states gives G' = 2/(n strain) sum sigma sin(omega t), and
        G'' with the cosine. Linear response is `state.complex_modulus`, without an amplitude and
        without noise.

        Contacts and, without a period, relaxed forces are balanced up to a part epsilon of the
        largest or mean contact force. With |F_c| and d_c of the contacts and the room V the error
        of the stress is about epsilon sum |F_c| d_c/(d V), in errors divided by the strain. Time
        steps dt of a period T change G' and G'' by at most pi G'' dt/T, which is in the errors too.

        Args:
            skip: number of cycles at the start that do not count, in which the response settles.

        Raises:
            ParameterError: the run is none of `oscillate`, or fewer than two cycles are left.
        """
        return harmonic(self, skip)

    def movie(self, path: str | Path, mode: str = "x", **settings: Any) -> None:
        """Draw the states as a movie, all with the same scale of colors and forces.

        Args:
            path: of the movie, .gif, or .mp4 if ffmpeg is installed.
            mode: `w` replaces a file that is there, `x` refuses to.
            settings: `rate` in pictures per second, 10 if not given, and those of `State.plot`.

        Raises:
            ParameterError: the format is another, ffmpeg is missing, or there are no states or no
                such attribute or color map, or `vmin` is not below `vmax`.
            FileError: there is a file, see `mode`, or it cannot be written.
            ImportError: matplotlib is missing.
        """
        from ..pictures.movies import movie  # which loads matplotlib

        movie(self, path, mode=mode, **settings)

    def export(self, path: str | Path, forces: bool = False, mode: str = "x") -> None:
        """Write the shapes of the states for ParaView and OVITO, see `State.export`.

        Args:
            path: `NAME.pvd`, which lists the files NAME_0000.vtp, NAME_0001.vtp, ... beside it,
                by the numbers of the frames, with the times of a motion, or with their numbers.
            forces: write the networks of forces in the place of shapes.
            mode: `w` replaces files that are there, `x` refuses to.

        Raises:
            ParameterError: the suffix is another, or there are no states.
            FileError: there is a file, see `mode`, or it cannot be written.
        """
        expect("path", path, str, Path)
        path = at_home(path)
        if path.suffix != ".pvd":
            raise ParameterError(f"a series of shapes is a .pvd, not '{path}'")
        names, times = [], []
        for number, state in zip(self._numbers(), self, strict=True):
            expect("a state that is exported", state, State)
            names.append(f"{path.stem}_{number:04d}.vtp")
            times.append(state.time)
            if writes(state) and len(names) == 1:
                refuse_present(path, replaces(mode))
            state.export(path.with_name(names[-1]), forces, mode)
            if writes(state):
                write_whole(path, collection(names, times))
        if not names:
            raise ParameterError("a series of shapes needs at least one state")

    def save(self, folder: str | Path, mode: str = "x") -> Run:
        """Write the states as a recorded run: those in memory, of a dump, or a part of a run.

            run[10:20].save("part")
            frames = (ld.State.from_file("dump", "cells", frame=n) for n in range(100))
            ld.Run(frames).save("run")

        Args:
            folder: made if missing.
            mode: `w` replaces a state or a run that is there, `x` refuses to.

        Returns:
            The run in the folder, which has nothing to resume.

        Raises:
            ParameterError: there are no states, or one cannot be saved, as those of polygons.
            FileError: the folder has a state or a run, see `mode`, or cannot be written.
        """
        ways = (f"replace it with save({str(folder)!r}, mode='w')",)

        def place() -> Path:
            return store.refuse_run(folder, replaces(mode), ways).absolute()

        if (into := place()) == self.folder:
            raise ParameterError(f"the run in '{into}' cannot be written over itself: name another")
        if not len(self):
            raise ParameterError("there are no states to save")
        told = {name: value for name, value in self.parameters.items() if name != "start"}
        with alone_in(into, world(), place):
            for number, state in enumerate(self):
                expect("a state that is saved", state, State)
                expect("the law of a state that is saved", state.law, *SAVED)
                if writes(state) and number == 0:
                    store.drop_frames(into)
                if writes(state):
                    recording.write_frame(into, number, state, told)
        wait_for_all()
        return Run(into)

    def to_mdanalysis(self) -> Universe:
        """A Universe of MDAnalysis of a run in a folder.

            for frame in ld.Run("run").to_mdanalysis().trajectory:
                print(frame.time, frame.data["area"].mean())

        Particles and frames are those of `State.to_mdanalysis`. `time` is that of a motion whose
        states are equally far apart, and the number of the frame in all other runs.

        Raises:
            FileError: the number of particles changes, which MDAnalysis does not know.
            ParameterError: the run is in memory.
        """
        if self.folder is None:
            raise ParameterError("a run in memory has no trajectory: give record= to the protocol")
        from ..formats.run_universe import universe

        return universe(self.folder, self._range)
