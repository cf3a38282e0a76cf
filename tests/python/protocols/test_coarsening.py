"""Gas that flows through films: sums over contacts, closed forms, bubbles that vanish."""

import math
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.protocols.coarsening import after, gas_flow
from lammps_deformable.state.labels import labels_of, remaining
from refusals import refused
from scipy.integrate import solve_ivp

FOAM = ld.Ring(kA=math.inf, kP=0, tension=1.0, contact="curved", reach=2.0)


@pytest.fixture(scope="module")
def foam() -> ld.State:
    with ld.Simulation(ld.jam(ld.bidisperse(32, seed=1)).packing, FOAM) as sim:
        return sim.compress(phi=0.97, steps=4)[-1]


@pytest.fixture(scope="module")
def emulsion() -> ld.State:
    packing = ld.jam(ld.bidisperse(16, dimension=3, seed=3)).packing
    with ld.Simulation(packing.at(0.75), ld.Droplet()) as sim:
        return sim.relax()


def areas(state: ld.State) -> np.ndarray:
    return np.pi * state.radii**2


def test_the_sum_over_films_one_by_one(foam: ld.State) -> None:
    """Each side of a film has its length; the free rest of an outline lets gas into the liquid."""
    expected, free = np.zeros(32), foam.perimeters.copy()
    for row in foam.contacts:
        i, j = row["i"], row["j"]
        expected[i] -= row["length"] * (foam.pressures[i] - foam.pressures[j])
        free[i] -= row["length"]
    assert gas_flow(foam, 3.0) == pytest.approx(3.0 * expected, rel=1e-6, abs=1e-9)
    free /= foam.radii
    liquid = (free * foam.pressures).sum() / free.sum()
    expected -= 0.2 * free * (foam.pressures - liquid)
    assert gas_flow(foam, 3.0, 0.2) == pytest.approx(3.0 * expected, rel=1e-6, abs=1e-9)


def test_bubbles_with_less_than_six_neighbors_shrink(foam: ld.State) -> None:
    """And the others grow, as in the dry limit, by less, as the films are shorter."""
    flow, neighbors = gas_flow(foam, 1.0), foam.n_contacts
    assert flow.sum() == pytest.approx(0.0, abs=1e-12)
    for n in np.unique(neighbors[neighbors != 6]):
        dry = 2.0 * math.pi / 3.0 * (n - 6)
        assert 0.3 < flow[neighbors == n].mean() / dry < 1.0


def test_a_short_time_takes_the_flow(foam: ld.State) -> None:
    with ld.Simulation(foam, FOAM) as sim:
        before, after = sim.coarsen(2.0, time=1e-4, border=0.1)
    flow = gas_flow(foam, 2.0, 0.1)
    assert (areas(after) - areas(before)) / 1e-4 == pytest.approx(flow, rel=1e-6, abs=1e-6)
    assert after.time == pytest.approx(1e-4)


def test_two_bubbles_in_the_liquid() -> None:
    """dV_1/dt = -2 pi border permeability tension (1/R_1 - 1/R_2)/2: Euler's method."""
    packing = ld.Packing([[2.0, 2.0], [6.0, 6.0]], [0.9, 1.1], (8.0, 8.0))
    with ld.Simulation(packing, ld.Ring(kA=math.inf, kP=0, tension=0.7)) as sim:
        end = sim.coarsen(3.0, time=0.3, steps=10, border=0.5)[-1]

    def flow(_: float, volume: np.ndarray) -> np.ndarray:
        small, large = np.sqrt(volume / math.pi)
        rate = 2.0 * math.pi * 0.5 * 3.0 * 0.7 * 0.5 * (1.0 / small - 1.0 / large)
        return np.array([-rate, rate])

    exact = solve_ivp(flow, (0.0, 0.3), math.pi * packing.radii**2, rtol=1e-10).y[:, -1]
    assert areas(end) == pytest.approx(exact, rel=0.01)
    assert abs(exact[0] / areas(end)[0] - 1.0) > 1e-6  # it has an error that could be seen


def test_the_small_vanish_and_their_gas_stays(foam: ld.State) -> None:
    with ld.Simulation(foam, FOAM) as sim:
        run = sim.coarsen(1.0, time=areas(foam).mean(), steps=8)
    last = run[-1]
    assert 8 < len(last.packing) < 28
    for state in run:
        assert areas(state).sum() == pytest.approx(areas(foam).sum(), rel=1e-12)
        assert state.converged
    assert run[0].labels is None
    assert set(last.labels) < set(range(32))
    events = run.events()
    gone = events["i"][events["event"] == "vanishes"]
    assert sorted([*gone, *last.labels]) == list(range(32))
    assert events["time"] == pytest.approx([run[n].time for n in events["frame"]])
    # a bubble moves little while others vanish, if it is the same
    before, now = run[-2], run[-1]
    here = {label: n for n, label in enumerate(labels_of(before))}
    same = [here[label] for label in now.labels]
    moved = now.positions - before.positions[same]
    box = np.diag(now.box)
    moved -= np.rint(moved / box) * box
    assert np.median(np.linalg.norm(moved, axis=1)) < 0.3 * now.radii.mean()


