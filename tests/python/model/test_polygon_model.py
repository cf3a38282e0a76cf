"""Numbers of beads, rest values and effective radii of polygons, and the settings they refuse."""

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused

RADII = np.array([0.5, 0.7])


def test_numbers_of_the_paper() -> None:
    polygons = ld.DeformablePolygon(50, radius=0.05, smooth=False).polygons(RADII)
    assert polygons.number.tolist() == [50, 72]
    assert polygons.radius == pytest.approx([0.45, 0.65])
    assert polygons.effective_radius == pytest.approx(RADII - 0.00205, abs=2e-5)


def test_few_vertices_are_enough_for_smooth_polygons() -> None:
    assert ld.DeformablePolygon(8, radius=0.01).polygons(RADII).number[0] == 8
    with pytest.raises(ld.ParameterError, match="too few"):
        ld.DeformablePolygon(8, radius=0.01, smooth=False).polygons(RADII)
    with pytest.raises(ld.ParameterError, match="too many"):
        ld.DeformablePolygon(9000, radius=0.01).polygons(RADII)


@pytest.mark.parametrize("number", [(50, 80), np.array([50.0, 80.0])])
def test_numbers_of_each_species(number: object) -> None:
    assert ld.DeformablePolygon(number, smooth=False).polygons(RADII).number.tolist() == [50, 80]


def test_one_number_is_of_the_smallest() -> None:
    model = ld.DeformablePolygon(np.float64(50.0), smooth=False)
    assert model.polygons(RADII[::-1]).number.tolist() == [72, 50]


def test_numbers_of_beads_are_whole_and_three_or_more() -> None:
    for number in (
        2,
        50.5,
        float("nan"),
        "many",
        [50, 2],
        [[50, 60]],
        [50, [1]],
        [],
    ):
        with refused("vertices must be whole numbers, at least 3, not"):
            ld.DeformablePolygon(number, smooth=False)  # type: ignore[arg-type]


def test_settings_are_positive() -> None:
    for name, value in (
        ("radius", 0.0),
        ("kr", [1.0, 2.0]),
    ):
        with refused(f"{name} must be a positive number"):
            ld.DeformablePolygon(**{name: value})


def test_stiffnesses_are_positive() -> None:
    for name, value, message in (
        ("kL", 0.0, r"be positive and finite, not 0\.0"),
        ("kA", [1.0, float("inf")], r"be positive and finite, not \[1\.0, inf\]"),
        ("kA", "1", "be a number, or one number for each species, not '1'"),
    ):
        with refused(f"{name} must {message}"):
            ld.DeformablePolygon(**{name: value})


def test_stiffnesses_of_each_species() -> None:
    model = ld.DeformablePolygon([50, 80], kL=np.array([1, 2]), kA=3, smooth=False)
    assert model == ld.DeformablePolygon([50, 80], kL=(1.0, 2.0), kA=3.0, smooth=False)
    polygons = model.polygons(RADII)
    assert polygons.kL.tolist() == [1.0, 2.0]
    assert polygons.kA.tolist() == [3.0, 3.0]
    assert polygons.kP.tolist() == [1.0 / 50, 2.0 / 80]
    assert (polygons.radius + polygons.skin).tolist() == polygons.effective_radius.tolist()


def test_one_value_a_species() -> None:
    message = r"there are 2 species, so \[1\.0.*\] must have as many numbers"
    with pytest.raises(ld.ParameterError, match=message):
        ld.DeformablePolygon(kL=[1.0]).polygons(RADII)
    with pytest.raises(ld.ParameterError, match=r"one for each of 2 species, not \["):
        ld.DeformablePolygon([50], smooth=False).polygons(RADII)


def test_beads_are_smaller_than_the_ring() -> None:
    with pytest.raises(ld.ParameterError, match=r"too large for a particle of radius 0\.5"):
        ld.DeformablePolygon(50, radius=0.25, smooth=False).polygons(RADII)


def test_no_bead_slips_through_between_others() -> None:
    with pytest.raises(ld.ParameterError, match=r"20 beads .* radius 0\.7, .* take 21 or more"):
        ld.DeformablePolygon([40, 20], radius=0.05, smooth=False).polygons(RADII)
    enough = ld.DeformablePolygon([40, 21], radius=0.05, smooth=False).polygons(RADII)
    assert enough.spacing[1] < 4.0 * 0.05 < 2.0 * 0.65 * np.sin(np.pi / 20)
    assert np.isfinite(enough.effective_radius).all()


def test_the_number_that_is_asked_for_suffices() -> None:
    """One number is that of the smallest species, but a larger species may need more beads."""
    for radii, number, way_out, step in (
        (np.array([0.5, 0.55, 0.9]), 3, "more", -1),
        (np.array([0.5, 0.55, 0.9]), 1e300, "fewer", 1),
        (np.array([0.15, 0.26]), 3, "more", -1),
        (np.array([0.15, 0.26]), 1e300, "fewer", 1),
    ):
        message = rf"take vertices = \d+ or {way_out}$"
        with pytest.raises(ld.ParameterError, match=message) as error:
            ld.DeformablePolygon(number, smooth=False).polygons(radii)
        limit = int(str(error.value).split()[-3])
        ld.DeformablePolygon(limit, smooth=False).polygons(radii)
        with pytest.raises(ld.ParameterError, match=message):
            ld.DeformablePolygon(limit + step, smooth=False).polygons(radii)


def test_lammps_lists_the_neighbors_of_the_closest_beads() -> None:
    with pytest.raises(ld.ParameterError, match=r"5000 .* radius 0\.7, .* take 1361 or fewer"):
        ld.DeformablePolygon([50, 5000], smooth=False).polygons(RADII)
    jammed = ld.jam(ld.bidisperse(8, seed=1)).packing
    model = ld.DeformablePolygon(244, radius=0.15, smooth=False)
    with ld.Simulation(jammed, model) as polygons:
        assert polygons.engine.polygons.spacing == pytest.approx(0.06 * 0.15, rel=1e-2)
        polygons.deform(polygons.box * 0.97)
        assert polygons.state().energy > 0.0
