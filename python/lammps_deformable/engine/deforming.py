"""Deformable particles in LAMMPS: what simulations in the plane and of droplets have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import ClassVar, Generic, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..common.validate import expect, positive, zero_or_more
from ..io.data_file import Motion
from ..io.lammps_commands import species_file
from ..model.droplet import AnyLaw, Droplet, check_dimension
from ..model.free_room import free_room
from ..model.friction import Friction, check_friction
from ..model.lattice import shown_box
from ..model.laws import Ring
from ..model.packing import Packing
from ..model.places import check_centers
from ..model.room import check_fit
from ..model.sticking import check_sticky_walls
from ..model.walls import Wall, as_walls
from ..state.droplet_state import DeformedState
from .damped_contacts import rest
from .followed import has_other_fixes, refuse_forces_of_motion, setup
from .free_box import check_free, relax_free_box
from .lammps import Engine, close_lammps, communicator, place_walls
from .opening import IMBALANCE, go_on, particles_in_lammps, with_spins
from .relaxation import TOLERANCE, Forces, minimize_until_relaxed, stress
from .relaxed_warnings import warn_of
from .rigidity import BALANCED, Rigidity
from .watching import Iteration, Watched, tell

S = TypeVar("S", bound=DeformedState)

# Iterations without halving the largest force after which a relaxation counts as stalled.
_PATIENCE = 60_000

# Imbalance of contacts at most.
UNBALANCED = 0.01

# Runs the minimizer once, from given forces and with so many iterations left; returns how many it
# has taken.
Approach = Callable[[Forces, int], int]


class Deforming(Watched, Engine, Generic[S]):
    """Deformable particles in LAMMPS, see `Simulation`; a law says what differs."""

    law: AnyLaw
    _loose: bool  # whether no contact bears a force
    _laws: ClassVar[tuple[type, ...]]
    _state: ClassVar[type]

    def __init__(
        self,
        packing: Packing | S,
        law: AnyLaw,
        comm: MPI.Comm | None = None,
        walls: Wall | Sequence[Wall] | None = None,
        friction: Friction | None = None,
    ) -> None:
        expect("packing", packing, Packing, self._state)
        expect("law", law, *self._laws)
        expect("friction", friction, Friction, type(None))
        self.law, self.comm = law, communicator(comm)
        start, state = _parts(self.comm.bcast(packing))  # those of other machines may differ
        self.friction = state.friction if state and friction is None else friction
        if walls is not None:
            start = replace(start, walls=as_walls(walls, start.dimension))
        self._rigidity = Rigidity(start)
        self._open(start, state)

    @property
    def walls(self) -> tuple[Wall, ...]:
        """The walls, where they are now."""
        return self._walls

    def __repr__(self) -> str:
        kind = type(self).__name__
        if self.closed:
            return f"<{kind}: closed>"
        number = self.lmp.get_natoms()
        return f"<{kind}: {number} particles, law {self.law!r}, {shown_box(self.box)}>"

    def restart(self, packing: Packing | S) -> None:
        """Start anew from a packing or a state, with the same law: results depend on it alone.

        Otherwise the last digits depend on data that LAMMPS and the pair style keep, such as the
        order of particles and the shares of both sides in a contact. Where a packing rearranges,
        other last digits may lead to another packing. Commands given to `lmp` are lost.

        Args:
            packing: that of a state of this simulation, or another one: particles may be added,
                removed or have other radii. They are at rest, stick where their circles overlap,
                and time and strain begin anew. Those of a state go on, with velocities and films.
        """
        expect("packing", packing, Packing, self._state)
        start, state = _parts(packing)
        self._check(start)  # or fail before the old LAMMPS is gone
        close_lammps(self.lmp)
        self._rigidity.start = self._rigidity.start and start
        self._open(start, state)

    def _open(self, packing: Packing, state: S | None) -> None:
        law = self.law
        self._check(packing)
        if self.friction:
            packing = with_spins(packing)
        self._species, self._radii = packing.species, packing.radii
        self._check_walls(packing.walls, packing.box)
        if packing.walls:
            check_centers(packing.walls, packing.box, packing.positions)
            check_sticky_walls(packing, law)
        self._walls = packing.walls
        self.lmp = particles_in_lammps(packing, law, self.comm, self.friction)
        still = Motion(np.zeros_like(packing.positions))
        go_on(self, state.motion.at(state.packing.walls, packing.walls) if state else still)
        self._setup = setup(self.lmp)
        smallest = float(packing.radius.min())
        self._smallest_radius, self._facet = smallest, smallest ** (packing.dimension - 1)
        self._measure(packing)

    def _check(self, packing: Packing) -> None:
        check_dimension(self.law, packing.dimension)
        species_file(self.law, packing.radii)
        if self.friction:
            check_friction(self.friction, packing, self.law)

    def _check_walls(self, walls: tuple[Wall, ...], box: NDArray[np.float64]) -> None:
        reach = 1.0 + (self.law.reach if isinstance(self.law, (Ring, Droplet)) else 0.0)
        check_fit(walls, box, reach * float(self._radii.max()))

    def _follow(self, walls: tuple[Wall, ...], box: NDArray[np.float64]) -> None:
        self._check_walls(walls, box)
        if walls:
            place_walls(self.lmp, walls, former=self._walls)
        self._walls = walls

    def relax(
        self,
        tolerance: float = TOLERANCE,
        minimum_contact_force: float = 0.0,
        pressure: float | None = None,
        box: str = "size",
    ) -> S:
        """Minimize the energy by FIRE until no force exceeds a part of the mean contact force.

        Forces of a user's fixes count that act in minimizations too, such as *fix addforce*. With
        friction particles move until they rest, as velocities and spins decay, and all fixes act.

        Args:
            tolerance: largest force on a particle, and with friction torque over its radius, over
                the mean contact force.
            minimum_contact_force: replaces the mean contact force where that is smaller, as in a
                loose packing [energy/length].
            pressure: of the state, of droplets the osmotic one; the box is free to reach it, to
                1e-6 [energy/length^d].
            box: what is free at a pressure: the `size` of the box alone, its `sides`, or the
                `shape`, which ends without shear stress.

        Returns:
            The relaxed state; its `stalled` is true if the tolerance was not reached.

        Raises:
            ParameterError: a value is out of range, or the pressure cannot be reached, or it is
                given with friction; or with friction a `move` has not ended.
            LammpsError: LAMMPS gave up, e.g. because a contact line is behind a center; a particle
                has no area left; or LAMMPS was given commands that states cannot follow, or a fix
                whose forces act in motion only, such as *fix gravity*; or the forces of droplets
                have no solution, far beyond the model.

        Warns:
            UnjammedWarning: a packing that was rigid has become loose without expanding. The one at
                the start counts as rigid if its forces balance, by the law or as soft disks.
            StalledWarning: forces stopped falling, or contacts far beyond the model do not balance.
            BeyondModelWarning: outlines have a negative radius of curvature, e.g. past confluence;
                or droplets have a load above 0.4, or one above 0.05 in the mean facet.

        Source: FIRE: Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006), in the form of Guenole et
        al., Comput. Mater. Sci. 175, 109584 (2020).
        """
        positive("tolerance", tolerance)
        minimum_contact_force = zero_or_more("minimum_contact_force", minimum_contact_force)
        if not self.friction:
            refuse_forces_of_motion(self.lmp)
        check_free(box, self._walls, pressure, self.friction)
        if pressure is not None:
            least = max(minimum_contact_force, pressure * self._facet)
            return relax_free_box(self, pressure, box, lambda: self.relax(tolerance, least))
        first = self.lmp.extract_global("ntimestep")

        def evaluate() -> Forces:
            forces = self._evaluate(minimum_contact_force)
            self._tell(forces, self.lmp.extract_global("ntimestep") - first)
            return forces

        forces = minimize_until_relaxed(
            evaluate(),
            tolerance,
            _PATIENCE,
            self._approach(tolerance),
            evaluate,
            lambda forces: forces.largest,
        )
        rest(self.lmp)  # FIRE leaves velocities
        unbalanced = self._told(IMBALANCE) > max(tolerance, UNBALANCED)  # forces say nothing then
        state = self._snapshot(forces, stalled=forces.residual > tolerance or unbalanced)
        unjammed = self._rigidity.lost(state.packing.phi, self._loose, self._balanced)
        warn_of(state, tolerance, unjammed)
        return state

    def _tell(self, forces: Forces, iterations: int) -> None:
        """Tell the callback, if there is one, of the last evaluation."""
        if self.callback is None:
            return
        if not self.friction:
            rest(self.lmp)  # FIRE begins without velocities
        room = free_room(self._walls, self.box)
        tensor = stress(self.lmp, room if self._walls else None)
        phi, pressure = self._filled() / room, float(np.trace(tensor) / len(tensor))
        root = self.comm.rank == 0
        seen = Iteration("relax", iterations, phi, pressure, forces.residual, root)
        tell(self.callback, seen, self.comm)

    def state(self) -> S:
        """The present state, not relaxed."""
        return self._snapshot(self._evaluate(), stalled=False)

    def _told(self, n: int) -> float:
        """What the pair style tells beside its energy; 0 of a law that does not."""
        told = self.lmp.numpy.extract_compute("deformable_beyond", 0, 1)
        return float(told[n]) if n < len(told) else 0.0

    def _others(self, largest: float, total: float) -> bool:
        """Whether a user's fix moves particles: all contacts together bear less than a force."""
        return largest > total and has_other_fixes(self.lmp, self._setup)

    def _balanced(self, packing: Packing) -> bool:
        """Whether contact forces about balance in a packing."""
        with type(self)(packing, self.law, self.comm) as sim:
            return sim.state().residual <= BALANCED and not sim._loose

    @abstractmethod
    def _measure(self, packing: Packing) -> None:
        """Take scales of forces and times from the packing of the start."""

    @abstractmethod
    def _approach(self, tolerance: float) -> Approach:
        """The minimizer of one relaxation."""

    @abstractmethod
    def _filled(self) -> float:
        """Area or volume of all particles at the last evaluation."""

    @abstractmethod
    def _evaluate(self, minimum_contact_force: float = 0.0) -> Forces:
        """Bring forces and results of the particles up to date; returns the forces."""

    @abstractmethod
    def _snapshot(self, forces: Forces, stalled: bool) -> S:
        """The state at the last evaluation."""


def _parts(given: Packing | S) -> tuple[Packing, S | None]:
    """The packing, and the state if it is one."""
    return (given, None) if isinstance(given, Packing) else (given.packing, given)
