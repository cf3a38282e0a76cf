"""Secondary contacts: no overlaps remain and perimeters are constant, compared with shapely."""

from collections.abc import Iterator
from itertools import product

import lammps_deformable as ld
import numpy as np
import pytest
import shapely
from lammps_deformable import core
from lammps_deformable.state.secondary_contacts import SecondaryOutlines, _divided, _overlaps
from numpy.typing import NDArray
from refusals import refused

Array = NDArray[np.float64]


def sector_state(packing: ld.Packing) -> ld.State:
    """The sector law on given centers."""
    with ld.Simulation(packing, ld.Sector()) as sim:
        return sim.state()


@pytest.fixture(scope="module")
def dense() -> ld.State:
    """Centers of a relaxed packing in a sheared box."""
    jammed = ld.jam(ld.bidisperse(40, tilt=0.3, seed=5)).packing
    with ld.Simulation(jammed.at(0.92), ld.Ring()) as sim:
        return sector_state(sim.relax(1e-3).packing)


def column(width: float, radii: list[float], heights: list[float]) -> ld.State:
    """A column of particles, each pressed by its own images from both sides."""
    *y, top = np.cumsum([0.0, *heights])
    positions = np.column_stack([np.zeros(len(y)), y])
    box = np.diag([width, top])
    return sector_state(ld.Packing(positions, radii, box, species=np.arange(len(y))))


def flats(arcs: Array) -> tuple[Array, Array]:
    """From the end of each arc to the next one's beginning: along its tangent, and across."""
    following = np.roll(arcs, -1, axis=0)
    n = np.column_stack([np.cos(arcs[:, 4]), np.sin(arcs[:, 4])])
    step = following[:, :2] - arcs[:, :2] + (following[:, 2] - arcs[:, 2])[:, np.newaxis] * n
    return step[:, 1] * n[:, 0] - step[:, 0] * n[:, 1], np.sum(step * n, axis=1)


def meetings(
    state: ld.State, secondary: SecondaryOutlines, points: int = 180
) -> Iterator[tuple[Array, Array]]:
    """Overlapping outlines of particles without a primary contact, with images, by shapely."""
    packing = state.packing
    outlines = [
        center + core.arc_outline(arcs, points)
        for center, arcs in zip(packing.positions, secondary.arcs, strict=True)
    ]
    images = [np.array(image) @ packing.box for image in product([-1, 0, 1], repeat=2)]
    moved = [outline + image for image in images for outline in outlines]
    centers = np.concatenate([packing.positions + image for image in images])
    polygons = shapely.make_valid([shapely.Polygon(outline) for outline in moved])
    tree, count = shapely.STRtree(polygons), len(packing)
    for i in range(count):
        for n in tree.query(polygons[4 * count + i], predicate="intersects"):
            distance = np.hypot(*(centers[n] - packing.positions[i]))
            if distance > packing.radii[i] + packing.radii[n % count]:
                yield outlines[i], moved[n]


def overlap_area(state: ld.State, secondary: SecondaryOutlines) -> float:
    return 0.5 * sum(
        shapely.Polygon(one).intersection(shapely.Polygon(other)).area
        for one, other in meetings(state, secondary)
    )


def deepest(state: ld.State, secondary: SecondaryOutlines) -> float:
    """Largest overlap: the smallest shift that separates two, which is normal to some edge."""
    depths = [0.0]
    for one, other in meetings(state, secondary, points=1000):
        edges = np.concatenate([np.roll(one, -1, axis=0) - one, other - np.roll(other, -1, axis=0)])
        edges = edges[np.hypot(*edges.T) > 1e-9]
        normals = np.array([edges[:, 1], -edges[:, 0]]) / np.hypot(*edges.T)
        reach = np.max(one @ normals, axis=0) - np.min(other @ normals, axis=0)
        depths.append(float(np.min(reach)))
    return max(depths)


