"""Simulations between walls, compared with LAMMPS scripts, differences of energies and balances."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import LammpsError, ParameterError, Plane, PolygonWall, Ring, Segment, Sphere

SCENE = (
    Sphere(6.0, (1.0, -2.0)),
    Sphere(1.0, (3.0, -2.0), inside=False),
    PolygonWall([(-2, -3), (0, -3), (0, -1), (-2, -1)]),
    Segment((0, 1), (1.5, 1)),
)
# the same by LAMMPS' regions
REGIONS = """
region drum cylinder z 1 -2 6 INF INF
region post cylinder z 3 -2 1 INF INF side out
region pillar block -2 0 -3 -1 INF INF side out
region line block 0 1.5 1 1 INF INF side out
region scene intersect 4 drum post pillar line
fix scene all deformable/wall scene
fix_modify scene virial yes
"""
LAWS = {"balanced": Ring(kP=2.0), "radical": Ring(contact="radical"), "sector": ld.Sector()}
laws = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


@pytest.fixture(scope="module")
def packing() -> ld.Packing:
    """Pressed against walls of every kind, and against one another."""
    return ld.bidisperse(60, seed=2).between(SCENE).push_off().at(0.86)


def forces(sim: ld.Simulation) -> np.ndarray:
    return np.array(sim.lmp.gather("f", 1, 3)).reshape(-1, 3)[:, :2]


@pytest.mark.parametrize("law", [Ring(kP=2.0), ld.Sector()])
def test_lammps_script_with_regions(packing, law) -> None:
    """Regions in LAMMPS' own units of length: the same energy, forces and pressure."""
    scale = packing.walls[0].radius / 6.0
    with ld.Simulation(packing, law) as sim:
        state, found = sim.state(), forces(sim)
    bare = packing.replace(walls=(), box=np.diag([90, 90]), positions=packing.positions + 20)
    with ld.Simulation(bare, law) as raw:
        scaled = f"lattice sq {scale**-2!r} origin 0 0 0\n" + REGIONS
        raw.lmp.commands_string("variable shift equal 20")
        for line in scaled.strip().splitlines():
            moves = line.startswith("region") and "intersect" not in line
            shift = " move v_shift v_shift NULL" if moves else ""
            raw.lmp.command(line + shift)
        raw.lmp.command("compute check all pressure NULL pair fix")
        other = raw.state()
        xx, yy, _, xy, *_ = raw.lmp.numpy.extract_compute("check", 0, 1)
        low, high, *_ = raw.lmp.extract_box()
        assert other.energy == pytest.approx(state.energy, rel=1e-11)
        assert state.energy > 0
        scale_of_forces = np.abs(found).max()
        np.testing.assert_allclose(forces(raw), found, atol=1e-10 * scale_of_forces)
        volume = np.prod(np.subtract(high, low)[:2])
        np.testing.assert_allclose(
            np.array([[xx, xy], [xy, yy]]) * volume,
            state.pressure_tensor * packing.volume,
            atol=1e-9 * abs(state.pressure_tensor).max(),
        )


@laws
def test_forces_are_differences_of_the_energy(packing, law) -> None:
    """Along a random direction of the particles at walls."""
    with ld.Simulation(packing, law) as sim:
        state, found = sim.state(), forces(sim)
    touching = np.unique(state.contacts["i"][state.contacts["j"] < 0])
    assert len(touching) > 15
    along = np.zeros_like(found)
    along[touching] = np.random.default_rng(1).normal(size=(len(touching), 2))
    energies = []
    for step in (-1e-6, 1e-6):
        moved = packing.replace(positions=packing.positions + step * along)
        with ld.Simulation(moved, law) as sim:
            energies.append(sim.state().energy)
    slope = (energies[1] - energies[0]) / 2e-6
    assert -slope == pytest.approx(np.sum(found * along), abs=1e-5 * np.abs(found).max())


