"""Folders of runs, for other programs to read and for a run to go on from.

    packing.data            last state, LAMMPS data file
    species.deformable      its species, for the pair style
    in.lammps               LAMMPS script that reads these two
    summary.json            numbers of the last state, law, parameters and versions
    series.csv              one row per state
    trajectory.lammpstrj    LAMMPS dump for OVITO and MDAnalysis
    setups.jsonl            law, radii and walls of the frames: a line for each change

`State.save` writes the first four, `record` all of them while a run goes on, and `load` continues
from the last state. A run may be interrupted at any moment: the packing is written last and
atomically, with the number of recorded frames. Frames beyond it are removed when the run goes on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from mpi4py import MPI

from ..common.files import make_folder
from ..common.validate import expect
from ..engine.lammps import communicator, place_velocities
from ..engine.simulation import Simulation
from ..io.frames import (
    append_frame,
    append_setup,
    check_frames,
    frames_in,
    keep_frames,
    refuse_foreign,
)
from ..io.run_folder import DATA, SERIES
from ..io.store import read, read_motion, setup, summary_in
from ..state.state import State


def load(folder: str | Path, comm: MPI.Comm | None = None) -> Simulation:
    """A simulation of the last state of a saved run: the same particles, box and law.

    Velocities, time and shear strain go on from those of the state.

    Args:
        folder: of `State.save` or `record`.
        comm: as for `Simulation`.

    Raises:
        FileError: a file is missing or cannot be read.
    """
    expect("folder", folder, str, Path)
    communicator(comm).barrier()  # rank 0 may still be writing
    packing, law = read(Path(folder))
    motion = read_motion(Path(folder), len(packing))
    sim = Simulation(packing, law, comm)
    place_velocities(sim.lmp, motion.velocities)
    sim.time, sim.strain = motion.time, motion.strain
    return sim


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
        parameters: anything that JSON can hold, for the summary.
        append: go on with the series and trajectory in the folder instead of replacing them; the
            parameters in its summary move to `before`.

    Yields:
        The states, unchanged.

    Raises:
        ParameterError: these are no states, of a `Simulation`, or no parameters.
        FileError: a file cannot be written, or `series.csv` is that of another program.
    """
    expect("folder", folder, str, Path)
    expect("states", states, Iterable)
    expect("parameters", parameters, Mapping, type(None))
    folder = Path(folder)
    refuse_foreign(folder)
    goes_on = append and (folder / SERIES).exists()
    first, before = recorded(folder) if goes_on else (0, {})
    return write(states, folder, {**(parameters or {}), **before}, first)


def recorded(folder: Path) -> tuple[int, dict[str, Any]]:
    """Number of frames of a run, and its parameters for the summary of the next one."""
    check_frames(folder)
    return frames_in(folder), {"before": summary_in(folder).get("parameters")}


def write(
    states: Iterable[State], folder: Path, parameters: Mapping[str, Any], first: int
) -> Iterator[State]:
    """Write each state after the first frames of a folder; later frames are removed."""
    for number, state in enumerate(states, start=first):
        expect("a state that is recorded", state, State)
        if state.root:
            if number == first:
                make_folder(folder)
                if frames_in(folder) > 0 == first:  # another run is replaced
                    (folder / DATA).unlink(missing_ok=True)
                keep_frames(folder, first)
            append_setup(folder, number, setup(state.packing, state.law))
            append_frame(folder, number, state.packing, state.particle_values(), state.numbers())
            state.save(folder, parameters, frames=number + 1)
        yield state
