"""Modes, moduli and responses of disks and of each ring law."""

import math

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.state import modes

from validation.finite_strain import bulk_modulus, shear_modulus

pytestmark = pytest.mark.usefixtures("exact_balance")

LAWS = {
    "disks": None,
    "curved": ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved"),
}
Snapshot = ld.State


@pytest.fixture(scope="module", params=LAWS)
def state(request: pytest.FixtureRequest) -> Snapshot:
    """64 particles at rest, rattlers among them."""
    law = LAWS[request.param]
    if law is None:
        jammed = ld.jam(ld.bidisperse(64, seed=2)).packing
        with ld.Simulation(jammed.at(jammed.phi + 0.01), ld.SoftContact()) as disks:
            return disks.relax(1e-10)
    jammed = ld.jam(ld.bidisperse(64, seed=5)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.03), law) as sim:
        return sim.relax(1e-10)


def test_zero_modes_are_translations_and_two_of_each_rattler(state: Snapshot) -> None:
    hessian = state.hessian(rattlers=False)
    assert (hessian.free == state.rattlers).all()
    assert hessian.free.any()
    assert hessian.zero_modes == 2 + 2 * int(state.rattlers.sum())
    stiffness = np.linalg.eigvalsh(hessian.reduced())
    zero = np.abs(stiffness) < 1e-11 * stiffness.max()
    assert zero.sum() == hessian.zero_modes
    moved = hessian.operator @ hessian.motions
    assert np.abs(moved).max() < 1e-11 * stiffness.max()
    modes = state.modes()
    assert len(modes) == 128 - hessian.zero_modes
    assert modes.zero_modes == hessian.zero_modes
    assert modes.stiffness == pytest.approx(stiffness[~zero], abs=1e-12 * stiffness.max())


def test_modes_are_eigenvectors(state: Snapshot) -> None:
    modes, operator = state.modes(), state.hessian(rattlers=False).operator
    vectors = modes.vectors.reshape(len(modes), -1)
    assert vectors @ vectors.T == pytest.approx(np.eye(len(modes)), abs=1e-12)
    scale = 1e-12 * modes.stiffness.max()
    assert operator @ vectors.T == pytest.approx(vectors.T * modes.stiffness, abs=scale)
    assert modes.frequencies**2 == pytest.approx(modes.stiffness)
    alone = modes.participation
    assert ((alone > 1.0 / 64) & (alone < 1.0)).all()
    assert not modes.vectors[:, state.rattlers].any()
    middle, density = modes.density(10)
    assert np.sum(density) * (middle[1] - middle[0]) == pytest.approx(1.0)
    values = state.modes(vectors=False)
    assert values.stiffness == pytest.approx(modes.stiffness, rel=1e-10, abs=scale)
    with pytest.raises(ld.ParameterError, match="vectors"):
        values.plot(0)
    with pytest.raises(ld.ParameterError, match="128"):
        state.modes(128)


def test_softest_modes(state: Snapshot, monkeypatch: pytest.MonkeyPatch) -> None:
    """By Lanczos' method, with the lines as variables, as from the dense matrix."""
    every = state.modes()
    monkeypatch.setattr(modes, "_SMALL", 0)
    few = state.modes(6)
    assert few.stiffness == pytest.approx(every.stiffness[:6], rel=1e-7)
    overlap = np.einsum("kia,kia->k", few.vectors, every.vectors[:6])
    assert np.abs(overlap) == pytest.approx(np.ones(6), abs=1e-6)
    assert few.plot(0).get_title() == every.plot(0).get_title()


def test_response_to_forces(state: Snapshot) -> None:
    hessian = state.hessian(rattlers=False)
    forces = hessian.project(np.random.default_rng(1).standard_normal((128, 3)))
    moved = hessian.solve(forces)
    assert hessian.operator @ moved == pytest.approx(forces, abs=1e-9)
    assert hessian.project(moved) == pytest.approx(moved, abs=1e-12 * np.abs(moved).max())
    with pytest.raises(ld.ParameterError, match=r"\(5,\)"):
        hessian.solve(np.zeros(5))


def test_moduli_are_those_of_finite_strains(state: Snapshot) -> None:
    moduli = state.moduli()
    found = [
        (moduli.shear_modulus, shear_modulus(state, 1e-5, 1e-10)),
        (moduli.pure_shear_modulus, shear_modulus(state, 1e-5, 1e-10, pure=True)),
        (moduli.bulk_modulus, bulk_modulus(state, 1e-5, 1e-10)),
    ]
    assert f"shear {moduli.shear_modulus:.4g}, " in repr(moduli)
    for exact, finite in found:
        assert finite.linear
        assert exact == pytest.approx(finite.value, abs=2e-5 * moduli.bulk_modulus, rel=1e-5)
    scale = 1e-14 * max(moduli.bulk_modulus, 1.0)
    assert moduli.affine - moduli.relaxing == pytest.approx(moduli.tensor, abs=scale)
    assert moduli.relaxing[0, 1, 0, 1] > 0.0


@pytest.mark.parametrize("law", [None, LAWS["curved"]])
def test_loose_particles_do_not_resist(law: ld.Ring | None) -> None:
    start = ld.bidisperse(16, phi=0.4, seed=1).push_off()
    with ld.Simulation(start, law or ld.SoftContact()) as sim:
        state = sim.relax(1e-6)
    assert state.hessian().matrix.nnz == 0
    assert (len(state.modes()), state.modes().zero_modes) == (0, 32)
    assert not state.moduli().tensor.any()


def test_picture(state: Snapshot) -> None:
    modes = state.modes(3)
    ax = modes.plot(0)
    (arrows,) = [each for each in ax.collections if type(each).__name__ == "Quiver"]
    length = np.hypot(arrows.U, arrows.V)
    assert length.max() == pytest.approx(2.0 * state.packing.radii.mean())
    assert "participation" in ax.get_title()
    with pytest.raises(ld.ParameterError, match="3"):
        modes.plot(3)


def test_unstable_motions_have_negative_frequencies() -> None:
    """A square lattice under pressure shears by itself."""
    with ld.Simulation(ld.crystal("square", 4, phi=0.85), ld.SoftContact()) as disks:
        modes = disks.state().modes()
    assert modes.stiffness[0] < 0.0 < modes.stiffness[-1]
    expected = np.sign(modes.stiffness) * np.sqrt(np.abs(modes.stiffness))
    assert modes.frequencies == pytest.approx(expected)
