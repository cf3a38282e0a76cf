"""Gravity in relaxations, protocols and motion: its energy and forces, ranks, files, refusals."""

import json
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from programs import output
from ranks import here, python

G = 1e-3
RING = ld.Ring(kA=10.0, kP=0.0, tension=0.05)
BOX, TALL = ld.BoxWall((10, 12)), ld.BoxWall((4, 4, 6))
DOWN = {"all": (0, -G), "by species": [[0, -G], [1e-4, 2 * G]]}
LAWS = {"balanced": RING, "radical": ld.Ring(contact="radical")}
by_kind = pytest.mark.parametrize("kind", DOWN)


@pytest.fixture(scope="module")
def loose() -> ld.Packing:
    return ld.bidisperse(30, seed=1).between(BOX.parts).push_off()


@pytest.fixture(scope="module")
def in_space() -> ld.Packing:
    start = ld.bidisperse(40, sizes=(0.5, 0.6), dimension=3, seed=2).between(TALL)
    return start.push_off()


def weights(state: ld.State) -> np.ndarray:
    return state.gravity[state.packing.species] if state.gravity.ndim == 2 else state.gravity


@pytest.mark.parametrize("law", LAWS)
def test_a_heap_on_a_floor(loose: ld.Packing, law: str) -> None:
    with ld.Simulation(loose, LAWS[law], gravity=(0, -G)) as sim:
        heap = sim.relax()
    assert heap.converged
    assert heap.wall_forces.sum(axis=0) == pytest.approx([0.0, -30 * G], abs=30e-6 * G)
    assert heap.gravity_energy == pytest.approx(G * heap.packing.positions[:, 1].sum())


def test_newtons_method_knows_it(loose: ld.Packing) -> None:
    with ld.Simulation(loose, RING, gravity=(0, -G)) as sim:
        heap = sim.relax(1e-10)
    assert heap.converged
    assert heap.residual <= 1e-10


@by_kind
@pytest.mark.usefixtures("exact_balance")
def test_forces_are_the_gradient_of_the_energy(loose: ld.Packing, kind: str) -> None:
    with ld.Simulation(loose.at(0.9).push_off(), RING, gravity=DOWN[kind]) as sim:
        at, h = sim.state(), 1e-5
        forces = np.array(sim.lmp.gather("f", 1, 3)).reshape(-1, 3)[:, :2]
        assert forces == pytest.approx(at.forces + weights(at), abs=1e-12)
        for n, axis in ((0, 0), (0, 1), (17, 1)):
            energies = []
            for step in (h, -h):
                moved = at.packing.positions.copy()
                moved[n, axis] += step
                sim.reset(at.packing.replace(positions=moved))
                energies.append(sim.state().energy)
            slope = (energies[1] - energies[0]) / (2 * h)
            assert slope == pytest.approx(forces[n, axis], rel=1e-5, abs=1e-9)


@by_kind
def test_a_fall_keeps_the_energy(loose: ld.Packing, kind: str) -> None:
    """Unwrapped positions count, as particles fall through a periodic box."""
    periodic = ld.bidisperse(30, phi=0.6, seed=1).push_off()
    for start in (loose, periodic):
        with ld.Simulation(start, RING, gravity=DOWN[kind]) as sim:
            states = sim.run(2000, every=1000)
        whole = [state.energy + state.kinetic_energy for state in states]
        assert whole == pytest.approx(whole[:1] * 3, abs=2e-4 * states[-1].kinetic_energy)
        assert abs(states[-1].images).max() == (0 if start is loose else pytest.approx(4, abs=3))
    mean = weights(states[-1]) * np.ones((30, 1))
    assert states[-1].velocities.mean(axis=0) == pytest.approx(
        mean.mean(axis=0) * states[-1].time, rel=1e-9
    )


def test_types_may_change(loose: ld.Packing) -> None:
    with ld.Simulation(loose, RING, gravity=DOWN["by species"]) as sim:
        before = sim.state()
        sim.lmp.command("set group all type 1")
        after = sim.state()
    assert before.gravity_energy != pytest.approx(after.gravity_energy, rel=1e-2)
    assert after.gravity_energy == pytest.approx(G * after.packing.positions[:, 1].sum())


