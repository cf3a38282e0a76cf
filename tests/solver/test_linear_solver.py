"""C x = r by conjugate gradients and by Chebyshev's iteration, against the matrix C."""

import numpy as np
import pytest
from parts import LMP, Lattice, parts

ALWAYS = "chebyshev=0"  # Chebyshev's iteration, however fast conjugate gradients are


class Equations:
    """Of a lattice in which a quarter of the contacts are open, which take no part."""

    def __init__(self, kP=np.inf):
        lattice = Lattice(6, 5, kP=kP)
        self.rings, self.random = lattice.rings, lattice.random
        self.bears = self.random.random(lattice.force.size) > 0.25
        force = lattice.force * self.bears
        steps = 1e-5 * np.eye(force.size)
        of = [lattice.indentation(force + d) - lattice.indentation(force - d) for d in steps]
        self.matrix = np.array(of).T[np.ix_(self.bears, self.bears)] / 2e-5
        self.base = lattice.indentation(force)
        self.take(self.random.uniform(-1e-4, 1e-4, self.bears.sum()))
        root = np.sqrt(self.weight)
        self.spectrum, vectors = np.linalg.eigh(root[:, None] * self.matrix * root)
        modes = (vectors / root[:, None]).T  # as residuals
        self.modes = 1e-4 * modes / np.abs(modes).max(axis=1)[:, None]

    def take(self, residual):
        self.residual = residual
        overlap = self.base - 1e-4
        overlap[self.bears] += 1e-4 + residual
        self.norm2 = self.rings.find_residuals(overlap)
        assert ((self.rings.weight > 0) == self.bears).all()
        self.weight = self.rings.weight[self.bears]

    @property
    def x(self):
        first = self.rings.first_correction
        np.testing.assert_array_equal(first, self.rings.second_correction)
        assert (first[~self.bears] == 0).all()
        return first[self.bears]

    @property
    def left(self):
        """What is left of r, over r, in the norm of the weights."""
        rest = self.residual - self.matrix @ self.x
        return np.sqrt((self.weight * rest**2).sum() / self.norm2)


@pytest.fixture(params=[np.inf, 0.5], ids=["rigid", "soft"])
def equations(request):
    return Equations(request.param)


@pytest.mark.parametrize("accuracy", [0.1, 1e-2, 1e-4])
def test_conjugate_gradients(equations, accuracy):
    solver = parts.LinearSolver(equations.rings, LMP)
    assert solver.begin(equations.norm2, accuracy) == 0
    assert 0.01 * accuracy < equations.left <= 1.01 * accuracy
    exact = np.linalg.solve(equations.matrix, equations.residual)
    assert np.abs(equations.x - exact).max() <= 10 * accuracy * np.abs(exact).max()


def test_chebyshev_for_every_mode(equations):
    """None grows: the bounds contain the spectrum. Wider ones would cost iterations."""
    solver = parts.LinearSolver(equations.rings, LMP, ALWAYS)
    solver.begin(equations.norm2, 1e-6)
    lowest, highest = equations.spectrum[[0, -1]]
    decay = np.arccosh((highest + lowest) / (highest - lowest))
    for accuracy in (1e-2, 1e-4, 0.1):  # also after longer plans
        last, least = solver.begin(equations.norm2, accuracy), np.arccosh(1 / accuracy) / decay
        assert last == solver.plan(accuracy)
        assert least <= last <= 1.2 * least + 1
        for mode in equations.modes:
            equations.take(mode)
            solver.iterate(last)
            assert equations.left <= accuracy


def test_few_conjugate_gradients_know_no_bounds(equations):
    solver = parts.LinearSolver(equations.rings, LMP, ALWAYS)
    assert not solver.knows_bounds()
    general = equations.residual
    for _ in range(2):
        equations.take(equations.modes[3])  # one iteration is enough for a mode
        assert solver.begin(equations.norm2, 1e-3) == 0
        assert equations.left <= 1e-3
        assert not solver.knows_bounds()
        equations.take(general)
        assert solver.begin(equations.norm2, 1e-3) == 0
        assert solver.knows_bounds()
        solver.invalidate_bounds()
        assert not solver.knows_bounds()


@pytest.mark.parametrize(("tuning", "worth"), [(ALWAYS, True), ("chebyshev=inf", False)])
def test_chebyshev_where_it_is_worth_it(tuning, worth):
    equations = Equations()
    solver = parts.LinearSolver(equations.rings, LMP, tuning)
    solver.begin(equations.norm2, 1e-4)
    assert solver.knows_bounds() == worth


def test_sound_steps(equations):
    """Those of every mode; none that goes back, or twice as far as the softest mode."""
    solver = parts.LinearSolver(equations.rings, LMP, ALWAYS)
    solver.begin(equations.norm2, 1e-6)
    for mode in equations.modes:
        norm2 = (equations.weight * mode**2).sum()
        slope = mode @ np.linalg.solve(equations.matrix, mode)
        assert solver.is_sound(slope, norm2)
        assert not solver.is_sound(-slope, norm2)
    longest = 1 / equations.spectrum[0]
    assert not solver.is_sound(2.1 * longest, 1.0)
