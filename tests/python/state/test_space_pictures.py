"""Pictures in three dimensions: what rays meet, colors, the force network, and what is refused."""

from pathlib import Path
from typing import TYPE_CHECKING

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.pictures import plot3d
from lammps_deformable.pictures.plot3d import WHOLE, Facets, facets_of, section_of
from lammps_deformable.state.contacts import other_side
from refusals import refused

if TYPE_CHECKING:
    from collections.abc import Callable

plt = pytest.importorskip("matplotlib.pyplot")

LOW, HIGH = np.array([-1.5, -1.5]), np.array([2.5, 2.5])


def cast(centers: list[list[float]], facets: Facets = WHOLE) -> np.ndarray:
    """Red, green and blue spheres of radius 1."""
    count = len(centers)
    return plot3d._cast(
        np.array(centers, float), np.ones(count), np.eye(3)[:count], facets, LOW, HIGH
    )


def area(picture: np.ndarray, color: int) -> float:
    """Of the pixels of a color."""
    seen = picture[..., color] > 0.0
    return float(seen.sum()) * 16.0 / seen.size


def test_the_nearer_sphere_is_in_front() -> None:
    """Two circles at the distance 1 have 1.2284 in common."""
    common = 2.0 * np.pi / 3.0 - np.sqrt(0.75)
    for near, far in ((0, 1), (1, 0)):
        depth = [0.0, 0.0]
        depth[near] = 5.0
        picture = cast([[0.0, 0.0, depth[0]], [1.0, 0.0, depth[1]]])
        assert area(picture, near) == pytest.approx(np.pi, rel=0.02)
        assert area(picture, far) == pytest.approx(np.pi - common, rel=0.03)


def test_a_plane_cuts_off_a_cap() -> None:
    """From the side the disk lacks a segment; facets that are seen are dark, pi (1 - h^2) cos."""
    h, whole = 0.8, cast([[0.0, 0.0, 0.0]])

    def cut(tilt: float) -> np.ndarray:
        normal = np.array([[np.sin(tilt), 0.0, np.cos(tilt)]])
        return cast([[0.0, 0.0, 0.0]], Facets(np.zeros(1, np.int64), normal, np.array([h])))

    segment = np.arccos(h) - h * np.sqrt(1.0 - h**2)
    assert area(cut(np.pi / 2.0), 0) == pytest.approx(np.pi - segment, rel=0.02)
    changed = float((np.abs(cut(0.4) - whole).max(axis=-1) > 1e-3).mean()) * 16.0
    assert changed == pytest.approx(np.pi * (1.0 - h**2) * np.cos(0.4), rel=0.05)
    assert area(cut(2.7), 0) == pytest.approx(np.pi, rel=0.02)


@pytest.fixture(scope="module")
def states() -> tuple[ld.State, ld.State]:
    crystal = ld.crystal("fcc", 2, phi=0.8)
    with ld.Simulation(crystal, ld.SoftContact()) as spheres:
        soft = spheres.state()
    with ld.Simulation(crystal, ld.Droplet()) as sim:
        return soft, sim.state()


def test_states_and_packings_are_drawn(
    states: tuple[ld.State, ld.State],
) -> None:
    for state in (*states, states[0].packing):
        axes = state.plot(color="radius", title="equal", colorbar=False)
        assert axes.get_title() == "equal"
        assert axes.images[0].get_array().max() > 0.0
    soft, droplets = states
    axes = droplets.plot(color=droplets.loads, label="load", view=(40, 10))
    assert len(axes.figure.axes) == 2
    network = droplets.plot(forces=True)
    assert not network.images
    assert len(network.collections[1].get_segments()) == len(droplets.contacts) // 2
    for state in states:
        assert "<img" in (state._repr_html_() or "")
    facets, table = facets_of(soft), soft.contacts
    assert len(facets.i) == len(table)
    both = facets.height + facets.height[other_side(table)]
    assert both == pytest.approx(table["distance"])


def polygon_area(outline: np.ndarray) -> float:
    x, y = outline.T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2.0)


