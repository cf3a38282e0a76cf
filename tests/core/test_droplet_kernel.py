"""A droplet between given forces: check values of regular arrangements, derivatives, limits."""

import numpy as np
import pytest
from lammps_deformable import core
from polyhedra import FACES, FORCES, INDENTATIONS, random_normals
from scipy.integrate import quad
from scipy.optimize import brentq

levels = pytest.mark.parametrize("level", core.simd_levels())


def equal(normals, indentation):
    """The droplet whose contacts all have this indentation, and their force."""

    def rest(f):
        return core.droplet(normals, np.full(len(normals), f)).indentation[0] - indentation

    f = brentq(rest, 1e-6, 2.0, xtol=1e-14)
    return core.droplet(normals, np.full(len(normals), f)), f


def test_regular_arrangements():
    for name, (*forces, work) in FORCES.items():
        for indentation, force in zip(INDENTATIONS, forces, strict=True):
            found, f = equal(FACES[name], indentation)
            assert f == pytest.approx(force, rel=5e-9), name  # all digits
            assert found.load == pytest.approx(len(FACES[name]) * f / (8 * np.pi))
            if indentation == 0.03:
                assert found.work == pytest.approx(work, rel=5e-9), name  # all digits


def between_plates(width):
    """Indentation and force of a droplet of volume 4 pi/3 whose facets have this part of its width.

    Its surface has constant mean curvature and meets the plates without an angle (Delaunay): with
    radius 1 in the middle and b at the facets,
    dz/dr = s/sqrt(1 - s^2), s = (r^2 - b^2)/(r (1 - b^2)).
    """
    b, middle = width, 1.0 - width**2

    def slope(turn):  # r = b + (1 - b) sin(turn), dz/dturn
        r = b + (1 - b) * np.sin(turn)
        s = (r**2 - b**2) / (r * middle)
        rest = (1 - r) * (r + b**2) / (r * middle)  # 1 - s
        return s / np.sqrt(rest * (1 + s)) * (1 - b) * np.cos(turn), r

    def integral(power):
        return quad(lambda turn: slope(turn)[0] * slope(turn)[1] ** power, 0, np.pi / 2 - 1e-9)[0]

    radius = np.cbrt(1.5 * integral(2))
    return 1 - integral(0) / radius, 2 * np.pi * b**2 / middle / radius


def test_between_plates():
    """The law has this part of the exact force."""
    for indentation, ratio in ((0.030, 0.986), (0.092, 0.946), (0.173, 0.880)):
        width = brentq(lambda width, a=indentation: between_plates(width)[0] - a, 0.01, 0.8)
        _, f = equal(FACES["plates"], indentation)
        assert f / between_plates(width)[1] == pytest.approx(ratio, abs=2e-3)


def unequal(z, seed, load=0.12):
    """Normals and forces of any kind, of this load."""
    normals = random_normals(z, seed)
    forces = np.random.default_rng(seed).uniform(0.05, 1.0, z)
    return normals, forces * (8 * np.pi * load / forces.sum())


def changes(function, x, step):
    """Derivatives of a function by each number of x, of fourth order in the step."""
    rows = []
    for n in range(x.size):
        at = [function(x + h * step * np.eye(x.size)[n].reshape(x.shape)) for h in (1, -1, 2, -2)]
        rows.append((8 * (at[0] - at[1]) - (at[2] - at[3])) / (12 * step))
    return np.array(rows)


@pytest.mark.parametrize(("z", "load"), [*((z, 0.12) for z in (1, 2, 8, 20)), (7, 0.51), (13, 0.9)])
def test_derivatives(z, load):
    normals, forces = unequal(z, z, load)
    radius, tension = 1.3, 0.7
    given = {"radius": radius, "tension": tension}
    forces = forces * radius * tension
    found = core.droplet(normals, forces, **given)
    by_force = changes(lambda f: core.droplet(normals, f, **given).work, forces, 1e-4)
    assert found.indentation == pytest.approx(by_force, abs=1e-11 * max(1.0, 10 * found.work))
    second = changes(lambda f: core.droplet(normals, f, **given).indentation, forces, 1e-4)
    assert found.compliance == pytest.approx(second, abs=1e-8)
    assert found.compliance == pytest.approx(found.compliance.T, abs=1e-15)

    across = np.eye(3) - np.einsum("ca,cb->cab", normals, normals)
    turned = changes(lambda n: core.droplet(n, forces, **given).work, normals, 1e-4).reshape(z, 3)
    expected = np.einsum("cab,cb->ca", across, found.d_normal)
    assert expected == pytest.approx(turned, abs=1e-10)

    moment = forces @ (radius - found.indentation)
    inside = 4 / 3 * np.pi * radius**3 * 3 * found.pressure
    outside = 2 * (4 * np.pi * radius**2 * tension + found.energy) + moment
    assert inside == pytest.approx(outside)
    assert found.energy == pytest.approx(forces @ found.indentation - found.work)


def test_work_is_convex_up_to_the_load_of_the_model():
    """Any loads up to x = 0.12 in regular arrangements, whether they balance or not."""
    rng = np.random.default_rng(1)
    for normals in FACES.values():
        for _ in range(200):
            forces = rng.exponential(size=len(normals)) ** 2
            forces *= 8 * np.pi * 0.12 / forces.sum()
            compliance = core.droplet(normals, forces).compliance
            assert np.linalg.eigvalsh(compliance)[0] > 0


