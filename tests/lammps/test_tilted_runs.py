"""Contact lines that tilt: on several ranks, along trajectories, in relaxations and from files."""

from itertools import pairwise

import numpy as np
import pytest
from balanced import of_compute_pair
from scene import HEADER, PACKINGS, SPECIES, Scene
from test_balanced_runs import energy_error
from test_contacts import CONTACTS, contacts
from test_parallel import run as run_ranks
from test_restart import RUN, Continued
from test_soft_rings import mixture, pushed
from tilted import CASES, DEFAULT, EXACT, packing


@pytest.mark.parametrize("copies", [1, 4])
def test_ranks(copies, tmp_path):
    """Forces and tilts are the same on both ranks that share a pair, also when those change.

    If ranks did not take the same steps, forces would differ by the tolerance, and not by rounding.
    """
    fields = {
        "style": f"{DEFAULT} balance 1e-8 100",
        "name": "deformable/ring",
        "species": f"{SPECIES} fixed skinned",
        "data": tmp_path / "data",
        "boundary": "p p p",
        "commands": f"""
replicate {copies} {copies} 1
velocity all create 1e-3 4711 loop geom
neighbor 0.05 bin
""",
    }
    Scene.packing(PACKINGS[0], EXACT).run(f"write_data {fields['data']} nofix")
    grids = [(1, "1 1 1"), (2, "2 1 1"), (4, "2 2 1")]
    reference, *others = (
        run_ranks(ranks, grid, tmp_path / grid.replace(" ", ""), **fields) for ranks, grid in grids
    )
    assert reference[0][0][0] > 1e-6
    for found in others:
        for steps, (scalars, atoms) in reference.items():
            np.testing.assert_allclose(found[steps][0], scalars, rtol=1e-12)
            scale = 1e-12 * np.abs(atoms).max(axis=0)
            assert (np.abs(found[steps][1] - atoms) <= scale).all()


@pytest.mark.parametrize("lists", ["every 10 check yes", "every 1 delay 0 check no"])
def test_tilts_continue(lists):
    """Few evaluations along a trajectory, also with a new neighbor list in every step."""
    scene = mixture(PACKINGS[0], DEFAULT, commands=f"neigh_modify {lists}")[0]
    scene.run("velocity all create 1e-8 4711 loop all\nfix nve all nve\ntimestep 0.001\nrun 4")
    cold = mixture(PACKINGS[0], DEFAULT)[0]
    cold.energy()
    assert of_compute_pair(cold)[0] >= 8
    evaluations = []
    for _ in range(10):
        scene.run("run 1 pre no post no")
        evaluations.append(scene.vector("pair", 4)[2])
    assert max(evaluations) <= 3


def test_energy_is_conserved():
    """To second order in the time step."""
    errors = [energy_error(DEFAULT, dt) for dt in (0.4, 0.2, 0.1)]
    fall = errors[0][0] / errors[2][0]
    assert 8 < fall < 32
    assert errors[2][0] < 1e-4 * errors[2][1]


def test_momentum_and_angular_momentum():
    """Pair forces are opposite, and the torques of all of them cancel, also before balance.

    Forces and tilts are off by 1e-3 here; torques about the centers sum to zero for each ring.
    """
    x = np.array(CASES[0]["centres"])
    box = (-20, 20, -20, 20)
    scene = Scene(x, ["small"] * 8 + ["large"] * 8, box, f"{DEFAULT} balance 1e-3 100")
    force = scene.evaluate(x).force
    assert of_compute_pair(scene)[1] > 1e-6
    scale = np.abs(force).max()
    np.testing.assert_allclose(force.sum(0), 0, atol=1e-13 * scale)
    torque = x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0]
    assert abs(torque.sum()) < 1e-12 * scale


def test_descent():
    """FIRE to 1e-6 of the mean contact force."""
    scene = mixture(PACKINGS[0], DEFAULT)[0]
    shape = scene.evaluate(pushed(PACKINGS[0])).shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    scene.run("min_style fire\nmin_modify dmax 0.002\ntimestep 0.5")
    scene.run(f"minimize 0 {1e-7 * force} 20000 20000")
    assert of_compute_pair(scene)[1] <= 1e-7
    energy = scene.lmp.get_thermo("pe")
    state = scene.evaluate()
    assert energy == pytest.approx(state.energy, rel=1e-11)
    shape = state.shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    assert np.hypot(*state.force.T).max() <= 1e-6 * force
    assert state.energy > 1e-6


def test_contacts_that_open_and_close():
    """A particle loses two contacts and gains three: its tilts have no jump, nor has the energy."""
    scene = Scene.packing(PACKINGS[0], EXACT, commands=CONTACTS)
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


@pytest.mark.parametrize("kind", ["restart", "data"])
def test_files(kind, tmp_path):
    file = tmp_path / "file"
    style = f"{EXACT}"
    scene = Scene.packing(PACKINGS[0], style, commands=RUN)
    scene.run(f"velocity all create 1e-4 4711 loop all\nrun 20\nwrite_{kind} {file}\nrun 20")
    header = "" if kind == "restart" else HEADER.format(boundary="p p p")
    continued = Continued(f"{header}read_{kind} {file}", style)
    continued.run("run 20")
    np.testing.assert_allclose(continued.x, scene.x, rtol=0, atol=1e-11)
    assert continued.evaluate().energy == pytest.approx(scene.evaluate().energy, rel=1e-9)


def test_loose_tolerance(tmp_path):
    """Forces are off by the tolerance, the energy by its square."""
    tolerance = 1e-3
    exact = packing(CASES[0], tmp_path, EXACT).evaluate()
    state = packing(CASES[0], tmp_path, f"{DEFAULT} balance {tolerance} 100").evaluate()
    assert state.energy == pytest.approx(exact.energy, rel=20 * tolerance**2)
    largest = max(contact["force"] for contact in CASES[0]["contacts"])
    assert np.abs(state.force - exact.force).max() < 4 * tolerance * largest