@pytest.mark.parametrize("law", [Ring(kP=2.0), ld.Sector()])
def test_walls_bear_the_total_force(packing, law) -> None:
    """Forces between particles cancel: what is left is what the walls take."""
    with ld.Simulation(packing, law) as sim:
        state, found = sim.state(), forces(sim)
    assert state.wall_forces.shape == (4, 2)
    largest = np.abs(state.wall_forces).max()
    np.testing.assert_allclose(state.wall_forces.sum(0), -found.sum(0), atol=1e-12 * largest)
    table = state.contacts
    if law.name != "sector":
        # a flat wall turns no contact: its force is the sum of those of its contacts
        by_wall = np.isclose(table["position"][:, 1], state.packing.walls[3].a[1])
        rows = table[by_wall & (table["j"] < 0)]
        assert (rows["j"] == -1 - 3).all()
        ends = [p[0] for p in (state.packing.walls[3].a, state.packing.walls[3].b)]
        inner = rows[(rows["position"][:, 0] > ends[0]) & (rows["position"][:, 0] < ends[1])]
        if len(inner) == len(rows) > 0:
            along = np.sum(rows["force"] * np.sin(rows["angle"]))
            assert state.wall_forces[3, 1] == pytest.approx(along, abs=1e-12 * largest)


def test_relaxed_particles_are_in_balance() -> None:
    start = ld.bidisperse(60, seed=2).between(SCENE[:2])
    with ld.Simulation(start.at(0.88).push_off(), Ring()) as sim:
        relaxed = sim.relax(1e-9)
    assert relaxed.residual < 1e-9
    assert relaxed.converged
    np.testing.assert_allclose(relaxed.wall_forces.sum(0), 0, atol=1e-8 * relaxed.pressure)
    free = 60 - int(relaxed.rattlers.sum())
    assert relaxed.isostatic_contacts == 2 * free + 1
    assert relaxed.network_contacts > relaxed.isostatic_contacts


def test_pressure_is_the_derivative_by_the_free_area(packing) -> None:
    """When particles and walls are scaled together."""
    with ld.Simulation(packing, Ring(kP=2.0)) as sim:
        state = sim.state()
    found = []
    for factor in (1 - 1e-6, 1 + 1e-6):
        with ld.Simulation(packing.at(packing.phi / factor**2), Ring(kP=2.0)) as sim:
            there = sim.state()
            found.append((there.energy, there.packing.volume))
    (first, small), (second, large) = found
    # Energies are right to second order in the imbalance, so that a difference at 1e-6 is to 1e-9.
    # The pressure is a sum of forces: balanced ones are right to 1e-8 of the largest one.
    forces = np.abs(state.contacts["force"])
    rel = 1e-9 + 1e-8 * forces.max() / forces.mean()
    assert state.pressure == pytest.approx((first - second) / (large - small), rel=rel)


def test_pressure_in_a_square_is_force_per_length() -> None:
    sides = ld.BoxWall((9, 9), (-4, 3)).parts
    packing = ld.bidisperse(64, seed=1).between(sides).at(0.87).push_off()
    with ld.Simulation(packing, Ring()) as sim:
        state = sim.relax(1e-9)
    length = state.packing.box[0, 0]
    left, right, low, high = state.wall_forces
    assert state.pressure_tensor[0, 0] == pytest.approx(right[0] / length, rel=1e-6)
    assert state.pressure_tensor[0, 0] == pytest.approx(-left[0] / length, rel=1e-6)
    assert state.pressure_tensor[1, 1] == pytest.approx(high[1] / length, rel=1e-6)
    assert state.pressure_tensor[1, 1] == pytest.approx(-low[1] / length, rel=1e-6)
    assert state.pressure == pytest.approx((right[0] + high[1]) / (2 * length), rel=1e-6)
    assert state.phi == pytest.approx(state.results["area"].sum() / length**2)


def test_obstacles_alone_stay_in_the_periodic_box() -> None:
    """A pillar at the corner of the box touches particles at all four corners."""
    start = ld.bidisperse(40, tilt=0.2, seed=3).between(Sphere(2.0, (0, 0), inside=False))
    packing = start.at(0.85).push_off()
    with ld.Simulation(packing, Ring()) as sim:
        state = sim.state()
    inside = state.packing.positions @ np.linalg.inv(state.packing.box) % 1
    touching = np.unique(state.contacts["i"][state.contacts["j"] < 0])
    assert len(np.unique(np.rint(inside[touching]), axis=0)) == 4
    # moving box and pillar along does not matter
    shift = np.array([0.3, 0.2]) @ packing.box
    pillar = packing.walls[0]
    moved = packing.replace(
        positions=packing.positions + shift, walls=Sphere(pillar.radius, tuple(shift), inside=False)
    )
    with ld.Simulation(moved, Ring()) as sim:
        assert sim.state().energy == pytest.approx(state.energy, rel=1e-9)