def test_overlaps_vanish(dense: ld.State) -> None:
    steps = [dense.resolve_secondary(n) for n in range(4)]
    area = [overlap_area(dense, step) for step in steps]
    residual = steps[3].residual
    assert residual[0] > 0.02
    assert area[0] > 0.01
    for n in range(3):
        assert residual[n + 1] < residual[n] or residual[n] == 0.0
        assert area[n + 1] < 0.1 * area[n] or area[n] < 1e-12
    # polygons lie within their outlines: only rounding of common straight parts remains
    assert residual[3] == 0.0
    assert steps[3].overlaps[3] == 0
    assert area[3] < 1e-12
    for n, step in enumerate(steps):
        np.testing.assert_array_equal(step.residual, residual[: n + 1])
        np.testing.assert_array_equal(step.overlaps, steps[3].overlaps[: n + 1])


@pytest.mark.parametrize("iterations", [0, 2])
def test_residual_is_the_largest_penetration(dense: ld.State, iterations: int) -> None:
    secondary = dense.resolve_secondary(iterations)
    found = secondary.residual[-1] * dense.packing.radii.mean()
    # polygons err by up to R (2 pi/1000)^2/8 = 3.5e-6 each
    assert found == pytest.approx(deepest(dense, secondary), rel=0, abs=7e-6)


def test_perimeters_and_tangents_are_kept(dense: ld.State) -> None:
    for iterations in (0, 1, 3):
        secondary = dense.resolve_secondary(iterations)
        for radius, arcs in zip(dense.packing.radii, secondary.arcs, strict=True):
            opening = arcs[:, 4] - arcs[:, 3]
            length, across = flats(arcs)
            perimeter = np.sum(arcs[:, 2] * opening) + length.sum()
            assert perimeter == pytest.approx(2.0 * np.pi * radius, rel=1e-12)
            # angles up to 8 are rounded to 1e-15, centers of the size R as well
            assert np.sum(opening) == pytest.approx(2.0 * np.pi, rel=0, abs=2e-15 * len(arcs))
            turn = np.remainder(np.roll(arcs[:, 3], -1) - arcs[:, 4] + np.pi, 2.0 * np.pi) - np.pi
            assert np.abs(turn).max() < 1e-14
            assert np.abs(across).max() < 1e-14 * radius


def test_outlines_are_those_of_the_arcs(dense: ld.State) -> None:
    secondary = dense.resolve_secondary()
    changed = 0
    for n, outline in enumerate(secondary.outlines):
        arcs = secondary.arcs[n]
        assert shapely.Polygon(outline).is_valid
        if len(arcs) == 1:
            continue
        np.testing.assert_array_equal(
            outline, dense.packing.positions[n] + core.arc_outline(arcs, same_area=True)
        )
        same = outline.shape == dense.outlines[n].shape and (outline == dense.outlines[n]).all()
        changed += not same
    assert changed >= secondary.overlaps[0]  # two a contact, but many have two contacts


def test_nothing_to_do() -> None:
    radius, height = 0.5, 0.5 * np.sqrt(3)
    crystal = ld.Packing(
        np.array([[0.25, 0.25 * height], [0.75, 1.25 * height]]),
        radius,
        0.98 * np.array([[1.0, 0.0], [0.0, 2 * height]]),
    )
    state = sector_state(crystal)
    secondary = state.resolve_secondary()
    for outline, expected in zip(secondary.outlines, state.outlines, strict=True):
        np.testing.assert_array_equal(outline, expected)
    assert secondary.residual.tolist() == [0.0] * 4
    assert secondary.overlaps.tolist() == [0] * 4


