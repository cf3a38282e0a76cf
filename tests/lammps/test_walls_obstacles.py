"""Particles outside of convex obstacles: pillars that are hit, and what is equal to what."""

import numpy as np
import pytest
from laws import EXACT, LAWS, two_laws
from obstacles import PILLARS, WALL, energies, scene_of
from scene import Scene
from turns import in_turn

HEIGHTS = np.linspace(-1.9, 1.9, 12)


@pytest.mark.parametrize(("pillar", "law"), in_turn(PILLARS, ["radical", "balanced"]))
def test_pillar_that_is_hit(law, pillar):
    """A particle sent against faces and corners comes back with the energy that it had."""
    pillar, turned = PILLARS[pillar], 0
    for y in HEIGHTS:
        scene = scene_of([[-2.8, y]], ["unit"], law, f"{pillar}\n{WALL}")
        scene.run("velocity all set 0.1 0.02 0\nfix move all nve\ntimestep 0.02\nrun 0")
        found = np.array(energies(scene, 8, 250))
        assert np.abs(found / found[0] - 1).max() < 1e-4
        turned += scene.gather("v", 3)[0, 0] < 0.09
    assert turned >= 6


def same(first, second, law, x, species=("unit", "small")):
    one, other = (scene_of(x, species, law, walls).evaluate() for walls in (first, second))
    assert one.energy > 1e-6
    assert one.energy == pytest.approx(other.energy, rel=1e-12)
    np.testing.assert_allclose(one.force, other.force, rtol=1e-11, atol=1e-15)
    np.testing.assert_allclose(one.virial, other.virial, rtol=1e-11, atol=1e-15)


X = np.array([[-1.71, 1.53], [-1.30, 0.13]])  # at a corner, at a face, and at each other
SQUARE = f"{PILLARS['square']}\n{WALL}"
WRITTEN = {
    "four planes": """
        region a plane -1 0 0 -1 0 0
        region b plane 1 0 0 1 0 0
        region c plane 0 1 0 0 1 0
        region d plane 0 -1 0 0 -1 0
        region pillar union 4 a b c d
        fix pillar all deformable/wall pillar""",
    "planes from inside": """
        region a plane -1 0 0 1 0 0
        region b plane 1 0 0 -1 0 0
        region c plane 0 1 0 0 1 0 side out
        region d plane 0 -1 0 0 1 0
        region pillar intersect 4 a b c d side out
        fix pillar all deformable/wall pillar""",
    "two strips": """
        region a block -1 1 INF INF INF INF
        region b block INF INF -1 1 INF INF side out
        region c union 2 a b side out
        region d block INF INF -1 1 INF INF
        region e intersect 2 a d
        region pillar intersect 2 e a side out
        fix pillar all deformable/wall pillar""",
    "prism": """
        region pillar prism -1 1 -1 1 -0.5 0.5 0 0 0 side out
        fix pillar all deformable/wall pillar""",
    "lattice units": """
        lattice sq 4.0 origin 0 0 0
        region pillar block -2 2 -2 2 INF INF side out
        fix pillar all deformable/wall pillar""",
    "words": "fix pillar all deformable/wall polygon 4 -1 -1 -1 1 1 1 1 -1",
    "rotated by a right angle": """
        variable angle equal PI/2
        variable shift equal -2.0
        variable none equal 1.0
        region moved block 1 3 0 2 INF INF side out &
          move v_shift v_none NULL rotate v_angle 1 0 0 0 0 -1
        fix pillar all deformable/wall moved""",
}


@pytest.mark.parametrize("walls", WRITTEN.values(), ids=WRITTEN)
def test_ways_to_write_a_square(walls):
    same(SQUARE, walls, "radical", X)


def test_prisms_without_end():
    for prism, block in (
        ("INF INF 0 1 INF INF 0 0 0 side out", "INF INF 0 1 INF INF side out"),
        ("0 INF 0 1 INF INF 0 0 0 side out", "0 INF 0 1 INF INF side out"),
        ("-1.5 INF -3 1.95 -1 1 0 0 0", "-1.5 INF -3 1.95 INF INF"),
    ):
        walls = [f"region pillar {r}\n{WALL}" for r in (f"prism {prism}", f"block {block}")]
        same(*walls, "radical", np.array([[-0.6, 1.4]]), ["unit"])


def test_segment_and_disk_in_words():
    law = "radical"
    segment = f"{PILLARS['segment']}\n{WALL}"
    x = np.array([[-0.75, 0.2], [0.3, 1.25]])
    same(segment, "fix w all deformable/wall segment 0 -1 0 1", law, x)
    same(segment, "fix w all deformable/wall segment 0 1 0 -1", law, x)
    disk = f"{PILLARS['disk']}\n{WALL}"
    x = np.array([[-1.5, 0.2], [-0.3, 1.2]])
    same(disk, "fix w all deformable/wall disk 0 0 0.8", law, x)
    same(disk, "region p sphere 0 0 0 0.8 side out\nfix w all deformable/wall p", law, x)


