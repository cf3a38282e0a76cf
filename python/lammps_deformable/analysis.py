"""Functions of the distance of two centers, by freud, between walls too.

Density waves of centers in a periodic box, and their static structure factor.

Packings and contacts as freud takes them.

What one asks of a packing: motion between two states, stress, contacts, and order.

Order of a packing in the plane: Voronoi cells, hexatic order.

Order of a packing in three dimensions: Voronoi cells, Steinhardt's order parameters.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property, reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import contacts, tracking
from ._checks import count, numbers, positive, shown
from .box import fractional, lengths, widths
from .core import unit_vectors
from .errors import ParameterError
from .files import in_space
from .neighbors import forward
from .room import Distances, bounds, closed
from .versions import optional
from .voronoi import Cells, cells_of, space_cells_of

if TYPE_CHECKING:
    from .contacts import ContactForces
    from .packing import Packing
    from .tracking import LocalStrain, Snapshot

Floats = NDArray[np.float64]

# Random places between walls, each with a random direction: g is right to 1/sqrt of this number.
_PLACES = 40_000


def radial_distribution(
    packing: Packing, freud_system: tuple[Any, Floats], r_max: float, bins: int
) -> tuple[Floats, Floats]:
    """See `State.radial_distribution`.

    Args:
        packing: the centers and walls.
        freud_system: box and points of `State.to_freud`.
        r_max: largest distance [length].
        bins: number of intervals of the distance.
    """
    density = optional("freud", "freud").density
    box, _ = freud_system
    found = _by_distance(density.RDF(bins, r_max), r_max, freud_system)
    r, g = np.array(found.bin_centers), np.array(found.rdf, dtype=np.float64)
    if packing.walls:
        area, inside = _room_around(packing, r)
        g *= area / (box.volume * inside)  # freud's density counts the empty part of its box
    return r, g


def correlation(
    freud_system: tuple[Any, Floats], values: NDArray[np.complex128], r_max: float, bins: int
) -> tuple[Floats, Floats]:
    """Distances r and the mean of conj(a_i) a_j over all pairs at r; nan where there are none.

    Args:
        freud_system: box and points of `State.to_freud`.
        values: a of each particle, shape (N,); pairs with a nan are left out.
        r_max: largest distance [length].
        bins: number of intervals of the distance.
    """
    density = optional("freud", "freud").density
    box, points = freud_system
    known = ~np.isnan(values)
    function = density.CorrelationFunction(bins, r_max)
    found = _by_distance(function, r_max, (box, points[known]), values=values[known])
    mean = np.array(found.correlation).real  # each pair counts in both orders
    return np.array(found.bin_centers), np.where(np.array(found.bin_counts) > 0, mean, np.nan)


def _by_distance(function: Any, r_max: float, system: tuple[Any, Floats], **values: Any) -> Any:
    box, _ = system
    if box.is2D:
        most = min(box.Lx / np.hypot(1.0, box.xy), box.Ly) / 2.0
    else:
        most = float(widths(np.asarray(box.to_matrix()).T).min()) / 2.0
    if r_max >= most:
        raise ParameterError(
            f"r_max = {r_max:g} is too large for the box: it must be below {most:.4g}, half the "
            "distance of opposite sides"
        )
    return function.compute(system, **values)


def _room_around(packing: Packing, r: Floats) -> tuple[float, Floats]:
    """Where centers may be: its area, and the part of circles of radius r about it that is within.

    In space these are a volume and spheres. It begins as far from the walls as the nearest center.
    """
    distances = Distances(packing.walls, packing.box)
    nearest = float(distances(packing.positions)[1].min())
    low, high = bounds(packing.walls, packing.box)
    rng = np.random.default_rng(0)
    tried = low + rng.random((_PLACES, packing.dimension)) * (high - low)

    def free(places: Floats) -> NDArray[np.bool_]:
        return distances(places)[1].min(axis=0) >= nearest

    places = tried[free(tried)]
    if packing.dimension == 2:
        out = unit_vectors(2.0 * np.pi * rng.random(len(places)))
    else:
        out = rng.normal(size=places.shape)
        out /= lengths(out)[:, None]
    inside = np.array([np.mean(free(places + distance * out)) for distance in r])
    return float(np.prod(high - low)) * len(places) / _PLACES, inside


# Farthest from a whole number of periods in the box that a wave may be.
_WHOLE = 1e-6

# Phases that are in memory at a time.
_PHASES = 2_000_000


def structure_factor(packing: Packing, k_max: float, bins: int) -> tuple[Floats, Floats]:
    """See `Analysis.structure_factor`."""
    _refuse_container(packing)
    fractions, box = fractional(packing.positions, packing.box), packing.box
    # k = 2 pi (h, m, ..) B^-T, and h = k.a / 2 pi is below k_max |a| / 2 pi
    most = (k_max * lengths(box) / (2.0 * np.pi)).astype(int).tolist()
    # of k and -k, which are one wave, that with h >= 0
    orders = [np.arange(most[0] + 1), *(np.arange(-each, each + 1) for each in most[1:])]
    total = np.zeros((np.prod([len(h) for h in orders[:-1]]), len(orders[-1])), dtype=complex)
    block = max(_PHASES // len(total), 1)
    for first in range(0, len(packing), block):
        places = fractions[first : first + block].T
        phases = [
            np.exp(2.0j * np.pi * np.outer(h, x)) for h, x in zip(orders, places, strict=True)
        ]
        *some, last = phases
        before = reduce(lambda a, b: (a[:, None] * b).reshape(-1, b.shape[1]), some)
        total += before @ last.T
    power = np.abs(total).ravel() ** 2 / len(packing)
    grid = np.stack(np.meshgrid(*orders, indexing="ij"), axis=-1).reshape(-1, len(box))
    k = lengths(2.0 * np.pi * grid @ np.linalg.inv(box).T)
    kept = (k <= k_max) & forward(grid)
    edges = np.linspace(0.0, k_max, bins + 1)
    count, summed = (np.histogram(k[kept], edges, weights=each)[0] for each in (None, power[kept]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    return middle, np.where(count > 0, summed / np.maximum(count, 1), np.nan)


def density_waves(packing: Packing, k: Floats) -> NDArray[np.complex128]:
    """See `Analysis.density_waves`."""
    _refuse_container(packing)
    if k.ndim != 2 or k.shape[1] != packing.dimension:
        raise ParameterError(f"k must have shape (M, {packing.dimension}), not {k.shape}")
    periods = k @ packing.box.T / (2.0 * np.pi)
    off = np.abs(periods - np.rint(periods)).max(axis=1, initial=0.0)
    if off.max(initial=0.0) > _WHOLE:
        n = int(off.argmax())
        nearest = 2.0 * np.pi * np.linalg.solve(packing.box, np.rint(periods[n]))
        raise ParameterError(
            f"k = {k[n].tolist()} is no wave vector of the box: it has {periods[n].tolist()} "
            f"periods along its sides, not whole numbers; the nearest one is {nearest.tolist()}"
        )
    return np.array([np.exp(1.0j * (packing.positions @ wave)).mean() for wave in k])


def _refuse_container(packing: Packing) -> None:
    if any(closed(packing.walls, packing.dimension)):
        raise ParameterError(
            "the structure factor needs a periodic box: a container has no wave vectors of its own"
        )


def system(freud: Any, packing: Packing) -> tuple[Any, NDArray[np.float64]]:
    """See `Analysis.to_freud`."""
    shut = closed(packing.walls, packing.dimension)
    sides = packing.box.diagonal() * np.where(shut, 2.0, 1.0)
    tilts = packing.box / packing.box.diagonal()[:, None]
    if packing.dimension == 2:
        box = freud.box.Box(*sides, xy=tilts[1, 0], is2D=True)
    else:
        box = freud.box.Box(*sides, tilts[1, 0], tilts[2, 0], tilts[2, 1])
    center = packing.origin + packing.box.sum(axis=0) / 2.0
    return box, box.wrap(in_space(packing.positions - center))


def neighbors(freud: Any, number: int, contacts: ContactForces) -> Any:
    """The contacts of so many particles as a NeighborList, from both sides."""
    pair = contacts.j >= 0
    i, j, vector, push = (
        each[pair] for each in (contacts.i, contacts.j, contacts.vector, contacts.push)
    )
    begin, end = np.append(i, j), np.append(j, i)
    order = np.lexsort((end, begin))
    both = in_space(np.concatenate([vector, -vector]))[order]
    weights = np.append(push, push)[order]
    return freud.locality.NeighborList.from_arrays(
        number, number, begin[order], end[order], both, weights
    )


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
    def _contact_forces(self) -> contacts.ContactForces:
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

        The sum of stress times `filled_area` over the particles is `stress` times `packing.volume`;
        in three dimensions these are volumes.
        Between walls that holds for the trace, the pressure. A wall also exerts a torque on a
        particle, which `stress` has in its other components, and this tensor does not.

        Source: mean stress by Love and Weber; Bagi, Mech. Mater. 22, 165 (1996).
        """
        return contacts.particle_stress(self._contact_forces, self._filled)

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
        return contacts.graph(self.packing, self._contact_forces, self.rattlers)

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
        return tracking.displacements(before, self)

    def nonaffine(self, before: Snapshot | Packing) -> NDArray[np.float64]:
        """`displacements` without the strain of the box, shape (N, d) [length].

        Without them the centers would keep their places in units of the lattice vectors.
        """
        return tracking.nonaffine(before, self)

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
        start = tracking.packing_of("before", before)
        r_max = tracking.usual_distance(start) if r_max is None else positive("r_max", r_max)
        return tracking.local_strain(before, self, r_max)

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
            return system(freud, self.packing)
        return neighbors(freud, len(self.packing), self._contact_forces)

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

        return radial_distribution(self.packing, self.to_freud(), r_max, bins)


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

        return correlation(self.to_freud(), self.hexatic(k), r_max, bins)


