"""Contacts of vertices with edges in LAMMPS: energy, forces, virial, images, kinds of polygons."""

import numpy as np
import pytest
from polygons import lattice
from smooth_polygons import (
    AREAS,
    BOX,
    CONTACTS,
    DATA,
    EXCLUDE,
    FIRST,
    PAIR,
    SECOND,
    STATES,
    TILT,
    TWO,
    centered,
    expected_energy,
    expected_of_two,
    of_contacts,
    packing,
    two_polygons,
)

tilts = pytest.mark.parametrize("tilt", [0.0, TILT], ids=["orthogonal", "tilted"])
states = pytest.mark.parametrize("state", STATES)
# Half of the spacing of numbers up to 4 and 16, and what that makes of the two springs of a vertex
ULP, FAR_ULP = 4.4e-16, 1.8e-15 / 2
ROUNDING, FAR_ROUNDING = (4 * max(DATA["kL"]) * ulp for ulp in (ULP, FAR_ULP))


# ---- a packing computed elsewhere ----


@states
def test_packing(state):
    """Energies by term, forces and stress of smooth_packing.json."""
    polygons, expected = packing(state, commands=EXCLUDE + AREAS + PAIR), STATES[state]
    energy = polygons.energy()
    assert energy == pytest.approx(expected["energy"], rel=1e-9)
    assert of_contacts(polygons) == pytest.approx(expected["energy_contacts"], rel=1e-9)
    area = sum(polygons.lmp.extract_fix(f"area{kind}", 0, 0) for kind in (1, 2))
    assert area == pytest.approx(expected["energy_area"], rel=1e-9)
    springs = energy - area - of_contacts(polygons)
    assert springs == pytest.approx(expected["energy_springs"], rel=1e-9)
    force = np.vstack(expected["forces"])
    assert np.abs(polygons.force - force).max() <= 1e-8 * np.abs(force).max() + ROUNDING
    stress = np.array(expected["stress"])[[0, 1, 0], [0, 1, 1]] * np.prod(DATA["box"])
    for virial in polygons.virial():
        np.testing.assert_allclose(virial, stress, atol=1e-9 * np.abs(stress).max())


def test_shifted_across_the_boundaries():
    state = "kicked"
    reference = packing(state)
    energy = reference.energy()
    for shift in (0.37, 0.61), (-0.5, 0.75):
        moved = packing(state, shift=np.array(shift) * DATA["box"])
        # l - l0 of springs at rest is a rounding error of its own
        assert moved.energy() == pytest.approx(energy, rel=1e-12, abs=1e-12 * energy + 1e-15)
        scale = np.abs(reference.force).max()
        assert np.abs(moved.force - reference.force).max() <= 1e-12 * scale + FAR_ROUNDING


def test_the_same_packing_in_a_tilted_box():
    """A tilt by a whole box length has the same images."""
    reference, tilted = packing("kicked"), packing("kicked", tilt=DATA["box"][0])
    assert tilted.energy() == pytest.approx(reference.energy(), rel=1e-12)
    scale = np.abs(reference.force).max()
    np.testing.assert_allclose(tilted.force, reference.force, atol=1e-12 * scale)


def test_contacts_with_the_own_polygon_are_none():
    """Whether they are in the neighbor list or not; special bonds remove only such pairs."""
    reference = packing("rough")
    energy = reference.energy()
    for commands in "", "special_bonds lj/coul 1 1 1\n", EXCLUDE + "special_bonds lj 0 0.5 1\n":
        polygons = packing("rough", commands=commands + AREAS)
        assert polygons.energy() == pytest.approx(energy, rel=1e-14)
        np.testing.assert_allclose(polygons.force, reference.force, atol=1e-12)


def test_other_parameters_for_each_pair_of_types():
    outlines = centered("rough")
    kr, c = [[10.0, 3.0], [3.0, 7.0]], [[0.05, 0.06], [0.06, 0.04]]
    pair = CONTACTS.splitlines()[0] + "\n"
    for i, j in (0, 0), (0, 1), (1, 1):
        pair += f"pair_coeff {i + 1} {j + 1} {kr[i][j]} {c[i][j]}\n"
    polygons = packing("rough", pair=pair, commands=EXCLUDE + PAIR)
    polygons.energy()
    kind = DATA["species"]

    def of_types(m, n):
        return kr[kind[m]][kind[n]], c[kind[m]][kind[n]]

    expected = expected_energy(outlines, lattice(DATA["box"]), of_types)
    assert of_contacts(polygons) == pytest.approx(expected, rel=1e-12)
    # no contacts between the types, and stiffer ones in a later run
    polygons.run("pair_coeff 1 2 0 0.06\npair_coeff 1 1 30 0.05")
    polygons.energy()
    kr = [[30.0, 0.0], [0.0, 7.0]]
    expected = expected_energy(outlines, lattice(DATA["box"]), of_types)
    assert of_contacts(polygons) == pytest.approx(expected, rel=1e-12)


# ---- two polygons ----


@tilts
def test_energy_of_two_polygons(tilt):
    """Either sense of the polygons, which differ by the vertex that each edge subtracts."""
    for outlines in (FIRST, SECOND), (FIRST[::-1], SECOND), (FIRST, SECOND[::-1]):
        polygons = two_polygons(outlines, tilt=tilt)
        energy = polygons.energy()
        assert energy == pytest.approx(expected_of_two(outlines, tilt), rel=1e-13)
        assert energy > 1e-3


