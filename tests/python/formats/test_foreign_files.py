"""Packings in files that other programs have written."""

import warnings
from pathlib import Path

import lammps_deformable as ld
import MDAnalysis
import numpy as np
import pytest
from lammps_deformable import Packing
from lammps_deformable.engine.lammps import silent_lammps
from lammps_deformable.particles.commands import PLANE
from mpi4py import MPI
from programs import output


@pytest.fixture(scope="module")
def tilted() -> Packing:
    """Of radii of their own, in a tilted box, pushed apart."""
    loose = ld.polydisperse(30, lambda rng, n: rng.uniform(0.4, 0.6, 30), phi=0.7, tilt=0.4, seed=1)
    return loose.push_off()


DUMPS = {
    "parts of the box": "id type xs ys zs radius",
    "parts, unwrapped": "type id radius ysu xsu",
}


@pytest.mark.parametrize("columns", DUMPS.values(), ids=DUMPS.keys())
def test_a_dump_of_lammps(columns: str, tilted: Packing, tmp_path: Path) -> None:
    """With its rows in any order, units and times before the frames."""
    path = tmp_path / "dump.shapes"
    with ld.Simulation(tilted, ld.Ring()) as sim:
        for command in (
            f"dump shapes all custom 1 {path} {columns}",
            "dump_modify shapes format float %.17g units yes time yes sort off first yes",
            "run 0 post no",
            "displace_atoms all move 0.1 0.0 0.0",
            "run 1 post no",
        ):
            sim.lmp.command(command)
        sim.lmp.command("undump shapes")
    first = Packing.from_file(path, frame=0)
    np.testing.assert_allclose(first.radii, tilted.radii, rtol=1e-15)
    np.testing.assert_allclose(first.box, tilted.box, rtol=1e-15)
    apart = first.positions - tilted.positions
    images = apart @ np.linalg.inv(tilted.box)
    np.testing.assert_allclose(images, np.rint(images), atol=1e-12)
    last = Packing.from_file(path)
    moved = (last.positions - first.positions) @ np.linalg.inv(tilted.box)
    moved -= np.rint(moved)
    np.testing.assert_allclose(moved @ tilted.box, [[0.1, 0.0]] * 30, atol=1e-3)


def test_a_data_file_of_lammps(tilted: Packing, tmp_path: Path) -> None:
    with ld.Simulation(tilted, ld.Ring()) as sim:
        sim.lmp.command(f"write_data {tmp_path / 'any'}")
    found = Packing.from_file(tmp_path / "any")
    np.testing.assert_allclose(found.radii, tilted.radii, rtol=1e-14)
    np.testing.assert_allclose(found.box, tilted.box, rtol=1e-14)
    assert found.phi == pytest.approx(tilted.phi, rel=1e-13)


def test_lammps_reads_what_goes_out(tilted: Packing, tmp_path: Path) -> None:
    """The data file, and the positions of the dump after the particles have moved away."""
    tilted.export(tmp_path / "out.data")
    tilted.export(tmp_path / "out.lammpstrj")
    lmp = silent_lammps(MPI.COMM_SELF, PLANE.replace("atomic", "sphere"))
    lmp.command(f"read_data {tmp_path / 'out.data'}")
    for _ in range(2):
        places = np.array(lmp.gather_atoms("x", 1, 3)).reshape(-1, 3)[:, :2]
        images = (places - tilted.positions) @ np.linalg.inv(tilted.box)
        np.testing.assert_allclose(images, np.rint(images), atol=1e-12)
        lmp.command("displace_atoms all random 0.5 0.5 0 1")
        lmp.command(f"read_dump {tmp_path / 'out.lammpstrj'} 0 x y box yes replace yes")
    np.testing.assert_allclose(lmp.gather_atoms("radius", 1, 1), tilted.radii, rtol=1e-15)
    np.testing.assert_allclose(lmp.gather_atoms("rmass", 1, 1), 1.0, rtol=1e-14)
    lmp.close()


