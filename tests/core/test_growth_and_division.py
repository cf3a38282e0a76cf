"""Growth and division: closed forms, and axes against numpy."""

import numpy as np
import pytest
from lammps_deformable import core


def test_growth() -> None:
    rate, pressure = [2.0, 2.0, 2.0, 0.0], [0.0, 0.3, 2.0, 0.3]
    assert core.growth_rate(rate, pressure, 1.0) == pytest.approx([2.0, 1.4, 0.0, 0.0])
    assert core.growth_rate(rate, pressure, np.inf).tolist() == rate


def test_daughters_share_the_size_of_their_mother() -> None:
    share = core.first_share(0.4, [-1.0, 0.0, 0.5, 1.0])
    assert share == pytest.approx([0.3, 0.5, 0.6, 0.7])
    radius = np.array([0.5, 0.7, 1.0, 2.0])
    for d in (2, 3):
        first, second, apart = core.daughters(radius, share, d)
        assert first**d == pytest.approx(share * radius**d)
        assert first**d + second**d == pytest.approx(radius**d)
        small, large = np.minimum(first, second), np.maximum(first, second)
        line = (apart**2 + small**2 - large**2) / (2.0 * apart)  # from the smaller one
        assert line == pytest.approx({2: 0.5, 3: 0.8}[d] * small)


@pytest.mark.parametrize("d", [2, 3])
def test_axes_of_least_pressure(d: int) -> None:
    stress = np.random.default_rng(d).normal(size=(50, d, d))
    stress += np.swapaxes(stress, 1, 2)
    stress[25:] += 9.0 * np.eye(d)  # pressed from all sides
    axes, lowest = core.stretched_axes(stress), np.linalg.eigh(stress)[1][:, :, 0]
    assert np.abs(np.einsum("md,md->m", axes, lowest)) == pytest.approx(np.ones(50), abs=1e-12)


@pytest.mark.parametrize("d", [2, 3])
def test_no_axis_where_all_directions_are_alike(d: int) -> None:
    stress = np.stack([np.zeros((d, d)), np.eye(d), -2.0 * np.eye(d), np.eye(d)])
    stress[3, 0, 0] += 1e-5
    axes = core.stretched_axes(stress)
    assert not axes[:3].any()
    assert np.linalg.norm(axes[3]) == pytest.approx(1.0)
    assert axes[3, 0] == pytest.approx(0.0, abs=1e-6)


def test_long_axes() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    assert core.long_axis(circle).tolist() == [0.0, 0.0]
    for angle in (0.3, 1.2, 2.9):
        along = np.array([np.cos(angle), np.sin(angle)])
        longer = circle + 0.2 * (circle @ along)[:, None] * along
        assert abs(core.long_axis(longer) @ along) == pytest.approx(1.0, abs=1e-12)


def test_long_axis_of_a_triangle_about_a_corner() -> None:
    """Its second moments are known: for corners a and b, (a a + b b + (a + b)(a + b))/12."""
    a, b = np.array([1.0, 0.0]), np.array([0.3, 1.1])
    moments = np.outer(a, a) + np.outer(b, b) + np.outer(a + b, a + b)
    axis = core.long_axis([[0.0, 0.0], a, b])
    assert abs(axis @ np.linalg.eigh(moments)[1][:, 1]) == pytest.approx(1.0, abs=1e-12)


def test_what_they_refuse() -> None:
    with pytest.raises(ValueError, match="rate and pressure must have as many numbers"):
        core.growth_rate([1.0], [1.0, 2.0], 1.0)
    with pytest.raises(ValueError, match="dimension must be 2 or 3, not 4"):
        core.daughters([1.0], [0.5], 4)
    with pytest.raises(ValueError, match="radius and share must have as many numbers"):
        core.daughters([1.0], [0.5, 0.5], 2)
    with pytest.raises(ValueError, match=r"share must be above 0 and below 1, not 1\.0"):
        core.daughters([1.0], [1.0], 2)
    with pytest.raises(ValueError, match="stress must have the shape"):
        core.stretched_axes(np.ones((2, 2, 3)))
    with pytest.raises(ValueError, match="outline must have rows of 2 numbers"):
        core.long_axis([[1.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match=r"most must be above 0, not nan"):
        core.growth_rate([1.0], [1.0], float("nan"))
    with pytest.raises(ValueError, match=r"asymmetry must be 0 or above and below 1, not 1\.0"):
        core.first_share(1.0, [0.0])
    with pytest.raises(ValueError, match="radius must be above 0, not -1"):
        core.daughters([-1.0], [0.5], 2)
    with pytest.raises(ValueError, match="stress must have finite numbers"):
        core.stretched_axes(np.full((1, 2, 2), np.inf))
    with pytest.raises(ValueError, match="outline must have finite numbers"):
        core.long_axis(np.full((3, 2), np.nan))
