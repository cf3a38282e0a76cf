"""The command `deformable report`: error against run time for a packing that the user names."""

from __future__ import annotations

import time
from typing import Annotated

import typer

from ..errors import ParameterError
from ..jamming import jam
from ..progress import print_once
from ..random import bidisperse
from .material_options import FromFile, FromFrame, FromRadii
from .options import is_given, refuse_ranks
from .settings import FILE, InFile, check_in_file


def report_command(
    context: typer.Context,
    number: Annotated[int, typer.Option(help="Number of particles.")] = 16,
    seed: Annotated[int, typer.Option(help="Seed of the random start.")] = 1,
    from_file: FromFile = None,
    from_radii: FromRadii = None,
    from_frame: FromFrame = -1,
    strain: Annotated[float, typer.Option(help="Linear strain of all steps together.")] = 0.02,
    steps: Annotated[int, typer.Option(help="Number of steps.")] = 2,
    vertices: Annotated[
        str,
        typer.Option(
            metavar="N,N,...",
            help="Vertices of the smallest smooth polygons; the most are the reference.",
        ),
    ] = "38,57,76",
    beads: Annotated[
        str, typer.Option(metavar="N,N,...", help="Beads of bead polygons, which interlock.")
    ] = "",
    workers: Annotated[
        int | None, typer.Option(help="Methods at a time; by default one a core.")
    ] = None,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "report",
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the report in the output folder.")
    ] = False,
) -> None:
    """Measure errors of the contact laws and of polygons against their run times.

    A random packing of two sizes is jammed; one from a file is to be at the onset of jamming. Each
    method compresses it and relaxes on its own. Writes report.json, report.csv and, if matplotlib
    is installed, error_against_time.png. An interrupted report goes on when the command is
    repeated. Errors are those against the finest polygons: more of them tell more. Seconds are
    processor time.
    """
    refuse_ranks("report times one core")
    from ..report import write_report

    began = time.perf_counter()
    in_file = InFile(from_file, from_radii, from_frame)
    given = [name for name in ("number", "seed", *FILE) if is_given(context, name)]
    check_in_file(in_file, given)
    counts = {"vertices": _counts("vertices", vertices), "beads": _counts("beads", beads)}
    if not counts["vertices"]:
        raise ParameterError("vertices must have a number at least")
    if from_file is None:
        origin = {"number": number, "seed": seed}
        start = jam(bidisperse(number, seed=seed)).packing
    elif given[0] in ("number", "seed"):
        raise ParameterError(
            f"the packing is that in '{from_file}', and --{given[0]} is about a random one: leave "
            "it out"
        )
    else:
        origin = vars(in_file)
        start = in_file.packing_in_file(2)
    settings = counts | {"strain": strain, "steps": steps}
    found = write_report(
        out, start, overwrite=overwrite, parameters=origin | settings, workers=workers, **settings
    )
    print_once(str(found))
    print_once(f"wrote {out} ({time.perf_counter() - began:.0f} s)")


def _counts(name: str, words: str) -> list[int]:
    try:
        return [int(word) for word in words.split(",") if word]
    except ValueError:
        raise ParameterError(f"{name} must be whole numbers such as 38,57, not {words}") from None
