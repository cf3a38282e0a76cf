"""The sparse matrix of second derivatives, and linear systems with it.

Factors of sparse matrices have the same last digits on every processor.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.checks import numbers
from ..common.errors import ParameterError
from ..particles.containers import free_room
from .contacts import motions

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..particles.packing import Packing

Floats = NDArray[np.float64]


def factored(matrix: Any) -> Callable[[Floats], Floats]:
    """Product with the inverse of a sparse symmetric matrix, by QDLDL.

    It adds in one order everywhere. SuperLU does not: it calls the kernels of linear algebra that
    are made for each processor.

    Args:
        matrix: of `scipy.sparse`, shape (n, n).

    Returns:
        A function of right sides, shape (n,) or (n, k).

    Raises:
        RuntimeError: a pivot is zero: the matrix is singular, or needs exchanges of rows.
    """
    import qdldl
    from scipy.sparse import triu

    solve: Callable[[Floats], Floats] = qdldl.Solver(triu(matrix, format="csc"), upper=True).solve

    def product(right: Floats) -> Floats:
        if right.ndim == 1:
            return solve(right)
        return np.stack([solve(column) for column in right.T], axis=1)

    return product


# Stiffness that is added to all centers before a factorization, in mean diagonal entries: motions
# without a stiffness would make the matrix singular. Corrections remove its effect.
_SHIFT = 1e-9

# Corrections of a solution, and the part of the forces that may remain.
_CORRECTIONS, _REMAINDER = 20, 1e-13


class Hessian:
    """Second derivatives of the energy of a packing by the coordinates of its centers.

    The lines of `balanced` and `curved` contacts follow the centers, and so do the forces of
    droplets in three dimensions, which are called lines here too. The energy is stationary in
    them, and they are variables of their own here: the matrix stays sparse, and that of the
    centers alone is its Schur complement,

        H = M_cc - M_cl M_ll^-1 M_lc

    with the centers c and the lines l. `reduced`, `operator` and `solve` are those of H. There are
    d N coordinates of the centers, in two or three dimensions d.

    Attributes:
        packing: the particles.
        matrix: M, sparse and symmetric, shape (dN + lines, dN + lines) [energy/length^2]. Rows
            are x_0, y_0, x_1, y_1, ... of the centers, with z in three dimensions, then the shift
            of each line [length], of droplets the force of each contact [energy/length], then for
            `curved` the direction [rad] and the curvature [1/length] of each line, and for each
            droplet with films that stick the stretch L and the pressure P of
            `core.stretch_blocks`. Soft disks, spheres and `radical` have no such lines: M is H.
        energy: [energy].
        gradient: of the energy, shape (dN + lines,); minus the forces, and what is left of the
            balance of lines.
        by_strain: second derivatives by the rows of `matrix` and by the components xx, xy, ... of
            a displacement gradient, shape (dN + lines, d^2). Walls do not follow the strain.
        strain: second derivatives by the displacement gradient alone, shape (d^2, d^2) [energy].
        room: area, in three dimensions volume, of the packing [length^d].
        stress: pressure tensor of the contacts between particles, shape (d, d) [energy/length^d].
        free: particles without contacts in the matrix, shape (N,).
        scale: mean diagonal entry of the centers that have contacts [energy/length^2].
    """

    def __init__(self, packing: Packing, blocks: Any, chain: Any, strains: Floats) -> None:
        """Chain the derivatives by local variables to the global ones.

        Args:
            packing: the particles.
            blocks: energy and its derivatives by V local variables, as `core.EnergyBlocks`.
            chain: their derivatives by centers and lines, sparse, shape (V, dN + lines).
            strains: their derivatives by a displacement gradient, shape (V, d^2).
        """
        from scipy.sparse import csc_matrix, csr_matrix

        row, column, value = blocks.hessian()
        local = csr_matrix((value, (row, column)), shape=(len(strains), len(strains)))
        strained = local @ strains
        self.packing, self.energy = packing, blocks.energy
        self.matrix = csc_matrix(chain.T @ local @ chain)
        self.gradient = chain.T @ blocks.gradient
        self.by_strain, self.strain = chain.T @ strained, strains.T @ strained
        dimension = packing.dimension
        self.room = free_room(packing.walls, packing.box)
        self.stress = -(strains.T @ blocks.gradient).reshape(dimension, dimension) / self.room
        diagonal = self.matrix.diagonal()[: self.size].reshape(-1, dimension)
        self.free = ~diagonal.any(axis=1)
        self.scale = (
            float(np.abs(diagonal).mean(where=~self.free[:, None])) if diagonal.any() else 1.0
        )

    def __repr__(self) -> str:
        lines = self.matrix.shape[0] - self.size
        return f"<Hessian: {len(self.packing)} particles, {lines} variables of contact lines>"

    @property
    def size(self) -> int:
        """Number of coordinates dN."""
        return self.packing.dimension * len(self.packing)

    @cached_property
    def motions(self) -> Floats:
        """Motions of all particles with contacts together that no wall resists.

        Orthonormal, shape (dN, m): d translations in a periodic box, one along a channel, a
        rotation in a round container.
        """
        found = np.where(
            self.free[:, None], 0.0, motions(self.packing.walls, self.packing.positions)
        )
        if self.free.all() or not len(found):
            return np.empty((self.size, 0))
        return np.linalg.qr(found.reshape(len(found), -1).T)[0]

    @property
    def zero_modes(self) -> int:
        """Number of motions without a stiffness: `motions`, and d of each free particle."""
        return self.motions.shape[1] + self.packing.dimension * int(self.free.sum())

    @property
    def held(self) -> NDArray[np.bool_]:
        """Coordinates of particles that are not free, shape (dN,)."""
        return np.repeat(~self.free, self.packing.dimension)

    def project(self, vectors: Floats) -> Floats:
        """The part of vectors, shape (dN, ...), that contains no motion without a stiffness."""
        kept = np.where(self.held.reshape(-1, *[1] * (vectors.ndim - 1)), vectors, 0.0)
        return kept - self.motions @ (self.motions.T @ kept)

    @cached_property
    def operator(self) -> Any:
        """H as a `scipy.sparse.linalg.LinearOperator`, shape (dN, dN)."""
        from scipy.sparse.linalg import LinearOperator

        n, centers, response = self.size, self.matrix[: self.size, : self.size], self._lines

        def product(vector: Floats) -> Floats:
            if response is None:
                return np.asarray(centers @ vector)
            coupled = self.matrix[n:, :n] @ vector
            return np.asarray(centers @ vector - self.matrix[:n, n:] @ response(coupled))

        return LinearOperator((n, n), matvec=product, rmatvec=product, matmat=product, dtype=float)

    def reduced(self) -> Floats:
        """H as a dense array, shape (dN, dN) [energy/length^2]."""
        dense: Floats = self.matrix[: self.size, : self.size].toarray()
        if self._lines is not None:
            coupling = self.matrix[self.size :, : self.size].toarray()
            dense -= self.matrix[: self.size, self.size :] @ self._lines(coupling)
        return dense

    def solve(self, forces: ArrayLike) -> Floats:
        """Displacements u with H u = f, without motions that have no stiffness.

        Args:
            forces: f, shape (dN,) or (dN, k) [energy/length]. Their parts along motions without a
                stiffness are left out.

        Returns:
            u, of the same shape [length].

        Raises:
            ParameterError: wrong shape; or another motion has no stiffness, so that nothing holds
                against the forces.
        """
        given = numbers("forces", forces)
        if given.ndim not in (1, 2) or len(given) != self.size:
            raise ParameterError(
                f"forces must have shape ({self.size},) or ({self.size}, k), not {given.shape}"
            )
        padded = np.zeros((len(self.gradient), *given.shape[1:]))
        padded[: self.size] = given
        return self.response(padded)[: self.size]

    def response(self, right: Floats) -> Floats:
        """Change z of centers and lines with M z = b, see `solve`; shape (dN + lines, ...)."""
        right = right.copy()
        right[: self.size] = self.project(right[: self.size])
        solution, remainder = np.zeros_like(right), right
        size = before = float(np.abs(right).max(initial=0.0))
        inverse = self._inverse
        for _ in range(_CORRECTIONS):
            if before <= _REMAINDER * size:
                return solution
            solution = solution + inverse(remainder)
            solution[: self.size] = self.project(solution[: self.size])
            remainder = right - self.matrix @ solution
            remainder[: self.size] = self.project(remainder[: self.size])
            now = float(np.abs(remainder).max())
            if not now < 0.5 * before:
                break
            before = now
        if not before <= 1e-6 * size:
            raise ParameterError(
                "the packing does not resist these forces: a motion that moves its particles "
                "against each other has no stiffness, as below jamming"
            )
        return solution

    @cached_property
    def _inverse(self) -> Callable[[Floats], Floats]:
        return self.factored(_SHIFT * self.scale)

    def factored(self, shift: float) -> Callable[[Floats], Floats]:
        """Product with the inverse of M, after a stiffness is added to all centers.

        Args:
            shift: this stiffness [energy/length^2].
        """
        from scipy.sparse import diags

        added = np.zeros(len(self.gradient))
        added[: self.size] = shift
        return factored(self.matrix + diags(added))

    def line_response(self, right: Floats) -> Floats:
        """Change y of lines with M_ll y = b while centers stay, shape (lines, ...)."""
        return right if self._lines is None else self._lines(right)

    @cached_property
    def _lines(self) -> Callable[[Floats], Floats] | None:
        """Product with M_ll^-1; None without lines."""
        lines = self.matrix[self.size :, self.size :]
        return factored(lines) if lines.shape[0] else None
