"""Simple shear and the moduli of linear response."""

from collections.abc import Callable

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import RADIUS, crystal
from lammps_deformable import core
from lammps_deformable.protocols.shearing import sheared, straighten
from refusals import refused

from validation.finite_strain import bulk_modulus, shear_modulus


def ring_energy(indentation: float, gamma: float, compression: float) -> float:
    """Energy of one particle of the lattice, strained affinely, by the kernel."""
    angle = np.arange(6) * np.pi / 3.0
    spacing = 2.0 * RADIUS * (1.0 - indentation)
    ends = spacing * np.column_stack([np.cos(angle), np.sin(angle)])
    ends = sheared(ends, gamma) * np.sqrt(1.0 - compression)
    distance = np.hypot(*ends.T)
    shape = core.ring(RADIUS, np.arctan2(*ends.T[::-1]), RADIUS - distance / 2.0)
    return float(shape.area_deficit**2 / 2.0)


def second_derivative(energy: Callable[[float], float], step: float) -> float:
    """Of fourth order in the step."""
    values = [energy(n * step) for n in range(-2, 3)]
    return float(np.dot([-1.0, 16.0, -30.0, 16.0, -1.0], values) / (12.0 * step**2))


def test_moduli_of_the_crystal_of_rings() -> None:
    """One particle a cell: it follows affinely, and its energy gives both moduli.

    G = U''/V over the shear strain; with V' = -V, K = -V dp/dV = (U'' - U')/V over e, V = 1 - e.
    """
    indentation = 0.02
    with ld.Simulation(crystal(indentation), ld.Ring()) as sim:
        state = sim.relax()
    cell = np.prod(state.packing.box.diagonal()) / len(state.packing)
    shear = second_derivative(lambda gamma: ring_energy(indentation, gamma, 0.0), 1e-4) / cell
    for pure in (False, True):
        found = shear_modulus(state, 1e-4, pure=pure)
        assert found.linear
        # central differences of strains up to 1e-4 over the indentation 0.02: (0.005)^2, a factor
        assert found.value == pytest.approx(shear, rel=2e-4)
    bulk = second_derivative(lambda e: ring_energy(indentation, 0.0, e), 1e-4) / cell
    assert bulk_modulus(state, 1e-4).value == pytest.approx(bulk, rel=2e-4)


@pytest.mark.parametrize(("law", "strain"), [(None, 1e-8), (ld.Ring(), 1e-6)])
def test_moduli_of_small_strains(law: ld.Ring | None, strain: float) -> None:
    """Right within their errors at any strain: relaxed forces are balanced relative to it."""
    jammed = ld.jam(ld.bidisperse(16, seed=2)).packing
    packing = jammed.at(jammed.phi + 0.04)
    sim = ld.Simulation(packing, law or ld.SoftContact())
    with sim:
        state = sim.relax(1e-10)
    exact = state.moduli()
    assert abs(exact.shear_modulus - exact.affine[0, 1, 0, 1]) > 0.1 * abs(exact.shear_modulus)
    for measure, modulus in (
        (shear_modulus, exact.shear_modulus),
        (bulk_modulus, exact.bulk_modulus),
    ):
        found = measure(state, strain)
        assert found.linear
        assert found.value == pytest.approx(modulus, abs=3.0 * found.error + 1e-4 * abs(modulus))
        assert found.error < 0.03 * abs(modulus)
        # relaxed less closely than the strain, it tells
        loose = measure(state, 1e-8, tolerance=1e-6)
        assert not loose.linear
        assert loose.value == pytest.approx(modulus, abs=loose.error)


def test_modulus_halves_a_strain_that_is_too_large() -> None:
    """Contacts of the crystal open at strains of about the overlap: beyond it is softer."""
    overlap = 1e-4
    with ld.Simulation(crystal(overlap), ld.SoftContact()) as sim:
        state = sim.relax()
    found = shear_modulus(state, 8.0 * overlap)
    assert found.linear
    assert found.strain < 2.0 * overlap
    assert found.value == pytest.approx(np.sqrt(3.0) / 4.0, rel=10 * overlap)


@pytest.fixture(scope="module")
def sim() -> ld.Simulation:
    packing = ld.jam(ld.bidisperse(12, seed=2)).packing
    return ld.Simulation(packing.at(packing.phi + 0.03), ld.Ring())


def test_work_is_the_gain_of_energy(sim: ld.Simulation) -> None:
    """dU = V sigma dgamma, with the trapezium rule over a small step."""
    before = sim.relax(1e-9)
    area = np.prod(before.packing.box.diagonal())
    (after,) = sim.shear(1e-4, tolerance=1e-9)[1:]
    stress = -(before.pressure_tensor[0, 1] + after.pressure_tensor[0, 1]) / 2.0
    # relative to the curvature of sigma: (1e-4 / 0.03)^2
    assert after.energy - before.energy == pytest.approx(area * stress * 1e-4, rel=1e-4)


def test_shear_goes_on_in_an_equivalent_box(sim: ld.Simulation) -> None:
    box = sim.box
    states = sim.shear(1.3, steps=13, tolerance=1e-3)[1:]
    assert all(state.converged for state in states)
    for n, state in enumerate(states, start=1):
        (lx, _), (xy, ly) = state.packing.box
        assert (lx, ly) == pytest.approx(box.diagonal())
        turns = (box[1, 0] + 0.1 * n * ly - xy) / lx
        assert turns == pytest.approx(round(turns), abs=1e-9)
        assert abs(xy) <= 0.5 * lx + 0.1 * ly


def test_equivalent_box_changes_nothing(sim: ld.Simulation) -> None:
    (lx, _), (_, ly) = sim.box.tolist()
    sim.deform(np.array([[lx, 0.0], [0.8 * lx, ly]]))
    before = sim.state()
    straighten(sim)
    after = sim.state()
    assert after.packing.box[1, 0] == pytest.approx(-0.2 * lx)
    assert after.energy == pytest.approx(before.energy, rel=1e-9)
    assert after.pressure_tensor == pytest.approx(
        before.pressure_tensor, rel=1e-9, abs=1e-9 * before.pressure
    )


def test_bad_input(sim: ld.Simulation) -> None:
    with refused("strain must be a finite number, not nan"):
        sim.shear(np.nan)
    with refused("steps must be at least 1"):
        sim.shear(0.1, steps=0)
    with refused("strain must be a positive number, not 0"):
        shear_modulus(sim.state(), 0.0)


def test_particles_stay_where_the_box_flips() -> None:
    """Their image flags count the lattice vectors of the new box."""
    packing = ld.bidisperse(16, phi=0.5, tilt=0.9, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.lmp.commands_string("set atom 1*8 image 1 -2 NULL\nset atom 9*16 image 0 3 NULL")
        before = ld.Run([sim.state()]).unwrapped()
        straighten(sim)
        assert abs(sim.box[1, 0]) < 0.5 * sim.box[0, 0]
        assert ld.Run([sim.state()]).unwrapped() == pytest.approx(before, abs=1e-11)
