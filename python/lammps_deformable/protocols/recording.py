"""The steps of every protocol: states are shown, kept or written, and runs go on after a kill.

Frame 0 of a run is the state before the first step. A protocol that is written starts each step
from the state before, as a process does that has read it from the folder: LAMMPS is cleared, and
the particles are created anew. So a step gives the same digits whether or not the same process
computed those before it. Where a user has given commands to LAMMPS that would be lost, the steps
follow each other instead, and the run cannot be resumed.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import ExitStack, closing
from dataclasses import fields
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..common.checks import expect, shown
from ..common.errors import FileError, ParameterError, UnjammedWarning, collected
from ..common.files import alone_in, as_json, check_parameters
from ..common.ranks import progress, together
from ..engine.lammps import has_commands_of_a_user
from ..formats import store
from ..particles.laws import Droplet, Ring, Sector, SoftContact
from ..state.recorded import motion_of, numbers_of, particle_values, write_state
from ..state.state import State
from .protocol import KNOWN, Protocol

if TYPE_CHECKING:
    from mpi4py import MPI

    from ..engine.simulation import Simulation
    from ..runs.run import Run

# Called with each state after a step; True ends the protocol there.
Callback = Callable[[State], object]


def _known() -> dict[str, type[Protocol]]:
    """The classes of protocols by their names."""
    from . import coarsening, compression, motion, proliferation, shearing  # noqa: F401, which know this module

    return KNOWN


def protocol_in(parameters: Mapping[str, Any]) -> Protocol:
    """The protocol in the parameters of a run.

    Raises:
        FileError: none of this name is known.
    """
    name = parameters["protocol"]
    if name not in _known():
        raise FileError(
            f"there is no protocol {name!r}: import the module that has its class, or go on with "
            "Run.simulation()"
        )
    kind = KNOWN[name]
    told = dict(parameters)
    if name == "run" and "look" in told:  # what `every` was called, which was limited by `steps`
        told["every"] = told["look"]
    names = {field.name for field in fields(kind)} & set(told)
    return kind(**{each: told[each] for each in names})


def check_callback(callback: Callback | None) -> None:
    """Refuse a callback that cannot be called."""
    if callback is not None and not callable(callback):
        raise ParameterError(
            "callback must be a function of a state, such as "
            f"lambda state: state.pressure > 1e-3, or None, not {shown(callback)}"
        )


def play(
    sim: Simulation,
    protocol: Protocol,
    record: str | Path | None,
    mode: str,
    callback: Callback | None,
    keep: bool,
    parameters: Mapping[str, Any] | None,
) -> Run:
    """See `Simulation.play`."""
    from ..runs.run import Run

    expect("protocol", protocol, Protocol)
    expect("keep", keep, bool)
    name, kind = protocol.name, type(protocol)
    if record is not None and (other := _known().get(name, kind)) is not kind:
        raise ParameterError(
            f"{other.__module__}.{other.__qualname__} is a protocol of the name {name!r} too: give "
            f"yours another one, class {kind.__name__}(Protocol, name=...)"
        )
    protocol = protocol.check(sim, record is not None)
    check_callback(callback)
    check_parameters(parameters)
    as_json(f"the settings of {name}", protocol.settings)
    _ = sim.lmp  # or say that it is closed
    folder, first, before = _taken(sim, name, record, mode)
    state, start = protocol.begin(sim)
    start = {"frame": max(first, 1)} | start
    start.setdefault("states", protocol.steps)
    told: dict[str, Any] = {**(parameters or {}), "protocol": name, **protocol.settings}
    if folder is not None and not has_commands_of_a_user(sim.lmp, sim.engine.setup):
        told["start"] = start
    if sim.minimizer != sim.engine.chosen(None, sim.friction):
        told["minimizer"] = sim.minimizer
    told |= before
    states = [state]
    with ExitStack() as lock:
        if folder is not None and record is not None:
            check = partial(_check_place, name, record, mode, first)
            lock.enter_context(alone_in(folder, sim.comm, check))
        if folder is not None and sim.comm.rank == 0:
            if mode == "a":
                store.keep_frames(folder, first)
            else:
                store.drop_frames(folder)
            if first:
                write_state(state, folder, told, frames=first)  # its frame is there already
            else:
                write_frame(folder, 0, state, told)
        _steps(sim, protocol, told, start, 0, max(first, 1), state, folder, callback, states, keep)
    if folder is None:
        return Run(states, told)
    return Run(folder)[max(first, 1) - 1 :] if keep else Run(folder)[-1:]


def resume(run: Run, sim: Simulation, done: int, callback: Callback | None = None) -> None:
    """Take the steps that a recorded run lacks, from a simulation of its last state.

    Args:
        run: in a folder.
        sim: of its last state.
        done: number of steps that the run had when that state was read.
        callback: see `play`.

    Raises:
        FileError: frames are missing, or another process writes or has written the run.
    """
    told = run.parameters
    protocol, start = protocol_in(told), told["start"]
    assert run.folder is not None

    def check() -> None:
        if run.steps_done != done:
            raise FileError(
                f"another process has gone on with the run in '{run.folder}': resume it again"
            )

    with alone_in(run.folder, sim.comm, check):
        store.check_frames(run.folder)
        sim.comm.barrier()  # all ranks have read the frames
        if sim.comm.rank == 0:
            store.keep_frames(run.folder, store.frames_in(run.folder))
        if done and "seed" not in told:
            sim.relax(np.finfo(float).max)  # relaxed already: this only finds whether it is rigid
            packing, *_ = store.read(run.folder)
            sim.reset(packing)
            sim.engine.go_on(sim, store.read_motion(run.folder, packing))
        first = start["frame"]
        _steps(sim, protocol, told, start, done, first, None, run.folder, callback, [], False)


def _taken(
    sim: Simulation, name: str, record: str | Path | None, mode: str
) -> tuple[Path | None, int, dict[str, Any]]:
    """The folder, the number of frames in it that stay, and the parameters of the run before.

    Raises:
        ParameterError: the mode is another, or the simulation cannot be recorded.
        FileError: see `_place`.
    """
    if mode not in ("x", "w", "a"):
        raise ParameterError(f"mode must be 'x', 'w' or 'a', not {shown(mode)}")
    if record is None:
        return None, 0, {}
    expect("record", record, str, Path)
    if not isinstance(sim.law, Ring | Sector | Droplet | SoftContact):
        raise ParameterError(
            f"states of {type(sim.law).__name__} cannot be written yet: leave out record, or take "
            "another law"
        )
    sim.comm.barrier()  # rank 0 may still be writing
    return _place(name, record, mode)


def _place(name: str, record: str | Path, mode: str) -> tuple[Path, int, dict[str, Any]]:
    """What `_taken` returns of a folder, by what is in it.

    Raises:
        FileError: the folder holds what the mode does not allow, or an interrupted run.
    """
    from ..runs.run import Run

    call = f"{name}(..., record={str(record)!r}, mode="
    ways = (
        f"finish it with Run({str(record)!r}).resume()",
        f"go on behind it with {call}'a')",
        f"replace it with {call}'w')",
    )
    place = store.refuse_run(record, mode != "x", ways)
    place = place.absolute()  # a callback may change the working folder
    store.refuse_foreign(place / store.SERIES)
    if mode != "a" or store.holds(place) is None:
        return place, 0, {}
    run = Run(place)
    done, before = run.steps_done, run.parameters
    if done is not None and done < before["start"]["states"]:
        raise FileError(
            f"the run in '{place}' is interrupted at step {done} of {before['start']['states']}: "
            f"finish it first with Run({str(place)!r}).resume() (in the shell: --resume)"
        )
    store.check_frames(place)
    return place, store.frames_in(place), {"before": before}


def _check_place(name: str, record: str | Path, mode: str, first: int) -> None:
    """Raise an error if a folder is not as `_taken` has found it, with `first` frames that stay."""
    if _place(name, record, mode)[1] != first:
        raise FileError(
            f"another process has gone on with the run in '{record}' since this call of {name} "
            "began: open it again, or name another folder"
        )


def _steps(
    sim: Simulation,
    protocol: Protocol,
    told: dict[str, Any],
    start: dict[str, Any],
    done: int,
    first: int,
    before: State | None,
    folder: Path | None,
    callback: Callback | None,
    states: list[State],
    keep: bool,
) -> None:
    """Take the steps that remain.

    Args:
        sim: that goes on.
        protocol: with the settings of the run.
        told: parameters of the run; with a `start` each step begins anew.
        start: what the steps know of the start.
        done: number of steps before.
        first: number of the frame of the first step.
        before: the last state; None if it is not known.
        folder: to which states are written, if any.
        callback: see `play`.
        states: to which they are appended; they take its place if not all are kept.
        keep: whether all are.
    """
    taken_by = partial(_each_anew, sim, protocol) if "start" in told else partial(protocol.go, sim)
    source = _closing(taken_by(start, done, before))
    number, state = first + done - 1, None
    with closing(source), progress(protocol.name, "state", start["states"], initial=done) as bar:
        remaining = islice(source, start["states"] - done)
        for number, state in enumerate(remaining, start=first + done):
            expect(f"the result of a step of {protocol.name}", state, State)
            if folder is not None and sim.comm.rank == 0:
                write_frame(folder, number, state, told)
            if not keep:
                states.clear()
            states.append(state)
            bar.set_postfix(phi=f"{state.phi:.4f}", pressure=f"{state.pressure:.3g}")
            bar.update()
            if callback and _ends(callback, state, sim.comm):
                break
    if "start" in told and state is not None and (taken := number + 1 - first) < start["states"]:
        told["start"] = {**told["start"], "states": taken}  # complete: nothing is to be resumed
        if folder is not None and sim.comm.rank == 0:
            write_state(state, folder, told, frames=number + 1)


def _closing(steps: Iterator[State]) -> Generator[State, None, None]:
    """The same states; to close this closes the steps, if they are a generator too."""
    yield from steps


def _each_anew(
    sim: Simulation, protocol: Protocol, start: dict[str, Any], done: int, state: State | None
) -> Iterator[State]:
    """The states after the steps that remain, each as if the one before were read from a file."""
    for n in range(done, start["states"]):
        if state is not None:
            so_far = steps_so_far(sim)
            sim.reset(state)
            sim.engine.steps_before = so_far  # a later call draws other noise
        with closing(_closing(protocol.go(sim, start, n, None))) as steps:
            state = next(steps, None)
        if state is None:
            return
        yield state


def steps_so_far(sim: Simulation) -> int:
    """Number of time steps and iterations of a simulation so far."""
    return int(sim.engine.steps_before + sim.lmp.extract_global("ntimestep"))


def _ends(callback: Callback, state: State, comm: MPI.Comm) -> bool:
    """Whether the callback ends the protocol; its exception is raised here, on all ranks.

    Raises:
        TypeError: it returns neither None nor a bool.
        RuntimeError: it has failed on other ranks only.
    """

    def ends() -> bool:
        answer = callback(state)
        if answer is not None and not isinstance(answer, (bool, np.bool_)):
            raise TypeError(
                "callback must return None to go on, or a bool, True to end here, not "
                f"{shown(answer)}"
            )
        return bool(answer)

    return together(ends, comm, "the callback")


def recorded_numbers(state: State) -> dict[str, Any]:
    """The numbers of a state that are recorded, by name: a row of the series."""
    numbers: dict[str, Any] = dict(numbers_of(state))
    axes = "xyz"[: len(state.pressure_tensor)]
    for k, a in enumerate(axes):
        for n, b in enumerate(axes[k:], start=k):
            numbers[f"p{a}{b}"] = float(state.pressure_tensor[k, n])
    if isinstance(state.law, Ring | Sector) or state.friction or state.films is not None:
        numbers["lost_energy"] = state.lost_energy
    return numbers


def write_frame(folder: Path, number: int, state: State, parameters: Mapping[str, Any]) -> None:
    """Write a frame, and the state behind it. Only one rank calls this."""
    made_of = store.setup(state.packing, state.law, state.friction, state.gravity)
    store.append_setup(folder, number, made_of | store.memory(motion_of(state)))
    images = () if state.images is None else state.images.T
    values = dict(zip(("ix", "iy", "iz"), images, strict=False)) | particle_values(state)
    store.append_frame(folder, number, state.packing, values, recorded_numbers(state))
    write_state(state, folder, parameters, frames=number + 1)


def at_rest(sim: Simulation, tolerance: float | None) -> State:
    """The relaxed state. Particles that become loose are no news where they vanish and divide."""
    with collected(UnjammedWarning):
        return sim.relax(tolerance)


def next_time(now: float, end: float, change: float, rate: float) -> tuple[float, float]:
    """A step in which what changes at this rate changes by so much at most, and the time after."""
    step = end - now if rate == 0.0 else min(end - now, change / rate)
    return step, end if step == end - now else now + step
