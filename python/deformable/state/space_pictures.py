"""Pictures of states in three dimensions."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from ..common.optional import optional
from ..model.facets import Facets
from ..model.scale import Scale, limited
from .colored import Colored, label_of
from .contact_forces import ContactForces

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class SpacePictures(Colored):
    """A state in three dimensions that can be drawn."""

    @property
    @abstractmethod
    def _contact_forces(self) -> ContactForces:
        """All contacts, each once."""

    @abstractmethod
    def _facets(self) -> Facets:
        """Where particles are cut by their contacts."""

    def plot(  # type: ignore[override]
        self,
        ax: Axes | None = None,
        color_by: str | ArrayLike = "particle_pressure",
        forces: bool = False,
        view: tuple[float, float] = (20.0, 30.0),
        scale: Scale | None = None,
        cmap: str | None = None,
        vmin: float | None = None,
        vmax: float | None = None,
        title: str | None = None,
        colorbar: bool = True,
        label: str | None = None,
    ) -> Axes:
        """Draw the particles with their facets, colored by a value of each; returns the axes.

            state.plot(color_by="load", view=(30, 60)).figure.savefig("picture.png")

        Particles are spheres that the planes of their contacts cut. Those are drawn whose centers
        are in the box, seen from far away. Of droplets, which bulge, this is a little less than
        their volume.

        Args:
            ax: axes to draw into; if not given those of a new figure, which pyplot does not know.
            color_by: name of an attribute with one number for each particle, e.g. `load`, or of
                one of `particle_values`; or these numbers, shape (N,). A particle whose number is
                nan is gray.
            forces: draw the force network in place of the particles: lines between centers, with
                widths proportional to the forces, those behind paler.
            view: elevation of the viewer above the plane of x and y, and azimuth in it [degree].
            scale: of colors and forces, to use one for several pictures.
            cmap: name of one of matplotlib's color maps.
            vmin: value of the first color.
            vmax: value of the last color.
            title: of the picture; phi and pressure if not given.
            colorbar: draw a bar of the colors.
            label: of the bar; that of the name if not given.

        Raises:
            ParameterError: as `State.plot`, or the view is no two numbers.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        optional("matplotlib", "plot")
        from ..model import space_picture

        contacts = self._contact_forces
        chains = space_picture.chains_of(contacts.i, contacts.vector, contacts.force)
        on = self._scale(scale, [chains.force], color_by)
        return space_picture.draw(
            self.packing,
            self.values(color_by),
            label_of(color_by, label),
            self._title(title),
            limited(on, vmin, vmax),
            ax,
            self._facets(),
            chains if forces else None,
            cmap,
            colorbar,
            view,
        )

    def _new_axes(self) -> Axes:
        from ..model.space_picture import new_axes

        return new_axes()
