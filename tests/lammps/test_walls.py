"""Particles between walls: regular polygons in closed form, forces on walls, moving walls."""

import numpy as np
import pytest
from closed_forms import polygon_stiffness
from laws import EXACT, LAWS, laws, two_laws
from scene import SPECIES, Scene, box_walls, polygon_faces, polygon_walls
from turns import in_turn

ROOM = (-2, 2, -2, 2)
CENTER = np.zeros((1, 2))


def alone(law, walls, x=CENTER, species="unit"):
    """One particle between walls."""
    return Scene(x, [species], ROOM, EXACT[law], boundary="f f p", commands=walls)


@pytest.mark.parametrize(("law", "n"), in_turn(LAWS, [3, 4, 5, 6]))
def test_regular_polygon(law, n):
    """S = K a^2, contact lengths 2 K a/n, and the force kA S L on every face."""
    a, kA = 0.02, 1.0
    deficit = polygon_stiffness(n) * a**2
    length = 2 * polygon_stiffness(n) * a / n
    scene = alone(law, polygon_walls(n, 1 - a))
    state = scene.evaluate()
    # the area is a difference of pi: S = 0.01 keeps 1e-16 pi/S of it
    assert np.pi - state.shape["area"][0] == pytest.approx(deficit, rel=1e-12, abs=4e-16)
    assert state.energy == pytest.approx(0.5 * kA * deficit**2, rel=1e-12)
    assert state.shape["contact_length"][0] == pytest.approx(n * length, rel=1e-12)
    assert state.shape["pressure"][0] == pytest.approx(kA * deficit, rel=1e-12)
    # n forces that cancel, each of the rounding of 1e-16/a of itself
    force = kA * deficit * length
    assert np.abs(state.force).max() <= 1e-13 * force
    assert np.abs(scene.force_on_wall("walls")).max() <= 1e-13 * force

    # the same polygon as one wall a face
    faces = "\n".join(f"fix wall{k} all deformable/wall face{k}" for k in range(n))
    scene = alone(law, polygon_faces(n, 1 - a) + "\n" + faces)
    assert scene.evaluate().energy == pytest.approx(state.energy, rel=1e-13)
    for k in range(n):
        theta = 0.1 + 2 * np.pi * k / n
        outwards = force * np.array([np.cos(theta), np.sin(theta)])
        np.testing.assert_allclose(scene.force_on_wall(f"wall{k}"), outwards, atol=1e-12 * force)


def test_deep_hexagon():
    """The free arcs are gone beyond a = 0.0931 R: counted, and still finite."""
    assert alone("radical", polygon_walls(6, 1 - 0.092)).evaluate().beyond == 0
    assert alone("radical", polygon_walls(6, 1 - 0.094)).evaluate().beyond == 1


@laws
def test_one_contact_with_a_wall(law):
    """Ring: S = a^2/2G(0). Sector: a soft disk and its mirror image, U = k/2 (1 - h/R)^2."""
    a = 0.03
    plane = f"region walls plane {1 - a} 0 0 -1 0 0\nfix walls all deformable/wall walls"
    scene = alone(law, plane)
    deficit, slope = a**2 * 2 * np.pi / 3, a * 4 * np.pi / 3
    energy, force = (a**2 / 2, a) if law == "sector" else (deficit**2 / 2, deficit * slope)
    state = scene.evaluate()
    assert state.energy == pytest.approx(energy, rel=1e-12)
    np.testing.assert_allclose(state.force, [[-force, 0]], rtol=1e-12)
    np.testing.assert_allclose(scene.force_on_wall("walls"), [force, 0], rtol=1e-12)


@two_laws
def test_moving_wall(law):
    """A moving region acts at its present position."""
    at_rest = alone(law, box_walls(-0.97, 0.97, -0.98, 0.98), np.array([[-0.01, 0.0]])).evaluate()
    moving = """
        variable shift equal 0.01
        variable rest equal 0
        region walls block -0.97 0.97 -0.98 0.98 -0.5 0.5 move v_shift v_rest v_rest
        fix walls all deformable/wall walls"""
    shifted = alone(law, moving).evaluate()
    assert shifted.energy == pytest.approx(at_rest.energy, rel=1e-12)
    np.testing.assert_allclose(shifted.force, at_rest.force, rtol=1e-11, atol=1e-15)

    dragged = alone(law, moving.replace("0.01", "5e-4*dt*step"))
    dragged.run("fix move all nve\nfix damp all viscous 0.5\ntimestep 0.05\nrun 4000")
    # drag 0.5 at a speed of 5e-4 against the stiffness of the cell, kA S dL/dx = 0.08 or more
    np.testing.assert_allclose(dragged.x, [[0.1, 0]], rtol=0, atol=0.5 * 5e-4 / 0.08)


