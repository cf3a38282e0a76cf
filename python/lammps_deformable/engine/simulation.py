"""Deformable particles of the plane in LAMMPS: relax them, take their state, change their box."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..core import dot
from ..io.lammps_commands import pair_style
from ..model.filled import filled_area
from ..model.lattice import lattice_vectors
from ..model.laws import Law, Ring, Sector
from ..model.onset import natural_pressure
from ..model.packing import Packing
from ..model.sticking import sticks
from ..model.timestep import STIFFNESS_PER_PRESSURE
from ..state.contact_table import ROWS, attached
from ..state.state import State
from .damped_contacts import NO_FORCE, carry, damp
from .deforming import Approach, Deforming
from .droplet_simulation import OfLaw
from .fire import Fire
from .followed import refuse_other, unsaved
from .lammps import gather, wall_forces
from .opening import BEYOND, IMBALANCE, LOST
from .pair_errors import refuse_without_area, run_forces
from .pair_results import are_round, contacts_of, evaluate
from .relaxation import Forces, largest_force, stress

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
        walls: one shape or several, see `Packing`; those of the packing if not given. Centers must
            be between them: `Packing.between` and `push_off` make such packings.
        friction: of the contacts, which then rub and damp, and turn the particles; these get radii
            of their own (`Packing.particle_radii`). That of a state if not given; contacts of a
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
        self._largest_radius = float(packing.radius.max())
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
        packing = Packing(
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
            stress=stress(self.lmp, packing.area if packing.walls else None),
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
            lost_energy=self._told(LOST) + sum(rubbing.lost if rubbing else ()),
            friction=self.friction,
            rubbing=rubbing,
            unsaved=unsaved(self.lmp, self._setup),
        )
