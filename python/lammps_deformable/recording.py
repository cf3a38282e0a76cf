"""Runs that are written as they go on.

Frame 0 is the state before the first step.

Each step of `compress_in` and `shear_in` starts from the packing in the folder, which has all
digits, and from the box of the first step. So a step gives the same whether or not the same process
computed those before it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import store
from ._checks import expect, positive
from ._files import check_parameters, make_folder
from .compression import check_target, remaining_steps, steps_towards
from .engines import go_on
from .errors import ParameterError
from .progress import Steps, start_of, waits_for_all
from .relax import TOLERANCE
from .shearing import check_shear, shear_steps
from .simulation import Simulation
from .state import State
from .store import SERIES, Motion, memory, refuse_foreign, refuse_run, setup

if TYPE_CHECKING:
    from .packing import Packing

# With a larger one the forces on a particle are far from balanced.
LARGEST_TOLERANCE = 1e-2

_WAYS = (
    "finish it with Run.resume",
    "go on with Run.compress or Run.shear",
)
_APPEND = ("go on with Run.append",)


def record(
    states: Iterable[State],
    folder: str | Path,
    parameters: Mapping[str, Any] | None = None,
    overwrite: bool = False,
) -> Iterator[State]:
    """Write each state into a folder as it comes: an interrupted run loses nothing.

    Frame 0 is the state before the first step of a protocol.

        for state in ld.record(ld.compress(sim, 0.01, 10), "run"):
            print(state.phi)

    Args:
        states: e.g. from `compress`. What protocols, `log` and `record` return knows the state
            before, until its first step is asked for. Frame 0 of all other states is the first one.
        folder: made if missing. `Run.append` goes on with a run in it.
        parameters: anything that JSON can hold, for the summary.
        overwrite: replace a run in the folder, when the first state comes.

    Yields:
        The states, unchanged; without the one before the first step.

    Raises:
        ParameterError: these are no states, of a `Simulation`, or no parameters.
        FileError: the folder holds a run and `overwrite` is not given, or it holds something else,
            or a file cannot be written, or `series.csv` is that of another program.
    """
    expect("folder", folder, str, Path)
    expect_states(states, parameters)
    refuse_foreign(Path(folder) / SERIES)
    if waits_for_all(states):
        refuse_run(folder, overwrite, _APPEND)
    start = start_of(states)
    written = write(states, Path(folder), parameters or {}, 0, start, overwrite)
    return Steps("record", written, start)


def compress_in(
    sim: Simulation,
    folder: str | Path,
    strain: float | None = None,
    steps: int = 10,
    tolerance: float = TOLERANCE,
    parameters: Mapping[str, Any] | None = None,
    overwrite: bool = False,
    phi: float | None = None,
    pressure: float | None = None,
) -> Iterator[State]:
    """Compress as `compress`, and write as `record`, so that `Run.resume` can go on at any step.

    Frame 0 is the state before the first step: unrelaxed, or the relaxed start for a phi or
    pressure.

    Args:
        sim: without further commands to its `lmp`, because each step starts a new LAMMPS.
        folder: made if missing.
        strain: of all steps together, as in `compress`; or phi or pressure, see there.
        steps: as in `compress`.
        tolerance: of each relaxation, see `Simulation.relax`; at most 0.01.
        parameters: anything that JSON can hold, for the summary.
        overwrite: replace the run in the folder.
        phi: as in `compress`.
        pressure: as in `compress`.

    Yields:
        The relaxed state after each step, once it is written.

    Raises:
        ParameterError: as for `compress`, or the tolerance is too large.
        FileError: as for `record`.
    """
    protocol = compression(steps, tolerance, strain=strain, phi=phi, pressure=pressure)
    return _begin_in("compress_in", sim, folder, protocol, parameters, overwrite)


def shear_in(
    sim: Simulation,
    folder: str | Path,
    strain: float,
    steps: int = 10,
    tolerance: float = TOLERANCE,
    parameters: Mapping[str, Any] | None = None,
    overwrite: bool = False,
) -> Iterator[State]:
    """Shear as `shear`, and write as `record`, so that `Run.resume` can go on at any step.

    Frame 0 is the state before the first step, with the strain 0. The other arguments are those of
    `compress_in`.

    Args:
        strain: shear strain of all steps together.

    Yields:
        The relaxed state after each step, once it is written.

    Raises:
        ParameterError: as for `shear`, or the tolerance is too large.
        FileError: as for `compress_in`.
    """
    expect("sim", sim, Simulation)
    check_shear(sim, strain, steps)
    protocol = shear_protocol(strain, steps, tolerance)
    return _begin_in("shear_in", sim, folder, protocol, parameters, overwrite)


def expect_states(states: Any, parameters: Any) -> None:
    """Refuse objects of another kind."""
    expect("states", states, Iterable)
    check_parameters(parameters)


def compression(steps: int, tolerance: float, **targets: float | None) -> dict[str, Any]:
    """The steps of a compression to a strain, phi or pressure, for the parameters of a run.

    Raises:
        ParameterError: a value is out of range.
    """
    name, target = check_target(None, steps, **targets)
    return {name: target} | _steps(steps, tolerance)


def shear_protocol(strain: float, steps: int, tolerance: float) -> dict[str, Any]:
    """The steps of a shear, for the parameters of a run."""
    return {"protocol": "shear", "strain": float(strain)} | _steps(steps, tolerance)


def _steps(steps: int, tolerance: float) -> dict[str, Any]:
    if positive("tolerance", tolerance) > LARGEST_TOLERANCE:
        raise ParameterError(f"tolerance must be at most {LARGEST_TOLERANCE}, not {tolerance}")
    return {"steps": int(steps), "tolerance": float(tolerance)}


def _target(parameters: Mapping[str, Any]) -> tuple[str, float]:
    """The target of a protocol, and its name."""
    names = ("strain", "phi", "pressure")
    return next((name, parameters[name]) for name in names if parameters.get(name) is not None)


def _begin_in(
    name: str,
    sim: Simulation,
    folder: str | Path,
    protocol: Mapping[str, Any],
    parameters: Mapping[str, Any] | None,
    overwrite: bool,
) -> Iterator[State]:
    expect("sim", sim, Simulation)
    sim.comm.barrier()  # rank 0 may still be writing
    _ = sim.lmp  # or say that it is closed
    place = refuse_run(folder, overwrite, _WAYS)
    refuse_foreign(place / SERIES)
    return begin(name, sim, place, protocol, parameters)


def begin(
    name: str,
    sim: Simulation,
    folder: Path,
    protocol: Mapping[str, Any],
    parameters: Mapping[str, Any] | None,
    before: Mapping[str, Any] | None = None,
    first: int = 0,
) -> Iterator[State]:
    """The steps of a run. Nothing is written before the first one is asked for.

    Args:
        name: of what the user has called.
        before: parameters of the run that it goes on with, if any.
        first: number of the frames before.
    """
    check_parameters(parameters)
    return Steps(name, _begun(sim, folder, protocol, parameters, before, first))


def _begun(
    sim: Simulation,
    folder: Path,
    protocol: Mapping[str, Any],
    parameters: Mapping[str, Any] | None,
    before: Mapping[str, Any] | None,
    first: int,
) -> Iterator[State]:
    """Write the start of a run, then take its steps."""
    shears, new = protocol.get("protocol") == "shear", before is None
    sim.strain = (sim.strain or 0.0) if shears else sim.strain
    start = sim.state()  # all ranks have read the folder by then
    target, _ = _target(protocol)
    if target != "strain":
        start = sim.relax(protocol["tolerance"])
    began = {"frame": max(first, 1), "box": start.packing.box.tolist()}
    began["strain"] = sim.strain
    began |= {} if target == "strain" else {target: getattr(start, target)}
    parameters = {**(parameters or {}), **protocol, "start": began, **(before or {})}
    if first == 0:
        for _ in write([start], folder, parameters, first, overwrite=True if new else None):
            pass
    elif start.root:
        start._write(folder, parameters, frames=first)
    yield from steps_of(sim, start.packing, start.motion, folder, parameters, done=0)


def steps_of(
    sim: Simulation,
    packing: Packing,
    motion: Motion,
    folder: Path,
    parameters: Mapping[str, Any],
    done: int,
) -> Iterator[State]:
    """The steps that are missing, each written and started from a new LAMMPS."""
    start = parameters["start"]
    target, goal = _target(parameters)
    steps = (goal, parameters["steps"], done, parameters["tolerance"])
    sim.reset(packing)
    go_on(sim, motion)
    if parameters.get("protocol") == "shear":
        states = shear_steps(sim, start.get("strain") or 0.0, *steps)
    elif target == "strain":
        states = remaining_steps(sim, np.array(start["box"]), *steps)
    else:
        states = steps_towards(sim, target, start[target], *steps)
    return write(_restarting(sim, states), folder, parameters, start["frame"] + done)


def _restarting(sim: Simulation, states: Iterable[State]) -> Iterator[State]:
    for state in states:
        yield state
        sim.reset(state)


def write(
    states: Iterable[State],
    folder: Path,
    parameters: Mapping[str, Any],
    first: int,
    start: Callable[[], State | None] = lambda: None,
    overwrite: bool | None = None,
) -> Iterator[State]:
    """Write each state after the first frames of a folder; later frames are removed.

    Args:
        states: to write.
        folder: of the run.
        parameters: of the run.
        first: number of the frames before.
        start: returns the state before the first step, which becomes frame 0 and is not yielded.
        overwrite: begin a new run, and may it replace another? None goes on with the run.
    """
    before = start() if first == 0 else None
    for number, state in enumerate(chain([before] if before else [], states), start=first):
        expect("a state that is recorded", state, State)
        if state.root:
            if number == first:
                if overwrite is None:
                    store.keep_frames(folder, first)
                else:
                    store.drop_frames(make_folder(refuse_run(folder, overwrite, _APPEND)))
            store.append_setup(
                folder,
                number,
                setup(state.packing, state.law, state.friction) | memory(state.motion),
            )
            values, numbers = state.particle_values(), state.numbers()
            store.append_frame(folder, number, state.packing, values, numbers)
            state._write(folder, parameters, frames=number + 1)
        if state is not before:
            yield state
