"""Pictures of states in three dimensions."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from ..common.errors import ParameterError
from ..common.optional import optional
from ..common.validate import finite
from ..model.facets import Facets
from ..model.scale import Scale, limited
from ..model.section import section_of
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
        contacts: bool = False,
        forces: bool = False,
        scale: Scale | None = None,
        cmap: str | None = None,
        vmin: float | None = None,
        vmax: float | None = None,
        title: str | None = None,
        colorbar: bool = True,
        label: str | None = None,
        view: tuple[float, float] = (20.0, 30.0),
        slice: float | None = None,
    ) -> Axes:
        """Draw the particles with their facets, colored by a value of each; returns the axes.

            state.plot(color_by="load", view=(30, 60)).figure.savefig("picture.png")
            state.plot(slice=2.5, contacts=True)

        Particles are spheres that the planes of their contacts cut. Those are drawn whose centers
        are in the box, seen from far away. Of droplets, which bulge, this is a little less than
        their volume.

        Args:
            ax: axes to draw into; if not given those of a new figure, which pyplot does not know.
            color_by: name of an attribute with one number for each particle, e.g. `load`, or of
                one of `particle_values`; or these numbers, shape (N,). A particle whose number is
                nan is gray.
            contacts: of a slice: draw the lines of contacts. Facets are always drawn.
            forces: draw the force network in place of the particles: lines between centers, with
                widths proportional to the forces, those behind paler.
            scale: of colors and forces, to use one for several pictures.
            cmap: name of one of matplotlib's color maps.
            vmin: value of the first color.
            vmax: value of the last color.
            title: of the picture; phi and pressure if not given.
            colorbar: draw a bar of the colors.
            label: of the bar; that of the name if not given.
            view: elevation of the viewer above the plane of x and y, and azimuth in it [degree].
            slice: draw what the plane at this z cuts, seen from above [length].

        Raises:
            ParameterError: as `State.plot`, the view is no two numbers, or contacts are for
                slices only, and forces for views.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        optional("matplotlib", "plot")
        from ..model import picture, space_picture

        if contacts and slice is None:
            raise ParameterError("contacts are drawn in a slice: give a slice, or leave it out")
        if forces and slice is not None:
            raise ParameterError("forces are those of the whole network: leave it out of a slice")
        network = self._contact_forces
        chains = space_picture.chains_of(network.i, network.vector, network.force)
        on = limited(self._scale(scale, [chains.force], color_by), vmin, vmax)
        values, label, title = self.values(color_by), label_of(color_by, label), self._title(title)
        named: dict[str, Any] = {"cmap": cmap, "colorbar": colorbar}
        if slice is not None:
            cut = section_of(self.packing, self._facets(), finite("slice", slice))
            return picture.draw(
                cut,
                cut.outlines,
                values[cut.particle],
                label,
                title,
                on,
                ax,
                cut.contacts if contacts else None,
                **named,
            )
        return space_picture.draw(
            self.packing,
            values,
            label,
            title,
            on,
            ax,
            self._facets(),
            chains if forces else None,
            view=view,
            **named,
        )

    def _new_axes(self) -> Axes:
        from ..model.space_picture import new_axes

        return new_axes()
