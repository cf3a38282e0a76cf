"""Walls that move, rotate and change their size: what they take from the particles is counted."""

import numpy as np
import pytest
from laws import two_laws
from obstacles import assert_walls_do_the_work, given, scene_of
from turns import in_turn

X = [[-3.2, -3], [-1, -3], [1.2, -3], [3.1, -2.9], [-3.0, 3], [-1, 3], [1.2, 3], [3.1, 2.9]]
SPECIES = ["large", "unit"] * 4

MACHINES = {
    "a paddle that rotates": """
        variable angle equal 0.01*step*dt
        region room block -4 4 -4 4 INF INF
        region paddle block -2.5 2.5 -0.1 0.1 INF INF side out rotate v_angle 0.3 0 0 0 0 1
        region all intersect 2 room paddle
        fix wall all deformable/wall all""",
    "a blade without thickness": """
        variable angle equal -0.01*step*dt
        region room cylinder z 0 0 5 INF INF
        region blade block -2 2.5 0 0 INF INF side out rotate v_angle 0 0 0 0 0 1
        region all intersect 2 room blade
        fix wall all deformable/wall all""",
    "a gap that closes": """
        variable down equal -0.3*(1-cos(0.01*step*dt))
        region room block -4 4 -4 4 INF INF
        region press block -20 20 3.9 8 INF INF side out move NULL v_down NULL
        region post cylinder z 0 0 1 INF INF side out move v_down v_down NULL
        region all intersect 3 room press post
        fix wall all deformable/wall all""",
    "a post and a room that breathe": """
        variable radius equal 1+0.4*sin(0.02*step*dt)
        variable top equal 4-0.4*sin(0.013*step*dt)
        region room block -4 4 -4 v_top INF INF
        region post cylinder z 0 0 v_radius INF INF side out
        region all intersect 2 room post
        fix wall all deformable/wall all""",
    "a triangle of planes": """
        variable angle equal 0.01*step*dt
        variable side equal 0.1*sin(0.01*step*dt)
        region a plane 1 0 0 1 0 0 move v_side NULL NULL rotate v_angle 0.1 0 0 0 0 -1
        region b plane -0.5 0.8 0 -0.5 0.8 0 move v_side NULL NULL rotate v_angle 0.1 0 0 0 0 -1
        region c plane -0.5 -0.8 0 -0.5 -0.8 0 move v_side NULL NULL rotate v_angle 0.1 0 0 0 0 -1
        region wedge union 3 a b c
        region room block -4 4 -4 4 INF INF
        region all intersect 2 room wedge
        fix wall all deformable/wall all""",
    "a triangle that grows": """
        variable out equal 0.6*sin(0.015*step*dt)
        region a plane 1 0 0 1 0 0 move v_out NULL NULL
        region b plane -0.5 0.8 0 -0.5 0.8 0
        region c plane -0.5 -0.8 0 -0.5 -0.8 0
        region wedge union 3 a b c
        region room block -4 4 -4 4 INF INF
        region all intersect 2 room wedge
        fix wall all deformable/wall all""",
}


@pytest.mark.parametrize(("machine", "law"), in_turn(MACHINES, ["radical", "balanced"]))
def test_energy_that_walls_take(machine, law):
    """Total energy changes by the work of the walls, which is as large as the energy."""
    scene = scene_of(X, SPECIES, law, MACHINES[machine])
    assert_walls_do_the_work(scene, 1e-4)


def test_work_is_part_of_econserve():
    scene = scene_of(X, SPECIES, "radical", MACHINES["a paddle that rotates"])
    scene.run("thermo_style custom step etotal econserve\nthermo_modify norm no")
    scene.run("velocity all create 0.002 123\nfix move all nve\ntimestep 0.025\nrun 3000")
    values = [scene.lmp.get_thermo(k) for k in ("etotal", "econserve")]
    assert abs(given(scene)) > 1e-4
    assert values[1] - values[0] == pytest.approx(given(scene), rel=1e-12)


def test_minimization_does_no_work():
    scene = scene_of(X, SPECIES, "radical", MACHINES["a gap that closes"])
    scene.run("minimize 0 0 20 20")
    assert given(scene) == 0


@two_laws
def test_moved_scene_is_the_scene_there(law):
    """Rotated about a point and moved then, as LAMMPS does, against the same corners at rest."""
    corners = np.array([[-1, -0.5], [1.2, -0.5], [1.6, 0.7], [-0.6, 0.7]])
    angle, point, shift = 0.7, np.array([0.3, -0.2]), np.array([0.4, -0.1])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = (corners - point) @ turn.T + point + shift
    region = f"""
        variable angle equal {angle}
        variable dx equal {shift[0]}
        variable dy equal {shift[1]}
        region wall prism -1 1.2 -0.5 0.7 -0.5 0.5 0.4 0 0 side out move v_dx v_dy NULL &
          rotate v_angle {point[0]} {point[1]} 0 0 0 1
        fix wall all deformable/wall wall"""
    numbers = " ".join(f"{v:.17g}" for v in moved.ravel())
    at_rest = f"fix wall all deformable/wall polygon 4 {numbers}"
    for center in ([2.1, 0.6], [0.6, -1.75], [-1.1, 0.4]):
        x = np.array([center])
        one, other = (scene_of(x, ["unit"], law, w).evaluate() for w in (region, at_rest))
        assert one.energy > 1e-8
        assert one.energy == pytest.approx(other.energy, rel=1e-11)
        np.testing.assert_allclose(one.force, other.force, rtol=1e-10, atol=1e-14)


def test_particles_at_rest_are_carried():
    """A cup that moves up slowly lifts a particle: work against its weight."""
    walls = """
        variable up equal 0.5*(1-cos(0.004*step*dt))
        region cup block -1.02 1.02 0 20 INF INF move NULL v_up NULL
        fix wall all deformable/wall cup
        fix weight all gravity 1e-3 vector 0 -1 0
        fix move all nve
        fix drag all viscous 0.02
        timestep 0.05"""
    scene = scene_of([[0, 0.95]], ["unit"], "radical", walls)
    scene.run("run 5000")
    start, work = scene.x[0, 1], given(scene)
    scene.run(f"run {round(np.pi / 0.004 / 0.05) - 5000}")
    rise = scene.x[0, 1] - start
    assert rise > 0.5
    # drag takes 0.02 v^2 of it
    assert given(scene) - work == pytest.approx(-1e-3 * rise, rel=0.05)


@pytest.mark.parametrize(
    ("region", "message"),
    [
        ("sphere 0 0 0 1 side out move NULL NULL v_shift", "'wall' leaves the xy plane.*along z"),
        (
            "block -1 1 v_shift 2 -1 1 side out",
            "atom 1 .* (in the obstacle|only .* from) region 'wall'",
        ),
    ],
)
def test_motion_that_ends_in_an_error(region, message):
    walls = f"""
        variable shift equal -0.02*step
        region wall {region}
        fix wall all deformable/wall wall"""
    scene = scene_of([[0.0, -1.4]], ["unit"], "radical", walls)
    with pytest.raises(Exception, match=message):
        scene.run("run 100")
