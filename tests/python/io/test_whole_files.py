"""A file is written whole or not at all, and no part of it stays."""

import os
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.cli.main import app
from lammps_deformable.common import files
from matplotlib.animation import PillowWriter
from refusals import refused

FULL = OSError(28, "No space left on device")


def full(*_: object, **__: object) -> None:
    raise FULL


def test_a_file(tmp_path: Path) -> None:
    (tmp_path / "file").mkdir()
    with refused("file' cannot be written: Is a directory", ld.FileError):
        files.write_whole(tmp_path / "file", "text")
    assert os.listdir(tmp_path) == ["file"]


def test_a_movie(state: ld.State, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    movie = tmp_path / "run.gif"
    ld.Run([state]).movie(movie)
    before = movie.read_bytes()
    monkeypatch.setattr(PillowWriter, "finish", full)
    with refused("run.gif' cannot be written: No space left on device", ld.FileError):
        ld.Run([state]).movie(movie, mode="w")
    assert os.listdir(tmp_path) == ["run.gif"]
    assert movie.read_bytes() == before


def test_a_folder_is_tried_before_the_movie_is_drawn(
    state: ld.State, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Path, "touch", full)
    monkeypatch.setattr(PillowWriter, "grab_frame", None)
    with refused("run.gif' cannot be written: No space left on device", ld.FileError):
        ld.Run([state]).movie(tmp_path / "run.gif")


def test_a_picture_of_the_shell(state: ld.State, tmp_path: Path) -> None:
    state.save(tmp_path / "run")
    with refused("^'.*nowhere/a.png' cannot be written: No such file", ld.FileError):
        app(["plot", str(tmp_path / "run"), "--out", "nowhere/a.png"], standalone_mode=False)