def test_round_container_in_words():
    law = "radical"
    region = "region drum cylinder z 0.1 -0.2 2.3 INF INF\nfix w all deformable/wall drum"
    x = np.array([[-1.3, 0.2], [0.4, 1.6]])
    same(region, "fix w all deformable/wall circle 0.1 -0.2 2.3", law, x)
    post = "region post sphere 0.3 -1.1 0 0.3 side out\nregion both intersect 2 drum post"
    words = "fix w all deformable/wall circle 0.1 -0.2 2.3 disk 0.3 -1.1 0.3"
    region = f"region drum cylinder z 0.1 -0.2 2.3 INF INF\n{post}\nfix w all deformable/wall both"
    same(region, words, law, np.array([[-0.8, -0.6], [0.4, 1.6]]))


@two_laws
def test_scene_as_one_region_or_as_several_fixes(law):
    parts = """
        region room block -2.6 9 -8 8 INF INF
        region pillar block -1 1 -1 1 INF INF side out
        region post cylinder z -0.9 2.6 0.5 INF INF side out
        """
    x = np.array([[-1.7, 1.3], [-1.4, 0.0]])
    several = "\n".join(f"fix {r} all deformable/wall {r}" for r in ("room", "pillar", "post"))
    one = "region all intersect 3 room pillar post\nfix all all deformable/wall all"
    same(parts + several, parts + one, EXACT[law], x)
    words = """
        fix all all deformable/wall polygon 4 -1 -1 1 -1 1 1 -1 1 &
          disk -0.9 2.6 0.5 plane -2.6 0 1 0"""
    same(parts + several, words, EXACT[law], x)
    scene = scene_of(x, ["unit", "small"], EXACT[law], parts + several)
    force = scene.evaluate().force.sum(0)
    walls = sum(scene.force_on_wall(w) for w in ("room", "pillar", "post"))
    np.testing.assert_allclose(walls, -force, rtol=1e-11, atol=1e-15)


@two_laws
def test_one_contact_at_a_corner(law):
    """S = a^2 2 pi/3 with a = R - distance, along the line from the corner."""
    a = 0.13
    x = np.array([[-1, 1]]) + (1 - a) * np.array([[-0.6, 0.8]])
    scene = scene_of(x, ["unit"], law, SQUARE)
    state = scene.evaluate()
    deficit, slope = a**2 * 2 * np.pi / 3, a * 4 * np.pi / 3
    assert state.energy == pytest.approx(0.5 * deficit**2, rel=1e-12)
    expected = deficit * slope * np.array([-0.6, 0.8])
    np.testing.assert_allclose(state.force, [expected], rtol=1e-12)
    np.testing.assert_allclose(scene.force_on_wall("pillar"), -expected, rtol=1e-12)


@two_laws
def test_obstacles_repeat_across_periodic_boundaries(law):
    """Also in a box that leans, and for a center that has not been wrapped yet."""
    for tilt in (None, 1.5):
        options = {"boundary": "p p p", "tilt": tilt}
        walls = "fix pillar all deformable/wall polygon 4 -1 -1 1 -1 1 1 -1 1"

        def energy(x, walls=walls, options=options):
            box = (-9, 9, -9, 9)
            return Scene([x], ["unit"], box, LAWS[law], commands=walls, **options)

        near = energy((1.7, 0.3)).energy()
        assert near > 1e-4
        shifted = walls.replace("-1 -1 1 -1 1 1 -1 1", "7.5 -1 9.5 -1 9.5 1 7.5 1")
        assert energy((-7.8, 0.3), shifted).energy() == pytest.approx(near, rel=1e-11)
        up = walls.replace("-1 -1 1 -1 1 1 -1 1", "-1 8 1 8 1 10 -1 10")
        lean = tilt or 0.0
        assert energy((1.7 - lean, -8.7), up).energy() == pytest.approx(near, rel=1e-11)


def test_particle_that_crosses_a_periodic_boundary_beside_a_pillar():
    walls = "fix pillar all deformable/wall polygon 4 7.5 -1 8.9 -1 8.9 1 7.5 1"
    scene = Scene([[-7.2, 0.9]], ["unit"], (-9, 9, -9, 9), LAWS["radical"], commands=walls)
    scene.run("velocity all set -0.12 0.01 0\nfix move all nve\ntimestep 0.02\nrun 0")
    found = np.array(energies(scene, 10, 200))
    assert np.abs(found / found[0] - 1).max() < 1e-4
    assert scene.gather("v", 3)[0, 0] > 0.1


def test_bulge_by_a_wall_that_cuts_a_particle():
    """The message names the wall, not the reach alone."""
    x = np.array([[-1.06, 0.3], [5.0, 5.0]])
    with pytest.raises(
        Exception, match=r"atom 1 .*wall of fix pillar cuts it 0.06 from its center"
    ) as e:
        scene_of(x, ["unit", "unit"], "radical", SQUARE).energy()
    assert "\n" not in str(e.value).split("Last input line")[0].strip()


def test_an_obstacle_at_the_bottom_repeats_at_the_top_of_a_box_that_leans():
    def energy(x, walls):
        options = {"boundary": "p p p", "tilt": 1.5, "commands": walls}
        return Scene([x], ["unit"], (-9, 9, -9, 9), LAWS["radical"], **options).energy()

    square = "fix pillar all deformable/wall polygon 4 -1 {0} 1 {0} 1 {1} -1 {1}"
    near = energy((1.7, -0.3), square.format(-1, 1))
    assert near > 1e-4
    assert energy((1.7 + 1.5, 8.7), square.format(-10, -8)) == pytest.approx(near, rel=1e-11)