def test_further_walls_by_hand(packing) -> None:
    """Through `lmp`: they act, but are none of the simulation's."""
    with ld.Simulation(packing.replace(walls=packing.walls[:3]), Ring()) as sim:
        line = packing.walls[3]
        words = " ".join(map(repr, line._values))
        sim.lmp.command(f"fix mine all deformable/wall segment {words}")
        sim.lmp.command("fix_modify mine virial yes")
        state = sim.state()
        assert state.wall_forces.shape == (3, 2)
    with ld.Simulation(packing, Ring()) as sim:
        assert sim.state().energy == pytest.approx(state.energy, rel=1e-12)
        np.testing.assert_allclose(sim.state().pressure_tensor, state.pressure_tensor, rtol=1e-10)


def test_errors_name_the_wall(packing) -> None:
    two = ld.Packing([[2, 2], [6, 6]], 0.5, np.diag([9.0, 9.0]))
    for walls, message in (
        (
            [Sphere(1, (4, 4), inside=False), Sphere(1, (6, 5.5), inside=False)],
            "particle 1, .* within disk 2",
        ),
        (
            [
                Sphere(1, (4, 4), inside=False),
                Segment((0, 0), (8, 0)),
                Sphere(0.5, (1, 8), inside=False),
            ],
            "segment 2 does not fit",
        ),
        (Plane((0, 0), (0, 1)), "leave the room open"),
        (3, "walls must be one or several of Plane"),
    ):
        with pytest.raises(ParameterError, match=message):
            ld.Simulation(two.replace(walls=walls), Ring())
    with ld.Simulation(
        two.replace(walls=[Sphere(1, (4, 4), inside=False), Sphere(0.5, (7, 1), inside=False)]),
        Ring(),
    ) as sim:
        sim.lmp.command("set atom 2 x 7.1 y 1.1")
        with pytest.raises(LammpsError, match=r"atom 2 at \(7.1, 1.1\) is in the obstacle disk 2$"):
            sim.state()
    close = ld.Simulation(
        two.replace(walls=[Sphere(0.2, (4, 8), inside=False), Sphere(0.98, (6, 5), inside=False)]),
        Ring(),
    )
    with close as sim, pytest.raises(LammpsError, match="disk 2"):
        sim.state()
    with pytest.raises(ParameterError, match="polygons have no walls"):
        ld.Simulation(packing, ld.DeformablePolygon(50, smooth=False))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_lid_under_a_load(dimension: int) -> None:
    """By lmp: it moves in runs, and in relaxations by friction, and bears its load at rest."""
    up = np.eye(dimension)[-1]
    floor = ld.Plane((0,) * dimension, tuple(up))
    start = ld.bidisperse(24, sizes=(0.5, 0.6), dimension=dimension, seed=1)
    start = start.between([floor, ld.Plane(tuple(8 * up), tuple(-up))]).at(0.35).push_off()
    law = ld.Droplet() if dimension == 3 else ld.Ring(kA=10.0, kP=0.0, tension=0.1)
    rough, load, top = ld.Friction(0.3, kt=0.1, gt=0.05, restitution=0.3), 0.1, start.box[-1, -1]

    def place(sim: ld.Simulation) -> float:
        return sim.lmp.extract_fix("lid", 0, 1, 3)

    for friction in (None, rough):
        with ld.Simulation(start, law, friction=friction) as sim:
            side = "zhi" if dimension == 3 else "yhi"
            sim.lmp.command(f"fix lid all deformable/wall {side} {0.999 * top} load {load} 20")
            assert sim.state().unsaved == "walls"
            if not friction:
                assert sim.relax(1e-3).converged
                assert place(sim) == 0.999 * top
                for how in ({}, {"drag": 0.5}, {"drag": 0.5, "inertia": False}):
                    before = place(sim)
                    sim.run(500, timestep=0.02, **how)
                    assert place(sim) < before
            else:
                sim.run(3000, timestep=0.02, drag=0.3)  # until the lid touches all of them
                assert sim.relax(1e-4).converged
                assert sim.lmp.extract_fix("lid", 0, 1, dimension - 1) == pytest.approx(
                    load, rel=1e-2
                )
