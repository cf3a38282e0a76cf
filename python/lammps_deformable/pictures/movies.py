"""Movies of a run."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from ..common.checks import expect, shown, whole
from ..common.errors import ParameterError
from ..common.files import at_home, refuse_present, replaces, written_whole
from ..common.ranks import progress
from ..particles.packing import Packing
from ..state.state import State
from .drawing import Look, new_figure
from .plot import title_of

# Pictures of a square box have 461 x 403 dots, so that a few dozen take less than a megabyte.
_DOTS_PER_INCH = 72

# Pictures per second: formats and viewers count in hundredths of a second.
_FASTEST = 100

# Settings of pictures in three dimensions; the others are for the plane.
_IN_SPACE = ("view", "slice")

# matplotlib's writers by format.
_WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}


def movie(
    states: Iterable[State],
    path: str | Path,
    mode: str = "x",
    color: str | ArrayLike = "pressures",
    contacts: bool = False,
    forces: bool = False,
    rate: int = 10,
    cmap: str | None = None,
    vmin: float | None = None,
    vmax: float | None = None,
    label: str | None = None,
    spins: bool = False,
    view: tuple[float, float] | None = None,
    slice: float | None = None,
) -> None:
    """See `Run.movie`."""
    if not 1 <= whole("rate", rate) <= _FASTEST:
        raise ParameterError(f"rate must lie between 1 and {_FASTEST}, not {shown(rate)}")
    expect("path", path, str, Path)
    expect("states", states, Iterable)
    overwrite = replaces(mode)
    name = _WRITERS.get(Path(path).suffix)
    if name is None:
        raise ParameterError(f"a movie is a .gif or an .mp4, not '{path}'")
    try:
        from matplotlib.animation import writers
    except ImportError:
        raise ImportError("movies need matplotlib: pip install lammps-deformable[plot]") from None
    if not writers.is_available(name):
        raise ParameterError(f"'{path}' needs the program ffmpeg: install it, or write a .gif")
    path = at_home(path)
    frames = list(states)
    if not frames:
        raise ParameterError("a movie needs at least one state")
    for state in frames:
        expect("a state of a movie", state, State)
    own = of_dimension(frames[0].packing.dimension, spins=spins, view=view, slice=slice)
    values = [state._values(color) for state in frames]
    look = Look(color=color, cmap=cmap, vmin=vmin, vmax=vmax, label=label)
    on = look.on(values, [state.contacts["force"] for state in frames])
    if not frames[0]._root:
        return
    refuse_present(path, overwrite)
    figure = _new_figure(frames[0].packing)

    def draw(state: State) -> None:
        figure.clear()
        drawn: dict[str, Any] = {"color": color, "contacts": contacts, "forces": forces, **own}
        drawn["title"] = title_of(state)
        state.plot(figure.subplots(), scale=on, cmap=cmap, label=label, **drawn)

    draw(frames[0])  # or fail before the file is there
    writer = writers[name](fps=rate)
    with ExitStack() as stack:
        part = stack.enter_context(written_whole(path))
        part.touch()  # or fail before the pictures are drawn
        stack.enter_context(writer.saving(figure, str(part), dpi=_DOTS_PER_INCH))
        bar = stack.enter_context(progress("drawing", unit="picture", total=len(frames)))
        for number, state in enumerate(frames):
            if number:
                draw(state)
            writer.grab_frame()
            bar.update()


def _new_figure(packing: Packing) -> Any:
    """A figure of matplotlib that fits the box."""
    if packing.dimension == 2:
        return new_figure(packing, True)
    from .plot3d import new_axes

    return new_axes().figure


def of_dimension(dimension: int, **settings: Any) -> dict[str, Any]:
    """The settings of a picture that are given, if they are for this dimension.

    Raises:
        ParameterError: one is for the other.
    """
    given = {
        name: each for name, each in settings.items() if each is not None and each is not False
    }
    for name in given:
        if (name in _IN_SPACE) != (dimension == 3):
            where = "three dimensions" if dimension == 2 else "the plane"
            raise ParameterError(f"{name} is for states in {where}: leave it out")
    return given
