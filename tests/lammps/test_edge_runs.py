"""Contacts of vertices with edges in LAMMPS: dynamics, lists, files, ranks, other styles."""

import numpy as np
import pytest
from parallel import (
    TILED,
    assert_atoms_change_ranks,
    assert_same,
    on_grids,
    report,
    reported,
)
from polygons import MEASURE, data_file
from smooth_polygons import (
    AREAS,
    CONTACTS,
    DATA,
    EXCLUDE,
    FIRST,
    HEADER,
    NO_SPRINGS,
    PAIR,
    SPRINGS,
    TWO,
    centered,
    expected_of_two,
    of_contacts,
    packing,
    two_polygons,
)

# The fastest frequency is sqrt(4 kL + 4 kr) = 32.
MOVE = "fix move all nve\ntimestep {timestep}\nthermo 0\n"


# ---- dynamics ----


def drift(timestep):
    """Largest change of the energy of a kicked packing in a time of 1, by steps of this length."""
    polygons = packing("kicked", commands=EXCLUDE + AREAS + MOVE.format(timestep=timestep))
    energies = []
    polygons.run("run 0\nthermo_style custom step etotal\nthermo_modify norm no")
    for _ in range(20):
        polygons.run(f"run {round(0.05 / timestep)}")
        energies.append(polygons.lmp.get_thermo("etotal"))
    return np.ptp([*energies, 0.7535589266775777])  # at rest, in smooth_packing.json


def test_energy_is_conserved():
    """To second order in the time step, while contacts open and close."""
    coarse, fine = drift(0.005), drift(0.0025)
    assert coarse < 1e-2 * 0.75
    assert coarse / fine == pytest.approx(4, rel=0.25)


def moved(neigh_modify):
    polygons = packing("kicked", commands=EXCLUDE + AREAS + MOVE.format(timestep=0.005))
    polygons.run("velocity all create 5e-4 4711 loop all\n" + neigh_modify)
    polygons.run("run 400")
    return polygons


def test_contacts_between_neighbor_lists():
    """None is missed that opens while the list is in use."""
    every = moved("neigh_modify every 1 delay 0 check no")
    few = moved("neigh_modify every 1 delay 0 check yes\nneighbor 0.06 bin")
    sorted_anew = moved("atom_modify sort 7 0.5")
    for polygons in few, sorted_anew:
        # rounding of 1e-15 a step, that grows
        np.testing.assert_allclose(polygons.x, every.x, atol=1e-10)
    np.testing.assert_allclose(few.force, every.force, atol=1e-8)


@pytest.mark.parametrize(("style", "force"), [("fire", 1e-3), ("cg", 5e-3)])
def test_minimizers(style, force):
    """A kicked packing relaxes toward the state it was kicked from; cg ends by its line search."""
    polygons = packing("kicked", commands=EXCLUDE + AREAS + PAIR)
    polygons.run(
        f"min_style {style}\ntimestep 0.01\nmin_modify dmax 0.005\nminimize 0 1e-7 1500 3000"
    )
    assert np.abs(polygons.force).max() < force
    assert 6.63e-5 < polygons.energy() < 1e-4
    assert of_contacts(polygons) > 0


def test_minimum():
    """The energy and the places of the relaxed packing, from which it was kicked."""
    polygons = packing("relaxed", commands=EXCLUDE + AREAS)
    before = polygons.energy()
    polygons.run("min_style fire\ntimestep 0.02\nminimize 0 1e-10 1000 1000")
    assert polygons.energy() == pytest.approx(before, rel=1e-10)


# ---- files ----


def continued(polygons, start, commands):
    """A second instance, started from a file by `start`."""
    polygons.lmp.commands_string("clear\nlog none\n")
    polygons.lmp.commands_string(start)
    polygons.run(commands + MEASURE)
    return polygons


def test_restart(tmp_path):
    """Settings and coefficients are in restart files."""
    pair = TWO + "pair_coeff 1 1 2.0 0.14\n"
    polygons = two_polygons(pair=pair)
    energy, force = polygons.energy(), polygons.force
    assert energy == pytest.approx(expected_of_two(kr=2.0, c=0.14), rel=1e-13)
    polygons.run(f"write_restart {tmp_path}/file")
    again = continued(polygons, f"read_restart {tmp_path}/file", NO_SPRINGS)
    assert again.energy() == pytest.approx(energy, rel=1e-14)
    np.testing.assert_allclose(again.force, force, atol=1e-15)


@pytest.mark.parametrize(("option", "commands"), [("ii", "pair_coeff 1 2 1.0 0.06\n"), ("ij", "")])
def test_data_file(option, commands, tmp_path):
    """Coefficients are in data files; those of unlike types with `pair ij`."""
    pair = CONTACTS.splitlines()[0] + "\n"
    coefficients = "pair_coeff 1 1 10 0.05\npair_coeff 1 2 1.0 0.06\npair_coeff 2 2 7.0 0.04\n"
    polygons = packing("kicked", pair=pair + coefficients, commands=EXCLUDE + AREAS)
    energy = polygons.energy()
    polygons.run(f"write_data {tmp_path}/data pair {option} nofix")
    start = HEADER + pair + f"bond_style harmonic\nread_data {tmp_path}/data\n"
    # bond_style harmonic writes 6 digits
    again = continued(polygons, start, SPRINGS + EXCLUDE + AREAS + commands)
    assert again.energy() == pytest.approx(energy, rel=1e-10)  # 16 digits in the file


