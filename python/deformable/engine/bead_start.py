"""Where rings of beads start: undeformed, apart, within walls; as a LAMMPS data file."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..model.beads import Beads, Rings
from ..model.packing import Packing
from ..model.walls import Walls


def undeformed(packing: Packing, rings: Rings) -> list[NDArray[np.float64]]:
    """Beads of undeformed rings around the centers of a packing, arrays (N_v, 2)."""
    positions = []
    for center, kind in zip(packing.positions, packing.species, strict=True):
        turn = 2.0 * np.pi * np.arange(rings.number[kind]) / rings.number[kind]
        positions.append(
            center + rings.radius[kind] * np.column_stack([np.cos(turn), np.sin(turn)])
        )
    return positions


def _translations(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """The shortest lattice vectors but one of each pair v, -v, shape (4, 2) [length]."""
    (lx, _), (xy, ly) = box.tolist()
    upright = [[lx, 0.0], [xy - lx * np.rint(xy / lx), ly]]  # a cell of the same lattice
    return np.array([(1, 0), (-1, 1), (0, 1), (1, 1)]) @ upright


def refuse_overlap(packing: Packing, beads: Beads) -> None:
    """Rings must start apart: deeper in each other, they could stay entangled."""
    steps = _translations(packing.box)
    cell = steps[[0, 2]]
    steps = np.vstack([np.zeros(2), steps, -steps])
    for n, (center, radius) in enumerate(zip(packing.positions, packing.radius, strict=True)):
        apart = packing.positions[n + 1 :] - center
        apart -= np.rint(apart @ np.linalg.inv(cell)) @ cell
        distance = np.hypot(*np.moveaxis(apart[:, None] + steps, -1, 0)).min(axis=1)
        overlap = packing.radius[n + 1 :] + radius - distance
        if overlap.max(initial=0.0) > beads.radius:
            raise ParameterError(
                f"particles {n} and {n + 1 + int(overlap.argmax())} overlap by "
                f"{overlap.max():.3g}, rings may start at most a bead radius {beads.radius:g} in "
                "each other: take a packing at jamming"
            )


def refuse_own_image(
    rings: list[NDArray[np.float64]], box: NDArray[np.float64], radius: float
) -> None:
    """A ring must not reach its own periodic image: beads of one ring do not repel."""
    for step in _translations(box):
        length = np.hypot(*step)
        for n, ring in enumerate(rings):
            if np.ptp(ring @ step) / length + 2.0 * radius > length:
                raise ParameterError(
                    f"particle {n} reaches its own image, {length:.4g} away, which a ring of beads "
                    "does not feel: repeat the packing in that direction"
                )


def refuse_outside(packing: Packing, beads: Beads, walls: Walls) -> None:
    """A ring must start within its walls, and within the box around them."""
    if len(packing) != 1 or packing.positions.any():
        raise ParameterError("walls stand around a single particle at the origin")
    radius = packing.radius[0]
    if packing.box[1, 0] != 0.0 or not (packing.box.diagonal() > 2.0 * radius).all():
        raise ParameterError(
            f"walls need a rectangular box wider than the particle, {2.0 * radius:g}, not "
            f"{packing.box.tolist()}"
        )
    if walls.height.min() <= radius - beads.radius:
        raise ParameterError(
            f"a wall at {walls.height.min():g} cuts through the particle of radius {radius:g}: "
            "start with walls around it, and move them in with confine"
        )


def data_file(packing: Packing, positions: list[NDArray[np.float64]], centered: bool) -> str:
    """LAMMPS data file of rings; the box begins at the origin or is centered on it."""
    (lx, _), (xy, ly) = packing.box.tolist()
    x0, y0 = (-0.5 * lx, -0.5 * ly) if centered else (0.0, 0.0)
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
