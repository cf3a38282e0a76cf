"""Contacts that form and break between states, and T1 events, found by eye."""

from dataclasses import replace

import lammps_deformable as ld
import numpy as np


def state(places: list[list[float]], walls: tuple = (), labels: list[int] | None = None):
    """Disks of radius 0.5."""
    packing = ld.Packing(places, 0.5, (10.0, 10.0), walls=walls)
    with ld.Simulation(packing, ld.SoftContact()) as sim:
        found = sim.state()
    return found if labels is None else replace(found, labels=np.array(labels))


# Four disks: 2 and 3 above and below the middle of 0 and 1.
APART = state([[4.5, 5.0], [5.45, 5.0], [4.97, 5.8], [4.97, 4.2]])
ACROSS = state([[4.2, 5.0], [5.75, 5.0], [4.97, 5.45], [4.97, 4.55]])


def rows(*states: ld.State) -> list[tuple]:
    events = ld.Run(states).events()
    return list(zip(*(events[name] for name in ("frame", "event", "i", "j", "t1")), strict=True))


def test_two_part_and_their_neighbors_meet() -> None:
    assert rows(APART, ACROSS) == [(1, "breaks", 0, 1, 0), (1, "forms", 2, 3, 0)]
    assert rows(APART, ACROSS, ACROSS, APART) == [
        (1, "breaks", 0, 1, 0),
        (1, "forms", 2, 3, 0),
        (3, "breaks", 2, 3, 1),
        (3, "forms", 0, 1, 1),
    ]


def test_contacts_elsewhere_are_no_t1() -> None:
    """Disk 3 is a neighbor of 0 and 1 in neither state."""
    before = state([[4.5, 5.0], [5.45, 5.0], [4.97, 5.8], [4.97, 8.0]])
    after = state([[4.2, 5.0], [5.75, 5.0], [4.97, 5.45], [4.97, 6.4]])
    assert rows(before, after) == [(1, "breaks", 0, 1, -1), (1, "forms", 2, 3, -1)]


def test_a_neighbor_of_one_only_is_no_t1() -> None:
    """Disk 3 touches 0 all the time, and never 1."""
    before = state([[4.5, 5.0], [5.45, 5.0], [4.97, 5.8], [3.7, 5.5]])
    after = state([[4.2, 5.0], [5.75, 5.0], [4.6, 5.9], [3.75, 5.85]])
    assert rows(before, after) == [
        (1, "breaks", 0, 1, -1),
        (1, "breaks", 1, 2, -1),
        (1, "forms", 2, 3, -1),
    ]


def test_walls_and_images() -> None:
    """A contact over the boundary is one like others; a wall has its code."""
    floor = ld.Plane((0.0, 0.0), (0.0, 1.0))
    before = state([[0.2, 0.4], [9.4, 0.4]], (floor, ld.Plane((0.0, 10.0), (0.0, -1.0))))
    after = state([[0.2, 0.4], [8.4, 5.0]], (floor, ld.Plane((0.0, 10.0), (0.0, -1.0))))
    assert rows(before, after) == [(1, "breaks", 0, 1, -1), (1, "breaks", 1, -1, -1)]
    assert rows(after, before) == [(1, "forms", 0, 1, -1), (1, "forms", 1, -1, -1)]


def test_labels_tell_who_is_gone() -> None:
    left = state([[5.45, 5.0], [4.97, 5.8], [4.97, 4.2]], labels=[1, 2, 3])
    gone = [(1, "vanishes", 0, 0, -1)]
    parted = [(1, "breaks", 0, j, -1) for j in (1, 2, 3)]
    assert rows(APART, left) == gone + parted
    assert rows(left, APART) == [(1, "is born", 0, 0, -1)] + [
        (1, "forms", 0, j, -1) for j in (1, 2, 3)
    ]


def test_the_table() -> None:
    events = ld.Run([APART, replace(ACROSS, time=2.0)]).events()
    assert list(events) == ["frame", "time", "event", "i", "j", "t1"]
    assert events["time"].tolist() == [2.0, 2.0]
    assert len(events.to_pandas()) == 2
    assert len(ld.Run([APART]).events()["frame"]) == 0


def test_droplets_have_no_t1() -> None:
    packing = ld.crystal("fcc", 2, phi=0.76)
    with ld.Simulation(packing, ld.Droplet()) as sim:
        close, loose = sim.state(), sim.compress(strain=-0.1)[-1]
    events = ld.Run([close, loose]).events()
    assert set(events["event"]) == {"breaks"}
    assert len(events["i"]) == np.sum(close.contacts["i"] < close.contacts["j"])
    assert set(events["t1"]) == {-1}


def test_a_shear_rearranges() -> None:
    """Coordination changes by what the table has."""
    with ld.Simulation(ld.jam(ld.bidisperse(16, seed=4)).packing, ld.Ring()) as sim:
        sim.compress(strain=0.01)
        run = sim.shear(0.3, steps=15)
    events = run.events()
    signs = {"forms": 1, "breaks": -1}
    change = sum(signs[event] for event in events["event"])

    def number(each: ld.State) -> int:
        pairs = np.sort(each.contacts[["i", "j"]].tolist(), axis=1)
        return len(np.unique(pairs, axis=0))

    assert change == number(run[-1]) - number(run[0])
    for t1 in range(events["t1"].max(initial=-1) + 1):
        two = events["event"][events["t1"] == t1]
        assert sorted(two) == ["breaks", "forms"]
