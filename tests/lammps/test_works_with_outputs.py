"""Computes, files and ranks beside the pair styles."""

import numpy as np
import pytest
from combinations import Packing, assert_same
from lammps import LMP_STYLE_GLOBAL, LMP_STYLE_LOCAL, LMP_TYPE_ARRAY, LMP_TYPE_SCALAR
from laws import EXACT, two_laws
from parallel import atoms, finished
from scene import SPECIES
from turns import in_turn

NVE = "fix move all nve\n"


def evaluated(law, commands=""):
    packing = Packing(EXACT[law])
    packing.run(f"{commands}\nrun 0")
    return packing


def scalar(packing, compute):
    return packing.lmp.extract_compute(compute, LMP_STYLE_GLOBAL, LMP_TYPE_SCALAR)


# ---- computes ----


def test_per_atom_energies_and_stress():
    """Their sums are the energy, and the virial of compute pressure."""
    packing = evaluated(
        "balanced",
        "compute energy all pe/atom pair\ncompute total all reduce sum c_energy\n"
        "compute virial all pressure NULL pair\n"
        "thermo_style custom step pe c_total c_virial[1] c_virial[2] c_virial[4]",
    )
    results = packing.results()
    assert scalar(packing, "total") == pytest.approx(results["energy"], rel=1e-12)
    virial = packing.lmp.numpy.extract_compute("virial", LMP_STYLE_GLOBAL, 1)[[0, 1, 3]]
    volume = packing.lmp.get_thermo("vol")
    np.testing.assert_allclose(
        -virial * volume, packing.stress(), rtol=0, atol=1e-12 * np.abs(virial * volume).max()
    )


def test_numdiff():
    """fix numdiff finds the forces by differences of the energy."""
    packing = evaluated("balanced", "fix difference all numdiff 1 1e-5")
    found, expected = packing.atom("f_difference")[:, :2], packing.results()["force"]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-4 * np.abs(expected).max())


@two_laws
def test_dynamical_matrix(law, tmp_path):
    """Its rows are derivatives of forces; a shift of all particles has no force."""
    packing = evaluated(law)
    packing.run(f"dynamical_matrix all regular 1e-6 file {tmp_path / 'matrix'}")
    matrix = np.loadtxt(tmp_path / "matrix").reshape(72, 72)
    scale = np.abs(matrix).max()
    assert scale > 1e-3
    np.testing.assert_allclose(matrix, matrix.T, rtol=0, atol=1e-6 * scale)
    np.testing.assert_allclose(matrix[:, ::3].sum(1), 0, rtol=0, atol=1e-6 * scale)


@pytest.mark.parametrize("law", ["balanced", "curved"])
def test_born_matrix_by_differences(law):
    """Minus the derivative of the virial by a strain of the box, and twice the virial."""
    packing = evaluated(
        law,
        "compute virial all pressure NULL virial\n"
        "compute born all born/matrix numdiff 1e-5 virial\n"
        "thermo_style custom step pe c_virial[1] c_born[1]",
    )
    born, volume = packing.lmp.extract_compute("born", 0, 1)[0], packing.lmp.get_thermo("vol")

    def virial():
        return packing.lmp.extract_compute("virial", 0, 1)[0] * packing.lmp.get_thermo("vol")

    here, step, found = virial(), 1e-5, []
    for scale in (1 + step, (1 - step) / (1 + step)):
        packing.run(f"change_box all x scale {scale!r} remap\nrun 0")
        found.append(virial())
    slope = (found[0] - found[1]) / (2 * step)
    assert born == pytest.approx(2 * here - slope, rel=1e-3)
    assert born > 0.01 * volume


def test_contacts_of_circles():
    """compute contact/atom counts overlaps of circles, the pair style outlines that touch."""
    packing = Packing(EXACT["balanced"], atoms="sphere 1")
    packing.run(
        "compute circles all contact/atom\ncompute number all reduce sum c_circles\n"
        f"fix outlines all pair 1 {EXACT['balanced'].split()[0]} contacts 0\n"
        "compute contacts all deformable/contact\n"
        "thermo_style custom step pe c_number\nrun 0"
    )
    number = np.sum(packing.lmp.gather("f_outlines", 1, 1))
    rows = packing.lmp.numpy.extract_compute("contacts", LMP_STYLE_LOCAL, LMP_TYPE_ARRAY)
    assert number == len(rows)
    assert scalar(packing, "number") != number


