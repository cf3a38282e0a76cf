"""Droplets and rings in motion: ranks, energy, relaxations, restarts."""

import numpy as np
import pytest
from scene import PACKINGS, SPECIES, Scene
from tense import BALANCED, RADICAL, TILTED, droplets, tense_mixture
from test_parallel import run as run_ranks
from test_restart import RUN, Continued
from test_soft_rings import pushed

KINDS = {"droplets": droplets, "mixture": lambda *args, **kw: tense_mixture(*args, **kw)[0]}
kinds = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
STYLES = {"radical": RADICAL, "balanced": BALANCED, "tilted": TILTED}
styles = pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)


@styles
def test_ranks(style, tmp_path):
    """The same on one, two and four ranks, with droplets beside rings that conserve perimeters."""
    fields = {
        "style": style,
        "name": "deformable/ring",
        "species": f"{SPECIES} drop large",
        "data": tmp_path / "data",
        "boundary": "p p p",
        "commands": "velocity all create 1e-3 4711 loop geom\nneighbor 0.05 bin",
    }
    Scene.packing(PACKINGS[0], RADICAL).run(f"write_data {fields['data']} nofix")
    grids = [(1, "1 1 1"), (2, "2 1 1"), (4, "2 2 1")]
    reference, *others = (
        run_ranks(ranks, grid, tmp_path / grid.replace(" ", ""), **fields) for ranks, grid in grids
    )
    assert reference[0][0][0] > 1e-6
    for found in others:
        for steps, (scalars, atoms) in reference.items():
            np.testing.assert_allclose(found[steps][0], scalars, rtol=1e-11)
            scale = 1e-11 * np.abs(atoms).max(axis=0)
            assert (np.abs(found[steps][1] - atoms) <= scale).all()


def energy_error(kind, style, dt, time=40.0):
    """Standard deviation of the total energy along a trajectory, and the mean kinetic energy."""
    scene = kind(PACKINGS[0], style)
    scene.run(f"timestep {dt}\nvelocity all create 1e-5 4711 loop all\nfix nve all nve\nrun 0")
    scene.run("thermo_style custom step pe ke etotal\nthermo_modify norm no")
    rows = []
    for _ in range(40):
        scene.run(f"run {round(time / dt / 40)} post no")
        rows.append([scene.lmp.get_thermo(key) for key in ("etotal", "ke")])
    total, kinetic = np.array(rows).T
    return total.std(), kinetic.mean()


@kinds
@styles
def test_energy_is_conserved(kind, style):
    """To second order in the time step."""
    errors = [energy_error(kind, style, dt) for dt in (0.4, 0.1)]
    assert 8 < errors[0][0] / errors[1][0] < 32
    assert errors[1][0] < 1e-3 * errors[1][1]


@kinds
@styles
def test_descent(kind, style):
    """FIRE to 1e-6 of the mean contact force."""
    scene = kind(PACKINGS[0], style)
    shape = scene.evaluate(pushed(PACKINGS[0])).shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    scene.run("min_style fire\nmin_modify dmax 0.002\ntimestep 0.3")
    scene.run(f"minimize 0 {1e-7 * force} 20000 20000")
    state = scene.evaluate()
    shape = state.shape
    force = (shape["pressure"] * shape["contact_length"]).sum() / shape["contacts"].sum()
    assert np.hypot(*state.force.T).max() <= 1e-6 * force


@styles
def test_restart(style, tmp_path):
    file = tmp_path / "file"
    scene = droplets(PACKINGS[0], style, commands=RUN)
    scene.run("velocity all create 1e-4 4711 loop all\nrun 20")
    scene.run(f"write_restart {file}\nrun 20")
    continued = Continued(f"read_restart {file}", style, "drop droplarge")
    continued.run("run 20")
    expected, found = scene.evaluate(), continued.evaluate()
    # forces of balanced contacts are good to 1e-8 of the largest
    assert found.energy == pytest.approx(expected.energy, rel=1e-9)
    np.testing.assert_allclose(continued.x, scene.x, rtol=0, atol=1e-9)
