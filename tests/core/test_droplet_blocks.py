"""Second derivatives of the dual energy of a droplet, against differences of first derivatives."""

import droplet_formula as formula
import numpy as np
import pytest
from lammps_deformable import core
from polyhedra import random_normals
from test_droplet_kernel import changes

RADIUS, TENSION = 1.3, 0.7


# Columns of `droplet_blocks`.
V, TURN, AXIS, OVERLAP, PART, FILM, FORCE = slice(0, 3), 3, slice(4, 7), 7, 8, 9, 10
ANGLE, WEIGHT = 11, slice(12, 15)


def scene(z, seed, load=0.1, walls=()):
    """Sides of one droplet with these forces: rows of `droplet_blocks`. The last ones are walls."""
    rng = np.random.default_rng(seed)
    sides = np.zeros((z, 15))
    sides[:, V] = rng.uniform(1.8, 3.0, z)[:, None] * random_normals(z, seed)
    sides[:, TURN] = 1.0 / np.linalg.norm(sides[:, V], axis=1)
    sides[:, [OVERLAP, FILM]] = rng.uniform(-0.1, 0.3, (z, 2))
    sides[:, PART] = 0.5
    sides[:, FORCE] = rng.uniform(0.05, 1.0, z)
    sides[:, FORCE] *= 8 * np.pi * load * RADIUS * TENSION / sides[:, FORCE].sum()
    for row, (turn, axis) in zip(sides[z - len(walls) :], walls, strict=True):
        row[TURN], row[AXIS], row[PART] = turn, axis, 1.0
    return sides


# Turn and axis. Flat; inside of a sphere, outside of a ball; inside of a cone, outside of one.
WALLS = [
    (0.0, (0, 0, 0)),
    (-0.3, (0, 0, 0)),
    (0.6, (0, 0, 0)),
    (-0.25, (0, 0, 1)),
    (0.5, (0.6, 0, -0.8)),
]


def moved(sides, step):
    """The sides after a step of vectors and forces, and with them of overlaps.

    Each direction turns about a point, which is the nearest one of the axis of a cone.
    """
    new, step = sides.astype(complex), np.reshape(step, (-1, 4))
    new[:, FORCE] += step[:, 3]
    for row, old, d in zip(new, sides, step[:, :3], strict=True):
        v, turn, axis = old[V], old[TURN], old[AXIS]
        length = np.sqrt(v @ v)
        n = v / length
        round_part = n - (n @ axis) * axis if turn else np.zeros(3)
        flat, r = n - round_part, round_part / (turn or 1.0)
        r0, r = np.sqrt(r @ r), r + d - (d @ axis) * axis
        r1, cosine = np.sqrt(r @ r), np.copysign(np.sqrt(round_part @ round_part), turn)
        further = flat @ d + cosine * (r1 - r0)
        row[V] = (flat + (cosine * r / r1 if turn else 0.0)) * (length + further)
        row[TURN] = cosine / r1 if turn else 0.0
        row[OVERLAP] -= further
    return new if np.iscomplexobj(step) else new.real


def loaded(sides):
    """Forces and normals in units of R and g R."""
    length = np.sqrt((sides[:, V] ** 2).sum(axis=1))
    return sides[:, FORCE] / (RADIUS * TENSION), sides[:, V] / length[:, None]


def energy(sides):
    f, n = loaded(sides)
    work = formula.work(f, n) + (f**2 * sides[:, FILM]).sum() / (8 * np.pi)
    return (sides[:, PART] * sides[:, FORCE] * sides[:, OVERLAP]).sum() - TENSION * RADIUS**2 * work


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


@pytest.mark.parametrize(
    ("z", "load", "walls"),
    [
        (1, 0.1, []),
        (2, 0.1, WALLS[:1]),
        (7, 0.3, []),
        (7, 0.2, WALLS),
        (5, 0.1, WALLS),
        (13, 0.1, WALLS[1:3]),
        (13, 0.51, WALLS[2:]),
    ],
)
def test_derivatives(z, load, walls):
    sides = scene(z, z, load, walls)
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


def test_films() -> None:
    """Films that push and pull: energy and indentations of `core.droplet`, and differences."""
    sides = scene(5, 5, 0.05)
    sides[:, ANGLE] = 0.5, 0.3, 0.0, 0.6, 0.4
    sides[:2, FORCE] *= -0.5
    sides[:, FILM] = 0.0
    second = changes(lambda x: blocks(moved(sides, x))[0].gradient, np.zeros(20), 1e-4)
    assert dense(blocks(sides)[0]) == pytest.approx(second, abs=1e-8 * np.abs(second).max())

    forces, lean = sides[:, FORCE], np.array([1.1, 0.9, 1.0, 1.0, 1.2])
    normals = loaded(sides)[1]
    droplet = core.droplet(
        normals, forces, RADIUS, TENSION, angles=sides[:, ANGLE], film_ratios=lean
    )
    stretch = droplet.stretch
    x = np.array([*forces, stretch, 2.0])

    def stretched(x):
        rows = np.column_stack([x[:5], sides[:, ANGLE], lean])
        return core.stretch_blocks([[5, RADIUS, TENSION, x[5], x[6]]], rows)

    x[6] -= stretched(x).gradient[5] / dense(stretched(x))[6, 5]  # linear in P
    found = stretched(x)
    assert found.gradient[5:] == pytest.approx(0.0, abs=1e-10)
    overlaps = (sides[:, PART] * forces * sides[:, OVERLAP]).sum()
    assert overlaps - blocks(sides)[0].energy - found.energy == pytest.approx(
        (forces * droplet.indentation).sum() - droplet.energy, abs=1e-12
    )
    gradient = found.gradient[:5] + blocks(sides)[0].gradient.reshape(5, 4)[:, 3]
    assert gradient == pytest.approx(sides[:, PART] * sides[:, OVERLAP] - droplet.indentation)
    second = changes(lambda step: stretched(x + step).gradient, np.zeros(7), 1e-5)
    assert dense(found) == pytest.approx(second, abs=1e-8 * np.abs(second).max())


@pytest.mark.parametrize("force", [0.1, -0.05])
def test_films_that_are_caps(force: float) -> None:
    def cap(x):
        return core.cap_blocks([[*x, 1.0, 1.7, TENSION, 0.5]])

    x = np.array([force, 2.05, 2.1])
    energy, *by = core.curved_film(force, TENSION * 2.05, TENSION * 2.1 / 1.7, TENSION, 0.5)
    assert cap(x).energy == pytest.approx(-energy)
    assert cap(x).gradient == pytest.approx(
        -TENSION * np.array([by[0] / TENSION, by[1], by[2] / 1.7])
    )
    second = changes(lambda step: cap(x + step).gradient, np.zeros(3), 1e-5)
    assert dense(cap(x)) == pytest.approx(second, abs=1e-8 * np.abs(second).max())


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
    weighted[:, WEIGHT] = np.random.default_rng(1).normal(size=(7, 3))
    plain, other = blocks(sides)[0], blocks(weighted)[0]
    assert (plain.gradient == other.gradient).all()
    by = changes(lambda x: weighted[:, WEIGHT].ravel() @ places(moved(sides, x)), start, 1e-4)
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
        ([5, 1, 1], {(4, FORCE): 0.0}, "force of side 4"),
    ):
        sides = scene(5, seed=1)
        for place, value in change.items():
            sides[place] = value
        for function in (core.droplet_blocks, core.droplet_facets):
            with pytest.raises(ValueError, match=message):
                function([droplet], sides)
            with pytest.raises(ValueError, match="15 numbers"):
                function([droplet], sides[:, :5])
