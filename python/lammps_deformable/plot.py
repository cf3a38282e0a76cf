"""The contacts of deformable particles, as pictures show them.

Outlines of a state, and lines parallel to them.

What pictures in the plane and in space have in common: values as colors, labels, notebooks.

Pictures of a state, of deformable particles or of soft disks.
"""

from __future__ import annotations

import base64
import html
from abc import ABC, abstractmethod
from functools import cached_property
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import drawing
from ._checks import count, expect, numbers
from .drawing import Mark, Scale, limited, per_particle
from .errors import ParameterError
from .laws import Law, refuse_adhesion
from .versions import optional

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from .contacts import ContactTable
    from .drawing import Halves
    from .packing import Packing


Floats = NDArray[np.float64]

# Points of an outline closer to the chord of a contact than this, over R, are its ends: forces are
# balanced to 1e-8, and an arc has left the line within 1e-4 R.
_ON_LINE = 1e-7


def flats_of(
    outlines: Sequence[Floats], radii: Floats, contacts: Sequence[ContactTable]
) -> list[list[Floats]]:
    """The part of each outline at its contacts, a straight line or an arc, arrays (m, 2)."""
    flats: list[list[Floats]] = []
    for outline, radius, table in zip(outlines, radii, contacts, strict=True):
        table = table[table["length"] > 0.0]
        out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
        half = 0.5 * table["length"] * np.sinc(table["half_angle"] / np.pi)  # of the chord
        height = np.sum(table["position"] * out, axis=1) - half * np.tan(0.5 * table["half_angle"])
        inward = height - outline @ out.T
        along = outline @ (out[:, ::-1] * [-1.0, 1.0]).T
        flats.append([])
        for off, place in zip(np.abs(inward).T, along.T, strict=True):
            if (on := np.flatnonzero(off <= _ON_LINE * radius)).size:
                begin, end = on[place[on].argmin()], on[place[on].argmax()]
                flats[-1].append(np.roll(outline, -begin, 0)[: (end - begin) % len(outline) + 1])
    return flats


class Parallels:
    """Lines parallel to the outlines of a `State`."""

    packing: Packing
    law: Law
    contact_table: ContactTable

    def parallels(
        self,
        inset: NDArray[np.float64] | None = None,
        points: int = 180,
        same_area: bool = False,
    ) -> list[NDArray[np.float64]]:
        """Lines parallel to the outlines, about each particle's center, arrays (m, 2) [length].

        Args:
            inset: distance inward from each outline, shape (N,) [length]; 0 if not given.
            points: number of points on a whole turn.
            same_area: move points between contacts a little outward, see `core.outline`.

        Raises:
            ParameterError: a value is out of range, or there is an inset where particles stick.
        """
        inset = np.zeros(len(self.packing)) if inset is None else numbers("inset", inset)
        if inset.shape != (len(self.packing),):
            raise ParameterError(f"inset must have shape ({len(self.packing)},), not {inset.shape}")
        count("points", points)
        if inset.any():
            why = ", and a line parallel to an outline does not end where a film does"
            refuse_adhesion(self.law, self.packing.walls, why)
        lines = ("force", "half_angle", "contact_angle") if self.law.name == "curved" else ()
        return [
            self.law.outline(
                kind,
                radius,
                rows["angle"],
                rows["indentation"],
                distance,
                points,
                same_area,
                **{name: rows[name] for name in lines},
            )
            for kind, radius, distance, rows in zip(
                self.packing.species,
                self.packing.radii,
                inset,
                self.contact_tables,
                strict=True,
            )
        ]

    @cached_property
    def contact_tables(self) -> list[ContactTable]:
        """The rows of `contact_table` of each particle."""
        first = np.searchsorted(self.contact_table["i"], np.arange(1, len(self.packing)))
        return np.split(self.contact_table, first)


# Names at the bar of the colors.
_LABELS = {
    "particle_pressure": "pressure in the particle",
    "pressure": "pressure in the particle",
    "area_deficit": "area deficit $A_0 - A$",
    "arc_radius": "smallest radius of curvature",
    "spin": "spin [1/time]",
    "direction": "direction of propulsion [rad]",
    "shape_parameter": r"shape parameter $P^2 / 4 \pi A$",
}


def label_of(color_by: str | ArrayLike, label: str | None) -> str:
    """The label of the bar of the colors; that of the name if none is given."""
    expect("label", label, str, type(None))
    if label is not None:
        return label
    return _LABELS.get(color_by, color_by) if isinstance(color_by, str) else ""


