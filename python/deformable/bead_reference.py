"""Rings of beads in LAMMPS: the deformable-polygon model, the reference for the contact laws."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path
from types import TracebackType

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .bead_state import BeadState, RingContacts
from .beads import Beads, Rings
from .engine import change_box, gather, lattice, local_array, run, silent_lammps
from .errors import ParameterError, StalledWarning
from .packing import Packing, positive
from .walls import Walls

_SETUP = """
special_bonds lj 1 1 1
neigh_modify exclude molecule/intra all
pair_style harmonic/cut
pair_coeff * * {pair!r} {diameter!r}
bond_style harmonic
{bonds}
neighbor {skin!r} bin
neigh_modify delay 0 every 1 check yes
fix area all deformable/polygon {kA!r}
compute virial all pressure NULL virial
thermo_style custom step pe c_virial[1] c_virial[2] c_virial[4]
thermo_modify norm no
min_style fire
min_modify dmax {dmax!r} norm max tmax 2.0
timestep {timestep!r}
"""

# FIRE's largest time step times the fastest frequency, of a spring whose beads touch others too.
# It is stable up to 2; benchmarks/bead_minimisers.py has what other steps and minimisers need.
_LARGEST_STEP = 1.25

# Iterations of one call of the minimiser, and those without halving the smallest residual after
# which a relaxation counts as stalled: rough rings creep through many small rearrangements.
_ITERATIONS, _PATIENCE = 20_000, 2_000_000

# Relative area deficit below which a ring counts as free.
_LOOSE = 1e-12

# Overlapping beads with their forces, for one evaluation.
_OVERLAPS = """
compute beads all property/local patom1 patom2
compute overlaps all pair/local dx dy fx fy
run 0 post no
"""


class BeadReference:
    """Rings of beads in LAMMPS, with the calls of `Simulation`.

    Every rank of an MPI run makes the same calls and sees the same values.

    Args:
        packing: where the particles start; each becomes an undeformed ring around its centre.
        beads: what rings are made of.
        walls: around a single particle at the origin, in the place of neighbours.
        comm: as for `Simulation`.

    Attributes:
        lmp: the LAMMPS instance, for any command of LAMMPS.
        beads: what rings are made of.
        rings: the undeformed rings of each species.
        comm: the communicator.

    Raises:
        ParameterError: beads too large or too few, rings that overlap at the start, or walls around
            more than one particle.
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
        self.rings = rings = beads.rings(packing.radii)
        self._species, self._radii = packing.species, packing.radii
        self._first = np.concatenate([[0], np.cumsum(rings.number[packing.species])])
        positions = _undeformed(packing, rings)
        if walls is None:
            _refuse_overlap(packing, beads)
        self.walls = walls
        if walls is not None and (len(packing) != 1 or packing.positions.any()):
            raise ParameterError("walls stand around a single particle at the origin")
        self.lmp = silent_lammps(self.comm)
        with tempfile.TemporaryDirectory() as folder:
            file = self.comm.bcast(str(Path(folder, "rings.data")))
            if self.comm.rank == 0:
                Path(file).write_text(_data_file(packing, positions, centred=walls is not None))
            if walls is not None:
                run(self.lmp, "boundary f f p")
            run(self.lmp, f'atom_style bond\nread_data "{file}"')
        bonds = "\n".join(
            f"bond_coeff {n} {0.5 * beads.kL!r} {float(spacing)!r}"  # LAMMPS has no 1/2
            for n, spacing in enumerate(rings.spacing, start=1)
        )
        run(
            self.lmp,
            _SETUP.format(
                pair=0.5 * beads.kr,
                diameter=2.0 * beads.radius,
                bonds=bonds,
                skin=0.5 * beads.radius,
                kA=beads.kA,
                dmax=0.1 * beads.radius,
                timestep=0.5 * _LARGEST_STEP / float(np.sqrt(4.0 * (beads.kL + beads.kr))),
            ),
        )
        if walls is not None:
            self._stand(walls)
            style = "deformable/stick walls {}" if walls.stick else "wall/region walls harmonic {}"
            run(self.lmp, f"fix walls all {style.format(_wall_arguments(beads, walls.stick))}")

    def close(self) -> None:
        """Free the LAMMPS instance."""
        self.lmp.close()

    def __enter__(self) -> BeadReference:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def box(self) -> NDArray[np.float64]:
        """Lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length]."""
        return lattice(self.lmp)

    def deform(self, box: NDArray[np.float64]) -> None:
        """Give the box other lattice vectors, and let the beads follow affinely.

        Args:
            box: lattice vectors as rows, ((lx, 0), (xy, ly)), shape (2, 2) [length].

        Raises:
            ParameterError: the box has another form; the simulation stays as it was.
        """
        change_box(self.lmp, box)

        change_box(self.lmp, box)

    def confine(self, walls: Walls) -> None:
        """Move the walls; beads that stick to one keep their place along it.

        Args:
            walls: as many as before, sticking or slipping as before; heights are those that a
                particle of radius R meets.

        Raises:
            ParameterError: there were no such walls before.
        """
        before = self.walls
        if before is None or (len(walls.angle), walls.stick) != (len(before.angle), before.stick):
            raise ParameterError(
                "confine moves the walls that are there: their number and kind stay"
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
        """Minimise the energy by FIRE until no force exceeds a part of what a bead bears.

        Args:
            tolerance: largest force on a bead over that of a bead in a contact, see
                `BeadState.residual`.

        Returns:
            The relaxed state; its `stalled` is true where the tolerance was not reached.

        Raises:
            LammpsError: LAMMPS gave up.

        Warns:
            StalledWarning: the forces stopped falling.
        """
        positive("tolerance", tolerance)
        residual, scale = self._evaluate()
        best, patience = residual, _PATIENCE
        while residual > tolerance and patience > 0:
            force = 0.9 * tolerance * scale  # the scale falls while the packing relaxes
            run(self.lmp, f"minimize 0 {force!r} {_ITERATIONS} {2 * _ITERATIONS}")
            residual, scale = self._evaluate()
            patience -= _ITERATIONS
            if residual < 0.5 * best:
                best, patience = residual, _PATIENCE
        stalled = residual > tolerance
        if stalled:
            warnings.warn(
                f"relaxation of bead rings stalled: the largest force is {residual:.2g} of that on "
                f"a bead in contact, not {tolerance:.2g}",
                StalledWarning,
                stacklevel=2,
            )
        return self._snapshot(residual, stalled)

    def state(self) -> BeadState:
        """The present state, not relaxed."""
        return self._snapshot(self._evaluate()[0], stalled=False)

    def _evaluate(self) -> tuple[float, float]:
        """Bring forces up to date; the residual and the force it is measured by."""
        run(self.lmp, "run 0 post no")
        count = len(self._species)
        measured = [
            [self.lmp.extract_fix("area", 0, 2, m, column) for column in range(2)]
            for m in range(count)
        ]
        self._area, self._perimeter = np.array(measured).T
        deficit = self.rings.area[self._species] - self._area
        bearing = deficit > _LOOSE * self._area
        largest = float(np.linalg.norm(gather(self.lmp, "f", 3), axis=1).max())
        if not bearing.any():
            return 0.0 if largest == 0.0 else np.inf, 0.0
        spacing = self.rings.spacing[self._species]
        scale = float(np.mean((self.beads.kA * deficit * spacing)[bearing]))
        return largest / scale, scale

    def _snapshot(self, residual: float, stalled: bool) -> BeadState:
        """Gather the state of the last evaluation."""
        box = self.box
        positions = gather(self.lmp, "x", 3)[:, :2]
        image = np.array(self.lmp.gather("image", 0, 3)).reshape(-1, 3)[:, :2]
        outlines = np.split(positions + image @ box, self._first[1:-1])
        centres = np.array([outline.mean(axis=0) for outline in outlines])
        xx, yy, _, xy, *_ = self.lmp.numpy.extract_compute("virial", 0, 1)
        return BeadState(
            packing=Packing(centres, self._species, self._radii, box),
            beads=self.beads,
            rings=self.rings,
            outlines=outlines,
            area=self._area,
            perimeter=self._perimeter,
            contacts=self._contacts(np.vstack(outlines), box),
            energy=float(self.lmp.get_thermo("pe")),
            stress=np.array([[xx, xy], [xy, yy]]),
            residual=residual,
            stalled=stalled,
        )

    def _contacts(self, beads: NDArray[np.float64], box: NDArray[np.float64]) -> RingContacts:
        """Sum the forces of overlapping beads by pairs of rings."""
        run(self.lmp, _OVERLAPS)
        tags = local_array(self.lmp, "beads", 2)
        overlaps = local_array(self.lmp, "overlaps", 4)
        parts = self.comm.allgather((tags - 1.0, overlaps))
        run(self.lmp, "uncompute beads\nuncompute overlaps")
        pairs, overlaps = (np.concatenate(column) for column in zip(*parts, strict=True))
        a, b = pairs.astype(np.int64).T
        # an exact integer, the same for all beads of a contact whatever their rounding
        apart = beads[a] - overlaps[:, :2] - beads[b]
        image = np.rint(apart @ np.linalg.inv(box)).astype(np.int64)
        i, j = (np.searchsorted(self._first, bead, side="right") - 1 for bead in (a, b))
        force = overlaps[:, 2:]
        # each pair of rings once, from its lower number, or from the right if a ring meets itself
        turn = (i > j) | ((i == j) & ((image[:, 0] < 0) | ((image[:, 0] == 0) & (image[:, 1] < 0))))
        i, j = np.where(turn, j, i), np.where(turn, i, j)
        sign = np.where(turn, -1, 1)[:, None]
        keys, which = np.unique(np.column_stack([i, j, sign * image]), axis=0, return_inverse=True)
        total = np.zeros((len(keys), 2))
        np.add.at(total, which.ravel(), sign * force)
        return RingContacts(i=keys[:, 0], j=keys[:, 1], image=keys[:, 2:], force=total)


def _sides(walls: Walls) -> list[str]:
    """Names of the regions of single walls."""
    return [f"side{n}" for n in range(len(walls.angle))]


def _wall_arguments(beads: Beads, stick: bool) -> str:
    """Walls press like beads do; the harmonic wall of LAMMPS has no 1/2, and ignores its sigma."""
    if stick:
        return f"{beads.kr!r} radius {beads.radius!r}"
    return f"{0.5 * beads.kr!r} 1.0 {beads.radius!r}"


def _undeformed(packing: Packing, rings: Rings) -> list[NDArray[np.float64]]:
    """Beads of undeformed rings around the centres of a packing, arrays (N_v, 2)."""
    positions = []
    for centre, kind in zip(packing.positions, packing.species, strict=True):
        turn = 2.0 * np.pi * np.arange(rings.number[kind]) / rings.number[kind]
        positions.append(
            centre + rings.radius[kind] * np.column_stack([np.cos(turn), np.sin(turn)])
        )
    return positions


def _refuse_overlap(packing: Packing, beads: Beads) -> None:
    """Rings must start apart: deeper in each other, they could stay entangled."""
    steps = np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)]) @ packing.box
    for n, (centre, radius) in enumerate(zip(packing.positions, packing.radius, strict=True)):
        apart = packing.positions[n:, None] + steps - centre
        overlap = (packing.radius[n:] + radius)[:, None] - np.hypot(*np.moveaxis(apart, -1, 0))
        overlap[0, len(steps) // 2] = 0.0  # itself
        if overlap.max() > beads.radius:
            other = n + int(overlap.max(axis=1).argmax())
            raise ParameterError(
                f"particles {n} and {other} overlap by {overlap.max():.3g}, rings may start "
                f"at most a bead radius {beads.radius:g} in each other: take a packing at jamming"
            )


def _data_file(packing: Packing, positions: list[NDArray[np.float64]], centred: bool) -> str:
    """LAMMPS data file of rings; the box begins at the origin or is centred on it."""
    (lx, _), (xy, ly) = packing.box.tolist()
    x0, y0 = (-0.5 * lx, -0.5 * ly) if centred else (0.0, 0.0)
    species = len(packing.radii)
    total = sum(len(ring) for ring in positions)
    atoms, bonds = [], []
    first = 1
    for m, (ring, kind) in enumerate(zip(positions, packing.species, strict=True), start=1):
        last = first + len(ring) - 1
        for tag, (x, y) in enumerate(ring.tolist(), start=first):
            atoms.append(f"{tag} {m} {kind + 1} {x!r} {y!r} 0")
            bonds.append(f"{tag} {kind + 1} {tag} {tag + 1 if tag < last else first}")
        first = last + 1
    head = f"""bead rings

{total} atoms
{total} bonds
{species} atom types
{species} bond types
{x0!r} {x0 + lx!r} xlo xhi
{y0!r} {y0 + ly!r} ylo yhi
-0.5 0.5 zlo zhi
{xy!r} 0 0 xy xz yz

Masses

"""
    masses = [f"{n} 1" for n in range(1, species + 1)]
    return head + "\n".join([*masses, "\nAtoms # bond\n", *atoms, "\nBonds\n", *bonds, ""])
