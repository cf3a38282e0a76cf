"""Analysis in three dimensions: crystals, sums over all pairs, scipy, freud, and affine strain."""

from itertools import product

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Packing, State
from scipy.spatial import ConvexHull, Voronoi
from scipy.special import factorial, lpmv


def state_of(packing: Packing) -> State:
    with ld.Simulation(packing, ld.SoftContact()) as spheres:
        return spheres.state()


def leaning(number: int, radii: tuple[float, float]) -> Packing:
    """Random places, pushed apart, in a box that leans all ways, some in images of it."""
    start = ld.bidisperse(number, sizes=radii, phi=0.5, dimension=3, aspect=1.3, seed=3)
    box = start.box + np.array([[0.0] * 3, [0.9, 0.0, 0.0], [-0.8, 0.6, 0.0]])
    places = start.positions @ np.linalg.inv(start.box) @ box
    apart = Packing(places, start.radii, box, species=start.species).push_off()
    images = np.random.default_rng(1).integers(-1, 2, (number, 3)) @ box
    return Packing(apart.positions + images, apart.radii, box, species=apart.species)


@pytest.fixture(scope="module")
def mixture() -> State:
    return state_of(leaning(30, (0.4, 0.7)))


@pytest.mark.parametrize(
    ("lattice", "sides", "q4", "q6"),
    [
        ("fcc", 12, 0.190941, 0.574524),
        ("bcc", 14, None, None),
    ],
)
def test_cells_of_crystals(lattice: str, sides: int, q4: float | None, q6: float | None) -> None:
    """Steinhardt's numbers; the cell of bcc is a truncated octahedron of known faces."""
    state = state_of(ld.crystal(lattice, 3, phi=0.8))
    assert state.local_phi == pytest.approx(np.full(len(state.packing), 0.8), rel=1e-12)
    assert (state.cell_sides == sides).all()
    for degree, known in ((4, q4), (6, q6)):
        if known is None:
            known = truncated_octahedron(degree)
        assert state.steinhardt(degree) == pytest.approx(known, abs=1e-6)


def truncated_octahedron(degree: int) -> float:
    """q of eight hexagons and six squares of one edge."""
    corners = np.array(list(product((1.0, -1.0), repeat=3))) / np.sqrt(3.0)
    normal = np.concatenate([corners, np.eye(3), -np.eye(3)])
    return by_harmonics(normal, np.repeat([1.5 * np.sqrt(3.0), 1.0], [8, 6]), degree)


def by_harmonics(normal: np.ndarray, area: np.ndarray, degree: int) -> float:
    """The definition, with harmonics of scipy."""
    theta, phi = np.arccos(normal[:, 2]), np.arctan2(normal[:, 1], normal[:, 0])
    total = 0.0
    for m in range(-degree, degree + 1):
        legendre = lpmv(abs(m), degree, np.cos(theta))
        size = (2 * degree + 1) / (4.0 * np.pi) * factorial(degree - abs(m))
        harmonic = legendre * np.exp(1j * m * phi) * np.sqrt(size / factorial(degree + abs(m)))
        total += abs(area @ harmonic) ** 2
    return float(np.sqrt(total * 4.0 * np.pi / (2 * degree + 1)) / area.sum())


def test_cells_fill_the_box(mixture: State) -> None:
    """Each point of space is in the cell of the sphere with the least d^2 - R^2."""
    packing, volume = mixture.packing, mixture.volumes / mixture.local_phi
    assert volume.sum() == pytest.approx(packing.volume, rel=1e-9)
    assert volume @ mixture.local_phi / packing.volume == pytest.approx(packing.phi)
    points = np.random.default_rng(2).random((20_000, 3)) @ packing.box
    least, owner = np.full(20_000, np.inf), np.zeros(20_000, int)
    wrapped = packing.positions @ np.linalg.inv(packing.box) % 1.0
    for step in product((-1, 0, 1), repeat=3):
        for n, center in enumerate((wrapped + step) @ packing.box):
            power = np.sum((points - center) ** 2, axis=1) - packing.radii[n] ** 2
            owner = np.where(power < least, n, owner)
            least = np.minimum(power, least)
    share = volume / packing.volume
    counted = np.bincount(owner, minlength=30)
    assert np.abs(counted - 20_000 * share).max() < 5.0 * np.sqrt(20_000 * share.max())


def test_equal_spheres_as_in_scipy() -> None:
    packing = leaning(30, (0.5, 0.5))
    state = state_of(packing)
    wrapped = packing.positions @ np.linalg.inv(packing.box) % 1.0
    steps = sorted(product((-1, 0, 1), repeat=3), key=any)
    diagram = Voronoi(np.concatenate([(wrapped + step) @ packing.box for step in steps]))
    corners = [diagram.vertices[diagram.regions[diagram.point_region[n]]] for n in range(30)]
    volume = [ConvexHull(each).volume for each in corners]
    assert state.volumes / state.local_phi == pytest.approx(volume, rel=1e-9)
    sides = np.bincount(diagram.ridge_points.ravel(), minlength=30)[:30]
    assert np.array_equal(state.cell_sides, sides)


def test_order_by_harmonics(mixture: State) -> None:
    cells = mixture._cells
    for degree in (4, 6, 7):
        parts = [(cells.direction[cells.i == n], cells.side[cells.i == n]) for n in range(30)]
        expected = [by_harmonics(*part, degree) for part in parts]
        assert mixture.steinhardt(degree) == pytest.approx(expected, abs=1e-9)


