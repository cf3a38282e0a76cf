"""Regions that are no walls are refused by name and with advice, before the first step."""

import re

import numpy as np
import pytest
from laws import LAWS, RADICAL
from obstacles import ROOM, scene_of
from scene import BOX, Scene

FIX = "\nfix walls all deformable/wall walls"


def refuses(message):
    return pytest.raises(Exception, match=rf"\AERROR: Fix walls deformable/wall: .*(?:{message})")


def far_away(walls):
    """A particle that touches no wall, so that nothing but the region itself is wrong."""
    return scene_of([[7.9, 7.9]], ["small"], "radical", walls)


L_SHAPE = "region a block -9 9 -9 0 -1 1\nregion b block 0 9 -9 9 -1 1\nregion walls union 2 a b"
NO_REGIONS = {
    "curved": (
        "region walls ellipsoid 0 0 0 1.2 0.9 3 side out",
        "'walls' of style ellipsoid.*curved",
    ),
    "cylinder along x": ("region walls cylinder x 0 0 1 -3 3 side out", "'walls'.*axis.*along z"),
    "cylinder above": ("region walls cylinder z 0 0 1 1 3 side out", "'walls'.*cross.* z = 0"),
    "sphere above": ("region walls sphere 0 0 0.1 1 side out", "'walls'.*center is not at z = 0"),
    "block above": ("region walls block -1 1 -1 1 0.2 1 side out", "'walls'.*cross.* z = 0"),
    "block everywhere": ("region walls block INF INF INF INF -1 1", "'walls'.*no surface"),
    "plane that leans": ("region walls plane 0 -2 0 0 1 0.3", "'walls'.*nz = 0"),
    "plane that lies": ("region walls plane 0 -2 -1 0 0 1", "'walls'.*nz = 0"),
    "prism that leans": (
        "region walls prism -1 1 -1 1 -1 1 0 0.5 0 side out",
        "'walls'.*xz = yz = 0",
    ),
    "prism above": (
        "region walls prism -1 1 -1 1 1 2 0 0 0 side out",
        "'walls'.*not cross the plane",
    ),
    "open box": ("region walls block -1 8 -1 8 -1 1 open 4", "'walls' has open faces.*segment"),
    "rotates out": (
        "variable t equal 0\nregion walls block -1 1 -1 1 -1 1 side out rotate v_t 0 0 0 1 0 0",
        "'walls' rotates.*axis must be along z",
    ),
    "L": (L_SHAPE, "'walls' is neither .*'a'.*intersect.*'side out'"),
    "L as a pillar": (
        L_SHAPE.replace("-9 0", "-9 -1")
        .replace("0 9 -9 9", "0 1 -9 1")
        .replace("walls union 2 a b", "u union 2 a b side out")
        + "\nregion c sphere 7 7 0 1\nregion v union 2 u c\nregion walls intersect 2 v v",
        "'u' is neither .*'a'",
    ),
    "half a disk": (
        "region a cylinder z 0 0 1 INF INF\nregion b plane 0 0 0 0 1 0\n"
        "region walls intersect 2 a b side out",
        "'walls' is neither .*'a'",
    ),
    "part of a scene": (
        "region room block -8 9 -8 9 INF INF\nregion horn cone z 0 0 2 1 -3 3 side out\n"
        "region walls intersect 2 room horn",
        "'horn' of style cone",
    ),
    "planes that cover all": (
        "region a plane 0 0 0 0 1 0\nregion b plane 0 1 0 0 -1 0\nregion walls union 2 a b",
        "'walls' has no surface",
    ),
}


@pytest.mark.parametrize(("region", "message"), NO_REGIONS.values(), ids=NO_REGIONS)
def test_regions(region, message):
    scene = far_away(region + FIX)
    step = scene.lmp.get_thermo("step")
    with refuses(message) as error:
        scene.run("run 10")
    assert scene.lmp.get_thermo("step") == step
    assert len(str(error.value).split("Last input line")[0].strip().splitlines()) == 1


WORDS = {
    "polygon 3 0 0 1 0": "polygon needs 6 numbers, but 4 follow",
    "polygon 2 0 0 1 0": "polygon: 2 corners",
    "polygon 4 0 0 2 0 0.5 0.5 0 2": r"polygon 1 is not convex at its corner \(0.5, 0.5\)",
    "polygon 5 1 0 -0.809 0.588 0.309 -0.951 0.309 0.951 -0.809 -0.588": "polygon 1 crosses itself",
    "disk 0 0 1 disk 1 1 0": "disk 2 has a radius of 0",
    "disk 0 0 1 circle 0 0 -1": "circle 2 has a radius of -1",
    "disk 0 0 1 square 1 1": "unknown word 'square'",
    "disk 0 0 inf": "'inf'",
    "segment 1 1 1 1": "segment 1 has no length",
    "plane 1 1 0 0": "plane 1 has a normal of zero length",
}


def test_words():
    scene = far_away("")
    for words, message in WORDS.items():
        with pytest.raises(Exception, match=message):
            scene.run(f"fix walls all deformable/wall {words}")


def test_more_fixes_than_codes():
    scene = far_away("")
    scene.run("\n".join(f"fix w{k} all deformable/wall plane 0 -{k + 2} 0 1" for k in range(256)))
    scene.run("run 0 post no")
    with pytest.raises(Exception, match=r"Fix w256 deformable/wall: there are 256 fixes .*several"):
        scene.run("fix w256 all deformable/wall plane 0 -300 0 1")


