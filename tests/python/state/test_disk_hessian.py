"""Second derivatives of soft disks: Hessian, modes and moduli."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.moduli import ElasticModuli
from lammps_deformable.particles.walls import Wall

SCENE = (ld.Sphere(4, (0, 0)), ld.Sphere(0.6, (1, 0.5), inside=False))
ANNULUS = (ld.Sphere(1.5, (1, 2), inside=False), ld.Sphere(5, (1, 2)))
CHANNEL = (ld.Plane((0, 0), (0, 1)), ld.Plane((0, 5), (0, -1)))
TRIANGLE = (*CHANNEL, ld.PolygonWall(((1, 1), (3, 1), (2, 3))))
PACKINGS = {
    "tilted": ld.bidisperse(30, phi=1.0, tilt=-0.7, seed=2),
    "one": ld.bidisperse(1, phi=0.9, tilt=0.3, seed=1),
    "sizes": ld.polydisperse(20, np.linspace(0.1, 1.0, 20), phi=0.95, tilt=2.2, seed=1),
    "circle": ld.bidisperse(40, seed=1).between(SCENE),
    "corners": ld.bidisperse(20, phi=0.9, seed=1).between(TRIANGLE),
}


def state_of(packing: ld.Packing) -> ld.State:
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        return disks.state()


def moved(packing: ld.Packing, step: np.ndarray) -> ld.Packing:
    return packing.replace(positions=packing.positions + step.reshape(-1, 2))


def difference(packing: ld.Packing, direction: np.ndarray) -> np.ndarray:
    """Change of the gradient per step along a direction: Richardson's of two central ones."""
    values = []
    for size in (1e-5, 2e-5):
        ends = [state_of(moved(packing, sign * size * direction)) for sign in (1.0, -1.0)]
        up, down = (end.hessian().gradient for end in ends)
        values.append((up - down) / (2.0 * size))
    return (4.0 * values[0] - values[1]) / 3.0


def test_energy_gradient_and_stress_are_those_of_lammps() -> None:
    for name, packing in PACKINGS.items():
        with ld.Simulation(packing, ld.SoftContact()) as disks:
            state = disks.state()
            forces = np.array(disks.lmp.gather("f", 1, 3)).reshape(-1, 3)[:, :2]
        hessian = state.hessian()
        assert hessian.energy == pytest.approx(state.energy, rel=1e-12), name
        scale = np.abs(forces).max() + 1e-3
        assert hessian.gradient.reshape(-1, 2) == pytest.approx(-forces, abs=1e-12 * scale)
        if not packing.walls:
            assert hessian.stress == pytest.approx(state.pressure_tensor, abs=1e-12)


def test_hessian_is_the_derivative_of_the_gradient() -> None:
    for name, packing in PACKINGS.items():
        hessian = state_of(packing).hessian()
        rng = np.random.default_rng(3)
        for _ in range(3):
            direction = rng.standard_normal(hessian.size)
            exact, found = difference(packing, direction), hessian.operator @ direction
            assert found == pytest.approx(exact, abs=1e-6 * np.abs(exact).max()), name
            assert hessian.matrix @ direction == pytest.approx(found, abs=1e-14)
        assert abs(hessian.matrix - hessian.matrix.T).max() <= 4e-16 * abs(hessian.matrix).max()


def test_modes_that_do_not_fit_into_the_memory() -> None:
    """Those of 100 000 particles need 1.2 TB; a few of them do not."""
    box = np.array([[400.0, 0.0], [0.0, 125.0 * np.sqrt(3.0)]])
    places = np.array([(a, b) for a in range(400) for b in range(250)])
    places = (places + 0.5 * (places[:, 1:] % 2) * [1, 0]) / [400, 250]
    state = state_of(ld.Packing(places @ box, 0.505, box))
    with pytest.raises(ld.ParameterError, match=r"\d\d\d GB .* modes\(10\)"):
        state.modes()


def test_all_modes_of_the_same_stiffness_are_found() -> None:
    """A crystal has up to twelve of each; of some Lanczos' method by itself finds eleven."""
    box = np.array([[20.0, 0.0], [10.0, 10.0 * np.sqrt(3.0)]])
    places = np.array([(a, b) for a in range(20) for b in range(20)]) / 20.0
    state = state_of(ld.Packing(places @ box, 0.505, box))
    every = state.modes(vectors=False)
    for number in (5, 12, 20):
        few = state.modes(number)
        assert few.stiffness == pytest.approx(every.stiffness[:number], rel=1e-10)
        vectors = few.vectors.reshape(number, -1)
        assert vectors @ vectors.T == pytest.approx(np.eye(number), abs=1e-12)


