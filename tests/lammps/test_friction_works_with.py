"""Friction beside other commands of LAMMPS, those that docs/works_with.md names."""

import numpy as np
import pytest
from grains import Grains
from test_friction import cloud

NVE = "fix move all nve/sphere disc"
PART = "group part id 12 13\ngroup rest subtract all part\nfix move rest nve/sphere disc"
COMMANDS = {
    "fix nvt/sphere": ("fix move all nvt/sphere temp 0.002 0.002 10 disc", ""),
    "fix nph/sphere": ("fix move all nph/sphere iso 0.001 0.001 20 disc", ""),
    "fix rigid": (PART, "fix body part rigid single torque * off off on force * on on off\n"),
    "fix move": (PART, "fix turn part move rotate 0 0 0 0 0 1 50\n"),
    "fix momentum": (NVE, "fix still all momentum 5 linear 1 1 0 angular\n"),
    "fix adapt": (NVE, "variable d equal 1.8+0.001*step\nfix d all adapt 1 atom diameter v_d\n"),
    "fix langevin": (NVE, "fix bath all langevin 0.001 0.001 5 4711 omega yes\n"),
    "fix viscous/sphere": (NVE, "fix drag all viscous/sphere 0.1\n"),
    "fix freeze": (NVE, "group rest id 1 2 3\nfix rest rest freeze\n"),
    "fix gravity": (NVE, "fix down all gravity 0.001 vector 0 -1 0\n"),
    "fix deform": (NVE, "fix shear all deform 1 xy erate 0.01 remap v flip yes\n"),
    "fix deform/pressure": (NVE, "fix p all deform/pressure 1 y pressure 0.001 0.1 remap v\n"),
    "fix balance": (NVE, "comm_style tiled\nfix even all balance 10 1.0 rcb\n"),
    "delete_atoms": (NVE, "group gone id 5 9\nrun 20\ndelete_atoms group gone\n"),
    "reset_atoms id": (
        NVE,
        "group gone id 5 9\nrun 20\ndelete_atoms group gone compress no\nreset_atoms id\n",
    ),
    "minimize": (NVE, "run 20\nminimize 0 1e-9 3 10\n"),
    "displace_atoms": (NVE, "run 20\ndisplace_atoms all move 3 1 0\n"),
    "change_box": (NVE, "run 20\nchange_box all x scale 0.99 y scale 1.01 remap\n"),
    "set": (NVE, "run 20\nset atom 3 omega 0 0 1\n"),
    "velocity": (NVE, "run 20\nvelocity all scale 0.01\n"),
    "balance": (NVE, "run 20\nbalance 1.0 shift x 5 1.0\n"),
    "reset_timestep": (NVE, "run 20\nreset_timestep 0\n"),
    "neigh_modify exclude": (NVE, "group a id 1:8\nneigh_modify exclude group a a\n"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_beside(name, tmp_path):
    """It runs, contacts rub and keep their bound, and spins begin to turn."""
    move, commands = COMMANDS[name]
    x, radii, v, _ = cloud()
    box = {"box": (-6.5, 6.5, -6.5, 6.5)}
    if name == "fix deform":
        box["tilt"] = 0.0
    scene = Grains(x, radii, "0.5 0.6 0.1 damp 0.1", tmp_path, v, move=move, dt=0.04, **box)
    scene.run(f"{commands}fix plane all enforce2d\nrun 150")
    terms, rows = scene.terms, scene.rows
    assert terms["contacts"] == len(rows) > 0
    assert (np.abs(rows[:, 6]) <= 0.5 * rows[:, 5] * (1 + 1e-12)).all()
    assert terms["sliding"] > 1e-5
    assert np.abs(scene.spin).max() > 1e-3
    assert np.isfinite(scene.v).all()


def test_particles_that_come_and_go(tmp_path):
    x, radii, v, _ = cloud()
    scene = Grains(x, radii, "0.5 0.6 0.1 damp 0.1", tmp_path, v, dt=0.04)
    scene.run(
        "region rain block -5 5 5 5.5 0 0\nregion all block INF INF INF INF INF INF\n"
        "fix rain all deposit 9 1 10 4711 region rain near 0.9 attempt 99 vy -0.1 -0.1\n"
        "fix gone all evaporate 15 1 all 4711\nfix flat all enforce2d\nrun 200"
    )
    assert scene.lmp.extract_fix("gone", 0, 0) == 13
    assert scene.terms["contacts"] == len(scene.rows) > 0
    assert np.isfinite(scene.lmp.get_thermo("econserve"))


def test_frozen_particles_rest(tmp_path):
    """Friction acts before fix freeze, as contacts do."""
    x, radii, v, _ = cloud()
    rest = np.where(np.arange(len(x)) < 3, 0, 1)[:, None] * v
    words = COMMANDS["fix freeze"][1]
    scene = Grains(x, radii, "0.5 0.6 0.1", tmp_path, rest, commands=words, dt=0.04)
    scene.run("run 100")
    assert np.abs(scene.v[:3]).max() == np.abs(scene.spin[:3]).max() == 0


def test_beside_another_pair_style(tmp_path):
    """The forces of the other style add up; energy and its losses balance."""
    x, radii, v, spin = cloud()
    scene = Grains(x, radii, "0.5 0.6 0.1 damp 0.1", tmp_path, v, spin, dt=0.01)
    scene.run(
        "pair_style hybrid/overlay deformable/ring radius atom lj/cut 1.0\n"
        f"pair_coeff * * deformable/ring {tmp_path / 'species'} drop\n"
        "pair_coeff * * lj/cut 0.001 0.8\nrun 0 post no"
    )
    before = scene.balance()
    scene.run("run 400")
    assert scene.terms["sliding"] > 1e-4
    assert scene.balance() == pytest.approx(before, rel=1e-4)


def test_no_contacts_before_the_first_run(tmp_path):
    """Minimizers pass over friction: a file of its contacts is empty."""
    scene = Grains([[-0.98, 0], [0.98, 0]], 1, "0.5 0.6 0", tmp_path)
    scene.run(f"dump rows all local 1 {tmp_path}/rows f_rub[1] f_rub[6]\nminimize 0 1e-9 1 9")
    assert len(scene.rows) == 0
    assert (tmp_path / "rows").read_text().count("ENTRIES\n0\n") == 2


def test_films_that_are_pulled(tmp_path):
    """They do not rub, and damp while their sides approach; energy balances."""
    errors = []
    for dt in (0.02, 0.01):
        scene = Grains(
            [[-0.98, 0], [0.98, 0]], 1, "0.5 0.5 0.1 damp 0.02", tmp_path,
            [[-0.02, -0.1], [0.02, 0.1]], 0.1, law="curved", dt=dt,
        )  # fmt: skip
        with (tmp_path / "species").open("a") as species:
            species.write("adhesion drop drop 0.3\n")
        scene.run(f"pair_coeff * * {tmp_path}/species drop\nrun 0 post no")
        before, found, rows = scene.balance(), [], []
        for _ in range(50):
            scene.run(f"run {round(0.2 / dt)} post no")
            found.append(scene.balance() - before)
            rows.extend(scene.rows[:, 5:])
        errors.append(np.abs(found).max())
        force, friction, damping, _, slides = np.transpose(rows)
        pulled = force < 0
        assert 10 < pulled.sum() < 40
        assert (friction[pulled] == 0).all()
        assert (slides[pulled] == 1).all()
        assert (damping[pulled] <= 0).all()
        assert (damping[pulled] < 0).any()
        assert (np.abs(friction) <= 0.5 * np.maximum(force, 0)).all()
        assert np.abs(friction).max() > 0.01
    assert scene.terms["damping"] > 0.01
    assert errors[0] / errors[1] == pytest.approx(4, abs=0.5)


def test_rerun(tmp_path):
    """Files have neither springs nor spins: each snapshot has what its velocities say."""
    x, radii, v, _ = cloud()
    made = Grains(x, radii, "0.5 0.6 0.1 damp 0.1", tmp_path, v, dt=0.04)
    made.run(f"dump all all custom 100 {tmp_path}/states id x y vx vy\nrun 400")
    made.lmp.close()
    scene = Grains(x, radii, "0.5 0.6 0.1 damp 0.1", tmp_path, v, dt=0.04)
    for step in (200, 300, 400):
        scene.run(f"rerun {tmp_path}/states first 200 last {step} dump x y vx vy")
        i, j, _, _, angle, force, friction, damping, xi, _ = scene.rows.T
        assert len(i) > 2
        way = scene.v[j.astype(int) - 1] - scene.v[i.astype(int) - 1]
        n = np.column_stack([np.cos(angle), np.sin(angle)])
        t = np.column_stack([-n[:, 1], n[:, 0]])
        along, across = 0.1 * np.sum(way * t, axis=1), 0.1 * np.sum(way * n, axis=1)
        np.testing.assert_array_equal(xi, 0)
        np.testing.assert_allclose(friction, np.clip(along, -0.5 * force, 0.5 * force), atol=1e-8)
        np.testing.assert_allclose(damping, np.minimum(across, force), atol=1e-8)
