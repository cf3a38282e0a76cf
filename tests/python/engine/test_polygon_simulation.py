"""Bead polygons in LAMMPS against their energy written down in numpy."""

from collections.abc import Iterator

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.lammps import gather
from naive_polygons import area, naive, pair

pytestmark = pytest.mark.filterwarnings("error")


SOFT = ld.DeformablePolygon(14, radius=0.08, kL=[7.0, 20.0], kA=[3.0, 0.5], kr=11.0, smooth=False)


@pytest.fixture
def crumpled() -> Iterator[ld.Simulation]:
    """Compressed polygons in a tilted box whose beads are displaced at random."""
    jammed = ld.jam(ld.bidisperse(4, seed=1, tilt=0.6, aspect=0.7)).packing
    with ld.Simulation(jammed, SOFT) as sim:
        sim.deform(0.96 * sim.box)
        sim.lmp.command("displace_atoms all random 0.01 0.01 0 5 units box")
        yield sim


def test_energy_and_forces_are_the_formula(crumpled: ld.Simulation) -> None:
    state = crumpled.state()
    exact = naive(state, state.outlines, state.packing.box)
    force = gather(crumpled.lmp, "f", 3)
    assert state.energy == pytest.approx(exact.energy, rel=1e-12)
    assert force[:, :2] == pytest.approx(np.vstack(exact.force), abs=1e-12)
    assert not force[:, 2].any()


def test_contacts_are_those_of_the_beads(crumpled: ld.Simulation) -> None:
    state = crumpled.state()
    contacts = state.contacts
    exact = naive(state, state.outlines, state.packing.box).contacts
    seen = {(int(c["i"]), int(c["j"]), *c["image"].tolist()): c["force_vector"] for c in contacts}
    others = {(j, i, -a, -b): -force for (i, j, a, b), force in exact.items()}
    assert seen.keys() == exact.keys() | others.keys()
    assert all(seen[key] == pytest.approx((exact | others)[key], abs=1e-12) for key in seen)
    assert len(contacts) == 2 * len(exact)
    # springs and areas put no force on a whole ring
    total = np.zeros((len(state.packing), 2))
    np.add.at(total, contacts["i"], contacts["force_vector"])
    force = np.split(
        gather(crumpled.lmp, "f", 3)[:, :2],
        np.cumsum(state.polygons.number[state.packing.species])[:-1],
    )
    assert total == pytest.approx(np.array([f.sum(axis=0) for f in force]), abs=1e-12)


def test_stress_is_the_derivative_of_the_energy(crumpled: ld.Simulation) -> None:
    state = crumpled.state()
    volume = np.prod(state.packing.box.diagonal())
    step = 1e-6
    for a, b in ((0, 0), (1, 1), (1, 0)):
        energy = []
        for sign in (-1.0, 1.0):
            stretch = np.eye(2)
            stretch[a, b] += sign * step  # rows are positions: x' = x + sign step y for (1, 0)
            moved = [outline @ stretch for outline in state.outlines]
            energy.append(naive(state, moved, state.packing.box @ stretch).energy)
        slope = (energy[1] - energy[0]) / (2.0 * step)
        # truncation by step^2 and rounding by eps/step leave 1e-8 of the largest term
        assert state.pressure_tensor[a, b] == pytest.approx(-slope / volume, rel=1e-6, abs=1e-9)
    assert state.pressure == pytest.approx(np.trace(state.pressure_tensor) / 2.0)


def test_areas_perimeters_and_centers(crumpled: ld.Simulation) -> None:
    state = crumpled.state()
    assert state.results["area"] == pytest.approx(
        [area(outline) for outline in state.outlines], rel=1e-12
    )
    sides = [outline - np.roll(outline, 1, axis=0) for outline in state.outlines]
    assert state.perimeters == pytest.approx([np.hypot(*side.T).sum() for side in sides], rel=1e-12)
    assert max(np.hypot(*side.T).max() for side in sides) < 0.4  # polygons are whole
    centers = [outline.mean(axis=0) for outline in state.outlines]
    assert state.packing.positions == pytest.approx(np.array(centers))
    skin = state.polygons.skin[state.packing.species]
    filled = state.results["area"] + state.perimeters * skin + np.pi * skin**2
    assert state.volumes == pytest.approx(filled, rel=1e-14)
    assert state.phi == pytest.approx(filled.sum() / np.prod(state.packing.box.diagonal()))
    rest = state.polygons.area[state.packing.species]
    assert state.area_deficit == pytest.approx(rest - state.results["area"])


