"""Cells that grow, divide and die: closed forms, axes, pressure, clones."""

import math
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.protocols.proliferation import (
    Proliferate,
    divide,
    drawn_about,
    growth,
    long_axes,
    stretched_axes,
)
from lammps_deformable.state.labels import divided
from refusals import refused
from scipy.special import ive

CELL = ld.Ring(kA=20.0, kP=2.0, tension=1.0)
NEVER = 100.0  # size at which cells divide


def loose(number: int = 9) -> ld.Packing:
    """Cells far apart."""
    side = math.isqrt(number)
    places = [[3.0 * x + 1.5, 3.0 * y + 1.5] for x in range(side) for y in range(side)]
    return ld.Packing(places, 0.5, (3.0 * side, 3.0 * side))


def areas(state: ld.State) -> np.ndarray:
    return np.pi * state.radii**2


def test_free_cells_grow_by_their_rates() -> None:
    packing = loose().replace(species=np.arange(9) % 2)
    with ld.Simulation(packing, CELL) as sim:
        run = sim.proliferate([0.5, 0.0], division=NEVER, time=1.5, steps=3)
    grown = areas(run[-1]) / areas(run[0])
    assert grown == pytest.approx(np.exp(0.5 * 1.5 * (1 - packing.species)), rel=1e-12)
    assert [state.time for state in run] == pytest.approx([0.0, 0.5, 1.0, 1.5])
    assert run[-1].labels is None
    assert run[-1].clones is None


def test_two_in_the_place_of_one() -> None:
    with ld.Simulation(loose(), CELL) as sim:
        state = sim.state()
    axes = np.array([[1.0, 0.0], [0.6, 0.8]])
    cells = np.array([2, 5])
    two = divided(state, cells, axes, np.array([0.5, 0.3]), 40)
    assert two.labels.tolist() == [*range(9), 40, 41]
    assert two.clones.tolist() == [*range(9), 2, 5]
    volume = areas(two)
    assert volume[cells] == pytest.approx(areas(state)[cells] * [0.5, 0.3])
    assert volume[cells] + volume[9:] == pytest.approx(areas(state)[cells])
    center = volume[cells, None] * two.positions[cells] + volume[9:, None] * two.positions[9:]
    assert center / areas(state)[cells, None] == pytest.approx(state.positions[cells])
    apart = two.positions[cells] - two.positions[9:]
    distance = np.linalg.norm(apart, axis=1)
    assert apart / distance[:, None] == pytest.approx(axes)
    small = np.minimum(two.radii[cells], two.radii[9:])
    large = np.maximum(two.radii[cells], two.radii[9:])
    line = (distance**2 + small**2 - large**2) / (2.0 * distance)  # from the smaller one
    assert line == pytest.approx(0.5 * small)


def test_a_clone_in_free_space() -> None:
    """Its area grows as if none had divided, and each cell stays below the size of division."""
    alone = ld.Packing([[20.0, 20.0]], 0.5, (40.0, 40.0))
    with ld.Simulation(alone, CELL) as sim:
        run = sim.proliferate(1.0, division=1.2, time=4.0, steps=8, seed=3)
    last = run[-1]
    assert areas(last).sum() == pytest.approx(math.pi / 4 * math.exp(4.0), rel=1e-9)
    assert (areas(last) < 1.2).all()
    assert len(last.packing) >= 32
    assert sorted(last.labels) == list(range(len(last.packing)))
    assert set(last.clones) == {0}
    born = run.events()["event"] == "is born"
    assert born.sum() == len(last.packing) - 1


def test_a_container_fills_and_growth_stops_at_the_pressure() -> None:
    start = ld.Packing([[4.0, 4.0]], [0.5], (8.0, 8.0)).between(ld.Sphere(3.0, (4.0, 4.0)))
    with ld.Simulation(start, CELL) as sim:
        *_, before, last = sim.proliferate(
            1.0, division=1.2, time=12.0, steps=4, pressure=1.0, seed=1
        )
    pressure = np.trace(last.particle_stress, axis1=1, axis2=2) / 2.0
    assert 0.99 < pressure.min() < pressure.max() < 2.0  # others may have grown a little later
    assert last.phi == pytest.approx(before.phi, rel=1e-3)
    assert last.phi > 0.9
    assert last.converged


def test_cells_that_outgrow_their_box_are_told_of_the_pressure() -> None:
    with ld.Simulation(ld.crystal("hex", (2, 2), phi=0.95), ld.Ring()) as sim:
        sim.proliferate(1.0, division=NEVER, time=0.02)
        with (
            pytest.warns(ld.BeyondModelWarning),
            refused("no room to grow at time .*: give a pressure at", ld.ParameterError),
        ):
            sim.proliferate(1.0, division=NEVER, time=9.0)


