"""Contact lines that tilt and bend: known packings, closed forms, changes, limits."""

from itertools import pairwise

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts, of_compute_pair
from curved import CASES, known
from derivatives import assert_forces
from laws import CURVED, EXACT
from scene import BOX, FOUR, PACKINGS, ROOM_OF_FOUR, Scene, box_walls
from scipy.optimize import fsolve
from turns import in_turn

cases = pytest.mark.parametrize("case", CASES, ids=[case["name"] for case in CASES])
# beside energy and virial: evaluations, imbalance, lines at a limit
OUTPUTS = 6


@cases
def test_known_packings(case, tmp_path):
    """Energies, forces, shapes and every contact of an independent code."""
    scene = known(case, tmp_path, commands=CONTACTS)
    state = scene.evaluate()
    assert state.energy == pytest.approx(case["energy"], rel=1e-11)
    largest = max(abs(contact["force"]) for contact in case["contacts"])
    np.testing.assert_allclose(state.force, case["force"], rtol=0, atol=1e-10 * largest)
    for name in ("pressure", "area", "perimeter"):
        np.testing.assert_allclose(state.shape[name], case[name], rtol=1e-10)

    seen = contacts(scene)
    rows = {}
    for n in range(len(seen["atom"])):
        key = seen["atom"][n] - 1, seen["partner"][n] - 1
        assert key not in rows
        rows[key] = {name: seen[name][n] for name in ("force", "tilt", "half_angle", "length")}
    assert len(rows) == 2 * len(case["contacts"])
    for contact in case["contacts"]:
        for pair, sign in (((contact["i"], contact["j"]), 1), ((contact["j"], contact["i"]), -1)):
            row = rows[pair]
            assert row["force"] == pytest.approx(contact["force"], abs=1e-10 * largest)
            assert row["tilt"] == pytest.approx(contact["tilt"], abs=1e-9)
            assert row["half_angle"] == pytest.approx(sign * contact["half_angle"], abs=1e-9)
            length = np.broadcast_to(contact["length"], 2)[(1 - sign) // 2]
            assert row["length"] == pytest.approx(length, rel=1e-7)


@pytest.mark.parametrize(("case", "size"), in_turn(CASES[1::2], [0.99, 0.975]))
def test_forces_of_known_packings(case, size, tmp_path):
    """Compressed further, where tilts and half angles reach 0.1 rad."""
    scene = known(case, tmp_path, scale=size)
    state = scene.evaluate()
    assert of_compute_pair(scene)[1] <= 1e-12
    assert state.beyond == 0
    assert_forces(scene, scene.x)


def test_equal_particles_are_those_of_balanced():
    """In a hexagonal crystal nothing tilts or bends."""
    spacing = 0.97
    height = spacing * np.sqrt(0.75)
    x = np.array([((n + 0.5 * (m % 2)) * spacing, m * height) for m in range(4) for n in range(4)])
    box = (0, 4 * spacing, 0, 4 * height)
    for species in ("small", "both", "drop"):
        states = [
            Scene(x, [species] * 16, box, EXACT[law]).evaluate() for law in ("balanced", "curved")
        ]
        assert states[1].energy == pytest.approx(states[0].energy, rel=1e-13)
        pressures = [state.shape["pressure"] for state in states]
        np.testing.assert_allclose(pressures[1], pressures[0], rtol=1e-12)


def slit(radii, width, gamma):
    """Energy, force, pressures and half angle of two droplets in a row between two plates.

    Each outline is a flat part on its plate, two arcs of the radius q = gamma/p, and half of the
    film, an arc of the half angle b: the width is (q_i + q_j)(1 + cos b).
    """

    def shape(unknown):
        p, force = unknown[:2], unknown[2]
        q, flat = gamma / p, force / p
        sine = (flat[1] - flat[0]) / (2 * q.sum())
        b = np.array([1, -1]) * np.arcsin(sine)
        half_chord = 0.5 * flat + q * np.sin(b)
        segment = half_chord**2 * (b - np.sin(b) * np.cos(b)) / np.sin(b) ** 2
        area = flat * q * (1 + np.cos(b)) + q**2 * (np.pi - b + np.sin(b) * np.cos(b)) + segment
        perimeter = flat + 2 * q * (np.pi - b) + 2 * half_chord * b / np.sin(b)
        return area, perimeter, q.sum() * (1 + np.cos(b[0])), b[0]

    def left(unknown):
        area, _, total, _ = shape(unknown)
        return [*(area - np.pi * radii**2), total - width]

    start = [*(1.2 * gamma / radii), 0.3 * gamma]
    found, _, converged, why = fsolve(left, start, xtol=1e-14, full_output=True)
    assert np.abs(left(found)).max() < 1e-13, (converged, why)
    _, perimeter, _, b = shape(found)
    return gamma * np.sum(perimeter - 2 * np.pi * radii), found[2], found[:2], b


@pytest.mark.parametrize("width", [2.9, 2.3])
def test_two_droplets_in_a_slit(width, tmp_path):
    """A film between droplets of radius 0.5 and 1, against its closed form."""
    radii, gamma = np.array([0.5, 1.0]), 0.7
    energy, force, pressures, half_angle = slit(radii, width, gamma)
    (tmp_path / "species").write_text(
        f"# UNITS: lj\ntiny 0.5 inf 0 tension {gamma}\nwide 1.0 inf 0 tension {gamma}\n"
    )
    scene = Scene(
        [[0.16 * width, 0.0], [0.67 * width, 0.0]],
        ["tiny", "wide"],
        (-1, width + 1, -6, 6),
        EXACT["curved"],
        coeff=f"pair_coeff * * {tmp_path / 'species'} tiny wide",
        boundary="f f p",
        commands=box_walls(0, width, -5, 5) + CONTACTS,
    )
    scene.run("min_style fire\nminimize 0 1e-11 10000 100000")
    state = scene.evaluate(scene.gather("x", 3)[:, :2])
    seen = contacts(scene)
    assert state.energy == pytest.approx(energy, rel=1e-11)
    np.testing.assert_allclose(state.shape["pressure"], pressures, rtol=1e-9)
    film = seen["partner"] > 0
    np.testing.assert_allclose(seen["force"], force, rtol=1e-9)
    np.testing.assert_allclose(seen["half_angle"][film], [half_angle, -half_angle], rtol=1e-8)
    assert half_angle > 0.01
    assert (seen["half_angle"][~film] == 0).all()


def test_lines_of_walls_stay():
    options = {"boundary": "f f p", "commands": ROOM_OF_FOUR + CONTACTS}
    species = ["small", "weak", "both", "fixed"]
    seen = contacts(Scene(FOUR, species, BOX, EXACT["curved"], **options))
    wall = seen["partner"] < 0
    assert wall.sum() == 8
    for name in ("tilt", "half_angle"):
        assert (seen[name][wall] == 0).all()
        assert (np.abs(seen[name][~wall]) > 1e-4).all()
        assert (np.abs(seen[name][~wall]) < 0.2).all()


def test_lines_that_would_tilt_too_far(tmp_path):
    """Three particles beyond the model: two lines tilt by 0.3, are counted, and said."""
    log = tmp_path / "log"
    x = np.array([[0, 0], [0.75, 0], [0.375, 0.45]])
    scene = Scene(x, ["small"] * 3, BOX, f"{EXACT['curved']} reach 1", commands=CONTACTS, log=log)
    seen = contacts(scene)
    assert of_compute_pair(scene)[1] <= 1e-12
    assert scene.vector("pair", OUTPUTS)[4] == 2
    assert np.sum(np.abs(seen["tilt"]) > 0.3 - 1e-14) == 4
    assert np.abs(seen["tilt"]).max() <= 0.3 + 1e-14
    assert log.read_text().count("WARNING: Contact lines would tilt") == 1


def test_lines_that_would_bend_too_far(tmp_path):
    """Soft particles between hard ones, far beyond 5 %: half angles end at 30 degrees."""
    log = tmp_path / "log"
    (tmp_path / "species").write_text("# UNITS: lj\nsoft 0.5 1 0.001\nhard 0.5 1e4 1e4\n")
    box = (0, 3.9, -2, 2)
    x = [[0.3 + 0.65 * n, 0.0] for n in range(6)]
    scene = Scene(
        x,
        ["soft", "hard"] * 3,
        box,
        f"{EXACT['curved']} reach 1",
        coeff=f"pair_coeff * * {tmp_path / 'species'} soft hard",
        commands=CONTACTS,
        log=log,
    )
    seen = contacts(scene)
    assert np.abs(seen["half_angle"]).max() == pytest.approx(np.pi / 6, rel=1e-12)
    assert scene.vector("pair", OUTPUTS)[4] == 6
    assert log.read_text().count("WARNING: Contact lines would tilt") == 1


def test_momentum_and_angular_momentum():
    """Pair forces are opposite, and the torques of all of them cancel, also before balance.

    Forces and tilts are off by 1e-3 here; torques about the centers sum to zero for each ring.
    """
    x = np.array(next(case for case in CASES if case["name"] == "rings 1")["x"])
    box = (-20, 20, -20, 20)
    scene = Scene(x, ["small"] * 8 + ["large"] * 8, box, f"{CURVED} balance 1e-3 100")
    force = scene.evaluate(x).force
    assert of_compute_pair(scene)[1] > 1e-6
    scale = np.abs(force).max()
    np.testing.assert_allclose(force.sum(0), 0, atol=1e-13 * scale)
    torque = x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]
    assert abs(torque.sum()) < 1e-12 * scale


