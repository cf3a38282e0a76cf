"""Smooth polygons against an independent code, and Newton's method on them."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import crystal
from lammps_deformable import core
from lammps_deformable.engine.lammps import gather
from lammps_deformable.engine.polygon_engine import SmoothPolygons, have_crossed
from naive_polygons import pair
from refusals import refused

pytestmark = pytest.mark.filterwarnings("error")

# A packing in three states, made by a code that shares nothing with this project; `note` describes
# it. Places of vertices are in it to all digits.
STORED = Path(__file__).parents[2] / "data"
DATA = json.loads((STORED / "smooth_packing.json").read_text())
STATES = {state["state"]: state for state in DATA["states"]}
EXACT = ld.DeformablePolygon(
    DATA["N_v"], radius=0.5 * DATA["c"], kL=DATA["kL"], kA=1.0, kr=DATA["kr"]
)
KERNEL = SmoothPolygons(
    EXACT,
    EXACT.polygons(np.array(DATA["radii_law"])),
    np.array(DATA["species"]),
    np.diag(DATA["box"]),
)
FINE = ld.DeformablePolygon(80, radius=0.025, kL=480.0, kr=10.0)


def vertices(state: dict[str, Any]) -> np.ndarray:
    return np.vstack(state["vertices"])


@pytest.fixture(params=STATES)
def expected(request: pytest.FixtureRequest) -> dict[str, Any]:
    return STATES[request.param]


@pytest.fixture
def in_lammps(expected: dict[str, Any]) -> Iterator[ld.Simulation]:
    """The polygons of the independent code in LAMMPS."""
    packing = ld.Packing(
        expected["centres_mean"],
        np.array(DATA["radii_law"])[DATA["species"]],
        np.diag(DATA["box"]),
        species=DATA["species"],
    )
    loose = packing.at(0.6)  # polygons must not overlap at the start
    with ld.Simulation(loose, EXACT) as sim:
        sim.deform(packing.box)
        place(sim, vertices(expected))
        yield sim


def place(sim: ld.Simulation, x: np.ndarray) -> None:
    placed = np.zeros((len(x), 3))
    image = np.array(sim.lmp.gather("image", 0, 3)).reshape(-1, 3)
    placed[:, :2] = x - image[:, :2] @ sim.box
    sim.lmp.scatter("x", 1, 3, np.ctypeslib.as_ctypes(placed.ravel()))


def test_rest_values_are_those_of_the_independent_code() -> None:
    polygons = EXACT.polygons(np.array(DATA["radii_law"]))
    assert polygons.spacing == pytest.approx(DATA["l0"], rel=1e-14)
    assert polygons.radius == pytest.approx(DATA["circumradius"], rel=1e-14)
    assert polygons.area == pytest.approx(DATA["A0"], rel=1e-14)
    assert polygons.kP == pytest.approx(DATA["kP"], rel=1e-14)
    assert polygons.effective_radius.tolist() == DATA["radii_law"]
    assert polygons.skin == pytest.approx(0.5 * DATA["c"])


def test_energies_and_forces_of_the_kernel(expected: dict[str, Any]) -> None:
    at = KERNEL.energy(vertices(expected))
    assert at.springs == pytest.approx(expected["energy_springs"], rel=1e-9)
    assert at.areas == pytest.approx(expected["energy_area"], rel=1e-9)
    assert at.contacts == pytest.approx(expected["energy_contacts"], rel=1e-9)
    assert at.energy == pytest.approx(expected["energy"], rel=1e-9)
    assert -at.gradient == pytest.approx(np.vstack(expected["forces"]), abs=1e-8)
    assert at.pressure == pytest.approx(np.array(expected["area_deficits"]), abs=1e-14)


def test_state_in_lammps(expected: dict[str, Any], in_lammps: ld.Simulation) -> None:
    state = in_lammps.state()
    force = gather(in_lammps.lmp, "f", 3)[:, :2]
    assert state.energy == pytest.approx(expected["energy"], rel=1e-9)
    assert force == pytest.approx(np.vstack(expected["forces"]), abs=1e-8)
    assert state.results["area"] == pytest.approx(expected["areas"], rel=1e-12)
    assert state.area_deficit == pytest.approx(expected["area_deficits"], abs=1e-12)
    assert state.perimeters == pytest.approx(expected["perimeters"], rel=1e-12)
    assert state.pressure_tensor == pytest.approx(np.array(expected["stress"]), rel=1e-9, abs=1e-12)
    apart = state.packing.positions - np.array(expected["centres_steiner"])
    apart -= np.rint(apart / DATA["box"]) * DATA["box"]
    assert np.abs(apart).max() < 1e-12
    contacts = state.contacts
    given = {(c["i"], c["j"]): np.array(c["force_on_i"]) for c in expected["contacts"]}
    found = {(c["i"], c["j"]): c["force_vector"] for c in contacts if c["i"] < c["j"]}
    assert 2 * len(found) == len(contacts)
    for key in given.keys() | found.keys():
        zero = np.zeros(2)
        assert found.get(key, zero) == pytest.approx(given.get(key, zero), abs=1e-9)


def test_the_balanced_law_at_the_centers() -> None:
    state = STATES["relaxed"]
    packing = ld.Packing(
        state["centres_steiner"],
        np.array(DATA["radii_law"])[DATA["species"]],
        np.diag(DATA["box"]),
        species=DATA["species"],
    )
    polygons = EXACT.polygons(np.array(DATA["radii_law"]))
    law = ld.Ring(polygons.kA, kP=polygons.kP, skin=polygons.skin)
    given = DATA["law"]["at_steiner_points"]
    with ld.Simulation(packing, law) as particles:
        found = particles.state()
    assert found.energy == pytest.approx(given["energy"], rel=1e-7)
    assert found.pressure == pytest.approx(given["pressure"], rel=1e-7)
    assert found.area_deficit == pytest.approx(given["area_deficits"], rel=1e-6)


@pytest.mark.parametrize("name", STATES)
def test_second_derivatives(name: str) -> None:
    """Along random directions; where a vertex gets into touch, they jump."""
    state = STATES[name]
    x = vertices(state)
    at = KERNEL.energy(x)
    row, column, value = at.hessian()
    rng, step = np.random.default_rng(5), 1e-7
    for _ in range(3):
        move = rng.normal(size=x.shape)
        ahead, behind = (KERNEL.energy(x + sign * step * move).gradient for sign in (1.0, -1.0))
        product = np.zeros(x.size)
        np.add.at(product, row, value * move.ravel()[column])
        product = product.reshape(-1, 2)
        first = np.cumsum(KERNEL.number) - KERNEL.number
        along = np.add.reduceat(np.sum(at.area_gradient * move, axis=1), first)
        product += at.area_gradient * np.repeat(along, KERNEL.number)[:, None]  # kA = 1
        # rounding of forces up to 400 over the step, and third derivatives times its square
        assert (ahead - behind) / (2.0 * step) == pytest.approx(product, abs=2e-5)


@pytest.fixture(scope="module")
def relaxed() -> ld.State:
    """Six particles, compressed by 2 %."""
    jammed = ld.jam(ld.bidisperse(6, tilt=0.3, seed=1)).packing
    model = ld.DeformablePolygon(40, radius=0.025, kL=240.0, kr=10.0)
    with ld.Simulation(jammed, model) as sim:
        sim.deform(0.98 * sim.box)
        state = sim.relax()
        again = sim.relax()  # it is at rest, and stays there
        assert gather(sim.lmp, "f", 3)[:, :2] == pytest.approx(0.0, abs=1e-9)
    assert again.energy == pytest.approx(state.energy, rel=1e-10)  # roundings of coordinates
    return state


def test_newton_relaxes_to_rounding(relaxed: ld.State) -> None:
    assert relaxed.residual <= 1e-6
    assert relaxed.converged
    total = np.zeros((6, 2))
    np.add.at(total, relaxed.contacts["i"], relaxed.contacts["force_vector"])
    # N_v residuals of the force on a vertex
    scale = np.mean(relaxed.area_deficit * relaxed.polygons.spacing[relaxed.packing.species])
    assert np.abs(total).max() <= 57 * 1e-6 * scale


@pytest.mark.parametrize(
    ("indentation", "number", "ratio"), [(0.01, 160, 0.9998), (0.03, 40, 0.997)]
)
def test_crystal_against_the_exact_polygon(indentation: float, number: int, ratio: float) -> None:
    """With more vertices the energy comes to that of a hexagon; ratios of another code."""
    model = ld.DeformablePolygon(number, radius=0.025, kL=6.0 * number, kr=10.0)
    with ld.Simulation(crystal(0.0, 2, 2), model) as sim:
        for part in (0.5, 1.0):
            sim.deform(crystal(part * indentation, 2, 2).box)
            state = sim.relax()
    turn = np.arange(6) * np.pi / 3.0
    exact = core.soft_ring(0.5, turn, np.full(6, 0.5 * indentation), 1.0, 6.0, 0.025)
    # their last digit; polygons turned by half a spacing differ by less
    assert state.energy / (4.0 * exact.energy) == pytest.approx(ratio, abs=4e-4)


def test_soft_contacts_that_let_polygons_cross_are_given_up() -> None:
    """In one step contacts of 0.02 kr would let polygons of this packing pass each other."""
    stored = json.loads((STORED / "crossing_disks.json").read_text())
    radii = np.array(stored["radii"])[stored["species"]]
    jammed = ld.Packing(stored["positions"], radii, stored["box"], species=stored["species"])
    model = ld.DeformablePolygon(57, radius=0.025, kL=6.0 * 57, kr=10.0)
    energies = []
    for steps in (1, 3):
        with ld.Simulation(jammed, model) as sim:
            state = sim.compress(strain=0.03, steps=steps)[-1]
        assert state.residual <= 1e-6
        settings = SmoothPolygons(model, state.polygons, state.packing.species, state.packing.box)
        assert not have_crossed(settings, np.vstack(state.outlines))
        energies.append(state.energy)
    # polygons that are turned by parts of an edge differ by less
    assert energies[0] == pytest.approx(energies[1], rel=1e-3)


def test_polygons_that_have_crossed() -> None:
    """Through the sides of a tilted box too, wherever the polygons are unwrapped."""
    for shift, distance, crossed in (
        ((0.0, 0.0), 0.97, True),
        ((-2.0, 1.0), 0.97, True),
        ((-2.0, 1.0), 1.03, False),
    ):
        turn = 2.0 * np.pi * np.arange(80) / 80
        circle = 0.5 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        box = np.array([[3.0, 0.0], [0.7, 3.0]])
        settings = SmoothPolygons(
            FINE, FINE.polygons(np.array([0.525])), np.zeros(2, dtype=int), box
        )
        x = np.vstack([circle + 0.1, circle + 0.1 + (distance, 0.0) + np.array(shift) @ box])
        assert have_crossed(settings, x) == crossed, (shift, distance)


def test_soft_contacts_do_not_let_polygons_pass() -> None:
    """Areas so stiff that polygons would cross if contacts began at 0.002 kr."""
    jammed = ld.jam(ld.bidisperse(6, seed=1)).packing
    model = ld.DeformablePolygon(40, radius=0.025, kL=2400.0, kA=1000.0, kr=100.0)
    with ld.Simulation(jammed, model) as sim:
        sim.deform(0.96 * sim.box)
        state = sim.relax()
    assert state.residual <= 1e-6
    assert state.energy > 0.0


def test_edges_that_meet_their_images_are_refused() -> None:
    packing = pair(1.42)
    model = ld.DeformablePolygon(5, radius=0.1)  # edges of 0.5 at rest
    with (
        ld.Simulation(packing, model) as sim,
        pytest.raises(ld.LammpsError, match="more than half of the box"),
    ):
        sim.state()


def test_kernel_refuses() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    of_two = {key: [1.0, 1.0] for key in ("kL", "length", "kA", "area")}
    good: dict[str, Any] = {
        "vertices": np.vstack([square, square + 1.5]),
        "number": [4, 4],
        "box": 4.0 * np.eye(2),
        "kr": 1.0,
        "c": 0.1,
    }
    assert core.smooth_polygons(**good, **of_two).energy == 0.0
    for change, message in (
        ({"kr": 0.0}, "kr is 0"),
        ({"number": [4, 3]}, "vertices has 8 rows, but the polygons have 7"),
        ({"number": [6, 2]}, "number of vertices is 2"),
        ({"c": 1.5}, "below half of the box"),
        ({"vertices": np.full((8, 2), np.nan)}, "vertices"),
    ):
        with refused(message, ValueError):
            core.smooth_polygons(**(good | of_two | change))
