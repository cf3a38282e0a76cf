"""Droplets in three dimensions on several ranks."""

import pytest
from droplets import CASES, STRESS, dense, sheared, species
from parallel import FEW, TWO, assert_atoms_change_ranks, assert_same, on_grids, report, reported

SCRIPT = """
units lj
atom_modify map yes
processors {grid}
box tilt large
region box prism 0 {box[0]} 0 {box[1]} 0 {box[2]} 0.3 -0.2 0.1
create_box 2 box
{atoms}
mass * 1.0
{balance}
pair_style deformable/droplet balance 1e-12 100
{coeff}
neighbor 0.2 bin
compute stress all stress/atom NULL virial
fix shape all pair 1 deformable/droplet pressure 0 load 0
compute contact all deformable/contact
compute contacts all reduce sum c_contact[5] c_contact[3] inputs local
thermo_style custom step pe press pxx pyy pzz pxy pxz pyz c_contacts[*]
thermo_modify norm no
"""
COLUMNS = "x y z fx fy fz f_shape[1] f_shape[2] c_stress[1] c_stress[4]"


def script(number, folder, tilt=(0.3, -0.2, 0.1)):
    case = CASES[number]
    types, coeff = species(case, folder / "species.deformable")
    rows = sheared(case, tilt).tolist()
    atoms = [
        f"create_atoms {kind} single {x:.17g} {y:.17g} {z:.17g}"
        for kind, (x, y, z) in zip(types, rows, strict=True)
    ]
    return {"atoms": "\n".join(atoms), "coeff": coeff, "box": case["box"]}


@pytest.mark.parametrize("number", [2, 3])
def test_ranks(number, tmp_path):
    """Droplets that touch several images of others on other ranks, at rest and after a run."""
    scalars = " ".join(["pe", "press", *STRESS, "c_contacts[1]", "c_contacts[2]"])
    commands = SCRIPT + report(0, scalars, COLUMNS)
    commands += "velocity all create 0.02 5 loop geom\nvelocity all set 1.0 0.7 0.4 sum yes\n"
    commands += "fix move all nve\ntimestep 0.03\n"
    commands += report(30, scalars, COLUMNS)
    folders = on_grids(commands, tmp_path, FEW if number == 3 else TWO, **script(number, tmp_path))
    before, after = (reported(folders, steps) for steps in (0, 30))
    assert_same(before, 1e-10)
    assert_same(after, 1e-9)
    assert_atoms_change_ranks(before, after)


@pytest.mark.parametrize("number", [2, 3])
def test_stored_packings(number, tmp_path):
    """Energy and forces are those of the dense solution, which knows all images, on any ranks."""
    commands = SCRIPT.replace("prism", "block").replace("0.3 -0.2 0.1", "")
    commands += report(0, "pe press", "fx fy fz")
    fields = script(number, tmp_path, (0, 0, 0))
    energy, force, _ = dense(CASES[number])
    for scalars, rows in reported(on_grids(commands, tmp_path, FEW, **fields), 0).values():
        assert scalars[0] == pytest.approx(energy, rel=1e-10)
        assert rows[:, 2:] == pytest.approx(force, abs=1e-8)
