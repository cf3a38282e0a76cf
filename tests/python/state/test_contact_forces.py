"""Stress of each particle against the stress of all, Laplace's law and LAMMPS; the graph."""

import math

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import crystal
from lammps_deformable import Ring, Sector
from lammps_deformable.state.contacts import forces_of

DROPLET = {"kA": math.inf, "kP": 0.0, "tension": 1.0}
LAWS = {
    "radical": Ring(contact="radical"),
    "skin": Ring(kP=0.3, skin=0.03, contact="curved"),
    "two stiffnesses": Ring(kA=[1.0, 0.3], contact="curved"),
    "droplets": Ring(**DROPLET),
    "films": Ring(**DROPLET, contact="curved", adhesion=0.1),
    "sector": Sector(),
}
CONTAINERS = {
    "rectangle": ld.BoxWall((8, 7)).parts,
    "circle": (ld.Sphere(4.5, (1.0, 2.0)), ld.Sphere(0.6, (1.0, 2.0), inside=False)),
    "obstacles": (ld.Sphere(0.8, (2.0, 3.0), inside=False), ld.Segment((5.0, 2.0), (6.0, 4.0))),
}


def pressed(law: Ring | Sector, walls: tuple = ()) -> ld.State:
    """A packing whose forces do not balance."""
    packing = ld.bidisperse(24, tilt=0.0 if walls else 0.3, seed=3)
    packing = packing.between(walls) if walls else packing
    with ld.Simulation(packing.at(0.86).push_off(), law) as sim:
        return sim.state()


def total(state: ld.State) -> np.ndarray:
    return np.einsum("n,nab->ab", state.volumes, state.particle_stress) / state.packing.volume


def test_stresses_sum_to_that_of_the_packing() -> None:
    for name, law in LAWS.items():
        state = pressed(law)
        stress, largest = state.particle_stress, np.abs(state.pressure_tensor).max()
        assert np.array_equal(stress, np.swapaxes(stress, 1, 2)), name
        assert np.abs(total(state) - state.pressure_tensor).max() < 1e-12 * largest, name


def test_pressures_sum_between_walls() -> None:
    for name, walls in CONTAINERS.items():
        for law in (Ring(contact="curved"), Sector()):
            state = pressed(law, walls)
            assert -1 in state.contacts["j"]
            assert np.trace(total(state)) == pytest.approx(2.0 * state.pressure, rel=1e-12), name


def test_stresses_of_disks() -> None:
    """Those of walls too: they exert no torque on a disk."""
    loose = ld.bidisperse(24, seed=3)
    packings = [loose.between(walls).at(0.86).push_off() for walls in CONTAINERS.values()]
    for packing in (*packings, ld.jam(loose).packing.at(0.9)):
        with ld.Simulation(packing, ld.SoftContact()) as disks:
            state = disks.state()
        largest = np.abs(state.pressure_tensor).max()
        assert np.abs(total(state) - state.pressure_tensor).max() < 1e-12 * largest


def test_each_particle_by_a_loop() -> None:
    """Forces act where contact lines cross the lines of centers."""
    state = pressed(Ring(kA=[1.0, 0.3], contact="curved"))
    for n, rows in enumerate(state._contacts_of_each):
        center, moment = state.packing.positions[n], np.zeros((2, 2))
        for row in rows:
            across = np.array([np.cos(row["angle"]), np.sin(row["angle"])])
            other = state.packing.positions[row["j"]] + row["image"] @ state.packing.box
            along = (other - center) / np.linalg.norm(other - center)
            part = (row["position"] - center) @ across / (along @ across)
            moment -= np.outer(part * along, row["force_vector"])
        expected = 0.5 * (moment + moment.T) / state.results["area"][n]
        assert state.particle_stress[n] == pytest.approx(expected, rel=1e-8, abs=1e-13)


def test_particles_that_touch_their_own_images() -> None:
    row = crystal(0.02, 1, 2)
    with ld.Simulation(row, ld.SoftContact()) as disks, ld.Simulation(row, Ring()) as sim:
        for state in (disks.state(), sim.state()):
            assert forces_of(state).i.tolist().count(0) == 5
            assert total(state) == pytest.approx(state.pressure_tensor, rel=1e-10, abs=1e-15)


