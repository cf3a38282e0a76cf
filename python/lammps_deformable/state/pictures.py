"""Pictures of a state, of deformable particles or of soft disks."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.optional import optional
from ..model.marks import Mark
from ..model.scale import Scale, limited
from .colored import Colored, label_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..model.picture import Halves

Floats = NDArray[np.float64]


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
                `lammps_deformable.model.scale`.
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
        from ..model import picture

        values, halves = self.values(color_by), self._halves()
        label = label_of(color_by, label)
        scale = self._scale(scale, [force for _, force in halves], color_by)
        return picture.draw(
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
        from ..model.picture import new_figure

        return new_figure(self.packing).subplots()
