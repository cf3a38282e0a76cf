"""Droplets in three dimensions in LAMMPS."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import LammpsError
from ..io.lammps_commands import pair_style
from ..model.droplet import LARGEST_LOAD, Droplet
from ..model.filled import undeformed
from ..model.packing import Packing
from ..state.droplet_contacts import ROWS, droplet_table
from ..state.droplet_state import DropletState
from .deforming import UNBALANCED, Approach, Deforming
from .followed import refuse_other, unsaved
from .lammps import gather, wall_forces
from .opening import BEYOND, IMBALANCE
from .pair_errors import run_forces
from .pair_results import evaluate
from .relaxation import Forces, force_rounding, largest_force, minimize_command, stress

# Time step of FIRE over sqrt(mass/stiffness), with the tension as the stiffness of a contact.
_TIMESTEP = 0.05

# Iterations of one call of FIRE; and beyond the model, where forces may have several solutions.
# There each counts for so many, as energies that jump have no minimum to be found.
_ITERATIONS, _FEW, _DEARER = 2000, 50, 30

# Results of the pair style for each particle, see `pair_results`.
_RESULTS = ("area", "contacts", "contact_area", "pressure", "load")


class DropletSimulation(Deforming[DropletState]):
    """Droplets in three dimensions in LAMMPS, what `Simulation` makes of the law `Droplet`.

    Arguments, attributes and errors are those of `Simulation`, without friction.
    """

    law: Droplet
    _laws, _state = (Droplet,), DropletState

    def _measure(self, packing: Packing) -> None:
        tension = self.law.species_parameters(packing.radii).tension
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
            self.lmp, pair_style(self.law), self._walls, _RESULTS, len(ROWS)
        )
        _refuse_no_numbers(self._results)
        self._rows = np.concatenate(self.comm.allgather(rows))
        force = self._rows[:, ROWS.index("force")]
        self._loose = not force.any()
        mean = 0.0 if self._loose else float(force.mean())
        largest = largest_force(self.lmp)
        others = self._others(largest, float(force.sum()))
        scale = max(mean, minimum_contact_force) or others * largest
        return Forces(largest, scale, force_rounding(self.box, self._stiffness))

    def _snapshot(self, forces: Forces, stalled: bool) -> DropletState:
        area, contacts, contact_area, pressure, load = np.ascontiguousarray(self._results.T)
        packing = Packing(
            positions=gather(self.lmp, "x", 3),
            species=self._species,
            radii=self._radii,
            box=self.box,
            particle_radii=self._particle_radii,
            walls=self._walls,
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
