"""Forces are the gradient of an energy that does not jump where faces end."""

import numpy as np
import pytest
from laws import LAWS, laws, two_laws
from obstacles import scene_of
from turns import in_turn

STYLES = {law: LAWS[law] if law == "sector" else f"{LAWS[law]} reach 0.5" for law in LAWS}

# A particle of radius 1 between pillar, post and the wall of the room; a smaller one beside it.
WALLS = """
    region pillar block -1 1 -1 1 INF INF side out
    region post cylinder z 0.9 2.6 0.5 INF INF side out
    region room block -8 2.6 -8 8 INF INF
    region all intersect 3 room pillar post
    fix walls all deformable/wall all
    fix_modify walls virial yes"""
NEIGHBOR = [1.75, -0.3]


def scene(law, walls=WALLS):
    return scene_of([[1.78, 1.1], NEIGHBOR], ["unit", "small"], STYLES[law], walls)


def forces(s, x, y):
    """Of the first particle, and by differences of the energy."""
    found = s.evaluate(np.array([[x, y], NEIGHBOR])).force[0]
    step = 1e-6
    differences = []
    for dx, dy in np.eye(2) * step:
        ends = [s.energy(np.array([[x + k * dx, y + k * dy], NEIGHBOR])) for k in (1, -1)]
        differences.append((ends[1] - ends[0]) / (2 * step))
    return found, np.array(differences)


@two_laws
def test_face_corner_face(law):
    """Along a face, around its end, and along the next face."""
    s = scene(law)
    path = [(1.78, y) for y in (0.6, 0.9, 1 - 1e-5, 1 + 1e-5, 1.1, 1.3, 1.5)]
    for x, y in path:
        found, expected = forces(s, x, y)
        assert np.abs(found).max() > 1e-3
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(found).max())

    s = scene(law, WALLS.replace("region room block -8 2.6", "region room block -8 2.3"))
    for x, y in [(1 + 1e-5, 1.7), (1 - 1e-5, 1.7), (0.5, 1.75), (1.2, 1.65)]:
        found, expected = forces(s, x, y)
        assert np.abs(found).max() > 1e-3
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(found).max())


@pytest.mark.parametrize(("law", "obstacle"), in_turn(LAWS, ["pillar", "segment"]))
def test_energy_does_not_jump(law, obstacle):
    """Nor does the force along the normal, where a face ends; the part across has a step there."""
    walls = WALLS
    if obstacle == "segment":
        walls = WALLS.replace("block -1 1 -1 1", "block 1 1 -1 1")
    s = scene(law, walls)
    energies = [s.energy(np.array([[1.78, y], NEIGHBOR])) for y in (1 - 1e-9, 1, 1 + 1e-9)]
    np.testing.assert_allclose(energies, energies[1], rtol=1e-7)


@laws
def test_virial_of_slanted_faces(law):
    """The derivative by a strain of particles and walls, shear too.

    The force of a wall acts where its pressure is centered, not at the point nearest to the center.
    """
    corners = np.array([[-1.0, -1.2], [1.0, -0.7], [0.8, 1.1], [-1.2, 0.6]])
    room = np.array([[2.45, 0.0], [0.0, 2.25], [-0.1, 3.0]])
    along = np.array([[0.1, 1.0], [-1.0, 0.2], [-1.0, -0.3]])  # tangents of the room's walls
    x = np.array([[1.68, 1.25], [1.75, 0.02]])

    def strained(strain):
        f = np.eye(2) + strain
        polygon = " ".join(f"{v:.17g}" for v in (corners @ f.T).ravel())
        planes = []
        for p, t in zip(room @ f.T, along @ f.T, strict=True):
            planes.append(f"plane {p[0]:.17g} {p[1]:.17g} {-t[1]:.17g} {t[0]:.17g}")
        walls = f"fix w all deformable/wall polygon 4 {polygon} {' '.join(planes)}"
        return scene_of(
            x @ f.T, ["unit", "small"], STYLES[law], walls + "\nfix_modify w virial yes"
        )

    state = strained(np.zeros((2, 2))).evaluate()
    assert state.shape["contacts"][0] >= 3
    step = 1e-6
    for k, (i, j) in enumerate([(0, 0), (1, 1), (0, 1), (1, 0)]):
        strain = np.zeros((2, 2))
        strain[i, j] = step
        expected = (strained(-strain).energy() - strained(strain).energy()) / (2 * step)
        found = state.virial[min(k, 2)]
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-7 * np.abs(state.virial).max())
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=1e-11)