def test_a_recorded_run(tmp_path: Path, jammed: Packing) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        states = sim.compress(strain=0.01, steps=2, record=tmp_path)[1:]
    path = tmp_path / "trajectory.lammpstrj"
    for number in (-2, -1):
        found = Packing.from_file(path, frame=number)
        np.testing.assert_array_equal(found.positions, states[number].packing.positions)
        np.testing.assert_array_equal(found.radii, jammed.radii)
    by_column = Packing.from_file(path, radii="area")
    np.testing.assert_array_equal(by_column.radii, states[-1].results["area"])
    with pytest.raises(ld.FileError, match=r"3 frames, and no frame 3: give 0 to 2, or -1"):
        Packing.from_file(path, frame=3)


XYZ = """3
Lattice="4 0 0 1 3 0 0 0 9" Origin="-1 -1 0" Properties=species:S:1:pos:R:3:size:R:1
Zr 0.0 0.0 2.0 0.7
Cu 1.0 0.5 2.0 0.5
Zr 2.0 0.5 2.0 0.6
"""


def test_names_of_types_in_alphabetical_order(tmp_path: Path) -> None:
    path = tmp_path / "glass.xyz"
    path.write_text(XYZ.replace("4 0 0", "8 0 0") + XYZ)
    found = Packing.from_file(path, radii="size")
    assert found.species.tolist() == [1, 0, 1]
    assert found.radii.tolist() == [0.7, 0.5, 0.6]
    assert found.box.tolist() == [[4.0, 0.0], [1.0, 3.0]]
    assert found.positions.tolist() == [[1.0, 1.0], [2.0, 1.5], [3.0, 1.5]]
    by_type = Packing.from_file(path, radii={"Cu": 0.4, "Zr": 0.5, "Ni": 0.45}, frame=0)
    assert (by_type.radii.tolist(), by_type.box[0, 0]) == ([0.5, 0.4, 0.5], 8.0)


def test_as_many_types_as_atoms(tmp_path: Path) -> None:
    """Of which some have no atoms: radii are those of the atoms."""
    path = tmp_path / "three.data"
    atoms = "1 1 1.0 1.0 1 1 0\n2 1 1.0 1.0 2 1 0\n3 2 1.4 1.0 3 1 0"
    head = "a title\n\n3 atoms\n3 atom types\n0 5 xlo xhi\n0 5 ylo yhi\n-0.5 0.5 zlo zhi\n"
    path.write_text(f"{head}\nAtoms # sphere\n\n{atoms}\n")
    found = Packing.from_file(path)
    assert (found.species.tolist(), found.radii.tolist()) == ([0, 0, 1], [0.5, 0.5, 0.7])


def test_any_comment_of_plain_xyz(tmp_path: Path) -> None:
    """Also behind a header of the extended format."""
    lattice = 'Lattice="2 0 0 0 3 0 0 0 1" Properties=species:S:1:pos:R:3'
    for comment in ("", "it's a=b", "6'3\" high", "a='b", "half of 'it", "x = 3", "= \"'"):
        (tmp_path / "a.xyz").write_text(f"1\n{comment}\nA 0.1 0.2 0\n")
        found = Packing.from_file(tmp_path / "a.xyz", radii=0.5, box=(2, 3))
        assert found.box[1, 1] == 3.0
        (tmp_path / "b.xyz").write_text(f"1\n{lattice} {comment}\nA 0.1 0.2 0\n")
        assert Packing.from_file(tmp_path / "b.xyz", radii=0.5).box[1, 1] == 3.0


def test_words_that_look_like_numbers(tmp_path: Path) -> None:
    """`species:S` says that types are words, of which some are numbers."""
    for head, names, species in (
        ("", ("1", "A", "1"), [0, 1, 0]),
        ("", ("1e0", "01", "2"), [1, 0, 2]),
        ("Properties=species:S:1:pos:R:3", ("nan", "Cu", "inf"), [2, 0, 1]),
        ("Properties=species:S:1:pos:R:3", ("2", "1", "2"), [1, 0, 1]),
    ):
        rows = "".join(f"{name} {n}.1 0.2 0\n" for n, name in enumerate(names))
        (tmp_path / "a.xyz").write_text(f"3\n{head}\n{rows}")
        found = Packing.from_file(tmp_path / "a.xyz", radii=0.5, box=(4, 3))
        assert found.species.tolist() == species, names


