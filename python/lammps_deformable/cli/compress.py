"""The command `deformable compress`: jam a packing, compress it, keep the run in a folder."""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Annotated

import typer
from mpi4py import MPI

from .._files import make_folder
from ..compression import check_target
from ..errors import ParameterError
from ..jamming import jam
from ..progress import print_once
from ..recording import check_tolerance
from ..relax import TOLERANCE
from ..run import Run
from ..simulation import Simulation
from ..store import refuse
from .material_options import (
    Adhesion,
    AreaStiffness,
    Dimension,
    FromFile,
    FromFrame,
    FromRadii,
    LawName,
    PerimeterStiffness,
    Reach,
    Tension,
)
from .options import Overwrite, Resume, Tolerance
from .output import draw, printing
from .settings import PROTOCOL, Settings, check_same, check_together, given_settings

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
    aspect: Annotated[
        float, typer.Option(help="Height over width of the box, ly / lx or lz / lx.")
    ] = 1.0,
    tilt: Annotated[float, typer.Option(help="Shear of the box, xy / ly.")] = 0.0,
    seed: Annotated[int, typer.Option(help="Seed of the random start.")] = 1,
    from_file: FromFile = None,
    from_radii: FromRadii = None,
    from_frame: FromFrame = -1,
    law: LawName = None,
    dimension: Dimension = None,
    kA: AreaStiffness = 1.0,
    kP: PerimeterStiffness = math.inf,
    tension: Tension = 0.0,
    adhesion: Adhesion = 0.0,
    reach: Reach = None,
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
            help="Compress or expand to this pressure [energy/length^2, energy/length^3].",
            show_default=False,
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
    settings, given = given_settings(context, Settings)
    if resume + append + overwrite > 1:
        raise ParameterError("give one of --resume, --append and --overwrite")
    replaced = resume or append or overwrite
    folder = refuse(out, "compression" if replaced else None, _WAYS_OUT)
    if resume:
        check_same(folder, given)
        done = Run(folder).steps_done or 0
        run = Run(folder).resume(callback=printing(done, _COLUMNS))
    elif append:
        check_same(folder, {name: given[name] for name in given if name not in PROTOCOL})
        done = len(Run(folder)) - 1
        run = (
            Run(folder)
            .simulation()
            .compress(
                steps=steps,
                tolerance=tolerance,
                record=folder,
                mode="a",
                callback=printing(max(done, 0), _COLUMNS),
                **settings.target,
            )
        )
        done = 0
    else:
        check_together(settings, given)
        run, done = _begin(folder, settings, overwrite), 0
    if resume and run.steps_done == done:
        print_once(f"the compression in '{folder}' is complete")
    else:
        draw(run[-1], folder / "packing.png")
        print_once(f"wrote {folder} ({time.perf_counter() - began:.1f} s)")


def _begin(folder: Path, settings: Settings, overwrite: bool) -> Run:
    """Jam or read a packing and compress it; errors of the settings come before any work."""
    began = time.perf_counter()
    check_target(None, settings.steps, **settings.target)
    check_tolerance(settings.tolerance)
    law, in_file = settings.contact_law(), settings.from_file is not None
    start = settings.packing_in_file(settings.dimension) if in_file else settings.random_start()
    if MPI.COMM_WORLD.rank == 0:
        make_folder(folder)
    packing = start if in_file else jam(start)
    begun = f"{len(packing)} particles" if in_file else "jammed"
    print_once(f"{begun} at phi = {packing.phi:.5f} ({time.perf_counter() - began:.1f} s)")
    return Simulation(packing, law).compress(
        steps=settings.steps,
        tolerance=settings.tolerance,
        record=folder,
        mode="w" if overwrite else "x",
        callback=printing(0, _COLUMNS),
        parameters=settings.parameters,
        **settings.target,
    )
