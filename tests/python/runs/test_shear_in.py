"""A shear that is interrupted and resumed gives the files of one that was not, byte for byte."""

import csv
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

FILES = (
    *("packing.data", "species.deformable", "in.lammps", "summary.json"),
    *("series.csv", "trajectory.lammpstrj"),
)

# with rearrangements, so that other last digits would show, and the box is straightened once
STRAIN, STEPS = 0.8, 5


@pytest.fixture(scope="module")
def squeezed() -> ld.Packing:
    jammed = ld.jam(ld.bidisperse(16, seed=4))
    with ld.Simulation(jammed.at(jammed.phi + 0.03), ld.Ring()) as sim:
        return sim.relax().packing


def begin(packing: ld.Packing, folder: Path) -> list[ld.State]:
    sim = ld.Simulation(packing, ld.Ring())
    return sim.shear(STRAIN, record=folder, steps=STEPS, parameters={"seed": 4})[1:]


def contents(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in FILES}


def test_interrupted_after_any_step(squeezed: ld.Packing, tmp_path: Path) -> None:
    whole = list(begin(squeezed, tmp_path / "whole"))
    assert len(whole) == STEPS
    assert np.diff([state.packing.box[1, 0] for state in whole]).min() < 0.0  # straightened
    for steps in range(1, STEPS):
        states = begin(squeezed, tmp_path / str(steps))
        for _ in range(steps):
            next(states)
        missing = list(ld.Run(tmp_path / str(steps)).resume())
        assert len(missing) == STEPS - steps
        assert contents(tmp_path / str(steps)) == contents(tmp_path / "whole")
    assert list(ld.Run(tmp_path / "whole").resume()) == []


def test_it_is_a_shear(squeezed: ld.Packing, tmp_path: Path) -> None:
    """The same as `shear`, up to what rounding does; the box leans over and keeps its area."""
    with ld.Simulation(squeezed, ld.Ring()) as sim:
        first, *_ = sim.shear(0.02, steps=2)[1:]
    with ld.Simulation(squeezed, ld.Ring()) as sim:
        again, last = sim.shear(0.02, record=tmp_path, steps=2)[1:]
    assert again.energy == pytest.approx(first.energy, rel=1e-4)
    lean = last.packing.box[1, 0] - squeezed.box[1, 0]
    assert lean == pytest.approx(0.02 * squeezed.box[1, 1], rel=1e-12)
    assert last.packing.box.diagonal() == pytest.approx(squeezed.box.diagonal(), rel=1e-12)


def strains(folder: Path) -> list[str]:
    with (folder / "series.csv").open(newline="") as file:
        return [row.get("strain", "none") for row in csv.DictReader(file)]


def test_the_first_frame_is_the_start(squeezed: ld.Packing, tmp_path: Path) -> None:
    """Frame 0 of a new run; a run that is sheared further goes on after its last frame."""
    with ld.Simulation(squeezed, ld.Ring()) as sim:
        sim.shear(0.02, record=tmp_path, steps=2)
    assert strains(tmp_path) == ["0.0", "0.01", "0.02"]
    first, *_ = ld.Run(tmp_path)
    # LAMMPS takes them to fractions of the box and back, which rounds twice
    rounding = 2 * np.spacing(squeezed.box.max())
    np.testing.assert_allclose(first.packing.positions, squeezed.positions, 0, rounding)
    list(ld.Run(tmp_path).shear(0.04, 1))
    assert strains(tmp_path) == ["0.0", "0.01", "0.02", "0.06"]


def test_refusals(squeezed: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(squeezed, ld.Ring()) as sim:
        for values, word in (((0.1, 0), "steps"), ((np.nan, 2), "strain")):
            with pytest.raises(ld.ParameterError, match=word):
                ld.shear_in(sim, tmp_path / "run", *values)
        with pytest.raises(ld.ParameterError, match=r"tolerance .* 0\.5"):
            sim.shear(0.1, record=tmp_path / "run", steps=2, tolerance=0.5)
        assert not list(tmp_path.iterdir())
        sim.shear(0.02, record=tmp_path, steps=2)
        with pytest.raises(ld.FileError, match="overwrite=True"):
            sim.shear(0.02, record=tmp_path, steps=2)
        with pytest.raises(ld.FileError, match="interrupted at step 1 of 2"):
            ld.Run(tmp_path).shear(0.02, 2)
    with ld.Disks(squeezed) as disks, pytest.raises(ld.ParameterError, match="sim"):
        disks.shear(0.1, record=tmp_path / "run", steps=2)