class Colored(ABC):
    """A state whose particles have values that colors show."""

    packing: Packing

    # names for colors that a message lists, beside those of `particle_values`
    _NAMES: ClassVar[tuple[str, ...]] = ()

    @property
    @abstractmethod
    def phi(self) -> float:
        """Packing fraction."""

    @property
    @abstractmethod
    def pressure(self) -> float:
        """Pressure of the packing."""

    @abstractmethod
    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the particles by name."""

    # its arguments are those of each kind of picture
    @property
    @abstractmethod
    def plot(self) -> Any:
        """Draw the state."""

    @abstractmethod
    def _new_axes(self) -> Axes:
        """Axes of a new figure."""

    def values(self, color_by: str | ArrayLike) -> Floats:
        """One number for each particle, shape (N,).

        Args:
            color_by: name of an attribute, or in a trajectory; or these numbers themselves, of
                which some may be nan.

        Raises:
            ParameterError: there is no such name, or they are no such numbers.
        """
        columns = self.particle_values()
        found: Any = color_by
        if isinstance(color_by, str):
            found = columns.get(color_by, getattr(self, color_by, None))
        return per_particle(color_by, found, len(self.packing), {*columns, *self._NAMES})

    def _scale(
        self, scale: Scale | None, forces: Sequence[Floats], color_by: str | ArrayLike
    ) -> Scale:
        """The scale that is given, or that of the values and forces."""
        if scale is None:
            scale = drawing.scale([self.values(color_by)], forces, color_by)
        expect("scale", scale, Scale)
        return scale

    def _title(self, title: str | None) -> str:
        return f"$\\phi$ = {self.phi:.4f},  $p$ = {self.pressure:.3g}" if title is None else title

    def _repr_html_(self) -> str | None:
        """The picture and the line of `repr`, for notebooks; None without matplotlib."""
        if not find_spec("matplotlib"):
            return None
        figure: Any = self.plot(self._new_axes()).figure
        line = html.escape(repr(self).strip("<>"))
        coded = base64.b64encode(figure._repr_png_()).decode()
        return f'<img src="data:image/png;base64,{coded}" alt="{line}"><br>{line}'


class Pictures(Colored):
    """A state that can be drawn."""

    @property
    @abstractmethod
    def outlines(self) -> list[Floats]:
        """Outline of each particle."""

    @abstractmethod
    def _flats(self) -> list[list[Floats]]:
        """Contacts of each particle as lines, arrays of shape (m, 2) [length]."""

    @abstractmethod
    def _halves(self) -> list[Halves]:
        """Where the contacts of each particle are, (m, 2), and their forces, (m,)."""

    def _marks(self, contacts: bool, forces: bool, spins: bool) -> list[Mark]:
        """What friction adds to these parts of a picture.

        Raises:
            ParameterError: there are no spins to draw.
        """
        if spins:
            raise ParameterError("there are no spins: give the simulation a friction")
        return []

    def plot(
        self,
        ax: Axes | None = None,
        color_by: str | ArrayLike = "particle_pressure",
        contacts: bool = False,
        forces: bool = False,
        scale: Scale | None = None,
        cmap: str | None = None,
        vmin: float | None = None,
        vmax: float | None = None,
        title: str | None = None,
        colorbar: bool = True,
        label: str | None = None,
        spins: bool = False,
    ) -> Axes:
        """Draw the outlines, colored by a value of each particle; returns the axes.

            state.plot(color_by="local_phi").figure.savefig("picture.png")
            state.plot(color_by=state.local_strain(before).d2min, label="$D^2_{min}$")

        Colors begin at 0. If some values are negative, 0 is in the middle.

        Args:
            ax: axes to draw into; if not given those of a new figure, which is as long as the box.
                matplotlib.pyplot does not know that figure, so that a loop leaves none open: save
                it, or give `plt.gca()` for `plt.show()`.
            color_by: name of an attribute with one number for each particle, e.g. `area_deficit`,
                or of a column of the trajectory, e.g. `pressure`; or these numbers, shape (N,).
                A particle whose number is nan is gray.
            contacts: draw the contacts, the straight or curved parts that outlines share; of soft
                disks the chords of their overlaps. Those that slide are green.
            forces: draw the force chains: lines between centers, with widths proportional to the
                forces; those of films that pull are magenta. Friction is a bar along the contact,
                green where it slides, whose length is that part of the radius that friction is of
                the force, at most all of it.
            scale: of colors and forces, to use one for several pictures, see
                `lammps_deformable.drawing.scale`.
            cmap: name of one of matplotlib's color maps. If not given, `YlGnBu`, or `BrBG` if 0 is
                in the middle.
            vmin: value of the first color; that of `scale` if not given.
            vmax: value of the last color; that of `scale` if not given.
            title: of the picture; phi and pressure if not given.
            colorbar: draw a bar of the colors. One bar of several pictures is
                `figure.colorbar(axes.collections[0], ax=all_axes)`.
            label: of the bar; that of the name if not given.
            spins: draw an arrow in each particle, the longer the faster it turns.

        Raises:
            ParameterError: `color_by` is no such attribute and no such numbers, there is no such
                color map, the `vmin` is not below `vmax`, or there are no spins.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        optional("matplotlib", "plot")
        from . import drawing

        values, halves = self.values(color_by), self._halves()
        label = label_of(color_by, label)
        scale = self._scale(scale, [force for _, force in halves], color_by)
        return drawing.draw(
            self.packing,
            self.outlines,
            values,
            label,
            self._title(title),
            limited(scale, vmin, vmax),
            ax,
            self._flats() if contacts else None,
            halves if forces else None,
            cmap,
            colorbar,
            self._marks(contacts, forces, spins),
        )

    def _new_axes(self) -> Axes:
        from .drawing import new_figure

        return new_figure(self.packing).subplots()
