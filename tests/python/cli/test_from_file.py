"""`deformable compress --from` and `deformable shear --from`: the packing in a file."""

import math
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.cli.main import app
from programs import command
from refusals import refused


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jammed: ld.Packing) -> Path:
    """A folder with a packing in it."""
    jammed.export(tmp_path / "a.xyz")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_it_begins_with_the_packing_as_it_is(here: Path, jammed: ld.Packing) -> None:
    done = command("compress", "--from", "a.xyz", "--steps", "1", cwd=here)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"32 particles at phi = {jammed.phi:.5f}")
    with ld.Simulation(jammed, ld.Ring()) as sim:
        state = sim.compress(strain=0.01)[-1]
    run = ld.Run(here / "compress")
    np.testing.assert_allclose(run[-1].packing.box, state.packing.box, rtol=1e-14)
    assert run[-1].phi == pytest.approx(state.phi, rel=1e-4)
    known = run.parameters
    assert (known["from_file"], known["from_frame"]) == ("a.xyz", -1)
    assert not known.keys() & {"number", "seed", "radii"}


def test_nonsense_is_told(here: Path) -> None:
    with pytest.warns(ld.UnsavedWarning):
        ld.bidisperse(4, seed=1).between(ld.BoxWall((9, 9))).export("shut.dump")
    for options, message in (
        ("--from a.xyz --seed 3", "the packing is that in 'a.xyz', and --seed is about a random"),
        ("--from-radii 0.5", "--from-radii is about the file of a packing: give --from too"),
        ("--from b.xyz", "'b.xyz' cannot be read: No such file"),
        ("--from .", "'.' is a folder: name a file in it, such as packing.data; in Python"),
        ("--from shut.dump", "not periodic along x: .*, to Packing.from_file in Python$"),
        ("--from a.xyz --from-frame 1", "it has 1 frames, and no frame 1"),
        ("--from a.xyz --from-radii 1=0.5", "it has particles of type 2, and radii has 1 only"),
        ("--from a.xyz --from-radii 1=0.5,2=x", "radius of type 2 must be a positive number, not"),
    ):
        with refused(message, (ld.ParameterError, ld.FileError)):
            app(["compress", *options.split()], standalone_mode=False)
        assert {path.name for path in here.iterdir()} == {"a.xyz", "shut.dump"}


@pytest.mark.parametrize(
    ("word", "radii"), [("radius", [0.5, 0.7]), ("0.4", [0.4, 0.4]), ("1=0.3,2=0.6", [0.3, 0.6])]
)
def test_radii(word: str, radii: list[float], here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They reach the compression, which does not begin here."""
    begun = []

    def play(sim: ld.Simulation, *_: object, **__: object) -> list[ld.State]:
        begun.append(sorted({*sim.state().packing.radii.tolist()}))
        return [sim.state()]

    monkeypatch.setattr(ld.Simulation, "play", play)
    monkeypatch.setattr("lammps_deformable.cli.main._finish", lambda *_: None)
    app(["compress", "--from", "a.xyz", "--from-radii", word], standalone_mode=False)
    assert begun == [sorted({*radii})]


def test_shear_begins_with_it(here: Path, jammed: ld.Packing) -> None:
    droplets = ("--kA", "inf", "--kP", "0", "--tension", "1")
    ask = ("shear", "--from", "a.xyz", *droplets, "--strain", "0.01", "--steps", "2")
    done = command(*ask, cwd=here)
    assert done.returncode == 0, done.stderr
    law = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)
    with ld.Simulation(jammed, law) as sim:
        state = sim.shear(0.01, steps=2)[-1]
    run = ld.Run(here / "shear")
    assert run[-1].law == law
    np.testing.assert_allclose(run[-1].packing.box, state.packing.box, rtol=1e-14, atol=1e-14)
    assert run[-1].shear_stress == pytest.approx(state.shear_stress, rel=1e-4)
    again = command(*ask, "--resume", cwd=here)
    assert again.stdout == "the shear in 'shear' is complete\n"
    other = command("shear", "--resume", "--tension", "2", cwd=here)
    assert "begun with --tension 1.0, not 2.0" in other.stderr


def test_nonsense_is_told_of_shear(here: Path) -> None:
    for options, message in (
        ("run --from a.xyz", "give the folder 'run' of a run, or --from, not both"),
        ("run --kP 3", "--kP is about the packing in a file, and a run has its own law"),
        ("--strain 0.1", "give the folder of a run, .* or --from FILE"),
        ("--from a.xyz --law sector --tension 1", "--tension is an option of ring laws"),
        ("--from a.xyz --steps 0", "steps"),
    ):
        with refused(message, (ld.ParameterError, ld.FileError)):
            app(["shear", *options.split()], standalone_mode=False)
        assert [path.name for path in here.iterdir()] == ["a.xyz"]
