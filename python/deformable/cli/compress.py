"""The command `deformable compress`: a packing, jammed and compressed, kept in a folder."""

from __future__ import annotations

import importlib.util
import math
import time
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from mpi4py import MPI

from ..common.errors import ParameterError
from ..common.progress import print_once
from ..common.validate import positive
from ..engine.simulation import Simulation
from ..io.frames import frames_in
from ..io.run_folder import refuse
from ..io.store import summary_in
from ..model.laws import Law, Ring, Sector
from ..model.packing import Packing, bidisperse, polydisperse
from ..protocols.jamming import jam
from ..runs.record import load
from ..runs.resume import (
    LARGEST_TOLERANCE,
    check_compression,
    compress_in,
    steps_done,
)
from ..runs.resume import (
    resume as finish,
)
from ..state.state import State

# What describes a packing and its law; the rest describes what is done to it.
PACKING_OPTIONS = (
    *("number", "radii", "fraction", "polydispersity", "aspect", "tilt", "seed"),
    *("law", "ka", "kp", "contact", "reach"),
)


_PROTOCOL_OPTIONS = ("strain", "steps", "tolerance")

# Out of a folder that holds a run.
_WAYS = (
    "finish it with --resume",
    "compress it further with --further",
    "replace it with --overwrite",
)


# Residual above which a relaxation of a law fell short: the default of `Simulation.relax`.
TOLERANCE = 1e-6


class Lines(str, Enum):
    """Where contact lines are."""

    RADICAL = "radical"
    BALANCED = "balanced"


class LawName(str, Enum):
    """Contact laws by name."""

    RING = "ring"
    SECTOR = "sector"


def compress_command(
    context: typer.Context,
    number: Annotated[int, typer.Option(help="Number of particles.")] = 128,
    radii: Annotated[
        tuple[float, float], typer.Option(help="Radii of small and large particles.")
    ] = (0.5, 0.7),
    fraction: Annotated[float, typer.Option(help="Number fraction of large particles.")] = 0.5,
    polydispersity: Annotated[
        float | None,
        typer.Option(
            help="Instead of two sizes, log-normal radii of mean 0.5 with this standard deviation "
            "over the mean.",
            show_default=False,
        ),
    ] = None,
    aspect: Annotated[float, typer.Option(help="Height over width of the box.")] = 1.0,
    tilt: Annotated[float, typer.Option(help="Shear of the box, xy / ly.")] = 0.0,
    seed: Annotated[int, typer.Option(help="Seed of the random start.")] = 1,
    law: Annotated[
        LawName, typer.Option(help="Contacts slip (ring) or stick (sector).")
    ] = LawName.RING,
    ka: Annotated[
        float, typer.Option("--kA", help="Area stiffness, or inf to keep the area.")
    ] = 1.0,
    kp: Annotated[
        float,
        typer.Option("--kP", help="Perimeter stiffness, or inf to keep the perimeter."),
    ] = math.inf,
    contact: Annotated[
        Lines, typer.Option(help="Contact lines geometric or where both sides press alike (ring).")
    ] = Lines.BALANCED,
    reach: Annotated[float, typer.Option(help="Range of neighbors beyond touching (ring).")] = 0.3,
    strain: Annotated[float, typer.Option(help="Linear strain in all.")] = 0.01,
    steps: Annotated[int, typer.Option(help="Number of steps.")] = 10,
    tolerance: Annotated[
        float,
        typer.Option(
            help=f"Largest force over the mean contact force, at most {LARGEST_TOLERANCE:g}."
        ),
    ] = TOLERANCE,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "compress",
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Finish the interrupted compression in the output folder. Other options may be "
            "given if they are those that it was begun with.",
        ),
    ] = False,
    further: Annotated[
        bool,
        typer.Option("--further", help="Compress the finished run in the output folder further."),
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the run in the output folder.")
    ] = False,
) -> None:
    """Jam a random packing and compress it quasistatically.

    Writes packing.data, summary.json, series.csv, trajectory.lammpstrj and, with matplotlib,
    packing.png into the output folder as the run goes.
    """
    began = time.perf_counter()
    if resume + further + overwrite > 1:
        raise ParameterError("give one of --resume, --further and --overwrite")
    check_compression(strain, steps, tolerance)
    folder = refuse(out, "compression" if resume or further or overwrite else None, _WAYS)
    if resume:
        done, whole = steps_done(folder)
        _check_same(context, folder, (*PACKING_OPTIONS, *_PROTOCOL_OPTIONS))
        states = finish(folder)
        if done >= whole:
            print_once(f"the compression in '{folder}' is complete")
            return
    elif further:
        _check_same(context, folder, PACKING_OPTIONS)
        states = compress_in(folder, load(folder), strain, steps, tolerance, append=True)
    else:
        start, contact_law = _start(context)
        if MPI.COMM_WORLD.rank == 0:
            folder.mkdir(parents=True, exist_ok=True)  # or fail before the work
        packing = jam(start)
        print_once(f"jammed at phi = {packing.phi:.5f} ({time.perf_counter() - began:.1f} s)")
        parameters = {name: context.params[name] for name in PACKING_OPTIONS}
        if law is LawName.SECTOR:
            parameters["contact"] = Lines.RADICAL
        sim = Simulation(packing, contact_law)
        states = compress_in(folder, sim, strain, steps, tolerance, parameters, overwrite=overwrite)
    first = frames_in(folder) if resume or further else 0
    _show(states, folder, first)
    print_once(f"wrote {folder} ({time.perf_counter() - began:.1f} s)")


