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

from ..common.errors import FileError, ParameterError
from ..common.validate import positive
from ..engine.simulation import Simulation
from ..io.frames import check_frames, frames_in
from ..io.run_folder import DATA, refuse
from ..io.store import read, summary_in
from ..model.packing import Packing
from ..protocols.compression import check_strain_and_steps, remaining_steps
from ..state.state import State
from .record import write

# Above it the forces on a particle are not in balance by any measure.
LARGEST_TOLERANCE = 1e-2


def compress_in(
    folder: str | Path,
    sim: Simulation,
    strain: float,
    steps: int,
    tolerance: float = 1e-6,
    parameters: Mapping[str, Any] | None = None,
    append: bool = False,
    overwrite: bool = False,
) -> Iterator[State]:
    """Compress as `compress`, and write as `record` what `resume` needs to go on at any step.

    Args:
        folder: made if missing.
        sim: as it is, without further commands to its `lmp`: each step takes a new LAMMPS.
        strain: linear strain in all, below 1; negative expands.
        steps: number of steps.
        tolerance: of each relaxation, at most 0.01, see `Simulation.relax`.
        parameters: anything JSON that belongs into the summary.
        append: compress what is in the folder further: go on with its series and trajectory.
        overwrite: replace the run in the folder.

    Yields:
        The relaxed state after each step, once it is written.

    Raises:
        ParameterError: a value is out of range.
        FileError: the folder holds a run and neither `append` nor `overwrite` is given, or `append`
            is and the run is interrupted or lacks frames; or it holds something else.
    """
    check_compression(strain, steps, tolerance)
    if append and overwrite:
        raise ParameterError("a run is either compressed further or replaced: not both")
    ways = ("finish it with resume", "go on with append=True", "replace it with overwrite=True")
    sim.comm.barrier()  # rank 0 may still be writing
    folder = refuse(folder, "compression" if append or overwrite else None, ways)
    if append:
        check_further(folder)
    first = frames_in(folder) if append else 0
    before = {"before": summary_in(folder).get("parameters")} if append else {}
    start = sim.state()  # by then all ranks have read
    protocol = {"strain": float(strain), "steps": int(steps), "tolerance": float(tolerance)}
    began = {"frame": first, "box": start.packing.box.tolist()}
    parameters = {**(parameters or {}), **protocol, "start": began, **before}
    if start.root:
        if not append:
            (folder / DATA).unlink(missing_ok=True)  # until the new one is there: there is no run
        start.save(folder, parameters, frames=first)
    return _steps(sim, start.packing, folder, parameters, done=0)


def resume(folder: str | Path, comm: MPI.Comm | None = None) -> Iterator[State]:
    """Finish what `compress_in` has begun, with the numbers that it would have given.

    Args:
        folder: where it wrote. What it left of a step that it did not finish goes.
        comm: as for `Simulation`.

    Yields:
        The states that are missing; none if it is complete.

    Raises:
        FileError: there is no such compression, or its files cannot be understood.
    """
    comm = comm or MPI.COMM_WORLD
    comm.barrier()  # rank 0 may still be writing
    folder = refuse(folder, but="compression")
    packing, law = read(folder)
    parameters = summary_in(folder)["parameters"]
    done, steps = steps_done(folder)
    comm.barrier()  # all have read it
    if done >= steps:
        return iter(())
    check_frames(folder)
    sim = Simulation(packing, law, comm)
    if done > 0:
        sim.relax(np.finfo(float).max)  # it is: only to know whether it is rigid
    return _steps(sim, packing, folder, parameters, done)


def check_compression(strain: float, steps: int, tolerance: float) -> None:
    """Refuse what `compress_in` cannot do."""
    check_strain_and_steps(strain, steps)
    if positive("tolerance", tolerance) > LARGEST_TOLERANCE:
        raise ParameterError(f"tolerance must be at most {LARGEST_TOLERANCE}, not {tolerance}")


def steps_done(folder: Path) -> tuple[int, int]:
    """Steps of the compression in a folder that are done, and how many it has."""
    parameters = summary_in(folder).get("parameters") or {}
    if "start" not in parameters:
        raise FileError(
            f"the run in '{folder}' does not say how it was to go on: compress it further with "
            "--further (in Python: compress_in with append=True)"
        )
    return frames_in(folder) - parameters["start"]["frame"], parameters["steps"]


def check_further(folder: Path) -> None:
    """Refuse to go on behind a run that is not all there."""
    read(folder)
    if "start" in (summary_in(folder).get("parameters") or {}):
        done, steps = steps_done(folder)
        if done < steps:
            raise FileError(
                f"the compression in '{folder}' is interrupted at step {done} of {steps}: finish "
                "it first with --resume (in Python: resume)"
            )
    check_frames(folder)


def _steps(
    sim: Simulation, packing: Packing, folder: Path, parameters: Mapping[str, Any], done: int
) -> Iterator[State]:
    start = parameters["start"]
    protocol = (parameters["strain"], parameters["steps"], done, parameters["tolerance"])
    sim.restart(packing)
    states = remaining_steps(sim, np.array(start["box"]), *protocol)
    return write(_each_afresh(sim, states), folder, parameters, start["frame"] + done)


def _each_afresh(sim: Simulation, states: Iterable[State]) -> Iterator[State]:
    for state in states:
        yield state
        sim.restart(state.packing)
