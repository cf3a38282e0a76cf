"""What pictures in the plane and in space have in common: values as colors, labels, notebooks."""

from __future__ import annotations

import base64
import html
from abc import ABC, abstractmethod
from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.validate import expect
from ..model import scale as scales
from ..model.packing import Packing
from ..model.scale import Scale, per_particle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]

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
            scale = scales.scale([self.values(color_by)], forces, color_by)
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
