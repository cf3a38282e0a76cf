"""Compressions of beads and laws side by side: rows, and the criterion of a branch."""

from dataclasses import replace

import numpy as np
import pytest
from deformable import (
    BeadReference,
    Beads,
    BeadState,
    Ring,
    Simulation,
    State,
    bidisperse,
    compress,
    jam,
)
from deformable.report import compressions
from deformable.report.packings import matching_laws

COARSE = Beads(number=25)


@pytest.fixture(scope="module")
def start():
    return jam(bidisperse(8, seed=1))


@pytest.fixture(scope="module")
def pair(start) -> tuple[BeadState, State]:
    """Rings, and particles of the ring law, both strained by 6 %."""
    with BeadReference(start, COARSE) as rings, Simulation(start, Ring()) as sim:
        (exact,) = compress(rings, 0.06, 1)
        (own,) = compress(sim, 0.06, 1)
    return exact, own


def test_rows_of_a_compression(start):
    rows = compressions.compression_rows(8, 1, COARSE, 0.06, 2)
    assert [row["law"] for row in rows] == ["radical, kP inf", "radical", "balanced"] * 2
    assert [row["strain"] for row in rows[::3]] == [0.03, 0.06]
    with BeadReference(start, COARSE) as rings:
        *_, exact = compress(rings, 0.06, 2)
        balanced = matching_laws(COARSE, rings.rings)["balanced"]
    with Simulation(replace(start, radii=exact.rings.effective_radius), balanced) as sim:
        *_, own = compress(sim, 0.06, 2)
    row, wrong = rows[-1], own.area_deficit - exact.area_deficit
    # the same calls again, equal up to rounding
    assert row["energy_ratio"] == pytest.approx(own.energy / exact.energy, rel=1e-6)
    assert row["pressure_ratio"] == pytest.approx(own.pressure / exact.pressure, rel=1e-6)
    assert row["S_rms"] == pytest.approx(
        np.sqrt(np.mean(wrong**2) / np.mean(exact.area_deficit**2)), rel=1e-6
    )
    for row in rows:
        assert row["same_branch"] == (row["centers_rms"] <= 2.0 * row["strain"])
        assert row["seconds"] > 0.0
        assert row["seconds_beads"] > 0.0
        assert row["beads"] == 25


def moved(exact: BeadState, step: np.ndarray) -> BeadState:
    return replace(exact, packing=replace(exact.packing, positions=exact.packing.positions + step))


def test_distance_of_centers(pair):
    """Neither drift nor periodic images nor rattlers count; a particle that moves does."""
    exact, own = pair
    same = replace(exact, packing=replace(exact.packing, positions=own.packing.positions))
    touching = np.bincount(np.concatenate([exact.contacts.i, exact.contacts.j]), minlength=8)
    held = np.flatnonzero((touching >= 3) & ~own.rattlers)
    assert len(held) >= 3
    assert compressions.centers_rms(same, own) == pytest.approx(0.0, abs=1e-15)
    images = np.random.default_rng(1).integers(-2, 3, (8, 2)) @ own.packing.box
    drifted = moved(same, images + np.array([0.3, -2.0]))
    assert compressions.centers_rms(drifted, own) == pytest.approx(0.0, abs=1e-14)
    step = np.zeros((8, 2))
    step[held[-1]] = 0.03, 0.04
    share = 1.0 / len(held)
    expected = 0.05 * np.sqrt(share * (1.0 - share)) / own.packing.radius.mean()
    assert compressions.centers_rms(moved(drifted, step), own) == pytest.approx(expected)


def test_rattlers_do_not_count(pair):
    exact, own = pair
    loose = exact.contacts.i[0]
    there = (exact.contacts.i != loose) & (exact.contacts.j != loose)
    contacts = replace(
        exact.contacts,
        **{name: value[there] for name, value in vars(exact.contacts).items()},
    )
    exact = replace(exact, contacts=contacts)
    step = np.zeros((8, 2))
    step[loose] = 0.1
    before = compressions.centers_rms(exact, own)
    assert before == compressions.centers_rms(moved(exact, step), own)
    none = replace(contacts, **{name: value[:0] for name, value in vars(contacts).items()})
    assert compressions.centers_rms(replace(exact, contacts=none), own) is None
    assert compressions.centers_rms(exact, replace(own, stress=1e-7 * own.stress)) is None


def test_branch():
    assert compressions.same_branch(0.0199, 0.01)
    assert not compressions.same_branch(0.0201, 0.01)
    assert not compressions.same_branch(None, 0.01)


def test_net_force(pair):
    exact, _ = pair
    force = np.zeros_like(exact.contacts.force)
    force[0] = 3.0, 4.0
    one = replace(exact, contacts=replace(exact.contacts, force=force))
    # the only force, over a mean of all contacts
    assert compressions.net_force(one) == pytest.approx(len(force))
    none = replace(exact.contacts, **{n: v[:0] for n, v in vars(exact.contacts).items()})
    assert compressions.net_force(replace(exact, contacts=none)) == 0.0
