"""Second derivatives of states of the ring laws: Hessian, modes and moduli."""

import json
import math
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.relax import polish
from lammps_deformable.state.hessian import open_contacts
from ranks import here, python

pytestmark = pytest.mark.usefixtures("exact_balance")

STIFFNESS = {
    "perimeter": {"kA": 2.0},
    "finite": {"kA": 1.0, "kP": 0.3, "skin": 0.02},
    "area": {"kA": math.inf, "kP": 1.0},
    "droplets": {"kA": math.inf, "kP": 0.0, "tension": 1.0},
    "mixture": {"kA": [1.0, 3.0], "kP": [0.5, math.inf], "skin": [0.0, 0.05]},
}
LINES = {"radical": 0, "balanced": 1, "curved": 3}  # variables of a contact line
LAWS = {
    f"{contact}-{name}": ld.Ring(contact=contact, **values)
    for contact in LINES
    for name, values in STIFFNESS.items()
}
SCENES = {
    "circle": (ld.Sphere(4, (0, 0)), ld.Sphere(0.6, (1, 0.5), inside=False)),
    "corners": (
        *(ld.Plane((0, y), (0, sign)) for y, sign in ((0, 1), (5, -1))),
        ld.PolygonWall(((1, 1.5), (3, 1.5), (2, 3.5))),
    ),
}


@pytest.fixture(scope="module")
def packing() -> ld.Packing:
    jammed = ld.jam(ld.bidisperse(20, seed=3)).packing
    return jammed.at(jammed.phi + 0.03)


@pytest.fixture(
    params=[
        "radical-perimeter",
        "radical-mixture",
        "balanced-finite",
        "balanced-droplets",
        "curved-area",
        "curved-mixture",
    ]
)
def law(request: pytest.FixtureRequest) -> ld.Ring:
    return LAWS[request.param]


def evaluated(packing: ld.Packing, law: ld.Ring) -> tuple[ld.State, np.ndarray]:
    """State of a packing as it is, and the gradient of the energy that LAMMPS finds, (2N,)."""
    with ld.Simulation(packing, law) as sim:
        state = sim.state()
        forces = np.array(sim.lmp.gather("f", 1, 3)).reshape(-1, 3)[:, :2]
    return state, -forces.ravel()


def difference(packing: ld.Packing, law: ld.Ring, direction: np.ndarray):
    """Change of the gradient per step along a direction, with an error of the fourth order."""

    def gradient(step: float) -> np.ndarray:
        positions = packing.positions + step * direction.reshape(-1, 2)
        return evaluated(packing.replace(positions=positions), law)[1]

    near, far = ((gradient(h) - gradient(-h)) / (2.0 * h) for h in (2e-6, 4e-6))
    return (4.0 * near - far) / 3.0


def agrees(packing: ld.Packing, law: ld.Ring) -> ld.State:
    """Compare energy, gradient, stress and Hessian with those of LAMMPS."""
    state, gradient = evaluated(packing, law)
    hessian = state.hessian()
    force = float(state.contacts["force"].max())
    assert hessian.energy == pytest.approx(state.energy, rel=1e-11)
    assert hessian.gradient[: hessian.size] == pytest.approx(gradient, abs=1e-11 * force)
    assert hessian.gradient[hessian.size :] == pytest.approx(0.0, abs=1e-11 * force)
    if not packing.walls:
        scale = np.abs(state.pressure_tensor).max()
        assert hessian.stress == pytest.approx(state.pressure_tensor, abs=1e-11 * scale)
    matrix = hessian.matrix
    assert abs(matrix - matrix.T).max() <= 1e-15 * abs(matrix).max()
    direction = np.random.default_rng(1).standard_normal(hessian.size)
    exact = difference(packing, law, direction)
    found = hessian.operator @ direction
    assert found == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    assert hessian.reduced() @ direction == pytest.approx(found, abs=1e-12 * np.abs(found).max())
    return state


def test_every_law_and_stiffness(packing: ld.Packing, law: ld.Ring) -> None:
    state = agrees(packing, law)
    hessian = state.hessian()
    lines = hessian.matrix.shape[0] - 2 * len(packing)
    pairs = len({tuple(sorted((row["i"], row["j"]))) for row in state.contacts})
    assert lines == LINES[law.contact] * pairs
    assert repr(hessian) == f"<Hessian: 20 particles, {lines} variables of contact lines>"


@pytest.mark.parametrize("contact", ["radical", "curved"])
def test_any_sizes(contact: str) -> None:
    """Radii from 0.3 to 0.7 in a tilted box."""
    start = ld.polydisperse(20, np.linspace(0.3, 0.7, 20), tilt=0.4, seed=2)
    jammed = ld.jam(start).packing
    law = ld.Ring(kA=1.0, kP=0.5, contact=contact)
    agrees(jammed.at(jammed.phi + 0.03), law)


@pytest.mark.parametrize(
    ("scene", "contact"), [("circle", "radical"), ("circle", "curved"), ("corners", "balanced")]
)
def test_walls(scene: str, contact: str) -> None:
    """Flat and round ones, from inside and outside, and corners."""
    law = ld.Ring(kA=1.0, kP=0.5, contact=contact)
    start = ld.bidisperse(40, seed=1).between(SCENES[scene]).at(0.9)
    with ld.Simulation(start.push_off(), law) as sim:
        state = sim.relax(1e-3)
    assert (state.contacts["j"] < 0).sum() > 5
    # at rest a particle may sit where a face ends, and there the force of the wall has a jump
    shift = np.random.default_rng(1).uniform(-0.005, 0.005, state.packing.positions.shape)
    moved = state.packing.replace(positions=state.packing.positions + shift)
    agrees(moved, law)


