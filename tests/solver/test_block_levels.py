"""Blocks run ahead of others, and all come out as in sweeps from one end to the other."""

from itertools import pairwise

import numpy as np
import pytest
from parts import Lattice, parts

BLOCK = 512  # rings


class Network:
    """Twelve blocks of a lattice: each has contacts with the next one, and some with others."""

    def __init__(self, far):
        lattice = Lattice(64, 96, ghosts=True)
        table = np.array([lattice.first, lattice.second]).T
        within = np.concatenate(
            [table[: lattice.remote], lattice.random.integers(lattice.n, size=(far, 2))]
        )
        within = within[np.argsort(within[:, 0], kind="stable")]
        self.pairs = np.concatenate([within, table[lattice.remote :]])
        self.remote, self.wall = len(within), len(within) + lattice.wall - lattice.remote
        angle = lattice.random.uniform(-3, 3, len(self.pairs))
        self.rings = parts.Rings(lattice.kA, np.inf, *self.pairs.T, angle)
        self.blocks = lattice.n // BLOCK
        self.neighbors = [set() for _ in range(self.blocks)]
        for i, j in within // BLOCK:
            self.neighbors[i].add(j)
            self.neighbors[j].add(i)
        self.borders = set(self.pairs[self.remote : self.wall, 0] // BLOCK)


@pytest.fixture(scope="module", params=[0, 4, 400], ids=["chain", "few far", "many far"])
def network(request):
    return Network(request.param)


class Task:
    """Numbers of blocks that follow from the last ones of their neighbors, and of other ranks.

    As products of the linear solver: a number is kept until the next but one takes its place.
    """

    def __init__(self, network):
        self.network = network
        self.numbers = [[hash(k)] * 2 for k in range(network.blocks)]
        self.far, self.log = 0, []

    def work(self, block, iteration):
        self.log.append((block, iteration))
        used = {block} | self.network.neighbors[block]
        last = [self.numbers[k][(iteration - 1) % 2] for k in sorted(used)]
        far = self.far if block in self.network.borders else 0
        self.numbers[block][iteration % 2] = hash((*last, far, iteration))

    def exchange(self, iteration):
        self.log.append(("exchange", iteration))
        self.far = hash(tuple(self.numbers[k][iteration % 2] for k in self.network.borders))

    def sweep(self, last):
        for iteration in range(1, last + 1):
            for block in range(self.network.blocks):
                self.work(block, iteration)
            if iteration < last:
                self.exchange(iteration)
        return self.numbers


@pytest.mark.parametrize("threads", [1, 2, 5, 20])
@pytest.mark.parametrize("last", [1, 2, 4, 5, 13])
def test_the_order_of_work_changes_nothing(network, last, threads):
    task, blocks = Task(network), range(network.blocks)
    parts.BlockLevels(network.rings).run(last, task.work, task.exchange, threads)
    assert task.numbers == Task(network).sweep(last)
    done = [entry for entry in task.log if entry[0] != "exchange"]
    assert sorted(done) == [(k, n) for k in blocks for n in range(1, last + 1)]
    assert [n for what, n in task.log if what == "exchange"] == list(range(1, last))


@pytest.mark.parametrize("threads", [1, 3])
def test_neighbors_are_one_iteration_apart(network, threads):
    levels, level = parts.BlockLevels(network.rings), [0] * network.blocks

    def work(block, iteration):
        level[block] = iteration
        assert all(abs(level[k] - iteration) <= 1 for k in network.neighbors[block])

    levels.run(9, work, lambda _: None, threads)


def test_a_block_runs_ahead_of_those_far_away():
    """Few of forty have their turn between two iterations of one, which is in the cache still."""
    levels, visited = parts.BlockLevels(Lattice(64, 320).rings), []
    levels.run(12, lambda block, _: visited.append(block), lambda _: None)
    assert levels.count() == 40
    at = [np.flatnonzero(np.array(visited) == block) for block in range(40)]
    between = [len(set(visited[i + 1 : j])) for k in at for i, j in pairwise(k)]
    assert np.mean(between) < 10


def test_what_belongs_to_a_block(network):
    levels = parts.BlockLevels(network.rings)
    assert levels.count() == network.blocks
    for block in range(network.blocks):
        assert set(levels.neighbors(block)) == network.neighbors[block] - {block}
        assert len(levels.neighbors(block)) == len(set(levels.neighbors(block)))
        assert levels.batches(block) == (64 * block, 64 * (block + 1))
    found = {}
    for block in range(network.blocks):
        for begin, end, part in levels.pairs(block):
            for k in range(begin, end):
                assert k not in found
                assert network.pairs[k][0] // BLOCK == block
                found[k] = part
    assert found == {
        k: 0.5 if network.remote <= k < network.wall else 1.0 for k in range(len(network.pairs))
    }