def test_particle_that_meets_itself() -> None:
    """Contacts with two images let it bulge into others: a rectangle with round corners."""
    radius, h, half = 1.0, 0.95, 1.01
    state = column(2 * h, [radius], [2 * half])
    secondary = state.resolve_secondary()
    bulge = (radius - h) * np.pi / 2 + h - half
    assert secondary.residual == pytest.approx([2 * bulge, 0.0, 0.0, 0.0], abs=1e-14)
    assert secondary.overlaps.tolist() == [1, 0, 0, 0]
    (arcs,) = secondary.arcs
    # 4 (h + half) - (8 - 2 pi) q is the perimeter
    q = (4 * (h + half) - 2 * np.pi * radius) / (8 - 2 * np.pi)
    centers = [[x * (h - q), y * (half - q)] for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    begin = np.argmin(np.abs(np.remainder(arcs[:, 3] + np.pi, 2 * np.pi) - np.pi))
    np.testing.assert_allclose(np.roll(arcs, -begin, axis=0)[:, :2], centers, rtol=0, atol=1e-14)
    np.testing.assert_allclose(arcs[:, 2], q, rtol=0, atol=1e-14)


def test_two_arcs() -> None:
    """Two particles of unequal radius, whose arcs both have the radius h and share the overlap."""
    h, spacing, radii = 0.95, 2.13, [1.0, 1.1]
    secondary = column(2 * h, radii, [spacing, spacing]).resolve_secondary()
    center = [(radius - h) * np.pi / 2 for radius in radii]  # of the arc above the particle's
    apart = spacing - sum(center)
    mean = np.mean(radii)
    assert secondary.residual == pytest.approx([(2 * h - apart) / mean, 0.0, 0.0, 0.0], abs=1e-14)
    assert secondary.overlaps.tolist() == [2, 0, 0, 0]
    for radius, y, arcs in zip(radii, center, secondary.arcs, strict=True):
        half = y + apart / 2
        q = (4 * (h + half) - 2 * np.pi * radius) / (8 - 2 * np.pi)
        np.testing.assert_allclose(arcs[:, 2], q, rtol=0, atol=1e-14)


def test_circle_with_one_contact_stays() -> None:
    """The other particle is pressed flat; the rest of the overlap is in the residual."""
    h, large, small = 0.95, 1.1, 0.8
    top = (large - h) * np.pi / 2 + h
    state = column(2 * h, [large, small], [top + small - 0.02, top + small + 0.01])
    secondary = state.resolve_secondary(2)
    np.testing.assert_array_equal(secondary.outlines[1], state.outlines[1])
    rest = core.contact_line(small + h - 0.02, small, h)
    mean = np.mean([large, small])
    assert secondary.residual == pytest.approx([0.02 / mean, *[rest / mean] * 2], abs=1e-14)
    assert secondary.overlaps.tolist() == [1, 1, 1]
    assert len(secondary.arcs[0]) == 3


def test_circle_with_two_contacts_takes_the_shape_of_the_law() -> None:
    h, large, small = 0.95, 1.1, 0.8
    top = (large - h) * np.pi / 2 + h
    state = column(2 * h, [large, small], [top + small - 0.02, top + small - 0.01])
    secondary = state.resolve_secondary()
    below, above = (core.contact_line(small + h - o, small, h) for o in (0.02, 0.01))
    expected = core.sector_arcs(small, [np.pi / 2, 3 * np.pi / 2], [above, below])
    np.testing.assert_allclose(secondary.arcs[1][:, :3], expected[:, :3], rtol=0, atol=1e-14)
    assert secondary.residual[1:].tolist() == [0.0] * 3


def test_circle_keeps_its_contact_until_it_has_two() -> None:
    """Neighbors above and below, and a smaller circle whose contact makes the upper one bulge."""
    h, large, small, tiny = 0.95, 1.1, 0.3, 0.15
    arc = (large - h) * np.pi / 2
    y = arc + np.sqrt((h + small - 0.02) ** 2 - 0.5**2)
    top = y + arc + np.sqrt((h + small + 1e-4) ** 2 - 0.5**2)
    beside = top - arc - np.sqrt((h + tiny - 0.03) ** 2 - 0.4**2)
    packing = ld.Packing(
        np.array([[0.0, 0.0], [0.0, top], [0.5, y], [-0.4, beside]]),
        [large, large, small, tiny],
        np.diag([2 * h, top + 3.0]),
        species=[0, 0, 1, 2],
    )
    state = sector_state(packing)
    arcs = [len(state.resolve_secondary(n).arcs[2]) for n in range(3)]
    assert arcs == [1, 1, 2]


def test_a_primary_contact_is_no_secondary_one() -> None:
    """By the law, a circle with a single contact overlaps its partner."""
    secondary = column(1.9, [1.1, 0.8], [1.88, 2.2]).resolve_secondary()
    assert secondary.overlaps.tolist() == [0] * 4
    assert secondary.residual.tolist() == [0.0] * 4


def test_beyond_the_model() -> None:
    state = sector_state(ld.jam(ld.bidisperse(32, seed=3)).packing.at(1.2))
    secondary = state.resolve_secondary()
    assert secondary.beyond == sum(np.sum(arcs[:, 2] <= 0.0) for arcs in secondary.arcs) > 0
    assert 0 < secondary.overlaps[-1] < secondary.overlaps[0]
    assert all(np.isfinite(arcs).all() for arcs in secondary.arcs)


def test_arcs_of_negative_radius_meet_nothing() -> None:
    for radius, depth in ((0.05, [0.15]), (-0.05, [])):
        packing = ld.Packing(np.array([[2.0, 2.0], [4.1, 2.0]]), 1.0, 10.0 * np.eye(2))
        left = np.array([[0.2, 0.0, 1.0, -1.0, 1.0]])
        right = np.array([[-1.0, 0.0, radius, np.pi - 1.0, np.pi + 1.0]])
        found, depths = _overlaps(packing, [left, right])
        assert depths == pytest.approx(depth)
        assert len(found) == 2 * len(depth)


def test_images_in_a_small_box() -> None:
    """A box and 4 x 4 copies of it give the same outlines."""
    small = ld.bidisperse(3, phi=0.9, tilt=0.4, seed=11)
    copies = [np.array(image) @ small.box for image in product(range(4), repeat=2)]
    large = ld.Packing(
        np.concatenate([small.positions + shift for shift in copies]),
        np.tile(small.radii, len(copies)),
        4 * small.box,
        species=np.tile(small.species, len(copies)),
    )
    one, many = (sector_state(p).resolve_secondary() for p in (small, large))
    assert one.residual[0] > 0.0
    # coordinates of up to 10 are rounded to 1e-15
    np.testing.assert_allclose(one.residual, many.residual, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(len(copies) * one.overlaps, many.overlaps)


def test_contacts_that_leave_no_arc_are_left_out() -> None:
    arc = np.array([0.1, 0.2, 1.0, 0.0, 1.0])
    room = 0.5**2 / 6
    pressed = _divided(arc, [(0.5, 0.2 * room)])
    assert len(pressed) == 2
    for useless in (
        (0.5, 0.1 * room),  # the same direction, less deep
        (0.5 + 1e-9, 0.1 * room),
        (0.52, 0.1 * room),  # too close
        (1e-9, 1e-12),  # the end of the arc
        (1.0, 1e-12),
        (0.3, 1.5),  # behind the center
        (0.7, -0.1),  # off the arc
        (0.8, 0.9),  # too deep
    ):
        both = _divided(arc, [useless, (0.5, 0.2 * room)])
        np.testing.assert_array_equal(both, pressed)


def test_other_laws_are_refused() -> None:
    for law in (
        ld.Ring(),
        ld.Sector(kP=1.0),
    ):
        with ld.Simulation(ld.bidisperse(4, seed=1), law) as sim:
            state = sim.state()
        with refused(f"not {type(law).__name__}"):
            state.resolve_secondary()


def test_negative_iterations_are_refused() -> None:
    state = sector_state(ld.bidisperse(4, seed=1))
    with pytest.raises(ld.ParameterError, match="iterations must not be negative, not -1"):
        state.resolve_secondary(-1)
