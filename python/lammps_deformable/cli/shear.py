"""The command `deformable shear`: shear the packing of a run or file, keep the new run."""

from __future__ import annotations

import math
import time
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ParameterError
from ..progress import print_once
from ..relax import TOLERANCE
from ..run import Run
from ..simulation import Deforming, Simulation
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
from .options import Overwrite, Resume, Tolerance, is_given
from .output import draw, printing
from .settings import Material, check_material, check_same, given_settings, option

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
        float,
        typer.Option(help="Shear strain of all steps together; negative shears the other way."),
    ] = 0.1,
    steps: Annotated[int, typer.Option(help="Number of steps.")] = 20,
    tolerance: Tolerance = TOLERANCE,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "shear",
    resume: Resume = False,
    overwrite: Overwrite = False,
) -> None:
    """Shear the last packing of a run, or one from a file, quasistatically along x.

    A run has its law; options of the law are for a packing from a file.

    Writes the same files as `deformable compress` into the output folder, for the packing before
    the first step and after each step. The column strain of series.csv is the shear strain, and
    shear_stress the stress that resists.
    """
    began = time.perf_counter()
    if resume and overwrite:
        raise ParameterError("give one of --resume and --overwrite")
    material, given = given_settings(context, Material)
    folder = refuse(out, "compression" if resume or overwrite else None, _WAYS_OUT)
    if resume:
        settings = {"strain": strain, "steps": steps, "tolerance": tolerance}
        again = {name: settings[name] for name in settings if is_given(context, name)}
        check_same(folder, again | given)
        done = Run(folder).steps_done or 0
        sheared = Run(folder).resume(callback=printing(done, _COLUMNS))
    else:
        sim, parameters = _begin(run, folder, material, given)
        done, sheared = (
            0,
            sim.shear(
                strain,
                steps=steps,
                tolerance=tolerance,
                record=folder,
                mode="w" if overwrite else "x",
                callback=printing(0, _COLUMNS),
                parameters=parameters,
            ),
        )
    if resume and sheared.steps_done == done:
        print_once(f"the shear in '{folder}' is complete")
    else:
        draw(sheared[-1], folder / "packing.png")
        print_once(f"wrote {folder} ({time.perf_counter() - began:.1f} s)")


def _begin(
    run: Path | None, folder: Path, material: Material, given: dict[str, Any]
) -> tuple[Deforming[Any], dict[str, Any]]:
    """What is sheared, and the parameters that tell where it comes from."""
    if material.from_file is not None:
        if run is not None:
            raise ParameterError(f"give the folder '{run}' of a run, or --from, not both")
        check_material(material, given)
        packing, contact_law = material.packing_in_file(material.dimension), material.contact_law()
        return Simulation(packing, contact_law), asdict(material)
    if run is None:
        raise ParameterError(
            "give the folder of a run, whose packing is sheared, shear RUN, or --from FILE"
        )
    if given:
        raise ParameterError(
            f"{option(next(iter(given)))} is about the packing in a file, and a run has its own "
            "law: leave it out, or give --from FILE in the place of a run"
        )
    if folder.resolve() == run.resolve():
        raise ParameterError(f"'{run}' is the folder of the packing: give another one to --out")
    return Run(run).simulation(), {"before": Run(run).parameters}