def test_work_is_not_convex_far_beyond_the_model():
    """Equal forces on fcc contacts at a/R = 0.08, x = 0.49."""
    droplet, _ = equal(FACES["fcc"], 0.08)
    assert droplet.load > 0.4
    assert np.linalg.eigvalsh(droplet.compliance)[0] < 0


def test_work_grows_faster_than_the_square_of_forces():
    """Beyond x = 1/2, in any direction: else some positions would have no forces. It is convex
    again between regular contacts with equal forces."""
    for normals in FACES.values():
        for seed in range(20):
            forces = np.random.default_rng(seed).exponential(size=len(normals)) ** 2
            forces *= 8 * np.pi / forces.sum()
            work = [core.droplet(normals, s * forces).work for s in (1, 2, 4)]
            assert work[2] > 8 * work[1] > 64 * work[0] * np.sign(work[0])
        for load in (0.9, 1.0, 3.0):
            equal = np.full(len(normals), 8 * np.pi * load / len(normals))
            assert np.linalg.eigvalsh(core.droplet(normals, equal).compliance)[0] > 0


def test_work_of_one_contact():
    """Beyond x = 1/2 it has the further term, 30 (x - 1/2)^3."""
    for x in (0.3, 0.6, 1.5):
        bracket = -np.log(x) - 1 / 3 + np.log(1 + 4 * x**2) / 2 + 30 * max(x - 0.5, 0) ** 3
        found = core.droplet([[0, 0, 1]], [8 * np.pi * x])
        assert found.work == pytest.approx(8 * np.pi * x**2 * bracket, rel=1e-14)


@levels
def test_levels_agree(level):
    for z in (1, 2, 7, 8, 13, 20):
        normals, forces = unequal(z, z)
        plain, found = (core.droplet(normals, forces, level=each) for each in ("plain", level))
        assert plain.work == found.work
        for name in ("indentation", "d_normal", "compliance"):
            assert (getattr(plain, name) == getattr(found, name)).all(), (z, name)


def test_forces_that_vanish():
    """a ~ f ln(8 pi/f)/(4 pi); a contact without force is indented by the others only."""
    normals, forces = unequal(6, 5)
    forces[2] = 0.0
    full, rest = (
        core.droplet(normals, forces),
        core.droplet(*[np.delete(x, 2, 0) for x in (normals, forces)]),
    )
    assert np.delete(full.indentation, 2) == pytest.approx(rest.indentation, rel=1e-14)
    assert full.work == pytest.approx(rest.work, rel=1e-14)
    assert np.isfinite(full.indentation).all()
    for f in (1e-9, 1e-100):
        alone = core.droplet([[0, 0, 1]], [f])
        assert alone.indentation[0] == pytest.approx(
            f * (np.log(8 * np.pi / f) - 5 / 6) / (4 * np.pi)
        )


def test_a_droplet_alone():
    alone = core.droplet(np.zeros((0, 3)), [], radius=2.0, tension=3.0)
    assert alone.load == alone.work == alone.energy == 0.0
    assert alone.pressure == pytest.approx(3.0)


def test_contacts_in_one_direction_repel_each_other():
    """The indentation grows like the logarithm of their angle, to a bound."""
    angles, force = np.array([0.1, 1e-3, 1e-5, 0]), 0.1
    normals = [[[0, 0, 1], [0, np.sin(angle), np.cos(angle)]] for angle in angles]
    at = np.array([core.droplet(pair, [force, 0]).indentation[1] for pair in normals])
    half = np.maximum(np.sin(angles / 2) ** 2, 1e-12)  # (1 - m)/2
    green = -(1 / 2 + (1 - 2 * half) * (4 / 3 + np.log(half))) / (4 * np.pi)
    load = force / (8 * np.pi)
    of_all = force * load / (8 * np.pi) * 4 * load / (1 + 4 * load**2)
    assert at == pytest.approx(green * force + of_all, rel=1e-5)  # of 1 - m at 1e-5
    assert at[-1] < 0.3
    assert not core.droplet(normals[-1], [force, force]).d_normal.any()  # beyond the limit


def test_contacts_bulge_by_less_than_the_bound():
    """No force in any direction moves another contact outward by more than 1.177 x R."""
    cosine = np.linspace(-1, 1, 1001)
    normals = [[np.sqrt(1 - m * m), 0.0, m] for m in cosine[:-1]]
    at = [core.droplet([[0, 0, 1], n], [1e-3, 0.0]) for n in normals]
    bulge = np.array([-each.indentation[1] / each.load for each in at])
    assert bulge.max() == pytest.approx(1.1765, abs=1e-3)
    assert bulge.max() < 1.177


def test_errors():
    for change, message in (
        ({"normals": [[0, 0, 0]]}, "normal 0"),
        ({"normals": [[0, 0, np.nan]]}, "normals"),
        ({"forces": [-1.0]}, "force 0"),
        ({"forces": [1.0, 1.0]}, "one value"),
        ({"radius": 0.0}, "radius"),
        ({"tension": -1.0}, "tension"),
        ({"level": "sse9"}, "sse9"),
    ):
        given = {"normals": [[0, 0, 1]], "forces": [0.1]} | change
        with pytest.raises(ValueError, match=message):
            core.droplet(**given)
