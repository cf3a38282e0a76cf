"""Keywords of pair_style deformable/ring for its contacts, and the messages about balance."""

import numpy as np
import pytest
from balanced import DEFAULT, of_compute_pair
from lammps import lammps
from scene import HEADER, PACKINGS, SPECIES, Scene
from test_refusals import refuses
from test_soft_rings import mixture, pushed


@pytest.mark.parametrize("words", ["contact balanced", "reach 0.6", "balance 1e-8 1000"])
def test_default(words):
    """Without keywords: contact balanced, balance 1e-8 1000, reach 0.6."""
    states = [
        mixture(PACKINGS[0], style)[0].evaluate()
        for style in ("deformable/ring", f"deformable/ring {words}", DEFAULT)
    ]
    assert states[0].energy == states[1].energy == states[2].energy
    assert states[0].bulge == states[1].bulge == states[2].bulge


def test_too_few_evaluations_warn_once(tmp_path):
    log = tmp_path / "log"
    scene = mixture(PACKINGS[0], "deformable/ring contact balanced balance 1e-8 2", log=log)[0]
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


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("contact flat", "contact 'flat'"),
        ("contact", "contact command: missing argument"),
        ("contact balanced balance 0 100", "tolerance 0 "),
        ("contact balanced balance nan 100", "tolerance nan|Expected floating point"),
        ("contact balanced balance 1e-8 0", "balance: 0 "),
        ("contact balanced balance 1e-8 1", "balance: 1 "),
        ("contact balanced balance 1e-8", "missing argument"),
        ("contact radical balance 1e-8 100", "balance is for 'contact balanced'"),
        ("balance 1e-8 100 contact radical", "balance is for 'contact balanced'"),
        ("tolerance 1", "Unknown .*'tolerance'"),
    ],
)
def test_bad_words(words, message):
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(HEADER.format(boundary="p p p"))
    with refuses(message):
        lmp.command(f"pair_style deformable/ring {words}")


@pytest.mark.parametrize("x", [0.38, 0.38729833462074187])
def test_contact_line_behind_a_center(x):
    """Also where the distance is sqrt(0.8^2 - 0.7^2) up to its last bit."""
    places = np.array([[0.0, 0.0], [x, 0.0]])
    with refuses("contact line .*atoms 2 and 1.*center of atom 2.*0.38"):
        Scene(places, ["any", "large"], (-3, 3, -3, 3), DEFAULT).energy()


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


@pytest.mark.parametrize("law", ["balanced", "tilted"])
def test_the_default_reach_is_enough_for_a_start_from_a_lattice(law):
    """Two species at random on a lattice that is too dense for the larger ones: 0.3 stops it."""
    k, m = np.meshgrid(np.arange(6), np.arange(6), indexing="ij")
    x = np.column_stack([k.ravel(), m.ravel()]) * 1.0
    rng = np.random.default_rng(3)
    x += rng.uniform(-0.2, 0.2, x.shape)
    kinds = rng.permutation(["small", "large"] * 18)
    box = (0.0, 6.0, 0.0, 6.0)
    minimize = "min_style fire\ntimestep 0.01\nminimize 0 1e-8 500 1000"
    with pytest.raises(Exception, match="use a reach of 0"):
        Scene(x, kinds, box, f"deformable/ring contact {law} reach 0.3").run(minimize)
    scene = Scene(x, kinds, box, f"deformable/ring contact {law}")
    scene.run(minimize)
    assert scene.energy() > 0.0
