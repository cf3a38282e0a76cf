"""A compression that is killed and resumed gives the files of one that was not, byte for byte."""

import json
import subprocess
from contextlib import nullcontext
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.cli import main as cli
from programs import command, program
from protocol_helpers import Stop, stop_after, written

FILES = (
    *("packing.data", "species.deformable", "in.lammps", "summary.json"),
    *("series.csv", "trajectory.lammpstrj", "setups.jsonl"),
)

# Commands that kill themselves before they open for writing, rename, cut or remove a file of the
# run for the n-th time, or in the middle of the n-th text that they append. Each is a process of
# its own, from a fork of one that has loaded what they need, and has no MPI yet.
VICTIMS = """
import json, os, signal, sys
import lammps, mpi4py, qdldl, scipy.sparse.linalg
mpi4py.rc.initialize = False
from mpi4py import MPI
from lammps_deformable.cli import main as cli
from lammps_deformable.formats import store

def strike():
    global count
    count -= 1
    if count == 0:
        os.kill(os.getpid(), signal.SIGKILL)

CHANGES = "open", "os.rename", "os.remove", "os.truncate"

def watch(event, details):
    if event not in CHANGES or "run/" not in str(details[0]):
        return
    if event != "open" or details[2] & (os.O_WRONLY | os.O_RDWR):
        strike()

def torn(path, text):
    with path.open("a", newline="") as file:
        file.write(text[: len(text) // 2])
        file.flush()
        strike()
        file.write(text[len(text) // 2 :])

for how, count, *words in json.loads(sys.argv[1]):
    child = os.fork()
    if child == 0:
        MPI.Init()
        if how == "before":
            sys.addaudithook(watch)
        else:
            store.append = torn
        sys.argv = ["deformable", "compress", "--out", "run", *words]
        cli.main()
        os._exit(0)
    _, status = os.waitpid(child, 0)
    assert os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL, (how, count)
"""

# at 0.6 % a step the packing rearranges, so that other last digits would show
START = ("--number", "16", "--strain", "0.03", "--steps", "5", "--seed", "5")


