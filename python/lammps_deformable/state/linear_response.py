"""What a state knows from the second derivatives of its energy."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from .complex_modulus import complex_modulus_of
from .elastic import ElasticModuli, moduli_of
from .hessian import Hessian
from .modes import Modes, modes_of

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
