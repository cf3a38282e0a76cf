"""Pictures of a state in the plane: outlines, contacts and forces; values as colors.

`plot3d` draws states in space.
"""

from __future__ import annotations

import base64
import html
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..core import unit_vectors
from ..particles.laws import Ring, Sector, SoftContact
from ..state.contacts import ContactTable, chords, flats_of, forces_of, halves
from ..state.recorded import particle_values

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from ..particles.packing import Packing
    from ..state.state import State
    from .drawing import Halves, Look, Mark


Floats = NDArray[np.float64]


# Names for colors that a message lists, beside those of `particle_values`.
_NAMES = ("area_deficit", "volumes", "pressures", "rattlers", "shape_parameter")


def values_of(state: State, color_by: str | ArrayLike) -> Floats:
    """See `State._values`."""
    from .drawing import per_particle

    columns = particle_values(state)
    found: Any = color_by
    if isinstance(color_by, str):
        found = columns.get(color_by, getattr(state, color_by, None))
    names = {name for name in _NAMES if hasattr(state, name)}
    return per_particle(color_by, found, len(state.packing), {*columns, *names})


def title_of(state: State) -> str:
    """phi and pressure, the title of pictures of a run."""
    return f"$\\phi$ = {state.phi:.4f},  $p$ = {state.pressure:.3g}"


def in_notebook(state: State) -> str | None:
    """The picture and the line of `repr`, for notebooks; None without matplotlib."""
    if not find_spec("matplotlib"):
        return None
    figure: Any = state.plot().figure
    line = html.escape(repr(state).strip("<>"))
    coded = base64.b64encode(figure._repr_png_()).decode()
    return f'<img src="data:image/png;base64,{coded}" alt="{line}"><br>{line}'


def halves_of(state: State) -> list[Halves]:
    """Where the contacts of each particle are, (m, 2), and their forces, (m,)."""
    if isinstance(state.law, Ring | Sector):
        return [(table["position"], table["force"]) for table in state._contacts_of_each]
    return halves(state.packing, forces_of(state))


def _flats(state: State) -> list[list[Floats]]:
    """Contacts of each particle as lines, arrays of shape (m, 2) [length]."""
    if isinstance(state.law, SoftContact):
        return chords(state.packing, forces_of(state))
    if not isinstance(state.law, Ring | Sector):
        raise ParameterError("contacts of polygons have no lines to draw: draw their forces")
    return flats_of(state.outlines, state.packing.radii, state._contacts_of_each)


# Colors of contacts that slide and stick, and their width [points].
_SLIDES, _STICKS, _CONTACT = "lime", "orangered", 2.0

# Length of the bar of a friction that is as large as the force, over the radius.
_BAR = 1.0

# An arrow of a spin: its radius over that of the particle, the angle of the fastest one, the size
# of its head over its radius, the points of its arc; widths and colors, first the lower one.
_PLACE, _FASTEST, _HEAD, _POINTS = 0.45, 1.6 * np.pi, 0.45, 24
_ARROW = ((2.8, "white"), (1.0, "black"))

# Spins below this part of the fastest one are not drawn.
_SLOW = 0.02


def sliding_contacts(
    outlines: Sequence[Floats], packing: Packing, tables: Sequence[ContactTable]
) -> Mark:
    """The contacts that slide, as the outlines share them."""
    from .drawing import Mark

    sliding = [table[table["sliding"]] for table in tables]
    lines = flats_of(outlines, packing.radii, sliding)
    return Mark(lines, [[_CONTACT] * len(each) for each in lines], _SLIDES)


def friction_bars(packing: Packing, tables: Sequence[ContactTable]) -> list[Mark]:
    """A bar along each contact, the longer the larger its friction is, compared with its force."""
    from .drawing import Mark

    marks = []
    for slides, color in ((False, _STICKS), (True, _SLIDES)):
        lines, widths = [], []
        for radius, table in zip(packing.radii, tables, strict=True):
            rows = table[(table["sliding"] == slides) & (table["friction"] != 0.0)]
            part = np.minimum(np.abs(rows["friction"] / rows["force"]), 1.0)
            across = 0.5 * _BAR * radius * part[:, None] * unit_vectors(rows["angle"] + 0.5 * np.pi)
            ends = np.stack([rows["position"] - across, rows["position"] + across], axis=1)
            lines.append(list(ends))
            widths.append([_CONTACT] * len(rows))
        marks.append(Mark(lines, widths, color))
    return marks


def spin_arrows(packing: Packing, spins: Floats) -> list[Mark]:
    """An arc with a head in each particle, the longer the faster it turns; none in slow ones."""
    from .drawing import Mark

    fastest = float(np.abs(spins).max(initial=0.0)) or 1.0
    arrows = [
        _arrow(center, _PLACE * radius, _FASTEST * spin / fastest)
        if abs(spin) > _SLOW * fastest
        else []
        for center, radius, spin in zip(packing.positions, packing.radii, spins, strict=True)
    ]
    return [
        Mark(arrows, [[width] * len(each) for each in arrows], color) for width, color in _ARROW
    ]


def _arrow(center: Floats, radius: float, angle: float) -> list[Floats]:
    """An arc from above by this angle, positive to the left, and the head at its end."""
    arc = center + radius * unit_vectors(0.5 * np.pi + angle * np.linspace(0.0, 1.0, _POINTS))
    back = 0.5 * np.pi + angle - np.copysign(0.5 * np.pi, angle)
    head = min(_HEAD, abs(angle)) * radius * unit_vectors(np.array([back - 0.5, back, back + 0.5]))
    head[1] = 0.0
    return [arc, arc[-1] + head]


def _marks(state: State, contacts: bool, forces: bool, spins: bool) -> list[Mark]:
    """What friction adds to these parts of a picture.

    Raises:
        ParameterError: there are no spins to draw.
    """
    if state.rubbing is None:
        if spins:
            raise ParameterError("there are no spins: give the simulation a friction")
        return []
    packing, tables = state.packing, state._contacts_of_each
    marks = [sliding_contacts(state.outlines, packing, tables)] if contacts else []
    marks += friction_bars(packing, tables) if forces else []
    return marks + (spin_arrows(packing, state.rubbing.spins) if spins else [])


def plot(
    state: State, ax: Axes | None, look: Look, contacts: bool, forces: bool, spins: bool
) -> Axes:
    """See `State.plot`, of a state in the plane."""
    from . import drawing

    return drawing.draw(
        state.packing,
        state.outlines,
        values_of(state, look.color),
        look,
        ax,
        _flats(state) if contacts else None,
        halves_of(state) if forces else None,
        _marks(state, contacts, forces, spins),
    )
