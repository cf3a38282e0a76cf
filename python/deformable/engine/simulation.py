"""A packing of deformable particles inside LAMMPS: relax it, look at it, change its box."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path
from typing import ClassVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..common.errors import BeyondModelWarning, LammpsError, StalledWarning, UnjammedWarning
from ..common.renamed import FormerAttributes, former_arguments
from ..common.validate import expect, positive
from ..io.lammps_commands import law_commands, pair_style, species_file
from ..model.laws import Law, Ring, Sector
from ..model.packing import Packing
from ..model.timestep import STIFFNESS_PER_PRESSURE
from ..state.contact_table import contact_table
from ..state.state import State
from .lammps import (
    Engine,
    change_box,
    gather,
    local_array,
    open_lammps,
    radii_of_atoms,
    run,
)

# Results by fix pair. It reads the pair style once on a time step, which a run of no steps does not
# advance: each evaluation defines it anew, and removes it lest minimizations and runs pay for it.
_RESULTS = ("area", "perimeter", "contacts", "pressure", "arc_radius", "contact_length")

_MEASURE = """
compute virial all pressure NULL virial
compute beyond all pair {style}
thermo_style custom step pe c_virial[1] c_virial[2] c_virial[4] c_beyond[1]
thermo_modify norm no
"""

# FIRE starts from this part of 1/sqrt(p), p the pressure of the hardest particle (mass 1), and may
# stretch it tenfold. Measured, N = 40 and 128: 0.03 is the fastest, 0.04 three times slower.
_TIMESTEP = 0.02

# The pressure falls by decades while a packing relaxes, and the time step has to follow it. Once it
# stays within a factor two, each call of the minimizer is twice as long as the last one: soft modes
# near the onset of jamming need more iterations than this, and each call begins at rest.
_ITERATIONS = 2000

# Relative change of area and perimeter below which a particle counts as round, because the energy
# of a loose packing only tends to zero. An indentation of 1e-7 R changes them by about this much.
_LOOSE = 1e-14

# What the pair styles say of particles that overlap too much, and what Python knows against it.
_TOO_DEEP = "contact line"
_CURE = " (push_off parts overlaps, jam does so by itself)"

# Iterations without halving the largest force after which a relaxation counts as stalled. It falls
# by decades in a packing that loosens, where its ratio to the mean force may stay what it is.
_PATIENCE = 60_000


class Simulation(FormerAttributes, Engine):
    """Deformable particles in LAMMPS.

    Every rank of an MPI run makes the same calls and sees the same values.

    Args:
        packing: where particles start, e.g. from `jam`.
        law: contact law, `Ring` or `Sector`.
        comm: communicator that shares the work; all ranks if not given. With `MPI.COMM_SELF` every
            rank runs a simulation of its own, the fast way for many small packings.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS.
        law: the contact law.
        comm: the communicator.

    Raises:
        ParameterError: no packing or no law, or radii too large for LAMMPS' neighbor bins;
            choose another length unit.
        LammpsError: LAMMPS refuses the packing or the law.
    """

    _FORMER: ClassVar[dict[str, str]] = {"model": "law"}

    @former_arguments(model="law")
    def __init__(self, packing: Packing, law: Law, comm: MPI.Comm | None = None) -> None:
        expect("packing", packing, Packing)
        expect("law", law, Ring, Sector)
        self.law = law
        self.comm = MPI.COMM_WORLD if comm is None else comm
        packing = self.comm.bcast(packing)  # ranks on unlike machines may have jammed differently
        self._rigid_phi = np.inf
        self._open(packing)

    def restart(self, packing: Packing) -> None:
        """Go on from a packing as if nothing had been before: the result depends on it alone.

        Otherwise the last digits depend on what LAMMPS and the pair style remember, such as the
        order of particles and how contacts were shared, and with them where a packing rearranges
        to. What was given to `lmp` is lost.

        Args:
            packing: the one of a state of this simulation.
        """
        self.lmp.close()
        self._open(packing)

    def _open(self, packing: Packing) -> None:
        law = self.law
        self._species, self._radii = packing.species, packing.radii
        parameters = species_file(law, self._radii.tolist())
        self.lmp = open_lammps(packing, self.comm)
        with tempfile.TemporaryDirectory() as folder:
            file = self.comm.bcast(str(Path(folder, "species.txt")))
            if self.comm.rank == 0:
                Path(file).write_text(parameters)
            run(self.lmp, law_commands(packing, law, file))
        run(self.lmp, _MEASURE.format(style=pair_style(law)))
        smallest = float(packing.radius.min())
        stiffness = law.single_contact_stiffness(smallest)
        self._single_contact_pressure = stiffness / STIFFNESS_PER_PRESSURE
        self._single_contact_force = stiffness * smallest

    def deform(self, box: NDArray[np.float64]) -> None:
        """Give the box other lattice vectors, and let the centers follow affinely.

        Args:
            box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].

        Raises:
            ParameterError: the box has another form; the simulation stays as it was.
        """
        change_box(self.lmp, box)

    @former_arguments(bearing="minimum_contact_force")
    def relax(self, tolerance: float = 1e-6, minimum_contact_force: float = 0.0) -> State:
        """Minimize the energy by FIRE until no force exceeds a part of the mean contact force.

        Args:
            tolerance: largest force on a particle over the mean contact force.
            bearing: mean contact force below which the packing counts as loose: it then takes the
                place of the mean [energy/length].

        Returns:
            The relaxed state; its `stalled` is true where the tolerance was not reached.

        Raises:
            LammpsError: LAMMPS gave up, e.g. a contact line behind a center.

        Warns:
            UnjammedWarning: a packing that was rigid bears no force any more without expanding.
            StalledWarning: the forces stopped falling (energies of `Sector` jump).
            BeyondModelWarning: outlines with negative radius of curvature, e.g. past confluence.

        Source: FIRE: Bitzek et al., Phys. Rev. Lett. 97, 170201 (2006), in the form of Guenole et
        al., Comput. Mater. Sci. 175, 109584 (2020).
        """
        positive("tolerance", tolerance)
        residual = self._evaluate(minimum_contact_force)
        best, patience, iterations = self._largest_force, _PATIENCE, _ITERATIONS
        while residual > tolerance and patience > 0:
            pressure = self._largest_pressure
            timestep = _TIMESTEP / np.sqrt(max(pressure, self._single_contact_pressure))
            force = 0.5 * tolerance * self._force_scale  # it falls a little further on the way
            self._run(
                f"timestep {float(timestep)!r}\nminimize 0 {float(force)!r} {iterations} "
                f"{2 * iterations}",
            )
            residual = self._evaluate(minimum_contact_force)
            patience -= iterations
            iterations = _ITERATIONS if self._largest_pressure < 0.5 * pressure else 2 * iterations
            if self._largest_force < 0.5 * best:
                best, patience = self._largest_force, _PATIENCE
        run(self.lmp, "velocity all set 0 0 0")  # FIRE's
        state = self._snapshot(residual, stalled=residual > tolerance)
        self._judge(state, tolerance)
        return state

    def state(self) -> State:
        """The present state, not relaxed."""
        return self._snapshot(self._evaluate(), stalled=False)

    def _evaluate(self, minimum_contact_force: float = 0.0) -> float:
        """Bring forces and per-atom results up to date; returns the residual, see `relax`."""
        results = " ".join(f"{name} 0" for name in _RESULTS)
        run(
            self.lmp,
            f"fix results all pair 1 {pair_style(self.law)} {results}\n"
            "compute seen all deformable/contact",
        )
        try:
            self._run("run 0 post no")
            self._results = gather(self.lmp, "f_results", len(_RESULTS))
            self._seen = local_array(self.lmp, "seen", 9)
        finally:
            run(self.lmp, "unfix results\nuncompute seen")

        area, perimeter, contacts, pressure, _, length = self._results.T
        species = np.array(self.lmp.gather("type", 0, 1)) - 1
        self._particle_radii = radii_of_atoms(self.lmp)
        radius = self._radii[species] if self._particle_radii is None else self._particle_radii
        radius = radius - self.law.skins(len(self._radii))[species]
        strain = 1.0 - area / (np.pi * radius**2) + perimeter / (2.0 * np.pi * radius) - 1.0
        self._largest_force = float(np.linalg.norm(gather(self.lmp, "f", 3), axis=1).max())
        self._largest_pressure = float(pressure.max())
        self._loose = bool(strain.max() <= _LOOSE)
        mean = (
            self._single_contact_force if self._loose else float(pressure @ length / contacts.sum())
        )
        self._force_scale = max(mean, minimum_contact_force)
        return self._largest_force / self._force_scale if self._force_scale > 0.0 else 0.0

    def _run(self, commands: str) -> None:
        """Run commands that evaluate forces."""
        try:
            run(self.lmp, commands)
        except LammpsError as error:
            raise LammpsError(f"{error}{_CURE if _TOO_DEEP in str(error) else ''}") from None

    def _snapshot(self, residual: float, stalled: bool) -> State:
        """Gather the state of the last evaluation."""
        area, perimeter, contacts, pressure, arc_radius, _ = np.ascontiguousarray(self._results.T)
        xx, yy, _, xy, *_ = self.lmp.numpy.extract_compute("virial", 0, 1)
        positions = gather(self.lmp, "x", 3)[:, :2]
        packing = Packing(positions, self._species, self._radii, self.box, self._particle_radii)
        return State(
            packing=packing,
            law=self.law,
            area=area,
            perimeter=perimeter,
            contacts=contacts.astype(np.int64),
            particle_pressure=pressure,
            arc_radius=arc_radius,
            energy=float(self.lmp.get_thermo("pe")),
            stress=np.array([[xx, xy], [xy, yy]]),
            residual=residual,
            stalled=stalled,
            beyond=round(self.lmp.numpy.extract_compute("beyond", 0, 1)[0]),
            velocities=gather(self.lmp, "v", 3)[:, :2],
            contact_table=contact_table(self._seen, packing, self.comm),
            root=self.comm.rank == 0,
        )

    def _judge(self, state: State, tolerance: float) -> None:
        """Say what is wrong with a relaxed state."""
        phi = state.packing.phi
        unjammed = self._loose and phi >= self._rigid_phi
        self._rigid_phi = np.inf if self._loose else phi
        if not state.root:
            return
        if unjammed:
            warnings.warn(
                f"the packing lost its rigidity at phi = {phi:.5f}: it rearranged into a loose one",
                UnjammedWarning,
                stacklevel=4,
            )
        if state.stalled:
            warnings.warn(
                f"relaxation stalled at phi = {state.phi:.5f}: the largest force is "
                f"{state.residual:.2g} of the mean contact force, not {tolerance:.2g}",
                StalledWarning,
                stacklevel=4,
            )
        if state.beyond:
            warnings.warn(
                f"{state.beyond} particles are beyond the model at phi = {state.phi:.5f}: their "
                "outlines have a negative radius of curvature, as past confluence",
                BeyondModelWarning,
                stacklevel=4,
            )
