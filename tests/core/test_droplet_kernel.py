"""A droplet between given forces: check values of regular arrangements, derivatives, limits."""

import droplet_formula as formula
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


N = np.array([[1, 0, 0], [-0.6, 0.8, 0], [-0.48, -0.64, 0.6], [0, 0, -1]])
F = np.array([0.1, 0.2, 0.3, 0.05])


def without_balance(f, n):
    """Work, indentations and torques of unbalanced forces, without the term that holds them."""
    found, off, x = core.droplet(n, f), f @ n, f.sum() / (8 * np.pi)
    torque = found.d_normal - 0.5 * x * np.outer(f, off)
    return (
        found.work - 0.25 * x * off @ off,
        found.indentation - 0.25 / (8 * np.pi) * off @ off - 0.5 * x * n @ off,
        torque - (torque * n).sum(axis=1)[:, None] * n,
        found.compliance - 0.5 / (8 * np.pi) * np.add.outer(n @ off, n @ off) - 0.5 * x * n @ n.T,
    )


def test_check_values():
    """Of the prototype of the law, by another program."""
    work, a, torque, compliance = without_balance(F, N)
    assert work == pytest.approx(0.02229537743618, abs=1e-10)
    assert a == pytest.approx(
        [0.03824235841353, 0.05428638928115, 0.07741172307976, 0.01382656655173], abs=1e-10
    )
    expected = [
        [0.28069618558079, 0.01744937413511, 0.0033890831646, -0.0365880250794],
        [0.01744937413511, 0.219664349102, -0.0201159816565, -0.0369383757377],
        [0.0033890831646, -0.0201159816565, 0.1806671356656, 0.01364341266831],
        [-0.0365880250794, -0.0369383757377, 0.01364341266831, 0.3439023149519],
    ]
    assert compliance == pytest.approx(np.array(expected), abs=1e-9)
    assert torque[0] == pytest.approx([0, 0.00013197374854, -0.00171628620253], abs=1e-10)


def test_terms_of_the_formula():
    """The reference of these tests, by the prototype."""
    found = formula.parts(F, N)
    for name, value in {
        "Morse-Witten": 0.02284637874260,
        "a1": -0.00079333592604,
        "f^3": 0.00003812737249,
        "T1": -0.00005925955710,
        "J": 0.00379017917248,
        "I3": -0.00011700676424,
    }.items():
        assert found[name] == pytest.approx(value, abs=1e-14), name
    assert found["psi"] == pytest.approx(0.00566989484765 * 0.02397264589211, abs=1e-14)
    assert formula.facets(F, N)[0] == pytest.approx([0, -0.00181657282228, 0.01688396439591])
    assert formula.green2(np.array([0.0, -1.0])) == pytest.approx(
        [-0.01175484405056, 0.02079154965241], abs=1e-14
    )


@pytest.mark.parametrize("z", [1, 2, 5, 9, 14])
def test_work_is_that_of_the_formula(z):
    """The kernels take polynomials for the dilogarithm."""
    normals, forces = unequal(z, z)
    found = core.droplet(normals, forces)
    assert found.work == pytest.approx(formula.work(forces, normals), abs=1e-10)
    by_force = formula.by_steps(lambda f: formula.work(f, normals), forces)
    assert found.indentation == pytest.approx(by_force, abs=1e-10)


def test_regular_arrangements():
    for name, (*forces, energy) in FORCES.items():
        for indentation, force in zip(INDENTATIONS, forces, strict=True):
            if force is None:
                continue
            found, f = equal(FACES[name], indentation)
            assert f == pytest.approx(force, rel=1e-9), name
            assert found.load == pytest.approx(len(FACES[name]) * f / (8 * np.pi))
            if indentation == 0.03:
                assert found.energy == pytest.approx(energy, abs=1e-10), name


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
    for indentation, ratio in ((0.030, 1.0), (0.092, 1.0006), (0.173, 1.0021), (0.25, 1.0066)):
        width = brentq(lambda width, a=indentation: between_plates(width)[0] - a, 0.01, 0.8)
        _, f = equal(FACES["plates"], indentation)
        assert f / between_plates(width)[1] == pytest.approx(ratio, abs=6e-5)


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
    """Any loads up to x = 0.1 in regular arrangements, whether they balance or not; equal ones up
    to 0.28."""
    rng = np.random.default_rng(1)
    for normals in FACES.values():
        for _ in range(200):
            forces = rng.exponential(size=len(normals)) ** 2
            forces *= 8 * np.pi * 0.1 / forces.sum()
            compliance = core.droplet(normals, forces).compliance
            assert np.linalg.eigvalsh(compliance)[0] > 0
        equal = np.full(len(normals), 8 * np.pi * 0.28 / len(normals))
        assert np.linalg.eigvalsh(core.droplet(normals, equal).compliance)[0] > 0


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


@pytest.mark.parametrize("load", [0.3, 0.6, 1.5])
def test_work_of_one_contact(load):
    """Beyond x = 1/2 it has the further term, 30 (x - 1/2)^3."""
    f, one = np.array([8 * np.pi * load]), np.array([[0.0, 0.0, 1.0]])
    further = 8 * np.pi * load**2 * 30 * max(load - 0.5, 0) ** 3
    found = core.droplet(one, f)
    assert found.work == pytest.approx(formula.work(f, one) + further, rel=1e-9)


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
    x = force / (8 * np.pi)
    assert at == pytest.approx(green * force, rel=0.06)
    assert np.diff(at[1:]) == pytest.approx(np.diff(green[1:]) * force * (1 - 2 * x), rel=1e-3)
    assert at[-1] < 0.3
    assert not core.droplet(normals[-1], [force, force]).d_normal[:, :2].any()  # beyond the limit


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
