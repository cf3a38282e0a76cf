"""What is kept of a run: a folder that other programs read and from which a run goes on.

    packing.data            last state, LAMMPS data file
    species.deformable      its species, for the pair style
    in.lammps               script of LAMMPS that reads these two
    summary.json            last state in numbers, model, parameters and versions
    series.csv              one row a state
    trajectory.lammpstrj    LAMMPS dump for OVITO and MDAnalysis

`State.save` writes the first four, `record` all of them while a run goes on; `load` takes a run up
again. A run may be killed at any moment: the packing is written last and in one go, and counts the
frames that belong to it. What a killed run has left behind these goes when the run goes on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from mpi4py import MPI

from ..common.validate import expect
from ..engine.simulation import Simulation
from ..io.frames import append_frame, check_frames, frames_in, keep_frames
from ..io.run_folder import DATA, SERIES
from ..io.store import read, summary_in
from ..state.state import State


def load(folder: str | Path, comm: MPI.Comm | None = None) -> Simulation:
    """Take up a saved run: the same particles, box and model, ready to go on.

    Args:
        folder: where `State.save` or `record` wrote.
        comm: as for `Simulation`.

    Raises:
        FileError: a file is missing or cannot be understood.
    """
    expect("folder", folder, str, Path)
    (comm or MPI.COMM_WORLD).barrier()  # rank 0 may still be writing
    return Simulation(*read(Path(folder)), comm=comm)


def record(
    states: Iterable[State],
    folder: str | Path,
    parameters: Mapping[str, Any] | None = None,
    append: bool = False,
) -> Iterator[State]:
    """Write each state into a folder as it comes: an interrupted run loses nothing.

        for state in deformable.record(deformable.compress(sim, 0.01, 10), "run"):
            print(state.phi)

    Args:
        states: e.g. from `compress`.
        folder: made if missing.
        parameters: anything JSON that belongs into the summary.
        append: go on with the series and trajectory in the folder instead of replacing them; the
            parameters written there move to `before` in the summary.

    Yields:
        The states, unchanged.
    """
    folder = Path(folder)
    first = 0
    if append and (folder / SERIES).exists():
        check_frames(folder)
        first = frames_in(folder)
        parameters = {**(parameters or {}), "before": summary_in(folder).get("parameters")}
    yield from write(states, folder, parameters, first)


def write(
    states: Iterable[State], folder: Path, parameters: Mapping[str, Any] | None, first: int
) -> Iterator[State]:
    """As `record`, behind the first frames on record."""
    for number, state in enumerate(states, start=first):
        if state.root:
            if number == first:
                folder.mkdir(parents=True, exist_ok=True)
                if frames_in(folder) > 0 == first:  # of another run, whose frames go
                    (folder / DATA).unlink(missing_ok=True)
                keep_frames(folder, first)
            append_frame(folder, number, state.packing, state.particle_values(), state.numbers())
            state.save(folder, parameters, frames=number + 1)
        yield state
