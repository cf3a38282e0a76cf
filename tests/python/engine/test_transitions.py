"""States of each law, and after each kind of motion, start simulations of all laws."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import inf
from typing import Any

import lammps_deformable as ld
import pytest

STICKS = ld.Ring(kA=inf, kP=0.0, tension=1.0, adhesion=0.1, contact="curved")
LAWS: dict[str, Any] = {
    "ring": ld.Ring(),
    "droplet": ld.Ring(kA=inf, kP=0.0, tension=1.0, contact="curved"),
    "adhesion": STICKS,
    "sector": ld.Sector(),
    "soft": ld.SoftContact(),
    "polygon": ld.DeformablePolygon(19),
    "beads": ld.DeformablePolygon(19, smooth=False),
    "in space": ld.Droplet(),
}


@cache
def jammed() -> ld.State:
    return ld.jam(ld.bidisperse(6, seed=2))


def of(name: str, **settings: Any) -> ld.Simulation:
    return ld.Simulation(jammed().packing, LAWS[name], **settings)


def moved(name: str, **settings: Any) -> ld.State:
    with of(name, **settings) as sim:
        return sim.run(20, temperature=1e-6, seed=1)[-1]


def rests(name: str) -> ld.State:
    with of(name) as sim:
        return sim.relax(1e-3 if name == "adhesion" else 0.1, max_steps=1000)


def between_sticky_walls() -> ld.State:
    walls = ld.Plane((0.0, 0.0), (0.0, 1.0)), ld.Plane((0.0, 6.0), (0.0, -1.0))
    free = ld.jam(ld.bidisperse(6, seed=2).between(walls).at(0.45)).packing
    packing = replace(free, walls=(replace(free.walls[0], adhesion=0.2), free.walls[1]))
    with ld.Simulation(packing, LAWS["droplet"]) as sim:
        state = sim.relax(0.1)
    assert state.films is not None
    return state


STARTS: dict[str, Callable[[], ld.State]] = {
    "jammed": jammed,
    **{name: (lambda name=name: rests(name)) for name in LAWS if name != "in space"},
    **{f"{name}, moved": (lambda name=name: moved(name)) for name in ("ring", "droplet")},
    "adhesion, moved": lambda: moved("adhesion", gravity=(0.0, 0.0)),
    "friction": lambda: moved("ring", friction=ld.Friction(0.3, kt=0.01)),
    "falling": lambda: moved("ring", gravity=(0.0, -1e-4)),
    "sticky walls": between_sticky_walls,
    "in space": lambda: ld.jam(ld.bidisperse(6, dimension=3, seed=2), ld.Droplet()),
}


def refusal(start: str, law: str) -> str | None:
    """Words of the error where a law refuses a state; None if it takes it."""
    if start == "in space":
        return None if law in ("soft", "in space") else "three dimensions"
    if law == "in space":
        return "three dimensions"
    if start == "friction" and law in ("sector", "soft", "polygon", "beads"):
        return "start from the packing of the state"
    if start == "falling" and law in ("soft", "polygon", "beads"):
        return "has no gravity"
    if start == "sticky walls" and law in ("ring", "sector", "soft", "polygon", "beads"):
        if law == "soft":
            return "soft contacts have none"
        return "polygons have no walls" if law in ("polygon", "beads") else "plane 1: adhesion"
    if start == "adhesion" and law in ("polygon", "beads"):
        return "overlap by at most the bead radius"
    return None


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("start", STARTS)
def test_a_state_starts_any_law(start: str) -> None:
    """As its packing does, or with one line; a simulation that refuses it is as it was."""
    state = STARTS[start]()
    for name, law in LAWS.items():
        error = refusal(start, name)
        if error is None:
            with ld.Simulation(state, law) as sim, ld.Simulation(state.packing, law) as new:
                found = sim.state()
                remembers = state.friction or start == "sticky walls" or law == STICKS
                if not remembers:
                    assert found.pressure == pytest.approx(new.state().pressure, rel=1e-6)
                new.reset(state)
                assert new.state().pressure == pytest.approx(found.pressure, rel=1e-6)
            continue
        with pytest.raises(ld.ParameterError, match=error):
            ld.Simulation(state, law)
        other = "in space" if name == "in space" else "jammed"
        if start in ("friction", "falling"):  # a simulation keeps its own
            continue
        with ld.Simulation(STARTS[other]().packing, law) as sim:
            before = sim.state()
            with pytest.raises(ld.ParameterError, match=error):
                sim.reset(state)
            assert sim.state().pressure == pytest.approx(before.pressure, rel=1e-9)
            assert sim.walls == before.packing.walls
