"""A folder is known by what is in it, and no command spoils what another one has written."""

import json
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.formats.store import FORMAT, _last_line, holds, refuse
from programs import command


def run(*arguments: str, cwd: Path) -> str:
    """The one line of error with which a command ends."""
    result = command(*arguments, cwd=cwd)
    assert (result.returncode, result.stdout, result.stderr.count("\n")) == (2, "", 1)
    return result.stderr


def test_each_command_leaves_its_mark(state: ld.State, tmp_path: Path) -> None:
    for name in ("missing", "empty", "saved", "finished", "begun", "other"):
        if name != "missing":
            (tmp_path / name).mkdir()
    state.save(tmp_path / "saved")
    (tmp_path / "finished" / "report.json").write_text("{}")
    (tmp_path / "begun" / "parts").mkdir()
    assert holds(tmp_path / "begun") is None
    (tmp_path / "begun" / "parts" / "0.1.0" / "joblib").mkdir(parents=True)
    (tmp_path / "other" / "summary.json").write_text('["onset"]')
    assert {folder.name: holds(folder) for folder in sorted(tmp_path.iterdir())} == {
        "begun": "report",
        "empty": None,
        "finished": "report",
        "other": None,
        "saved": "run",
    }
    assert holds(tmp_path / "missing") is None


def test_no_report_in_a_run_nor_the_reverse(state: ld.State, tmp_path: Path) -> None:
    state.save(tmp_path / "run")
    with pytest.raises(ld.FileError, match=r"'.*run' holds a run: name another folder"):
        refuse(tmp_path / "run", but="report")
    (tmp_path / "report").mkdir()
    (tmp_path / "report" / "report.json").write_text(json.dumps({}))
    line = run("compress", "--out", "report", "--overwrite", cwd=tmp_path)
    assert line.startswith("error: 'report' holds a report")
    assert refuse(tmp_path / "report", but="report") == tmp_path / "report"


def test_a_folder_is_no_file(state: ld.State, tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("kept")
    with ld.Simulation(state.packing, state.law) as sim:
        for call in (
            lambda path: ld.Run(path).simulation(),
            lambda path: ld.Run(path).resume(),
            lambda path: sim.compress(record=path, strain=0.01)[1:],
        ):
            for path in (file, file / "within"):
                with pytest.raises(ld.FileError, match=f"'{file}' is a file, not a folder"):
                    call(path)
        with pytest.raises(ld.ParameterError, match="a folder needs a name, not ''"):
            sim.compress(record="", strain=0.01)
    for options in ((), ("--resume",), ("--overwrite",)):
        line = run("compress", "--out", "file", *options, cwd=tmp_path)
        assert line.startswith("error: 'file' is a file")
    assert file.read_text() == "kept"


def test_the_last_whole_line(tmp_path: Path) -> None:
    for text, last in (
        (b"", b""),
        (b"torn", b""),
        (b"one\n", b"one"),
        (b"one\ntwo\ntorn", b"two"),
        (b"x\n" + b"y" * 300_000 + b"\n", b"y" * 300_000),
        (b"one\n" + b"torn" * 30_000, b"one"),
    ):
        (tmp_path / "lines").write_bytes(text)
        assert _last_line(tmp_path / "lines") == last
    assert _last_line(tmp_path / "none") == b""


def test_a_folder_of_a_newer_format_is_refused(state: ld.State, tmp_path: Path) -> None:
    """One without a version is of 0.1.0."""
    state.save(tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary.pop("format") == FORMAT
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    assert ld.Run(tmp_path).simulation().packing.phi == state.packing.phi
    (tmp_path / "summary.json").write_text(json.dumps(summary | {"format": FORMAT + 1}))
    with pytest.raises(ld.FileError, match=f"has the format {FORMAT + 1}, .* reads up to {FORMAT}"):
        ld.Run(tmp_path)
