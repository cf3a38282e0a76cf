"""Second derivatives of droplets and spheres in three dimensions: Hessian, modes and moduli."""

import json
import sys
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import Droplet, Packing, State
from ranks import python
from refusals import refused

from validation.finite_strain import bulk_modulus, shear_modulus

pytestmark = pytest.mark.usefixtures("exact_balance")

EMULSION = ld.bidisperse(24, sizes=(1.0, 1.2), dimension=3, tilt=0.3, seed=2)
SIZES = ld.polydisperse(20, np.linspace(0.5, 1.5, 20), dimension=3, seed=3)
LAWS = {"spheres": None, "droplets": Droplet(0.7), "tensions": Droplet([1.0, 2.5])}
CLOSE = {"sc": np.pi / 6, "bcc": np.pi * np.sqrt(3) / 8, "fcc": np.pi * np.sqrt(2) / 6}


def evaluated(packing: Packing, law: Droplet | None):
    """State of a packing as it is, and the gradient of the energy that LAMMPS finds, (3N,)."""
    with ld.Simulation(packing, law or ld.SoftContact()) as sim:
        state = sim.state()
        forces = np.array(sim.lmp.gather("f", 1, 3))
    return state, -forces


def difference(packing: Packing, law: Droplet | None, direction: np.ndarray) -> np.ndarray:
    """Change of the gradient per step along a direction, with an error of the fourth order."""

    def gradient(step: float) -> np.ndarray:
        positions = packing.positions + step * direction.reshape(-1, 3)
        return evaluated(packing.replace(positions=positions), law)[1]

    near, far = ((gradient(h) - gradient(-h)) / (2.0 * h) for h in (2e-6, 4e-6))
    return (4.0 * near - far) / 3.0


def agrees(packing: Packing, law: Droplet | None) -> None:
    """Compare energy, gradient, stress and Hessian with those of LAMMPS."""
    state, gradient = evaluated(packing, law)
    hessian, scale = state.hessian(), np.abs(state.pressure_tensor).max()
    largest = np.abs(state.contacts["force"]).max() if law else 0.0
    force = max(scale * packing.radii.max() ** 2, largest)
    assert hessian.energy == pytest.approx(state.energy, rel=1e-11)
    assert hessian.gradient[: hessian.size] == pytest.approx(gradient, abs=1e-11 * force)
    assert hessian.gradient[hessian.size :] == pytest.approx(0.0, abs=1e-11 * force)
    if not packing.walls:  # it is that of the contacts between particles
        assert hessian.stress == pytest.approx(state.pressure_tensor, abs=1e-11 * scale)
    matrix = hessian.matrix
    assert abs(matrix - matrix.T).max() <= 2e-15 * abs(matrix).max()
    direction = np.random.default_rng(1).standard_normal(hessian.size)
    exact = difference(packing, law, direction)
    found = hessian.operator @ direction
    assert found == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    assert hessian.reduced() @ direction == pytest.approx(found, abs=1e-12 * np.abs(found).max())


@pytest.mark.parametrize("law", ["spheres", "tensions"])
def test_two_sizes_in_a_tilted_box(law: str) -> None:
    agrees(EMULSION.at(0.72).push_off(), LAWS[law])


def test_a_dense_emulsion() -> None:
    with ld.Simulation(SIZES.at(0.88).push_off(), Droplet()) as sim:
        packing = sim.relax(1e-3).packing
    agrees(packing, Droplet())


def test_any_sizes() -> None:
    agrees(SIZES.at(0.7).push_off(), Droplet(0.7))


FILMS = {
    "like": Droplet(0.7, adhesion=0.14),
    "unlike tensions": Droplet([1.0, 1.3], adhesion=[[0.2, 0.0], [0.0, 0.1]]),
}


@pytest.mark.parametrize("law", FILMS)
@pytest.mark.parametrize("phi", [0.6, 0.7])
def test_films_that_stick(law: str, phi: float) -> None:
    """Between sizes films are caps; at the lower fraction they pull."""
    with ld.Simulation(EMULSION.at(phi).push_off(), FILMS[law]) as sim:
        packing = sim.relax(1e-2).packing
    packing = packing.at(0.98 * packing.phi)
    agrees(packing, FILMS[law])
    state, _ = evaluated(packing, FILMS[law])
    assert state.contacts["attached"].any()
    assert phi > 0.6 or (state.contacts["force"] < 0.0).any()


