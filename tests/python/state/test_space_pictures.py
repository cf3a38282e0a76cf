"""Pictures in three dimensions: what rays meet, colors, the force network, and what is refused."""

from collections.abc import Callable

import deformable
import numpy as np
import pytest
from deformable.model import space_picture
from deformable.model.facets import WHOLE, Facets

plt = pytest.importorskip("matplotlib.pyplot")

LOW, HIGH = np.array([-1.5, -1.5]), np.array([2.5, 2.5])


def cast(centers: list[list[float]], facets: Facets = WHOLE) -> np.ndarray:
    """Red, green and blue spheres of radius 1."""
    count = len(centers)
    return space_picture._cast(
        np.array(centers, float), np.ones(count), np.eye(3)[:count], facets, LOW, HIGH
    )


def area(picture: np.ndarray, color: int) -> float:
    """Of the pixels of a color."""
    seen = picture[..., color] > 0.0
    return float(seen.sum()) * 16.0 / seen.size


def test_a_sphere_is_a_disk() -> None:
    picture = cast([[0.0, 0.0, 0.0]])
    assert area(picture, 0) == pytest.approx(np.pi, rel=0.02)
    assert float(picture[..., 3].mean()) * 16.0 == pytest.approx(np.pi, rel=2e-3)


def test_the_nearer_sphere_is_in_front() -> None:
    """Two circles at the distance 1 have 1.2284 in common."""
    common = 2.0 * np.pi / 3.0 - np.sqrt(0.75)
    for near, far in ((0, 1), (1, 0)):
        depth = [0.0, 0.0]
        depth[near] = 5.0
        picture = cast([[0.0, 0.0, depth[0]], [1.0, 0.0, depth[1]]])
        assert area(picture, near) == pytest.approx(np.pi, rel=0.02)
        assert area(picture, far) == pytest.approx(np.pi - common, rel=0.03)


@pytest.mark.parametrize("tilt", [0.0, 0.4, np.pi / 2.0, 2.7])
def test_a_plane_cuts_off_a_cap(tilt: float) -> None:
    """Seen from the front the disk is whole, from the side it lacks a segment.

    Facets that are seen are dark: pi (1 - h^2) cos tilt.
    """
    h = 0.8
    normal = np.array([[np.sin(tilt), 0.0, np.cos(tilt)]])
    picture = cast([[0.0, 0.0, 0.0]], Facets(np.zeros(1, np.int64), normal, np.array([h])))
    if tilt == np.pi / 2.0:
        segment = np.arccos(h) - h * np.sqrt(1.0 - h**2)
        assert area(picture, 0) == pytest.approx(np.pi - segment, rel=0.02)
    if tilt == 0.4:
        whole = cast([[0.0, 0.0, 0.0]])
        changed = float((np.abs(picture - whole).max(axis=-1) > 1e-3).mean()) * 16.0
        assert changed == pytest.approx(np.pi * (1.0 - h**2) * np.cos(tilt), rel=0.05)
    if tilt in (0.0, 2.7):
        assert area(picture, 0) == pytest.approx(np.pi, rel=0.02)


@pytest.fixture(scope="module")
def states() -> tuple[deformable.SphereState, deformable.DropletState]:
    crystal = deformable.cubic("fcc", 2, phi=0.8)
    with deformable.Spheres(crystal) as spheres:
        soft = spheres.state()
    with deformable.Simulation(crystal, deformable.Droplet()) as sim:
        return soft, sim.state()


def test_states_and_packings_are_drawn(
    states: tuple[deformable.SphereState, deformable.DropletState],
) -> None:
    for state in (*states, states[0].packing):
        axes = state.plot(color_by="radius", title="equal", colorbar=False)
        assert axes.get_title() == "equal"
        assert axes.images[0].get_array().max() > 0.0
    soft, droplets = states
    axes = droplets.plot(color_by=droplets.load, label="load", view=(40, 10))
    assert len(axes.figure.axes) == 2
    network = droplets.plot(forces=True)
    assert not network.images
    assert len(network.collections[1].get_segments()) == len(droplets.contact_table) // 2
    for state in states:
        assert "<img" in (state._repr_html_() or "")
    facets = soft._facets()
    assert len(facets.i) == 2 * len(soft.pairs)
    both = facets.height[: len(soft.pairs)] + facets.height[len(soft.pairs) :]
    assert both == pytest.approx(np.linalg.norm(soft._contact_forces.vector, axis=1))


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"view": 3}, "view must be elevation and azimuth, not 3"),
        ({"view": (1, 2, 3)}, "view must be elevation and azimuth"),
        ({"view": (np.nan, 0)}, "view must be finite numbers"),
        ({"color_by": "hue"}, "color_by must name a value of each particle"),
        ({"cmap": "none"}, "cmap must be one of"),
        ({"ax": 3}, "ax must be of the kind Axes"),
        ({"vmin": 2.0, "vmax": 1.0}, "vmin must be below vmax"),
    ],
)
def test_refusals(
    settings: dict[str, object],
    told: str,
    states: tuple[deformable.SphereState, deformable.DropletState],
) -> None:
    draw: Callable[..., object] = states[1].plot
    with pytest.raises(deformable.ParameterError, match=told):
        draw(**settings)
