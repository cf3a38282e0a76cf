"""Files that are no packing, each with one line that names the file and the way out."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Packing
from refusals import refused

DUMP = """ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp pp pp
0 4
0 3
-0.5 0.5
ITEM: ATOMS id type x y z radius
1 1 0.5 0.5 0 0.5
2 2 1.5 0.5 0 0.4
"""
DATA = """a title

2 atoms
2 atom types
0 4 xlo xhi
0 3 ylo yhi
-0.5 0.5 zlo zhi

Atoms # sphere

1 1 1.0 1.0 0.5 0.5 0
2 2 0.8 1.0 1.5 0.5 0

Velocities

1 0 0 0 0 0 0
2 0 0 0 0 0 0
"""
XYZ = """2
Lattice="4 0 0 0 3 0 0 0 1" Properties=species:S:1:pos:R:3:radius:R:1
1 0.5 0.5 0 0.5
2 1.5 0.5 0 0.4
"""
TEXTS = {"dump": DUMP, "data": DATA, "xyz": XYZ}

# kind of the file, what is changed to what in it, and what is told
BAD = [
    ("dump", "1.5 0.5 0 0.4", "1.5 0.5 0.7 0.4", "from 0 to 0.7, but a packing .*dimension=3"),
    ("xyz", "1.5 0.5 0 ", "1.5 0.5 -1 ", "fill space, z goes from -1 to 0"),
    ("dump", "1.5 0.5", "nan 0.5", "x of atom 2 is nan"),
    ("dump", "2 2 1.5", "1 2 1.5", "atom 1 occurs twice"),
    ("dump", "0 0.4", "0 0", "radius of atom 2 is 0, which is no radius: give radii"),
    ("data", "2 2 0.8", "2 2 0", "diameter of atom 2 is 0, which is no radius"),
    ("dump", "radius", "c_size", r"no radii \(type, c_size\): give radii=0.5, .* name of a column"),
    ("dump", "2 2 1.5", "2 0 1.5", "type of atom 2 is 0: types count from 1"),
    ("dump", "2 2 1.5 0.5 0 0.4\n", "", "has 1 of 2 atoms"),
    ("dump", "0 0.4\n", "0 0.", "has 2 of 2 atoms, the last one maybe in part"),
    ("dump", "1.5 0.5 0 0.4", "1.5 0.5", "invalid column index"),
    ("dump", "x y z", "fx fy fz", "no positions, such as x and y, among its columns id type fx"),
    ("dump", "pp pp pp\n", "pp ff pp\n", "not periodic along y: give the walls there"),
    ("dump", "BOUNDS pp pp pp\n0 4", "BOUNDS abc origin pp pp pp\n4 0 0 0", "a general one"),
    ("dump", "pp\n0 4\n0 3\n-0.5 0.5", "pp\n0 4\n0 3", "bounds of its box are incomplete"),
    ("dump", "0 4\n", "0 nan\n", "its box has the bounds 0 nan"),
    ("dump", "0 4\n", "4 0\n", r"its box is \[\[-4.0"),
    (
        "dump",
        "pp pp pp\n0 4\n0 3\n-0.5 0.5",
        "xy xz yz pp pp pp\n0 4 0\n0 3 1\n-0.5 0.5 0",
        "but the plane of a packing has lattice vectors",
    ),
    ("dump", "ITEM: BOX", "ITEM: NO BOX", "no frame with ITEM: NUMBER OF ATOMS, BOX BOUNDS and"),
    ("data", "# sphere", "# ellipsoid", "has the style ellipsoid, and atomic, .* give a dump"),
    ("data", "# sphere", "", "does not name its style"),
    ("data", "2 2 0.8 1.0 1.5 0.5 0\n", "", "it has 1 of 2 atoms"),
    ("data", "2 atom types", "2 atom types\n4 0 0 avec\n0 3 0 bvec", "a general one"),
    ("data", "1 1 1.0", "1 small 1.0", "type small has no number: it lacks Atom Type Labels"),
    ("data", "Atoms #", "Atom Type Labels\n\n1 a\n\nAtoms #", "Type Labels lack type 2"),
    ("data", "0 3 ylo yhi", "", "no LAMMPS data file of a box"),
    ("xyz", "Lattice=", "Cell=", r"it has no box: give one, such as box=\(lx, ly\)"),
    ("xyz", "4 0 0", "4 0", "Lattice must be 9 numbers, not 8"),
    ("xyz", "pos:R:3", "force:R:3", "no pos:R:3 among its columns species force0"),
    ("xyz", 'Lattice="4', 'pbc="T F T" Lattice="4', "not periodic along y"),
    ("xyz", 'Lattice="4', 'pbc="T T" Lattice="4', "pbc must be three letters"),
    ("xyz", '0 0 0 1" P', "0 0 0 1 P", 'lattice="4 has no closing quotation mark'),
    ("xyz", "2\n", "two\n", "begins with the number of atoms, not 'two'"),
    ("xyz", "2\n", "3\n", "has 2 of 3 atoms"),
    ("xyz", XYZ, "0\na comment\n", "has no atoms"),
]


def written(folder: Path, kind: str, text: str) -> Path:
    path = folder / f"packing.{kind}"
    path.write_text(text)
    return path


@pytest.mark.parametrize("kind", TEXTS)
def test_the_files_are_good_before(kind: str, tmp_path: Path) -> None:
    found = Packing.from_file(written(tmp_path, kind, TEXTS[kind]))
    assert found.positions.tolist() == [[0.5, 0.5], [1.5, 0.5]]
    assert (found.radii.tolist(), found.box.tolist()) == ([0.5, 0.4], [[4.0, 0.0], [0.0, 3.0]])


@pytest.mark.parametrize("kind", TEXTS)
def test_bad_files(kind: str, tmp_path: Path) -> None:
    for _, old, new, message in (row for row in BAD if row[0] == kind):
        assert old in TEXTS[kind]
        path = written(tmp_path, kind, TEXTS[kind].replace(old, new, 1))
        with pytest.raises(ld.FileError, match=f"{path.name}' cannot be read: .*{message}") as e:
            Packing.from_file(path)
        assert "\n" not in str(e.value)


ARGUMENTS = [
    ({"radii": [0.5, 0.4]}, "radii must be of the kind float .*5, 0.4.$"),
    ({"radii": {1: 0.5, 2: -1.0}}, "radius of type 2 must be a positive number, not -1.0"),
    ({"radii": {1: 0.5}}, "it has particles of type 2, and radii has 1 only"),
    ({"radii": "size"}, r"it has no column size \(type, radius\)"),
    ({"frame": 1}, "it has 1 frames, and no frame 1: give 0"),
    ({"box": (4, -3)}, "box must be"),
    ({"topology": "conf.gro"}, "packing.dump' is a LAMMPS dump: leave it out"),
]


def test_bad_arguments(tmp_path: Path) -> None:
    for arguments, message in ARGUMENTS:
        path = written(tmp_path, "dump", DUMP)
        with refused(message, (ld.ParameterError, ld.FileError)):
            Packing.from_file(path, **arguments)  # type: ignore[arg-type]


def test_files_that_are_none(tmp_path: Path) -> None:
    for path, message in (
        (tmp_path, "is a folder: .*packing.data; in Python ld.Run has the states"),
        (tmp_path / "nowhere.data", "nowhere.data' cannot be read: No such file"),
        (written(tmp_path, "empty", ""), "packing.empty' is empty"),
        (written(tmp_path, "txt", "words"), "is no LAMMPS data file, .* table are for Packing"),
        (written(tmp_path, "pdb", "words"), "packing.pdb'.* cannot"),
    ):
        with pytest.raises(ld.FileError, match=message) as e:
            Packing.from_file(path)
        assert "\n" not in str(e.value)
    (tmp_path / "bytes.xyz").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ld.FileError, match=r"bytes.xyz' cannot be read: .*decode"):
        Packing.from_file(tmp_path / "bytes.xyz")


def test_half_a_gsd(tmp_path: Path, jammed: Packing) -> None:
    pytest.importorskip("gsd")
    jammed.export(tmp_path / "a.gsd")
    whole = (tmp_path / "a.gsd").read_bytes()
    (tmp_path / "half.gsd").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ld.FileError, match=r"half.gsd' cannot be read") as e:
        Packing.from_file(tmp_path / "half.gsd")
    assert "\n" not in str(e.value)


def test_without_gsd(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, jammed: Packing) -> None:
    monkeypatch.setitem(__import__("sys").modules, "gsd.hoomd", None)
    with pytest.raises(ImportError, match=r"pip install 'lammps-deformable\[gsd\]'"):
        jammed.export(tmp_path / "a.gsd")


def test_particles_outside_are_images(tmp_path: Path) -> None:
    path = written(tmp_path, "dump", DUMP.replace("1.5 0.5 0", "9.5 -2.5 0"))
    found = Packing.from_file(path)
    assert found.positions[1].tolist() == [9.5, -2.5]
    moved = found.positions[1] - np.array([1.5, 0.5])
    assert (moved @ np.linalg.inv(found.box)).tolist() == [2.0, -1.0]
    with pytest.raises(ld.ParameterError, match="boxes away: move it into the box"):
        Packing.from_file(written(tmp_path, "dump", DUMP.replace("1.5 0.5 0", "1e9 0.5 0")))