@tilts
def test_forces_are_the_gradient(tilt):
    """Up to differences that do not cancel in the two steps, h and 2h.

    These are h^4/20 of fifth derivatives, kr/d^3 times 100, and the rounding of 30 energies
    of 0.02; second derivatives jump by 2 kr where a contact opens within the step.
    """
    polygons = two_polygons(tilt=tilt)
    polygons.energy()
    force, step = polygons.force, 1e-5
    error = 1e4 * step**4 + 30 * 1e-18 / step + 6 * step

    assert (np.abs(force).max(1) > 0).sum() >= 5
    np.testing.assert_allclose(polygons.gradient(step), -force, rtol=0, atol=error)
    assert error < 1e-3 * np.abs(force).max()


@pytest.mark.parametrize(("tilt", "fdotr"), [(0.0, "no"), (TILT, "yes")])
def test_virial_is_the_strain_derivative(tilt, fdotr):
    """Of a strained box, which moves the vertices with it; and the sum over all vertices."""
    step = 1e-6

    def strained(xx, yy, xy):
        polygons = two_polygons(tilt=tilt)
        polygons.run(
            f"change_box all triclinic x scale {1 + xx} y scale {1 + yy} "
            f"xy final {(1 + xx) * tilt + xy * BOX[1]} remap"
        )
        return polygons.energy()

    modify = "" if fdotr == "yes" else "pair_modify nofdotr\n"
    virial, of_vertices = two_polygons(tilt=tilt, commands=modify).virial()
    # h^2/6 of third derivatives, kr R^3/d, and energies of 0.02 from coordinates that are rounded
    error = 10 * step**2 + 100 * ULP * 0.02 / step
    for component, strain in enumerate(step * np.eye(3)):
        slope = (strained(*strain) - strained(*-strain)) / (2 * step)
        assert virial[component] == pytest.approx(-slope, abs=error)
    assert error < 1e-4 * np.abs(virial).max()
    np.testing.assert_allclose(of_vertices, virial, atol=1e-14)


def test_energies_of_vertices():
    """Their sum is the energy, and only vertices at contacts have one."""
    polygons = two_polygons(commands="compute each all pe/atom pair\n")
    polygons.run(
        "thermo_style custom step pe\nthermo_modify norm no\ndump d all custom 1 /dev/null c_each"
    )
    energy = polygons.energy()
    each = polygons.gather("c_each", 1, 1)[:, 0]
    assert each.sum() == pytest.approx(energy, rel=1e-14)
    assert (each == 0).any()


def test_no_net_force_and_no_torque():
    polygons = two_polygons()
    polygons.energy()
    force, x = polygons.force, polygons.x - polygons.x.mean(0)
    scale = len(force) * np.abs(force).max() * ULP
    assert np.abs(force.sum(0)).max() <= scale
    assert abs(np.sum(x[:, 0] * force[:, 1] - x[:, 1] * force[:, 0])) <= 4 * scale


def test_a_polygon_within_a_ring():
    """Edges push to either side: a nucleus in a cell."""
    cell, nucleus = SECOND - SECOND.mean(0), FIRST - FIRST.mean(0) + (0.24, 0.05)
    polygons = two_polygons((cell, nucleus))
    assert polygons.energy() == pytest.approx(expected_of_two((cell, nucleus)), rel=1e-13)
    force = polygons.force[len(cell) :].sum(0)
    assert force[0] < -1e-2


def slid(outlines, pair, distances):
    """Forces on the second polygon, moved along x by each of the distances."""
    polygons = two_polygons(outlines, pair=pair, commands=EXCLUDE)
    polygons.energy()
    x, first, found = polygons.x, len(outlines[0]), []
    for distance in distances:
        moved = x.copy()
        moved[first:, 0] += distance
        polygons.energy(moved)
        found.append(polygons.force[first:].sum(0))
    return np.array(found)


def test_a_corner_is_passed_without_a_jump():
    """A tip slides over a concave corner: second derivatives of a term are below kr (1 + c/d)."""
    notched = [
        (-1, -0.5),
        (0, -0.5),
        (1, -0.5),
        (1, 0.3),
        (0.3, 0.2),
        (0, 0),
        (-0.3, 0.2),
        (-1, 0.3),
    ]
    tip = [(0, 0.1), (0.25, 0.45), (0, 0.6), (-0.25, 0.45)]
    step, terms = 1e-3, 6
    force = slid(
        [np.array(notched), np.array(tip)], TWO.replace("0.4", "1.1"), np.arange(-0.05, 0.05, step)
    )
    assert np.abs(np.diff(force, axis=0)).max() < terms * 3.0 * (1 + 0.15 / 0.05) * step
    assert force[0, 0] > 0.05 > -0.05 > force[-1, 0]  # it is pushed back to the middle


def test_hardly_any_friction():
    """A flat side with round ends slides by the spacing of the vertices. Beads interlock there."""
    spacing = 0.1
    flat = [(x, 0.0) for x in np.linspace(1, -1, 21)] + [(-1, -0.6), (0, -0.6), (1, -0.6)]
    turn = np.pi * np.arange(1, 9) / 9
    right = np.column_stack([0.4 + 0.3 * np.sin(turn), 0.3 - 0.3 * np.cos(turn)])
    side = np.column_stack([np.linspace(-0.4, 0.4, 9), np.zeros(9)])
    half = np.vstack([side, right])
    slider = np.vstack([half, (0, 0.6) - half]) + np.array((0.01, 0.03))
    outlines, distances = [np.array(flat), slider], np.linspace(0, spacing, 20)
    edges = slid(outlines, "pair_style deformable/edge 1.1\npair_coeff * * 10 0.06\n", distances)
    beads = slid(outlines, "pair_style harmonic/cut\npair_coeff * * 5 0.06\n", distances)
    friction = [np.abs(f[:, 0]).max() / f[:, 1].mean() for f in (edges, beads)]
    assert friction[0] < 0.01
    assert friction[1] > 0.5
