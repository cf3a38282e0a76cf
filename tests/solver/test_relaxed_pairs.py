"""Pairs out of balance that are relaxed one by one: which ones, and what is left."""

import numpy as np
import pytest
from parts import Lattice, parts

LARGEST = 0.03  # force
LIMIT, MOST = 1e-4 * LARGEST, 1e-2 * LARGEST  # of the imbalances that are relaxed
COLUMNS, ROWS = 24, 60  # of three blocks; the borders are in rows 21 and 42
# their pairs have no neighbors in common; some are in the first block, some in the second one
APART = np.array([COLUMNS * row + column for row in (19, 23) for column in range(0, COLUMNS, 4)])
EDGE = COLUMNS * (ROWS - 1) + np.arange(0, COLUMNS, 4)  # below those of another rank


class Shaken:
    """A lattice in balance, but for a pair of each of these rings, which is off by this force.

    Of a ring beside the wall it is the pair with the wall.
    """

    def __init__(self, rings, by, *, kP=np.inf, force=None, tuning=""):
        lattice = self.lattice = Lattice(COLUMNS, ROWS, ghosts=True, kP=kP)
        self.pairs = np.searchsorted(lattice.first[: lattice.remote], rings)
        self.pairs = np.where(np.array(rings) < COLUMNS, lattice.wall + rings, self.pairs)
        self.force, self.rings = lattice.force, lattice.rings
        if force is not None:
            self.force[self.pairs] = force
        self.overlap = lattice.indentation(self.force)
        self.rings.find_residuals(self.overlap)
        self.overlap[self.pairs] += by / np.abs(self.rings.weight[self.pairs])
        self.rings.find_residuals(self.overlap)
        self.relaxation = parts.PairRelaxation(self.rings, tuning)

    @property
    def imbalance(self):
        """The changes that would balance each pair alone; no force becomes negative."""
        rings = self.rings
        return np.abs(np.maximum(rings.residual * np.abs(rings.weight), -rings.force))

    def relax(self):
        """The changes of forces."""
        assert self.relaxation.begin(tolerance=1e-3 * LIMIT / LARGEST, largest_force=LARGEST)
        for block in range(3):
            self.relaxation.relax(block)
        change = self.rings.force - self.force
        np.testing.assert_allclose(self.rings.step, change, atol=1e-6 * np.abs(change).max())
        return change


@pytest.mark.parametrize("kP", [np.inf, 0.5], ids=["rigid", "soft"])
@pytest.mark.parametrize("rings", [APART, APART % COLUMNS], ids=["rings", "wall"])
def test_all_are_balanced_afterwards(rings, kP):
    """To the limit, which is that of the first order: it knows what an evaluation finds."""
    rings = np.unique(rings)
    shaken = Shaken(rings, 2e-4 * (-1) ** np.arange(len(rings)), kP=kP)
    assert shaken.imbalance.max() == pytest.approx(2e-4)
    change = shaken.relax()
    assert (change[shaken.pairs] != 0).all()
    assert shaken.imbalance.max() <= LIMIT
    shaken.lattice.indentation(shaken.rings.force)
    shaken.rings.find_residuals(shaken.overlap)
    assert shaken.imbalance.max() <= 1.5 * LIMIT


def test_forces_stop_at_zero():
    shaken = Shaken(APART, -2e-4, force=5e-5)
    shaken.relax()
    assert shaken.rings.force.min() == 0
    assert shaken.imbalance.max() <= LIMIT


@pytest.mark.parametrize(
    ("rings", "by", "tuning"),
    [
        (APART, 0.9 * LIMIT, ""),
        (APART, 1.1 * MOST, ""),
        (APART, 2e-4, "of_ring=1e-4"),
        (np.arange(COLUMNS, COLUMNS + 100), 2e-4, "crowd=0.05"),
        (EDGE, 2e-4, ""),
    ],
    ids=["small", "far off", "large for a ring", "crowd", "beside another rank"],
)
def test_others_stay(rings, by, tuning):
    shaken = Shaken(rings, by, tuning=tuning)
    assert not shaken.relax().any()
    assert [shaken.relaxation.changed(block) for block in range(3)] == [[]] * 3


def test_changed_batches():
    """Those of rings whose forces have changed, once."""
    shaken = Shaken(APART, 2e-4)
    changed = np.flatnonzero(shaken.relax())
    first, second = shaken.lattice.first[changed], shaken.lattice.second[changed]
    expected = set(shaken.rings.batch[np.concatenate([first, second[second >= 0]])].astype(int))
    found = [batch for block in range(3) for batch in shaken.relaxation.changed(block)]
    assert sorted(found) == sorted(expected)
    assert [shaken.relaxation.changed(block) for block in range(3)] == [[]] * 3


def test_nothing_to_relax():
    """Where the limit is above what is left to Newton's method."""
    shaken = Shaken(APART, 2e-4, tuning="relaxed=1e9")
    assert not shaken.relaxation.begin(1e-7, LARGEST)