class SpaceAnalysis(Analysis):
    """What there is in three dimensions only."""

    @property
    @abstractmethod
    def filled_volume(self) -> NDArray[np.float64]:
        """Volume of each particle."""

    @property
    def _filled(self) -> NDArray[np.float64]:
        return self.filled_volume

    @cached_property
    def _cells(self) -> Cells:
        return space_cells_of(self.packing)

    def steinhardt(self, l: int = 6) -> NDArray[np.float64]:  # noqa: E741
        """Bond-orientational order of each particle, shape (N,).

            q_l^2 = 4 pi/(2 l + 1) sum_m |sum_b A_b Y_lm(n_b)|^2 / (sum_b A_b)^2
                  = sum_bc A_b A_c P_l(n_b n_c) / (sum_b A_b)^2

        over its neighbors in the directions n, with A the areas of the faces of its Voronoi cell,
        see `local_phi`. So it does not jump where neighbors change. q_6 is 0.575 in fcc, 0.567 in
        bcc, and 0.354 in sc; of random packings it has a mean below 0.4. It is nan without a cell.

        Args:
            l: degree of the spherical harmonics, 4 or 6 as a rule.

        Raises:
            ParameterError: l is no whole number above 0.

        Source: Steinhardt, Nelson and Ronchetti, Phys. Rev. B 28, 784 (1983); weights: Mickel et
        al., J. Chem. Phys. 138, 044501 (2013).
        """
        from scipy.special import eval_legendre

        degree, cells = count("l", l), self._cells
        ends = np.searchsorted(cells.i, np.arange(1, len(self.packing)))
        order = np.full(len(self.packing), np.nan)
        for n, (direction, side) in enumerate(
            zip(np.split(cells.direction, ends), np.split(cells.side, ends), strict=True)
        ):
            if len(side):
                cosine = np.clip(direction @ direction.T, -1.0, 1.0)
                order[n] = (
                    np.sqrt(max(side @ eval_legendre(degree, cosine) @ side, 0.0)) / side.sum()
                )
        return order
