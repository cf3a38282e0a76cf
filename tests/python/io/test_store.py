"""Files of a saved state, and damage to them."""

import json
import re
from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.formats.store import read
from refusals import refused


def test_summary_has_law_parameters_and_versions(state: ld.State, tmp_path: Path) -> None:
    state.save(tmp_path, {"seed": 3, "kP": float("inf")})
    text = (tmp_path / "summary.json").read_text()
    summary = json.loads(text, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert summary["state"]["phi"] == state.phi
    settings = {"kA": 2.0, "reach": 0.6, "kP": "inf", "skin": 0.0, "tension": 0.0, "adhesion": 0.0}
    assert summary["law"] == {"name": "balanced"} | settings
    assert summary["parameters"] == {"seed": 3, "kP": "inf"}
    assert {"deformable", "lammps", "numpy", "python", "mpi"} <= summary["versions"].keys()


def test_missing_and_broken_runs_are_named(state: ld.State, tmp_path: Path) -> None:
    with pytest.raises(ld.FileError, match=r"summary\.json is missing"):
        read(tmp_path / "nowhere")
    state.save(tmp_path)
    (tmp_path / "summary.json").write_text('{"law": {"name": "Foam"}}')
    with pytest.raises(ld.FileError, match=r"cannot be read.*Foam"):
        read(tmp_path)
    state.save(tmp_path, mode="w")
    (tmp_path / "packing.data").unlink()
    with pytest.raises(ld.FileError, match=r"packing\.data"):
        read(tmp_path)


def test_a_data_file_that_lacks_an_atom(state: ld.State, tmp_path: Path) -> None:
    state.save(tmp_path)
    data = tmp_path / "packing.data"
    data.write_text(data.read_text().replace("\n32 2 ", "\n99 2 "))
    with pytest.raises(ld.FileError, match=r"packing\.data cannot be read: atom IDs must"):
        read(tmp_path)


def halved(path: Path) -> None:
    text = path.read_text()
    path.write_text(text[: len(text) // 2])


BROKEN = {
    "bad JSON": ("summary.json", lambda path: path.write_text('{"law": '), "Expecting value"),
    "bytes": ("summary.json", lambda path: path.write_bytes(b"\xff\xfe"), "codec can't decode"),
    "empty": ("summary.json", lambda path: path.write_text("{}"), "it lacks 'law'"),
    "garbage": (
        "packing.data",
        lambda path: path.write_text("garb age"),
        "it is no LAMMPS data file",
    ),
    "no edges": (
        "packing.data",
        lambda path: path.write_text(re.sub(r".*(?=xhi)", "", path.read_text())),
        "it is no LAMMPS data file",
    ),
    "no atoms": (
        "packing.data",
        lambda path: path.write_text(
            re.sub(r"(Atoms # .*\n)[^$]*", r"\1", path.read_text()).replace("32 atoms", "0 atoms")
        ),
        "it has 0 of 0 atoms",
    ),
    "half": ("packing.data", halved, r"it has \d+ of 32 atoms"),
}


def test_errors_name_the_file(state: ld.State, tmp_path: Path) -> None:
    for name, spoil, message in BROKEN.values():
        state.save(tmp_path, mode="w")
        spoil(tmp_path / name)
        with refused(f"{name} cannot be read: .*{message}", ld.FileError):
            read(tmp_path)
