"""The study of disordered crystals: limits that are known exactly, and its small run."""

import json
import math
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from scipy.optimize import brentq

from validation.disordered_crystals import __main__ as crystals

pytest.importorskip("matplotlib")
pytest.importorskip("freud")
pytest.importorskip("networkx")

FOLDER = Path(__file__).parents[2] / "validation" / "disordered_crystals"

PHI, TOUCH = 0.94, math.pi / math.sqrt(12.0)
HEXAGON = 2.0 * math.sqrt(3.0)  # its area over the square of its inradius


def fine(law: str, u: np.ndarray, eta: float) -> ld.State:
    packing = crystals.spread(crystals.crystal(len(u), PHI), u, eta)
    state = crystals.relaxed(packing, crystals.LAWS[law])
    return ld.Simulation(state, state.law).relax(1e-10)


def pressure(law: str, phi: float) -> float:
    """Of the perfect crystal; particles have the radius 1."""
    h = math.sqrt(TOUCH / phi)  # half of the spacing
    if law == "disks":
        return math.sqrt(3.0) * (1.0 - h) / h
    if law == "droplets":  # Princen
        return (math.sqrt((1.0 - TOUCH) / (1.0 - phi)) - 1.0) / h

    def shape(q: float) -> tuple[float, float]:
        """Pressure inside and what it exceeds that of the tension by, with corners of radius q."""
        inside = math.pi - HEXAGON * h**2 + (HEXAGON - math.pi) * q**2
        stretch = 2.0 * HEXAGON * h - 2.0 * (HEXAGON - math.pi) * q - 2.0 * math.pi
        kP = crystals.LAWS[law].kP
        return inside, stretch if kP == math.inf else inside * q - kP * stretch

    q = brentq(lambda q: shape(q)[1], 0.0, h, xtol=1e-15)
    return shape(q)[0] * (h - q) / h


@pytest.mark.parametrize("law", ["disks", "soft rings", "droplets"])
def test_equal_sizes_are_the_perfect_crystal(law: str) -> None:
    """Order 1, six equal forces, and pressure and moduli of closed forms."""
    row = crystals.measure(fine(law, np.zeros(64), 0.0), stiffness=True)
    for name in ("psi6", "local_psi6", "g6_far", "bragg"):
        assert row[name] == pytest.approx(1.0, abs=1e-6), name  # freud has single precision
    assert row["z"] == 6.0
    assert max(row["u2"], row["force_spread"]) < 1e-8
    assert row["pressure"] == pytest.approx(pressure(law, PHI), rel=1e-8)
    strain = 1e-4
    up, down = (pressure(law, PHI * (1.0 + sign * strain)) for sign in (1.0, -1.0))
    assert row["K"] == pytest.approx((up - down) / (2.0 * strain), rel=1e-5)
    if law == "disks":
        prestress = (1.0 - 1.0 / math.sqrt(PHI / TOUCH)) * math.sqrt(PHI / TOUCH)
        assert row["G"] == pytest.approx(math.sqrt(3.0) / 4.0 * (1.0 - 3.0 * prestress), rel=1e-8)
    if law == "droplets":
        exact = math.sqrt(math.sqrt(3.0) / (2.0 * math.pi) * PHI)
        assert row["G"] == pytest.approx(exact, rel=1e-8)


def test_droplets_of_unequal_sizes_are_as_stiff_as_equal_ones() -> None:
    """As long as no contact is lost: all films stay straight and meet at 120 degrees."""
    u = crystals.sizes(36, 1)
    same, other = (fine("droplets", u, eta) for eta in (0.0, 0.1))
    assert other.coordination == 6.0
    assert other.pressure_tensor == pytest.approx(same.pressure_tensor, rel=1e-9, abs=1e-10)
    tensors = [state.moduli().tensor for state in (same, other)]
    assert tensors[1] == pytest.approx(tensors[0], rel=1e-8, abs=1e-8)
    moved = other.nonaffine(same)
    assert np.abs(moved - moved.mean(axis=0)).max() > 0.02
    straight = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)
    perpendicular = crystals.relaxed(other.packing, straight)  # its lines do not turn
    assert 1e-3 < perpendicular.pressure / same.pressure - 1.0 < 1e-2


