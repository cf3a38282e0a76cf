"""Options of a packing in a file and of the contact law, which several commands share."""

from __future__ import annotations

from typing import Annotated

import typer

from ..laws import ALL_LAWS
from .options import choice_option

FromFile = Annotated[
    str | None,
    typer.Option(
        "--from",
        metavar="FILE",
        help="Begin with the packing in this file, as it is: LAMMPS data file or dump, extended "
        "XYZ, GSD, or what MDAnalysis reads.",
        show_default=False,
    ),
]
FromRadii = Annotated[
    str | None,
    typer.Option(
        metavar="RADII",
        help="Radii of --from: the name of a column, a number, or numbers by type as in "
        "1=0.5,2=0.7. By default those of the file.",
        show_default=False,
    ),
]
FromFrame = Annotated[
    int, typer.Option(help="Frame of --from, from 0, or from the end if negative.")
]
Dimension = Annotated[
    int | None,
    typer.Option(
        help="2, or 3: droplets in space. By default that of the law.", show_default=False
    ),
]
LawName = Annotated[
    str | None,
    choice_option(
        ALL_LAWS,
        "Contact law. Contacts slip with contact lines where the forces of both sides are "
        "equal (balanced, the default), on arcs that balance torques and pressures too (curved), "
        "or on radical axes (radical), or they stick (sector). Droplets in three dimensions "
        "(droplet) are the default there.",
    ),
]
AreaStiffness = Annotated[
    float,
    typer.Option("--kA", help="Area stiffness [energy/length^4]; inf conserves the area."),
]
PerimeterStiffness = Annotated[
    float,
    typer.Option(
        "--kP", help="Perimeter stiffness [energy/length^2]; inf conserves the perimeter."
    ),
]
Tension = Annotated[
    float,
    typer.Option(
        help="Ring laws: line tension of the perimeter at rest [energy/length], beside a "
        "finite kP; droplets have --kA inf --kP 0 --tension 1. In three dimensions surface tension "
        "[energy/length^2], 1 if not given."
    ),
]
Adhesion = Annotated[
    float,
    typer.Option(
        help="With --law curved: energy gained for each unit of length of a film between two "
        "particles [energy/length], below twice the tension."
    ),
]
Reach = Annotated[
    float | None,
    typer.Option(
        help="Ring laws: how far beyond touching neighbors count, over the sum of their radii; "
        "0.6 if not given, with radical 0.3."
    ),
]