@pytest.mark.parametrize(
    ("walls", "message"),
    [
        ("region walls block -1 1 -1 1 INF INF side out", r"in the obstacle region 'walls' of fix"),
        ("region walls plane 0 3 0 0 1 0", r"outside of region 'walls' of fix"),
        (
            "region room block -8 8 -8 8 INF INF\nregion post sphere 0.3 0 0 1 side out\n"
            "region walls intersect 2 room post",
            "in the obstacle part 'post' of region 'walls' of fix",
        ),
        (
            "region room block -8 0.1 -8 8 INF INF\nregion post sphere 3 0 0 1 side out\n"
            "region walls intersect 2 room post",
            "outside of part 'room' of region 'walls' of fix",
        ),
        (
            "fix walls all deformable/wall disk -5 -5 1 polygon 3 -1 -1 1 -1 0 1",
            "in the obstacle 'polygon 2' of fix",
        ),
    ],
)
def test_center_on_the_wrong_side(walls, message):
    walls += "" if walls.startswith("fix") else FIX
    scene = scene_of([[5.0, 5.0], [0.2, 0.25]], ["small"] * 2, "sector", walls)
    if "-8 0.1" in walls:
        scene.x = np.array([[-5.0, 5.0], [0.2, 0.25]])
    with pytest.raises(Exception, match=rf"atom 2 at \(0.2, 0.25\) is {message} walls"):
        scene.energy()


@pytest.mark.parametrize("beside", [0.0, 0.1])
@pytest.mark.parametrize(
    ("law", "walls", "name"),
    [
        ("radical", "fix w all deformable/wall circle 0 0 {}", "'circle 1'"),
        ("curved", "region w cylinder z 0 0 {} INF INF\nfix w all deformable/wall w", "region 'w'"),
    ],
)
def test_containers_narrower_than_a_particle(walls, name, law, beside):
    """On the axis, where it would have no energy, and beside it; one that is as wide holds it."""
    x = [[beside, 0.0]]
    with pytest.raises(
        Exception,
        match=f"Atom 1 of radius 0.5 is wider than {name} of fix w .* whose radius is 0.45",
    ):
        Scene(x, ["small"], BOX, LAWS[law], boundary="f f p", commands=walls.format(0.45)).energy()
    held = Scene(x, ["small"], BOX, LAWS[law], boundary="f f p", commands=walls.format(0.5))
    assert (held.energy() > 1e-12) == (beside > 0.0)


def test_energy_is_of_the_pair_style():
    """fix_modify energy would count it twice. The message has the style of the command."""
    scene = far_away("region walls plane 0 -2 0 0 1 0" + FIX)
    with pytest.raises(Exception, match="Fix walls deformable/wall has no energy for 'fix_modify"):
        scene.run("fix_modify walls energy yes\nrun 0")
    scene.run("fix_modify walls energy no\nrun 0")


def test_reach_that_finds_no_more():
    with pytest.raises(Exception, match=r"reach 3\.1 must be 3 at most"):
        Scene([[0, 0]], ["small"], ROOM, "deformable/ring reach 3.1")
    assert Scene([[0, 0]], ["small"], ROOM, "deformable/ring reach 3").energy() == 0


def test_bulge_message_has_a_bound_and_a_way_out():
    """Where the bulge is hardly too large: both lengths, not "1 times as far"."""
    low, high = 0.02, 0.1
    walls = "region walls plane 0.7 0 0 -1 0 0" + FIX

    def message(reach):
        try:
            scene_of([[0, 0]], ["unit"], f"{RADICAL} reach {reach!r}", walls).energy()
        except Exception as error:
            return str(error)
        return ""

    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if message(middle) else (low, middle)
    found = message(low)
    assert "times as far" not in found
    assert "atom 1 bulges by" in found
    assert "fix walls cuts it 0.7 from its center" in found
    enough = float(found.split("use a reach of ")[1].split()[0])
    assert message(enough) == ""


BOXES = {
    "inside": ("region walls block -9 9 -9 9 -1 1", "f f p", None),
    "too wide": ("region walls block -9 10 -9 9 -1 1", "f f p", "'walls' .*in x .-9 to 9."),
    "shrink-wrapped": ("region walls block -9 10 -9 9 -1 1", "s f p", None),
    "round": ("region walls cylinder z 0 2 8 -1 1", "f f p", "'walls' .*in y .-9 to 9."),
    "round in a block": (
        "region round cylinder z 0 2 8 -1 1\nregion block block -9 9 -9 9 -1 1\n"
        "region walls intersect 2 round block",
        "f f p",
        None,
    ),
    "obstacle": ("region walls block -10 -8 -1 1 -1 1 side out", "f f p", None),
}


@pytest.mark.parametrize(("walls", "boundary", "message"), BOXES.values(), ids=BOXES)
def test_walls_outside_of_the_box(walls, boundary, message, tmp_path):
    """Particles would leave the box before they meet them."""
    log = tmp_path / "log"
    scene = Scene(
        np.array([[1.0, 2.0], [-3.0, -2.0]]),
        ["small", "small"],
        ROOM,
        RADICAL,
        boundary=boundary,
        commands=walls + FIX,
        log=log,
    )
    scene.run("run 0")
    found = [line for line in log.read_text().splitlines() if "simulation box" in line]
    assert len(found) == (message is not None)
    assert message is None or re.search(f"WARNING: Fix walls deformable/wall: {message}", found[0])
