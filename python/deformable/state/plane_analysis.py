"""Order and density of a packing in the plane: Voronoi cells, hexatic order, structure factor."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..common.optional import optional
from ..common.validate import count, positive
from .analysis import Analysis
from .cells import Cells, cells_of
from .structure_factor import structure_factor


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

    @cached_property
    def local_phi(self) -> NDArray[np.float64]:
        """Packing fraction in the Voronoi cell of each particle, shape (N,).

        The sides of cells are the radical axes of the undeformed circles, so that particles of all
        sizes are within their cells. Cells end at walls, and pass through a `Segment`. Weighted by
        the areas of cells, `filled_area / local_phi`, the mean is `phi`. It is infinite of a
        particle within a larger one, which leaves it no cell.
        """
        with np.errstate(divide="ignore"):
            return self.filled_area / self._cells.area

    @property
    def cell_sides(self) -> NDArray[np.int64]:
        """Number of neighbors in the Voronoi cells, see `local_phi`, shape (N,).

        It is 6 on a triangular lattice, and 6 in the mean of all particles of a periodic box
        without walls. Particles with 5 and with 7 are disclinations, pairs of them dislocations.
        """
        return np.bincount(self._cells.i[self._cells.length > 0.0], minlength=len(self.packing))

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
        np.add.at(order, cells.i, cells.length * (x + 1j * y) ** count("k", k))
        total = np.bincount(cells.i, cells.length, minlength=number)
        return np.divide(order, total, out=np.full(number, np.nan + 0j), where=total > 0.0)

    def hexatic_correlation(
        self, r_max: float, bins: int = 100, k: int = 6
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

    def structure_factor(
        self, k_max: float, bins: int = 100
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The static structure factor S(k) of the centers.

        The mean of |sum exp(i k r)|^2 / N over the wave vectors k of the periodic box with a length
        in each interval, k = 0 left out.

        Args:
            k_max: largest wave number [1/length].
            bins: number of intervals of the wave number.

        Returns:
            Wave numbers k, the middles of the intervals [1/length], and S, both of shape (bins,);
            S is nan where the box has no wave vectors.

        Raises:
            ParameterError: a value is out of range, or walls close a direction.
        """
        return structure_factor(self.packing, positive("k_max", k_max), count("bins", bins))
