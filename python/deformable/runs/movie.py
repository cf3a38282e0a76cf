"""Movies of a run."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ..common.errors import ParameterError
from ..common.progress import progress
from ..common.validate import whole
from ..state.state import State
from .replay import replay

# Pictures have 461 x 403 dots, so that a few dozen take less than a megabyte.
_DOTS_PER_INCH = 72

# matplotlib's writers by format.
_WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}


def movie(
    states: str | Path | Iterable[State],
    path: str | Path,
    color_by: str = "particle_pressure",
    contacts: bool = False,
    forces: bool = False,
    rate: int = 10,
) -> None:
    """Draw states as a movie, all with the same scale of colors and forces.

    Args:
        states: the folder of a recorded run, or states, e.g. from `compress` or `move`.
        path: of the movie, .gif, or .mp4 if ffmpeg is installed.
        color_by: see `State.plot`.
        contacts: see `State.plot`.
        forces: see `State.plot`.
        rate: pictures per second.

    Raises:
        ParameterError: the format is another, ffmpeg is missing, or there are no states or no such
            attribute.
        FileError: the folder cannot be read.
        ImportError: matplotlib is missing.
    """
    if whole("rate", rate) < 1:
        raise ParameterError(f"rate must be at least 1, not {rate}")
    name = _WRITERS.get(Path(path).suffix)
    if name is None:
        raise ParameterError(f"a movie is a .gif or an .mp4, not '{path}'")
    try:
        from matplotlib.animation import writers
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError("movies need matplotlib: pip install lammps-deformable[plot]") from None
    if not writers.is_available(name):
        raise ParameterError(f"'{path}' needs the program ffmpeg: install it, or write a .gif")
    from ..state.plot import scale

    shown = list(replay(states) if isinstance(states, (str, Path)) else states)
    if not shown:
        raise ParameterError("a movie needs at least one state")
    on = scale(
        [state.values(color_by) for state in shown],
        [state.contact_table["force"] for state in shown],
        color_by,
    )
    if not shown[0].root:
        return
    figure = Figure(figsize=(6.4, 5.6), layout="constrained")
    writer = writers[name](fps=rate)
    with (
        writer.saving(figure, str(path), dpi=_DOTS_PER_INCH),
        progress("drawing", unit="picture", total=len(shown)) as bar,
    ):
        for state in shown:
            figure.clear()
            state.plot(figure.subplots(), color_by, contacts, forces, on)
            writer.grab_frame()
            bar.update()
