"""Pictures of packings: disks at rest, box and walls."""

import lammps_deformable as ld
import numpy as np
import pytest
from matplotlib import pyplot as plt
from refusals import refused


def test_disks_of_a_tilted_box_in_one_color_scale(jammed: ld.Packing) -> None:
    """Every disk and its images that reach into the box, colored by the radius."""
    open_before = plt.get_fignums()
    ax = jammed.plot()
    (disks,) = ax.collections
    colors = np.array(disks.get_array())
    assert set(colors) == set(jammed.radii)
    assert len(colors) > len(jammed)
    corners = np.concatenate([path.vertices[:-1] for path in disks.get_paths()[:1]])
    assert np.ptp(corners, axis=0) == pytest.approx([2.0 * colors[0]] * 2, rel=0.01)
    assert disks.get_clim() == (jammed.radii.min(), jammed.radii.max())
    assert ax.get_title() == ""
    assert plt.get_fignums() == open_before


def test_walls_and_own_values() -> None:
    walls = [ld.BoxWall((8, 6)), ld.Sphere(1, (4, 3), inside=False)]
    walled = ld.bidisperse(12, seed=1).between(walls, seed=1)
    numbers = np.arange(12) - 5.0
    ax = walled.plot(color=numbers, label="charge", title="walled", vmax=7.0)
    disks, obstacles = ax.collections
    assert len(disks.get_array()) == 12
    assert disks.get_clim() == (-7.5, 7.5)  # whole numbers
    assert len(obstacles.get_paths()) == 1
    assert ax.get_title() == "walled"
    assert walled.plot(color="species", colorbar=False, cmap="magma").figure is not ax.figure


def test_other_settings_are_refused(jammed: ld.Packing) -> None:
    for settings, message in (
        ({"color": "pressure"}, "such as radius, species, or be 32 numbers, not 'pressure'"),
        ({"color": [1.0, 2.0]}, r"or be 32 numbers, not \[1.0, 2.0\]"),
        ({"color": [1j] * 32}, r"or be 32 real numbers, not \[1j, "),
        ({"vmin": 1.0, "vmax": 1.0}, "vmin must be below vmax"),
        ({"scale": 1.0}, "scale must be of the kind Scale"),
    ):
        with refused(message):
            jammed.plot(**settings)  # type: ignore[arg-type]
