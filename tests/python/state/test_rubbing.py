"""States whose contacts rub: their forces, stress, energies, and Coulomb's bound."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.particles.laws import LAWS
from lammps_deformable.state.recorded import particle_values

MU, MU_WALL = 0.4, 0.2
ROUGH = ld.Friction(
    [[MU, 0.5 * MU], [0.5 * MU, MU]],
    kt=1e-2,
    gt=1e-3,
    damping=1e-3,
    walls=ld.Friction(MU_WALL, kt=1e-2),
)
WALLS = (ld.BoxWall((7, 6)), ld.Sphere(0.7, (3, 3), inside=False))


def moved(contact: str, walls: tuple = ()) -> tuple[list[ld.State], np.ndarray]:
    """States of a motion, and the forces of LAMMPS at its end."""
    packing = ld.bidisperse(20, tilt=0.0 if walls else 0.3, seed=3).at(0.84)
    packing = (packing.between(walls, seed=1).at(0.84) if walls else packing).push_off()
    with ld.Simulation(packing, LAWS[contact], friction=ROUGH) as sim:
        motion = sim.run(300, temperature=1e-4, seed=1, every=100)[1:]
        states = list(motion)
        return states, np.reshape(sim.lmp.gather("f", 1, 3), (-1, 3))[:, :2]


@pytest.mark.parametrize(
    ("contact", "walls"),
    [("balanced", WALLS), ("curved", ()), ("radical", WALLS)],
    ids=["balanced-walls", "curved", "radical-walls"],
)
def test_forces_stress_and_energies(contact: str, walls: tuple) -> None:
    states, forces = moved(contact, walls)
    *_, state = states
    table = state.contacts
    i, j, species = table["i"], table["j"], state.packing.species
    wall = j < 0
    # Coulomb's bound, with the coefficient of the species or of walls
    mu = np.where(wall, MU_WALL, np.where(species[i] == species[j], MU, 0.5 * MU))
    most = mu * np.maximum(table["force"], 0.0)
    assert (np.abs(table["friction"]) <= most * (1 + 1e-12)).all()
    slides = table["sliding"]
    lines = slides & (wall | (contact != "radical"))  # radical sides bear a part of the force each
    np.testing.assert_allclose(np.abs(table["friction"])[lines], most[lines], rtol=1e-12)
    assert 0 < slides.sum() < len(table)
    assert (table["friction"] != 0).sum() > 0.9 * len(table)
    assert wall.any() == bool(walls)
    # sums of the table are the forces of LAMMPS; pushes within pairs are opposite
    sums = np.zeros_like(forces)
    np.add.at(sums, i, table["force_vector"])
    np.testing.assert_allclose(sums, forces, rtol=0, atol=1e-13 * np.abs(forces).max())
    if not walls:
        assert np.abs(sums.sum(axis=0)).max() < 1e-12 * np.abs(forces).max()
    # the stress of the packing is that of its particles; friction of walls acts at the middle of a
    # contact, beside the point that is nearest to the particle by half of its length at most
    total = np.einsum("n,nab->ab", state.volumes, state.particle_stress) / state.packing.volume
    if walls:
        beside = np.sum(np.abs(table["friction"] * table["length"])[wall]) / 2
        off = abs(np.trace(total) - 2.0 * state.pressure) * state.packing.volume
        assert off < beside + 1e-12 * state.pressure
        assert beside < 0.02 * state.pressure * state.packing.volume
    else:
        np.testing.assert_allclose(
            total, state.pressure_tensor, atol=1e-12 * np.abs(state.pressure_tensor).max()
        )
    # both sides of a line tell the same; radical sides have their own friction
    if contact != "radical":
        one, two = table[(i < j) & ~wall], table[(j < i) & ~wall]
        order = np.lexsort((two["image"][:, 1], -two["image"][:, 0], two["i"], two["j"]))
        for name in ("friction", "damping", "spring", "sliding"):
            first = one[np.lexsort((-one["image"][:, 1], one["image"][:, 0], one["j"], one["i"]))]
            np.testing.assert_array_equal(first[name], two[order][name])
    stored = np.sum((1e-2 / 2) * table["spring"][wall] ** 2)
    # two sides of one spring, or of radical lines two springs of half the stiffness
    stored += 0.5 * np.sum((1e-2 / 2) * table["spring"][~wall] ** 2)
    assert state.spring_energy == pytest.approx(stored, rel=1e-12)
    energies = [s.energy + s.kinetic_energy + s.spring_energy + s.lost_energy for s in states]
    assert state.lost_energy > 0.1 * state.kinetic_energy
    # to second order in the time step, a tenth of the longest one
    assert energies == pytest.approx([energies[0]] * len(energies), rel=1e-3)
    assert np.abs(state.spins).max() > 1e-3


def test_contacts_that_slip_have_no_such_columns() -> None:
    packing = ld.bidisperse(8, seed=3).at(0.84).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        state = sim.state()
    assert state.spins is state.rubbing is state.friction is None
    assert state.spring_energy == 0.0
    assert "friction" not in (state.contacts.dtype.names or ())
    assert "spin" not in particle_values(state)


def test_no_contacts() -> None:
    alone = ld.Packing([[1.0, 1.0]], 0.5, [3.0, 3.0])
    with ld.Simulation(alone, ld.Ring(), friction=ld.Friction(1, kt=1)) as sim:
        state = sim.state()
    assert len(state.contacts) == len(state.rubbing.springs) == 0
    assert state.spring_energy == 0.0


def test_two_contacts_of_one_pair() -> None:
    """In a small box a pair touches through several images: each contact has its own spring."""
    two = ld.Packing([[0.0, 0.0], [0.98, 0.0]], 0.5, [1.97, 3.0])
    rough = ld.Friction(np.inf, kt=1e-4)
    with ld.Simulation(two, ld.Ring(), friction=rough) as sim:
        sim.lmp.command("set atom 2 vy 0.01")
        state = sim.run(20, timestep=0.1)[-1]
    table = state.contacts
    assert len(table) == 4
    # the particle moves up past both sides of the other: to the left and right of it
    np.testing.assert_allclose(table["spring"][:2], [-0.02, 0.02], rtol=0.05)
    assert len(state.rubbing.springs) == 2


def test_the_graph_has_friction() -> None:
    pytest.importorskip("networkx")
    (*_, state), _ = moved("balanced")
    edges = state.graph().edges(data=True)
    assert {edge["sliding"] for *_, edge in edges} == {False, True}
    assert all(abs(edge["friction"]) <= MU * edge["force"] * 1.5 for *_, edge in edges)


def test_pictures() -> None:
    """Contacts that slide and bars of friction at their contacts, an arrow for each spin."""
    pytest.importorskip("matplotlib").use("agg")
    (*_, state), _ = moved("balanced")
    table = state.contacts

    def lines(color: tuple[float, ...], **parts: bool) -> list[np.ndarray]:
        drawn = state.plot(colorbar=False, **parts).collections[1:]
        found = [each for each in drawn if tuple(each.get_colors()[0]) == color]
        return [path.vertices for each in found for path in each.get_paths()]

    lime, black = (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, 0.0, 1.0)
    sliding = table[table["sliding"]]
    for parts in ({"contacts": True}, {"forces": True}):
        # some again in a periodic image
        middles = [line[[0, -1]].mean(axis=0) for line in lines(lime, **parts)]
        assert len(middles) >= len(sliding)
        distance = np.linalg.norm(sliding["position"][:, None] - middles, axis=2).min(axis=1)
        assert distance.max() < 0.1 * state.packing.radii.min()
    bars = [np.linalg.norm(line[1] - line[0]) for line in lines(lime, forces=True)]
    assert max(bars) == pytest.approx(MU * state.packing.radii.max(), rel=1e-9)
    # the arc of the fastest particle is the longest one; it ends to the left where spins are > 0
    arcs = [line for line in lines(black, spins=True) if len(line) > 3]
    assert len(arcs) >= len(state.packing)
    one = np.argmax(np.abs(state.spins))
    center = state.packing.positions[one]
    arc = min(arcs, key=lambda line: np.linalg.norm(line[0] - center))
    x, y = (arc - center).T
    turn = np.unwrap(np.arctan2(y, x))
    assert turn[-1] - turn[0] == pytest.approx(1.6 * np.pi * np.sign(state.spins[one]))
    state.plot(color="spin", colorbar=False)


def test_no_spins_to_draw() -> None:
    pytest.importorskip("matplotlib").use("agg")
    with ld.Simulation(ld.bidisperse(4, seed=1), ld.SoftContact()) as disks:
        state = disks.state()
    with pytest.raises(ld.ParameterError, match="no spins: give the simulation"):
        state.plot(spins=True)


def test_a_simulation_of_a_state_has_its_friction() -> None:
    friction = ld.Friction(0.3, kt=0.1)
    with ld.Simulation(ld.crystal("hex", (2, 1), phi=0.95), ld.Ring(), friction=friction) as sim:
        state = sim.state()
    for given, expected in ((state, friction), (state.packing, None)):
        with ld.Simulation(given, state.law) as sim:
            assert sim.friction == sim.state().friction == expected
