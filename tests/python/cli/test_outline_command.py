"""`deformable outline`: shapes of particles in a dump that LAMMPS alone has written."""

import json
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.cli.main import app
from programs import command, program
from protocol_helpers import written
from refusals import refused

SCRIPT = '''
units lj
dimension 2
lattice hex 0.95
region box block -1 5 -1 3 -0.5 0.5
create_box 2 box
create_atoms 1 box
set group all type/fraction 2 0.5 12345
mass * 1.0
displace_atoms all random 0.02 0.02 0 1
print """
# name radius kA kP
stiff  0.6  3.0  0.5  tension 0.02
soft   0.5  1.0  0.5  tension 0.02
""" file mixture screen no
pair_style deformable/ring contact curved
pair_coeff * * mixture soft stiff
thermo_modify norm no
min_style fire
timestep 0.2
minimize 0 1e-9 2000 4000
reset_timestep 0
fix shape all pair 1 deformable/ring area 0 pressure 0
dump all all custom 1 shapes.dump id type x y f_shape[1] f_shape[2]
dump_modify all sort id format float %.17g
run 1
print "$(pe:%.15g)" file energy
'''


@pytest.fixture(scope="module")
def dumped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dump")
    (folder / "in.mixture").write_text(SCRIPT)
    done = program("lmp", "-in", "in.mixture", "-log", "none", cwd=folder)
    assert done.returncode == 0, done.stdout
    return folder


def test_state_is_that_of_lammps(dumped: Path) -> None:
    """Energy, areas and pressures are those of the script; outlines enclose the areas."""
    state = ld.State.from_file(
        dumped / "shapes.dump", dumped / "mixture", law="curved", types=["soft", "stiff"]
    )
    rows = np.loadtxt(
        (dumped / "shapes.dump").read_text().split("ITEM: ATOMS")[-1].splitlines()[1:]
    )
    assert state.energy == pytest.approx(float((dumped / "energy").read_text()), rel=1e-9)
    np.testing.assert_allclose(state.results["area"], rows[:, 4], rtol=1e-9)
    np.testing.assert_allclose(state.pressures, rows[:, 5], rtol=1e-6)
    assert set(state.packing.radii) == {0.5, 0.6}
    x, y = state.outlines[0].T
    enclosed = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    # a polygon of n points within a circle lacks 2 pi^2/3 n^2 of its area
    assert enclosed == pytest.approx(state.results["area"][0], rel=2 * 6.6 / len(x) ** 2)


