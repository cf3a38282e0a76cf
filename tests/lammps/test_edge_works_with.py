"""Other commands of LAMMPS beside pair style deformable/edge.

After each command the energy is that of a sum over all vertices and edges at their present places.
"""

import numpy as np
import pytest
from polygons import lattice
from smooth_polygons import AREAS, DATA, EXCLUDE, KR, PAIR, C, expected_energy, of_contacts, packing

MOVE = "fix move all nve\n"
DISPLACE = "displace_atoms all random 0.001 0.001 0 7"
HEAT = "temp 1e-4 1e-4 1"
SCENE = """
velocity all create 1e-4 4711 loop all
velocity all set 0.5 0.4 NULL sum yes
timestep 0.02
"""

COMMANDS = {
    "fix nve": MOVE,
    "fix nve/limit": "fix move all nve/limit 0.01",
    "fix nvt": f"fix move all nvt {HEAT}",
    "fix npt": f"fix move all npt {HEAT} iso 5e-4 5e-4 1.0",
    "fix npt, tilted": f"change_box all triclinic\nfix move all npt {HEAT} x 5e-4 5e-4 1 xy 0 0 1",
    "fix langevin": MOVE + "fix bath all langevin 1e-4 1e-4 1 7\nfix plane all enforce2d",
    "fix deform": MOVE + "fix box all deform 1 x erate -0.005 y erate 0.002 remap x",
    "fix deform, flips": MOVE + "fix box all deform 1 xy erate -0.01 remap x",
    "fix nvt/sllod": f"fix move all nvt/sllod {HEAT}\nfix box all deform 1 xy erate 0.01 remap v",
    "fix balance": f"comm_style tiled\n{MOVE}fix balance all balance 10 1.0 rcb",
    "fix setforce": MOVE + "group some id 1:50\nfix hold some setforce 0.01 NULL NULL",
    "fix box/relax": "min_style cg\nfix box all box/relax iso 1e-4\nminimize 0 1e-6 100 200",
    "change_box": "change_box all x scale 0.999 y scale 1.001 remap",
    "change_box, tilted": "change_box all triclinic xy delta 0.01 remap",
    "displace_atoms": DISPLACE,
    "neighbor nsq": "neighbor 0.05 nsq\n" + MOVE,
    "neighbor multi": "neighbor 0.05 multi\n" + MOVE,
    "atom_modify sort": "atom_modify sort 5 0.5\n" + MOVE,
    "run every": MOVE + "run 30 every 10 NULL\nrun 20 pre no",
    "pair_modify": "pair_modify shift yes mix arithmetic nofdotr\n" + MOVE,
    "minimize": DISPLACE + "\nmin_style quickmin\nminimize 0 1e-9 50 100",
}


@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS)
def test_works_with(command):
    # a tilt by a whole box length has the same images, and flips at once
    tilt = DATA["box"][0] if "deform 1 xy" in command else 0.0
    polygons = packing("relaxed", tilt=tilt, commands=EXCLUDE + AREAS + PAIR + SCENE)
    polygons.energy()
    before, start = of_contacts(polygons), polygons.outlines
    polygons.run(command + "\nrun 100")
    polygons.energy()
    if tilt:
        assert abs(polygons.lmp.get_thermo("xy")) < 0.51 * tilt
    cell = lattice(
        [polygons.lmp.get_thermo(key) for key in ("lx", "ly")], polygons.lmp.get_thermo("xy")
    )
    expected = expected_energy(polygons.outlines, cell, lambda *_: (KR, C))
    assert of_contacts(polygons) == pytest.approx(expected, rel=1e-9)
    # something has happened
    assert abs(expected / before - 1) > 1e-6
    assert np.abs(np.vstack(polygons.outlines) - np.vstack(start)).max() > 1e-6


def test_replicate():
    polygons = packing("kicked", commands=EXCLUDE)
    energy = polygons.energy()
    polygons.run("replicate 2 3 1 bbox")
    assert polygons.energy() == pytest.approx(6 * energy, rel=1e-12)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("compute a all pair/local dist force", "compute pair/local"),
        (
            "group a type 1\ngroup b type 2\ncompute ab a group/group b\nthermo_style custom c_ab",
            "compute group/group",
        ),
        (
            "compute a all centroid/stress/atom NULL pair\ndump d all custom 1 /dev/null c_a[1]",
            "centroid/stress/atom",
        ),
        ("compute a all born/matrix\nthermo_style custom step c_a[1]", "born"),
        ("run_style respa 2 2 bond 1 inner 1 0.2 0.3 outer 2", "respa|inner"),
    ],
)
def test_refused(command, message):
    polygons = packing("relaxed", commands=EXCLUDE)
    with pytest.raises(Exception, match=f"(?i)ERROR.*({message})"):
        polygons.run(command + "\nrun 0")
