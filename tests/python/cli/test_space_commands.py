"""The commands in three dimensions: which law and dimension, dumps of LAMMPS, errors."""

from pathlib import Path

import lammps_deformable as ld
import pytest
from lammps_deformable.cli.main import app
from lammps_deformable.cli.options import law_and_dimension
from refusals import refused


def shell(line: str) -> None:
    app(line.split(), standalone_mode=False)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a packing of spheres and one of disks in it."""
    ld.crystal("fcc", 2, phi=0.78).export(tmp_path / "space.xyz")
    ld.bidisperse(8, dimension=2, seed=1).export(tmp_path / "plane.xyz")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_one_of_law_and_dimension() -> None:
    for law, dimension, found in (
        (None, None, ("balanced", 2)),
        (None, 3, ("droplet", 3)),
        ("droplet", None, ("droplet", 3)),
        ("curved", None, ("curved", 2)),
    ):
        assert law_and_dimension(law, dimension) == found


def test_droplets_in_a_dump_are_drawn(here: Path) -> None:
    """With a tension and a radius for each type."""
    packing = ld.bidisperse(8, sizes=(0.5, 0.6), dimension=3, seed=1).at(0.6).push_off()
    law = ld.Droplet([1.0, 1.5])
    with ld.Simulation(packing, law) as sim:
        expected = sim.state()
    packing.export("lammps.dump")
    (here / "oil.deformable").write_text(
        "small 0.5 inf 0 0 tension 1.0\nlarge 0.6 inf 0 0 tension 1.5\n"
    )
    shell(
        "outline lammps.dump --law droplet --species oil.deformable --color-by load --slice 0.5 "
        "--contacts --out section.png --out droplets.vtp"
    )
    assert {"section.png", "droplets.vtp"} <= {path.name for path in here.iterdir()}
    found = ld.State.from_file("lammps.dump", "oil.deformable", law="droplet")
    assert found.law == law
    assert found.energy == pytest.approx(expected.energy, rel=1e-6, abs=1e-12)
    assert "<polydata" in (here / "droplets.vtp").read_text().lower()


def test_nonsense_is_told(here: Path) -> None:
    for line, message in (
        ("compress --dimension 4", "--dimension must be 2 or 3, not 4"),
        ("compress --dimension 3 --law curved", "--law curved is for 2 dimensions, not 3: leave"),
        ("compress --law droplet --kA 2", "--kA is an option of ring laws: leave it out with"),
        ("compress --dimension 3 --aspect 40", "aspect must lie between 0.229 and 19.1 for 128"),
        ("compress --from space.xyz", r"fill space, .* dimension=3 \(in the shell --law droplet\)"),
        ("jam --from space.xyz --law droplet", "rigid already at phi = 0.7800"),
    ):
        errors = (ld.ParameterError, ld.FileError)
        with refused(message, errors):
            shell(line)


def test_nonsense_of_pictures_is_told(here: Path) -> None:
    """Of a packing in space, and of one in the plane."""
    with ld.Simulation(ld.crystal("fcc", 2, phi=0.78), ld.Droplet()) as sim:
        sim.state().save("space")
    with ld.Simulation(ld.crystal("hex", (4, 2), phi=0.92), ld.Ring()) as sim:
        sim.state().save("plane")
    for line, message in (
        ("plot space --spins", "spins is for states in the plane"),
        ("plot space --contacts", "contacts are drawn in a slice"),
        ("plot space --slice 1 --forces", "forces are those of the whole network"),
        ("plot plane --slice 1", "slice is for states in three dimensions"),
        ("plot plane --view 1 2", "view is for states in three dimensions"),
    ):
        with pytest.raises(ld.ParameterError, match=message):
            shell(line)
    shell("plot space --view 10 30 --color-by load --out view.png")
    shell("plot space --slice 0.2 --contacts --out slice.png")
    assert {"view.png", "slice.png"} <= {path.name for path in here.iterdir()}
