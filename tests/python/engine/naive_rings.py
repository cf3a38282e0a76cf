"""Rings of beads written down in numpy, and particles that both tests of rings use."""

import itertools
from dataclasses import dataclass

import deformable
import numpy as np


def area(ring: np.ndarray) -> float:
    x, y = ring.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


@dataclass
class Naive:
    """U = kL/2 sum (L - L0)^2 + kA/2 sum (A - A0)^2 + kr/2 sum (2p - |v - v'|)^2, term by term."""

    energy: float
    force: list[np.ndarray]
    contacts: dict[tuple[int, int, int, int], np.ndarray]


def naive(state: deformable.BeadState, rings: list[np.ndarray], box: np.ndarray) -> Naive:
    """Energy, forces on beads and forces of ring j's image on ring i, for these beads."""
    beads, rest, kinds = state.beads, state.polygons, state.packing.species
    energy, force, contacts = 0.0, [np.zeros_like(ring) for ring in rings], {}
    for ring, f, kind in zip(rings, force, kinds, strict=True):
        count = len(ring)
        radius = state.packing.radii[kind] - beads.radius
        rest_length = 2.0 * radius * np.sin(np.pi / count)
        rest_area = 0.5 * count * radius**2 * np.sin(2.0 * np.pi / count)
        kA, kL = rest.kA[kind], rest.kL[kind]
        pressure = kA * (rest_area - area(ring))
        energy += 0.5 * kA * (rest_area - area(ring)) ** 2
        for n in range(count):
            before, after = ring[n - 1], ring[(n + 1) % count]
            bond = after - ring[n]
            length = np.hypot(*bond)
            energy += 0.5 * kL * (length - rest_length) ** 2
            tension = kL * (length - rest_length) * bond / length
            f[n] += tension
            f[(n + 1) % count] -= tension
            f[n] += 0.5 * pressure * np.array([after[1] - before[1], before[0] - after[0]])
    for i, j in itertools.combinations(range(len(rings)), 2):
        for a, b in itertools.product(range(-3, 4), repeat=2):
            apart = rings[i][:, None] - rings[j] - np.array([a, b]) @ box
            distance = np.hypot(apart[..., 0], apart[..., 1])
            overlap = np.maximum(2.0 * beads.radius - distance, 0.0)
            push = (beads.kr * overlap / distance)[..., None] * apart
            if overlap.any():
                energy += 0.5 * beads.kr * float(np.sum(overlap**2))
                force[i] += push.sum(axis=1)
                force[j] -= push.sum(axis=0)
                contacts[i, j, a, b] = push.sum(axis=(0, 1))
    return Naive(energy, force, contacts)


def pair(width: float) -> deformable.Packing:
    """Two equal particles that meet each other through four images, 45 degrees off the axes."""
    return deformable.Packing(
        [[0.0, 0.0], [0.5 * width, 0.5 * width]], [0, 0], [0.5], width * np.eye(2)
    )


def square(height: float, stick: bool = False) -> deformable.Walls:
    return deformable.Walls(0.3 + np.arange(4) * np.pi / 2.0, np.full(4, height), stick)


ALONE = deformable.Packing(np.zeros((1, 2)), [0], [0.5], 3.0 * np.eye(2))


LONE_BEADS = deformable.Beads(number=40, radius=0.03)