def test_contacts_that_open_and_close():
    """A particle loses contacts and gains others: lines have no jump, nor has the energy."""
    scene = Scene.packing(PACKINGS[0], EXACT["curved"], commands=CONTACTS)
    shifts = np.linspace(-0.1, 0.1, 101)
    lines, energies = [], []
    for shift in shifts:
        x = np.array(PACKINGS[0]["x"])
        x[1, 0] += shift
        energies.append(scene.energy(x))
        seen = contacts(scene)
        its = seen["atom"] == 2
        each = zip(*(seen[name][its] for name in ("tilt", "half_angle")), strict=True)
        lines.append(dict(zip(seen["partner"][its], each, strict=True)))
    assert sum(len(set(a) ^ set(b)) for a, b in pairwise(lines)) >= 4
    largest = max(
        np.abs(np.subtract(a[k], b[k])).max() for a, b in pairwise(lines) for k in set(a) & set(b)
    )
    assert largest < 1.0 * (shifts[1] - shifts[0])
    # a jump would be there threefold
    assert np.abs(np.diff(energies, 3)).max() < 2e-4 * np.ptp(energies)


@pytest.mark.parametrize(("case", "tolerance"), in_turn(CASES[::2], [1e-3, 1e-5]))
def test_loose_tolerance(case, tolerance, tmp_path):
    """Forces are off by the tolerance, the energy by its square, or by rounding.

    Forces of contacts that stick count from the pull that tears them off.
    """
    style = f"{CURVED} balance {tolerance} 100"
    state = known(case, tmp_path, style).evaluate()
    assert state.energy == pytest.approx(case["energy"], rel=20 * tolerance**2 + 1e-12)
    largest = max(contact["force"] for contact in case["contacts"])
    w = case["adhesion"]
    largest += 2 * np.sqrt(w - 0.25 * w**2)
    assert np.abs(state.force - case["force"]).max() < 4 * tolerance * largest
