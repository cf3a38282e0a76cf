"""The command `deformable compress`: jam a packing, compress it, keep the run in a folder."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

import typer
from mpi4py import MPI

from ..common.errors import ParameterError
from ..common.files import make_folder
from ..common.progress import print_once
from ..engine.relaxation import TOLERANCE
from ..engine.simulation import Simulation
from ..io.run_folder import refuse
from ..model.laws import LAWS
from ..protocols.jamming import jam
from ..runs.recording import compress_in, compression
from ..runs.run import Run
from ..state.state import State
from .options import Overwrite, Resume, Tolerance, choice_option, is_given
from .output import draw, print_states
from .settings import PROTOCOL, Settings, check_same, check_together

_WAYS_OUT = (
    "finish it with --resume",
    "compress it further with --append",
    "replace it with --overwrite",
)

# What is printed of each state.
_COLUMNS = ("phi", "pressure", "energy", "coordination", "rattlers", "residual")


def compress_command(
    context: typer.Context,
    number: Annotated[int, typer.Option(help="Number of particles.")] = 128,
    radii: Annotated[
        tuple[float, float],
        typer.Option(metavar="SMALL LARGE", help="Radii of small and large particles [length]."),
    ] = (0.5, 0.7),
    fraction: Annotated[float, typer.Option(help="Number fraction of large particles.")] = 0.5,
    polydispersity: Annotated[
        float | None,
        typer.Option(
            help="Standard deviation over mean of log-normal radii of mean 0.5, in place of two "
            "sizes.",
            show_default=False,
        ),
    ] = None,
    aspect: Annotated[float, typer.Option(help="Height over width of the box.")] = 1.0,
    tilt: Annotated[float, typer.Option(help="Shear of the box, xy / ly.")] = 0.0,
    seed: Annotated[int, typer.Option(help="Seed of the random start.")] = 1,
    from_file: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="FILE",
            help="Begin with the packing in this file, as it is, in place of a random one: LAMMPS "
            "data file or dump, extended XYZ, GSD, or what MDAnalysis reads.",
            show_default=False,
        ),
    ] = None,
    from_radii: Annotated[
        str | None,
        typer.Option(
            metavar="RADII",
            help="Radii of --from: the name of a column, a number, or numbers by type as in "
            "1=0.5,2=0.7. By default those of the file.",
            show_default=False,
        ),
    ] = None,
    from_frame: Annotated[
        int, typer.Option(help="Frame of --from, from 0, or from the end if negative.")
    ] = -1,
    law: Annotated[
        str,
        choice_option(
            LAWS,
            "Contact law. Contacts slip with contact lines where the forces of both sides are "
            "equal (balanced), on arcs that balance torques and pressures too (curved), or on "
            "radical axes (radical), or they stick (sector).",
        ),
    ] = "balanced",
    kA: Annotated[
        float,
        typer.Option("--kA", help="Area stiffness [energy/length^4]; inf conserves the area."),
    ] = 1.0,
    kP: Annotated[
        float,
        typer.Option(
            "--kP", help="Perimeter stiffness [energy/length^2]; inf conserves the perimeter."
        ),
    ] = math.inf,
    tension: Annotated[
        float,
        typer.Option(
            help="Ring laws: line tension of the perimeter at rest [energy/length], beside a "
            "finite kP; droplets have --kA inf --kP 0 --tension 1."
        ),
    ] = 0.0,
    adhesion: Annotated[
        float,
        typer.Option(
            help="With --law curved: energy gained for each unit of length of a film between two "
            "particles [energy/length], below twice the tension."
        ),
    ] = 0.0,
    reach: Annotated[
        float | None,
        typer.Option(
            help="Ring laws: how far beyond touching neighbors count, over the sum of their radii; "
            "0.6 if not given, with radical 0.3."
        ),
    ] = None,
    strain: Annotated[
        float | None,
        typer.Option(
            help="Linear strain of all steps together; negative expands. 0.01 if neither this nor "
            "--phi nor --pressure is given.",
            show_default=False,
        ),
    ] = None,
    phi: Annotated[
        float | None,
        typer.Option(help="Compress or expand to this packing fraction.", show_default=False),
    ] = None,
    pressure: Annotated[
        float | None,
        typer.Option(
            help="Compress or expand to this pressure [energy/length^2].", show_default=False
        ),
    ] = None,
    steps: Annotated[int, typer.Option(help="Number of steps.")] = 10,
    tolerance: Tolerance = TOLERANCE,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "compress",
    resume: Resume = False,
    append: Annotated[
        bool,
        typer.Option("--append", help="Compress the finished run in the output folder further."),
    ] = False,
    overwrite: Overwrite = False,
) -> None:
    """Jam a random packing, or take one from a file, and compress it quasistatically.

    Writes packing.data, summary.json, series.csv and trajectory.lammpstrj into the output folder,
    for the packing before the first step and after each step, and packing.png at the end if
    matplotlib is installed.
    """
    began = time.perf_counter()
    settings, given = _settings(context)
    if resume + append + overwrite > 1:
        raise ParameterError("give one of --resume, --append and --overwrite")
    replaced = resume or append or overwrite
    folder = refuse(out, "compression" if replaced else None, _WAYS_OUT)
    if resume:
        check_same(folder, given)
        states = Run(folder).resume()
    elif append:
        check_same(folder, {name: given[name] for name in given if name not in PROTOCOL})
        states = Run(folder).compress(steps=steps, tolerance=tolerance, **settings.target)
    else:
        check_together(settings, given)
        states = _begin(folder, settings, overwrite)
    done = max(len(Run(folder)) - 1, 0) if resume or append else 0
    last = print_states(states, done, _COLUMNS)
    if last is None:
        print_once(f"the compression in '{folder}' is complete")
    else:
        draw(last, folder / "packing.png")
        print_once(f"wrote {folder} ({time.perf_counter() - began:.1f} s)")


def _settings(context: typer.Context) -> tuple[Settings, dict[str, Any]]:
    """The settings of the run, and those of them that are given on the command line."""
    values = {field.name: context.params[field.name] for field in fields(Settings)}
    return Settings(**values), {name: values[name] for name in values if is_given(context, name)}


def _begin(folder: Path, settings: Settings, overwrite: bool) -> Iterator[State]:
    """Jam or read a packing and compress it; errors of the settings come before any work."""
    began = time.perf_counter()
    compression(settings.steps, settings.tolerance, **settings.target)
    law, in_file = settings.contact_law(), settings.from_file is not None
    start = settings.packing_in_file() if in_file else settings.random_start()
    if MPI.COMM_WORLD.rank == 0:
        make_folder(folder)
    packing = start if in_file else jam(start)
    begun = f"{len(packing)} particles" if in_file else "jammed"
    print_once(f"{begun} at phi = {packing.phi:.5f} ({time.perf_counter() - began:.1f} s)")
    return compress_in(
        Simulation(packing, law),
        folder,
        steps=settings.steps,
        tolerance=settings.tolerance,
        parameters=settings.parameters,
        overwrite=overwrite,
        **settings.target,
    )
