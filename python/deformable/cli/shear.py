"""The command `deformable shear`: shear the packing of a run, keep the new run in a folder."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from ..common.errors import ParameterError
from ..common.progress import print_once
from ..engine.relaxation import TOLERANCE
from ..io.run_folder import refuse
from ..runs.recording import shear_in
from ..runs.run import Run
from .options import Overwrite, Resume, Tolerance, is_given
from .output import draw, print_states
from .settings import check_same

_WAYS_OUT = ("finish it with --resume", "replace it with --overwrite")

# What is printed of each state; the stress is positive if it resists.
_COLUMNS = ("strain", "shear_stress", "pressure", "energy", "coordination", "rattlers", "residual")


def shear_command(
    context: typer.Context,
    run: Annotated[
        Path | None,
        typer.Argument(
            help="Folder of a run, e.g. of `deformable compress`; its last packing is sheared."
        ),
    ] = None,
    strain: Annotated[
        float,
        typer.Option(help="Shear strain of all steps together; negative shears the other way."),
    ] = 0.1,
    steps: Annotated[int, typer.Option(help="Number of steps.")] = 20,
    tolerance: Tolerance = TOLERANCE,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "shear",
    resume: Resume = False,
    overwrite: Overwrite = False,
) -> None:
    """Shear the last packing of a run quasistatically along x.

    Writes the same files as `deformable compress` into the output folder, for the packing before
    the first step and after each step. The column strain of series.csv is the shear strain, and
    shear_stress the stress that resists.
    """
    began = time.perf_counter()
    if resume and overwrite:
        raise ParameterError("give one of --resume and --overwrite")
    folder = refuse(out, "compression" if resume or overwrite else None, _WAYS_OUT)
    if resume:
        settings = {"strain": strain, "steps": steps, "tolerance": tolerance}
        check_same(folder, {name: settings[name] for name in settings if is_given(context, name)})
        states = Run(folder).resume()
    elif run is None:
        raise ParameterError("give the folder of a run, whose packing is sheared: shear RUN")
    elif folder.resolve() == run.resolve():
        raise ParameterError(f"'{run}' is the folder of the packing: give another one to --out")
    else:
        before = {"before": Run(run).parameters}
        sim = Run(run).simulation()
        states = shear_in(sim, folder, strain, steps, tolerance, before, overwrite)
    done = Run(folder).steps_done if resume else None
    last = print_states(states, done or 0, _COLUMNS)
    if last is None:
        print_once(f"the shear in '{folder}' is complete")
    else:
        draw(last, folder / "packing.png")
        print_once(f"wrote {folder} ({time.perf_counter() - began:.1f} s)")
