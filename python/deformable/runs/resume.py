"""Compressions and shears that go on after an interruption at any moment, with the same numbers.

Each step starts from the packing in the folder, which has all digits, and from the box of the first
step. So a step gives the same whether or not the same process computed those before it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from ..common.errors import FileError, ParameterError
from ..common.validate import expect, positive
from ..engine.lammps import communicator
from ..engine.relaxation import TOLERANCE
from ..engine.simulation import Simulation
from ..io.frames import check_frames, frames_in, refuse_foreign
from ..io.run_folder import DATA, refuse
from ..io.store import read, summary_in
from ..model.packing import Packing
from ..protocols.compression import check_strain_and_steps, remaining_steps
from ..protocols.shear import shear, shear_steps
from ..state.state import State
from .record import load, recorded, write

# With a larger one the forces on a particle are far from balanced.
LARGEST_TOLERANCE = 1e-2


def compress_in(
    folder: str | Path,
    sim: Simulation,
    strain: float,
    steps: int,
    tolerance: float = TOLERANCE,
    parameters: Mapping[str, Any] | None = None,
    append: bool = False,
    overwrite: bool = False,
) -> Iterator[State]:
    """Compress as `compress`, and write as `record`, so that `resume` can go on after any step.

    Args:
        folder: made if missing.
        sim: without further commands to its `lmp`, because each step starts a new LAMMPS.
        strain: of all steps together, as in `compress`.
        steps: as in `compress`.
        tolerance: of each relaxation, see `Simulation.relax`; at most 0.01.
        parameters: anything that JSON can hold, for the summary.
        append: compress the run in the folder further: its series and trajectory go on.
        overwrite: replace the run in the folder.

    Yields:
        The relaxed state after each step, once it is written.

    Raises:
        ParameterError: as for `compress`, or the tolerance is too large.
        FileError: the folder holds a run and neither `append` nor `overwrite` is given; or `append`
            is given and the run is interrupted or lacks frames; or it holds something else.
    """
    expect("sim", sim, Simulation)
    expect("parameters", parameters, Mapping, type(None))
    check_compression(strain, steps, tolerance)
    protocol = {"strain": float(strain), "steps": int(steps), "tolerance": float(tolerance)}
    return _begin(folder, sim, protocol, parameters, append, overwrite)


def shear_in(
    folder: str | Path,
    sim: Simulation,
    strain: float,
    steps: int,
    tolerance: float = TOLERANCE,
    parameters: Mapping[str, Any] | None = None,
    append: bool = False,
    overwrite: bool = False,
) -> Iterator[State]:
    """Shear as `shear`, and write as `record`, so that `resume` can go on after any step.

    Frame 0 of a new run is the state before the first step, with the strain 0. The other arguments
    are those of `compress_in`.

    Args:
        strain: shear strain of all steps together.

    Yields:
        The relaxed state after each step, once it is written.

    Raises:
        ParameterError: as for `shear`.
        FileError: as for `compress_in`.
    """
    expect("sim", sim, Simulation)
    shear(sim, strain, steps, tolerance)  # checks its arguments, and does nothing before it starts
    _check_tolerance(tolerance)
    protocol = {"strain": float(strain), "steps": int(steps), "tolerance": float(tolerance)}
    return _begin(folder, sim, {"protocol": "shear"} | protocol, parameters, append, overwrite)


def _begin(
    folder: str | Path,
    sim: Simulation,
    protocol: Mapping[str, Any],
    parameters: Mapping[str, Any] | None,
    append: bool,
    overwrite: bool,
) -> Iterator[State]:
    """Write the start of a run, and return its steps."""
    if append and overwrite:
        raise ParameterError("a run either goes on or is replaced: not both")
    ways = ("finish it with resume", "go on with append=True", "replace it with overwrite=True")
    sim.comm.barrier()  # rank 0 may still be writing
    folder = refuse(folder, "compression" if append or overwrite else None, ways)
    refuse_foreign(folder)
    first, before = 0, dict[str, Any]()
    if append:
        _check_complete(folder)
        first, before = recorded(folder)
    shears = protocol.get("protocol") == "shear"
    shows_start = shears and not append
    sim.strain = (sim.strain or 0.0) if shears else sim.strain
    start = sim.state()  # all ranks have read the folder by then
    began = {"frame": first + shows_start, "box": start.packing.box.tolist(), "strain": sim.strain}
    parameters = {**(parameters or {}), **protocol, "start": began, **before}
    if start.root and not append:
        (folder / DATA).unlink(missing_ok=True)  # no run is here until the new one is complete
    if shows_start:
        for _ in write([start], folder, parameters, first):
            pass
    elif start.root:
        start.save(folder, parameters, frames=first)
    return _steps(sim, start.packing, folder, parameters, done=0)


def resume(folder: str | Path, comm: MPI.Comm | None = None) -> Iterator[State]:
    """Finish an interrupted `compress_in` or `shear_in`, with the numbers of a whole one.

    Args:
        folder: of `compress_in` or `shear_in`. The files of an unfinished step are removed.
        comm: as for `Simulation`.

    Yields:
        The states that are missing; none if the run is complete.

    Raises:
        FileError: there is no such run, or its files cannot be read.
    """
    comm = communicator(comm)
    comm.barrier()  # rank 0 may still be writing
    folder = refuse(folder, but="compression")
    packing, _ = read(folder)
    parameters = _parameters(folder)
    if "start" not in parameters:
        raise FileError(
            f"the run in '{folder}' is none that can be resumed: compress it further "
            "with --further (in Python: compress_in with append=True)"
        )
    done = _steps_done(folder, parameters)
    comm.barrier()  # all ranks have read the folder
    if done >= parameters["steps"]:
        return iter(())
    check_frames(folder)
    sim = load(folder, comm)
    if done > 0:
        sim.relax(np.finfo(float).max)  # relaxed already: this only finds whether it is rigid
    return _steps(sim, packing, folder, parameters, done)


def check_compression(strain: float, steps: int, tolerance: float) -> None:
    """Refuse values that are out of range for `compress_in`."""
    check_strain_and_steps(strain, steps)
    _check_tolerance(tolerance)


def _check_tolerance(tolerance: float) -> None:
    if positive("tolerance", tolerance) > LARGEST_TOLERANCE:
        raise ParameterError(f"tolerance must be at most {LARGEST_TOLERANCE}, not {tolerance}")


def _check_complete(folder: Path) -> None:
    """Refuse to compress a run further that is interrupted or cannot be read."""
    read(folder)
    parameters = _parameters(folder)
    if "start" in parameters and _steps_done(folder, parameters) < parameters["steps"]:
        raise FileError(
            f"the run in '{folder}' is interrupted at step "
            f"{_steps_done(folder, parameters)} of {parameters['steps']}: finish it first with "
            "--resume (in Python: resume)"
        )


def _parameters(folder: Path) -> dict[str, Any]:
    return summary_in(folder).get("parameters") or {}


def steps_in(folder: Path) -> int:
    """Number of steps of the run in a folder that are recorded."""
    return _steps_done(folder, _parameters(folder))


def _steps_done(folder: Path, parameters: Mapping[str, Any]) -> int:
    return frames_in(folder) - int(parameters["start"]["frame"])


def _steps(
    sim: Simulation, packing: Packing, folder: Path, parameters: Mapping[str, Any], done: int
) -> Iterator[State]:
    """The steps that are missing, each written and started from a new LAMMPS."""
    start = parameters["start"]
    protocol = (parameters["strain"], parameters["steps"], done, parameters["tolerance"])
    time, strain = sim.time, sim.strain
    sim.restart(packing)
    sim.time, sim.strain = time, strain
    if parameters.get("protocol") == "shear":
        states = shear_steps(sim, start.get("strain") or 0.0, *protocol)
    else:
        states = remaining_steps(sim, np.array(start["box"]), *protocol)
    return write(_restarting(sim, states), folder, parameters, start["frame"] + done)


def _restarting(sim: Simulation, states: Iterable[State]) -> Iterator[State]:
    for state in states:
        yield state
        sim.restart(state)
