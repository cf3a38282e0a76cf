"""`deformable shear` and `deformable plot`, as a user sees them."""

import csv
import json
import subprocess
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.engine.relax import TOLERANCE
from programs import command


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    result = command(*arguments, cwd=cwd)
    assert "Traceback" not in result.stdout + result.stderr
    return result


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a compression `run`, and a shear of its last packing, `shear`."""
    folder = tmp_path_factory.mktemp("runs")
    small = ("--number", "12", "--steps", "2", "--strain", "0.02", "--seed", "2")
    assert run("compress", *small, "--out", "run", cwd=folder).returncode == 0
    done = run("shear", "run", "--strain", "0.02", "--steps", "4", cwd=folder)
    assert done.returncode == 0, done.stderr
    head, *rows = done.stdout.splitlines()[:-1]
    assert head.split()[:4] == ["step", "shear_strain", "shear_stress", "pressure"]
    assert [row.split()[:2] for row in rows] == [[str(n), f"{0.005 * n:g}"] for n in range(1, 5)]
    return folder


def test_shear_starts_from_the_last_packing(folder: Path) -> None:
    with (folder / "shear" / "series.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["shear_strain"]) for row in rows] == [0.0, 0.005, 0.01, 0.015, 0.02]
    with ld.Run(folder / "run").simulation() as sim:
        states = [sim.state(), *sim.shear(0.02, steps=4)[1:]]
    assert [state.shear_strain for state in states] == [None, 0.005, 0.01, 0.015, 0.02]
    for row, state in zip(rows, states, strict=True):
        assert float(row["shear_stress"]) == pytest.approx(-state.pressure_tensor[0, 1], abs=1e-5)
        assert float(row["xy"]) == pytest.approx(state.packing.box[1, 0], rel=1e-9)
        assert float(row["lx"]) == pytest.approx(state.packing.box[0, 0], rel=1e-12)
    parameters = json.loads((folder / "shear" / "summary.json").read_text())["parameters"]
    assert (parameters["strain"], parameters["steps"]) == (0.02, 4)
    assert parameters["before"]["seed"] == 2


def interrupt(state: ld.State) -> None:
    raise KeyboardInterrupt


def test_shear_resumes(folder: Path, tmp_path: Path) -> None:
    with ld.Run(folder / "run").simulation() as sim:
        before = {"before": ld.Run(folder / "run").parameters}
        with pytest.raises(KeyboardInterrupt):
            sim.shear(
                0.02,
                steps=4,
                tolerance=TOLERANCE,
                record=tmp_path / "part",
                parameters=before,
                callback=interrupt,
            )
    done = run("shear", "--resume", "--strain", "0.02", "--out", "part", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for name in ("series.csv", "trajectory.lammpstrj", "summary.json", "packing.data"):
        assert (tmp_path / "part" / name).read_bytes() == (folder / "shear" / name).read_bytes()
    assert run("shear", "--resume", "--out", "part", cwd=tmp_path).stdout == (
        "the shear in 'part' is complete\n"
    )


def test_errors_are_one_line(folder: Path) -> None:
    before = sorted(folder.rglob("*"))
    for arguments, words in (
        (["shear", "--out", "new"], ["RUN"]),
        (["shear", "run"], ["'shear' holds a run", "--resume", "--overwrite"]),
        (["shear", "run", "--out", "run", "--overwrite"], ["'run'", "--out"]),
        (["shear", "nowhere", "--out", "new"], ["'nowhere'"]),
        (["shear", "--resume", "--strain", "0.3"], ["--strain 0.02", "0.3"]),
        (["plot", "run", "--frame", "3"], ["3 states", "no state 3"]),
        (["plot", "run", "--color-by", "beauty"], ["beauty"]),
        (["plot", "run", "--out", "a.doc"], [".png", "a.doc"]),
        (["plot", "run", "--out", "no/a.png"], ["no/a.png"]),
    ):
        result = run(*arguments, cwd=folder)
        assert (result.returncode, result.stderr.count("\n")) == (2, 1), arguments
        assert result.stderr.startswith("error: ")
        assert [word for word in words if word not in result.stderr] == []
        assert sorted(folder.rglob("*")) == before


def test_plot(folder: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    last = run("plot", str(folder / "run"), cwd=tmp_path)
    assert (last.returncode, last.stdout) == (0, "wrote packing.png\n")
    assert (tmp_path / "packing.png").stat().st_size > 10_000
    options = (
        "--color-by",
        "area",
        "--cmap",
        "magma",
        "--vmin",
        "0.5",
        "--vmax",
        "1.5",
        "--forces",
    )
    one = run(
        "plot",
        str(folder / "run"),
        "--frame",
        "0",
        *options,
        "--title",
        "A title",
        "--out",
        "first.svg",
        cwd=tmp_path,
    )
    assert one.returncode == 0, one.stderr
    assert "<!-- A title -->" in (tmp_path / "first.svg").read_text()


def test_plot_draws_the_frame(folder: Path, tmp_path: Path) -> None:
    """The title has phi and pressure of the frame."""
    pytest.importorskip("matplotlib")
    states = list(ld.Run(folder / "run"))
    for frame, state in ((0, states[0]), (-1, states[2])):
        name = f"{frame}.svg"
        run("plot", str(folder / "run"), "--frame", str(frame), "--out", name, cwd=tmp_path)
        assert f"{state.phi:.4f}" in (tmp_path / name).read_text()
    (again,) = [ld.Run(folder / "run")[-3]]
    assert again.energy == states[0].energy