def test_files(dumped: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = f"{dumped / 'shapes.dump'} --species {dumped / 'mixture'} --law curved"
    done = command("outline", *words.split(), "--types", "soft,stiff", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["wrote outlines.png", "wrote outlines.vtp"]
    assert (tmp_path / "outlines.png").stat().st_size > 10_000
    monkeypatch.chdir(tmp_path)
    more = ["--frame", "0", "--out", "a.svg", "--out", "b.geojson", "--color-by", "area_deficit"]
    app(["outline", *words.split(), *more], standalone_mode=False)
    assert json.loads((tmp_path / "b.geojson").read_text())["type"] == "FeatureCollection"
    assert (tmp_path / "a.svg").exists()


def form(law: ld.Ring | ld.Sector) -> tuple[str, object]:
    """What a species file does not have."""
    return law.name, getattr(law, "reach", None)


def test_files_of_a_run_tell_its_law(tmp_path: Path) -> None:
    """Of each frame, with its reach: energies are those of the run."""
    start = ld.jam(ld.bidisperse(16, seed=1)).packing.at(0.88)
    states = []
    for law in (ld.Ring(contact="curved", reach=0.4), ld.Sector()):
        with ld.Simulation(start, law) as sim:
            states.append(sim.state())
    written(states, tmp_path / "run")
    states[0].save(tmp_path / "saved")
    dump, species = tmp_path / "run" / "trajectory.lammpstrj", tmp_path / "saved"
    types = ["s1", "s2"]
    for frame in (0, 1, -1, -2):
        found = ld.State.from_file(dump, species / "species.deformable", types=types, frame=frame)
        assert form(found.law) == form(states[frame].law)
        assert found.energy == pytest.approx(states[frame].energy, rel=1e-9)
    alone = tmp_path / "alone.dump"
    alone.write_text(dump.read_text())
    for file in (species / "packing.data", alone):  # the species file is that of a run
        found = ld.State.from_file(file, species / "species.deformable")
        assert form(found.law) == ("curved", 0.4)
    own = tmp_path / "own.deformable"
    own.write_text((species / "species.deformable").read_text())
    assert ld.State.from_file(alone, own).law.name == "balanced"
    assert ld.State.from_file(dump, own, law="radical").law.name == "radical"
    for file, law in ((species / "packing.data", "curved"), (alone, "balanced")):
        words = ("outline", file, "--species", own, "--out", "a.vtp")
        said = command(*words, cwd=tmp_path).stdout.splitlines()
        assert said == [f"contact law {law}: give --law for another", "wrote a.vtp"]


def test_species_of_the_package_and_radii_of_atoms(tmp_path: Path) -> None:
    """Types in the order of the file; a radius for each atom where a column is named."""
    dump = tmp_path / "dump"
    rows = "1 1 1.0 1.0 0.4\n2 2 1.9 1.0 0.6\n"
    dump.write_text(
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 3\n0 3\n-1 1\n"
        f"ITEM: ATOMS id type x y size\n{rows}"
    )
    state = ld.State.from_file(dump, "droplets.deformable")
    np.testing.assert_array_equal(state.packing.radii, [0.5, 0.7])
    np.testing.assert_allclose(state.results["area"], np.pi * np.array([0.5, 0.7]) ** 2, rtol=1e-12)
    own = ld.State.from_file(dump, "droplets.deformable", radii="size")
    np.testing.assert_array_equal(own.packing.radii, [0.4, 0.6])
    assert own.energy > 0


def test_nonsense_is_told(dumped: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(dumped)
    text = (dumped / "shapes.dump").read_text()
    (dumped / "walled.dump").write_text(text.replace("pp pp pp", "ff pp pp"))
    errors = ld.ParameterError, ld.FileError, ld.LammpsError
    for words, message in (
        ("nowhere --species mixture", "'nowhere' cannot be read: No such file"),
        ("shapes.dump --species none", "no species file 'none'"),
        ("shapes.dump --species mixture --types soft", "type 2"),
        ("shapes.dump --species mixture --frame 9", "no frame 9"),
        ("shapes.dump --species mixture --radii size", "no column size"),
        ("shapes.dump --species mixture --law sector", "the sector law needs kP = inf"),
        ("shapes.dump --species mixture --out a.txt", "a picture is one of"),
        ("walled.dump --species mixture", "not periodic along x: .* State.from_file in Python$"),
    ):
        with refused(message, errors):
            app(["outline", *words.split()], standalone_mode=False)


def test_walls_of_the_input(tmp_path: Path) -> None:
    """A dump has no walls; with them the energy is that of the script."""
    between = (
        SCRIPT.replace("lattice", "boundary p f p\nlattice")
        .replace("-1 5 -1 3", "-1 5 -1.3 2.7")
        .replace("thermo_modify", "fix slit all deformable/wall ylo EDGE yhi EDGE\nthermo_modify")
        .replace("%.15g", "%.15g) $(ylo:%.17g) $(yhi:%.17g")
    )
    (tmp_path / "in.slit").write_text(between)
    done = program("lmp", "-in", "in.slit", "-log", "none", cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    energy, low, high = map(float, (tmp_path / "energy").read_text().split())
    walls = [ld.Plane((0, low), (0, 1)), ld.Plane((0, high), (0, -1))]
    how: dict[str, Any] = {"types": ["soft", "stiff"], "law": "curved"}
    state = ld.State.from_file(tmp_path / "shapes.dump", tmp_path / "mixture", walls=walls, **how)
    assert state.energy == pytest.approx(energy, rel=1e-9)
    assert np.abs(state.wall_forces[:, 1]).min() > 0.0


def test_law_must_be_one() -> None:
    with pytest.raises(ld.ParameterError, match=r"law must be .*balanced.*, not flat"):
        ld.State.from_file("a", "droplets.deformable", law="flat")


def test_species_that_stick(tmp_path: Path) -> None:
    """Lines of adhesion are no species."""
    law = ld.Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved", adhesion=0.2)
    with ld.Simulation(ld.Packing([[1, 1], [1.95, 1]], 0.5, (4, 4)), law) as sim:
        state = sim.state()
    state.save(tmp_path)
    words = ("packing.data", "--species", "species.deformable", "--out", "pair.geojson")
    assert command("outline", *words, cwd=tmp_path).returncode == 0
    found = json.loads((tmp_path / "pair.geojson").read_text())
    assert found["pressure"] == pytest.approx(state.pressure, rel=1e-9)
