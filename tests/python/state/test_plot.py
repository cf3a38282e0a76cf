"""Force chains, maps and movies, and the runs that they are drawn from."""

import shutil
import sys
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from exact_balance import exactly_balanced
from programs import command

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[ld.State]]:
    """A recorded run: its start, two steps of compression, then motion in a tilted box."""
    folder = tmp_path_factory.mktemp("run")
    jammed = ld.jam(ld.bidisperse(12, tilt=0.3, seed=2)).packing
    with (
        exactly_balanced(),
        ld.Simulation(jammed, ld.Ring(kP=2.0, skin=0.02)) as sim,
    ):
        states = [sim.state()]
        sim.compress(strain=0.03, steps=2, record=folder, callback=states.append)
        motion = {"temperature": 1e-5, "every": 20, "seed": 1, "callback": states.append}
        sim.run(60, record=folder, mode="a", **motion)
    return folder, states


@pytest.mark.parametrize(
    ("broken", "message"),
    [
        (None, r"trajectory\.lammpstrj is missing"),
        (lambda text: text[: len(text) - 700], "frame 5 .* cannot be read: [^;]*$"),
        (lambda text: text.replace("id type x y", "id type a b"), "frame 0 .* cannot be read"),
    ],
    ids=["missing", "half", "columns"],
)
def test_broken_trajectories_are_named(
    run: tuple[Path, list[ld.State]], tmp_path: Path, broken: object, message: str
) -> None:
    shutil.copytree(run[0], tmp_path, dirs_exist_ok=True)
    trajectory = tmp_path / "trajectory.lammpstrj"
    if callable(broken):
        trajectory.write_text(broken(trajectory.read_text()))
    else:
        trajectory.unlink()
    with pytest.raises(ld.FileError, match=message):
        list(ld.Run(tmp_path))


@pytest.mark.parametrize("title", ["many words that go on " * 6, "oneword" * 12, r"$\phi$ = 0.8"])
def test_a_title_is_within_the_picture(title: str, state: ld.State) -> None:
    for axes in (state.plot(title=title), ld.crystal("fcc", 1, phi=0.3).plot(title=title)):
        figure = axes.figure
        figure.draw_without_rendering()
        place, whole = axes.title.get_window_extent(), figure.bbox
        assert whole.x0 <= place.x0 < place.x1 <= whole.x1
        assert place.y1 <= whole.y1
        assert axes.get_title().split() == title.split()


def test_shape_parameter(state: ld.State) -> None:
    # a circle has the least perimeter
    assert state.shape_parameter.min() >= 1.0 - 4 * np.finfo(float).eps
    # conserved perimeter: P^2 / (4 pi A) = A0 / A
    expected = np.pi * state.packing.radii**2 / state.results["area"]
    assert state.shape_parameter == pytest.approx(expected, rel=1e-12)
    map_ = state.plot(color="shape_parameter").collections[0]
    assert map_.get_clim() == pytest.approx((expected.min(), expected.max()))


def test_force_chains_are_as_wide_as_their_forces(state: ld.State) -> None:
    """From each center to its contact lines, at every image that reaches into the box."""
    lines = state.plot(forces=True).collections[1]
    halves = np.array(lines.get_segments())
    length = np.linalg.norm(halves[:, 1] - halves[:, 0], axis=1)
    width = np.array(lines.get_linewidths())
    table = state.contacts
    found = set(zip(length.round(9), (width / width.max()).round(9), strict=True))
    height = state.packing.radii[table["i"]] - table["indentation"]
    force = table["force"] / table["force"].max()
    assert found == set(zip(height.round(9), force.round(9), strict=True))
    assert len(halves) >= len(table)


def test_force_chains_do_not_hide_the_particles(state: ld.State) -> None:
    """At most 3 points wide; narrower where particles are many and small."""
    from lammps_deformable.pictures.drawing import scale

    widths = [scale([np.ones(count)], [np.ones(3)], "area").widest for count in (4, 128, 1152)]
    assert widths[0] == widths[1] == 3.0
    assert widths[2] == pytest.approx(widths[1] / 3.0, rel=0.1)
    assert state.plot(forces=True).collections[1].get_alpha() < 1.0


def test_unloaded_packings_have_one_color_and_one_tick() -> None:
    """Without load all values are equal: the color bar names that one, and no other."""
    grid = 2.5 * np.stack(np.meshgrid(np.arange(4.0), np.arange(2.0)), axis=-1)
    loose = ld.Packing(
        grid.reshape(8, 2),
        np.where(np.arange(8) % 2, 0.7, 0.5),
        np.diag([10.0, 5.0]),
        species=np.arange(8) % 2,
    )
    with ld.Simulation(loose, ld.Ring()) as sim:
        idle = sim.state()
    ax = idle.plot(color="pressures", forces=True)
    bar = ax.collections[0].colorbar
    assert bar.get_ticks().tolist() == [0.0]
    assert ax.collections[0].norm(0.0) == 0.0