@pytest.mark.parametrize("contact", ["radical", "curved"])
def test_a_particle_and_its_own_images(contact: str) -> None:
    """A crystal of one particle: nothing moves, and the moduli are those of four."""
    law = ld.Ring(kA=1.0, kP=0.4, contact=contact)
    one = ld.bidisperse(1, phi=0.94, aspect=0.88, tilt=0.54, seed=1)
    steps = np.array([(a, b) for a in (0, 1) for b in (0, 1)]) @ one.box
    four = ld.Packing(one.positions + steps, 0.5, 2 * one.box)
    one = one.replace(species=[0], radii=0.5)
    states = [evaluated(packing, law)[0] for packing in (one, four)]
    assert np.abs(states[0].hessian().reduced()).max() < 1e-14
    left, right = (state.moduli() for state in states)
    assert left.tensor == pytest.approx(right.tensor, abs=1e-12)
    assert right.shear_modulus > 1e-4


@pytest.fixture(scope="module", params=["balanced-finite", "curved-droplets"])
def relaxed(request: pytest.FixtureRequest) -> ld.State:
    jammed = ld.jam(ld.bidisperse(64, seed=5)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.03), LAWS[request.param]) as sim:
        return polish(sim, sim.relax(1e-6), 1e-10)  # which frees rattlers of contacts


def test_contacts_of_rattlers_have_two_sides() -> None:
    """Also where only one side of a radical axis bears a force worth mentioning."""
    start = ld.bidisperse(20, phi=0.83, seed=3).push_off()
    law = ld.Ring(kA=[1.0, 50.0], kP=[0.5, math.inf], contact="radical")
    state, _ = evaluated(start, law)
    sides, _ = open_contacts(state)
    there = list(zip(sides.i, sides.j, strict=True))
    assert sorted(there) == sorted((j, i) for i, j in there)
    assert 0 < len(there) < len(state.contacts)


def test_affine_moduli_leave_the_lines_free(relaxed: ld.State) -> None:
    """Stress of packings whose centers follow a strain, with lines that LAMMPS balances."""
    moduli, packing, h = relaxed.moduli(), relaxed.packing, 5e-8

    def stress(strain: float) -> float:
        gradient = np.array([[1.0, strain], [0.0, 1.0]])
        moved = packing.replace(
            positions=packing.positions @ gradient.T, box=packing.box @ gradient.T
        )
        return -float(evaluated(moved, relaxed.law)[0].pressure_tensor[0, 1])

    near, far = ((stress(s) - stress(-s)) / (2.0 * s) for s in (h, 2.0 * h))
    affine = (4.0 * near - far) / 3.0
    assert moduli.affine[0, 1, 0, 1] == pytest.approx(affine, rel=1e-6)


def test_errors(packing: ld.Packing) -> None:
    with ld.Simulation(packing, ld.Sector()) as sim:
        state = sim.state()
    with pytest.raises(ld.ParameterError, match="sector"):
        state.hessian()
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.lmp.command("fix other all deformable/wall plane -50 0 1 0")
        state = sim.state()
    with pytest.raises(ld.ParameterError, match="walls"):
        state.modes()


def test_lines_at_the_largest_tilt() -> None:
    packing = ld.bidisperse(1, phi=1.9, aspect=0.88, tilt=0.54, seed=1)
    with ld.Simulation(packing, ld.Ring(kP=0.4, contact="curved")) as sim:
        state = sim.state()
    assert np.abs(state.contacts["tilt"]).max() == pytest.approx(0.3)
    with pytest.raises(ld.ParameterError, match=r"particle 0.*0\.3"):
        state.hessian()


SCRIPT = """
import json, math, sys
sys.path[:0] = [{tests!r}]
from mpi4py import MPI
import lammps_deformable as ld
from exact_balance import exactly_balanced

packing = ld.Run({folder!r}).simulation().state().packing
found = []
for contact in {contacts!r}:
    law = ld.Ring(kA=1.0, kP=0.3, contact=contact)
    with exactly_balanced(), ld.Simulation(packing, law) as sim:
        state = sim.state()
    hessian = state.hessian()
    matrices = hessian.reduced(), hessian.by_strain[: hessian.size], hessian.strain
    numbers = [matrix.ravel().tolist() for matrix in matrices]
    assert MPI.COMM_WORLD.allgather(numbers) == [numbers] * MPI.COMM_WORLD.size
    found.append(numbers)
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(found))
"""


def test_any_number_of_ranks_has_the_same_answer(packing: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(packing, ld.Ring(kA=1.0, kP=0.3)) as sim:
        sim.relax(1e-4).save(tmp_path / "start")
    tests = str(Path(__file__).parents[1])
    contacts = ["radical", "curved"]
    script = SCRIPT.format(tests=tests, folder=str(tmp_path / "start"), contacts=contacts)
    one, two = map(json.loads, (here(script), python(script, tmp_path, 2)))
    for mine, theirs in zip(one, two, strict=True):
        for first, second in zip(mine, theirs, strict=True):
            assert second == pytest.approx(first, abs=1e-11 * np.abs(first).max())
