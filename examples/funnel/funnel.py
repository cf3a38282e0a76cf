"""An emulsion comes to rest in a funnel of triangles, from an STL file."""

from itertools import pairwise
from pathlib import Path

import lammps_deformable as ld
import numpy as np

FILE, SIDES = Path("funnel.stl"), 12
RADIUS, HEIGHT = (0.8, 3.0, 3.0), (0.0, 2.5, 6.0)  # of the rings of corners, from below


def triangles() -> np.ndarray:
    """The funnel with a bottom and a lid, shape (n, 3, 3)."""
    angle = 2.0 * np.pi * np.arange(SIDES + 1) / SIDES
    around = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)
    rings = [r * around + [0.0, 0.0, z] for r, z in zip(RADIUS, HEIGHT, strict=True)]
    found = []
    for low, high in pairwise(rings):
        for (a, b), (d, c) in zip(pairwise(low), pairwise(high), strict=True):
            found += [(a, b, c), (a, c, d)]
    for ring in (rings[0], rings[-1]):
        middle = np.array([0.0, 0.0, ring[0, 2]])
        found += [(middle, a, b) for a, b in pairwise(ring)]
    return np.array(found)


def write(path: Path, found: np.ndarray) -> None:
    """STL as text, as CAD programs write it."""
    lines = ["solid funnel"]
    for triangle in found:
        corners = [f"vertex {x:.9g} {y:.9g} {z:.9g}" for x, y, z in triangle]
        lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid funnel", ""]))


write(FILE, triangles())
room = ld.SurfaceWall(FILE, inside=True)
start = ld.bidisperse(80, sizes=(0.35, 0.45), dimension=3, seed=1).between(room)
print(f"{len(room.corners)} triangles enclose {start.volume:.4f}, droplets fill {start.phi:.3f}")
WEIGHT = 0.02  # of each droplet
with ld.Simulation(start.push_off(), ld.Droplet(), gravity=(0.0, 0.0, -WEIGHT)) as sim:
    state = sim.relax()
walls = state.contacts[state.contacts["j"] < 0]
carried = -state.wall_forces[0][2] / (WEIGHT * len(start))
print(f"{len(walls)} contacts with the funnel, which carries {carried:.4f} of the weight")
ax = state.plot(view=(12, 40), title="80 droplets in a funnel of triangles")
ax.figure.savefig("funnel.png")
