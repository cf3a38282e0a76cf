"""Second derivatives of the dual energy of a droplet, against differences of first derivatives."""

import droplet_formula as formula
import numpy as np
import pytest
from lammps_deformable import core
from polyhedra import random_normals
from test_droplet_kernel import changes

RADIUS, TENSION = 1.3, 0.7


def scene(z, seed, load=0.1):
    """Sides of one droplet with these forces: rows of `droplet_blocks`."""
    rng = np.random.default_rng(seed)
    sides = np.zeros((z, 9))
    sides[:, :3] = rng.uniform(1.8, 3.0, z)[:, None] * random_normals(z, seed)
    sides[:, 3:5] = rng.uniform(-0.1, 0.3, (z, 2))
    sides[:, 5] = rng.uniform(0.05, 1.0, z)
    sides[:, 5] *= 8 * np.pi * load * RADIUS * TENSION / sides[:, 5].sum()
    return sides


def moved(sides, step):
    """The sides after a step of vectors and forces, and with them of overlaps."""
    new, step = sides.astype(complex), np.reshape(step, (-1, 4))
    new[:, :3] += step[:, :3]
    new[:, 5] += step[:, 3]
    before, after = (np.sqrt((each[:, :3] ** 2).sum(axis=1)) for each in (sides, new))
    new[:, 3] += before - after
    return new if np.iscomplexobj(step) else new.real


def loaded(sides):
    """Forces and normals in units of R and g R."""
    length = np.sqrt((sides[:, :3] ** 2).sum(axis=1))
    return sides[:, 5] / (RADIUS * TENSION), sides[:, :3] / length[:, None]


def energy(sides):
    f, n = loaded(sides)
    work = formula.work(f, n) + (f**2 * sides[:, 4]).sum() / (8 * np.pi)
    return (sides[:, 5] * sides[:, 3]).sum() / 2 - TENSION * RADIUS**2 * work


def blocks(sides):
    return core.droplet_blocks([[len(sides), RADIUS, TENSION]], sides)


def dense(found):
    row, column, value = found.hessian()
    matrix = np.zeros((found.gradient.size,) * 2)
    np.add.at(matrix, (row, column), value)
    return matrix


def places(sides):
    """Derivatives of R t, (3Z, 4Z)."""
    _, (row, column, value) = blocks(sides)
    matrix = np.zeros((3 * len(sides), 4 * len(sides)))
    np.add.at(matrix, (row, column), value)
    return matrix


@pytest.mark.parametrize(("z", "load"), [(1, 0.1), (2, 0.1), (7, 0.3), (13, 0.1), (13, 0.51)])
def test_derivatives(z, load):
    sides = scene(z, z, load)
    found, _ = blocks(sides)
    start = np.zeros(4 * z)
    if load < 0.5:  # the formula has no barrier
        assert found.energy == pytest.approx(energy(sides), abs=1e-9)
        first = formula.by_steps(lambda step: energy(moved(sides, step)), start)
        assert found.gradient == pytest.approx(first, abs=1e-9)
    second = changes(lambda x: blocks(moved(sides, x))[0].gradient, start, 1e-4)
    matrix = dense(found)
    assert (matrix == matrix.T).all()
    assert matrix == pytest.approx(second, abs=1e-8 * np.abs(second).max())


def test_places_of_facets():
    """And what they add to the second derivatives, by weights."""
    sides = scene(7, 3)
    start = np.zeros(28)

    def facets(step):
        return RADIUS * formula.facets(*loaded(moved(sides, step))).ravel()

    rows = [formula.by_steps(lambda step, n=n: facets(step)[n], start) for n in range(21)]
    assert places(sides) == pytest.approx(np.array(rows), abs=1e-12)
    found = core.droplet_facets([[7, RADIUS, TENSION]], sides)
    assert found[:, :3].ravel() == pytest.approx(facets(start), abs=1e-14)
    assert found[:, 3] == pytest.approx(np.exp(-0.065), rel=1e-14)

    weighted = sides.copy()
    weighted[:, 6:] = np.random.default_rng(1).normal(size=(7, 3))
    plain, other = blocks(sides)[0], blocks(weighted)[0]
    assert (plain.gradient == other.gradient).all()
    by = changes(lambda x: weighted[:, 6:].ravel() @ places(moved(sides, x)), start, 1e-4)
    assert dense(plain) - dense(other) == pytest.approx(TENSION * RADIUS * by, abs=1e-8)


def test_droplets_come_one_after_the_other():
    one, two = scene(5, 1), scene(8, 2)
    both, _ = core.droplet_blocks(
        [[5, RADIUS, TENSION], [0, 1.0, 1.0], [8, RADIUS, TENSION]], np.vstack([one, two])
    )
    assert both.energy == pytest.approx(blocks(one)[0].energy + blocks(two)[0].energy)
    matrix = dense(both)
    assert (matrix[:20, :20] == dense(blocks(one)[0])).all()
    assert (matrix[20:, 20:] == dense(blocks(two)[0])).all()
    assert not matrix[20:, :20].any()


def test_errors():
    for droplet, change, message in (
        ([6, 1, 1], {}, "fewer rows"),
        ([4, 1, 1], {}, "more rows"),
        ([5, 0, 1], {}, "radius of droplet 0"),
        ([5, 1, np.inf], {}, "tension of droplet 0"),
        ([5, 1, 1], {(2, 0): np.nan}, "vector 2|sides"),
        ([5, 1, 1], {(4, 5): 0.0}, "force of side 4"),
    ):
        sides = scene(5, seed=1)
        for place, value in change.items():
            sides[place] = value
        for function in (core.droplet_blocks, core.droplet_facets):
            with pytest.raises(ValueError, match=message):
                function([droplet], sides)
            with pytest.raises(ValueError, match="9 numbers"):
                function([droplet], sides[:, :5])
