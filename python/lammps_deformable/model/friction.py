"""Friction and damping of contacts, as settings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.errors import ParameterError
from ..common.validate import expect
from .by_pair import ByPair, by_pair, pair_matrix
from .droplet import AnyLaw, Droplet
from .laws import Sector
from .packing import Packing

_NAMES = ("mu", "kt", "gt", "damp")

# Masses are 1, and 1 + m R^2/I is that of spheres at most.
_MASS, _LEVER = 1.0, 3.5

# At this part of the longest time step energies and restitution are right to a percent.
_ACCURATE = 0.1


@dataclass(frozen=True)
class Friction:
    """Friction and damping of contacts, for `Simulation`.

    The sides of a contact move against each other by v. A spring of the length xi along the contact
    and a dashpot have the force, by which both sides rub, and another dashpot damps the normal:

        f_t = kt xi + gt dxi/dt,   dxi/dt = v.t,   held to |f_t| <= mu max(f, 0)
        f_d = min(damp v.n, max(f, 0))

    f is the elastic force of the contact. Particles turn: their spins have the moments of inertia
    m R^2/2 of disks. See *fix deformable/friction*.

    Args:
        mu: coefficient of friction, 0 or more; `math.inf` is a contact that does not slip.
        kt: stiffness of the spring [energy/length^2]; about half of that of the contact is usual.
        gt: constant of the dashpot along the contact [force/velocity].
        damp: constant of the dashpot along its normal [force/velocity].
        walls: of contacts with walls, each a number; if not given they are as those of particles.

    Each of the first four is a number for all pairs, or a symmetric matrix with a row and a column
    for each species.

    Raises:
        ParameterError: a value is no such number or matrix, is negative, or must be finite.

    Source: Cundall and Strack, Geotechnique 29, 47 (1979); LAMMPS' *pair_style granular*.
    """

    mu: ByPair
    kt: ByPair
    gt: ByPair = 0.0
    damp: ByPair = 0.0
    walls: Friction | None = None

    def __post_init__(self) -> None:
        for name in _NAMES:
            object.__setattr__(self, name, by_pair(name, getattr(self, name)))
        for row in self._rows():
            if problem := core.invalid_friction(*row):
                raise ParameterError(problem)
        expect("walls", self.walls, Friction, type(None))
        if self.walls and (self.walls.by_species or self.walls.walls):
            raise ParameterError("friction with walls has one number for each of mu, kt, gt, damp")

    @property
    def rubs(self) -> bool:
        """Whether any particles do: dashpots alone damp."""
        return bool(np.any(np.asarray(self.mu) > 0.0))

    @property
    def by_species(self) -> bool:
        """Whether a value differs by species."""
        return any(np.ndim(getattr(self, name)) for name in _NAMES)

    @property
    def longest_step(self) -> float:
        """The longest time step that *fix deformable/friction* takes [time]."""
        own = min(
            core.friction_time_step(mu, kt, gt, damp, _MASS, _LEVER)
            for mu, kt, gt, damp in self._rows()
        )
        return min(own, self.walls.longest_step) if self.walls else own

    @property
    def accurate_step(self) -> float:
        """The longest one that is accurate to a few percent [time]."""
        return _ACCURATE * self.longest_step

    def of_pairs(self, species: int) -> NDArray[np.float64]:
        """mu, kt, gt and damp of each pair, shape (species, species, 4).

        Raises:
            ParameterError: there is another number of species.
        """
        return np.stack([pair_matrix(name, getattr(self, name), species) for name in _NAMES], 2)

    def _rows(self) -> list[list[float]]:
        """mu, kt, gt and damp of each pair of as many species as matrices have."""
        species = max(len(np.atleast_1d(getattr(self, name))) for name in _NAMES)
        rows: list[list[float]] = self.of_pairs(species).reshape(-1, len(_NAMES)).tolist()
        return rows


def check_friction(friction: Friction, packing: Packing, law: AnyLaw) -> None:
    """Refuse friction where contacts do not slip, or where coefficients are missing.

    Raises:
        ParameterError: the law is `Sector` or `Droplet`; there is another number of species; or
            there are walls, and coefficients by species only.
    """
    expect("friction", friction, Friction)
    if isinstance(law, Droplet):
        raise ParameterError(
            "friction is for particles in the plane, and droplets have three dimensions: leave it "
            "out"
        )
    if isinstance(law, Sector):
        raise ParameterError(
            "friction needs contacts that slip, and those of Sector stick: take Ring"
        )
    friction.of_pairs(len(packing.radii))
    if packing.walls and friction.by_species and friction.walls is None:
        raise ParameterError(
            "friction differs by species, and walls have none: give it walls=Friction(mu, kt)"
        )
