"""Deformable polygons in LAMMPS, smooth or of beads: the references of the laws."""

from __future__ import annotations

import warnings
from functools import partial

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ._checks import expect, positive
from .box import cartesian, refuse_space
from .commands import (
    minimizer_commands,
    polygon_contact_commands,
    polygon_wall_commands,
    region_within,
    without_region,
)
from .errors import ParameterError, StalledWarning
from .lammps import (
    Engine,
    communicator,
    gather,
    local_array,
    refuse_other,
    refuse_other_types,
    run,
    setup,
    shared_file,
    silent_lammps,
)
from .packing import Packing
from .polygons import (
    DeformablePolygon,
    Walls,
    polygon_file,
    refuse_own_image,
    refuse_start,
    undeformed,
)
from .progress import progress
from .relax import (
    Forces,
    largest_force,
    largest_force_told,
    minimize_command,
    minimize_until_relaxed,
    polygon_forces,
    stress,
    thermo_commands,
    virial_command,
)
from .smooth_polygons import SmoothPolygons, relax_smooth
from .state import PolygonContacts, PolygonState, steiner_point, sum_contacts

_SETUP = """
neigh_modify exclude molecule/intra all
{contacts}
bond_style harmonic
{bonds}
comm_modify cutoff {ghosts!r}
{areas}
timestep {timestep!r}
"""

# FIRE's largest time step times the fastest frequency, and how far FIRE may stretch its first step.
# Measured (benchmarks/bead_minimizers.py): best up to 1.4, no convergence from 1.5 or 1.6 on.
_LARGEST_STEP, _STRETCH = 1.35, 2.0

# Iterations of one call of the minimizer, and those without halving the smallest residual after
# which a relaxation counts as stalled: bead polygons go through many small rearrangements.
_ITERATIONS, _PATIENCE = 20_000, 2_000_000

# Residuals at which relaxations end by default: by FIRE, and by Newton's method.
_FIRE_TOLERANCE, _NEWTON_TOLERANCE = 1e-3, 1e-6


