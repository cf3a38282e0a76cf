"""Color map, limits and title of a picture."""

import lammps_deformable as ld
import pytest
from refusals import refused

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")


def test_settings_of_a_picture(state: ld.State) -> None:
    axes = state.plot(color="area", cmap="magma", vmin=0.5, vmax=2, title="a packing", forces=True)
    particles = axes.collections[0]
    assert particles.get_cmap().name == "magma"
    assert particles.get_clim() == (0.5, 2.0)
    assert axes.get_title() == "a packing"
    # widths of forces stay
    widths = [max(ax.collections[1].get_linewidths()) for ax in (axes, state.plot(forces=True))]
    assert widths[0] == widths[1]
    assert state.plot(title="").get_title() == ""


def test_other_settings_are_refused(state: ld.State) -> None:
    for settings, words in (
        ({"cmap": "rainbows"}, "cmap .*'rainbows'"),
        ({"vmin": 1.0, "vmax": 1.0}, "vmin must be below vmax, not 1 and 1"),
        ({"vmin": (1.0,)}, r"vmin .*\(1\.0,\)"),
        ({"vmax": float("nan")}, "vmax .*nan"),
    ):
        with refused(words):
            state.plot(**settings)
