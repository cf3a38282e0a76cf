"""Each per-atom and local array of the styles is the same to all commands that read arrays.

Some read them by the pointers to rows (dump, compute reduce), others by the place of the first
number and the number of columns (variables, fix ave/histo, the Python module).
"""

import numpy as np
import pytest
from lammps import (
    LMP_STYLE_ATOM,
    LMP_STYLE_LOCAL,
    LMP_TYPE_ARRAY,
    LMP_TYPE_VECTOR,
    lammps,
)
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

SCENE = """
units lj
dimension {dimension}
atom_style sphere
atom_modify map yes
comm_modify vel yes
region box block 0 4 0 4 {depth}
create_box 1 box
create_atoms 1 random 12 4711 box overlap 0.95 maxtry 1000
set group all diameter 1.2
set group all mass 1.0
pair_style {style}
pair_coeff * * {species} drop
fix array_propel all deformable/propel 0.5 5.0 4711
fix array_rub all deformable/friction 0.3 10.0 0.1 film 0.1 1.0
fix array_shape all pair 1 {style} {results} 0
compute array_contacts all deformable/contact
{more}
fix move all nve
timestep 0.001
thermo_modify norm no
"""
SCENES = {
    "plane": dict(
        dimension=2,
        depth="-0.5 0.5",
        style="deformable/ring",
        results="area 0 pressure 0 contacts",
        more="compute array_lines all deformable/outline points 20",
    ),
    "space": dict(
        dimension=3,
        depth="0 4",
        style="deformable/droplet",
        results="area 0 pressure 0 load",
        more="",
    ),
}
ARRAYS = (
    ("plane", "f_array_propel", "atom", 2),
    ("space", "f_array_propel", "atom", 3),
    ("plane", "f_array_shape", "atom", 3),
    ("space", "f_array_shape", "atom", 3),
    ("plane", "f_array_rub", "local", 13),
    ("space", "f_array_rub", "local", 22),
    ("plane", "c_array_contacts", "local", 15),
    ("space", "c_array_contacts", "local", 21),
    ("plane", "c_array_lines", "local", 8),
)


def readers(name, kind, columns, folder):
    """Commands that read the columns of an array, and write what they see at each step."""
    words = "peratom" if kind == "atom" else kind
    entries = [f"{name}[{k + 1}]" for k in range(columns)]
    lines = [
        f"compute {how} all reduce {how} {' '.join(entries)} inputs {words}"
        for how in ("min", "max")
    ]
    lines += [
        f"fix histo{k} all ave/histo 1 1 1 -1e6 1e6 1 {entry} mode vector kind {words}"
        for k, entry in enumerate(entries)
    ]
    if kind == "local":
        lines.append(f"dump rows all local 1 {folder}/rows.* {' '.join(entries)}")
        lines.append("dump_modify rows format float %.17g")
    else:
        lines += [f"variable v{k} atom {entry}" for k, entry in enumerate(entries)]
        variables = " ".join(f"v_v{k}" for k in range(columns))
        lines.append(f"dump rows all custom 1 {folder}/rows.* {' '.join(entries)} {variables} id")
        lines.append("dump_modify rows format float %.17g sort id")
    lines.append("thermo_style custom step c_min[*] c_max[*]\nthermo 1")
    return "\n".join(lines)


def seen_by_python(lmp, name, kind, columns):
    """By the Python module as one block of memory; where rows have IDs also by gather."""
    extract = lmp.numpy.extract_fix if name[0] == "f" else lmp.numpy.extract_compute
    style = LMP_STYLE_ATOM if kind == "atom" else LMP_STYLE_LOCAL
    block = np.array(extract(name[2:], style, LMP_TYPE_ARRAY))
    if kind == "local":
        return [block]
    order = np.argsort(lmp.numpy.extract_atom("id")[: lmp.extract_setting("nlocal")])
    gathered = np.array(lmp.gather(name, 1, columns)).reshape(-1, columns)
    return [block[: len(order)][order], gathered]


@pytest.mark.parametrize(("where", "name", "kind", "columns"), ARRAYS)
def test_all_readers_see_the_same(where, name, kind, columns, tmp_path):
    species = tmp_path / "species"
    species.write_text("drop 0.6 inf 0 tension 1.0\n")
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(SCENE.format(species=species, **SCENES[where]))
    lmp.commands_string(f"{readers(name, kind, columns, tmp_path)}\nrun 3")
    seen = np.loadtxt(tmp_path / "rows.3", skiprows=9, ndmin=2)
    rows = seen[:, :columns]
    assert len(rows) > 3
    assert np.ptp(rows, axis=0).max() > 0.1
    for block in seen_by_python(lmp, name, kind, columns):
        np.testing.assert_array_equal(block, rows)
    if kind == "atom":
        np.testing.assert_array_equal(seen[:, columns : 2 * columns], rows)  # variables
    for k, column in enumerate(rows.T):
        of_histogram = [lmp.extract_fix(f"histo{k}", 0, 1, n) for n in (2, 3)]
        of_reduce = [lmp.extract_compute(how, 0, LMP_TYPE_VECTOR)[k] for how in ("min", "max")]
        assert of_histogram == of_reduce == [column.min(), column.max()]