def test_gsd_of_hoomd(tmp_path: Path) -> None:
    """Frames, names of types, a square box about the origin, and no diameters: no radii."""
    hoomd = pytest.importorskip("gsd.hoomd")
    with hoomd.open(tmp_path / "a.gsd", "w") as file:
        for shift in (0.0, 0.25):
            frame = hoomd.Frame()
            frame.configuration.box = [4, 4, 0, 0, 0, 0]
            frame.particles.N = 2
            frame.particles.types = ["small", "large"]
            frame.particles.typeid = [1, 0]
            frame.particles.position = [[-1.5 + shift, 0, 0], [1, 1, 0]]
            file.append(frame)
    with pytest.raises(ld.FileError, match=r"a.gsd' .* has no radii .*: give radii=0\.5, "):
        Packing.from_file(tmp_path / "a.gsd", frame=1)
    found = Packing.from_file(tmp_path / "a.gsd", radii=0.5, frame=1)
    assert found.positions.tolist() == [[0.75, 2.0], [3.0, 3.0]]
    assert (found.radii.tolist(), found.species.tolist()) == ([0.5, 0.5], [1, 0])
    sized = Packing.from_file(tmp_path / "a.gsd", radii={"small": 0.3, "large": 0.7}, frame=-2)
    assert (sized.radii.tolist(), sized.positions[0, 0]) == ([0.7, 0.3], 0.5)
    with pytest.raises(ld.FileError, match="2 frames, and no frame -3"):
        Packing.from_file(tmp_path / "a.gsd", frame=-3)


def test_diameters_of_gsd(tmp_path: Path) -> None:
    """Of the frame, of the first frame, and radii of 0.5, whose diameters gsd leaves out."""
    hoomd = pytest.importorskip("gsd.hoomd")
    with hoomd.open(tmp_path / "a.gsd", "w") as file:
        for diameters in ([1.2, 0.8], [1.2, 0.8], [1.0, 1.4]):
            frame = hoomd.Frame()
            frame.configuration.box = [4, 4, 0, 0, 0, 0]
            frame.particles.N = 2
            frame.particles.position = [[-1, 0, 0], [1, 0, 0]]
            frame.particles.diameter = diameters
            file.append(frame)
    for number, radii in ((0, [0.6, 0.4]), (1, [0.6, 0.4]), (2, [0.5, 0.7]), (-2, [0.6, 0.4])):
        found = Packing.from_file(tmp_path / "a.gsd", frame=number)
        assert found.radii == pytest.approx(radii, rel=1e-7)
    alike = Packing([[1.0, 1.0], [3.0, 1.0]], 0.5, (4.0, 4.0))
    alike.export(tmp_path / "b.gsd")
    with hoomd.open(tmp_path / "b.gsd") as file:
        assert not file.file.chunk_exists(0, "particles/diameter")
    assert Packing.from_file(tmp_path / "b.gsd").radii.tolist() == [0.5, 0.5]


TRAJECTORY = """units lj
dimension 2
atom_style sphere
read_data packing.data
pair_style zero 2.0
pair_coeff * *
dump xtc all xtc 1 run.xtc
dump_modify xtc sort id precision 100000
dump dcd all dcd 1 run.dcd
dump_modify dcd sort id
fix motion all nve
fix plane all enforce2d
velocity all set 0.25 0 0
timestep 1
run 2
"""


