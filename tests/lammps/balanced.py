"""Balanced contacts in LAMMPS, and the same by brute force from the kernels."""

import numpy as np
from lammps_deformable import core
from materials import STIFFNESS, pushed, radii_of, species_of


class Pairs:
    """All pairs of particles in a periodic square box, and their shapes from the kernels."""

    def __init__(self, x, box, radius, stiffness, reach=0.3):
        self.radius, self.stiffness = radius, stiffness
        i, j = np.triu_indices(len(x), 1)
        d = x[j] - x[i]
        d -= box * np.round(d / box)
        distance = np.hypot(*d.T)
        near = distance < (1 + reach) * (radius[i] + radius[j])
        self.i, self.j, d, distance = i[near], j[near], d[near], distance[near]
        theta = np.arctan2(d[:, 1], d[:, 0])
        self.angle = theta, theta + np.pi
        ri, rj = radius[self.i], radius[self.j]
        self.radical = core.contact_line(distance, ri, rj), core.contact_line(distance, rj, ri)

    def rows(self, s):
        """Of each particle: its pairs, their sides, angles, and indentations."""
        for n in range(len(self.radius)):
            first, second = np.flatnonzero(self.i == n), np.flatnonzero(self.j == n)
            yield (
                np.concatenate([first, second]),
                np.repeat([1, -1], [len(first), len(second)]),
                np.concatenate([self.angle[0][first], self.angle[1][second]]),
                np.concatenate(
                    [self.radical[0][first] + s[first], self.radical[1][second] - s[second]]
                ),
            )

    def shapes(self, s):
        return [
            core.soft_ring(self.radius[n], angle, a, *self.stiffness[n])
            for n, (_, _, angle, a) in enumerate(self.rows(s))
        ]

    def energy_and_gradient(self, s):
        energy, gradient, largest = 0.0, np.zeros_like(s), 0.0
        for (pairs, sign, _, _), shape in zip(self.rows(s), self.shapes(s), strict=True):
            energy += shape.energy
            np.add.at(gradient, pairs, sign * shape.d_indentation)
            largest = max(largest, shape.d_indentation.max(initial=0.0))
        return energy, gradient, largest

    def minimize(self, s):
        """Newton's method with a dense matrix, halving steps that do not lower the energy."""
        energy, gradient, largest = self.energy_and_gradient(s)
        for _ in range(100):
            if np.abs(gradient).max() <= 1e-11 * largest:
                return s
            k = np.zeros((len(s), len(s)))
            for n, (pairs, sign, angle, a) in enumerate(self.rows(s)):
                block = core.contact_stiffness(self.radius[n], angle, a, *self.stiffness[n])
                np.add.at(k, np.ix_(pairs, pairs), np.outer(sign, sign) * block)
            step = -np.linalg.lstsq(k, gradient, rcond=1e-13)[0]
            while True:
                there = self.energy_and_gradient(s + step)
                if there[0] <= energy * (1 + 1e-13):
                    break
                step /= 2
            s = s + step
            energy, gradient, largest = there
        raise AssertionError("the packing does not balance")


def of_mixture(case):
    """The material `rings` as Pairs; stiffness 10 to 1 and more between neighbors."""
    stiffness = [STIFFNESS[name] for name in species_of(case)]
    return Pairs(pushed(case), case["L"], radii_of(case), stiffness)
