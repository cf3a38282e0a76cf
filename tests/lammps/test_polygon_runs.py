"""The area term of bead polygons: which atoms, runs, minimizers, boxes, files, ranks."""

import numpy as np
import pytest
from parallel import (
    TILED,
    TWO,
    assert_atoms_change_ranks,
    assert_same,
    on_grids,
    report,
    reported,
)
from polygons import (
    ALONE,
    AREA,
    BOX,
    FIVE,
    HEADER,
    KA,
    MEASURE,
    REST,
    SEVEN,
    SPRINGS,
    Polygons,
    data_file,
    shoelace,
)

tilts = pytest.mark.parametrize("tilt", [0.0, 0.9], ids=["orthogonal", "tilted"])


# ---- who belongs to a polygon, and how ----


def test_other_atoms_are_left_alone():
    others = [(-1.0, 0.5), (0.0, -0.5)]
    commands = "group polygons molecule > 0\n" + REST.replace(" all ", " polygons ")
    polygons, alone = (
        Polygons(others=others, commands=commands, springs=ALONE),
        Polygons(commands=REST, springs=ALONE),
    )
    assert polygons.energy() == pytest.approx(alone.energy(), rel=1e-14)
    np.testing.assert_array_equal(polygons.force[:12], alone.force)
    np.testing.assert_array_equal(polygons.force[12:], 0)


def test_one_fix_a_kind_of_ring():
    commands = "group seven molecule 1\ngroup five molecule 2\n" + "".join(
        f"fix {name} {name} deformable/polygon {KA} rest 1.4\n" for name in ("seven", "five")
    )
    both = Polygons(commands=REST, springs=ALONE)
    polygons = Polygons(commands=commands, springs=ALONE)
    assert polygons.energy() == pytest.approx(both.energy(), rel=1e-14)
    np.testing.assert_array_equal(polygons.force, both.force)


def test_no_stiffness():
    """kA = 0 measures, and leaves springs and contacts alone."""
    polygons, springs = Polygons(commands=REST.replace("2.0", "0")), Polygons(commands="")
    assert polygons.energy() == springs.energy()
    np.testing.assert_array_equal(polygons.force, springs.force)
    assert polygons.table[0, 0] == pytest.approx(shoelace(SEVEN), rel=1e-14)


def test_energy_is_part_of_pe_unless_told_otherwise():
    polygons = Polygons(commands=REST)
    energy = polygons.energy()
    polygons.run("fix_modify area energy no")
    assert polygons.energy() == pytest.approx(energy - polygons.area_energy, rel=1e-14)
    assert polygons.area_energy > 0.1


def test_a_polygon_keeps_its_sense():
    """Inside out, its area is negative: in later runs and after a restart too."""
    polygons = Polygons([FIVE], springs=ALONE)
    polygons.energy()
    area = abs(shoelace(FIVE))
    mirrored = FIVE * [1, -1] + [0, -3.6]
    for _ in range(2):
        assert polygons.energy(mirrored) == pytest.approx(KA / 2 * (2 * area) ** 2, rel=1e-13)
    assert polygons.table[0, 0] == pytest.approx(-area, rel=1e-13)


# ---- runs, minimizers, boxes ----

MOVE = """
velocity all create 0.02 4711 loop all
velocity all set 0.4 0.3 NULL sum yes
fix move all nve
timestep 0.02
"""


@pytest.mark.parametrize(
    "commands",
    [
        "atom_modify sort 1 0.5\nrun 300",
        "run 150\nrun 0\nrun 0\nrun 150",
        "run 300 every 50 'print x'",
    ],
)
def test_order_of_beads_and_runs_do_not_matter(commands):
    reference, polygons = (Polygons(commands=REST + MOVE) for _ in range(2))
    reference.run("atom_modify sort 0 0.0\nrun 300")
    polygons.run(commands)
    assert not np.array_equal(reference.gather("image", 3, 0), Polygons().gather("image", 3, 0))
    # rounding of 1e-16 a step, that grows while polygons bump into each other
    np.testing.assert_allclose(polygons.x, reference.x, atol=1e-12)
    np.testing.assert_allclose(polygons.table, reference.table, atol=1e-12)


def test_minimisers_and_runs_agree():
    found = []
    for style in ("fire", "cg"):
        polygons = Polygons(commands=REST)
        start = polygons.energy()
        polygons.run(f"min_style {style}\nminimize 0 1e-10 20000 200000")
        energy, force, table = polygons.lmp.get_thermo("pe"), polygons.force, polygons.table
        assert energy < start - 0.1
        assert polygons.energy() == pytest.approx(energy, rel=1e-13)
        np.testing.assert_allclose(polygons.force, force, atol=1e-13)
        np.testing.assert_allclose(polygons.table, table, rtol=1e-13)
        found.append((energy, np.linalg.norm(force)))
    (fire, norm), (cg, _) = found
    assert norm < 1e-9
    assert cg == pytest.approx(fire, rel=1e-8)


