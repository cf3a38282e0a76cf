"""States of particles in files of LAMMPS and other programs: labels, elements, digits, archives."""

import bz2
import gzip
import lzma
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Packing, State
from lammps_deformable.engine.lammps import silent_lammps
from mpi4py import MPI
from protocol_helpers import written
from refusals import refused

SPECIES = "small 0.5 1.0 inf\nlarge 0.7 1.0 inf\n"

DIGITS = "format float %20.15g"

# Files of LAMMPS, and the `types` with which they are read.
BY_NAME = {"A": "small", "Z": "large"}
FILES = {
    "numbers": (
        f"dump d all custom 1 {{}} id type x y\ndump_modify d {DIGITS}",
        ["large", "small"],
    ),
    "elements": (
        f"dump d all custom 1 {{}} id element x y\ndump_modify d element Z A {DIGITS}",
        BY_NAME,
    ),
    "labels": (f"dump d all custom 1 {{}} id typelabel xs ys\ndump_modify d {DIGITS}", None),
    "labels and numbers": (
        f"dump d all custom 1 {{}} type typelabel id xu yu\ndump_modify d {DIGITS}",
        {1: "large", 2: "small"},
    ),
    "zipped": (f"dump d all custom 1 {{}}.gz id typelabel x y\ndump_modify d {DIGITS}", None),
    "data of labels": ("write_data {} types labels", None),
    "data": ("write_data {}", None),
    "data of numbers": ("write_data {}", ["large", "small"]),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With a species file, whose order is that of no type."""
    folder = tmp_path_factory.mktemp("states")
    (folder / "two.deformable").write_text(SPECIES)
    return folder


@pytest.fixture(scope="module")
def tight(jammed: ld.State) -> State:
    """A packing whose first species is the larger one."""
    packed = jammed.packing.at(jammed.phi + 0.01)
    with ld.Simulation(packed.replace(species=1 - packed.species), ld.Ring()) as sim:
        return sim.relax()


@pytest.mark.parametrize("style", ["atomic", "hybrid sphere 1 dipole"])
@pytest.mark.parametrize("file", FILES)
def test_files_of_lammps(file: str, style: str, tight: State, folder: Path) -> None:
    """Energies are those of the packing, whatever names and places the types have."""
    commands, types = FILES[file]
    path, start = folder / "any", folder / "start.data"
    for old in folder.glob("any*"):
        old.unlink()
    tight.packing.export(start, mode="w")
    lmp = silent_lammps(MPI.COMM_SELF, f"units lj\ndimension 2\natom_style {style}")
    side = "units box block 0 {} 0 {} -0.5 0.5".format(*map(repr, np.diag(tight.box).tolist()))
    lmp.commands_string(f"region b {side.removeprefix('units box ')}\ncreate_box 2 b")
    lmp.command("labelmap atom 1 large 2 small")
    lmp.command("mass * 1.0")
    number = len(tight.packing)
    places = np.column_stack([tight.positions, np.zeros(number)])
    lmp.create_atoms(number, None, tight.packing.species + 1, places.ravel())
    lmp.commands_string(f"pair_style zero 2.0\npair_coeff * *\n{commands.format(path)}")
    if "write_data" not in commands:
        lmp.commands_string("run 0\nundump d")
    lmp.close()
    (path,) = folder.glob("any*")
    found = State.from_file(path, folder / "two.deformable", types=types)
    assert found.energy == pytest.approx(tight.energy, rel=1e-9)
    assert found.radii.tolist() == tight.radii.tolist()


def dumped(columns: str, rows: str) -> str:
    """Text of a dump."""
    head = (
        "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS pp pp pp\n0 6\n0 6\n-1 1\n"
    )
    return f"{head.format(len(rows.splitlines()))}ITEM: ATOMS {columns}\n{rows}"


def test_elements_have_no_order(folder: Path) -> None:
    """Names of types are species by name, or by a mapping, and nothing else."""
    path, species = folder / "elements.dump", folder / "two.deformable"
    path.write_text(dumped("id element x y", "1 Z 1 1\n2 A 2 1.05\n3 A 2.9 1\n"))
    for types in (None, ["small", "large"]):
        told = (
            r"names of types, A, Z, .* give one of small, large for each, types=\{'A': \.\.\., 'Z'"
        )
        with refused(told):
            State.from_file(path, species, types=types)
    with refused("particles of type A, and types has Z only"):
        State.from_file(path, species, types={"Z": "large"})
    found = State.from_file(path, species, types={"Z": "large", "A": "small", "B": "small"})
    assert found.radii.tolist() == [0.7, 0.5, 0.5]
    assert set(State.from_file(path, species, types={"Z": "small", "A": "small"}).radii) == {0.5}
    path.write_text(dumped("id element x y", "1 C 1 1\n2 C 2 1.05\n"))
    assert set(State.from_file(path, species, types=["large"]).radii) == {0.7}


def test_particles_that_are_left_out(folder: Path) -> None:
    path = folder / "group.dump"
    path.write_text(dumped("id type x y", "5 1 1 1\n9 1 3 3\n12 1 5 1\n"))
    with pytest.warns(ld.LackingWarning, match=r"has 3 particles, whose IDs go up to 12: contacts"):
        State.from_file(path, folder / "two.deformable")


@pytest.fixture(scope="module")
def jammed() -> ld.State:
    return ld.jam(ld.bidisperse(24, seed=1))


@pytest.mark.parametrize(
    ("above", "columns"),
    [(1e-4, "id type x y"), (1e-4, "id type xs ys"), (1e-2, "id type x y")],
)
def test_digits(above: float, columns: str, jammed: ld.State, folder: Path) -> None:
    """Six digits are too few near the onset, and enough above it; 15 digits are always enough."""
    with ld.Simulation(jammed.packing.at(jammed.phi + above), ld.Ring()) as sim:
        state = sim.relax(1e-8)
        for name in ("six", "all"):
            sim.lmp.command(f"dump {name} all custom 1 {folder / name} {columns}")
        sim.lmp.command(f"dump_modify all {DIGITS}")
        sim.lmp.commands_string("run 0\nundump six\nundump all")
    state.save(folder / "saved", mode="w")
    species = folder / "saved" / "species.deformable"
    found = State.from_file(folder / "all", species)
    assert found.pressure == pytest.approx(state.pressure, rel=1e-7)
    if above < 1e-3:
        told = r"rounded to .e-0., and overlaps are .*dump_modify ID format float %20\.15g"
        with pytest.warns(ld.LackingWarning, match=told):
            State.from_file(folder / "six", species)
    else:
        assert State.from_file(folder / "six", species).pressure == pytest.approx(
            state.pressure, rel=0.01
        )


@pytest.mark.parametrize("module", [gzip, bz2, lzma], ids=lambda module: module.__name__)
@pytest.mark.parametrize("suffix", [".data", ".lammpstrj", ".xyz", ".gsd"])
def test_compressed(module: object, suffix: str, tight: State, tmp_path: Path) -> None:
    if suffix == ".gsd":
        pytest.importorskip("gsd")
    plain, packed = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}.any"
    tight.packing.export(plain)
    packed.write_bytes(module.compress(plain.read_bytes()))  # type: ignore[attr-defined]
    if suffix == ".xyz":  # which is known by its suffix
        packed = packed.rename(tmp_path / "b.xyz.gz")
    found, direct = Packing.from_file(packed), Packing.from_file(plain)
    assert found.positions.tolist() == direct.positions.tolist()
    packed.write_bytes(packed.read_bytes()[:-9])
    with pytest.raises(ld.FileError, match=r"b.*' cannot be read: .*damaged") as error:
        Packing.from_file(packed)
    assert "\n" not in str(error.value)


def test_extended_xyz_for_ase(tmp_path: Path) -> None:
    """Species are chemical elements in its order, also those without particles."""
    io = pytest.importorskip("ase.io")
    packing = ld.bidisperse(4, phi=0.3, seed=1).replace(species=[0, 2, 0, 2])
    packing.export(tmp_path / "a.extxyz")
    atoms = io.read(tmp_path / "a.extxyz")
    assert atoms.get_atomic_numbers().tolist() == [1, 3, 1, 3]
    np.testing.assert_array_equal(atoms.positions[:, :2], packing.positions)
    np.testing.assert_array_equal(atoms.cell[:2, :2], packing.box)
    assert Packing.from_file(tmp_path / "a.extxyz").species.tolist() == [0, 2, 0, 2]


def test_extended_xyz_of_ase(tmp_path: Path) -> None:
    """What ASE writes again keeps the order of species."""
    io = pytest.importorskip("ase.io")
    packing = ld.bidisperse(4, phi=0.3, seed=1).replace(species=[3, 0, 3, 0])
    packing.export(tmp_path / "a.extxyz")
    io.write(tmp_path / "b.extxyz", io.read(tmp_path / "a.extxyz"))
    assert Packing.from_file(tmp_path / "b.extxyz").species.tolist() == [3, 0, 3, 0]


JAMMED = ld.bidisperse(16, phi=0.86, seed=1).push_off()
SPHERES = ld.bidisperse(16, phi=0.66, dimension=3, seed=1).push_off()
LAWS: dict[str, tuple[ld.Packing, ld.Ring | ld.Sector | ld.Droplet]] = {
    "balanced": (JAMMED, ld.Ring()),
    "curved": (JAMMED, ld.Ring(contact="curved", reach=0.4)),
    "radical": (JAMMED, ld.Ring(contact="radical")),
    "materials": (JAMMED, ld.Ring(kA=[1.0, 2.0], kP=0.3, skin=0.05, tension=0.02)),
    "adhesion": (JAMMED, ld.Ring(contact="curved", kA=np.inf, kP=0, tension=1, adhesion=0.05)),
    "sector": (JAMMED, ld.Sector(kA=2.0)),
    "sector of one area": (JAMMED, ld.Sector(kP=2.0)),
    "droplet": (SPHERES, ld.Droplet([1.0, 2.0])),
}


@pytest.mark.parametrize("name", LAWS)
def test_folders_of_the_package(name: str, tmp_path: Path) -> None:
    """All files of a run and of a saved state tell the law."""
    packing, law = LAWS[name]
    with ld.Simulation(packing, law) as sim:
        state = sim.state()
    written([state], tmp_path / "run")
    state.save(tmp_path / "saved")
    for file in ("run/trajectory.lammpstrj", "run/packing.data", "saved/packing.data"):
        path = tmp_path / file
        found = State.from_file(path, path.parent / "species.deformable")
        assert (type(found.law), found.law.name) == (type(law), law.name)
        assert found.energy == pytest.approx(state.energy, rel=1e-9)
        assert found.pressure == pytest.approx(state.pressure, rel=1e-9)


def test_a_folder_of_soft_disks(tmp_path: Path) -> None:
    """It has no species file, and the line names what reads it."""
    with ld.Simulation(JAMMED, ld.SoftContact()) as sim:
        sim.state().save(tmp_path)
    with refused(r"no species file .*: ld\.Run\('.*'\) has the states of its run", ld.FileError):
        State.from_file(tmp_path / "packing.data", tmp_path / "species.deformable")