def test_sections_add_up_to_the_volume() -> None:
    """Of spheres that lean out of their box, in images: the mean area fraction is phi."""
    box = np.array([[3.0, 0.0, 0.0], [0.7, 2.5, 0.0], [-0.8, 0.9, 2.0]])
    places = np.random.default_rng(1).random((5, 3)) @ box + box[2]
    packing = ld.Packing(places, [0.3, 0.6, 0.3, 0.6, 0.3], box, species=[0, 1, 0, 1, 0])
    filled = 0.0
    for z in 2.0 * (np.arange(400) + 0.5) / 400:
        filled += sum(map(polygon_area, section_of(packing, WHOLE, z).outlines)) / 400 / 7.5
    circle = np.sin(2.0 * np.pi / 90) / (2.0 * np.pi / 90)  # 90 corners
    assert filled == pytest.approx(packing.phi * circle, rel=1e-4)
    below, above = (section_of(packing, WHOLE, 0.7 + 2.0 * step) for step in (-3, 2))
    assert np.sort(below.particle).tolist() == np.sort(above.particle).tolist()


def test_a_section_of_facets() -> None:
    """Of a cubic crystal: disks with four chords, of which four corners are left."""
    packing = ld.crystal("sc", 2, radius=1.0).at(0.6)
    with ld.Simulation(packing, ld.Droplet()) as sim:
        state = sim.state()
    h = packing.box[0, 0] / 4.0
    section = section_of(packing, facets_of(state), 0.1)
    assert len(section.outlines) == 4
    chord = 2.0 * np.sqrt(1.0 - 0.1**2 - h**2)
    lines = np.concatenate(section.contacts)
    assert len(lines) == 16
    assert np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1) == pytest.approx(chord, abs=6e-3)
    for middle, outline in zip(section.positions, section.outlines, strict=True):
        assert np.abs(outline - middle).max() == pytest.approx(h)
    axes = state.plot(slice=0.1, contacts=True, color="load")
    assert len(axes.collections[1].get_segments()) == 36  # of nine images
    between = section_of(ld.crystal("sc", 2, phi=0.3), WHOLE, 0.62)
    assert between.outlines == []
    assert state.plot(slice=h).collections  # on the facets


def test_movies(states: tuple[ld.State, ld.State], tmp_path: Path) -> None:
    from PIL import Image

    _, droplets = states
    for name, settings in (
        ("view", {"view": (10, 50)}),
        ("slice", {"slice": 0.0, "contacts": True}),
    ):
        path = tmp_path / f"{name}.gif"
        ld.Run([droplets, droplets]).movie(path, color="load", **settings)
        with Image.open(path) as movie:
            assert np.array(movie.convert("RGB")).std() > 10.0
    plane = ld.bidisperse(4, phi=0.1, seed=1)
    with ld.Simulation(plane.push_off(), ld.Ring()) as sim:
        state = sim.state()
    for one, settings, told in (
        (state, {"slice": 0.0}, "slice is for states in three dimensions"),
        (state, {"view": (1, 2)}, "view is for states in three dimensions"),
        (droplets, {"spins": True}, "spins is for states in the plane"),
        (droplets, {"contacts": True}, "contacts are drawn in a slice"),
    ):
        with pytest.raises(ld.ParameterError, match=told):
            ld.Run([one]).movie(tmp_path / "wrong.gif", **settings)
    assert not (tmp_path / "wrong.gif").exists()


def test_refusals(states: tuple[ld.State, ld.State]) -> None:
    for settings, told in (
        ({"slice": np.inf}, "slice must be a finite number"),
        ({"slice": 0.1, "forces": True}, "forces are those of the whole network"),
        ({"contacts": True}, "contacts are drawn in a slice: give a slice"),
        ({"view": 3}, "view must be elevation and azimuth, not 3"),
        ({"view": (np.nan, 0)}, "view must be finite numbers"),
        ({"color": "hue"}, "color must name a value of each particle"),
        ({"ax": 3}, "ax must be of the kind Axes"),
        ({"ax": plt.figure().add_subplot(projection="3d")}, "ax must be axes of the plane"),
    ):
        draw: Callable[..., object] = states[1].plot
        with refused(told):
            draw(**settings)
