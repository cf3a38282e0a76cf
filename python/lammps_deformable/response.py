"""What a state knows from the second derivatives of its energy.

Second derivatives of the energy of a state of soft disks or spheres, and its contacts.

Second derivatives of the energy of a state of the ring laws.

Second derivatives of the energy of a state of droplets.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .contacts import (
    ContactForces,
    ContactTable,
    DropletTable,
    Sides,
    bearing,
    between,
    by_centers,
    by_lines,
    by_strains,
    joined,
    other_side,
    with_walls,
)
from .core import disk_blocks, droplet_blocks
from .errors import ParameterError
from .hessian import Floats, Hessian, balanced, lines_of, rattler_contacts
from .modes import Modes, modes_of
from .moduli import ElasticModuli, complex_modulus_of, moduli_of
from .neighbors import near_pairs

if TYPE_CHECKING:
    from .friction import Friction
    from .laws import Droplet, Law
    from .packing import Packing


# Forces that remain in a state at rest, over the mean contact force. Ten times larger ones still
# change contacts, and with them moduli by several percent of the bulk modulus.
_AT_REST = 1e-3


class LinearResponse(ABC):
    """Second derivatives of the energy of a state, its normal modes and elastic moduli."""

    residual: float

    @abstractmethod
    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy, see `Hessian`."""

    def modes(self, number: int | None = None, vectors: bool = True) -> Modes:
        """The normal modes of lowest stiffness, without those that have none.

        Few modes of many particles are found by Lanczos' method with a sparse factorization; in an
        unstable state they are those with a stiffness closest to zero. Otherwise the matrix is
        dense: all modes of 4000 particles take 1 GB and minutes, in three dimensions those of
        2700. Contacts of rattlers are left out, so that each rattler has a mode without stiffness
        in each direction.

        Args:
            number: of modes; all if not given.
            vectors: whether displacements are computed, which takes longer for all modes.

        Raises:
            ParameterError: there are fewer modes, or all modes do not fit into the memory; or the
                state is not at rest (`residual` above 1e-3); or see `hessian`.
        """
        outlines = getattr(self, "outlines", ())  # there are none in three dimensions
        return modes_of(self._at_rest(), outlines, number, vectors)

    def elastic_moduli(self) -> ElasticModuli:
        """Elastic tensor, shear and bulk modulus, by one linear system.

        `ld.shear_modulus` and `ld.bulk_modulus` measure the same by finite strains.

        Raises:
            ParameterError: the state is not at rest (`residual` above 1e-3), has walls, or resists
                no strain; or see `hessian`.
        """
        return moduli_of(self._at_rest())

    def complex_modulus(
        self, frequencies: ArrayLike, friction: float = 1.0
    ) -> NDArray[np.complex128]:
        """Shear modulus under a small oscillating strain, G* = G' + i G'', by linear response.

            strain = Re gamma exp(i omega t),  shear stress = Re G*(omega) gamma exp(i omega t)

        Centers are overdamped, with a friction zeta against the mean flow, as in `oscillate` with a
        period of 2 pi/omega. With their displacements u from it, H and xi = d^2E/(du dgamma),

            zeta du/dt = - H u - xi gamma,
            G*(omega) = G_affine - xi^T (H + i omega zeta)^-1 xi / V

        with the area or volume V. At omega = 0 it is the `shear_modulus` of `elastic_moduli`, far
        above the rates of relaxation, eigenvalues of H over zeta, its affine part.
        `ld.dynamic_modulus` measures the same by finite strains.

        Args:
            frequencies: angular ones, omega, not negative, any shape [1/time].
            friction: zeta, force over velocity [1/time], as masses are 1.

        Returns:
            G*(omega) of simple shear along x, complex, of the shape of `frequencies`
            [energy/length^d].

        Raises:
            ParameterError: a value is out of range; or see `elastic_moduli`.

        Source: Lemaitre and Maloney, J. Stat. Phys. 123, 415 (2006); Tighe, Phys. Rev. Lett. 107,
        158303 (2011).
        """
        return complex_modulus_of(self._at_rest(), frequencies, friction)

    def _at_rest(self) -> Hessian:
        """The matrix without rattlers, of a state at rest."""
        hessian = self.hessian(rattlers=False)
        self.check_at_rest()
        return hessian

    def check_at_rest(self) -> None:
        """Refuse what has no meaning where forces are left.

        Raises:
            ParameterError: `residual` is above 1e-3.
        """
        if self.residual > _AT_REST:
            raise ParameterError(
                f"the state is not at rest: its largest force is {self.residual:.2g} of the mean "
                "contact force; relax it first"
            )


