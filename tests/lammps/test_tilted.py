"""Contact lines that tilt: known packings, how tilts change, the error that is told."""

from itertools import pairwise

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts, of_compute_pair
from deformable import core
from derivatives import assert_forces
from laws import CURVED, EXACT, RADICAL, balanced_laws
from materials import STIFFNESS, packing, pushed, radii_of, species_of
from scene import BOX, FOUR, PACKINGS, ROOM_OF_FOUR, Scene
from tilted import CASES, known

cases = pytest.mark.parametrize("case", CASES, ids=[case["case"] for case in CASES])
# beside energy and virial: evaluations, imbalance, error of the model, limited tilts
OUTPUTS = 6


@cases
def test_known_packings(case, tmp_path):
    """Energies, forces, areas and every contact of an independent code."""
    scene = known(case, tmp_path, commands=CONTACTS)
    state = scene.evaluate()
    assert state.energy == pytest.approx(case["energy"], rel=1e-12)
    largest = max(contact["force"] for contact in case["contacts"])
    np.testing.assert_allclose(state.force, case["forces"], rtol=0, atol=1e-9 * largest)
    ring = (np.array(case["radii"]) - case["skin"])[case["species"]]
    deficit = np.pi * ring**2 - state.shape["area"]
    np.testing.assert_allclose(deficit, case["area_deficits"], rtol=0, atol=1e-10)

    seen = contacts(scene)
    rows = {}
    for n in range(len(seen["atom"])):
        key = seen["atom"][n] - 1, seen["partner"][n] - 1
        rows.setdefault(key, []).append(
            [seen[name][n] for name in ("force", "indentation", "tilt")]
        )
    assert sum(map(len, rows.values())) == 2 * len(case["contacts"])
    for contact in case["contacts"]:
        i, j = contact["i"], contact["j"]
        for pair, name in (((i, j), "indentation_i"), ((j, i), "indentation_j")):
            force, indentation, tilt = min(
                rows[pair], key=lambda row, of=contact["force"]: abs(row[0] - of)
            )
            assert force == pytest.approx(contact["force"], abs=1e-10 * largest)
            assert indentation == pytest.approx(contact[name], abs=1e-9)
            assert tilt == pytest.approx(contact["tilt"], abs=1e-9)


@cases
def test_upright_lines(case, tmp_path):
    """The balanced law has the energy of lines that only shift."""
    energy = known(case, tmp_path, EXACT["balanced"]).energy()
    assert energy == pytest.approx(case["energy_shift_only"], rel=1e-12)


@pytest.mark.parametrize("size", [0.99, 0.97])
@cases
def test_forces_of_known_packings(case, size, tmp_path):
    """Compressed further, beyond 5 %, where tilts reach 0.1 rad."""
    scene = known(case, tmp_path, scale=size)
    state = scene.evaluate()
    assert of_compute_pair(scene)[1] <= 1e-12
    assert state.beyond == 0
    assert_forces(scene, scene.x)


def test_tilts_save_energy():
    case = PACKINGS[0]
    tilted, balanced = (
        packing(case, EXACT[law]).energy(pushed(case)) for law in ("curved", "balanced")
    )
    assert 0.9 * balanced < tilted < 0.999 * balanced


def test_lines_of_walls_do_not_tilt():
    options = {"boundary": "f f p", "commands": ROOM_OF_FOUR + CONTACTS}
    species = ["small", "weak", "both", "fixed"]
    seen = contacts(Scene(FOUR, species, BOX, EXACT["curved"], **options))
    wall = seen["partner"] == 0
    assert wall.sum() == 8
    assert (seen["tilt"][wall] == 0).all()
    assert (np.abs(seen["tilt"][~wall]) > 1e-4).all()
    assert (np.abs(seen["tilt"][~wall]) < 0.1).all()