def test_pictures_with_one_bar(state: ld.State) -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    axes = figure.subplots(1, 2)
    for ax in axes:
        assert state.plot(ax, colorbar=False, vmin=0.0, vmax=1.0, forces=True) is ax
    assert len(figure.axes) == 2
    bar = figure.colorbar(axes[0].collections[0], ax=axes)
    assert bar.mappable.get_clim() == (0.0, 1.0)
    assert np.array_equal(np.unique(bar.mappable.get_array()), np.unique(state.pressures))


def test_movie_has_a_picture_a_state(run: tuple[Path, list[ld.State]], tmp_path: Path) -> None:
    from PIL import Image

    path = tmp_path / "movie.gif"
    ld.Run(run[0]).movie(path, forces=True, rate=5)
    with Image.open(path) as image:
        assert image.n_frames == len(run[1])
        assert image.info["duration"] == 200  # ms


@pytest.mark.parametrize("limits", [{}, {"vmin": 0.5, "vmax": 1.5}], ids=str)
def test_pictures_of_a_movie_share_one_scale(
    limits: dict[str, float],
    run: tuple[Path, list[ld.State]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from lammps_deformable.pictures import drawing as plots

    drawn, maps = [], []
    draw = plots.draw

    def watched(*arguments: object) -> object:
        ax = draw(*arguments)
        colors, forces = ax.collections
        maps.append(colors.get_cmap().name)
        drawn.append((*colors.get_clim(), max(forces.get_linewidths())))
        return ax

    monkeypatch.setattr(plots, "draw", watched)
    states = run[1]
    ld.Run(states).movie(tmp_path / "movie.gif", forces=True, cmap="magma", **limits)
    assert set(maps) == {"magma"}
    pressures = np.concatenate([state.pressures for state in states])
    force = [state.contacts["force"].max() for state in states]
    widest = drawn[int(np.argmax(force))][2]
    low, high = limits.get("vmin", pressures.min()), limits.get("vmax", pressures.max())
    expected = [(low, high, widest * one / max(force)) for one in force]
    assert np.array(drawn) == pytest.approx(np.array(expected))


def test_whole_numbers_have_a_color_each(state: ld.State) -> None:
    ax = state.plot(color="contacts")
    colors, numbers = ax.collections[0], state.n_contacts
    assert colors.get_clim() == (numbers.min() - 0.5, numbers.max() + 0.5)
    assert np.ptp(numbers) + 1 == colors.get_cmap().N
    (bar,) = (axes for axes in ax.figure.axes if axes is not ax)
    low, high = numbers.min(), numbers.max()
    assert [tick for tick in bar.get_yticks() if low <= tick <= high] == list(range(low, high + 1))
    rattlers = state.plot(color=np.arange(len(numbers)) % 2 == 0).collections[0]
    assert rattlers.get_clim() == (-0.5, 1.5)
    assert state.plot(color=np.linspace(0.0, 2.0, len(numbers))).collections[0].get_clim() == (0, 2)


def test_a_key_tells_the_widest_force(state: ld.State) -> None:
    ax = state.plot(forces=True)
    (text,) = ax.get_legend().get_texts()
    assert text.get_text() == f"force {np.abs(state.contacts['force']).max():.2g}"
    assert state.plot().get_legend() is None
    assert state.plot().get_title() == ""


def test_movies_that_cannot_be(
    state: ld.State, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(
        message: str, states: object = (state,), name: str = "a.gif", **how: object
    ) -> None:
        with pytest.raises(ld.ParameterError, match=message):
            ld.Run(states).movie(tmp_path / name, **how)

    refused(r"\.gif or an \.mp4, not '.*a\.avi'", name="a.avi")
    refused("at least one state", states=())
    refused("'beauty'", color="beauty")
    refused("cmap .*'beauty'", cmap="beauty")
    refused("vmin must be below vmax, not 2 and 1", vmin=2, vmax=1)
    refused("rate .* 0", rate=0)
    refused("rate .* 2.5", rate=2.5)
    monkeypatch.setattr("matplotlib.animation.writers.is_available", lambda _: False)
    refused("ffmpeg", name="a.mp4")
    monkeypatch.setitem(sys.modules, "matplotlib.animation", None)
    with pytest.raises(ImportError, match=r"pip install lammps-deformable\[plot\]"):
        ld.Run([state]).movie(tmp_path / "a.gif")
    assert not list(tmp_path.iterdir())


def test_movie_from_the_shell(run: tuple[Path, list[ld.State]], tmp_path: Path) -> None:
    from PIL import Image

    ask = ["--forces", "--color-by", "shape_parameter"]
    done = command("movie", run[0], *ask, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "wrote movie.gif\n")
    assert (tmp_path / "movie.gif").stat().st_size > 10_000
    ask += ["--cmap", "gray", "--vmin", "8", "--vmax", "9", "--out", "black.gif"]
    assert command("movie", run[0], *ask, cwd=tmp_path).returncode == 0
    with Image.open(tmp_path / "black.gif") as image:  # no particle reaches the first color
        middle = np.array(image.convert("L"))[150:250, 150:250]
    assert np.mean(middle < 128) > 0.5
    failed = command("movie", "nowhere", cwd=tmp_path)
    assert failed.returncode == 2
    assert failed.stderr.startswith("error: no saved run in 'nowhere'")
