"""Distances of beads from outlines, for shapes with known distances."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import core
from lammps_deformable.reference.comparison import deviation, radial_distance, shape_error


def polar(radius: float, angle: np.ndarray) -> np.ndarray:
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def test_distances_of_a_square() -> None:
    corners = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
    angle = np.linspace(-7.0, 7.0, 141)  # beyond one turn too
    exact = 1.0 / np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))
    for start in range(4):
        assert radial_distance(np.roll(corners, start, axis=0), angle) == pytest.approx(exact)


def test_circle() -> None:
    circle = polar(2.0, 2.0 * np.pi * np.arange(1440) / 1440)
    beads = polar(2.1, np.linspace(0.0, 6.0, 50))
    chord = 2.0 * (1.0 - np.cos(np.pi / 1440))  # the polygon is within the circle by so much
    assert (deviation(beads, circle) >= 0.1 - 1e-14).all()
    assert (deviation(beads, circle) <= 0.1 + chord + 1e-14).all()
    assert shape_error(beads, circle, 2.0) == pytest.approx(0.05, abs=chord)


@pytest.mark.parametrize("law", ["ring", "sector"])
def test_an_outline_has_no_error_against_itself(law: str) -> None:
    angle, a = np.array([0.1, 1.9, 3.3, 5.0]), np.array([0.03, 0.05, 0.02, 0.04])
    points, corners = core.outline(law, 1.0, angle, a, 97), core.outline(law, 1.0, angle, a, 1440)
    # a chord of an arc of radius q <= 1.1 and length 2 pi/1440 stays within its sagitta
    assert shape_error(points, corners, 1.0) < 1.1 * (2.0 * np.pi / 1440) ** 2 / 8.0
    assert np.abs(deviation(corners, corners)).max() < 1e-14


def test_corners_that_coincide() -> None:
    corners = [[1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]]
    angle = np.linspace(-np.pi, np.pi, 33)  # corners among them
    exact = 1.0 / np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))
    assert radial_distance(corners, angle) == pytest.approx(exact)


@pytest.mark.parametrize(
    "corners",
    [
        [[1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]],  # clockwise
        [[2.0, -1.0], [4.0, -1.0], [4.0, 1.0], [2.0, 1.0]],  # not around the center
        [[2.0, 0.0], [0.5, 0.4], [1.5, 0.2], [0.0, 2.0], [-2.0, 0.0], [0.0, -2.0]],  # folded
        [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]],  # the center on a side, half a turn long
    ],
)
def test_rays_cross_an_outline_once(corners: list[list[float]]) -> None:
    with pytest.raises(ld.ParameterError, match="once around its center"):
        radial_distance(corners, np.array([0.3]))