@balanced_laws
def test_model_error(law):
    """The energy that curved lines would save, from pressures and tensions of both sides."""
    case = PACKINGS[0]
    scene = packing(case, EXACT[law], commands=CONTACTS)
    scene.run("fix error all pair 1 deformable/ring model_error 0")
    state = scene.evaluate(pushed(case))
    radius, names = radii_of(case), species_of(case)
    seen = contacts(scene)
    i, j = (seen[name].astype(int) - 1 for name in ("atom", "partner"))
    rings = [
        core.forced_ring(
            radius[n], seen["angle"][i == n], seen["force"][i == n], *STIFFNESS[names[n]]
        )
        for n in range(len(radius))
    ]
    expected = np.zeros(len(radius))
    for n, force in enumerate(seen["force"]):
        a, b = rings[i[n]], rings[j[n]]
        saved = core.curvature_energy(force, a.pressure, b.pressure, a.tension, b.tension)
        expected[i[n]] += 0.5 * saved
    expected = np.minimum(expected, state.atom_energy)
    found = scene.gather("f_error", 1)[:, 0]
    np.testing.assert_allclose(found, expected, rtol=1e-8)
    assert scene.vector("pair", OUTPUTS)[4] == pytest.approx(expected.sum(), rel=1e-8)
    assert 1e-4 < expected.sum() / state.energy < 0.1


def test_error_that_is_not_told():
    scene = Scene.packing(PACKINGS[0], RADICAL)
    with pytest.raises(Exception, match="model_error"):
        scene.run("fix error all pair 1 deformable/ring model_error 0\nrun 0")
    assert (scene.vector("pair", OUTPUTS)[2:] == 0).all()


def test_lines_that_would_tilt_too_far(tmp_path):
    """Three particles beyond the model: two lines tilt by 0.3, are counted, and said."""
    log = tmp_path / "log"
    x = np.array([[0, 0], [0.75, 0], [0.375, 0.45]])
    scene = Scene(x, ["small"] * 3, BOX, f"{EXACT['curved']} reach 1", commands=CONTACTS, log=log)
    seen = contacts(scene)
    assert of_compute_pair(scene)[1] <= 1e-12
    assert scene.vector("pair", OUTPUTS)[5] == 2
    assert np.sum(np.abs(seen["tilt"]) > 0.3 - 1e-14) == 4
    assert np.abs(seen["tilt"]).max() <= 0.3 + 1e-14
    assert log.read_text().count("WARNING: Contact lines would tilt") == 1


def test_momentum_and_angular_momentum():
    """Pair forces are opposite, and the torques of all of them cancel, also before balance.

    Forces and tilts are off by 1e-3 here; torques about the centers sum to zero for each ring.
    """
    x = np.array(CASES[0]["centres"])
    box = (-20, 20, -20, 20)
    scene = Scene(x, ["small"] * 8 + ["large"] * 8, box, f"{CURVED} balance 1e-3 100")
    force = scene.evaluate(x).force
    assert of_compute_pair(scene)[1] > 1e-6
    scale = np.abs(force).max()
    np.testing.assert_allclose(force.sum(0), 0, atol=1e-13 * scale)
    torque = x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]
    assert abs(torque.sum()) < 1e-12 * scale


def test_contacts_that_open_and_close():
    """A particle loses two contacts and gains three: its tilts have no jump, nor has the energy."""
    scene = Scene.packing(PACKINGS[0], EXACT["curved"], commands=CONTACTS)
    shifts = np.linspace(-0.1, 0.1, 101)
    tilts, energies = [], []
    for shift in shifts:
        x = np.array(PACKINGS[0]["x"])
        x[1, 0] += shift
        energies.append(scene.energy(x))
        seen = contacts(scene)
        its = seen["atom"] == 2
        tilts.append(dict(zip(seen["partner"][its], seen["tilt"][its], strict=True)))
    assert sum(len(set(a) ^ set(b)) for a, b in pairwise(tilts)) == 5
    largest = max(abs(a[k] - b[k]) for a, b in pairwise(tilts) for k in set(a) & set(b))
    assert largest < 0.7 * (shifts[1] - shifts[0])
    # a jump would be there threefold
    assert np.abs(np.diff(energies, 3)).max() < 2e-4 * np.ptp(energies)


def test_loose_tolerance(tmp_path):
    """Forces are off by the tolerance, the energy by its square."""
    tolerance = 1e-3
    exact = known(CASES[0], tmp_path).evaluate()
    state = known(CASES[0], tmp_path, f"{CURVED} balance {tolerance} 100").evaluate()
    assert state.energy == pytest.approx(exact.energy, rel=20 * tolerance**2)
    largest = max(contact["force"] for contact in CASES[0]["contacts"])
    assert np.abs(state.force - exact.force).max() < 4 * tolerance * largest