def test_films_of_walls_and_of_a_cluster_that_hangs_together() -> None:
    """A droplet on a sticky floor, and two that hang at it: three contacts bear against motions."""
    floor = ld.Plane((0, 0, 1), (0, 0, 1), adhesion=0.1)
    lid = ld.Plane((0, 0, 11), (0, 0, -1))
    centers = [[6.0, 6.0, 1.98], [6.0, 7.2, 3.4], [7.8, 6.0, 2.1]]
    packing = Packing(centers, 1.0, (12.0,) * 3, walls=(floor, lid))
    law = Droplet(adhesion=0.15)
    with ld.Simulation(packing, law) as sim:
        state = sim.relax()
    stiffness = state.modes().stiffness
    assert stiffness[:4] == pytest.approx(0.0, abs=1e-6)  # and two motions along the floor
    assert (stiffness[4:] > 1.0).all()
    closer = packing.replace(positions=state.positions + np.array([0.0, 0.0, -0.02]))
    agrees(closer, law)


def test_moduli_with_films() -> None:
    """Those of finite strains, of an emulsion that sticks."""
    with ld.Simulation(EMULSION.at(0.7).push_off(), FILMS["like"]) as sim:
        state = sim.relax(1e-10)
    moduli = state.moduli()
    finite = shear_modulus(state, 1e-5, tolerance=1e-10)
    assert moduli.shear_modulus == pytest.approx(finite.value, rel=1e-4)
    assert (state.modes(3).stiffness > 0.0).all()


def test_a_particle_and_its_own_images() -> None:
    """A crystal of one particle: nothing moves, and the moduli are those of eight."""
    box = np.array([[1.9, 0.0, 0.0], [0.5, 1.93, 0.0], [0.3, 0.4, 1.91]])
    one = Packing(np.zeros((1, 3)), 1.0, box)
    steps = np.array(np.unravel_index(range(8), (2, 2, 2))).T @ box
    eight = Packing(steps, 1.0, 2 * box)
    states = [evaluated(packing, Droplet(0.7))[0] for packing in (one, eight)]
    assert np.abs(states[0].hessian().reduced()).max() < 1e-14
    left, right = (state.moduli() for state in states)
    assert left.tensor == pytest.approx(right.tensor, abs=1e-11)
    assert np.abs(left.tensor).max() > 0.1


@pytest.mark.parametrize(
    ("lattice", "shear", "extension"),
    [("fcc", 0.28696, 0.49403), ("sc", None, 0.63313)],
)
def test_moduli_of_crystals(lattice: str, shear: float | None, extension: float | None) -> None:
    """0.01 above close packing, in tension/R: of shear along the axes, and of d(s33 - s11)/de33.

    The same by finite strains of LAMMPS: `tests/lammps/test_droplet_crystals.py`. A uniaxial strain
    at constant volume stretches z by e and x and y by -e/2.
    """
    packing = ld.crystal(lattice, 2, radius=2.0, phi=CLOSE[lattice] + 0.01)
    moduli = evaluated(packing, Droplet(3.0))[0].moduli()
    c, unit = moduli.tensor, 3.0 / 2.0
    assert np.abs(moduli.relaxing).max() < 1e-9  # centers follow the strain
    if shear:
        assert moduli.shear_modulus / unit == pytest.approx(shear, abs=1e-5)  # all digits
    if extension:
        change = c[2, 2] - c[0, 0]
        found = change[2, 2] - 0.5 * (change[0, 0] + change[1, 1])
        assert found / unit == pytest.approx(extension, abs=1e-5)


def relaxed(law: Droplet | None, phi: float) -> State:
    jammed = ld.jam(ld.bidisperse(48, sizes=(1.0, 1.2), dimension=3, seed=1)).packing
    start = jammed.at(phi)
    with ld.Simulation(start, law or ld.SoftContact()) as sim:
        return sim.relax(1e-10)


@pytest.fixture(scope="module", params=["spheres", "droplets"])
def rest(request: pytest.FixtureRequest) -> State:
    return relaxed(LAWS[request.param], 0.68)


def test_moduli_are_those_of_finite_strains(rest: State) -> None:
    """Of second order in the strain; contacts change from some 1e-4 on."""
    moduli, strain = rest.moduli(), 1e-5
    for modulus, found in (
        (shear_modulus, moduli.shear_modulus),
        (bulk_modulus, moduli.bulk_modulus),
    ):
        finite = modulus(rest, strain, tolerance=1e-10)
        assert found == pytest.approx(finite.value, rel=1e-4)
    assert moduli.relaxing[0, 1, 0, 1] > 0.1 * moduli.affine[0, 1, 0, 1]