class PolygonSimulation(Engine):
    """Polygons in LAMMPS, smooth or of beads, with the calls of `Simulation`.

    Every rank of an MPI run must make the same calls, and gets the same values.

    Args:
        packing: where the particles start; each becomes an undeformed polygon around its center.
        model: settings of the polygons.
        walls: around a single particle at the origin, instead of neighbors.
        comm: as for `Simulation`.

    Attributes:
        lmp: the LAMMPS instance, for commands that leave beads, springs and pair style as they are.
        model: settings of the polygons.
        polygons: the undeformed polygons of each species.
        walls: the present walls, or None.
        comm: the communicator.

    Raises:
        ParameterError: beads are too large or too few, polygons overlap at the start or reach their
            own periodic images, walls are not around a single particle, or particles have radii of
            their own.
        LammpsError: LAMMPS refuses the polygons.
    """

    def __init__(
        self,
        packing: Packing,
        model: DeformablePolygon | None = None,
        walls: Walls | None = None,
        comm: MPI.Comm | None = None,
    ) -> None:
        self.model = model = DeformablePolygon() if model is None else model
        expect("packing", packing, Packing)
        expect("model", model, DeformablePolygon)
        expect("walls", walls, Walls, type(None))
        self.comm = communicator(comm)
        packing = self.comm.bcast(packing)
        refuse_space("a polygon", packing.dimension, "take soft spheres, `Spheres`")
        if packing.walls:
            raise ParameterError(
                "polygons have no walls but `Walls` around a single one: replace the packing "
                "by one without walls"
            )
        if packing._own_radii:
            raise ParameterError(
                "polygons have the radii of their species: give each size a species of its own"
            )
        self.polygons = polygons = model.polygons(packing._species_radii)
        self._species, self._radii = packing.species, packing._species_radii
        self._first = np.concatenate([[0], np.cumsum(polygons.number[packing.species])])
        positions = undeformed(packing, polygons)
        self.walls = walls
        refuse_start(packing, positions, model, walls)
        self.lmp = silent_lammps(self.comm)
        if walls is not None:
            run(self.lmp, "boundary f f p")
        with shared_file(self.comm, polygon_file(packing, positions, walls is not None)) as file:
            run(self.lmp, f'atom_style bond\nread_data "{file}"')
        self._define_energy()
        if walls is not None:
            run(self.lmp, f"{region_within(walls)}\n{polygon_wall_commands(model, walls.stick)}")
        self._setup = setup(self.lmp)

    def _define_energy(self) -> None:
        """Define springs, areas and contacts, their results, and the minimizer."""
        model, polygons, species = self.model, self.polygons, self._species
        longest = float(polygons.spacing.max())
        bonds = "\n".join(
            f"bond_coeff {n} {float(0.5 * kL)!r} {float(spacing)!r}"  # LAMMPS has no 1/2
            for n, (kL, spacing) in enumerate(
                zip(polygons.kL, polygons.spacing, strict=True), start=1
            )
        )
        # one fix for each area stiffness, with its polygons
        areas = ""
        self._areas: list[tuple[str, NDArray[np.int64]]] = []
        for n, kA in enumerate(np.unique(polygons.kA[species]).tolist()):
            members = np.flatnonzero(polygons.kA[species] == kA)
            types = " ".join(str(kind + 1) for kind in np.unique(species[members]))
            areas += f"group members{n} type {types}\n"
            areas += f"fix area{n} members{n} deformable/polygon {kA!r}\n"
            self._areas.append((f"area{n}", members))
        skin = 0.5 * model.radius
        run(
            self.lmp,
            _SETUP.format(
                contacts=polygon_contact_commands(model, longest),
                bonds=bonds,
                # a spring connects to a far image of a bead if the near one is no ghost
                ghosts=max(2.0 * model.radius + skin, 2.0 * longest),
                areas=areas,
                timestep=_LARGEST_STEP / _STRETCH / polygons.fastest_frequency(model.kr),
            ),
        )
        run(self.lmp, virial_command() + thermo_commands("pe"))
        run(self.lmp, minimizer_commands(skin, dmax=0.1 * model.radius, tmax=_STRETCH))

    def deform(self, box: NDArray[np.float64]) -> None:
        """Give the box other lattice vectors; the beads follow affinely.

        Args:
            box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].

        Raises:
            ParameterError: the box has another form, or there are walls, which `confine` moves; the
                simulation is unchanged.
        """
        if self.walls is not None:
            raise ParameterError("walls do not follow the box: move them with confine")
        super().deform(box)

    def confine(self, walls: Walls) -> None:
        """Move the walls; beads that stick to one keep their place along it.

        Args:
            walls: as many as before, and sticking or slipping as before. An undeformed particle
                of radius R touches a wall of height R.

        Raises:
            ParameterError: there were no such walls before, or a bead would be beyond one; the
                simulation is unchanged.
        """
        expect("walls", walls, Walls)
        before = self.walls
        if before is None or (len(walls.angle), walls.stick) != (len(before.angle), before.stick):
            raise ParameterError(
                "confine only moves walls: their number, and stick, must be as before"
            )
        gap = walls.height - (gather(self.lmp, "x", 3)[:, :2] @ walls.normal.T).max(axis=0)
        if gap.min() <= 0.0:
            side = int(gap.argmin())
            raise ParameterError(
                f"a step of {before.height[side] - walls.height[side]:.3g} puts beads "
                f"{-gap[side]:.3g} beyond wall {side}: relax, and take steps below the radius of "
                f"a bead, {self.model.radius:g}"
            )
        run(self.lmp, without_region(before))
        run(self.lmp, region_within(walls))
        self.walls = walls

    def relax(self, tolerance: float | None = None) -> PolygonState:
        """Minimize the energy until forces are small against those on beads in contact.

        Smooth polygons without walls take steps of Newton's method, see `relax_smooth`; others
        FIRE.

        Args:
            tolerance: largest residual, see `PolygonState.residual`; by default 1e-3 with FIRE, and
                1e-6 with Newton's method.

        Returns:
            The relaxed state; its `stalled` is true if the tolerance was not reached.

        Raises:
            LammpsError: LAMMPS gave up.
            ParameterError: a polygon reached its own periodic image.

        Warns:
            StalledWarning: the forces stopped falling.
        """
        newton = self.model.smooth and self.walls is None
        if tolerance is None:
            tolerance = _NEWTON_TOLERANCE if newton else _FIRE_TOLERANCE
        positive("tolerance", tolerance)
        forces = self._by_newton(tolerance) if newton else self._by_fire(tolerance)
        stalled = forces.residual > tolerance
        if stalled and self.comm.rank == 0:
            warnings.warn(
                "relaxation of polygons stalled: "
                + largest_force_told(forces.residual, "that on a bead in a contact", tolerance),
                StalledWarning,
                stacklevel=2,
            )
        return self._snapshot(forces, stalled)

    def _by_fire(self, tolerance: float) -> Forces:
        with progress("relaxing polygons", unit="step") as bar:

            def minimize(forces: Forces, left: int) -> int:
                force = 0.9 * max(tolerance * forces.scale, forces.rounding)
                run(self.lmp, minimize_command(force, _ITERATIONS))
                bar.update(_ITERATIONS)
                return _ITERATIONS

            def evaluate() -> Forces:
                forces = self._evaluate()
                bar.set_postfix(residual=f"{forces.residual:.2g}", tolerance=f"{tolerance:.2g}")
                return forces

            # the scale falls while the packing relaxes
            return minimize_until_relaxed(
                self._evaluate(),
                tolerance,
                _PATIENCE,
                minimize,
                evaluate,
                indicator=lambda forces: forces.residual,
            )

    def _by_newton(self, tolerance: float) -> Forces:
        forces = self._evaluate()  # LAMMPS refuses polygons that cannot be relaxed
        if forces.residual <= tolerance:
            return forces
        with progress("relaxing polygons", unit="step") as bar:

            def each(residual: float) -> None:
                bar.update()
                bar.set_postfix(residual=f"{residual:.2g}", tolerance=f"{tolerance:.2g}")

            x, shift = self._positions()
            relaxed = None
            if self.comm.rank == 0:  # ranks would only differ by roundings, but must not
                relaxed = relax_smooth(self._smooth(), x + shift, 0.9 * tolerance, each)
            placed = np.zeros((len(x), 3))
            placed[:, :2] = self.comm.bcast(relaxed) - shift
        self.lmp.scatter("x", 1, 3, np.ctypeslib.as_ctypes(placed.ravel()))
        return self._evaluate()

    def _smooth(self) -> SmoothPolygons:
        return SmoothPolygons(self.model, self.polygons, self._species, self.box)

    def _positions(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Places of the beads in the box, and the shifts that unwrap polygons, shape (V, 2)."""
        image = np.array(self.lmp.gather("image", 0, 3)).reshape(-1, 3)[:, :2]
        return gather(self.lmp, "x", 3)[:, :2], cartesian(image, self.box)

    def state(self) -> PolygonState:
        """The present state, not relaxed."""
        return self._snapshot(self._evaluate(), stalled=False)

    def _evaluate(self) -> Forces:
        """Bring forces, areas and perimeters up to date; returns the forces."""
        refuse_other(self.lmp, self._setup)
        refuse_other_types(self.lmp, np.repeat(self._species + 1, np.diff(self._first)))
        run(self.lmp, "run 0 post no")
        self._area, self._perimeter = np.empty((2, len(self._species)))
        for fix, members in self._areas:
            measured = [
                [self.lmp.extract_fix(fix, 0, 2, row, column) for column in range(2)]
                for row in range(len(members))
            ]
            self._area[members], self._perimeter[members] = np.array(measured).T
        polygons, kind = self.polygons, self._species
        pressure = polygons.kA[kind] * (polygons.area[kind] - self._area)
        largest = largest_force(self.lmp)
        return polygon_forces(largest, pressure, polygons.spacing[kind], self.box, polygons.kL)

    def _snapshot(self, forces: Forces, stalled: bool) -> PolygonState:
        """The state at the last evaluation."""
        box = self.box
        vertices = np.sum(self._positions(), axis=0)
        outlines = np.split(vertices, self._first[1:-1])
        if self.walls is None:
            refuse_own_image(outlines, box, self.model.radius)
        center = steiner_point if self.model.smooth else partial(np.mean, axis=0)
        centers = np.array([center(outline) for outline in outlines])
        return PolygonState(
            packing=Packing._of_species(centers, self._species, self._radii, box),
            model=self.model,
            polygons=self.polygons,
            outlines=outlines,
            area=self._area,
            perimeter=self._perimeter,
            contact_table=self._contacts(vertices),
            energy=float(self.lmp.get_thermo("pe")),
            stress=stress(self.lmp),
            residual=forces.residual,
            stalled=stalled,
        )

    def _contacts(self, vertices: NDArray[np.float64]) -> PolygonContacts:
        """The contacts of polygons at the last evaluation, which was at these vertices."""
        if self.model.smooth:
            pairs, overlaps = self._smooth().energy(vertices).touches()
        else:
            parts = self.comm.allgather(
                (local_array(self.lmp, "pairs", 2) - 1, local_array(self.lmp, "overlaps", 4))
            )
            pairs, overlaps = (np.concatenate(column) for column in zip(*parts, strict=True))
        return sum_contacts(vertices, self._first, pairs.astype(np.int64), overlaps, self.box)
