"""compute deformable/contact: the forces on particles are those of their contacts."""

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts
from laws import EXACT, LAWS, direct_laws, laws, straight_laws
from materials import radii_of
from scene import BOX, FOUR, PACKINGS, ROOM_OF_FOUR, Scene


@straight_laws
def test_packing(law):
    case = PACKINGS[0]
    scene = Scene.packing(case, EXACT[law], commands=CONTACTS)
    state = scene.evaluate()
    seen = contacts(scene)
    i = seen["atom"].astype(int) - 1
    radius = radii_of(case)[i]
    # what each particle bears in all is p sum L where its contacts have lengths
    held = seen["length"] != 0
    length = np.bincount(i[held], seen["length"][held], minlength=len(case["x"]))
    force = np.bincount(i[held], seen["force"][held], minlength=len(case["x"]))
    np.testing.assert_allclose(length, state.shape["contact_length"], rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(force, state.shape["pressure"] * length, rtol=1e-12, atol=1e-20)
    # the line is where it is said to be: at R - a in the direction of the partner
    foot = np.column_stack([seen["x"], seen["y"]])
    out = np.column_stack([np.cos(seen["angle"]), np.sin(seen["angle"])])
    height = radius - seen["indentation"]
    np.testing.assert_allclose(
        foot - np.asarray(case["x"])[i], height[:, None] * out, rtol=0, atol=1e-13
    )
    # both sides of a pair stand on one line, and see each other at one distance
    pairs = {}
    for n in range(len(i)):
        key = tuple(sorted((seen["atom"][n], seen["partner"][n])))
        pairs.setdefault(key, []).append(n)
    both = [pair for pair in pairs.values() if len(pair) == 2]
    assert both
    for a, b in both:
        assert seen["distance"][a] == pytest.approx(seen["distance"][b], rel=1e-14)
        apart = seen["distance"][a] * np.cos(seen["tilt"][a])
        assert height[a] + height[b] == pytest.approx(apart, rel=1e-14)
        assert seen["tilt"][a] == pytest.approx(seen["tilt"][b], rel=1e-14)
        assert seen["tilt"][a] == 0
        if law == "balanced":
            # to the tolerance of 1e-8 of the largest force
            assert abs(seen["force"][a] - seen["force"][b]) < 1e-8 * seen["force"].max()


def check_force_vectors(scene):
    """Forces on particles, tangential parts included, are sums over rows: to rounding."""
    seen = contacts(scene)
    force = np.array(scene.lmp.gather("f", 1, 3)).reshape(-1, 3)[:, :2]
    net = np.zeros((len(force) + 1, 2))  # walls in the first row
    side = np.column_stack([seen["fx"], seen["fy"]])
    np.add.at(net, seen["atom"].astype(int), side)
    np.subtract.at(net, np.maximum(seen["partner"], 0).astype(int), side)
    rounding = 30 * np.finfo(float).eps * seen["force"].max()
    np.testing.assert_allclose(net[1:], force, rtol=0, atol=rounding)


@laws
def test_force_vectors(law):
    case = PACKINGS[1]
    check_force_vectors(Scene.packing(case, LAWS[law], commands=CONTACTS))


@direct_laws
def test_walls_have_partners_below_zero(law):
    options = {"boundary": "f f p", "commands": ROOM_OF_FOUR + CONTACTS}
    scene = Scene(FOUR, ["small"] * 4, BOX, LAWS[law], **options)
    scene.evaluate()
    seen = contacts(scene)
    walls = seen["partner"] == -1
    assert np.bincount(seen["atom"][walls].astype(int))[1:].tolist() == [2, 2, 2, 2]
    push = seen["force"] * np.array([np.cos(seen["angle"]), np.sin(seen["angle"])])
    found = scene.force_on_wall("walls")
    np.testing.assert_allclose(push[:, walls].sum(axis=1), found, rtol=1e-12)
    check_force_vectors(scene)
    on_walls = [-seen[name][walls].sum() for name in ("fx", "fy")]
    np.testing.assert_allclose(on_walls, found, rtol=1e-12)


def test_one_contact_of_the_sector_law():
    """A soft disk: U = k/2 (1 - d/(R_i + R_j))^2, force k (1 - d/2R)/2R, no length."""
    a, d = 0.5, 0.96
    scene = Scene([[0, 0], [d, 0]], ["small"] * 2, BOX, LAWS["sector"], commands=CONTACTS)
    force = np.hypot(*scene.evaluate().force[0])
    seen = contacts(scene)
    assert seen["length"].tolist() == [0, 0]
    assert seen["atom"].tolist() == [1, 2]
    assert seen["partner"].tolist() == [2, 1]
    assert seen["force"] == pytest.approx(force, rel=1e-12)
    assert seen["indentation"] == pytest.approx(a - d / 2, rel=1e-12)


def test_refusals():
    scene = Scene([[0, 0], [0.96, 0]], ["small"] * 2, BOX, LAWS["radical"])
    with pytest.raises(Exception, match="Unknown compute deformable/contact argument 'x'"):
        scene.run("compute c all deformable/contact x")
    scene.run("compute c all deformable/contact\npair_style zero 2.0\npair_coeff * *\nunfix shape")
    scene.run("uncompute pair\nthermo_style custom step pe")
    with pytest.raises(Exception, match=r"needs pair_style deformable/ring, .* pair_style is zero"):
        scene.run("run 0")


def test_rows_of_a_group():
    """Those of its particles, also with partners outside of it."""
    scene = Scene.packing(PACKINGS[0], LAWS["radical"], commands=CONTACTS)
    scene.lmp.commands_string("group some id 1 3\ncompute few some deformable/contact")
    scene.evaluate()
    atoms, few = (
        np.array(scene.lmp.numpy.extract_compute(name, 2, 2))[:, 0] for name in ("contacts", "few")
    )
    assert set(few) == {1.0, 3.0}
    assert len(few) == np.isin(atoms, (1, 3)).sum()
