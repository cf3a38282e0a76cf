"""Droplets in three dimensions, as a setting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.errors import ParameterError
from ..common.validate import shown
from .laws import LAWS, Law, SpeciesParameters, one_or_each, per_species
from .plane import refuse_space

# Load beyond which the law is off by more than it is worth; as in `src/core/droplet.h`.
LARGEST_LOAD = 0.4
# And part of the surface in the mean facet, where contacts are few and strong.
LARGEST_FACET = 0.05


@dataclass(frozen=True, repr=False)
class Droplet:
    """Droplets or bubbles of constant volume in three dimensions.

        U = max over F >= 0 of  sum_pairs F (R_i + R_j - d) - sum_i W_i(F)

    with one force F for each pair and the work W of Morse and Witten's theory, which is exact for
    small forces, and one more term for large ones. Droplets bulge between their contacts, so that
    each contact depends on all others of both droplets. Compared with Surface Evolver, the osmotic
    pressure of fcc crystals is right to a few per cent up to phi = 0.85. The *load* of a droplet is
    the part of its surface that facets cover; beyond 0.4, or beyond 0.05 in the mean facet, a
    droplet is beyond the model.

        Simulation(packing, Droplet(tension=1.0))

    Args:
        tension: surface tension [energy/length^2]: a number, or one for each species.

    Raises:
        ParameterError: a tension is not a positive number.

    Source: Morse and Witten, Europhys. Lett. 22, 549 (1993); docs/pair_deformable_droplet.md.
    """

    dimension: ClassVar[int] = 3
    sticks: ClassVar[bool] = False

    tension: float | Sequence[float] = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "tension", one_or_each("tension", self.tension))
        values = np.atleast_1d(self.tension)
        if not ((values > 0.0) & (values < np.inf)).all():
            raise ParameterError(
                f"tension must be positive, as droplets have nothing else, not "
                f"{shown(np.asarray(self.tension))}"
            )

    def __repr__(self) -> str:
        return "Droplet()" if self.tension == 1.0 else f"Droplet(tension={self.tension!r})"

    @property
    def name(self) -> str:
        """`droplet`, in files."""
        return "droplet"

    @property
    def reach(self) -> float:
        """How far beyond its undeformed sphere a droplet may touch, in radii."""
        return core.largest_bulge

    def species_parameters(self, radii: Sequence[float] | NDArray[np.float64]) -> SpeciesParameters:
        """As for `Ring`: the volume is kept, kA = inf, and all else but the tension is 0.

        Raises:
            ParameterError: there is another number of species.
        """
        tension = np.array(per_species(self.tension, len(radii)))
        none = np.zeros(len(radii))
        return SpeciesParameters(np.full(len(radii), np.inf), none, none, tension)


AnyLaw = Law | Droplet

# By the names that files have.
ALL_LAWS: dict[str, AnyLaw] = {**LAWS, "droplet": Droplet()}


def check_dimension(law: AnyLaw, dimension: int) -> None:
    """Refuse a law of the plane in three dimensions, and `Droplet` in the plane.

    Raises:
        ParameterError: law and dimension do not fit.
    """
    if law.dimension == 2:
        refuse_space(f"the law {type(law).__name__}", dimension, "take `Droplet`")
    elif dimension == 2:
        raise ParameterError(
            "Droplet is for three dimensions, and this packing has two: droplets in the plane are "
            "Ring(kA=math.inf, kP=0.0, tension=1.0)"
        )
