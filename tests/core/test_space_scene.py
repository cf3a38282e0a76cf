"""Distances from walls in space, their directions, and how these turn."""

import numpy as np
import pytest
from lammps_deformable import core

TILTED = (6.0, 5.0, 4.0, 1.5, -0.5, 0.7)


def scene():
    """In a box that is not periodic."""
    found = core.SpaceScene(0, 0, 0, 0, 0, 0)
    found.add_plane(1, 0, 0, 1, 2, -2)
    found.add_round(0.3, 0.1, 0.2, 9.0, True)
    found.add_round(3, 2, 1, 0.5, False)
    found.add_cone(0.3, 0.1, 0.2, 1, 2, 2, 8.0, 0.0, True)
    found.add_cone(0.3, 0.1, 0.2, 1, 2, 2, 8.0, -0.75, True)
    found.add_cone(3, 2, 1, 1, 2, 2, 0.5, 0.0, False)
    return found


X = np.random.default_rng(1).uniform(-1, 1.5, size=(30, 3))


def nearest(walls, x):
    return walls.nearest(*x.T).reshape(-1, len(x), 5)


def test_directions_are_slopes_of_distances():
    found, step = nearest(scene(), X), 1e-6
    assert np.linalg.norm(found[..., :3], axis=-1) == pytest.approx(1, rel=1e-14)
    for axis in range(3):
        high, low = (nearest(scene(), X + sign * step * np.eye(3)[axis]) for sign in (1, -1))
        slopes = (high - low) / (2 * step)
        assert slopes[..., 3] == pytest.approx(-found[..., axis], abs=1e-8)
        unit, of_wall = np.eye(3)[axis], np.zeros((6, 1, 3))
        of_wall[3:] = np.array([1, 2, 2]) / 3
        out = found[..., :3] - (found[..., :3] * of_wall).sum(-1, keepdims=True) * of_wall
        out /= np.linalg.norm(out, axis=-1, keepdims=True)
        across = unit - of_wall[..., axis, None] * of_wall - out[..., axis, None] * out
        assert slopes[..., :3] == pytest.approx(-found[..., 4, None] * across, abs=1e-8)


def test_known_distances():
    plane, sphere, ball, tube, cone, post = nearest(scene(), X)[..., 3]
    assert plane == pytest.approx((X - [1, 0, 0]) @ [1, 2, -2] / 3)
    from_center = X - [0.3, 0.1, 0.2]
    assert sphere == pytest.approx(9 - np.linalg.norm(from_center, axis=1))
    assert ball == pytest.approx(np.linalg.norm(X - [3, 2, 1], axis=1) - 0.5)
    axis = np.array([1, 2, 2]) / 3
    across = np.linalg.norm(np.cross(from_center, axis), axis=1)
    assert tube == pytest.approx(8 - across)
    assert cone == pytest.approx((8 - 0.75 * from_center @ axis - across) * 0.8)
    away = np.linalg.norm(np.cross(X - [3, 2, 1], axis), axis=1)
    assert post == pytest.approx(away - 0.5)


def test_images_of_obstacles():
    """The nearest one of all, if it is nearer than half of the sides; containers have none."""
    walls = core.SpaceScene(*TILTED)
    walls.add_round(0.5, 4.5, 3.5, 0.3, False)
    walls.add_round(0.5, 4.5, 3.5, 9.0, True)
    walls.add_cone(0.5, 4.5, 3.5, 1, 0, 0, 0.3, 0.0, False)
    walls.add_cone(0.5, 4.5, 3.5, 1, 0, 0, 9.0, 0.0, True)
    lx, ly, lz, xy, xz, yz = TILTED
    box = np.array([[lx, 0, 0], [xy, ly, 0], [xz, yz, lz]])
    x = np.random.default_rng(2).random((200, 3)) @ box
    steps = np.array(np.meshgrid(*[range(-3, 4)] * 3)).reshape(3, -1).T @ box
    apart = np.linalg.norm(x[:, None] - [0.5, 4.5, 3.5] - steps, axis=-1).min(axis=1)
    ball, sphere, post, tube = nearest(walls, x)[..., 3]
    near = apart < 1.8
    assert near.sum() > 10
    assert ball[near] == pytest.approx(apart[near] - 0.3)
    assert sphere == pytest.approx(9 - np.linalg.norm(x - [0.5, 4.5, 3.5], axis=1))
    apart = np.linalg.norm((x[:, None] - [0.5, 4.5, 3.5] - steps)[..., 1:], axis=-1).min(axis=1)
    near = apart < 1.8
    assert near.sum() > 10
    assert post[near] == pytest.approx(apart[near] - 0.3)
    assert tube == pytest.approx(9 - np.linalg.norm((x - [0.5, 4.5, 3.5])[:, 1:], axis=1))


def test_middles_have_any_direction():
    walls = core.SpaceScene(0, 0, 0, 0, 0, 0)
    walls.add_round(1, 2, 3, 2.0, True)
    walls.add_round(1, 2, 3, 2.0, False)
    walls.add_cone(1, 2, 3, 0, 0, 1, 2.0, 0.0, True)
    walls.add_cone(1, 2, 3, 0, 0, 1, 2.0, 0.0, False)
    found = walls.nearest([1], [2], [3])
    assert np.linalg.norm(found[:, :3], axis=1) == pytest.approx(1)
    assert found[:, 3].tolist() == [2, -2, 2, -2]
    assert np.isinf(found[:, 4]).all()
    with pytest.raises(ValueError, match="one value for each point"):
        walls.nearest([1], [2], [3, 4])