def test_protocols_keep_it(loose: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(loose, RING, gravity=(0, -G)) as sim:
        pressed = sim.compress(phi=0.7, steps=2, tolerance=1e-4, record=tmp_path)
        assert pressed[-1].phi == pytest.approx(0.7, rel=1e-8)
        grown = sim.grow(factor=1.02)[-1]
        at_rest = sim.relax(pressure=2e-3)
    assert [state.gravity.tolist() for state in (*pressed, grown, at_rest)] == [[0.0, -G]] * 5
    assert at_rest.pressure == pytest.approx(2e-3, rel=1e-6)
    below = grown.wall_forces.sum(axis=0)[1]
    assert below == pytest.approx(-30 * G, rel=1e-5)


@by_kind
def test_files_and_resume(loose: ld.Packing, kind: str, tmp_path: Path) -> None:
    whole, part = tmp_path / "whole", tmp_path / "part"
    how = {"every": 100, "timestep": 0.05}
    with ld.Simulation(loose, RING, gravity=DOWN[kind]) as sim:
        run = sim.run(300, record=whole, **how)
    with ld.Simulation(loose, RING, gravity=DOWN[kind]) as sim, pytest.raises(KeyboardInterrupt):
        sim.run(300, record=part, callback=interrupt, **how)
    again = ld.Run(part).resume()
    last = run[-1]
    assert np.array_equal(again[-1].packing.positions, last.packing.positions)
    assert np.array_equal(last.gravity, DOWN[kind])
    assert last.energy == again[-1].energy
    assert ld.Run(whole).simulation().state().energy == pytest.approx(last.energy, rel=1e-12)
    with ld.Simulation(last, RING) as on, ld.Simulation(last, RING, gravity=(0, 0)) as off:
        assert np.array_equal(on.gravity, DOWN[kind])
        assert off.gravity is None
        assert off.state().energy == pytest.approx(last.energy - last.gravity_energy, abs=1e-12)
    lines = output("lmp", "-in", "in.lammps", "-log", "none", cwd=whole).splitlines()
    head = next(n for n, line in enumerate(lines) if line.split()[:2] == ["Step", "PotEng"])
    assert float(lines[head + 1].split()[1]) == pytest.approx(last.energy, rel=1e-9)


def interrupt(state: ld.State) -> None:
    if state.time > 7.0:
        raise KeyboardInterrupt


def test_droplets_in_space(in_space: ld.Packing) -> None:
    """Heavy ones sink and light ones rise; in motion the energy stays."""
    apart = [[0, 0, -0.02], [0, 0, 0.02]]
    with ld.Simulation(in_space, ld.Droplet(), gravity=apart) as sim:
        rest = sim.relax()
        z, species = rest.packing.positions[:, 2], rest.packing.species
        assert rest.converged
        assert z[species == 1].mean() - z[species == 0].mean() > 1.5
        assert np.linalg.norm(rest.wall_forces.sum(axis=0)) < 1e-4
    with ld.Simulation(in_space, ld.Droplet(), gravity=(0, 0, -0.02)) as sim:
        states = sim.run(400, every=200, timestep=0.02)
    whole = [state.energy + state.kinetic_energy for state in states]
    assert whole == pytest.approx(whole[:1] * 3, abs=2e-4 * states[-1].kinetic_energy)


def test_friction_and_films(loose: ld.Packing) -> None:
    """Motion to rest by friction knows it; losses make the energy whole."""
    rough = ld.Friction(0.4, kt=0.1, gt=0.05, damping=0.1)
    with ld.Simulation(loose, RING, friction=rough, gravity=(0, -G)) as sim:
        states = sim.run(2000, every=1000)
        whole = [s.energy + s.kinetic_energy + s.spring_energy + s.lost_energy for s in states]
        assert whole == pytest.approx(whole[:1] * 3, abs=1e-3 * whole[0])
        heap = sim.relax(1e-3)
    assert heap.wall_forces.sum(axis=0)[1] == pytest.approx(-30 * G, rel=1e-2)


def test_a_flow_sediments() -> None:
    """Beside the flow all particles drift with g/drag."""
    start = ld.bidisperse(16, phi=0.5, seed=1).push_off()
    with ld.Simulation(start, ld.Ring(), gravity=(0, -G)) as sim:
        run = sim.shear(0.01, rate=1e-3, drag=1.0, steps=1)
    way = run.unwrapped()
    assert (way[-1] - way[0]).mean(axis=0)[1] == pytest.approx(-G * run[-1].time, rel=1e-6)


def test_bubbles_coarsen_under_their_lift(loose: ld.Packing) -> None:
    foam = ld.Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved")
    with ld.Simulation(loose, foam, gravity=(0, 0.01)) as sim:
        last = sim.coarsen(1.0, time=0.1)[-1]
    assert last.wall_forces.sum(axis=0)[1] == pytest.approx(0.01 * len(last.packing), rel=1e-5)


RANKS = """
import json
from mpi4py import MPI
import lammps_deformable as ld

start = ld.bidisperse(30, seed=1).between(ld.BoxWall((10, 12)).parts).push_off()
seen = []
for down in (0, -1e-3), [[0, -1e-3], [1e-4, 2e-3]]:
    with ld.Simulation(start, ld.Ring(kA=10.0, kP=0.0, tension=0.05), gravity=down) as sim:
        state = sim.run(60, timestep=0.1)[-1]
        seen += [state.energy, state.gravity_energy, state.kinetic_energy]
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(seen))
"""


def test_on_ranks(tmp_path: Path) -> None:
    alone, shared = map(json.loads, (here(RANKS), python(RANKS, tmp_path, 2)))
    assert shared == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize(
    ("given", "law", "words"),
    [
        ((1, 2, 3), RING, r"gravity must be \(gx, gy\), or 2 rows of that.*, not \(1, 2, 3\)"),
        ([[0, 1]] * 3, RING, "or 2 rows of that, one for each species"),
        ((0, np.nan), RING, "gravity must be finite numbers"),
        ((0, 1), ld.SoftContact(), "SoftContact has no gravity: take Ring or Droplet"),
    ],
)
def test_what_it_must_be(loose: ld.Packing, given, law, words: str) -> None:
    with pytest.raises(ld.ParameterError, match=words):
        ld.Simulation(loose, law, gravity=given)


def test_a_fall_without_end_is_refused() -> None:
    periodic = ld.bidisperse(16, phi=0.5, seed=1)
    channel = [ld.Plane((0, 0), (0, 1)), ld.Plane((0, 6), (0, -1))]
    in_channel = periodic.between(channel).push_off()
    falls = "gravity pulls the particles along {}, where the box is periodic"
    for start, pull, axis in (
        (periodic, (0, G), "y"),
        (in_channel, (G, -G), "x"),
        (periodic, [[G, 0], [2 * G, 0]], "x"),
    ):
        with ld.Simulation(start.push_off(), RING, gravity=pull) as sim:
            for call in (sim.relax, lambda sim=sim: sim.compress(strain=0.01)):
                with pytest.raises(ld.ParameterError, match=falls.format(axis)):
                    call()
    with ld.Simulation(in_channel, RING, gravity=(0, -G)) as sim:
        assert sim.relax().converged
    with (
        ld.Simulation(periodic, RING, gravity=(0, G)) as sim,
        pytest.raises(ld.ParameterError, match="come to rest in a periodic box, where they fall"),
    ):
        sim.run(10, pressure=1e-3)


def test_obstacles_may_hold_the_particles() -> None:
    post = ld.Sphere(0.5, (3, 3), inside=False)
    start = ld.bidisperse(16, phi=0.35, seed=1).between([post]).push_off()
    with ld.Simulation(start, RING, gravity=(0, -G)) as sim, pytest.warns(ld.StalledWarning):
        sim.relax(max_steps=50)


def test_a_users_wall_may_hold_them() -> None:
    start = ld.crystal("square", 3, phi=0.4)
    start = start.replace(positions=start.positions + 0.5)
    with ld.Simulation(start, RING, gravity=(0, -G)) as sim:
        sim.lmp.command("fix floor all deformable/wall plane 0 0 0 1")
        heap = sim.relax()
        floor = sim.lmp.extract_fix("floor", 0, 1, 1)
    assert heap.converged
    assert floor == pytest.approx(-G * len(start), rel=1e-5)
