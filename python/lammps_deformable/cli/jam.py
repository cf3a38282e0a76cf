"""The command `deformable jam`: one packing at the onset of jamming."""

from __future__ import annotations

import math
import time
from typing import Annotated

import typer

from ..errors import ParameterError
from ..jamming import jam
from ..progress import print_once
from ..random import bidisperse
from ..simulation import Simulation
from ..store import refuse_run
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
from .options import Overwrite, is_given
from .output import draw
from .settings import Material, check_material, given_settings

# Part of a contact force that is left, so that the weakest contacts are counted.
_TOLERANCE = 1e-6


def jam_command(
    context: typer.Context,
    number: Annotated[int, typer.Option(help="Number of particles.")] = 128,
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
    pressure: Annotated[
        float,
        typer.Option(
            help="Pressure at the onset, between this and twice this, in natural units: kA R0^2 "
            "with the mean radius R0, of droplets tension/R0."
        ),
    ] = 1e-6,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "jam",
    overwrite: Overwrite = False,
) -> None:
    """Jam a random packing of two sizes, or a loose one from a file, and save it at its onset.

    The output folder is a run of one state, with packing.png if matplotlib is installed. Ensembles
    of packings: docs/jamming.md.
    """
    began = time.perf_counter()
    settings, given = given_settings(context, Material)
    check_material(settings, given)
    folder = refuse_run(out, overwrite)
    if settings.from_file is None:
        start = bidisperse(number, seed=seed, dimension=settings.dimension)
    else:
        for name in ("number", "seed"):
            if is_given(context, name):
                raise ParameterError(
                    f"the packing is that in '{from_file}', and --{name} is about a random one: "
                    "leave it out"
                )
        start = settings.packing_in_file(settings.dimension)
    contact_law = settings.contact_law()
    packing = jam(start, contact_law, pressure=pressure, tolerance=_TOLERANCE).packing
    with Simulation(packing, contact_law) as sim:
        state = sim.relax()
        state.save(folder, overwrite=overwrite)
    draw(state, folder / "packing.png")
    print_once(
        f"phi_J = {state.phi:.6g}, pressure {state.pressure:.3g}, coordination "
        f"{state.coordination:.4g}, {int(state.rattlers.sum())} rattlers"
    )
    print_once(f"wrote {folder} ({time.perf_counter() - began:.1f} s)")
