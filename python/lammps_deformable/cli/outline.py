"""The command `deformable outline`: shapes of the particles in a dump."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..laws import ALL_LAWS
from ..progress import print_once
from ..run import state_in_file
from .options import choice_option, refuse_ranks
from .plot import (
    ColorBy,
    Contacts,
    FirstColor,
    Forces,
    LastColor,
    Slice,
    View,
    check_picture,
    draw,
)

# Files of polygons; all others are pictures.
_POLYGONS = (".vtp", ".geojson")


def outline_command(
    dump: Annotated[
        Path, typer.Argument(help="LAMMPS dump, or another file of particles in a periodic box.")
    ],
    species: Annotated[
        str,
        typer.Option(metavar="FILE", help="Species file of pair_coeff, or one of the package."),
    ],
    law: Annotated[
        str | None,
        choice_option(
            ALL_LAWS, "Contact law; by default that of the run with these files, or balanced."
        ),
    ] = None,
    types: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,NAME,...",
            help="Species of atom types 1, 2, ..., as in pair_coeff; by default those of the file "
            "in their order.",
            show_default=False,
        ),
    ] = None,
    frame: Annotated[
        int, typer.Option(help="Number of the frame, from 0; -1 is the last one.")
    ] = -1,
    radii: Annotated[
        str | None,
        typer.Option(
            metavar="COLUMN",
            help="Column of the dump with the radius of each particle; by default radii are those "
            "of the species.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="PATH",
            help="Picture (.png, .pdf, .svg) or shapes (.vtp, .geojson); may be repeated. By "
            "default outlines.png and outlines.vtp.",
            show_default=False,
        ),
    ] = None,
    color_by: ColorBy = "pressures",
    vmin: FirstColor = None,
    vmax: LastColor = None,
    contacts: Contacts = False,
    forces: Forces = False,
    view: View = None,
    slice: Slice = None,
) -> None:
    """Write the outlines of particles in a dump, made by LAMMPS alone.

    With --law droplet the dump is of three dimensions, and the .vtp has droplets with facets.
    """
    refuse_ranks("outlines are written by one process")
    paths = out or [Path("outlines.png"), Path("outlines.vtp")]
    pictures = [path for path in paths if path.suffix not in _POLYGONS]
    for path in pictures:
        check_picture(path)
    names = None if types is None else types.split(",")
    state = state_in_file(dump, species, law, names, frame, radii)
    if law is None:
        print_once(f"contact law {state.law.name}: give --law for another")
    for path in paths:
        if path in pictures:
            colors = {"vmin": vmin, "vmax": vmax}
            own = {"view": view, "slice": slice}
            draw(state, path, color_by, own, contacts=contacts, forces=forces, **colors)
        else:
            state.export(path, mode="w")
            print_once(f"wrote {path}")
