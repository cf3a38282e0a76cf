"""Balanced contacts: on several ranks, along trajectories and in relaxations."""

import numpy as np
import pytest
from balanced import DEFAULT, EXACT, of_compute_pair
from deformable import core
from scene import PACKINGS, SPECIES, Scene
from test_contacts import CONTACTS, contacts
from test_parallel import run as run_ranks
from test_soft_rings import mixture, pushed

BOX_OF_FOUR = (-5, 5, -2, 8)


@pytest.mark.parametrize("copies", [1, 4])
def test_ranks(copies, tmp_path):
    """Forces are the same on both ranks that share a pair, also when particles change ranks.

    If ranks did not take the same steps, forces would differ by the tolerance, and not by rounding,
    which a few violent steps multiply.
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
    scene = Scene.packing(PACKINGS[0], EXACT)
    scene.run(f"write_data {fields['data']} nofix")
    grids = [(1, "1 1 1"), (2, "2 1 1"), (4, "2 2 1")]
    reference, *others = (
        run_ranks(ranks, grid, tmp_path / grid.replace(" ", ""), **fields) for ranks, grid in grids
    )
    assert reference[0][0][0] > 1e-6
    for found in others:
        for steps, (scalars, atoms) in reference.items():
            np.testing.assert_allclose(found[steps][0], scalars, rtol=1e-12)
            scale = (1e-12 if steps == 0 else 1e-11) * np.abs(atoms).max(axis=0)
            assert (np.abs(found[steps][1] - atoms) <= scale).all()


@pytest.mark.parametrize("far", [False, True])
def test_imbalance(far):
    """What is left of the overlap, over the compliance of both sides and the largest force of all.

    The overlap is known only as the sum of the indentations that each force needs.
    """
    tolerance = 1e-4
    style = f"{DEFAULT} balance {tolerance} 100"
    x, species = [[0, 0], [0.97, 0]], ["small", "weak"]
    if far:  # a pair with much larger forces
        x, species = [*x, [0, 5], [0.9, 5]], [*species, "small", "small"]
    scene = Scene(x, species, BOX_OF_FOUR, style, commands=CONTACTS)
    seen = contacts(scene)
    force = seen["force"]
    assert force[0] == force[1]
    evaluations, imbalance = of_compute_pair(scene)
    assert evaluations > 1
    assert 0 < imbalance <= tolerance
    rings = [core.forced_ring(0.5, [0.0], [force[0]], kA, np.inf) for kA in (1.0, 0.3)]
    left = 0.03 - sum(ring.indentation[0] for ring in rings)
    off = abs(left) / sum(ring.compliance[0, 0] for ring in rings)
    if far:
        assert off <= tolerance * force.max()
    else:
        assert imbalance == pytest.approx(off / force.max(), rel=1e-6)


@pytest.mark.parametrize("lists", ["every 10 check yes", "every 1 delay 0 check no"])
def test_forces_continue(lists):
    """Few evaluations along a trajectory, also with a new neighbor list in every step."""
    scene = mixture(PACKINGS[0], DEFAULT, commands=f"neigh_modify {lists}")[0]
    scene.run("velocity all create 1e-8 4711 loop all\nfix nve all nve\ntimestep 0.001\nrun 4")
    cold = mixture(PACKINGS[0], DEFAULT)[0]
    cold.energy()
    assert of_compute_pair(cold)[0] >= 5
    evaluations = []
    for _ in range(10):
        scene.run("run 1 pre no post no")
        evaluations.append(scene.vector("pair", 4)[2])
    assert max(evaluations) <= 2


def energy_error(style, dt, time=40.0):
    """Standard deviation of the total energy along a trajectory, and the mean kinetic energy."""
    scene = mixture(PACKINGS[0], style)[0]
    scene.run(f"timestep {dt}\nvelocity all create 1e-5 4711 loop all\nfix nve all nve\nrun 0")
    scene.run("thermo_style custom step pe ke etotal\nthermo_modify norm no")
    rows = []
    for _ in range(40):
        scene.run(f"run {round(time / dt / 40)} post no")
        rows.append([scene.lmp.get_thermo(key) for key in ("etotal", "ke")])
    total, kinetic = np.array(rows).T
    return total.std(), kinetic.mean()


def test_energy_is_conserved():
    """To second order in the time step."""
    errors = [energy_error(DEFAULT, dt) for dt in (0.4, 0.2, 0.1)]
    fall = errors[0][0] / errors[2][0]
    assert 8 < fall < 32
    assert errors[2][0] < 1e-4 * errors[2][1]


def test_descent():
    """FIRE to 1e-6 of the mean contact force."""
    scene = mixture(PACKINGS[0], DEFAULT)[0]
    shape = scene.evaluate(pushed(PACKINGS[0])).shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    scene.run("min_style fire\nmin_modify dmax 0.002\ntimestep 0.5")
    scene.run(f"minimize 0 {1e-7 * force} 20000 20000")
    evaluations, imbalance = of_compute_pair(scene)
    # contacts have come to balance as the particles have come to rest
    assert evaluations <= 3
    assert imbalance <= 1e-7
    energy = scene.lmp.get_thermo("pe")
    state = scene.evaluate()
    assert energy == pytest.approx(state.energy, rel=1e-11)
    shape = state.shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    assert np.hypot(*state.force.T).max() <= 1e-6 * force
    assert state.energy > 1e-6
