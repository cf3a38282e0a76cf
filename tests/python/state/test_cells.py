"""Voronoi cells and hexatic order against scipy, points on a grid, and lattices."""

from itertools import product
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import crystal
from lammps_deformable.particles.containers import closed
from programs import output
from scipy.spatial import ConvexHull, Voronoi

WALLS = {
    "periodic": (),
    "triangle": tuple(
        ld.Plane(p, n) for p, n in (((0, 0), (0, 1)), ((0, 0), (2, -1)), ((9, 0), (-2, -1)))
    ),
    "channel": ld.BoxWall((9.0, 8.0)).parts[:2],
    "circle": (ld.Sphere(5.0, (1.0, 2.0)), ld.Sphere(0.7, (1.0, 2.0), inside=False)),
    "obstacle": (ld.Sphere(0.8, (8.9, 3.0), inside=False),),
}


def state_of(packing: ld.Packing) -> ld.State:
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        return disks.state()


def tiled(packing: ld.Packing) -> np.ndarray:
    """Centers and their images around, shape (25 N, 2); those of the box come first."""
    steps = sorted(product(range(-2, 3), repeat=2), key=lambda step: step != (0, 0))
    wrapped = packing.positions @ np.linalg.inv(packing.box) % 1.0
    return np.concatenate([(wrapped + step) @ packing.box for step in steps])


def test_cells_fill_the_room() -> None:
    for name in ("periodic", "channel", "circle"):
        walls = WALLS[name]
        packing = ld.bidisperse(30, tilt=0.0 if walls else 1.7, seed=2)
        packing = (packing.between(walls).at(0.8) if walls else packing.at(0.8)).push_off()
        away = packing.replace(positions=packing.positions + (0.0 if walls else 2.3))
        for each in (packing, away):
            state = state_of(each)
            area = state.volumes / state.local_phi
            assert area.sum() == pytest.approx(packing.volume, rel=1e-9), name
            assert area @ state.local_phi / packing.volume == pytest.approx(state.phi, rel=1e-9)
            assert 0.3 < state.local_phi.min() < state.local_phi.max() < 1.05


def test_cells_by_points_at_random_places() -> None:
    """Each point is in the cell of the particle with the least d^2 - R^2."""
    for name in ("periodic", "triangle", "obstacle", "circle"):
        walls = WALLS[name]
        packing = ld.polydisperse(12, lambda rng, n: rng.uniform(0.2, 0.9, 12), seed=2)
        packing = packing.between(walls) if walls else packing
        packing = packing.at(0.7).push_off()
        rng = np.random.default_rng(1)
        if walls:
            many = ld.polydisperse(20000, np.full(20000, 1e-3), seed=1)
            points = many.replace(box=packing.box).between(packing.walls, seed=1).positions
        else:
            points = rng.random((20000, 2)) @ packing.box
        apart = (points[:, None] - packing.positions) @ np.linalg.inv(packing.box)
        shut = np.array(closed(packing.walls))
        images = [
            (apart - np.rint(apart) * ~shut + np.array(step) * ~shut) @ packing.box
            for step in product((-1, 0, 1), repeat=2)
        ]
        power = np.min([np.sum(each**2, axis=-1) for each in images], axis=0) - packing.radii**2
        count = np.bincount(power.argmin(axis=1), minlength=12)
        state = state_of(packing)
        share = state.volumes / state.local_phi / packing.volume
        assert np.abs(count - 20000 * share).max() < 5.0 * np.sqrt(20000 * share.max()), name


def test_equal_particles_as_in_scipy() -> None:
    packing = ld.bidisperse(40, sizes=(0.5, 0.5), phi=0.6, tilt=0.7, seed=3)
    state = state_of(packing)
    points = tiled(packing)
    diagram = Voronoi(points)
    area = [
        ConvexHull(diagram.vertices[diagram.regions[diagram.point_region[n]]]).volume
        for n in range(40)
    ]
    assert state.volumes / state.local_phi == pytest.approx(np.array(area), rel=1e-9)
    for k in (4, 6):
        psi, total = np.zeros(40, dtype=complex), np.zeros(40)
        for pair, ends in zip(diagram.ridge_points, diagram.ridge_vertices, strict=True):
            for n, m in (pair, pair[::-1]):
                if n < 40:
                    length = np.linalg.norm(np.subtract(*diagram.vertices[ends]))
                    x, y = points[m] - points[n]
                    psi[n] += length * np.exp(1j * k * np.arctan2(y, x))
                    total[n] += length
        assert state.hexatic(k) == pytest.approx(psi / total, abs=1e-9)