@pytest.mark.parametrize(
    ("law", "impurity"),
    [("disks", True), ("rings", False), ("soft rings", True), ("droplets", False)],
)
def test_linear_response_is_that_of_relaxed_packings(law: str, impurity: bool) -> None:
    """Relaxed with spreads +-eta their differences are off by a part of order eta^2 = 1e-6.

    Contacts are balanced to about 1e-4 of a force before the step of Newton's method.
    """
    u = (np.arange(36) == 14).astype(float) if impurity else crystals.sizes(36, 1)
    lattice = crystals.crystal(36, PHI)
    expected = crystals.linear_response(lattice, crystals.LAWS[law], u)
    larger, smaller = (fine(law, u, eta).nonaffine(lattice) for eta in (1e-3, -1e-3))
    found = (larger - smaller) / 2e-3
    found -= found.mean(axis=0) - expected.mean(axis=0)
    assert found == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())
    if impurity:  # neighbors are pushed away, those farther off less
        out, distance = pushed(lattice, 14, expected)
        assert out[distance < 1.1 * distance.min()].min() > 3.0 * np.abs(out[distance > 5.0]).max()


def pushed(lattice: ld.Packing, n: int, moved: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Radial parts of displacements relative to a particle, and distances from it."""
    fractions = (lattice.positions - lattice.positions[n]) / lattice.box.diagonal()
    away = np.delete((fractions - np.rint(fractions)) * lattice.box.diagonal(), n, axis=0)
    distance = np.hypot(*away.T)
    return np.sum(np.delete(moved - moved[n], n, axis=0) * away, axis=1) / distance, distance


def test_linear_response_of_disks_by_a_sum_over_contacts() -> None:
    """Springs of stiffness 1 under the force f at the distance d, written out."""
    lattice, u = crystals.crystal(36, PHI), crystals.sizes(36, 1)
    u_ij = u - u.mean()  # the mean keeps its value, as phi does
    apart = lattice.positions - lattice.positions[:, None]
    apart -= np.rint(apart / lattice.box.diagonal()) * lattice.box.diagonal()
    distance = np.linalg.norm(apart, axis=-1)
    matrix, force = np.zeros((36, 2, 36, 2)), np.zeros((36, 2))
    for i, j in np.argwhere((distance > 0.0) & (distance < 2.0)):
        n, d = apart[i, j] / distance[i, j], distance[i, j]
        spring = np.outer(n, n) - (2.0 - d) / d * (np.eye(2) - np.outer(n, n))
        matrix[i, :, i] += spring
        matrix[i, :, j] -= spring
        force[i] -= n * (u_ij[i] + u_ij[j])
    expected = np.linalg.lstsq(matrix.reshape(72, 72), force.ravel(), rcond=1e-10)[0].reshape(36, 2)
    found = crystals.linear_response(lattice, None, u)
    scale = np.abs(expected).max()
    assert found - found.mean(axis=0) == pytest.approx(expected, abs=1e-3 * scale)


@pytest.mark.parametrize("law", ["disks", "droplets"])
def test_small_spreads_act_linearly(law: str) -> None:
    """u^2, 1 - psi_6 and 1 - bragg are of order eta^2, the spread of the forces of order eta."""
    u = crystals.sizes(36, 2)
    one, two = (crystals.measure(fine(law, u, eta), False) for eta in (0.002, 0.004))
    for name, value, ratio in (
        ("u2", lambda x: x, 4.0),
        ("psi6", lambda x: 1.0 - x, 4.0),
        ("bragg", lambda x: 1.0 - x, 4.0),
        ("force_spread", lambda x: x, 2.0),
    ):
        assert value(two[name]) / value(one[name]) == pytest.approx(ratio, rel=0.02), name


@pytest.mark.parametrize(
    ("law", "phi", "slope"),
    [
        ("disks", 1.001 * TOUCH, 1.0 / (18.0 * math.sqrt(3.0) * math.pi)),
        ("droplets", PHI, math.sqrt(3.0) * PHI**2 / (24.0 * math.pi)),
    ],
)
def test_displacements_grow_as_the_logarithm_of_the_number(
    law: str, phi: float, slope: float
) -> None:
    """u = C/r around an inclusion in an elastic plane: ln N adds pi n C^2 to <u^2>.

    n is the number per area, and 1/12 the variance of sizes. Disks at the touch are springs with
    lambda = mu = sqrt(3)/4, and those around one press with the sum 3 a^2/2 of their moments: C =
    a^2/(sqrt(3) pi). Droplets all have one pressure, so that the cell of a larger one grows by as
    much as itself: C = R^2. A lattice of N sites differs by a part of 1/N.
    """
    small, large = (crystals.impurity(law, number, phi)["u2"] for number in (144, 576))
    assert (large - small) / math.log(4.0) == pytest.approx(slope, rel=0.01)


@pytest.mark.parametrize("law", ["disks", "droplets"])
def test_one_impurity_tells_the_mean_of_all_packings(law: str) -> None:
    """All sites are alike: the mean over independent sizes is the mean over places of one."""
    number, lattice = 16, crystals.crystal(16, PHI)
    response = [
        crystals.linear_response(lattice, crystals.LAWS[law], (np.arange(number) == n) * 1.0)
        for n in range(number)
    ]
    total = sum(crystals.mean_square(each, lattice) for each in response) / 12.0
    assert crystals.impurity(law, number, PHI)["u2"] == pytest.approx(total, rel=1e-3)


QUICK = json.loads((FOLDER / "quick.json").read_text())


@pytest.mark.parametrize("law", ["disks", "soft rings"])
def test_small_run_gives_the_stored_values(law: str) -> None:
    """Up to a spread of 0.1, before anything rearranges.

    Packings are relaxed to 1e-4 of a contact force: positions, and what is linear in them, are
    right to about that part of the effect of a spread, and to SMALL at the least.
    """
    (stored,) = (
        ramp
        for ramp in QUICK["ramps"]
        if (ramp["law"], ramp["number"], ramp["phi"], ramp["seed"]) == (law, 144, PHI, 1)
    )
    lattice, u = crystals.crystal(144, PHI), crystals.sizes(144, 1)
    response = crystals.linear_response(lattice, crystals.LAWS[law], u)
    found = crystals.mean_square(response, lattice)
    assert found == pytest.approx(stored["linear_u2"], rel=2e-3)
    packing, up = lattice, stored["up"]
    for n, eta in enumerate((0.0, 0.01, 0.02, 0.05, 0.1)):
        assert up["eta"][n] == eta
        state = crystals.relaxed(crystals.spread(packing, u, eta), crystals.LAWS[law])
        packing, row = state.packing, crystals.measure(state, stiffness=eta == 0.1)
        effect = {"psi6": 1.0, "bragg": 1.0, "pressure": up["pressure"][0]}
        for name, start in effect.items():
            change = abs(up[name][n] - start)
            assert row[name] == pytest.approx(up[name][n], abs=0.01 * change + 1e-5 * start), name
        assert row["u2"] == pytest.approx(up["u2"][n], rel=0.01, abs=1e-10)
        assert row["force_spread"] == pytest.approx(up["force_spread"][n], rel=0.01, abs=1e-6)
        assert row["z"] == pytest.approx(up["z"][n], abs=2.0 / 144)  # one contact about to open
    assert row["K"] == pytest.approx(up["K"][4], rel=0.05)
