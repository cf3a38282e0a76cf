"""Droplets in three dimensions in LAMMPS: relax them, take their state, change their box."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..common.errors import BeyondModelWarning, LammpsError, ParameterError, StalledWarning
from ..common.validate import expect, positive, zero_or_more
from ..io.lammps_commands import law_commands, pair_style, species_file
from ..model.droplet import LARGEST_LOAD, Droplet, check_dimension
from ..model.lattice import shown_box
from ..model.packing import Packing
from ..state.droplet_contacts import ROWS, droplet_table
from ..state.droplet_state import DropletState
from .followed import refuse_forces_of_motion, refuse_other, setup
from .free_box import check_free, relax_free_box
from .lammps import (
    Engine,
    close_lammps,
    communicator,
    gather,
    local_array,
    open_lammps,
    run,
    shared_file,
)
from .opening import BEYOND, IMBALANCE, THERMO, commands_of_energy
from .pair_errors import run_forces
from .relaxation import (
    TOLERANCE,
    Forces,
    force_rounding,
    largest_force,
    largest_force_told,
    minimize_command,
    minimize_until_relaxed,
    stress,
)

# Time step of FIRE over sqrt(mass/stiffness), with the tension as the stiffness of a contact.
_TIMESTEP = 0.05

# Iterations without halving the largest force after which a relaxation counts as stalled, those of
# one call of FIRE, and the imbalance of contacts at most.
_PATIENCE, _ITERATIONS, _UNBALANCED = 60_000, 2000, 0.01

# Iterations of one call beyond the model, where the law may lose its solution and take long.
_FEW = 50

# Results of the pair style for each particle, see `pair_results`.
_RESULTS = ("area", "contacts", "contact_area", "pressure", "load")


class DropletSimulation(Engine):
    """Droplets in three dimensions in LAMMPS, what `Simulation` makes of the law `Droplet`.

    Every rank of an MPI run must make the same calls, and gets the same values.

    Args:
        packing: where droplets start, spheres that overlap little, e.g. from `jam`; or a state.
        law: the law, `Droplet`.
        comm: communicator that shares the work; all ranks if not given.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS, as that of a `Simulation`.
        law: the law.
        comm: the communicator.

    Raises:
        ParameterError: no packing, or one in the plane; or another number of tensions than species.
        LammpsError: LAMMPS refuses the packing.
    """

    def __init__(
        self, packing: Packing | DropletState, law: Droplet, comm: MPI.Comm | None = None
    ) -> None:
        expect("packing", packing, Packing, DropletState)
        expect("law", law, Droplet)
        self.law, self.comm = law, communicator(comm)
        self._open(self.comm.bcast(packing))

    def __repr__(self) -> str:
        if self.closed:
            return "<DropletSimulation: closed>"
        number = self.lmp.get_natoms()
        return f"<DropletSimulation: {number} droplets, {self.law!r}, {shown_box(self.box)}>"

    @property
    def walls(self) -> tuple[()]:
        """There are none."""
        return ()

    def restart(self, packing: Packing | DropletState) -> None:
        """Start anew from a packing or a state, with the same law: results depend on it alone."""
        expect("packing", packing, Packing, DropletState)
        self._check(packing if isinstance(packing, Packing) else packing.packing)
        close_lammps(self.lmp)
        self._open(packing)

    def _check(self, packing: Packing) -> None:
        check_dimension(self.law, packing.dimension)
        species_file(self.law, packing.radii)

    def _open(self, start: Packing | DropletState) -> None:
        packing = start if isinstance(start, Packing) else start.packing
        self._check(packing)
        self.strain = None if isinstance(start, Packing) else start.strain
        self._radii = packing.radii
        tension = self.law.species_parameters(packing.radii).tension
        self._stiffness, self._facet = float(tension.max()), float(packing.radius.min()) ** 2
        self.lmp = open_lammps(packing, self.comm)
        with shared_file(self.comm, species_file(self.law, packing.radii)) as file:
            run(self.lmp, law_commands(packing, self.law, file))
        run(self.lmp, commands_of_energy(self.law, fixes=False))
        run(self.lmp, f"timestep {_TIMESTEP / self._stiffness**0.5!r}")
        self._setup = setup(self.lmp)

    def relax(
        self,
        tolerance: float = TOLERANCE,
        minimum_contact_force: float = 0.0,
        pressure: float | None = None,
        box: str = "size",
    ) -> DropletState:
        """Minimize the energy by FIRE until no force exceeds a part of the mean contact force.

        Args:
            tolerance: largest force on a droplet over the mean contact force.
            minimum_contact_force: replaces the mean contact force where that is smaller, as in a
                loose packing [energy/length].
            pressure: osmotic pressure of the state; the box is free to reach it, to 1e-6
                [energy/length^3].
            box: what is free at a pressure, its `size`.

        Returns:
            The relaxed state; its `stalled` is true if the tolerance was not reached.

        Raises:
            ParameterError: a value is out of range, or the pressure cannot be reached.
            LammpsError: LAMMPS gave up, e.g. because droplets overlap too deeply: `push_off`; or
                forces have no solution, far beyond the model.

        Warns:
            StalledWarning: forces stopped falling, or contacts far beyond the model do not balance.
            BeyondModelWarning: droplets have a load above 0.4.

        Source: FIRE: Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006).
        """
        positive("tolerance", tolerance)
        minimum_contact_force = zero_or_more("minimum_contact_force", minimum_contact_force)
        refuse_forces_of_motion(self.lmp)
        check_free(box, (), pressure, dimension=3)
        if pressure is not None:
            least = max(minimum_contact_force, pressure * self._facet)
            return relax_free_box(self, pressure, box, lambda: self.relax(tolerance, least))

        def minimize(forces: Forces, left: int) -> int:
            if self._told(IMBALANCE) > _UNBALANCED:
                return left
            force = 0.5 * tolerance * forces.scale  # the scale falls a little further meanwhile
            count = min(left, _FEW if self._told(BEYOND) else _ITERATIONS)
            run_forces(self.lmp, minimize_command(float(force), count), ())
            return count

        def evaluate() -> Forces:
            return self._evaluate(minimum_contact_force)

        forces = minimize_until_relaxed(
            evaluate(), tolerance, _PATIENCE, minimize, evaluate, lambda forces: forces.largest
        )
        run(self.lmp, "velocity all set 0 0 0")  # FIRE leaves velocities
        unbalanced = self._told(IMBALANCE) > max(tolerance, _UNBALANCED)  # forces say nothing then
        state = self._snapshot(forces, stalled=forces.residual > tolerance or unbalanced)
        if state.root:
            _warn_of(state, tolerance)
        return state

    def state(self) -> DropletState:
        """The present state, not relaxed."""
        return self._snapshot(self._evaluate(), stalled=False)

    def _told(self, n: int) -> float:
        """What the pair style tells beside its energy."""
        return float(self.lmp.numpy.extract_compute("deformable_beyond", 0, 1)[n])

    def _evaluate(self, minimum_contact_force: float = 0.0) -> Forces:
        """Bring forces and results of the droplets up to date; returns the forces."""
        refuse_other(self.lmp, self._setup)
        results = " ".join(f"{name} 0" for name in _RESULTS)
        style = pair_style(self.law)
        run(
            self.lmp,
            f"{THERMO}\n"
            f"fix deformable_results all pair 1 {style} {results}\n"
            "compute deformable_rows all deformable/contact",
        )
        try:
            run_forces(self.lmp, "run 0 post no", ())
            self._results = gather(self.lmp, "f_deformable_results", len(_RESULTS))
            rows = local_array(self.lmp, "deformable_rows", len(ROWS))
        finally:
            run(self.lmp, "unfix deformable_results\nuncompute deformable_rows")
        _refuse_no_numbers(self._results)
        self._rows = np.concatenate(self.comm.allgather(rows))
        force = self._rows[:, ROWS.index("force")]
        mean = float(force.mean()) if len(force) else 0.0
        rounding = force_rounding(self.box, self._stiffness)
        return Forces(largest_force(self.lmp), max(mean, minimum_contact_force), rounding)

    def _snapshot(self, forces: Forces, stalled: bool) -> DropletState:
        area, contacts, contact_area, pressure, load = np.ascontiguousarray(self._results.T)
        by_particle = self.lmp.extract_setting("radius_flag")
        packing = Packing(
            positions=gather(self.lmp, "x", 3),
            species=gather(self.lmp, "type", 1).astype(np.int64) - 1,
            radii=self._radii,
            box=self.box,
            particle_radii=gather(self.lmp, "radius", 1) if by_particle else None,
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
            stress=stress(self.lmp),
            residual=forces.residual,
            stalled=stalled,
            beyond=round(self._told(BEYOND)),
            velocities=gather(self.lmp, "v", 3),
            contact_table=droplet_table(self._rows, packing),
            root=self.comm.rank == 0,
            strain=self.strain,
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
            return _of_droplets(packing, law, *rest, **named)
        return super().__new__(cls)


def _of_droplets(
    packing: Packing | DropletState,
    law: Droplet,
    comm: MPI.Comm | None = None,
    walls: object = None,
    friction: object = None,
) -> DropletSimulation:
    for name, given in (("walls", walls), ("friction", friction)):
        if given is not None:
            raise ParameterError(
                f"{name} is for particles in the plane, and droplets have three dimensions: leave "
                "it out"
            )
    return DropletSimulation(packing, law, comm)


def _warn_of(state: DropletState, tolerance: float) -> None:
    """Warn the caller of `relax` if its state has stalled, or is beyond the model."""
    if state.stalled:
        why = "the contacts do not balance, so that forces are not known"
        if state.residual > tolerance:
            why = largest_force_told(state.residual, "the mean contact force", tolerance)
        warnings.warn(
            f"relaxation stalled at phi = {state.phi:.5f}: {why}", StalledWarning, stacklevel=4
        )
    if state.beyond:
        warnings.warn(
            f"{state.beyond} of {len(state.packing)} droplets are beyond the model at phi = "
            f"{state.phi:.5f}: their load is above {LARGEST_LOAD:g}, the largest "
            f"{state.load.max():.2g}, so that pressures are off by more than ten per cent",
            BeyondModelWarning,
            stacklevel=4,
        )