def test_it_goes_on_where_it_ended(foam: ld.State, tmp_path: Path) -> None:
    """Labels go with a state, its folder, and a simulation of it."""
    time = areas(foam).mean()
    with ld.Simulation(foam, FOAM) as sim:
        run = sim.coarsen(1.0, time=time, steps=4, record=tmp_path / "run")
        labels = run[-1].labels
        assert np.array_equal(sim.state().labels, labels)
        assert np.array_equal(sim.relax().labels, labels)
    run[-1].save(tmp_path / "saved")
    with ld.Run(tmp_path / "saved").simulation() as sim:
        assert np.array_equal(sim.state().labels, labels)
        more = sim.coarsen(1.0, time=time)
    assert more[-1].time == pytest.approx(2.0 * time)
    assert set(more[-1].labels) <= set(labels)


@pytest.mark.parametrize("border", [0.0, 0.1])
def test_droplets_in_space(emulsion: ld.State, border: float) -> None:
    with ld.Simulation(emulsion, emulsion.law) as sim:
        run = sim.coarsen(1.0, time=0.5, steps=2, border=border)
    volume = [4.0 / 3.0 * math.pi * state.radii**3 for state in run]
    assert [each.sum() for each in volume] == pytest.approx([volume[0].sum()] * 3, rel=1e-12)
    small = emulsion.radii < emulsion.radii.mean()
    assert volume[-1][small].mean() < volume[0][small].mean()


def test_many_vanish_at_once() -> None:
    """Of those without films all take the gas; one that has lost too much is gone as well."""
    places = [[2.0 * x, 2.0 * y] for x in range(1, 6) for y in range(1, 6)]
    radii = np.where(np.arange(25) % 3 == 0, 0.9, 0.16)
    packing = ld.Packing(places, radii, (12.0, 12.0))
    with ld.Simulation(packing, ld.Ring(kA=math.inf, kP=0, tension=1.0)) as sim:
        state = sim.state()
    change = np.where(radii < 0.5, -0.2, 0.0)
    after_it = after(state, change)
    assert len(after_it.packing) == 9
    assert areas(after_it).sum() == pytest.approx(areas(state).sum() + change.sum(), rel=1e-12)


def test_films_of_those_that_are_left() -> None:
    """Numbers follow; codes of walls stay."""
    law = ld.Ring(kA=20.0, kP=2.0, tension=1.0, adhesion=0.2, contact="curved")
    places = [[1.0, 0.5], [1.95, 0.5], [2.9, 0.5], [3.85, 0.5]]
    packing = ld.Packing(places, 0.5, (8.0, 4.0))
    with ld.Simulation(packing, law) as sim:
        state = sim.state()
    assert state.films.tolist() == [[1, 2], [2, 3], [3, 4]]
    left = remaining(state, np.array([True, False, True, True]))
    assert left.films.tolist() == [[2, 3]]
    assert left.labels.tolist() == [0, 2, 3]
    assert remaining(left, np.array([False, True, True])).labels.tolist() == [2, 3]


def test_a_species_without_bubbles_keeps_its_place() -> None:
    """So that the numbers of a law stay those of their species."""
    law = ld.Ring(kA=math.inf, kP=0, tension=[1.0, 2.0])
    packing = ld.Packing([[2.0, 2.0], [6.0, 6.0], [2.0, 6.0]], [1.0, 1.0, 0.2], (8.0, 8.0))
    with ld.Simulation(packing.replace(species=[0, 0, 1]), law) as sim:
        end = sim.coarsen(1.0, time=0.1, border=1.0)[-1]
    assert end.labels.tolist() == [0, 1]
    assert end.law == law


def test_what_it_refuses(foam: ld.State) -> None:
    with ld.Simulation(foam, FOAM) as sim:
        with refused("permeability must be a positive number, not -1"):
            sim.coarsen(-1.0, time=1.0)
        with refused("border must not be negative"):
            sim.coarsen(1.0, time=1.0, border=-0.1)
        with refused("time must be a positive number"):
            sim.coarsen(1.0, time=0.0)
    with (
        ld.Simulation(foam.packing, ld.SoftContact()) as sim,
        refused("the law of bubbles must be of the kind Ring or Droplet"),
    ):
        sim.coarsen(1.0, time=1.0)
    rough = ld.Friction(0.3, kt=0.01)
    with (
        ld.Simulation(foam.packing, ld.Ring(), friction=rough) as sim,
        refused("leave friction out of a simulation that coarsens"),
    ):
        sim.coarsen(1.0, time=1.0)
