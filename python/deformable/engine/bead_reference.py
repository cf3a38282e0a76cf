"""Rings of beads in LAMMPS: the deformable-polygon model, the reference for the contact laws."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..common.errors import ParameterError, StalledWarning
from ..common.progress import progress
from ..common.validate import positive
from ..model.beads import Beads
from ..model.packing import Packing
from ..model.walls import Walls
from ..state.bead_state import BeadState, sum_contacts
from .bead_start import data_file, refuse_outside, refuse_overlap, refuse_own_image, undeformed
from .lammps import Engine, change_box, gather, local_array, run, silent_lammps

_SETUP = """
neigh_modify exclude molecule/intra all
pair_style harmonic/cut
pair_coeff * * {pair!r} {diameter!r}
bond_style harmonic
{bonds}
neighbor {skin!r} bin
comm_modify cutoff {ghosts!r}
neigh_modify delay 0 every 1 check yes
{areas}
compute virial all pressure NULL virial
compute pairs all property/local patom1 patom2
compute overlaps all pair/local dx dy fx fy
thermo_style custom step pe c_virial[1] c_virial[2] c_virial[4]
thermo_modify norm no
min_style fire
min_modify dmax {dmax!r} norm max tmax 2.0
timestep {timestep!r}
"""

# FIRE's largest time step times the fastest frequency.
# Measured (benchmarks/bead_minimizers.py): best up to 1.4, no convergence from 1.5 or 1.6 on.
_LARGEST_STEP = 1.35

# Iterations of one call of the minimizer, and those without halving the smallest residual after
# which a relaxation counts as stalled: rough rings creep through many small rearrangements.
_ITERATIONS, _PATIENCE = 20_000, 2_000_000

# Forces of springs are known to a few roundings of the beads' coordinates: forces up to so many
# roundings count as none.
_ROUNDINGS = 8.0


class BeadReference(Engine):
    """Rings of beads in LAMMPS, with the calls of `Simulation`.

    Every rank of an MPI run makes the same calls and sees the same values.

    Args:
        packing: where the particles start; each becomes an undeformed ring around its center.
        beads: what rings are made of.
        walls: around a single particle at the origin, in the place of neighbors.
        comm: as for `Simulation`.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS.
        beads: what rings are made of.
        rings: the undeformed rings of each species.
        walls: as they stand now, or None.
        comm: the communicator.

    Raises:
        ParameterError: beads too large or too few, rings that overlap at the start or reach their
            own periodic image, walls that are not around a single particle, or a packing whose
            particles have sizes of their own.
        LammpsError: LAMMPS refuses the rings.
    """

    def __init__(
        self,
        packing: Packing,
        beads: Beads | None = None,
        walls: Walls | None = None,
        comm: MPI.Comm | None = None,
    ) -> None:
        self.beads = beads = Beads() if beads is None else beads
        self.comm = MPI.COMM_WORLD if comm is None else comm
        packing = self.comm.bcast(packing)
        if packing.particle_radii is not None:
            raise ParameterError(
                "rings of beads have the sizes of their species: give each size one of its own, "
                "not `particle_radii`"
            )
        self.rings = rings = beads.rings(packing.radii)
        self._species, self._radii = packing.species, packing.radii
        self._first = np.concatenate([[0], np.cumsum(rings.number[packing.species])])
        positions = undeformed(packing, rings)
        self.walls = walls
        if walls is None:
            refuse_overlap(packing, beads)
            refuse_own_image(positions, packing.box, beads.radius)
        else:
            refuse_outside(packing, beads, walls)
        self.lmp = silent_lammps(self.comm)
        with tempfile.TemporaryDirectory() as folder:
            file = self.comm.bcast(str(Path(folder, "rings.data")))
            if self.comm.rank == 0:
                Path(file).write_text(data_file(packing, positions, centered=walls is not None))
            if walls is not None:
                run(self.lmp, "boundary f f p")
            run(self.lmp, f'atom_style bond\nread_data "{file}"')
        bonds = "\n".join(
            f"bond_coeff {n} {float(0.5 * kL)!r} {float(spacing)!r}"  # LAMMPS has no 1/2
            for n, (kL, spacing) in enumerate(zip(rings.kL, rings.spacing, strict=True), start=1)
        )
        # one fix for each stiffness, with the rings that have it
        areas = ""
        self._areas: list[tuple[str, NDArray[np.int64]]] = []
        for n, kA in enumerate(np.unique(rings.kA[packing.species]).tolist()):
            alike = np.flatnonzero(rings.kA[packing.species] == kA)
            types = " ".join(str(kind + 1) for kind in np.unique(packing.species[alike]))
            areas += f"group alike{n} type {types}\n"
            areas += f"fix area{n} alike{n} deformable/polygon {kA!r}\n"
            self._areas.append((f"area{n}", alike))
        skin = 0.5 * beads.radius
        run(
            self.lmp,
            _SETUP.format(
                pair=0.5 * beads.kr,
                diameter=2.0 * beads.radius,
                bonds=bonds,
                skin=skin,
                # springs reach for a far image of a bead if the near one is no ghost
                ghosts=max(2.0 * beads.radius + skin, 2.0 * float(rings.spacing.max())),
                areas=areas,
                dmax=0.1 * beads.radius,
                timestep=0.5 * _LARGEST_STEP / rings.fastest_frequency(beads.kr),
            ),
        )
        if walls is not None:
            self._stand(walls)
            run(self.lmp, f"fix walls all {_wall_style(beads, walls.stick)}")
            run(self.lmp, "fix_modify walls energy yes")

    def deform(self, box: NDArray[np.float64]) -> None:
        """Give the box other lattice vectors, and let the beads follow affinely.

        Args:
            box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].

        Raises:
            ParameterError: the box has another form, or there are walls, which `confine` moves; the
                simulation stays as it was.
        """
        if self.walls is not None:
            raise ParameterError("walls do not follow the box: move them with confine")
        change_box(self.lmp, box)

    def confine(self, walls: Walls) -> None:
        """Move the walls; beads that stick to one keep their place along it.

        Args:
            walls: as many as before, sticking or slipping as before; heights are those that a
                particle of radius R meets.

        Raises:
            ParameterError: there were no such walls before, or a bead would be beyond one; the
                simulation stays as it was.
        """
        before = self.walls
        if before is None or (len(walls.angle), walls.stick) != (len(before.angle), before.stick):
            raise ParameterError(
                "confine moves the walls that are there: their number and kind stay"
            )
        reach = walls.height - (gather(self.lmp, "x", 3)[:, :2] @ walls.normal.T).max(axis=0)
        if reach.min() <= 0.0:
            side = int(reach.argmin())
            raise ParameterError(
                f"a step of {before.height[side] - walls.height[side]:.3g} puts beads "
                f"{-reach[side]:.3g} beyond wall {side}: relax, and take steps below the radius of "
                f"a bead, {self.beads.radius:g}"
            )
        run(self.lmp, "\n".join(f"region {name} delete" for name in ("walls", *_sides(before))))
        self._stand(walls)

    def _stand(self, walls: Walls) -> None:
        """Define the region within the walls."""
        for side, (nx, ny), height in zip(
            _sides(walls), walls.normal.tolist(), walls.height.tolist(), strict=True
        ):
            run(
                self.lmp,
                f"region {side} plane {height * nx!r} {height * ny!r} 0 {-nx!r} {-ny!r} 0",
            )
        run(self.lmp, f"region walls intersect {len(walls.angle)} {' '.join(_sides(walls))}")
        self.walls = walls

    def relax(self, tolerance: float = 1e-3) -> BeadState:
        """Minimize the energy by FIRE until no force exceeds a part of what a bead bears.

        Args:
            tolerance: largest force on a bead over that of a bead in a contact, see
                `BeadState.residual`.

        Returns:
            The relaxed state; its `stalled` is true where the tolerance was not reached.

        Raises:
            LammpsError: LAMMPS gave up.
            ParameterError: a ring reached its own periodic image.

        Warns:
            StalledWarning: the forces stopped falling.
        """
        positive("tolerance", tolerance)
        residual = self._evaluate()
        best, patience = residual, _PATIENCE
        with progress("relaxing rings", unit="step") as bar:
            while residual > tolerance and patience > 0:
                # the scale falls while the packing relaxes
                force = 0.9 * max(tolerance * self._force_scale, self._rounding)
                run(self.lmp, f"minimize 0 {force!r} {_ITERATIONS} {2 * _ITERATIONS}")
                residual = self._evaluate()
                patience -= _ITERATIONS
                if residual < 0.5 * best:
                    best, patience = residual, _PATIENCE
                bar.set_postfix(residual=f"{residual:.2g}", tolerance=f"{tolerance:.2g}")
                bar.update(_ITERATIONS)
        stalled = residual > tolerance
        if stalled and self.comm.rank == 0:
            warnings.warn(
                f"relaxation of bead rings stalled: the largest force is {residual:.2g} of that on "
                f"a bead in contact, not {tolerance:.2g}",
                StalledWarning,
                stacklevel=2,
            )
        return self._snapshot(residual, stalled)

    def state(self) -> BeadState:
        """The present state, not relaxed."""
        return self._snapshot(self._evaluate(), stalled=False)

    def _evaluate(self) -> float:
        """Bring forces, areas and perimeters up to date; returns the residual."""
        run(self.lmp, "run 0 post no")
        self._area, self._perimeter = np.empty((2, len(self._species)))
        for fix, alike in self._areas:
            measured = [
                [self.lmp.extract_fix(fix, 0, 2, row, column) for column in range(2)]
                for row in range(len(alike))
            ]
            self._area[alike], self._perimeter[alike] = np.array(measured).T
        largest = float(np.linalg.norm(gather(self.lmp, "f", 3), axis=1).max())
        deficit = np.maximum(self.rings.area[self._species] - self._area, 0.0)
        borne = self.rings.kA * self.rings.spacing
        self._force_scale = float(np.mean(borne[self._species] * deficit))
        coordinate = float(np.abs(self.box).sum(axis=0).max())
        stiffest = float(self.rings.kL.max())
        self._rounding = _ROUNDINGS * stiffest * coordinate * float(np.finfo(float).eps)
        if largest <= self._rounding:
            return 0.0
        return largest / max(self._force_scale, self._rounding)

    def _snapshot(self, residual: float, stalled: bool) -> BeadState:
        """Gather the state of the last evaluation."""
        box = self.box
        positions = gather(self.lmp, "x", 3)[:, :2]
        image = np.array(self.lmp.gather("image", 0, 3)).reshape(-1, 3)[:, :2]
        outlines = np.split(positions + image @ box, self._first[1:-1])
        if self.walls is None:
            refuse_own_image(outlines, box, self.beads.radius)
        centers = np.array([outline.mean(axis=0) for outline in outlines])
        parts = self.comm.allgather(
            (local_array(self.lmp, "pairs", 2), local_array(self.lmp, "overlaps", 4))
        )
        pairs, overlaps = (np.concatenate(column) for column in zip(*parts, strict=True))
        xx, yy, _, xy, *_ = self.lmp.numpy.extract_compute("virial", 0, 1)
        return BeadState(
            packing=Packing(centers, self._species, self._radii, box),
            beads=self.beads,
            rings=self.rings,
            outlines=outlines,
            area=self._area,
            perimeter=self._perimeter,
            contacts=sum_contacts(np.vstack(outlines), self._first, pairs, overlaps, box),
            energy=float(self.lmp.get_thermo("pe")),
            stress=np.array([[xx, xy], [xy, yy]]),
            residual=residual,
            stalled=stalled,
        )


def _sides(walls: Walls) -> list[str]:
    """Names of the regions of single walls."""
    return [f"side{n}" for n in range(len(walls.angle))]


def _wall_style(beads: Beads, stick: bool) -> str:
    """Walls press like beads do; the harmonic wall of LAMMPS has no 1/2, and ignores its sigma."""
    if stick:
        return f"deformable/stick walls {beads.kr!r} radius {beads.radius!r}"
    return f"wall/region walls harmonic {0.5 * beads.kr!r} 1.0 {beads.radius!r}"
