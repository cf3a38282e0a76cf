"""A restitution that is given: collisions head on, of any law, velocity and masses."""

import numpy as np
import pytest
from grains import Grains
from laws import balanced_laws
from test_friction_space import Balls
from test_refusals import refuses

SPEEDS = 1e-3, 1e-2, 5e-2
RADII, MASSES = (1.0, 0.7), (1.0, 3.0)
STILL = [[-0.86, 0.0], [0.86, 0.0]]  # with a gap of 0.02


def collide(scene, e, speed, dt):
    """Velocity apart over that of the approach, of unlike masses that meet in the middle."""
    scene.run("set atom 2 mass 3")
    start = np.zeros_like(scene.v)
    start[:, 0] = speed * np.array([0.75, -0.25])
    scene.v = start
    steps = int(0.1 / (speed * e * dt)) + int(30 / dt)
    scene.run(f"timestep {dt}\nrun {steps}")
    v = scene.v
    assert np.array(MASSES) @ v == pytest.approx(np.zeros(v.shape[1]), abs=1e-12)
    return (v[1, 0] - v[0, 0]) / speed


@balanced_laws
@pytest.mark.parametrize(
    ("kind", "e"), [("drop", 0.8), ("drop", 0.3), ("ring", 0.5), ("ring", 0.1)]
)
def test_rings(law, kind, e, tmp_path):
    for speed in SPEEDS:
        scene = Grains(
            STILL, RADII, f"0 1 0 restitution {e}", tmp_path, law=law, kind=kind,
            boundary="f f p", box=(-9, 9, -9, 9),
        )  # fmt: skip
        dt = 0.004 if kind == "drop" else 0.002 / np.sqrt(speed)
        assert collide(scene, e, speed, dt) == pytest.approx(e, rel=1e-2), speed


@pytest.mark.parametrize("e", [0.9, 0.3])
def test_droplets_in_space(e, tmp_path):
    still = np.column_stack([STILL, [0.0, 0.0]])
    for speed in (1e-2, 1e-1, 0.4):
        scene = Balls(still, np.array(RADII), f"0 1 0 restitution {e}", tmp_path)
        assert collide(scene, e, speed, 0.01) == pytest.approx(e, rel=1e-2), speed


def test_by_types_at_walls_and_as_a_variable(tmp_path):
    floor = "fix floor all deformable/wall plane 0 -3 0 1\n"
    for words in (
        "0 1 0 restitution 0.9 types * wall 0 1 0 0 restitution 0.4",
        "0 1 0 restitution v_e",
    ):
        scene = Grains(
            [[0, -1.98]], 1, words, tmp_path, commands=f"variable e equal 0.4\n{floor}",
        )  # fmt: skip
        scene.v = [[0, -1e-2]]
        scene.run("run 1000")
        assert scene.v[0, 1] == pytest.approx(0.4e-2, rel=5e-3)


def test_energy_is_whole(tmp_path):
    scene = Grains(STILL, RADII, "0 1 0 restitution 0.3", tmp_path)
    scene.v = [[0.01, 0], [-0.01, 0]]
    scene.run("run 1000")
    kinetic = 0.5 * np.sum(scene.v**2)
    assert scene.terms["damping"] == pytest.approx(1e-4 - kinetic, rel=1e-3)


def test_what_is_refused(tmp_path):
    scene = Grains(STILL, 1, "0 1 0", tmp_path)
    for words, message in {
        "0 restitution 0": "Fix rub .*: restitution must be above 0 and 1 at most, not 0",
        "0 restitution 1.1": "restitution must be .*, not 1.1",
        "0 damp 1 restitution 0.5": "damp must be 0 beside a restitution, not 1",
        "0 restitution": "Illegal fix deformable/friction restitution",
    }.items():
        with refuses(message):
            scene.run(f"unfix rub\nfix rub all deformable/friction 0 1 {words}")
        scene.run("fix rub all deformable/friction 0 1 0")
    with refuses("the time step 1 is too long for the restitution of contacts .*: use .* or less"):
        pressed = Grains([[-0.8, 0], [0.8, 0]], 1, "0 1 0 restitution 0.1", tmp_path)
        pressed.run("timestep 1\nrun 0")


def test_two_forces_of_a_contact_are_refused(tmp_path):
    with refuses("a restitution needs contacts with one force, but those of 'contact radical'"):
        Grains(STILL, 1, "0 1 0 restitution 0.5", tmp_path, law="radical").run("run 0")