@pytest.mark.parametrize(
    ("law", "line"), in_turn(["radical", "balanced", "curved"], ["quadratic", "forcezero"])
)
def test_pressures_of_box_relax(law, line):
    """With these line searches cg reaches them; backtrack may not."""
    packing = Packing(EXACT[law])
    packing.run(
        f"min_style cg\nmin_modify line {line} dmax 0.002\n"
        "compute virial all pressure NULL virial\nthermo_style custom step pe c_virial\n"
        "fix box all box/relax iso 2e-3 vmax 1e-3\nminimize 0 1e-9 2000 4000"
    )
    assert scalar(packing, "virial") == pytest.approx(2e-3, rel=1e-6)


def test_reduce_of_contacts():
    """compute reduce takes rows of contacts with `inputs local`."""
    packing = evaluated(
        "balanced",
        "compute contacts all deformable/contact\n"
        "compute force all reduce sum c_contacts[5] inputs local\n"
        "compute largest all reduce max c_contacts[5] inputs local\n"
        "fix histogram all ave/histo 1 1 1 0 0.1 10 c_contacts[5] mode vector kind local\n"
        "thermo_style custom step pe c_force c_largest",
    )
    rows = packing.lmp.numpy.extract_compute("contacts", LMP_STYLE_LOCAL, LMP_TYPE_ARRAY)
    assert scalar(packing, "force") == pytest.approx(rows[:, 4].sum(), rel=1e-12)
    assert scalar(packing, "largest") == rows[:, 4].max() > 0
    assert packing.lmp.extract_fix("histogram", LMP_STYLE_GLOBAL, 1, 0) == len(rows)
    with pytest.raises(Exception, match="per-atom"):
        packing.run("compute wrong all reduce sum c_contacts[5]")


def test_neighborhoods():
    """Computes that use positions only."""
    packing = evaluated(
        "balanced",
        "compute near all coord/atom cutoff 1.4\ncompute mean all reduce ave c_near\n"
        "compute distances all rdf 20\ncompute moved all msd\n"
        "fix distances all ave/time 1 1 1 c_distances[*] mode vector\n"
        "thermo_style custom step pe c_mean c_moved[4]",
    )
    assert 4 < scalar(packing, "mean") < 7


# ---- files ----


def test_rerun(tmp_path):
    packing = Packing(EXACT["balanced"])
    packing.run(
        f"dump frames all custom 50 {tmp_path / 'dump'} id type x y z\n"
        f"dump_modify frames format float %.17g\n{NVE}run 200"
    )
    expected = packing.results()
    packing.run("velocity all set 0 0 0\ndisplace_atoms all random 0.01 0.01 0 1\nrun 0")
    packing.run(f"rerun {tmp_path / 'dump'} dump x y")
    assert_same(packing.results(), expected)


def test_read_dump(tmp_path):
    packing = Packing(EXACT["balanced"])
    packing.run(
        f"{NVE}run 100\nwrite_dump all custom {tmp_path / 'dump'} id type x y z vx vy "
        "modify format float %.17g"
    )
    expected = packing.results()
    packing.run(f"run 100\nread_dump {tmp_path / 'dump'} 100 x y vx vy\nrun 0")
    assert_same(packing.results(), expected)


# ---- ranks ----

GRIDS = {
    "processors": ("processors 1 2 1", ""),
    "balance": ("", "balance 1.0 shift xy 10 1.05"),
    "comm_style tiled": ("comm_style tiled", "balance 1.0 rcb"),
    "fix balance": ("comm_style tiled", "fix b all balance 20 1.0 rcb"),
}
SCRIPT = f"""
units lj
dimension 2
newton on
atom_modify map yes
{{before}}
read_data data
pair_style {{style}}
pair_coeff * * {SPECIES} small large
neighbor 0.1 bin
neigh_modify every 1 delay 0 check yes
{{after}}
fix move all nve
velocity all set 0.5 0.3 0 sum yes
timestep 0.05
run 20
write_dump all custom out id x y fx fy modify sort id format float %.17g
"""


def test_two_ranks(tmp_path):
    """Particles cross the borders of ranks; positions and forces are those of one rank."""
    style = EXACT["balanced"]
    Packing(style).run(f"write_data {tmp_path / 'data'} nofix")

    def run(ranks, before, after):
        script = SCRIPT.format(style=style, before=before, after=after)
        finished(ranks, script, tmp_path)
        return atoms(tmp_path / "out")

    expected = run(1, "", "")
    for name, (before, after) in GRIDS.items():
        found = run(2, before, after)
        for columns in (slice(1, 3), slice(3, 5)):
            scale = 1e-9 * np.abs(expected[:, columns]).max()
            np.testing.assert_allclose(
                found[:, columns], expected[:, columns], rtol=0, atol=scale, err_msg=name
            )
