"""A compression that may be killed at any moment and goes on as if it had not been.

Each step starts from the packing in the folder alone, which has every digit, and its box is a part
of the first one. So a step gives the same whether or not the same process took those before it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from .compression import check_protocol, go_on
from .errors import FileError, ParameterError
from .files import DATA, frames_in, read, save, summary_in, write
from .packing import Packing
from .simulation import Simulation
from .state import State


def compress_in(
    folder: str | Path,
    sim: Simulation,
    strain: float,
    steps: int,
    tolerance: float = 1e-6,
    parameters: Mapping[str, Any] | None = None,
    append: bool = False,
) -> Iterator[State]:
    """Compress as `compress`, and write as `record` what `resume` needs to go on at any step.

    Args:
        folder: made if missing.
        sim: as it is, without further commands to its `lmp`: each step takes a new LAMMPS.
        strain: linear strain in all, below 1; negative expands.
        steps: number of steps.
        tolerance: of each relaxation, see `Simulation.relax`.
        parameters: anything JSON that belongs into the summary.
        append: go on with the series and trajectory in the folder instead of replacing them.

    Yields:
        The relaxed state after each step, once it is written.

    Raises:
        ParameterError: a value is out of range.
    """
    check_protocol(strain, steps)
    folder = Path(folder)
    first = frames_in(folder) if append else 0
    before = {"before": summary_in(folder).get("parameters")} if append else {}
    start = sim.state()  # by then all ranks have read
    protocol = {"strain": strain, "steps": steps, "tolerance": tolerance}
    began = {"frame": first, "box": start.packing.box.tolist()}
    parameters = {**(parameters or {}), **protocol, "start": began, **before}
    if start.root:
        if not append:
            (folder / DATA).unlink(missing_ok=True)  # until the new one is there: there is no run
        save(start, folder, parameters, frames=first)
    return _steps(sim, start.packing, folder, parameters, done=0)


def resume(folder: str | Path, comm: MPI.Comm | None = None) -> Iterator[State]:
    """Finish what `compress_in` has begun, with the numbers that it would have given.

    Args:
        folder: where it wrote. What it left of a step that it did not finish goes.
        comm: as for `Simulation`.

    Yields:
        The states that are missing.

    Raises:
        FileError: there is no such compression, or its files cannot be understood.
        ParameterError: it is complete.
    """
    folder, comm = Path(folder), comm or MPI.COMM_WORLD
    packing, model = read(folder)
    parameters = summary_in(folder)["parameters"]
    if "start" not in parameters:
        raise FileError(
            f"the run in '{folder}' does not say how it was to go on: compress it further, by a "
            "strain in a number of steps"
        )
    done = frames_in(folder) - parameters["start"]["frame"]
    if done >= parameters["steps"]:
        raise ParameterError(
            f"the compression in '{folder}' is complete: compress it further, by a strain in a "
            "number of steps"
        )
    comm.barrier()  # all have read it
    sim = Simulation(packing, model, comm)
    if done > 0:
        sim.relax(np.finfo(float).max)  # it is: only to know whether it is rigid
    return _steps(sim, packing, folder, parameters, done)


def _steps(
    sim: Simulation, packing: Packing, folder: Path, parameters: Mapping[str, Any], done: int
) -> Iterator[State]:
    start = parameters["start"]
    protocol = (parameters["strain"], parameters["steps"], done, parameters["tolerance"])
    sim.restart(packing)
    states = go_on(sim, np.array(start["box"]), *protocol)
    return write(_each_afresh(sim, states), folder, parameters, start["frame"] + done)


def _each_afresh(sim: Simulation, states: Iterable[State]) -> Iterator[State]:
    for state in states:
        yield state
        sim.restart(state.packing)