@pytest.mark.parametrize(("walls", "zero"), [(ANNULUS, 1), (CHANNEL, 1), (TRIANGLE, 0)])
def test_motions_between_walls(walls: tuple[Wall, ...], zero: int):
    """A rotation in a circle or annulus, a translation along a channel, none around others."""
    packing = ld.bidisperse(40, sizes=(0.4, 0.56), seed=5).between(walls)
    with ld.Simulation(packing.at(0.95), ld.SoftContact()) as disks:
        state = disks.relax(1e-10)
    hessian = state.hessian(rattlers=False)
    assert hessian.motions.shape == (80, zero)
    assert np.abs(hessian.operator @ hessian.motions).max(initial=0.0) < 1e-8
    assert state.modes(1).stiffness[0] > 1e-6
    with pytest.raises(ld.ParameterError, match="walls"):
        state.moduli()


def test_disks_that_resist_no_force() -> None:
    state = state_of(ld.bidisperse(30, phi=0.7, seed=2))
    with pytest.raises(ld.ParameterError, match="resist"):
        state.hessian().solve(np.random.default_rng(1).standard_normal(60))


def test_moduli_of_a_triangular_lattice() -> None:
    """Springs without prestress: both of Lame's constants are sqrt(3)/4."""
    box = np.array([[6.0, 0.0], [3.0, 3.0 * np.sqrt(3.0)]])
    steps = np.array([(a, b) for a in range(6) for b in range(6)]) / 6.0
    start = ld.Packing(steps @ box, 0.5 + 1e-9, box)
    moduli = state_of(start).moduli()
    lame = np.sqrt(3.0) / 4.0
    assert moduli.shear_modulus == pytest.approx(lame, rel=1e-7)
    assert moduli.pure_shear_modulus == pytest.approx(lame, rel=1e-7)
    assert moduli.bulk_modulus == pytest.approx(2.0 * lame, rel=1e-7)
    assert np.abs(moduli.relaxing).max() < 1e-9


def test_no_density_of_states_without_different_frequencies() -> None:
    """Of a square crystal of two, with the same stiffness in all directions."""
    crystal = ld.Packing([[0, 0], [0.5, 0.5]], 0.5, np.eye(2))
    modes = state_of(crystal.at(0.95)).modes()
    assert len(modes) == 2
    with pytest.raises(ld.ParameterError, match="frequencies"):
        modes.density()


def test_a_particle_at_the_center_of_a_circle() -> None:
    """Its energy has a kink there; rings are refused as they are wider than the circle."""
    circle = ld.Sphere(1, (0, 0))
    packing = ld.Packing([[0, 0]], 1.02, np.eye(2), walls=[circle])
    with (
        ld.Simulation(packing, ld.Ring()) as sim,
        pytest.raises(ld.LammpsError, match="wider than circle 1"),
    ):
        sim.state()
    with ld.Simulation(packing, ld.SoftContact()) as sim:
        state = sim.state()
    with pytest.raises(ld.ParameterError, match=r"particle 0 .* circle 1"):
        state.hessian()


def test_the_mean_shear_modulus_is_that_of_all_directions() -> None:
    """Of a tensor without symmetry but that of an elastic one, turned by many angles."""
    c = np.random.default_rng(2).normal(size=(2, 2, 2, 2))
    c = c + c.transpose(1, 0, 2, 3)
    c = c + c.transpose(0, 1, 3, 2)
    c = c + c.transpose(2, 3, 0, 1)
    turned = []
    for angle in np.linspace(0.0, np.pi, 8, endpoint=False):
        q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned.append(np.einsum("ai,bj,ck,dl,ijkl->abcd", q, q, q, q, c)[0, 1, 0, 1])
    moduli = ElasticModuli(c, c, 0.0 * c)
    assert moduli.mean_shear_modulus == pytest.approx(np.mean(turned), rel=1e-12)
    assert max(turned) - min(turned) > 0.1