def test_growth_by_the_pressure_of_contacts() -> None:
    """1 - p/P, p = sum f h/2V with V without contacts, as fix deformable/proliferate has it."""
    packing = ld.Packing([[1.0, 2.0], [1.85, 2.0], [2.9, 2.1]], [0.5, 0.6, 0.7], (3.4, 4.0))
    with ld.Simulation(packing, CELL) as sim:
        state = sim.state()
    table = state.contacts
    moments = table["force"] * (state.radii[table["i"]] - table["indentation"])
    pressure = np.bincount(table["i"], moments) / (2.0 * areas(state))
    most = 1.5 * pressure.max()
    assert (pressure > 0.0).all()
    assert growth(state, 3.0, most) == pytest.approx(3.0 * (1.0 - pressure / most), rel=1e-9)


def test_deaths_by_chance() -> None:
    number = 196
    with ld.Simulation(loose(number), CELL) as sim:
        run = sim.proliferate(0.0, division=NEVER, time=1.0, steps=2, death=0.5, seed=5)
    left = [len(state.packing) for state in run]
    for found, time in zip(left, (0.0, 0.5, 1.0), strict=True):
        chance = math.exp(-0.5 * time)
        spread = math.sqrt(number * chance * (1.0 - chance))
        assert abs(found - number * chance) <= 4.0 * spread
    assert (np.diff(run[-1].labels) > 0).all()
    assert areas(run[-1]) == pytest.approx(math.pi / 4)


def test_the_last_cell_stays() -> None:
    with ld.Simulation(loose(4), CELL) as sim:
        last = sim.proliferate(0.0, division=NEVER, time=0.1, death=100.0)[-1]
    assert len(last.packing) == 1


@pytest.fixture(scope="module")
def squeezed() -> ld.State:
    """Cells in a row along x: they are long along y, and pressed along x."""
    packing = ld.Packing([[0.4, 3.0], [1.2, 3.0], [2.0, 3.0]], 0.5, (2.4, 6.0))
    with ld.Simulation(packing, CELL) as sim:
        return sim.state()


@pytest.mark.parametrize("axes", [long_axes, stretched_axes])
def test_axes_across_the_pressure(squeezed: ld.State, axes) -> None:
    found = axes(squeezed, np.array([1]))
    assert np.abs(found) == pytest.approx(np.array([[0.0, 1.0]]), abs=1e-6)


@pytest.mark.parametrize("axis", ["long", "stress"])
def test_daughters_lie_on_the_axis(squeezed: ld.State, axis: str) -> None:
    cells = Proliferate(rate=1.0, time=1.0, division=0.5, axis=axis, asymmetry=0.0)
    two = divide(squeezed, squeezed.radii, cells, {"label": 3}, np.random.default_rng(1))
    assert two.clones.tolist() == [0, 1, 2, 0, 1, 2]
    apart = two.positions[:3] - two.positions[3:]
    assert np.abs(apart) == pytest.approx(np.tile([0.0, 0.5 / math.sqrt(2.0)], (3, 1)), abs=1e-6)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("kappa", [0.0, 0.7, 12.0])
def test_directions_about_an_axis(d: int, kappa: float) -> None:
    """<cos 2 theta> = I2/I0, or <cos theta> = coth kappa - 1/kappa, at five standard errors."""
    axis = np.array([0.6, 0.8, 0.0])[:d]
    drawn = drawn_about(np.tile(axis, (3000, 1)), kappa, np.random.default_rng(1))
    np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), 1.0, rtol=1e-12)
    cosine = drawn @ axis
    values = 2.0 * cosine**2 - 1.0 if d == 2 else cosine
    expected = ive(2, kappa) / ive(0, kappa)
    if d == 3:
        expected = 1.0 / np.tanh(kappa) - 1.0 / kappa if kappa else 0.0
    assert abs(values.mean() - expected) < 5.0 * values.std() / np.sqrt(3000)


def test_rates_by_place() -> None:
    """Free cells grow by a formula of their places, as they do in *fix deformable/proliferate*."""
    places = [[2.0, 2.0], [6.0, 2.0], [10.0, 2.0]]
    with ld.Simulation(ld.Packing(places, 0.5, [12.0, 4.0]), ld.Ring()) as sim:
        grown = sim.proliferate("exp(-x/4)", division=9.0, time=0.5, steps=2)[-1]
        rate = np.exp(-np.array(places)[:, 0] / 4.0)
        np.testing.assert_allclose(grown.radii, 0.5 * np.exp(0.25 * rate), rtol=1e-12)
        for rate, message in (
            ("3 - x", "rate = '3 - x' is -3 at particle 1: not a rate"),
            ("exp(", r"rate = 'exp\(' is no atom-style formula"),
        ):
            with refused(message):
                sim.proliferate(rate, division=9.0, time=0.5)
        with refused("kappa is that of directions about an axis"):
            sim.proliferate(1.0, division=9.0, time=0.5, kappa=1.0)
        with refused("kappa must not be negative"):
            sim.proliferate(1.0, division=9.0, time=0.5, axis="long", kappa=-1.0)