def test_modes_and_zero_modes(rest: State) -> None:
    """Three translations, and three motions of each rattler; Lanczos' method as the dense one."""
    number = 3 + 3 * int(rest.rattlers.sum())
    every, few = rest.modes(), rest.modes(5)
    assert len(every) == 3 * len(rest.packing) - number
    assert every.zero_modes == few.zero_modes == number
    assert every.stiffness[0] > 1e-5 * every.stiffness[-1]
    assert few.stiffness == pytest.approx(every.stiffness[:5], rel=1e-9)
    assert every.vectors is not None
    assert every.vectors.shape == (len(every), len(rest.packing), 3)
    dense = rest.hessian(rattlers=False).reduced()
    assert np.linalg.eigvalsh(dense) == pytest.approx(
        np.sort(np.append(every.stiffness, np.zeros(number))), abs=1e-11 * every.stiffness[-1]
    )
    assert (every.participation <= 1.0).all()
    ax = few.plot(0, view=(90, -90))  # from above: x to the right
    arrows = ax.collections[-1]
    longest = np.linalg.norm(few.vectors[0], axis=1).max()
    order = np.argsort(rest.packing.positions[:, 2], kind="stable")
    drawn = np.hypot(arrows.U, arrows.V) / (2.0 * rest.packing.radii.mean())
    expected = np.hypot(*few.vectors[0, order, :2].T) / longest
    assert np.sort(drawn) == pytest.approx(np.sort(expected))
    with refused("view must be elevation and azimuth"):
        few.plot(0, view=3)


def test_rattlers_are_left_out() -> None:
    """A small droplet in the place of one of a crystal, pushed away from a neighbor that it met.

    Its contact hardly bears any more, and would be a soft spring.
    """
    fcc = ld.crystal("fcc", 2, radius=1.0, phi=0.76)
    x = fcc.positions.copy()
    toward = x[1] - x[0]
    x[0] += 0.5 * toward
    small = fcc.replace(positions=x, radii=np.where(np.arange(32) > 0, 1.0, 0.4))
    with ld.Simulation(small, Droplet(), minimizer="fire") as sim:
        state = sim.relax(1e-4)
    assert state.n_contacts[0] == 1
    assert not state.hessian().free.any()
    hessian = state.hessian(rattlers=False)
    assert hessian.free.tolist() == state.rattlers.tolist() == [True] + 31 * [False]
    assert state.modes(1).zero_modes == hessian.zero_modes == 6


def test_mean_shear_modulus_of_a_crystal() -> None:
    """Voigt's mean of a cubic crystal, (C11 - C12 + 3 C44)/5."""
    fcc = ld.crystal("fcc", 2, phi=0.78)
    moduli = evaluated(fcc, Droplet())[0].moduli()
    mean = (2.0 * moduli.pure_shear_modulus + 3.0 * moduli.shear_modulus) / 5.0
    assert moduli.mean_shear_modulus == pytest.approx(mean, rel=1e-9)
    assert abs(moduli.pure_shear_modulus - moduli.shear_modulus) > 0.05


def test_droplets_that_do_not_touch() -> None:
    state, _ = evaluated(ld.crystal("sc", 2, phi=0.4), Droplet())
    hessian = state.hessian()
    assert hessian.matrix.nnz == 0
    assert hessian.zero_modes == 24
    assert len(state.modes()) == 0


def test_what_acts_on_contacts_and_has_no_second_derivatives() -> None:
    """Walls that the packing does not know, and friction."""
    with ld.Simulation(ld.crystal("sc", 2, radius=1.0, phi=0.54), Droplet()) as sim:
        sim.lmp.command("fix floor all deformable/wall plane 0 0 -0.9 0 0 1")
        state = sim.state()
    assert (state.contacts["j"] < 0).any()
    with pytest.raises(ld.ParameterError, match="walls"):
        state.hessian()
    with (
        ld.Simulation(
            EMULSION.at(0.72).push_off(), Droplet(), friction=ld.Friction(0.3, kt=1.0)
        ) as sim,
        pytest.raises(ld.ParameterError, match="friction has no energy"),
    ):
        sim.state().hessian()


SCRIPT = """
import json, sys
sys.path[:] = {path!r}
from mpi4py import MPI
from exact_balance import exactly_balanced
from test_space_hessian import matrices
from validation.finite_strain import bulk_modulus, shear_modulus

with exactly_balanced():
    found = matrices()
assert MPI.COMM_WORLD.allgather(found) == [found] * MPI.COMM_WORLD.size
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(found))
"""


def matrices() -> list[list[float]]:
    """Of droplets on all ranks: H, and the derivatives by strains."""
    hessian = evaluated(EMULSION.at(0.72).push_off(), Droplet())[0].hessian()
    found = hessian.reduced(), hessian.by_strain[: hessian.size], hessian.strain
    return [matrix.ravel().tolist() for matrix in found]


def test_two_ranks_have_the_same_answer(tmp_path: Path) -> None:
    script = SCRIPT.format(path=sys.path)
    for mine, theirs in zip(matrices(), json.loads(python(script, tmp_path, 2)), strict=True):
        assert theirs == pytest.approx(mine, abs=1e-10 * np.abs(mine).max())