@pytest.fixture(scope="module")
def moved(tilted: Packing, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with trajectories of a motion."""
    folder = tmp_path_factory.mktemp("moved")
    tilted.export(folder / "packing.data")
    (folder / "in.run").write_text(TRAJECTORY)
    output("lmp", "-in", "in.run", "-log", "none", cwd=folder)
    return folder


@pytest.mark.parametrize(
    ("kind", "suffix"),
    [("xtc", ".data"), ("dcd", ".lammpstrj"), ("dcd", ".xyz"), ("xtc", ".gsd")],
)
def test_a_trajectory_of_lammps(
    kind: str, suffix: str, tilted: Packing, moved: Path, tmp_path: Path
) -> None:
    """Types and radii are those of the topology, whatever its format, lengths those of the file."""
    if suffix == ".gsd":
        pytest.importorskip("gsd")
    topology = tmp_path / f"packing{suffix}"
    tilted.export(topology)
    for frame, distance in ((0, 0.0), (2, 0.5)):
        found = Packing.from_file(moved / f"run.{kind}", frame=frame, topology=topology)
        assert found.species.tolist() == tilted.species.tolist()
        assert found.radii == pytest.approx(tilted.radii, rel=1e-6)
        assert found.box == pytest.approx(tilted.box, rel=1e-5)
        apart = found.positions - tilted.positions - [distance, 0.0]
        images = apart @ np.linalg.inv(tilted.box)
        assert images == pytest.approx(np.rint(images), abs=1e-5)


@pytest.mark.parametrize("kind", ["xtc", "dump"])
def test_types_that_no_file_tells(kind: str, tmp_path: Path) -> None:
    """Radii by type, or several species, need types: all particles would be of the first one."""
    data, species = tmp_path / "packing.data", tmp_path / "two.deformable"
    packing = ld.bidisperse(8, phi=0.1, seed=1)
    packing.export(data)
    path = tmp_path / f"run.{kind}"
    if kind == "xtc":
        (tmp_path / "in.run").write_text(TRAJECTORY)
        output("lmp", "-in", "in.run", "-log", "none", cwd=tmp_path)
        typed = Packing.from_file(path, radii={1: 0.5, 2: 0.4}, topology=data)
        assert sorted(set(typed.radii)) == [0.4, 0.5]
    else:
        packing.export(path)
        path.write_text(path.read_text().replace(" type ", " kind "))
    species.write_text("first 0.01 1.0 inf\nsecond 0.02 1.0 inf\n")
    told = "no types of particles: give a file that has them, "
    with pytest.raises(ld.FileError, match=f"{told}a topology, or one radius for all"):
        Packing.from_file(path, radii={1: 0.5, 2: 0.4})
    with pytest.raises(ld.FileError, match=f"{told}or the one species of all.* first"):
        ld.State.from_file(path, species)
    assert set(Packing.from_file(path, radii={1: 0.5}).radii) == {0.5}
    assert set(ld.State.from_file(path, species, types=["second"]).packing.radii) == {0.02}


def test_a_topology_of_other_particles(tilted: Packing, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tilted.to_mdanalysis().atoms.write(str(tmp_path / "a.dcd"))
    ld.bidisperse(7, seed=1).export(tmp_path / "b.data")
    for name, told in (
        ("b.data", "number of atoms"),
        ("c.data", "c.data' cannot be read: No such"),
    ):
        with pytest.raises(ld.FileError, match=told) as error:
            Packing.from_file(tmp_path / "a.dcd", topology=tmp_path / name)
        assert "\n" not in str(error.value)


def test_files_of_mdanalysis(tilted: Packing, tmp_path: Path) -> None:
    """The numbers of a .gro, which are nanometers, a trajectory with a topology, radii by name."""
    universe = tilted.to_mdanalysis()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name in ("a.gro", "a.dcd", "a.pqr"):
            universe.atoms.write(str(tmp_path / name))
        gro = Packing.from_file(tmp_path / "a.gro", radii=0.5)
        dcd = Packing.from_file(tmp_path / "a.dcd", radii=0.5, topology=tmp_path / "a.gro")
        pqr = Packing.from_file(tmp_path / "a.pqr", box=tilted.box)
    # MDAnalysis writes a tenth of the numbers that it has, with three digits
    np.testing.assert_allclose(gro.positions, tilted.positions / 10.0, atol=0.00051)
    np.testing.assert_allclose(gro.box, tilted.box / 10.0, atol=1e-5)
    np.testing.assert_allclose(dcd.positions, tilted.positions, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(pqr.radii, tilted.radii, atol=1e-4)
    again = MDAnalysis.Universe(str(tmp_path / "a.pqr"))
    assert len(again.atoms) == len(tilted)
