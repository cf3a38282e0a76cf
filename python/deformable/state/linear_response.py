"""What a state knows from the second derivatives of its energy."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ..common.errors import ParameterError
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
            ParameterError: there are fewer modes, or all modes do not fit into the memory; or see
                `hessian`.
        """
        outlines = getattr(self, "outlines", ())  # there are none in three dimensions
        return modes_of(self.hessian(rattlers=False), outlines, number, vectors)

    def elastic_moduli(self) -> ElasticModuli:
        """Elastic tensor, shear and bulk modulus, by one linear system.

        `deformable.shear_modulus` and `deformable.bulk_modulus` measure the same by finite strains.

        Raises:
            ParameterError: the state is not at rest (`residual` above 1e-3), has walls, or resists
                no strain; or see `hessian`.
        """
        if self.residual > _AT_REST:
            raise ParameterError(
                f"the state is not at rest: its largest force is {self.residual:.2g} of the mean "
                "contact force; relax it first"
            )
        return moduli_of(self.hessian(rattlers=False))