def _show(states: Iterator[State], folder: Path, first: int) -> None:
    """A line for each state as it comes, and a picture of the last one."""
    columns = ("phi", "pressure", "energy", "coordination", "rattlers", "residual")
    print_once("step " + " ".join(f"{name:>12}" for name in columns))
    for step, state in enumerate(states, start=first + 1):
        row = state.numbers()
        print_once(f"{step:4d} " + " ".join(f"{row[name]:12.6g}" for name in columns))
    if state.root and importlib.util.find_spec("matplotlib"):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.4, 5.6), layout="constrained")
        state.plot(figure.subplots())
        figure.savefig(folder / "packing.png", dpi=150)


def _start(context: typer.Context) -> tuple[Packing, Law]:
    """The packing that is to be jammed, and its law: whatever is wrong with them shows here."""
    given = context.params
    law: Law
    if given["law"] is LawName.RING:
        law = Ring(given["ka"], given["reach"], given["kp"], contact=given["contact"].value)
    elif given["contact"] is Lines.BALANCED and _is_given(context, "contact"):
        raise ParameterError("contacts of the sector law are radical, not balanced")
    else:
        law = Sector(given["ka"], given["kp"])
    number, aspect, tilt, seed = (given[name] for name in ("number", "aspect", "tilt", "seed"))
    if given["polydispersity"] is None:
        start = bidisperse(
            number, given["radii"], given["fraction"], aspect=aspect, tilt=tilt, seed=seed
        )
    elif _is_given(context, "radii") or _is_given(context, "fraction"):
        raise ParameterError("give a polydispersity, or radii and fraction of two sizes")
    else:
        start = _log_normal(number, given["polydispersity"], aspect, tilt, seed)
    _check_aspect(start, aspect)
    return start, law


def _check_aspect(start: Packing, aspect: float) -> None:
    """Refuse a box that the largest particles fill from side to side before they jam."""
    largest = 2.0 * start.radius.max()
    limit = max(float(np.prod(start.box.diagonal())) / (2.0 * largest) ** 2, 1.0)
    if not 1.0 / limit <= aspect <= limit:
        raise ParameterError(
            f"aspect must lie between {1.0 / limit:.3g} and {limit:.3g} for {len(start)} particles,"
            f" not {aspect:g}: the box would be thinner than two of the largest"
        )


def _check_same(context: typer.Context, folder: Path, options: tuple[str, ...]) -> None:
    """Refuse options that are not what the run in a folder was begun with."""
    for name in options:
        if not _is_given(context, name):
            continue
        option = f"--{name}".replace("--ka", "--kA").replace("--kp", "--kP")
        parameters = summary_in(folder)["parameters"]
        while name not in parameters and parameters.get("before"):
            parameters = parameters["before"]  # what was compressed further was begun there
        if name not in parameters:
            raise ParameterError(f"the run in '{folder}' does not say its {option}: leave it out")
        given, saved = _plain(context.params[name]), _plain(parameters[name])
        if given != saved and str(given) != str(saved):  # JSON keeps inf as a string
            raise ParameterError(
                f"the run in '{folder}' was begun with {option} {_shown(saved)}, not "
                f"{_shown(given)}: leave it out, or name another folder"
            )


def _plain(value: object) -> object:
    """An option as JSON has it."""
    if isinstance(value, Enum):
        return value.value
    return list(value) if isinstance(value, tuple) else value


def _shown(value: object) -> str:
    """An option as it is typed."""
    if value is None:
        return "none"
    return " ".join(map(str, value)) if isinstance(value, list) else str(value)


def _log_normal(
    number: int, polydispersity: float, aspect: float, tilt: float, seed: int
) -> Packing:
    """Radii of mean 0.5 and this relative standard deviation."""
    width = positive("polydispersity", polydispersity)
    variance = math.log1p(width * width)
    return polydisperse(
        number,
        lambda rng: 0.5 * rng.lognormal(-0.5 * variance, math.sqrt(variance), number),
        aspect=aspect,
        tilt=tilt,
        seed=seed,
    )


def _is_given(context: typer.Context, name: str) -> bool:
    """Whether an option stands on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"