def test_group():
    """A wall has no effect on particles outside of its group."""
    walls = """
        group none id 99
        region walls block -0.97 0.97 -0.97 0.97 -0.5 0.5
        fix walls none deformable/wall walls"""
    assert alone("balanced", walls).evaluate().energy == 0


@two_laws
def test_beside_fix_deform(law):
    """LAMMPS does not take it for a fix deform."""
    plane = "region walls plane 0.97 0 0 -1 0 0\nfix walls all deformable/wall walls\n"
    deform = "fix grow all deform 1 y final -2.2 2.2\nrun 2 post no"
    at_rest, beside = (
        Scene(CENTER, ["unit"], ROOM, EXACT[law], boundary="f p p", commands=commands)
        for commands in (plane, plane + deform)
    )
    assert beside.lmp.get_thermo("ly") > 4
    np.testing.assert_allclose(beside.evaluate().force, at_rest.evaluate().force, rtol=1e-12)


@laws
def test_virial(law):
    """The virial is the derivative by a strain of the walls, with fix_modify virial yes."""
    x = np.array([[-0.476, 0.004], [0.474, -0.003]])

    def scene(sx, sy):
        walls = box_walls(-0.96 * sx, 0.965 * sx, -0.48 * sy, 0.475 * sy)
        return Scene(
            x * [sx, sy],
            ["small", "weak"],
            ROOM,
            EXACT[law],
            boundary="f f p",
            commands=walls + "fix_modify walls virial yes",
        )

    step = 1e-6
    virial = scene(1, 1).evaluate().virial
    for component, (ex, ey) in enumerate(step * np.eye(2)):
        strained = scene(1 + ex, 1 + ey).energy() - scene(1 - ex, 1 - ey).energy()
        # F ~ a^3 with a ~ 0.02: the difference misses 1e-12/a^2
        assert virial[component] == pytest.approx(-strained / (2 * step), rel=1e-7)
    state = scene(1, 1).evaluate()
    np.testing.assert_allclose(state.atom_virial.sum(0), virial, rtol=1e-12)


@pytest.mark.parametrize("order", ["before", "after"])
def test_other_calls_of_the_pair_style_leave_the_wall_alone(order):
    """fix numdiff moves the particles and calls the pair style many times within a step."""
    numdiff = "fix probe all numdiff 1 1e-5"
    walls = polygon_walls(5, 0.97)
    commands = f"{numdiff}\n{walls}" if order == "before" else f"{walls}\n{numdiff}"
    x = np.array([[0.01, 0.005]])
    expected = alone("radical", walls, x).evaluate().force
    np.testing.assert_array_equal(alone("radical", commands, x).evaluate().force, expected)


def test_both_laws_beside_each_other_meet_the_wall():
    """Each pair style of a hybrid makes its own calls; its particles have their own forces."""
    x = np.array([[-1.53, 0.3], [1.52, 0.3]])
    walls = box_walls(-2, 2, -2, 2)

    def forces(style, **options):
        room = (-3, 3, -3, 3)
        return Scene(x, ["small", "twin"], room, style, boundary="f f p", commands=walls, **options)

    coeff = "\n".join(
        [
            f"pair_coeff * * deformable/ring {SPECIES} small NULL",
            f"pair_coeff * * deformable/sector {SPECIES} NULL small",
            "pair_coeff 1 2 none",
        ]
    )
    both = (
        forces("hybrid deformable/ring contact radical deformable/sector", coeff=coeff)
        .evaluate()
        .force
    )
    alike = f"pair_coeff * * {SPECIES} small small"
    ring, sector = (
        forces(EXACT[law], coeff=alike).evaluate().force for law in ("radical", "sector")
    )
    assert ring[0, 0] > 0 > sector[1, 0]
    np.testing.assert_array_equal(both, [ring[0], sector[1]])
