"""All ring laws in motion: evaluations, energy, relaxations."""

import numpy as np
import pytest
from contact_rows import of_compute_pair
from laws import BALANCED, EXACT, LAWS, RING_LAWS, balanced_laws
from materials import KINDS, packing, pushed
from scene import PACKINGS
from turns import in_turn


@pytest.mark.parametrize(("law", "cold", "warm"), [("balanced", 5, 2), ("curved", 8, 3)])
def test_forces_continue(law, cold, warm):
    """Few evaluations along a trajectory, with a new neighbor list in every step."""
    lists = "neigh_modify every 1 delay 0 check no"
    scene = packing(PACKINGS[0], LAWS[law], commands=lists)
    scene.run("velocity all create 1e-8 4711 loop all\nfix nve all nve\ntimestep 0.001\nrun 4")
    new = packing(PACKINGS[0], LAWS[law])
    new.energy()
    assert of_compute_pair(new)[0] >= cold
    evaluations = []
    for _ in range(10):
        scene.run("run 1 pre no post no")
        evaluations.append(of_compute_pair(scene)[0])
    assert max(evaluations) <= warm


@balanced_laws
def test_contacts_between_neighbor_lists(law):
    """None is missed while particles come from afar and LAMMPS keeps its list.

    Lines of `curved` contacts are known less well than balanced forces; a missed contact shows a
    thousand times more.
    """
    gaps = "change_box all x scale 1.1 y scale 1.1 remap\nneighbor 1.0 bin"
    scene, fresh = (packing(PACKINGS[0], EXACT[law], commands=gaps) for _ in range(2))
    scene.run("velocity all create 5e-4 4711 loop all\nfix nve all nve\ntimestep 0.2")
    scene.run("run 0 post no")
    for _ in range(40):
        scene.run("run 2 pre no post no")
        force, expected = scene.gather("f", 3)[:, :2], fresh.evaluate(scene.x).force
        np.testing.assert_allclose(force, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize(("kind", "dt"), [("rings", 0.2), ("droplets", 0.1)])
def test_corrections_are_as_accurate_as_planned(kind, dt):
    """Chebyshev's iterations, in a motion whose steps ask for two corrections.

    The second one is to leave 0.1 of the tolerance, and so each call has three evaluations. Some
    have one more, where contacts open or close. Coefficients that are 15 % off, or wrong bounds of
    the spectrum, need more, or leave more.
    """
    tolerance, steps = 1e-8, 60
    style = f"{BALANCED} balance {tolerance} 100"
    scene = packing(PACKINGS[0], style, kind, commands="replicate 4 4 1")
    scene.run(f"velocity all create 1e-6 4711 loop geom\nfix nve all nve\ntimestep {dt}\nrun 5")
    evaluations, imbalance = np.empty((2, steps))
    for n in range(steps):
        scene.run("run 1 pre no post no")
        evaluations[n], imbalance[n] = of_compute_pair(scene)
    assert np.median(evaluations) == 3
    assert np.mean(evaluations > 3) < 0.2
    assert np.median(imbalance) <= 0.2 * tolerance


def energy_error(kind, law, dt, time=40.0):
    """Standard deviation of the total energy along a trajectory, and the mean kinetic energy."""
    scene = packing(PACKINGS[0], LAWS[law], kind)
    scene.run(f"timestep {dt}\nvelocity all create 1e-5 4711 loop all\nfix nve all nve\nrun 0")
    scene.run("thermo_style custom step pe ke etotal\nthermo_modify norm no")
    rows = []
    for _ in range(40):
        scene.run(f"run {round(time / dt / 40)} post no")
        rows.append([scene.lmp.get_thermo(key) for key in ("etotal", "ke")])
    total, kinetic = np.array(rows).T
    return total.std(), kinetic.mean()


@pytest.mark.parametrize(("law", "kind"), in_turn(RING_LAWS, KINDS))
def test_energy_is_conserved(kind, law):
    """To second order in the time step."""
    (coarse, _), (fine, kinetic) = (energy_error(kind, law, dt) for dt in (0.4, 0.1))
    assert 8 < coarse / fine < 32
    assert fine < (1e-4 if kind == "rings" and law != "radical" else 1e-3) * kinetic


@pytest.mark.parametrize(("law", "kind"), in_turn(RING_LAWS, (*KINDS[1:], KINDS[0])))
def test_descent(kind, law):
    """FIRE to 1e-6 of the mean contact force."""
    scene = packing(PACKINGS[0], LAWS[law], kind)
    shape = scene.evaluate(pushed(PACKINGS[0])).shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    scene.run(f"min_style fire\nmin_modify dmax 0.002\ntimestep {0.5 if kind == 'rings' else 0.3}")
    scene.run(f"minimize 0 {1e-7 * force} 20000 20000")
    evaluations, imbalance = of_compute_pair(scene)
    # contacts have come to balance as the particles have come to rest
    assert evaluations <= 3
    assert imbalance <= 1e-7
    energy = scene.lmp.get_thermo("pe")
    state = scene.evaluate()
    # of second order in the imbalance of forces, of first order in that of lines that turn and bend
    assert energy == pytest.approx(state.energy, rel=1e-12 + imbalance)
    shape = state.shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    assert np.hypot(*state.force.T).max() <= 1e-6 * force
    assert state.energy > 1e-6
