"""Self-propulsion: persistence, speed, records, and a second call."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused

FORCE, FRICTION, TAU = 1e-4, 2.0, 100.0
SPEED = FORCE / FRICTION
NUMBER = 1600
ACTIVE = {"drag": FRICTION, "propulsion": FORCE, "persistence": TAU}


@pytest.fixture(scope="module")
def free() -> ld.Packing:
    x, y = np.divmod(np.arange(NUMBER), 40)
    return ld.Packing(2.0 + 4.0 * np.column_stack([x, y]), 0.5, 160.0 * np.eye(2))


def square(state: ld.State, start: ld.Packing) -> np.ndarray:
    return np.sum((state.packing.positions - start.positions) ** 2, axis=1)


@pytest.mark.parametrize("inertia", [False, True])
def test_persistence(free: ld.Packing, inertia: bool) -> None:
    """<r^2> of free particles, at five standard errors of this sample, and <n(t).n(0)>.

    With inertia and the rates g = friction, k = 1/tau, velocities that begin at rest follow
    v' = g (v n - v), so that r is that of the directions less v/g: at g tau >> 1 a small part.
    """
    with ld.Simulation(free, ld.Ring()) as sim:
        start, *states = sim.run(1000, timestep=0.2, every=500, seed=1, inertia=inertia, **ACTIVE)
    assert start.time == 0.0
    for state in states:
        t = state.time
        found = square(state, free)
        expected = 2.0 * SPEED**2 * TAU * (t - TAU * (1.0 - np.exp(-t / TAU)))
        error = 5.0 * found.std() / np.sqrt(NUMBER)
        delay = 2.0 / (FRICTION * t) * expected if inertia else 0.0
        assert found.mean() == pytest.approx(expected, abs=error + delay)
        kept = np.mean(np.sum(state.directions * start.directions, axis=1))
        assert kept == pytest.approx(np.exp(-t / TAU), abs=5.0 / np.sqrt(2.0 * NUMBER))
        np.testing.assert_allclose(np.hypot(*state.directions.T), 1.0, rtol=1e-12)
    if inertia:  # velocities at half steps of fix gjf are larger by (1 + friction dt/2)^(1/2)
        speed = np.sqrt(np.mean(np.sum(states[-1].velocities ** 2, axis=1)))
        larger = np.sqrt(1.0 + FRICTION * 0.2 / 2.0)
        assert speed == pytest.approx(SPEED * larger, rel=1.0 / (FRICTION * TAU))


@pytest.fixture(scope="module")
def free_in_space() -> ld.Packing:
    places = np.array(np.unravel_index(range(12**3), (12, 12, 12))).T
    return ld.Packing(2.0 + 4.0 * places, 0.5, 48.0 * np.eye(3))


def test_persistence_in_space(free_in_space: ld.Packing, tmp_path: Path) -> None:
    """The same formulas; directions go on from a folder, a record and a second call."""
    free, number, law = free_in_space, len(free_in_space), ld.Droplet(0.1)
    settings = {"timestep": 0.5, "inertia": False, **ACTIVE}
    with ld.Simulation(free, law) as sim:
        start, *states = sim.run(400, every=200, seed=1, record=tmp_path, **settings)
    assert np.abs(start.directions.mean(axis=0)).max() < 5.0 / np.sqrt(3.0 * number)
    for state in states:
        t = state.time
        found = square(state, free)
        expected = 2.0 * SPEED**2 * TAU * (t - TAU * (1.0 - np.exp(-t / TAU)))
        assert found.mean() == pytest.approx(expected, abs=5.0 * found.std() / np.sqrt(number))
        kept = np.mean(np.sum(state.directions * start.directions, axis=1))
        assert kept == pytest.approx(np.exp(-t / TAU), abs=5.0 / np.sqrt(3.0 * number))
        np.testing.assert_allclose(np.linalg.norm(state.directions, axis=1), 1.0, rtol=1e-12)
    read = ld.Run(tmp_path)
    for state, recorded in zip([start, *states], read, strict=True):
        np.testing.assert_allclose(recorded.directions, state.directions, rtol=0, atol=1e-14)
    with read.simulation() as sim:
        (further,) = sim.run(10, seed=2, **settings)[1:]
    turned = np.sum(further.directions * states[-1].directions, axis=1)
    assert turned.mean() == pytest.approx(np.exp(-5 / TAU), abs=5 * turned.std() / number**0.5)


def test_directions_go_on(free: ld.Packing, tmp_path: Path) -> None:
    """In a second call, in a simulation from a state or of a folder, and in a record."""
    with ld.Simulation(free, ld.Ring()) as sim:
        motion = {"timestep": 0.5, "every": 10, "seed": 1, "inertia": False}
        first = sim.run(20, record=tmp_path / "run", **motion, **ACTIVE)[-1]
        (second,) = sim.run(1, timestep=0.5, seed=1, inertia=False, **ACTIVE)[1:]
    deviation = np.sqrt(2.0 * 0.5 / TAU)  # in one step
    assert turned(second, first).std() == pytest.approx(deviation, rel=5.0 / np.sqrt(2 * NUMBER))
    read = ld.Run(tmp_path / "run")[-1]
    np.testing.assert_allclose(read.directions, first.directions, rtol=0, atol=1e-15)
    with ld.Simulation(read, ld.Ring()) as sim:
        third = sim.run(1, timestep=0.5, seed=2, inertia=False, **ACTIVE)[1]
        sim.reset(free)
        other = sim.run(1, timestep=0.5, seed=2, inertia=False, **ACTIVE)[1]
    assert turned(third, first).std() == pytest.approx(deviation, rel=5.0 / np.sqrt(2 * NUMBER))
    assert abs(np.cos(turned(other, first)).mean()) < 5.0 / np.sqrt(2 * NUMBER)
    with ld.Run(tmp_path / "run").simulation() as sim:
        np.testing.assert_allclose(sim.directions, first.directions, rtol=0, atol=1e-15)
        fourth = sim.run(1, timestep=0.5, seed=2, inertia=False, **ACTIVE)[1]
    np.testing.assert_allclose(fourth.directions, third.directions, rtol=0, atol=1e-12)
    data = tmp_path / "run" / "packing.data"
    data.write_text(data.read_text().rpartition("# direction")[0])
    with pytest.raises(ld.FileError, match="it has directions of 1599 of 1600 atoms"):
        ld.Run(tmp_path / "run").simulation()
    assert first._values("direction") == pytest.approx(np.arctan2(*first.directions.T[::-1]))
    ax = first.plot(color="direction")
    assert ax.collections[0].get_clim() == pytest.approx((-np.pi, np.pi))
    assert ax.collections[0].get_cmap().name == "twilight"
    assert ld.Simulation(free, ld.Ring()).run(1, timestep=0.5)[1].directions is None


def turned(state: ld.State, since: ld.State) -> np.ndarray:
    """Angles between the directions."""
    (x, y), (a, b) = since.directions.T, state.directions.T
    return np.arctan2(x * b - y * a, x * a + y * b)


def test_particles_that_push_each_other_keep_their_step() -> None:
    """A dense crowd: the default step holds, and the mean speed is below that of free ones."""
    packing = ld.bidisperse(32, phi=0.85, seed=3).push_off()
    with ld.Simulation(packing, ld.Ring(kP=0.3)) as sim:
        crowd = {"drag": 1.0, "propulsion": 1e-3, "persistence": 1e4}
        states = sim.run(2000, seed=1, inertia=False, every=500, **crowd)
    assert states[-1].energy > 0.0
    assert max(state.pressures.max() for state in states) < 0.1
    assert states[-1].time > states[-2].time


@pytest.mark.parametrize("d", [2, 3])
def test_alignment(d: int) -> None:
    """Two that touch turn away from each other, or to each other's direction, by their rates.

    Of an angle phi to a field tan(phi/2) decays by its rate; two that align close theirs by twice
    the rate. The default step is short against it.
    """
    away = np.zeros((2, d))
    away[:, 0] = -1.0, 1.0
    pair = ld.Packing(10.0 + 0.9 * away, 1.0, 20.0 * np.eye(d))
    start = np.zeros((2, d))
    start[:, :2] = [[0.8, 0.6], [0.0, 1.0]]
    law = ld.Ring() if d == 2 else ld.Droplet()
    settings = {"drag": 1.0, "inertia": False, "propulsion": 1e-9, "persistence": np.inf}
    for alignment, rate in ((ld.Alignment(free=0.5), 0.5), (ld.Alignment(neighbors=0.5), 1.0)):
        with ld.Simulation(pair, law) as sim:
            sim.directions = start
            state = sim.run(60, timestep=1e-4 * np.pi, alignment=alignment, **settings)[-1]
            assert sim.run(1, alignment=alignment, **settings)[-1].time < state.time + 0.11
        if alignment.free:
            old, new = (np.arccos(np.sum(n * away, axis=1)) for n in (start, state.directions))
        else:
            old, new = (np.arccos(n[0] @ n[1]) for n in (start, state.directions))
        decay = np.exp(-rate * state.time)
        np.testing.assert_allclose(np.tan(new / 2), decay * np.tan(old / 2), rtol=2e-6)


def test_neighbors_at_a_distance(free: ld.Packing) -> None:
    """Particles that are far from each other align; the order of all grows."""
    flock = ld.Alignment(neighbors=1.0, distance=10.0)
    with ld.Simulation(free, ld.Ring()) as sim:
        start, end = sim.run(60, timestep=0.1, seed=1, alignment=flock, inertia=False, **ACTIVE)
    before, after = (np.linalg.norm(state.directions.mean(axis=0)) for state in (start, end))
    assert before < 0.1
    assert after > 3.0 * before


def test_refusals(free: ld.Packing) -> None:
    with ld.Simulation(free, ld.Ring()) as sim:
        for values, message in (
            ({"drag": 0.0}, "get faster and faster: give a drag"),
            ({"persistence": None}, "give propulsion and persistence, or none of them"),
            ({"propulsion": float("inf")}, "propulsion must be a positive number, not inf"),
            ({"persistence": -1.0}, "persistence must be a positive number, not -1"),
            ({"persistence": 0.1, "timestep": 0.2}, "longer than the persistence of 0.1"),
        ):
            with refused(message):
                sim.run(10, **ACTIVE | values)
        with refused("an alignment turns a propulsion: give one"):
            sim.run(10, drag=1.0, alignment=ld.Alignment(free=1.0))
        with refused("leave out temperature.*alignment"):
            sim.run(10, pressure=1e-3, alignment=ld.Alignment(free=1.0))
    with refused("a distance is that of neighbors: give their rate too"):
        ld.Alignment(distance=1.0)