def test_droplets_have_their_pressure_less_that_of_their_tension() -> None:
    """The mean stress in a droplet and its surface: p - T P / 2A."""
    state = pressed(LAWS["droplets"])
    expected = state.pressures - 1.0 * state.perimeters / (2.0 * state.results["area"])
    pressure = np.trace(state.particle_stress, axis1=1, axis2=2) / 2.0
    assert pressure == pytest.approx(expected, rel=1e-7)


def test_equal_particles_as_in_lammps() -> None:
    """compute stress/atom halves each pair, as do radical axes of equal circles."""
    equal = ld.bidisperse(24, sizes=(0.5, 0.5), phi=0.9, seed=3).push_off()
    with ld.Simulation(equal, Ring(contact="radical")) as sim:
        state = sim.state()
        sim.lmp.commands_string(
            "compute s all stress/atom NULL pair\n"
            "compute t all reduce sum c_s[1]\n"
            "thermo_style custom step c_t\n"
            "run 0 post no"
        )
        found = -np.array(sim.lmp.gather("c_s", 1, 6)).reshape(-1, 6)
    moment = state.volumes[:, None, None] * state.particle_stress
    assert moment[:, 0, 0] == pytest.approx(found[:, 0], rel=1e-9)
    assert moment[:, 1, 1] == pytest.approx(found[:, 1], rel=1e-9)


def test_the_graph_has_the_contacts() -> None:
    networkx = pytest.importorskip("networkx")
    with ld.Simulation(ld.jam(ld.bidisperse(32, seed=3)).packing, Ring()) as sim:
        state = sim.compress(strain=0.02, steps=2)[-1]
    graph, table = state.graph(), state.contacts
    assert graph.number_of_edges() == len(table) // 2
    assert [degree for _, degree in graph.degree()] == state.n_contacts.tolist()
    for i, j, values in graph.edges(data=True):
        assert i < j
        (row,) = table[(table["i"] == i) & (table["j"] == j)]
        out = np.array([np.cos(row["angle"]), np.sin(row["angle"])])
        assert values["distance"] == pytest.approx(row["distance"])
        assert [values["dx"], values["dy"]] == pytest.approx(row["distance"] * out)
        assert values["force"] == pytest.approx(-row["force_vector"] @ out, rel=1e-8)
    nodes = dict(graph.nodes(data=True))
    assert [nodes[n]["rattler"] for n in range(32)] == state.rattlers.tolist()
    assert [nodes[n]["radius"] for n in range(32)] == state.packing.radii.tolist()
    largest = max(networkx.connected_components(graph), key=len)
    assert largest >= set(np.flatnonzero(~state.rattlers).tolist())
    assert len(list(networkx.generate_graphml(graph))) > 32  # values that files can hold


def test_forces_in_the_graph_of_disks_balance() -> None:
    pytest.importorskip("networkx")
    walls = ld.BoxWall((8, 7)).parts
    packing = ld.bidisperse(24, seed=3).between(walls).at(0.9).push_off()
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        state = disks.relax(1e-9)
    graph, wall = state.graph(), state.contacts["j"] < 0
    assert graph.number_of_edges() == np.sum(~wall) // 2 + np.sum(wall)
    force = np.zeros((24, 2))
    for i, j, values in graph.edges(data=True):
        push = values["force"] * np.array([values["dx"], values["dy"]]) / values["distance"]
        i, j = (j, i) if i < 0 else (i, j)
        assert values["force"] > 0.0
        force[i] -= push
        if j >= 0:
            force[j] += push
    assert np.abs(force).max() < 1e-8 * state.pressure
    assert len(graph) == 25
    assert graph.degree(-1) == np.sum(wall)


def test_two_particles_touch_through_several_images() -> None:
    pytest.importorskip("networkx")
    with ld.Simulation(crystal(0.01, 2, 2), ld.SoftContact()) as disks:
        state = disks.state()
    graph = state.graph()
    assert graph.number_of_edges() == 12
    assert graph.number_of_edges(0, 1) == 2
    assert {degree for _, degree in graph.degree()} == {6}
    assert [values["force"] for *_, values in graph.edges(data=True)] == pytest.approx([0.01] * 12)