def compress(*options: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return command("compress", "--out", "run", *options, cwd=cwd)


def killed(*victims: tuple[object, ...], cwd: Path) -> None:
    """Commands, one after another: how and when each dies, and its options."""
    result = program("python", "-c", VICTIMS, json.dumps(victims), cwd=cwd)
    assert result.returncode == 0, result.stderr


def contents(folder: Path) -> dict[str, bytes]:
    assert not list(folder.glob("*.part"))
    return {name: (folder / name).read_bytes() for name in FILES}


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("uninterrupted")
    result = compress(*START, cwd=folder)
    assert result.returncode == 0, result.stderr
    return contents(folder / "run")


def test_killed_again_and_again(uninterrupted: dict[str, bytes], tmp_path: Path) -> None:
    again = (*START, "--overwrite")
    killed(
        ("torn", 1, *START),  # within the line of its law and walls
        ("torn", 3, *again),  # within the row of the start
        ("before", 15, *again),  # before its packing, which is written last
        cwd=tmp_path,
    )
    result = compress("--resume", cwd=tmp_path)  # there is no run yet
    assert (result.returncode, result.stderr.count("\n")) == (2, 1)
    assert "packing.data is missing" in result.stderr

    killed(
        ("before", 16, *again),  # before the frame of the first step
        ("torn", 3, "--resume"),  # within the frame of the second step
        ("torn", 2, "--resume"),  # within its row
        ("before", 21, "--resume"),  # between summary and packing of the third step
        cwd=tmp_path,
    )
    result = compress("--resume", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert [line.split()[0] for line in result.stdout.splitlines()] == [
        "step",
        "3",
        "4",
        "5",
        "wrote",
    ]
    assert contents(tmp_path / "run") == uninterrupted

    for options in ((), START):
        result = compress(*options, "--resume", cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        assert result.stdout == "the compression in 'run' is complete\n"
    assert contents(tmp_path / "run") == uninterrupted
    assert len(ld.Run(tmp_path / "run").resume()) == 6


def in_process(*options: str) -> None:
    """The command in this process, for errors."""
    cli.app(["compress", "--out", "run", *options], standalone_mode=False)


def test_the_same_command_resumes(
    uninterrupted: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another option is refused, and so is going further from an interrupted run."""
    monkeypatch.chdir(tmp_path)
    law = ("--kA", "1", "--kP", "inf", "--radii", "0.5", "0.7", "--law", "balanced")
    killed(("torn", 8, *START, *law), cwd=tmp_path)
    broken = contents(tmp_path / "run")
    for option, saved, given in (
        ("--seed", "5", "2"),
        ("--kP", "inf", "3.0"),
        ("--radii", "0.5 0.7", "0.5 0.8"),
        ("--law", "balanced", "radical"),
        ("--polydispersity", "none", "0.1"),
        ("--steps", "5", "2"),
        ("--tolerance", "1e-06", "1e-08"),
    ):
        with pytest.raises(ld.ParameterError) as error:
            in_process("--resume", option, *given.split())
        assert f"'run' was begun with {option} {saved}, not {given}" in str(error.value)
    with pytest.raises(ld.FileError, match=r"at step 2 of 5: finish it first with .*--resume"):
        in_process("--append", "--steps", "1")
    with pytest.raises(ld.FileError, match="at step 2 of 5: finish it first"):
        ld.Run(tmp_path / "run").simulation().compress(strain=0.01, record="run", mode="a")
    assert contents(tmp_path / "run") == broken
    result = compress(*START, *law, "--resume", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert contents(tmp_path / "run") == uninterrupted

    result = compress("--append", "--strain", "0.001", "--steps", "1", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    with pytest.raises(ld.ParameterError, match="was begun with --seed 5, not 3"):
        in_process("--append", "--seed", "3")  # of the first compression
    in_process("--resume", "--seed", "5", "--steps", "1")


def test_a_run_is_not_overwritten(uninterrupted: dict[str, bytes], tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    for name, content in uninterrupted.items():
        (folder / name).write_bytes(content)
    result = compress("--number", "8", cwd=tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith("error: 'run' holds a run")
    for way in ("--resume", "--append", "--overwrite"):
        assert way in result.stderr
    with (
        ld.Run(folder).simulation() as sim,
        pytest.raises(ld.FileError, match="mode='w'"),
    ):
        sim.compress(record=folder, strain=0.01)
    assert contents(folder) == uninterrupted
    result = compress("--number", "8", "--steps", "1", "--overwrite", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert (folder / "series.csv").read_text().count("\n") == 3
    assert json.loads((folder / "summary.json").read_text())["parameters"]["number"] == 8


def spoil(text: str, how: str) -> str | None:
    """A file that has lost recorded frames; None if it is missing."""
    if how == "missing":
        return None
    if how == "cut":  # within the last row
        return text[:-20]
    if how == "short":
        return text[: len(text) // 2]
    return text.replace("ITEM: TIMESTEP\n1\n", "ITEM: TIMESTEP\n7\n").replace("\n1,", "\n7,")


@pytest.mark.parametrize(
    ("name", "how"),
    [("trajectory.lammpstrj", "cut"), ("trajectory.lammpstrj", "other"), ("series.csv", "short")],
)
def test_missing_frames_are_refused(
    uninterrupted: dict[str, bytes], tmp_path: Path, name: str, how: str
) -> None:
    for file, content in uninterrupted.items():
        (tmp_path / file).write_bytes(content)
    left = spoil((tmp_path / name).read_text(), how)
    (tmp_path / name).unlink()
    if left is not None:
        (tmp_path / name).write_text(left)
    with pytest.raises(ld.FileError, match=rf"{name} lacks frame \d"):
        ld.Run(tmp_path).simulation().compress(strain=0.01, record=tmp_path, mode="a")
    summary = json.loads((tmp_path / "summary.json").read_text())
    summary["parameters"]["start"]["states"] = 6
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    with pytest.raises(ld.FileError, match=rf"{name} lacks frame \d"):
        ld.Run(tmp_path).resume()


def test_numbers_of_numpy_can_be_resumed(tmp_path: Path) -> None:
    """JSON does not know them."""
    packing = ld.jam(ld.bidisperse(8, seed=1)).packing
    given = {"strain": np.float32(0.02), "steps": np.int64(3), "tolerance": np.float32(1e-6)}
    with ld.Simulation(packing, ld.Ring()) as sim, pytest.raises(Stop):
        sim.compress(record=tmp_path, callback=stop_after(1), **given)
    assert len(ld.Run(tmp_path).resume()) == 4
    assert json.loads((tmp_path / "summary.json").read_text())["parameters"]["steps"] == 3


def test_python_resumes_what_it_began(jammed: ld.Packing, tmp_path: Path) -> None:
    """Also in a tilted box, where LAMMPS rounds centers as it wraps them, and behind a run."""
    tilted = ld.jam(ld.bidisperse(12, aspect=1.2, tilt=0.3, seed=2)).packing
    for name, stop in (("whole", None), ("broken", 1)):
        folder = tmp_path / name
        for packing in (jammed, tilted):
            sim = ld.Simulation(packing, ld.Ring())
            mode = "w" if packing is tilted else "x"
            sim.compress(record=folder, strain=0.02, steps=3, mode=mode)
        with ld.Run(folder).simulation() as sim, pytest.raises(Stop) if stop else nullcontext():
            how = {"record": folder, "mode": "a", "callback": stop_after(stop) if stop else None}
            sim.compress(strain=0.02, steps=3, **how)
    assert len(ld.Run(tmp_path / "broken").resume()) == 7
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")
    parameters = json.loads((tmp_path / "whole" / "summary.json").read_text())["parameters"]
    assert parameters["start"]["frame"] == 4
    assert parameters["before"]["start"]["frame"] == 1


def test_a_resumed_packing_was_rigid(
    jammed: ld.Packing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that a resumed packing that loses its rigidity still gives a warning."""
    first = ld.Simulation(jammed, ld.Ring())
    with pytest.raises(Stop):
        first.compress(record=tmp_path, strain=0.02, steps=2, callback=stop_after(1))
    again = []
    opened = ld.Run._simulation
    monkeypatch.setattr(
        ld.Run, "_simulation", lambda *given: again.append(opened(*given)) or again[0]
    )
    monkeypatch.setattr("lammps_deformable.protocols.recording._steps", lambda *_: None)
    ld.Run(tmp_path).resume()
    assert again[0]._rigidity.phi == first._rigidity.phi < 1.0


def test_what_cannot_be_resumed(state: ld.State, tmp_path: Path) -> None:
    with pytest.raises(ld.FileError, match=r"summary\.json is missing"):
        ld.Run(tmp_path).resume()
    written([state], tmp_path)
    with pytest.raises(ld.FileError, match=r"cannot be resumed: it is a saved state, or"):
        ld.Run(tmp_path).resume()
    lines = (tmp_path / "packing.data").read_text().splitlines(keepends=True)
    (tmp_path / "packing.data").write_text("".join(lines[:-2]))
    with pytest.raises(ld.FileError, match=r"packing\.data .* 30 "):
        ld.Run(tmp_path).resume()