def test_undeformed_polygons_are_at_rest() -> None:
    loose = ld.bidisperse(2, phi=0.05, tilt=0.3, seed=1)
    with ld.Simulation(loose, SOFT) as sim:
        state = sim.state()
        # lengths are off by roundings of coordinates below 8: 14 and 23 springs, (8 eps)^2 each
        stiffness = state.polygons.number @ state.polygons.kL
        assert state.energy < 0.5 * stiffness * (8 * np.finfo(float).eps) ** 2
        assert len(state.contacts["i"]) == 0
        assert (state.residual, state.coordination) == (0.0, 0.0)
        assert state.packing.positions == pytest.approx(loose.positions, abs=1e-14)
        e = 0.01
        sim.deform((1.0 + e) * sim.box)
        stretched = sim.state()
    of_each, rest = loose.species, state.perimeters
    number = state.polygons.number[of_each]
    assert rest == pytest.approx(number * state.polygons.spacing[of_each], rel=1e-13)
    assert stretched.perimeters == pytest.approx((1.0 + e) * rest, rel=1e-12)
    kP, kA = np.array([7.0, 20.0])[of_each] / number, np.array([3.0, 0.5])[of_each]
    perimeter = 0.5 * kP * (stretched.perimeters - rest) ** 2
    assert stretched.energy == pytest.approx(
        np.sum(perimeter + 0.5 * kA * stretched.area_deficit**2), rel=1e-11
    )


def test_polygons_touch_at_the_effective_radius() -> None:
    """Flat contacts of nine beads a side: facing rows interlock."""
    model = ld.DeformablePolygon(152, radius=0.01, kr=1000.0, smooth=False)
    width = 2.0**0.5
    with ld.Simulation(pair(width), model) as sim:
        # the polygons start bead on bead: turn one by 0.3 spacings, and relaxation does the rest
        sim.lmp.command("group turned molecule 2")
        turn = f"{0.5 * width!r} {0.5 * width!r} 0 0 0 1 {0.3 * 360.0 / 152}"
        sim.lmp.command(f"displace_atoms turned rotate {turn} units box")
        for strain in (0.02, 0.04):
            sim.deform((1.0 - strain) * width * np.eye(2))
            state = sim.relax(0.01)
    (radius,), (spacing,) = state.polygons.radius, state.polygons.spacing
    normal, tangent = np.array([1.0, 1.0]) / np.sqrt(2.0), np.array([-1.0, 1.0]) / np.sqrt(2.0)
    middle = state.packing.positions.mean(axis=0)
    rows = []
    for side, outline in zip((-1.0, 1.0), state.outlines, strict=True):
        t, n = (outline - middle) @ tangent, (outline - middle) @ normal
        rows.append(n[(np.abs(t) < 2.0 * spacing) & (side * n < 0.5 * radius)])
    gap = rows[1].mean() - rows[0].mean()
    roughness = 2.0 * model.radius - np.sqrt(4.0 * model.radius**2 - 0.25 * spacing**2)
    predicted = 2.0 * (state.polygons.effective_radius[0] - radius)
    assert predicted == pytest.approx(2.0 * model.radius - roughness)
    # beads give way by kA S L0 / kr < 1e-4 of it, springs by less; 1 % is for the residual
    assert abs(gap - predicted) < 0.01 * roughness


def test_relaxation_ends_at_the_tolerance() -> None:
    kA = (2.0, 20.0)
    jammed = ld.jam(ld.bidisperse(6, seed=1)).packing
    with ld.Simulation(jammed, ld.DeformablePolygon(20, kA=kA, smooth=False)) as sim:
        sim.deform(0.97 * sim.box)
        state = sim.relax(0.02)
        force = np.linalg.norm(gather(sim.lmp, "f", 3), axis=1).max()
        pressure = np.array(kA)[jammed.species] * np.maximum(state.area_deficit, 0.0)
        borne = np.mean(pressure * state.polygons.spacing[jammed.species])
        assert 0.0 < force <= 0.02 * borne
        assert state.residual == pytest.approx(force / borne)
        assert state.converged


def test_stiff_areas_of_soft_polygons_relax() -> None:
    """Then the whole ring oscillates faster than any spring, and the time step is shorter."""
    model = ld.DeformablePolygon(20, kL=1.0, kA=[1.0, 1e3], kr=1.0, smooth=False)
    jammed = ld.jam(ld.bidisperse(6, seed=1)).packing
    with ld.Simulation(jammed, model) as sim:
        sim.deform(0.97 * sim.box)
        state = sim.relax(0.05)
    assert state.residual <= 0.05
    assert state.energy > 0.0


def test_errors_of_lammps_come_as_one_line() -> None:
    with ld.Simulation(pair(1.42), ld.DeformablePolygon(20, smooth=False)) as sim:
        sim.lmp.command("displace_atoms all random 3 3 0 1 units box")
        with pytest.raises(ld.LammpsError, match=r"atoms .* apart|[Bb]ond atoms") as caught:
            sim.relax()
    assert "\n" not in str(caught.value)