def test_rerun(tmp_path):
    """Contacts are those of each snapshot, however far apart."""
    polygons = two_polygons()
    polygons.energy()
    x, energies = polygons.x, []
    for step, shift in enumerate([0.5, 0.0, 0.02, -0.01]):
        moved = x + shift * np.array([1.0, 0.0]) * (np.arange(len(x)) >= len(FIRST))[:, None]
        polygons.run(f"reset_timestep {step}")
        energies.append(polygons.energy(moved))
        dump = f"write_dump all custom {tmp_path}/{step} id x y ix iy modify format float %.17g"
        polygons.run(dump)
    files = " ".join(f"{tmp_path}/{step}" for step in range(4))
    polygons.run(
        "thermo_style custom step pe\nthermo_modify norm no format float %.17g\nthermo 1\n"
        f"log {tmp_path}/log\nrerun {files} dump x y ix iy\nlog none"
    )
    lines = (tmp_path / "log").read_text().split("PotEng")[1].splitlines()[1:5]
    found = np.array([float(line.split()[1]) for line in lines])
    np.testing.assert_allclose(found, energies, rtol=1e-12)
    assert found[0] == 0 < found[1]


# ---- other styles and atoms ----


def test_hybrid():
    """Polygons among other atoms, which another style pushes away from them."""
    others, pushed = [(-1.0, -0.9), (0.9, 0.75)], "pair_coeff * 2 harmonic/cut 4.0 0.5\n"
    pair = "pair_style hybrid deformable/edge 0.4 harmonic/cut\n" + pushed
    both = two_polygons(
        others=others, other_type=2, pair=pair + "pair_coeff 1 1 deformable/edge 3.0 0.15\n"
    )
    pair = "pair_style hybrid harmonic/cut zero 0.5\npair_coeff 1 1 zero\n" + pushed
    alone = two_polygons(others=others, other_type=2, pair=pair)
    expected = expected_of_two()
    assert both.energy() == pytest.approx(expected + alone.energy(), rel=1e-13)
    assert of_contacts(both) == pytest.approx(expected, rel=1e-13)
    assert alone.energy() > 0.1


def test_hybrid_overlay():
    """Other contacts of the same atoms, with a larger cutoff."""
    overlay = "pair_style hybrid/overlay deformable/edge 0.4 harmonic/cut\n"
    overlay += "pair_coeff * * deformable/edge 3.0 0.15\npair_coeff * * harmonic/cut 0.2 0.9\n"
    alone = two_polygons(pair="pair_style harmonic/cut\npair_coeff * * 0.2 0.9\n")
    edges, both = two_polygons(), two_polygons(pair=overlay)
    energy = alone.energy() + edges.energy()
    assert both.energy() == pytest.approx(energy, rel=1e-13)
    np.testing.assert_allclose(both.force, alone.force + edges.force, atol=1e-13)
    assert of_contacts(both) == pytest.approx(expected_of_two(), rel=1e-13)


@pytest.mark.parametrize(
    "command",
    [
        "neigh_modify exclude molecule/inter all",
        "neigh_modify exclude group first second",
        "atom_modify first first\nneigh_modify include first",
        "pair_coeff * * 0 0.15",
    ],
)
def test_contacts_of_whole_polygons_may_be_left_out(command):
    groups = "group first molecule 1\ngroup second molecule 2\n"
    assert two_polygons(commands=groups + command + "\n").energy() == 0


def test_ghost_cutoff_is_set(tmp_path):
    """c + 2 l + skin, unless the user's is larger."""
    polygons = two_polygons()
    polygons.run(f"log {tmp_path}/log")
    polygons.energy()
    assert "ghost cutoff set to 0.97" in (tmp_path / "log").read_text()
    polygons.run(f"log {tmp_path}/larger\ncomm_modify cutoff 1.2")
    polygons.energy()
    assert "ghost cutoff set" not in (tmp_path / "larger").read_text()


def test_polygons_that_vanish():
    """Between runs, and in a run."""
    polygons = two_polygons()
    polygons.energy()
    polygons.run("group second molecule 2\ndelete_atoms group second bond yes")
    assert polygons.energy() == 0
    polygons = two_polygons()
    polygons.run(
        "region all block EDGE EDGE EDGE EDGE EDGE EDGE\ngroup second molecule 2\n"
        "fix out second evaporate 2 17 all 1 molecule yes\nfix move all nve\ntimestep 1e-3\nrun 3"
    )
    assert polygons.lmp.get_natoms() == len(FIRST)
    assert polygons.lmp.get_thermo("pe") == 0


# ---- ranks ----

STEPS = 0, 20
SCALARS = "pe c_virial[1] c_virial[2] c_virial[4]"

SCRIPT = (
    "processors {grid}\n"
    + HEADER
    + "read_data {data}\n"
    + CONTACTS
    + SPRINGS
    + MEASURE
    + EXCLUDE
    + AREAS
    + "compute each all pe/atom pair\n"
    + MOVE.format(timestep=0.005)
    + "velocity all create 5e-4 4711 loop all\nvelocity all set 3 2 NULL sum yes\n{balance}"
    + "".join(report(steps, SCALARS, "x y fx fy c_each c_stress[1] c_stress[4]") for steps in STEPS)
)
CASES = {0.0: ("1 1 1", "2 2 1", TILED), DATA["box"][0]: ("1 1 1", "2 1 1")}


@pytest.mark.parametrize("tilt", CASES, ids=["orthogonal", "tilted"])
def test_ranks_and_grids(tilt, tmp_path):
    """Polygons are shared by ranks and their vertices change them."""
    kinds = [kind + 1 for kind in DATA["species"]]
    data = tmp_path / "data"
    data.write_text(data_file(centered("kicked"), DATA["box"], tilt, types=kinds))
    folders = on_grids(SCRIPT, tmp_path, CASES[tilt], data=data)
    found = [reported(folders, steps) for steps in STEPS]
    for reports in found:
        assert_same(reports, atol=1e-12)
    assert_atoms_change_ranks(*found)
