"""The commands `deformable plot` and `deformable movie`: pictures of the frames of a run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ParameterError
from ..movies import of_dimension
from ..progress import print_once
from ..run import Run
from ..state import State
from ..versions import optional
from .options import refuse_ranks
from .output import DOTS

Recorded = Annotated[Path, typer.Argument(help="Folder of a run, e.g. of `deformable compress`.")]
ColorBy = Annotated[str, typer.Option(help="Quantity of the particles, e.g. shape_parameter.")]
ColorMap = Annotated[
    str | None,
    typer.Option(
        help="Color map of matplotlib; without, one for the signs of the values.",
        show_default=False,
    ),
]
FirstColor = Annotated[
    float | None, typer.Option(help="Value of the first color.", show_default=False)
]
LastColor = Annotated[
    float | None, typer.Option(help="Value of the last color.", show_default=False)
]
Contacts = Annotated[bool, typer.Option("--contacts", help="Draw the contacts.")]
Forces = Annotated[bool, typer.Option("--forces", help="Draw the force chains.")]
View = Annotated[
    tuple[float, float] | None,
    typer.Option(
        metavar="ELEVATION AZIMUTH",
        help="Of the viewer, in three dimensions [degree].",
        show_default=False,
    ),
]
Slice = Annotated[
    float | None,
    typer.Option(
        help="In three dimensions: draw what the plane at this z cuts [length].", show_default=False
    ),
]
Spins = Annotated[bool, typer.Option("--spins", help="Draw the spins, with friction.")]


def check_picture(out: Path) -> None:
    """Refuse a file that is no picture of matplotlib."""
    optional("matplotlib", "plot")
    from matplotlib.figure import Figure

    formats = Figure().canvas.get_supported_filetypes()
    if out.suffix.removeprefix(".") not in formats:
        raise ParameterError(f"a picture is one of .{', .'.join(formats)}, not '{out}'")


def draw(state: State, out: Path, color_by: str, own: Mapping[str, Any], **settings: Any) -> None:
    """Draw a state into a picture that fits its box; settings as of `State.plot`.

    Args:
        own: settings of one dimension, of which some may not be given.
    """
    settings |= of_dimension(state.packing.dimension, **own)
    figure: Any = state.plot(color=color_by, **settings).figure
    figure.savefig(out, dpi=DOTS)
    print_once(f"wrote {out}")


def plot_command(
    run: Recorded,
    out: Annotated[Path, typer.Option(metavar="PATH", help="Picture, .png, .pdf or .svg.")] = Path(
        "packing.png"
    ),
    frame: Annotated[
        int | None,
        typer.Option(
            help="Number of the frame, from 0; -1 is the last one. Without, the saved state.",
            show_default=False,
        ),
    ] = None,
    color_by: ColorBy = "pressures",
    cmap: ColorMap = None,
    vmin: FirstColor = None,
    vmax: LastColor = None,
    title: Annotated[
        str | None, typer.Option(help="Title; by default phi and pressure.", show_default=False)
    ] = None,
    contacts: Contacts = False,
    forces: Forces = False,
    spins: Spins = False,
    view: View = None,
    slice: Slice = None,
) -> None:
    """Draw a state of a run."""
    refuse_ranks("a picture is drawn by one process")
    check_picture(out)
    if frame is None:
        with Run(run).simulation() as sim:
            state = sim.state()
    else:
        try:
            state = Run(run)[frame]
        except IndexError as error:
            raise ParameterError(str(error)) from None
    colors = {"cmap": cmap, "vmin": vmin, "vmax": vmax, "title": title}
    drawn = {"contacts": contacts, "forces": forces}
    own = {"spins": spins, "view": view, "slice": slice}
    draw(state, out, color_by, own, **drawn, **colors)


def movie_command(
    run: Recorded,
    out: Annotated[Path, typer.Option(metavar="PATH", help="Movie, .gif or .mp4.")] = Path(
        "movie.gif"
    ),
    color_by: ColorBy = "pressures",
    cmap: ColorMap = None,
    vmin: FirstColor = None,
    vmax: LastColor = None,
    contacts: Contacts = False,
    forces: Forces = False,
    spins: Spins = False,
    view: View = None,
    slice: Slice = None,
    rate: Annotated[int, typer.Option(help="Pictures per second.")] = 10,
) -> None:
    """Draw each state of a recorded run as a movie."""
    refuse_ranks("a movie is drawn by one process")
    colors = {"color": color_by, "cmap": cmap, "vmin": vmin, "vmax": vmax}
    drawn = {"contacts": contacts, "forces": forces, "spins": spins, "view": view, "slice": slice}
    Run(run).movie(out, rate=rate, **drawn, **colors)
    print_once(f"wrote {out}")
