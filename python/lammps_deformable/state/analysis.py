"""What one asks of a packing: motion between two states, stress, contacts, and order."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.optional import optional
from ..common.validate import count, numbers, positive, shown
from ..model.packing import Packing
from . import contact_forces, displacements, for_freud, local_strain
from .cells import Cells
from .displacements import Snapshot
from .local_strain import LocalStrain
from .structure_factor import density_waves, structure_factor


class Analysis(ABC):
    """Analysis of a state, alone or together with an earlier one."""

    packing: Packing

    @property
    @abstractmethod
    def rattlers(self) -> NDArray[np.bool_]:
        """Which particles are rattlers."""

    @property
    @abstractmethod
    def _filled(self) -> NDArray[np.float64]:
        """Area of each particle, or its volume."""

    @property
    @abstractmethod
    def _contact_forces(self) -> contact_forces.ContactForces:
        """All contacts."""

    @property
    @abstractmethod
    def _cells(self) -> Cells:
        """Voronoi cells of all particles."""

    @cached_property
    def particle_stress(self) -> NDArray[np.float64]:
        """Pressure tensor of each particle, compression positive, (N, d, d) [energy/length^d].

        It is the mean stress in a particle under the forces F of its contacts, which act where
        their lines cross the lines of centers, at x from its center:

            stress = -sum x F / filled_area        (symmetric part)

        The sum of stress times `filled_area` over the particles is `stress` times `packing.area`;
        in three dimensions these are volumes.
        Between walls that holds for the trace, the pressure. A wall also exerts a torque on a
        particle, which `stress` has in its other components, and this tensor does not.

        Source: mean stress by Love and Weber; Bagi, Mech. Mater. 22, 165 (1996).
        """
        return contact_forces.particle_stress(self._contact_forces, self._filled)

    @cached_property
    def local_phi(self) -> NDArray[np.float64]:
        """Packing fraction in the Voronoi cell of each particle, shape (N,).

        The sides of cells are the radical axes of the undeformed circles, in three dimensions the
        radical planes of spheres, so that particles of all sizes are within their cells. Cells end
        at walls, and pass through a `Segment`. Weighted by the sizes of cells, `filled_area /
        local_phi`, the mean is `phi`. It is infinite of a particle within a larger one, which
        leaves it no cell.
        """
        with np.errstate(divide="ignore"):
            return self._filled / self._cells.size

    @property
    def cell_sides(self) -> NDArray[np.int64]:
        """Number of neighbors in the Voronoi cells, see `local_phi`, shape (N,).

        In the plane it is 6 on a triangular lattice, and 6 in the mean of all particles of a
        periodic box without walls. Particles with 5 and with 7 are disclinations, pairs of them
        dislocations. In three dimensions it is 12 in fcc, 14 in bcc, and about 14 in disorder.
        """
        return np.bincount(self._cells.i[self._cells.side > 0.0], minlength=len(self.packing))

    def graph(self) -> Any:
        """The contacts as a graph of networkx, a `MultiGraph` with particles as nodes.

            networkx.number_connected_components(state.graph())

        Nodes are numbered as particles, and have `x`, `y`, `radius`, `species` and `rattler`. Each
        active contact is an edge, with the `force` along the line of centers, positive where it
        pushes [energy/length], the `distance` of the centers and the vector (`dx`, `dy`) from the
        lower to the higher number [length]; in three dimensions there are `z` and `dz` too, and
        with friction `friction` and `sliding`, see `State.contact_table`. Two particles may touch
        through several images. The node -1 stands for all walls, and is there if a particle touches
        one.

        Raises:
            ImportError: networkx is missing (`pip install 'lammps-deformable[networkx]'`).
        """
        return contact_forces.graph(self.packing, self._contact_forces, self.rattlers)

    def displacements(self, before: Snapshot | Packing) -> NDArray[np.float64]:
        """Displacements of the particles since an earlier state, shape (N, d) [length].

        Particles may have crossed the boundaries of the box. Each is followed by the image that is
        nearest to where the strain of the box alone would have brought it: in a box of the lengths
        lx and ly it may move by up to lx/2 and ly/2 beside that. Of boxes whose tilts differ by
        their width, the one is meant that the `strain` of both states leads to or, if that is
        None, the one with the tilt nearest to the earlier one.

        Args:
            before: state or packing of the same particles.

        Raises:
            ParameterError: `before` has another number of particles, or walls that close other
                directions.
        """
        return displacements.displacements(before, self)

    def nonaffine(self, before: Snapshot | Packing) -> NDArray[np.float64]:
        """`displacements` without the strain of the box, shape (N, d) [length].

        Without them the centers would keep their places in units of the lattice vectors.
        """
        return displacements.nonaffine(before, self)

    def local_strain(self, before: Snapshot | Packing, r_max: float | None = None) -> LocalStrain:
        """Strain around each particle since an earlier state, and D^2_min.

            gradient, d2min, neighbors = state.local_strain(before)

        With vectors v to its neighbors before, and v' now, the displacement gradient G of a
        particle minimizes

            D^2 = sum |v' - v - G v|^2

        Args:
            before: state or packing of the same particles, see `displacements`.
            r_max: distance of neighbors in the earlier state; 3 times the mean radius if not given
                [length].

        Returns:
            Tuple `gradient`, `d2min`, `neighbors`; its `strain` is the symmetric part.

        Raises:
            ParameterError: a value is out of range, or see `displacements`.

        Source: Falk and Langer, Phys. Rev. E 57, 7192 (1998).
        """
        start = displacements.packing_of("before", before)
        r_max = local_strain.usual_distance(start) if r_max is None else positive("r_max", r_max)
        return local_strain.local_strain(before, self, r_max)

    def structure_factor(
        self, k_max: float, *, bins: int = 100
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The static structure factor S(k) of the centers.

        The mean of |sum exp(i k r)|^2 / N over the wave vectors k of the periodic box with a length
        in each interval, k = 0 left out. The time grows as N^2 k_max^d: in three dimensions 1000
        spheres take a second up to three peaks, k_max = 10/R.

        Args:
            k_max: largest wave number [1/length].
            bins: number of intervals of the wave number; by name, as freud has it first.

        Returns:
            Wave numbers k, the middles of the intervals [1/length], and S, both of shape (bins,);
            S is nan where the box has no wave vectors.

        Raises:
            ParameterError: a value is out of range, or walls close a direction.
        """
        return structure_factor(self.packing, positive("k_max", k_max), count("bins", bins))

    def density_waves(self, k: ArrayLike) -> NDArray[np.complex128]:
        """Amplitudes of density waves of the centers, shape (M,).

            rho_k = 1/N sum exp(i k r)

        Its modulus is 1 at the reciprocal lattice of a perfect crystal, 1/sqrt(N) in disorder:
        positional order. N |rho_k|^2 is the structure factor at k.

        Args:
            k: wave vectors of the periodic box, shape (M, d) [1/length].

        Raises:
            ParameterError: wrong shape, or a wave that does not fit into the box, or walls close a
                direction.
        """
        return density_waves(self.packing, numbers("k", k))

    def to_freud(self, what: str = "points") -> Any:
        """Box and points as freud takes them, or the contacts as its list of neighbors.

            freud.order.Hexatic().compute(state.to_freud(), neighbors=state.to_freud("contacts"))

        The box has the dimension of the packing and its center at the origin, so that the points
        are moved.
        It is twice as long along directions that walls close, because freud finds no neighbors in
        boxes that are not periodic; walls themselves are left out. freud's densities count the
        empty part: `radial_distribution` does not. Import freud before `deformable` to call
        `freud.locality.Voronoi`, which crashes on the Voro++ of LAMMPS.

        Args:
            what: `points`, or `contacts`, those between particles, from both sides.

        Returns:
            The tuple (freud.box.Box, array of shape (N, 3)), or a freud.locality.NeighborList with
            the forces along the lines of centers as weights.

        Raises:
            ParameterError: `what` is another word.
            ImportError: freud is missing (`pip install 'lammps-deformable[freud]'`).
        """
        if what not in ("points", "contacts"):
            raise ParameterError(f"what must be points or contacts, not {shown(what)}")
        freud = optional("freud", "freud")
        if what == "points":
            return for_freud.system(freud, self.packing)
        return for_freud.neighbors(freud, len(self.packing), self._contact_forces)

    def radial_distribution(
        self, r_max: float, *, bins: int = 100
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The radial distribution function g(r) of the centers, by freud.

        Between walls the number of pairs is compared with that of centers at random places, no
        nearer to the walls than the nearest center is: g tends to 1 there too.

        Args:
            r_max: largest distance, below half of the box; between walls below their distance
                [length].
            bins: number of intervals of the distance; by name, as freud has it first.

        Returns:
            Distances r, the middles of the intervals [length], and g, both of shape (bins,).

        Raises:
            ParameterError: a value is out of range.
            ImportError: freud is missing (`pip install 'lammps-deformable[freud]'`).
        """
        r_max, bins = positive("r_max", r_max), count("bins", bins)
        optional("freud", "freud")
        from .radial_distribution import radial_distribution

        return radial_distribution(self.packing, self.to_freud(), r_max, bins)