def test_dynamics_conserves_energy_to_second_order():
    """One polygon without contacts, with a smooth energy: half the step, a quarter of the error."""
    errors = []
    for halves in (1, 2):
        polygons = Polygons([SEVEN], commands=REST + MOVE)
        polygons.run(f"timestep {0.02 / halves}\nrun 0")
        start, error = polygons.lmp.get_thermo("etotal"), 0.0
        for _ in range(100):
            polygons.run(f"run {halves} pre no post no")
            error = max(error, abs(polygons.lmp.get_thermo("etotal") - start))
        errors.append(error)
    assert errors[0] < 1e-2
    # the next order is (omega dt)^2 = 4 kL dt^2 = 0.5 % of it
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)


def test_change_of_box_between_runs():
    tilt = 0.9
    polygons = Polygons(tilt=tilt, springs=ALONE)
    polygons.energy()
    areas = np.abs([shoelace(SEVEN), shoelace(FIVE)])
    polygons.run(f"change_box all triclinic x scale 1.03 xy final {1.03 * tilt} remap")
    assert polygons.energy() == pytest.approx(KA / 2 * 0.03**2 * np.sum(areas**2), rel=1e-12)
    np.testing.assert_allclose(polygons.table[:, 0], 1.03 * areas, rtol=1e-14)
    np.testing.assert_allclose(polygons.table[:, 2], areas, rtol=1e-14)


def test_beside_fix_deform():
    """LAMMPS does not take it for a fix deform. Polygons stay whole when the box flips."""
    deform = "change_box all triclinic\nfix shear all deform 1 xy erate 1.0 remap x\n"
    far = np.array([0, 30 * BOX[1]])
    polygons = Polygons([SEVEN + far, FIVE - far], commands=AREA + deform, springs=ALONE)
    areas = polygons.table[:, 0]
    polygons.run("timestep 0.01\nrun 80")
    assert polygons.lmp.get_thermo("xy") < -1
    np.testing.assert_allclose(polygons.table[:, 0], areas, rtol=1e-13)
    centers = [outline.mean(axis=0) for outline in polygons.outlines]
    # the box has moved on since the last forces, by a strain of 0.01
    np.testing.assert_allclose(polygons.table[:, 3:], centers, atol=0.01 * BOX[1])


# ---- files ----


def from_restart(file, commands=AREA, springs=SPRINGS):
    polygons = Polygons([FIVE])
    polygons.run(
        f"clear\nread_restart {file}\ncomm_modify cutoff 1.6\n{springs}{MEASURE}{commands}"
    )
    polygons.sizes = [7, 5]
    return polygons


def test_restart_keeps_rest_areas(tmp_path):
    polygons = Polygons(commands=AREA + MOVE)
    polygons.run(f"run 0\nrun 50\nchange_box all x scale 1.05 remap\nwrite_restart {tmp_path}/file")
    energy = polygons.energy()
    again = from_restart(tmp_path / "file")
    assert again.energy() == pytest.approx(energy, rel=1e-13)
    np.testing.assert_array_equal(again.table[:, 2], polygons.table[:, 2])
    np.testing.assert_allclose(again.force, polygons.force, atol=1e-13)
    # told anew
    assert (from_restart(tmp_path / "file", REST).table[:, 2] == 1.4).all()


def test_restart_keeps_the_sense(tmp_path):
    polygons = Polygons(springs=ALONE)
    polygons.energy()
    energy = polygons.energy(np.vstack([SEVEN, FIVE * [1, -1] + [0, -3.6]]))
    polygons.run(f"write_restart {tmp_path}/file")
    assert energy > 1
    assert from_restart(tmp_path / "file", springs=ALONE).energy() == pytest.approx(energy)
    told = from_restart(tmp_path / "file", REST, ALONE)
    told.energy()
    assert told.table[1, 0] == pytest.approx(shoelace(FIVE))


# ---- ranks ----

STEPS = 0, 150
SCALARS = "pe c_virial[1] c_virial[2] c_virial[4] f_area[1][1] f_area[1][2] f_area[1][4]"
SCALARS += " f_area[2][1] f_area[2][2] f_area[2][5]"
PARALLEL = (
    "processors {grid}\n"
    + HEADER
    + "read_data {data}\n"
    + SPRINGS
    + MEASURE
    + REST
    + MOVE
    + "{balance}"
    + "".join(report(steps, SCALARS, "x y fx fy c_stress[1] c_stress[4]") for steps in STEPS)
)


@tilts
def test_ranks_and_grids(tilt, tmp_path):
    """Polygons are shared by ranks and their beads change them; virials are sums of either sign."""
    (tmp_path / "data").write_text(data_file([SEVEN, FIVE], tilt=tilt))
    grids = TWO if tilt else ("1 1 1", "2 2 1", TILED)
    folders = on_grids(PARALLEL, tmp_path, grids, data=tmp_path / "data")
    found = [reported(folders, steps) for steps in STEPS]
    for reports in found:
        assert_same(reports, atol=1e-14)
    assert_atoms_change_ranks(*found)
