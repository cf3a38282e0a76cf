"""Storage and loss modulus by linear response, against modes, limits and flows at small rates."""

import math
from collections.abc import Callable

import lammps_deformable as ld
import numpy as np
import pytest
from protocol_helpers import dynamic_modulus

from validation.finite_strain import bulk_modulus, shear_modulus

Snapshot = ld.State


def ring(contact: str) -> ld.State:
    """16 particles at rest, rattlers among them."""
    jammed = ld.jam(ld.bidisperse(16, seed=2)).packing
    law = ld.Ring(kA=2.0, kP=0.7, contact=contact)
    with ld.Simulation(jammed.at(jammed.phi + 0.05), law) as sim:
        return sim.relax(1e-10)


def droplets() -> ld.State:
    jammed = ld.jam(ld.bidisperse(16, sizes=(0.5, 0.6), dimension=3, seed=1)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.06), ld.Droplet(2.0)) as sim:
        return sim.relax(1e-10)


STATES: dict[str, Callable[[], Snapshot]] = {
    "curved": lambda: ring("curved"),
    "droplets": droplets,
}


@pytest.fixture(scope="module", params=STATES)
def rest(request: pytest.FixtureRequest) -> Snapshot:
    return STATES[request.param]()


def test_as_a_sum_over_modes(rest: Snapshot) -> None:
    """G_affine - sum (xi.e)^2/(k + i omega zeta)/V with the modes e of the stiffness k."""
    zeta, omega = 1.7, np.geomspace(1e-4, 1e2, 12).reshape(3, 4)
    hessian = rest.hessian(rattlers=False)
    n, m = hessian.size, hessian.matrix.toarray()
    coupled = hessian.by_strain[:, 1]
    lines = np.linalg.solve(m[n:, n:], np.column_stack([m[n:, :n], coupled[n:]]))
    xi = coupled[:n] - m[:n, n:] @ lines[:, -1]
    stiffness, vectors = np.linalg.eigh(m[:n, :n] - m[:n, n:] @ lines[:, :-1])
    weight = (xi @ vectors) ** 2 / hessian.room
    affine = rest.moduli().affine[0, 1, 0, 1]
    expected = affine - np.sum(weight / (stiffness + 1j * zeta * omega[..., None]), axis=-1)
    found = rest.complex_modulus(omega, drag=zeta)
    assert found.shape == omega.shape
    assert np.abs(found - expected).max() < 1e-9 * affine
    assert rest.complex_modulus(1.0, zeta).shape == ()
    # the drag sets the unit of time alone
    assert rest.complex_modulus(omega * zeta) == pytest.approx(found, rel=1e-9)


def test_limits_of_slow_and_of_fast_shear(rest: Snapshot) -> None:
    """Static and affine modulus; G'' rises with the frequency, and falls again."""
    moduli = rest.moduli()
    affine = moduli.affine[0, 1, 0, 1]
    still, slow, fast = rest.complex_modulus([0.0, 1e-10, 1e10], drag=0.3)
    assert still == pytest.approx(moduli.shear_modulus, abs=1e-12 * affine)
    assert slow == pytest.approx(still, abs=1e-5 * affine)
    assert fast == pytest.approx(affine, abs=1e-7 * affine)
    loss = rest.complex_modulus(np.geomspace(1e-10, 1e10, 11)).imag
    assert (loss > 0.0).all()
    assert loss[1] / loss[0] == pytest.approx(100.0, rel=1e-2)
    assert loss[-1] / loss[-2] == pytest.approx(0.01, rel=1e-3)


def test_a_flow_at_small_strains_has_it(rest: Snapshot) -> None:
    """Where the softest mode begins to follow, within the time step."""
    omega = 2.0 * rest.modes(1, vectors=False).stiffness[0] / 0.5
    expected = rest.complex_modulus(omega, drag=0.5)
    affine = rest.moduli().affine[0, 1, 0, 1]
    period = 2.0 * math.pi / omega
    found = dynamic_modulus(rest, 1e-7, period, cycles=2, skip=3, steps=8, drag=0.5)
    assert abs(found.storage + 1j * found.loss - expected) < 4e-3 * affine
    assert abs(expected - affine) > 0.03 * affine


def test_refusals() -> None:
    packing = ld.jam(ld.bidisperse(12, seed=1)).packing.at(0.9)
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        moving, rest = disks.state(), disks.relax(1e-8)
    for state, arguments, message in (
        (rest, (-1.0,), "frequencies must not be negative, not -1"),
        (rest, ([1.0, math.inf],), "frequencies must be finite numbers, not "),
        (rest, ("fast",), "frequencies must be finite numbers, not 'fast'"),
        (rest, (1.0, 0.0), "drag must be a positive number, not 0"),
        (moving, (1.0,), "the state is not at rest: its largest force is .* relax it first"),
    ):
        with pytest.raises(ld.ParameterError, match=message) as error:
            state.complex_modulus(*arguments)
        assert "\n" not in str(error.value)
    walled = ld.jam(ld.bidisperse(12, seed=1).between(ld.BoxWall((6, 6)))).packing
    with ld.Simulation(walled.at(walled.phi + 0.01), ld.SoftContact()) as disks:
        held = disks.relax(1e-8)
    with pytest.raises(ld.ParameterError, match="a periodic box without walls"):
        held.complex_modulus(1.0)


def test_a_state_that_is_not_at_rest_has_no_modes_and_no_moduli(jammed: ld.Packing) -> None:
    """All of them say so; its second derivatives, and forces, are there."""
    packing = jammed.at(jammed.phi + 0.05)
    with ld.Simulation(packing, ld.Ring(kA=2.0)) as sim:
        state, rest = sim.state(), sim.relax(5e-4)
    assert state.residual > 1e-3 > rest.residual
    state.hessian()
    for measure in (
        lambda each: each.modes(1),
        lambda each: each.moduli(),
        lambda each: each.complex_modulus(1.0),
        lambda each: shear_modulus(each, 1e-4),
        lambda each: bulk_modulus(each, 1e-4),
    ):
        with pytest.raises(ld.ParameterError, match=r"\Athe state is not at rest[^\n]*\Z"):
            measure(state)
        measure(rest)
