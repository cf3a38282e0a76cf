"""Walls in three dimensions that are not known, or in the way, are refused by one clear line."""

import numpy as np
import pytest
from droplet_walls import ORIGIN, region, walled
from turns import in_turn

WALL = r"\AERROR: Fix walls deformable/wall: "

REGIONS = {
    "curved": (region("walls ellipsoid 0 0 0 3 2 3"), "'walls' of style ellipsoid is not known"),
    "open": (region("walls block -2 2 -2 2 -2 2 open 6"), "'walls' has open faces.*INF"),
    "tip": (region("walls cone z 0 0 2 0 -3 3 side out"), "'walls' is a cone .*with a tip"),
    "everywhere": (region("walls block INF INF INF INF INF INF"), "'walls' has no surface"),
    "union": (
        "region a block -2 2 -2 2 -2 0\nregion b block -2 0 -2 2 -2 2\nregion walls union 2 a b\n"
        "fix walls all deformable/wall walls\n",
        "'walls' is neither a container nor .*'a'.*intersect",
    ),
    "half a ball": (
        "region a sphere 2 0 0 1\nregion b plane 2 0 0 1 0 0\n"
        "region walls intersect 2 a b side out\nfix walls all deformable/wall walls\n",
        "'walls' is neither .*'a'",
    ),
    "all of space": (
        "region a plane 0 0 0 0 1 0\nregion b plane 0 1 0 0 -1 0\nregion walls union 2 a b\n"
        "fix walls all deformable/wall walls\n",
        "'walls' has no surface: its parts cover all of space",
    ),
    "gone in a run": (
        "variable up equal 3+0.5*step\nregion a plane 0 0 2 0 0 1 move NULL NULL v_up\n"
        "region b plane 0 0 4 0 0 -1\nregion walls union 2 a b\n"
        "fix walls all deformable/wall walls\n",
        "obstacle 'walls' has no surface|'walls' has no surface",
    ),
}


@pytest.mark.parametrize(("walls", "message"), REGIONS.values(), ids=REGIONS)
def test_regions(walls, message, tmp_path):
    with pytest.raises(Exception, match=f"{WALL}.*(?:{message})") as error:
        walled(ORIGIN, walls, tmp_path).run("run 10")
    assert len(str(error.value).split("Last input line")[0].strip().splitlines()) == 1


WORDS = {
    "zlo": "needs a region ID only|Region 'zlo'",
    "xlo -2 zlo": "zlo needs its place: a number, EDGE or v_name",
    "zlo v_none": "zlo: variable 'none' does not exist",
    "zlo v_style": "zlo: variable 'style' must be equal-style",
    "zlo v_far": "zlo: its value 'v_far' is inf",
    "disk 0 0 1": "'disk' is no wall in 3 dimensions: it must be 'plane', 'sphere'",
    "plane 0 0 -2 0 0": "plane needs 6 numbers, but 5 follow",
    "cylinder 0 0 0 0 0 0 3": "cylinder 1 has a direction of zero length",
    "zlo -2 post 0 0 0 0 0 1 -1": "post 2 has a radius of -1",
    "cone 0 0 0 0 0 1 2 0": "cone 1 has a slope of 0: use 'cylinder'",
    "zlo -2 square 1 1": "unknown word 'square': it must be 'plane'",
    "zlo -2 adhesion -0.1": "adhesion must be 0 or positive and finite, not -0.1",
    "zlo -2 adhesion 0 zhi 2": "unknown word 'zhi' after adhesion",
}


def test_words(tmp_path):
    variables = "variable style string hello\nvariable far equal exp(1000)\n"
    for words, message in WORDS.items():
        with pytest.raises(Exception, match=message):
            walled(ORIGIN, f"{variables}fix walls all deformable/wall {words}\n", tmp_path)


@pytest.mark.parametrize(
    ("walls", "message"),
    [
        ("zlo 1", r"at \(0, 0, 0.5\) is outside of 'zlo'"),
        ("zlo 0.46", r"at \(0, 0, 0.5\) is only 0.04 from 'zlo'"),
        ("ball 0 0 1 0.7", r"is in the obstacle 'ball 1'"),
        (region("post block -1 1 -1 1 -1 1 side out"), "is in the obstacle region 'post'"),
        (
            region("room block -3 3 -3 3 -3 3", "post cylinder y 0 0 0.6 -1 1 side out"),
            "is in the obstacle part 'post' of region 'scene'",
        ),
        (region("room cone z 2 0 1 1.5 -3 3"), "is outside of region 'room'"),
    ],
)
def test_center_on_the_wrong_side(walls, message, tmp_path):
    with pytest.raises(Exception, match=f"The center of atom 1 .*{message} of fix walls"):
        walled(np.array([[0, 0, 0.5]]), walls, tmp_path)


def test_other_commands(tmp_path):
    scene = walled(ORIGIN, "zlo -0.97", tmp_path)
    with pytest.raises(Exception, match="no energy for 'fix_modify walls energy yes'"):
        scene.run("fix_modify walls energy yes\nrun 0")
    scene.run("fix_modify walls energy no\nrun_style respa 2 2 pair 2\n")
    with pytest.raises(Exception, match="cannot be used with run_style respa"):
        scene.run("run 0")
    scene = walled(ORIGIN, "zlo -5", tmp_path)
    assert "'zlo' lies outside of the simulation box in z (-4 to 4)" in scene.log.read_text()
    tilted = "change_box all triclinic\nfix walls all deformable/wall xlo EDGE\n"
    with pytest.raises(Exception, match=r"xlo EDGE: a side of a tilted box.*'plane'"):
        walled(ORIGIN, tilted, tmp_path)


NARROW = {
    "cylinder 0 0 0 0 0 1 0.99": ("cylinder 1", "0.99"),
    "sphere 0 0 0 0.5": ("sphere 1", "0.5"),
    "cone 0 0 0 0 0 1 1.02 0.75": ("cone 1", "0.816"),  # 1.02 cos of its slope
    "region": ("region 'tube'", "0.7"),
}


@pytest.mark.parametrize(("words", "beside"), in_turn(NARROW, [0.0, 0.05]))
def test_containers_narrower_than_a_droplet(words, beside, tmp_path):
    """On the axis, where it would have no energy, and beside it; one that is as wide holds it."""
    wall, room = NARROW[words]
    walls = region("tube cylinder z 0 0 0.7 -3 3") if words == "region" else words
    message = f"Atom 1 of radius 1 is wider than '?{wall}'? of fix walls .*radius is {room} there"
    with pytest.raises(Exception, match=message):
        walled(np.array([[0, beside, 0]]), walls, tmp_path)
    if words.startswith("cyl"):
        assert walled(ORIGIN, words.replace("0.99", "1"), tmp_path).energy == 0.0


def test_a_tube_that_narrows_in_a_run(tmp_path):
    """At the step at which it is too narrow; a droplet outside of the group does not matter."""
    walls = (
        "group big id 1\nvariable r equal 1.05-0.01*step\n"
        "region tube cylinder z 0 0 v_r -3 3\nfix walls big deformable/wall tube\n"
    )
    scene = walled(np.array([[0, 0, 0], [0, 0, 2.2]]), walls, tmp_path)
    with pytest.raises(
        Exception, match=r"Atom 1 of radius 1 is wider than region 'tube' .* is 0\.99"
    ):
        scene.run("fix still all move linear 0 0 0\nrun 20")
    assert scene.lmp.get_thermo("step") == 6