class SoftResponse(LinearResponse):
    """Linear response of a `DiskState` or `SphereState`."""

    packing: Packing

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy by the centers, and by strains.

        Each contact adds n n^T - (o/d) (1 - n n^T) for its direction n and overlap o. The second
        part is the prestress.

        Args:
            rattlers: False leaves out the contacts of rattlers, which bear nothing; a contact that
                bears a thousandth of the mean contact force or more stays.

        Raises:
            ParameterError: spheres touch a cylinder, cone or post.
        """
        sides, contact, kept = self._overlaps()
        if not rattlers:
            sides, contact = sides.part(kept), contact[kept]
        if np.isnan(sides.turn).any():
            raise ParameterError(
                "second derivatives of soft spheres do not know cylinders, cones and posts: take "
                "other walls, or a state in which none touches one"
            )
        blocks = disk_blocks(sides.vector, sides.turn, contact)
        return Hessian(
            self.packing, blocks, by_centers(sides, len(self.packing)), by_strains(sides)
        )

    def rattler_contacts(self) -> tuple[Sides, NDArray[np.float64]]:
        """Contacts that `hessian(rattlers=False)` leaves out, and their overlaps."""
        sides, contact, kept = self._overlaps()
        return sides.part(~kept), (contact - sides.distance)[~kept]

    def _overlaps(self) -> tuple[Sides, NDArray[np.float64], NDArray[np.bool_]]:
        """Contacts, the distances at which they open, and whether they bear, all of them once."""
        packing, radius = self.packing, self.packing.radii
        i, j, shift = near_pairs(packing, 0.0)
        pairs = between(i, j, packing.positions[j] + shift - packing.positions[i])
        sides = joined(pairs, with_walls(packing, 0.0))
        contact = radius[sides.i] + np.where(sides.j < 0, 0.0, radius[sides.j])
        overlap, count = contact - sides.distance, len(i)
        both = np.append(overlap, overlap[:count])
        ends = np.append(sides.i, j), np.append(sides.j, i)
        kept = bearing(*ends, both, len(packing), packing.dimension)
        return sides, contact, kept[: len(contact)]

    @property
    def _contact_forces(self) -> ContactForces:
        sides, contact, _ = self._overlaps()
        overlap, wall = contact - sides.distance, sides.j < 0
        part = np.where(wall, 1.0, (self.packing.radii[sides.i] - 0.5 * overlap) / sides.distance)
        force = -(overlap / sides.distance)[:, None] * sides.vector
        return ContactForces(sides.i, sides.j, sides.vector, part, force)


class RingResponse(LinearResponse):
    """Linear response of a `State`."""

    packing: Packing
    law: Law
    contact_table: ContactTable
    unsaved: str
    friction: Friction | None

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy of the ring laws, see `SoftResponse.hessian`.

        Raises:
            ParameterError: the law is `Sector`, particles stick or rub, walls were given to `lmp`,
                or a line is held at the largest tilt.
        """
        if self.unsaved:
            raise ParameterError(
                f"second derivatives do not know the {self.unsaved} that were given to lmp"
            )
        if self.friction:
            raise ParameterError("friction has no energy, and so no second derivatives of one")
        lines = lines_of(self.packing, self.law, self.contact_table, rattlers)
        return balanced(lines).hessian()

    def rattler_contacts(self) -> tuple[Sides, Floats]:
        """Contacts that `hessian(rattlers=False)` leaves out, and lengths by which they open.

        Returns:
            Sides of S contacts, and distances (S,) by which they are to become longer [length].
        """
        return rattler_contacts(self.packing, self.contact_table)


# Local variables of a side, the vector and the shift of its facet; how the shift is seen from the
# other side; and the part of a change of the distance that a facet takes.
_VARIABLES, _OTHER_SIDE, _SHARE = 4, (-1.0,), 0.5


class DropletResponse(LinearResponse):
    """Linear response of a `DropletState`."""

    packing: Packing
    law: Droplet
    contact_table: DropletTable

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy of droplets, see `SoftResponse.hessian`.

        Raises:
            ParameterError: droplets touch walls; or the compliance of one is singular, far beyond
                the model.
        """
        packing, table = self.packing, self.contact_table
        if (table["j"] < 0).any():
            raise ParameterError(
                "second derivatives of droplets do not know walls: take a state of a periodic box "
                "without them"
            )
        if not rattlers:
            force = table["force"]
            kept = bearing(table["i"], table["j"], force, len(packing), packing.dimension)
            table = table[kept | kept[other_side(table)]]
        sides = between(table["i"], table["j"], table["distance"][:, None] * table["normal"])
        tension = self.law.species_parameters(packing._species_radii).of(packing.species).tension
        number = np.bincount(sides.i, minlength=len(packing))
        droplets = np.column_stack([number, packing.radii, tension])
        rows = [sides.vector, sides.turn, np.full(len(table), _SHARE), table["force"]]
        try:
            blocks = droplet_blocks(droplets, np.column_stack(rows))
        except ValueError as error:
            raise ParameterError(str(error)) from None
        from scipy.sparse import hstack

        facets = by_lines(other_side(table), _VARIABLES, _OTHER_SIDE)
        chain = hstack([by_centers(sides, len(packing), _VARIABLES), *facets], format="csr")
        return Hessian(packing, blocks, chain, by_strains(sides, _VARIABLES))
