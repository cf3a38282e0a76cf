"""Degrees of the contact network, and its coordination beyond isostaticity, by loops."""

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import crystal
from lammps_deformable import Ring
from lammps_deformable.state.contacts import Later, forces_of, isostatic

DROPLETS = Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved")


@pytest.fixture(scope="module")
def states() -> list[ld.State]:
    """Droplets and disks above jamming, alone, in a rectangle and in a channel.

    The last ones are not at rest: there rattlers bear forces.
    """
    found: list[ld.State] = []
    for walls in ((), ld.BoxWall((8, 7)), ld.BoxWall((8, 7)).parts[2:]):
        loose = ld.bidisperse(24, seed=5)
        loose = loose.between(walls) if walls else loose
        pressed = loose.at(0.87).push_off()
        with (
            ld.Simulation(pressed, DROPLETS) as sim,
            ld.Simulation(pressed, ld.SoftContact()) as disks,
        ):
            found += [sim.relax(), disks.relax()]
    dense = ld.jam(ld.bidisperse(24, seed=1)).packing.at(0.95)
    shaken = np.random.default_rng(1).normal(scale=0.03, size=dense.positions.shape)
    moved = dense.replace(positions=dense.positions + shaken)
    with ld.Simulation(moved, DROPLETS) as sim, ld.Simulation(moved, ld.SoftContact()) as disks:
        return [*found, sim.state(), disks.state()]


def by_loops(state: ld.State, threshold: float) -> tuple[int, np.ndarray]:
    """Contacts and the degree of each particle, once rattlers are gone."""
    contacts = forces_of(state)
    all_of_them = [
        (int(i), int(j), float(np.hypot(*force)))
        for i, j, force in zip(contacts.i, contacts.j, contacts.force, strict=True)
    ]

    def rigid(kept: list[tuple[int, int, float]]) -> tuple[list, np.ndarray]:
        while True:
            degree = np.zeros(len(state.packing), int)
            for i, j, _ in kept:
                degree[i] += 1
                degree[j] += j >= 0
            held = [c for c in kept if degree[c[0]] >= 3 and (c[1] < 0 or degree[c[1]] >= 3)]
            if len(held) == len(kept):
                return held, degree
            kept = held

    mean = np.mean([force for *_, force in rigid(all_of_them)[0]])
    held, degree = rigid([c for c in all_of_them if c[2] >= threshold * mean])
    return len(held), degree


def test_degrees_and_excess_by_loops(states: list) -> None:
    for n, state in enumerate(states):
        contacts, degree = by_loops(state, 0.0)
        assert degree.any()
        assert state.network_degree.tolist() == degree.tolist(), n
        assert state.network_contacts == contacts
        assert (state.rattlers == (degree == 0)).all()
        motions = {0: 2, 2: 1, 4: 0}[len(state.packing.walls)]
        found = {}
        for threshold in (0.0, 1e-3, 0.3, 1.0, 50.0):
            contacts, degree = by_loops(state, threshold)
            particles = int(np.sum(degree > 0))
            expected = 2.0 * (contacts - (2 * particles + 1 - motions)) / max(particles, 1)
            found[threshold] = state.excess_coordination(threshold)
            assert found[threshold] == (expected if particles else 0.0), (n, threshold)
        assert found[0.3] < found[0.0]
        assert found[50.0] == 0.0


@pytest.mark.parametrize("law", [Ring(), Ring(contact="radical"), ld.Droplet()])
def test_ends_are_those_of_the_table(law: ld.Ring | ld.Droplet) -> None:
    """Where both sides have rows; else nothing is said."""
    if isinstance(law, ld.Droplet):
        scenes = [ld.jam(ld.bidisperse(40, dimension=3, seed=2)).packing.at(0.66)]
    else:
        between = ld.bidisperse(24, seed=5).between(ld.BoxWall((8, 7)).parts[2:])
        small = ld.jam(ld.bidisperse(3, seed=1)).packing.at(0.9)
        scenes = [between.at(0.87).push_off(), small]
    for packing in scenes:
        with ld.Simulation(packing, law) as sim:
            later = sim.state()._table
        assert isinstance(later, Later)
        assert (later.ends is not None) == later.one_force
        if later.ends:
            pairs = zip(later.table["i"].tolist(), later.table["j"].tolist(), strict=True)
            assert sorted(zip(*(each.tolist() for each in later.ends), strict=True)) == list(pairs)
        assert later.one_force == (law != Ring(contact="radical"))


def test_ends_are_not_told_where_a_side_lacks() -> None:
    packing = ld.Packing([[1.0, 1.0], [2.0, 1.0], [3.0, 1.0]], 0.5, (4.0, 4.0))
    for words, lacks in (((1, 2), True), ((1, 2, 2, 3), True), ((1, 2, 2, 1, 1, -1), False)):
        rows = np.array(words, float).reshape(-1, 2)
        assert (Later(rows, packing, True).ends is None) == lacks


def test_without_contacts_there_is_no_excess() -> None:
    with ld.Simulation(crystal(-0.03), Ring()) as sim:
        state = sim.state()
    assert not state.network_degree.any()
    assert state.excess_coordination() == state.excess_coordination(0.5) == 0.0


def test_thresholds_are_parts_of_a_force(states: list) -> None:
    for threshold in (-0.1, "much"):
        with pytest.raises(ld.ParameterError, match="threshold must"):
            states[0].excess_coordination(threshold)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("walls", [(), ld.BoxWall((8, 7)).parts])
def test_isostatic_numbers_where_contacts_rub(dimension: int, walls: tuple[ld.Plane, ...]) -> None:
    """Contacts with `dimension` forces each, at least as many as motions; no half ones."""
    motions = 3 if dimension == 2 else 6
    assert isostatic(0, walls, dimension, True) == 0
    for rigid in range(1, 9):
        needed = motions * rigid - (0 if walls else dimension) + dimension
        found = isostatic(rigid, walls, dimension, True)
        assert found * dimension <= needed < (found + 1) * dimension