@pytest.mark.parametrize("axis", ["random", "long", "stress"])
def test_free_cells_divide_in_all_directions(axis: str) -> None:
    with ld.Simulation(loose(196), CELL) as sim:
        state = sim.state()
    cells = Proliferate(rate=1.0, time=1.0, division=0.5, axis=axis, asymmetry=0.0)
    two = divide(state, state.radii, cells, {"label": 196}, np.random.default_rng(1))
    apart = two.positions[:196] - two.positions[196:]
    angle = np.arctan2(apart[:, 1], apart[:, 0])
    for k in (1, 2, 4):
        assert abs(np.exp(1j * k * angle).mean()) < 3.0 / 14.0


def test_the_same_seed_is_the_same_tissue(tmp_path: Path) -> None:
    def tissue(**how) -> ld.State:
        with ld.Simulation(loose(4), CELL) as sim:
            return sim.proliferate(1.0, division=1.0, time=1.5, steps=3, death=0.1, **how)[-1]

    one, same, other = tissue(seed=7), tissue(seed=7), tissue(seed=8)
    assert np.array_equal(one.positions, same.positions)
    assert len(one.packing) != len(other.packing) or (one.positions != other.positions).any()
    recorded = tissue(seed=7, record=tmp_path)
    assert np.array_equal(recorded.labels, one.labels)
    assert np.array_equal(recorded.clones, one.clones)


@pytest.mark.parametrize("axis", ["long", "stress"])
def test_cells_die_while_others_divide_along_an_axis(axis: str) -> None:
    """Axes are those of the cells that are there, whoever dies."""
    dense = ld.Packing([[0.4 + 0.8 * n, 1.0] for n in range(10)], 0.5, (8.0, 2.0))
    with ld.Simulation(dense, CELL) as sim:
        run = sim.proliferate(
            1.0, division=1.0, time=1.0, steps=3, death=1.0, axis=axis, seed=4, pressure=5.0
        )
    events = run.events()["event"]
    assert (events == "vanishes").any()
    assert (events == "is born").any()
    assert all(state.converged for state in run)


def test_labels_of_the_dead_are_not_given_again() -> None:
    with ld.Simulation(loose(4), CELL) as sim:
        run = sim.proliferate(1.0, division=1.0, time=3.0, steps=30, death=0.5, seed=2)
    seen: set[int] = set()
    gone: set[int] = set()
    for state in run:
        here = set(range(4)) if state.labels is None else set(state.labels.tolist())
        assert not here & gone
        gone |= seen - here
        seen |= here
    assert gone
    assert max(seen) > 8


def test_droplets_divide_in_space() -> None:
    start = ld.Packing([[3.0, 3.0, 3.0]], 1.0, (12.0, 12.0, 12.0))
    with ld.Simulation(start, ld.Droplet()) as sim:
        run = sim.proliferate(1.0, division=5.0, time=2.0, steps=2, axis="stress", seed=1)
    volume = 4.0 / 3.0 * math.pi * run[-1].radii ** 3
    assert volume.sum() == pytest.approx(4.0 / 3.0 * math.pi * math.exp(2.0), rel=1e-9)
    assert len(volume) >= 6


def test_what_it_refuses() -> None:
    with ld.Simulation(loose(4), CELL) as sim:
        with refused("rate must not be negative, not -1"):
            sim.proliferate(-1.0, division=1.0, time=1.0)
        with refused("axis must be random, long or stress, not 'x'"):
            sim.proliferate(1.0, division=1.0, time=1.0, axis="x")
        with refused("asymmetry must be below 1"):
            sim.proliferate(1.0, division=1.0, time=1.0, asymmetry=1.0)
        with refused("pressure must be a positive number"):
            sim.proliferate(1.0, division=1.0, time=1.0, pressure=0.0)
    drop = ld.Packing([[3.0, 3.0, 3.0]], 1.0, (12.0, 12.0, 12.0))
    with ld.Simulation(drop, ld.Droplet()) as sim, refused("axis 'long' is for cells in the plane"):
        sim.proliferate(1.0, division=1.0, time=1.0, axis="long")
    rough = ld.Friction(0.3, kt=0.01)
    with (
        ld.Simulation(loose(4), ld.Ring(), friction=rough) as sim,
        refused("leave friction out of a simulation that proliferates"),
    ):
        sim.proliferate(1.0, division=1.0, time=1.0)
