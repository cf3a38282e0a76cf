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

import csv
import io
import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from .checks import expect
from .errors import FileError
from .folders import DATA, SERIES, SUMMARY, TRAJECTORY, refuse
from .frames import check_frames, frames_in
from .lammps_files import SCRIPT, SPECIES, data_file, packing_in, script
from .models import Ring, Sector
from .packing import Packing
from .simulation import Simulation
from .state import State
from .versions import versions

_FRAME = r"(?=ITEM: TIMESTEP\n)"

_MODELS: dict[str, type[Ring] | type[Sector]] = {"Ring": Ring, "Sector": Sector}


def save(
    state: State,
    folder: str | Path,
    parameters: Mapping[str, Any] | None,
    frames: int | None = None,
) -> None:
    """See `State.save`; the packing counts the frames on record up to this state, if given."""
    if not state.root:
        return
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    summary = {
        "state": numbers(state),
        "model": {"name": type(state.model).__name__}
        | {name: _strict(value) for name, value in asdict(state.model).items()},
        "radii": state.packing.radii.tolist(),
        "parameters": {name: _strict(value) for name, value in (parameters or {}).items()},
        "versions": versions(),
    }
    _replace(folder / SPECIES, state.model.parameters(state.packing.radii.tolist()))
    _replace(folder / SCRIPT, script(state))
    _replace(folder / SUMMARY, json.dumps(summary, indent=2, default=str) + "\n")
    _replace(folder / DATA, data_file(state.packing, frames))


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
    series, trajectory = folder / SERIES, folder / TRAJECTORY
    for number, state in enumerate(states, start=first):
        if state.root:
            if number == first:
                folder.mkdir(parents=True, exist_ok=True)
                if frames_in(folder) > 0 == first:  # of another run, whose frames go
                    (folder / DATA).unlink(missing_ok=True)
                _keep(trajectory, first, _FRAME)
                _keep(series, first + 1 if first > 0 else 0, r"(?<=\n)")
            row = io.StringIO()
            writer = csv.DictWriter(row, ["frame", *numbers(state)])
            if number == 0:
                writer.writeheader()
            writer.writerow({"frame": number} | numbers(state))
            _append(trajectory, _dump_frame(number, state))
            _append(series, row.getvalue())
            save(state, folder, parameters, frames=number + 1)
        yield state


def numbers(state: State) -> dict[str, Any]:
    """A state in numbers, by name."""
    (lx, _), (xy, ly) = state.packing.box.tolist()
    return {
        "particles": len(state.packing),
        "lx": lx,
        "ly": ly,
        "xy": xy,
        "phi": state.phi,
        "pressure": state.pressure,
        "shear_stress": -float(state.stress[0, 1]),  # as `shear` has it: resists shear along x
        "energy": state.energy,
        "temperature": state.temperature,
        "time": state.time,
        "coordination": state.coordination,
        "rattlers": int(np.sum(state.rattlers)),
        "beyond": state.beyond,
        "residual": state.residual,
        "stalled": state.stalled,
    }


def _strict(value: Any) -> Any:
    """JSON has no infinity; `float` reads it back from a string."""
    if isinstance(value, tuple):
        return [_strict(each) for each in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def _replace(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.replace(path)


def _append(path: Path, text: str) -> None:
    with path.open("a", newline="") as file:
        file.write(text)


def _keep(path: Path, count: int, boundary: str) -> None:
    """Leave the first parts of a file; a killed run may have left more, or a part of one."""
    text = path.read_bytes().decode() if path.exists() else ""
    parts = [part for part in re.split(boundary, text) if part]
    if len(parts) > count:
        _replace(path, "".join(parts[:count]))


def _dump_frame(number: int, state: State) -> str:
    packing = state.packing
    (lx, _), (xy, ly) = packing.box.tolist()
    # LAMMPS gives the bounding box of a tilted cell and the tilts beside it.
    box = (
        ["ITEM: BOX BOUNDS pp pp pp", f"0 {lx!r}", f"0 {ly!r}", "-0.5 0.5"]
        if xy == 0.0
        else [
            "ITEM: BOX BOUNDS xy xz yz pp pp pp",
            f"{min(0.0, xy)!r} {lx + max(0.0, xy)!r} {xy!r}",
            f"0 {ly!r} 0",
            "-0.5 0.5 0",
        ]
    )
    columns = {
        "radius": packing.radius,
        "area": state.area,
        "perimeter": state.perimeter,
        "pressure": state.particle_pressure,
        "contacts": state.contacts,
        "arc_radius": state.arc_radius,
        "rattler": state.rattlers.astype(int),
        "vx": state.velocities[:, 0],
        "vy": state.velocities[:, 1],
    }
    lines = ["ITEM: TIMESTEP", str(number), "ITEM: NUMBER OF ATOMS", str(len(packing)), *box]
    lines.append("ITEM: ATOMS id type x y z " + " ".join(columns))
    rows = zip(
        packing.species.tolist(),
        packing.positions.tolist(),
        *(column.tolist() for column in columns.values()),
        strict=True,
    )
    for n, (kind, (x, y), *values) in enumerate(rows, start=1):
        lines.append(f"{n} {kind + 1} {x!r} {y!r} 0 " + " ".join(map(repr, values)))
    return "\n".join(lines) + "\n"


def summary_in(folder: Path) -> dict[str, Any]:
    """What `summary.json` says."""
    path = folder / SUMMARY
    try:
        return dict(json.loads(_text(path, folder)))
    except (ValueError, TypeError) as error:
        raise FileError(f"{path} cannot be read: {error}") from None


def _text(path: Path, folder: Path) -> str:
    try:
        return path.read_text()
    except FileNotFoundError:
        raise FileError(f"no saved run in '{folder}': {path} is missing") from None
    except OSError as error:
        raise FileError(f"{path} cannot be read: {error.strerror}") from None


def _setting(value: Any) -> Any:
    """A word, a number, or numbers, as `_strict` has written them."""
    if isinstance(value, list):
        return [_setting(each) for each in value]
    try:
        return float(value)
    except ValueError:
        return value


def read(folder: Path) -> tuple[Packing, Ring | Sector]:
    """The packing in a folder, to the last digit, and its model."""
    summary, path = summary_in(refuse(folder, but="compression")), folder / SUMMARY
    try:
        settings = dict(summary["model"])
        name = settings.pop("name")
        if name not in _MODELS:
            raise ValueError(f"there is no law {name!r}")
        model = _MODELS[name](**{key: _setting(value) for key, value in settings.items()})
        radii = summary["radii"]
        path = folder / DATA
        return packing_in(_text(path, folder), radii), model
    except KeyError as error:
        raise FileError(f"{path} cannot be read: it does not tell {error}") from None
    except (ValueError, TypeError) as error:
        raise FileError(f"{path} cannot be read: {error}") from None