def test_a_sphere_within_another_has_no_cell() -> None:
    places = [[1.0, 1.0, 1.0], [1.0, 1.0, 1.1], [3.0, 3.0, 3.0]]
    state = state_of(Packing(places, [0.9, 0.2, 0.9], (4.0, 4.0, 4.0), species=[0, 1, 0]))
    assert np.isinf(state.local_phi[1])
    assert np.isfinite(state.local_phi[[0, 2]]).all()
    assert np.isnan(state.steinhardt()[1])
    assert state.cell_sides[1] == 0
    # the center of the small one is not in its cell, beside the large one
    places[1] = [1.0, 1.0, 1.85]
    beside = state_of(Packing(places, [0.9, 0.2, 0.9], (4.0, 4.0, 4.0), species=[0, 1, 0]))
    assert np.sum(beside.volumes / beside.local_phi) == pytest.approx(64.0, rel=1e-9)
    alone = state_of(Packing([[0.3, 0.2, 0.1]], 0.5, (2.0, 3.0, 4.0)))
    assert alone.local_phi == pytest.approx(np.pi / 6.0 / 24.0)
    assert alone.cell_sides.tolist() == [6]


def test_structure_factor_as_a_sum_over_pairs() -> None:
    packing = leaning(8, (0.4, 0.7))
    _, s = state_of(packing).structure_factor(k_max=6.0, bins=6)
    waves = 2.0 * np.pi * np.linalg.inv(packing.box).T
    apart = packing.positions[:, None] - packing.positions
    found: list[list[float]] = [[] for _ in range(6)]
    for orders in product(range(-6, 7), repeat=3):
        wave = np.array(orders) @ waves
        length = float(np.linalg.norm(wave))
        if 0.0 < length < 6.0:
            assert max(map(abs, orders)) < 6
            found[int(length)].append(float(np.cos(apart @ wave).sum()) / 8)
    expected = [np.mean(each) if each else np.nan for each in found]
    assert s == pytest.approx(np.array(expected), nan_ok=True)
    assert np.isfinite(s[2:]).all()


def test_shells_of_a_crystal() -> None:
    """g(r) counts 12, 6 and 24 neighbors at 1, sqrt 2 and sqrt 3."""
    pytest.importorskip("freud")
    crystal = ld.crystal("fcc", 4)
    r, g = state_of(crystal).radial_distribution(r_max=1.9, bins=190)
    density = len(crystal) / crystal.volume
    edges = np.linspace(0.0, 1.9, 191)
    shells = g * density * 4.0 / 3.0 * np.pi * np.diff(edges**3)
    for distance, count in ((1.0, 12), (np.sqrt(2.0), 6), (np.sqrt(3.0), 24)):
        assert shells[np.abs(r - distance) < 0.02].sum() == pytest.approx(count, rel=1e-3)
    assert shells.sum() == pytest.approx(42.0, rel=1e-3)


def test_affine_strain_is_told(mixture: State) -> None:
    """Also where tilts have been replaced by those of an equivalent box."""
    before = mixture.packing
    strain = np.eye(3) + np.array([[0.01, 0.0, 0.0], [0.03, -0.02, 0.0], [0.01, -0.02, 0.015]])
    box, places = before.box @ strain, before.positions @ strain
    wrapped = places - np.floor(places @ np.linalg.inv(box)) @ box
    after = state_of(Packing(wrapped, before.radii, box, species=before.species))
    assert after.nonaffine(before) == pytest.approx(np.zeros((30, 3)), abs=1e-9)
    local = after.local_strain(before, r_max=2.5)
    gradient = np.tile(strain.T - np.eye(3), (30, 1, 1))
    assert local.gradient == pytest.approx(gradient, abs=1e-9)
    assert local.d2min == pytest.approx(np.zeros(30), abs=1e-15)
    moved = wrapped.copy()
    moved[7] += [0.05, -0.04, 0.03]
    beside = state_of(Packing(moved, before.radii, box, species=before.species))
    assert beside.nonaffine(before)[7] == pytest.approx([0.05, -0.04, 0.03])
    assert beside.local_strain(before, 2.5).d2min.argmax() == 7
    crossing = [
        before,
        after,
        state_of(Packing(wrapped + box[2], before.radii, box, species=before.species)),
    ]
    paths = ld.Run(crossing).unwrapped()
    assert paths[2] == pytest.approx(paths[1], abs=1e-9)


def test_refusals(mixture: State) -> None:
    for call, told in (
        (lambda: mixture.steinhardt(0), "l must be at least 1, not 0"),
        (lambda: mixture.steinhardt(2.5), "l must be a whole number"),  # type: ignore[arg-type]
        (lambda: mixture.structure_factor(bins=100, k_max=-1.0), "k_max must be"),
        (lambda: mixture.radial_distribution(bins=100, r_max=20.0), "is too large for the box"),
        (lambda: mixture.density_waves([[1.0, 2.0]]), r"k must have shape \(M, 3\)"),
    ):
        with pytest.raises(ld.ParameterError, match=told):
            call()
    with pytest.raises(AttributeError, match="take steinhardt"):
        mixture.hexatic()
