"""Pictures of states and of soft disks: figures, colors of signed values, values from arrays."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.state.contacts import forces_of
from refusals import refused

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")


def soft(aspect: float) -> ld.State:
    start = ld.bidisperse(30, phi=0.95, aspect=aspect, seed=1).push_off()
    with ld.Simulation(start, ld.SoftContact()) as disks:
        return disks.state()


@pytest.fixture(scope="module")
def disks() -> ld.State:
    return soft(4.0)


@pytest.mark.parametrize("aspect", [0.2, 4.0])
def test_long_boxes_fill_their_figures(aspect: float) -> None:
    """The box takes more than half of the figure, which is not larger than a page."""
    disks = soft(aspect)
    figure = disks.plot().figure
    figure.draw_without_rendering()
    width, height = figure.get_size_inches()
    area = disks.plot().figure.axes[0].get_position()
    box = figure.axes[0].get_window_extent().transformed(figure.dpi_scale_trans.inverted())
    (lx, _), (_, ly) = disks.packing.box
    assert box.width / box.height == pytest.approx(lx / ly, rel=0.03)
    assert box.width * box.height > 0.5 * width * height
    assert max(width, height) < 12.0
    assert area.width > 0.0


def test_no_figure_stays_open(state: ld.State, disks: ld.State) -> None:
    from matplotlib import pyplot

    before = pyplot.get_fignums()
    for _ in range(2):
        state.plot()
        disks.plot()
        assert state._repr_html_().startswith("<img")
        assert "State" in disks._repr_html_()
    assert pyplot.get_fignums() == before


def test_disks_have_the_words_of_states(disks: ld.State) -> None:
    """Contacts are chords: both ends on both circles; force chains bear the overlaps."""
    ax = disks.plot(contacts=True, forces=True, color="contacts", cmap="magma", title="disks")
    circles, chords, chains = ax.collections
    assert (circles.get_cmap().name, ax.get_title()) == ("magma", "disks")
    radius = np.unique(disks.packing.radii)
    x = disks.packing.positions
    images = np.concatenate(
        [x + (a, b) @ disks.packing.box for a in (-1, 0, 1) for b in (-1, 0, 1)]
    )
    for ends in chords.get_segments():
        for end in ends:
            away = np.hypot(*(images - end).T)
            on = np.abs(away[:, None] - radius).min(axis=1) < 1e-9
            assert on.sum() >= 2
    middle = [segment[1] - segment[0] for segment in chains.get_segments()]
    assert np.hypot(*np.transpose(middle)).max() < radius.max()
    forces = forces_of(disks)
    largest = np.hypot(*forces.force.T)
    widths = np.array(chains.get_linewidths())
    assert set((widths / widths.max()).round(9)) == set((largest / largest.max()).round(9))
    assert len(widths) >= 2 * len(largest)
    held = disks.particle_stress[:, [0, 1], [0, 1]].mean(axis=1)
    assert disks._values("pressures") == pytest.approx(held, rel=1e-12)
    assert np.sum(held * disks.volumes) / disks.packing.volume == pytest.approx(disks.pressure)


def test_disks_at_walls_are_drawn() -> None:
    """The chord of a wall is on the wall."""
    room = ld.bidisperse(12, phi=0.95, seed=1).between(ld.BoxWall((4, 4)))
    with ld.Simulation(room.push_off(), ld.SoftContact()) as disks:
        state = disks.state()
    assert np.sum(state.contacts["j"] < 0) > 0
    ends = np.array(state.plot(contacts=True).collections[-1].get_segments())
    (x, _), (_, y) = state.packing.box
    on_wall = (np.abs(ends) < 1e-9) | (np.abs(ends - (x, y)) < 1e-9)
    assert on_wall.all(axis=1).any(axis=1).sum() == np.sum(state.contacts["j"] < 0)


def test_signed_values_are_centered(state: ld.State) -> None:
    stress = -state.particle_stress[:, 0, 1]
    particles = state.plot(color=stress, label="shear stress").collections[0]
    low, high = particles.get_clim()
    assert low == -high == -np.abs(stress).max()
    assert particles.get_cmap().name == "BrBG"
    assert particles.colorbar.ax.get_ylabel() == "shear stress"
    one = state.plot(color=stress, vmin=-1.0, cmap="PRGn").collections[0]
    assert (one.get_clim(), one.get_cmap().name) == ((-1.0, 1.0), "PRGn")
    two = state.plot(color=stress, vmin=-1.0, vmax=2.0).collections[0]
    assert (two.get_clim(), two.get_cmap().name) == ((-1.0, 2.0), "YlGnBu")
    below = state.plot(color=-1.0 - np.abs(stress)).collections[0]
    assert below.get_clim()[1] > 1.0
    # what rounding leaves below 0 has no sign
    rounded = np.where(stress == stress.min(), -1e-12, 1.0)
    assert state.plot(color=rounded).collections[0].get_cmap().name == "YlGnBu"


def test_values_from_an_array(state: ld.State) -> None:
    values = np.arange(len(state.packing), dtype=float)
    values[2] = np.nan
    particles = state.plot(color=values.tolist()).collections[0]
    assert particles.get_clim() == (0.0, len(values) - 1.0)
    assert particles.colorbar.ax.get_ylabel() == ""
    shown = particles.to_rgba(np.array([np.nan]))
    assert shown == pytest.approx(np.array([[0.8, 0.8, 0.8, 1.0]]))


def test_other_values_are_refused(state: ld.State) -> None:
    for color in ("beauty", [1.0, 2.0], np.full(32, np.nan), np.full(32, "a")):
        with refused("color must name .* or be 32 numbers"):
            state.plot(color=color)
    with refused(r"ax must be axes .* plot\(\.\.\.\)\.figure\.savefig\('a\.png'\)"):
        state.plot("a.png")  # type: ignore[arg-type]
    with refused("label .* not 3"):
        state.plot(color="area", label=3)
    with refused("scale .* not 2"):
        state.plot(scale=2)


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
