"""Flat walls around a ring of beads: a convex polygon around the origin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.validate import numbers
from ..core import unit_vectors
from .walls import Plane


@dataclass(frozen=True, eq=False)
class Walls:
    """A convex polygon around the origin, for `PolygonSimulation` and `squeeze`.

    `planes` are the same sides for a `Packing`.

    Attributes:
        angle: directions from the origin to the sides, increasing, shape (n,), n >= 3 [rad].
        height: distance of each side from the origin, shape (n,) [length].
        stick: beads that touch a side keep their place along it; otherwise they slip.

    Raises:
        ParameterError: the sides do not close a polygon around the origin.
    """

    angle: NDArray[np.float64]
    height: NDArray[np.float64]
    stick: bool = False

    def __post_init__(self) -> None:
        angle, height = (numbers(f"{n} of walls", getattr(self, n)) for n in ("angle", "height"))
        if angle.ndim != 1 or len(angle) < 3 or not _turns_once(angle):
            raise ParameterError(
                "angles of walls must increase through one turn, by less than half a turn from one "
                f"to the next, not {angle.tolist()}"
            )
        if height.shape != angle.shape or not (height > 0.0).all():
            raise ParameterError(
                f"heights of walls must be {len(angle)} positive numbers, not {height.tolist()}"
            )
        for name, array in (("angle", angle), ("height", height)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward normals, shape (n, 2)."""
        return unit_vectors(self.angle)

    @property
    def planes(self) -> tuple[Plane, ...]:
        """The sides as walls of a `Packing`."""
        return tuple(
            Plane(tuple(height * normal), tuple(-normal))
            for height, normal in zip(self.height, self.normal, strict=True)
        )

    def distances_from(self, center: ArrayLike) -> NDArray[np.float64]:
        """Distance of each side from a point, negative beyond the side, shape (n,) [length]."""
        return self.height - np.sum(self.normal * np.asarray(center), axis=1)


def _turns_once(angle: NDArray[np.float64]) -> bool:
    """Whether directions increase through one turn, by less than half a turn each."""
    turns = np.diff(angle, append=angle[:1] + 2.0 * np.pi)
    return bool(((turns > 0.0) & (turns < np.pi)).all())