@pytest.mark.slow
def test_equal_particles_as_in_freud(tmp_path: Path) -> None:
    """Which has to be imported first: LAMMPS brings another Voro++."""
    pytest.importorskip("freud")
    script = tmp_path / "script.py"
    script.write_text(
        "import freud\n"
        "import lammps_deformable as ld\n"
        "import numpy as np\n"
        "packing = ld.bidisperse(40, sizes=(0.5, 0.5), phi=0.6, tilt=0.4, seed=3)\n"
        "with ld.Simulation(packing.push_off(), ld.SoftContact()) as disks:\n"
        "    state = disks.state()\n"
        "cells = freud.locality.Voronoi().compute(state.to_freud())\n"
        "order = freud.order.Hexatic(6, weighted=True).compute(state.to_freud(), cells.nlist)\n"
        "print(np.abs(cells.volumes * state.local_phi / state.volumes - 1.0).max())\n"
        "print(np.abs(order.particle_order - state.hexatic()).max())\n"
    )
    area, psi = map(float, output("python", script, cwd=tmp_path).split())
    assert area < 1e-5  # freud's centers have single precision
    assert psi < 1e-4


def test_hexatic_order_of_lattices() -> None:
    triangular = state_of(crystal(0.01))
    assert triangular.hexatic() == pytest.approx(np.ones(16, dtype=complex), abs=1e-12)
    assert triangular.local_phi == pytest.approx(np.full(16, triangular.phi))
    places = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0)), axis=-1).reshape(-1, 2)
    square = state_of(ld.Packing(places, 0.5, np.diag([4.0, 4.0])))
    assert square.hexatic(4) == pytest.approx(np.ones(16, dtype=complex), abs=1e-12)
    assert np.abs(square.hexatic(6)) == pytest.approx(np.zeros(16), abs=1e-12)
    with pytest.raises(ld.ParameterError, match="k must be at least 1, not 0"):
        square.hexatic(0)


def test_sides_are_those_of_the_voronoi_diagram() -> None:
    """Of equal particles by scipy, of all sizes 6 in the mean (Euler), and 6 on a lattice."""
    equal = ld.polydisperse(40, np.full(40, 0.5), seed=3).at(0.8).push_off()
    pairs = Voronoi(tiled(equal)).ridge_points
    expected = np.bincount(pairs.ravel(), minlength=40)[:40]
    assert np.array_equal(state_of(equal).cell_sides, expected)
    assert set(expected) > {5, 6, 7}
    unequal = ld.bidisperse(40, seed=3).at(0.8).push_off()
    assert state_of(unequal).cell_sides.mean() == 6.0
    assert np.array_equal(state_of(crystal(0.01)).cell_sides, np.full(16, 6))


def test_turned_order_has_a_phase() -> None:
    """At the wall too: neighbors are in directions of the lattice, if there are fewer."""
    ring = np.exp(1j * (np.arange(6) * np.pi / 3 + 0.2))
    places = np.concatenate([[0.0], ring, 2.0 * ring, np.sqrt(3) * ring * np.exp(1j * np.pi / 6)])
    packing = ld.Packing(
        np.column_stack([places.real, places.imag]),
        0.5,
        np.eye(2),
        walls=ld.Sphere(3.0, (0.05, 0.1)),
    )
    psi = state_of(packing).hexatic()
    assert psi == pytest.approx(np.full(19, np.exp(1.2j)), abs=1e-12)


def test_sides_at_walls_do_not_count() -> None:
    pair = ld.Packing([[1.0, 1.0], [2.0, 1.0]], 0.5, np.eye(2))
    state = state_of(pair.replace(walls=ld.BoxWall((3.0, 2.0))))
    assert state.hexatic(1) == pytest.approx(np.array([1.0, -1.0]), abs=1e-12)
    assert state.local_phi == pytest.approx(np.full(2, np.pi * 0.25 / 3.0))
    alone = ld.Packing([[1.0, 1.0]], 0.5, np.eye(2), walls=ld.BoxWall((3, 2)))
    assert np.isnan(state_of(alone).hexatic()).all()
    assert state.cell_sides.tolist() == [1, 1]
    assert state_of(alone).cell_sides.tolist() == [0]
