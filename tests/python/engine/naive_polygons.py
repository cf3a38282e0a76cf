"""Bead polygons written down in numpy, and particles that both tests of polygons use."""

import itertools
from dataclasses import dataclass

import lammps_deformable as ld
import numpy as np
from lammps_deformable.particles.polygons import Walls


def area(outline: np.ndarray) -> float:
    x, y = outline.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


@dataclass
class Naive:
    """U = kL/2 sum (L - L0)^2 + kA/2 sum (A - A0)^2 + kr/2 sum (2p - |v - v'|)^2, term by term."""

    energy: float
    force: list[np.ndarray]
    contacts: dict[tuple[int, int, int, int], np.ndarray]


def naive(state: ld.State, outlines: list[np.ndarray], box: np.ndarray) -> Naive:
    """Energy, forces on beads and forces of ring j's image on ring i, for these beads."""
    model, rest, kinds = state.law, state.polygons, state.packing.species
    energy, force, contacts = 0.0, [np.zeros_like(outline) for outline in outlines], {}
    particles = zip(outlines, force, kinds, state.packing.radii, strict=True)
    for outline, f, kind, whole in particles:
        count = len(outline)
        radius = whole - model.radius
        rest_length = 2.0 * radius * np.sin(np.pi / count)
        rest_area = 0.5 * count * radius**2 * np.sin(2.0 * np.pi / count)
        kA, kL = rest.kA[kind], rest.kL[kind]
        pressure = kA * (rest_area - area(outline))
        energy += 0.5 * kA * (rest_area - area(outline)) ** 2
        for n in range(count):
            before, after = outline[n - 1], outline[(n + 1) % count]
            bond = after - outline[n]
            length = np.hypot(*bond)
            energy += 0.5 * kL * (length - rest_length) ** 2
            tension = kL * (length - rest_length) * bond / length
            f[n] += tension
            f[(n + 1) % count] -= tension
            f[n] += 0.5 * pressure * np.array([after[1] - before[1], before[0] - after[0]])
    for i, j in itertools.combinations(range(len(outlines)), 2):
        for a, b in itertools.product(range(-3, 4), repeat=2):
            apart = outlines[i][:, None] - outlines[j] - np.array([a, b]) @ box
            distance = np.hypot(apart[..., 0], apart[..., 1])
            overlap = np.maximum(2.0 * model.radius - distance, 0.0)
            push = (model.kr * overlap / distance)[..., None] * apart
            if overlap.any():
                energy += 0.5 * model.kr * float(np.sum(overlap**2))
                force[i] += push.sum(axis=1)
                force[j] -= push.sum(axis=0)
                contacts[i, j, a, b] = push.sum(axis=(0, 1))
    return Naive(energy, force, contacts)


def pair(width: float) -> ld.Packing:
    """Two equal particles that meet each other through four images, 45 degrees off the axes."""
    return ld.Packing([[0.0, 0.0], [0.5 * width, 0.5 * width]], 0.5, width * np.eye(2))


def square(height: float, stick: bool = False) -> Walls:
    return Walls(0.3 + np.arange(4) * np.pi / 2.0, np.full(4, height), stick)


ALONE = ld.Packing(np.zeros((1, 2)), 0.5, 3.0 * np.eye(2))


LONE_BEADS = ld.DeformablePolygon(40, radius=0.03, smooth=False)
