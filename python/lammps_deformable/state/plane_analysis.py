"""Order of a packing in the plane: Voronoi cells, hexatic order."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..common.optional import optional
from ..common.validate import count, positive
from .analysis import Analysis
from .cells import Cells, cells_of


class PlaneAnalysis(Analysis):
    """What there is in the plane only."""

    @property
    @abstractmethod
    def filled_area(self) -> NDArray[np.float64]:
        """Area of each particle."""

    @property
    def _filled(self) -> NDArray[np.float64]:
        return self.filled_area

    @cached_property
    def _cells(self) -> Cells:
        return cells_of(self.packing)

    def hexatic(self, k: int = 6) -> NDArray[np.complex128]:
        """Bond-orientational order of each particle, shape (N,).

            psi_k = sum l exp(i k theta) / sum l

        over its neighbors, in the directions theta, with l the lengths of the sides of its Voronoi
        cell, see `local_phi`. So it does not jump where neighbors change. |psi_6| is 1 on a
        triangular lattice. The sides at walls do not count; psi is nan without neighbors.

        Args:
            k: number of directions, 4 for square order.

        Raises:
            ParameterError: k is no whole number above 0.

        Source: Mickel et al., J. Chem. Phys. 138, 044501 (2013).
        """
        cells, number = self._cells, len(self.packing)
        x, y = cells.direction.T
        order = np.zeros(number, dtype=np.complex128)
        np.add.at(order, cells.i, cells.side * (x + 1j * y) ** count("k", k))
        total = np.bincount(cells.i, cells.side, minlength=number)
        return np.divide(order, total, out=np.full(number, np.nan + 0j), where=total > 0.0)

    def hexatic_correlation(
        self, r_max: float, *, bins: int = 100, k: int = 6
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Correlation of the bond-orientational order over the distance, by freud.

            g_k(r) = mean of Re conj(psi_k(i)) psi_k(j)

        over all pairs of particles at the distance r, with psi_k of `hexatic`. On a triangular
        lattice g_6 is 1. It tends to |mean psi_6|^2 in a crystal, falls as a power of r in a
        hexatic phase, and exponentially in a fluid.

        Args:
            r_max: largest distance, below half of the box [length].
            bins: number of intervals of the distance.
            k: number of directions.

        Returns:
            Distances r, the middles of the intervals [length], and g, both of shape (bins,); g is
            nan where no pair has such a distance.

        Raises:
            ParameterError: a value is out of range.
            ImportError: freud is missing (`pip install 'lammps-deformable[freud]'`).

        Source: Nelson and Halperin, Phys. Rev. B 19, 2457 (1979).
        """
        r_max, bins = positive("r_max", r_max), count("bins", bins)
        optional("freud", "freud")
        from .radial_distribution import correlation

        return correlation(self.to_freud(), self.hexatic(k), r_max, bins)
