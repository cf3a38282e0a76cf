"""Jamming: the onset of rigidity of soft disks and of deformable particles."""

import dataclasses
import math
import warnings
from types import SimpleNamespace
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from contact_laws import simulate
from lammps_deformable.engine import jamming, soft_disks
from lammps_deformable.engine.jamming import natural_pressure
from lammps_deformable.engine.simulation import relax_above
from lammps_deformable.engine.soft_disks import (
    RelaxedDisks,
    Report,
    relax_at_pressure,
    relax_in_box,
)
from mpi4py import MPI

RADICAL, BALANCED = (ld.Ring(contact=contact) for contact in ("radical", "balanced"))
ONSETS = [
    (None, 1e-7, 1),
    (RADICAL, 1e-16, 2),
    (ld.Ring(kA=[4.0, 1.0], kP=2.0), 1e-16, 1),
    (BALANCED, 1e-13, 2),
]


def onset(packing: ld.Packing, law: ld.Ring | None) -> ld.State:
    with simulate(packing, law) as sim:
        return sim.state()


def assert_at_onset(jammed: ld.Packing, rel: float, tolerance: float = 1e-6) -> None:
    """Disks whose threshold is 1e-7; rounding of the box length moves them a little."""
    state = onset(jammed, None)
    assert state.pressure == pytest.approx(1.4e-7, rel=rel)
    assert state.residual <= 1.5 * tolerance


def pairs(state: ld.State) -> set[tuple[int, int]]:
    """Pairs i < j in contact, without rattlers."""
    i, j = state.contacts["i"], state.contacts["j"]
    rigid = ~state.rattlers
    return {(min(p), max(p)) for p in zip(i.tolist(), j.tolist(), strict=True) if rigid[[*p]].all()}


def test_equal_mixture_jams_near_084() -> None:
    jammed = ld.jam(ld.bidisperse(128, seed=1)).packing
    assert 0.825 < jammed.phi < 0.855


def distances(packing: ld.Packing) -> np.ndarray:
    """Of each pair once, shape (N (N - 1)/2,)."""
    fraction = (packing.positions[:, None] - packing.positions) @ np.linalg.inv(packing.box)
    distance = np.linalg.norm((fraction - np.rint(fraction)) @ packing.box, axis=2)
    return distance[np.triu_indices(len(packing), 1)]


def test_one_particle_jams_against_its_images() -> None:
    assert ld.jam(ld.bidisperse(1, seed=1)).phi == pytest.approx(np.pi / 4, rel=1e-4)


@pytest.mark.parametrize(("law", "pressure", "seed"), ONSETS)
def test_onset_is_isostatic_and_at_its_pressure(
    law: ld.Ring | None, pressure: float, seed: int
) -> None:
    """Relaxed to 1e-6, N' particles have 2N' - 1 contacts, one more than modes of motion."""
    packing = ld.bidisperse(16, seed=seed)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        jammed = ld.jam(packing, law, pressure=pressure, tolerance=1e-6).packing
    state = onset(jammed, law)
    assert pressure < state.pressure <= 2.0 * pressure
    # disks are relaxed to 1e-6 of the threshold; rounding of the box length moves them a little
    assert state.residual <= 1.5e-6
    held = int(np.sum(~state.rattlers))
    assert state.network_contacts == state.isostatic_contacts == 2 * held - 1
    assert state.coordination == pytest.approx(2 * (2 * held - 1) / held)


def test_rings_jam_where_disks_do() -> None:
    """Neither has an energy before circles overlap, so from one loose packing both jam in one way.

    At their thresholds disks are 3.5e-7 beyond phi_J (p = 0.4 x), rings 3e-6 (p = 5 x^3).
    """
    disks = ld.jam(ld.bidisperse(16, seed=1), pressure=1e-7, tolerance=1e-6).packing
    with ld.Simulation(disks.at(disks.phi - 1e-3), RADICAL) as sim:
        sim.deform(disks.at(disks.phi + 2.7e-6).box)
        rings = relax_above(sim, 1e-6, 1e-16).packing
    assert pairs(onset(rings, RADICAL)) == pairs(onset(disks, None))


def test_natural_pressure() -> None:
    packing = ld.bidisperse(4, sizes=(0.5, 1.5), seed=1)  # R0 = 1
    for law, unit in (
        (None, 1.0),
        (ld.Ring(kA=3.0), 3.0),
        (ld.Ring(kA=np.inf, kP=5.0), 5.0),
        (ld.Ring(kA=3.0, kP=6.0), 2.0),
        (ld.Ring(kA=[3.0, 1.0]), 2.0),
        (ld.Sector(kA=3.0), 3.0),
        (ld.Ring(kA=np.inf, kP=0.0, tension=2.0), 2.0),
        (ld.Ring(kA=3.0, kP=0.0, tension=2.0), 2.0),
        (ld.Ring(kA=3.0, kP=6.0, tension=2.0), 4.0),
    ):
        assert natural_pressure(packing, law or ld.SoftContact()) == pytest.approx(unit)
    small = ld.bidisperse(4, sizes=(0.25, 0.75), seed=1)
    assert natural_pressure(small, ld.Ring(kA=3.0)) == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("dimension", "law"),
    [
        (2, ld.SoftContact(k=8.0)),
        (2, ld.Ring(kA=8.0)),
        (2, ld.Ring(kA=np.inf, kP=0.0, tension=8.0)),
        (3, ld.SoftContact(k=8.0)),
        (3, ld.Droplet(8.0)),
    ],
    ids=str,
)
@pytest.mark.parametrize("grow", [False, True])
def test_the_pressure_has_the_unit_of_all_pressures(dimension: int, law: Any, grow: bool) -> None:
    """Energy/length^d, at any radii; and 1e-6 of the natural one if it is not given."""
    sizes = (0.05, 0.06) if grow else (0.25, 0.3)
    start = ld.bidisperse(12, sizes=sizes, phi=0.3, dimension=dimension, seed=1)
    unit = natural_pressure(start.at({2: 0.84, 3: 0.64}[dimension], grow=grow), law)
    for pressure, given in ((1e-5 * unit, {"pressure": 1e-5 * unit}), (1e-6 * unit, {})):
        jammed = ld.jam(start, law, grow=grow, tolerance=1e-2, **given)
        assert pressure * (1.0 - 1e-3) <= jammed.pressure <= 2.0 * pressure
    with pytest.raises(ld.ParameterError, match=r"pressure = .* is far above an onset: .* default"):
        ld.jam(start, law, grow=grow, pressure=unit)


def test_sector_warns_that_it_has_no_onset() -> None:
    with pytest.warns(ld.StalledWarning, match="the onset of jamming is uncertain"):
        ld.jam(ld.bidisperse(8, seed=2), ld.Sector(), pressure=1e-4)


def test_a_relaxation_that_stalls_does_not_end_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the next step of phi the rings may come to rest; after three in a row `jam` warns."""
    relaxed, stalls = jamming._relaxed, [True, True]

    def stalling(*arguments: Any) -> ld.State:
        state = relaxed(*arguments)
        return dataclasses.replace(state, converged=not stalls.pop()) if stalls else state

    monkeypatch.setattr(jamming, "_relaxed", stalling)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ld.jam(ld.bidisperse(16, seed=1), RADICAL, pressure=1e-7)
    stalls += [True] * 3
    with pytest.warns(ld.StalledWarning):
        ld.jam(ld.bidisperse(16, seed=1), RADICAL, pressure=1e-7)


@pytest.mark.parametrize(("way", "steps"), [(5e-6, 3), (0.02, 18)])
def test_loose_particles_climb_in_growing_steps(
    way: float, steps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of droplets that are loose up to a higher phi than disks, and rigid from there on.

    Steps 1.4e-6 2^k, up to 0.0025 each, add up to the way. The last one leads too far by at most
    its length, and steps back are at most half as long: there are two.
    """
    packing = ld.bidisperse(8, phi=0.8, seed=1)
    seen: list[float] = []

    def relaxed(packing: ld.Packing, *_: Any) -> Any:
        seen.append(packing.phi)
        found = max(packing.phi - 0.8 - way, 0.0) / 0.6  # tension/R0
        table = np.zeros(0, [("i", int), ("j", int)])
        return ld.State(packing, ld.SoftContact(), 0.0, found * np.eye(2), 0.0, True, _table=table)

    monkeypatch.setattr(jamming, "_relaxed", relaxed)
    monkeypatch.setattr(jamming, "_jammed_disks", lambda *_: SimpleNamespace(packing=packing))
    law = ld.Ring(kA=np.inf, kP=0.0, tension=1.0)
    jammed = ld.jam(packing, law).packing
    assert 1e-6 < jammed.phi - 0.8 - way <= 2e-6
    assert len(seen) <= 1 + steps + 2
    assert np.diff(seen).max() < 0.0025 * (1.0 + 1e-9)


def test_rattlers_fall_one_after_another() -> None:
    """Four particles hold each other; 5 and 6 have two contacts each, and 4 is left with one."""
    packing = ld.bidisperse(7, seed=1)
    ends = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3), (0, 4)]
    ends += [(4, 5), (4, 6), (5, 6)]
    both = np.concatenate([ends, np.fliplr(ends)])
    table = np.zeros(len(both), [("i", int), ("j", int)])
    table["i"], table["j"] = both[np.lexsort(both.T[::-1])].T
    state = ld.State(packing, ld.SoftContact(), 0.0, np.zeros((2, 2)), 0.0, False, _table=table)
    assert state.rattlers.tolist() == [False] * 4 + [True] * 3
    assert (state.network_contacts, state.isostatic_contacts) == (6, 7)
    assert state.coordination == 3.0


def test_disks_that_rearrange_slowly_are_compressed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The fourth pressure is said not to be reached: they go back up, and still come to rest."""
    asked: list[tuple[float, int]] = []

    def relax(
        packing: ld.Packing, pressure: float, part: float, patience: int, report: Report
    ) -> RelaxedDisks:
        asked.append((pressure, patience))
        found = relax_at_pressure(packing, pressure, part, patience, report)
        return found._replace(converged=len(asked) != 4)

    monkeypatch.setattr(jamming, "relax_at_pressure", relax)
    jammed = ld.jam(ld.bidisperse(64, seed=1), pressure=1e-7, tolerance=1e-6).packing
    pressures, patience = np.transpose(asked)
    assert np.flatnonzero(np.diff(pressures) > 0.0).tolist() == [3]
    assert pressures.max() == pressures[0]
    assert patience[3] < patience[4] == patience[-1]
    assert_at_onset(jammed, rel=1e-6)


@pytest.mark.parametrize("many", [64, 65])
def test_many_disks_are_told_to_be_rigid_early(many: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """But not the start, which may be far from rest, nor the packing that is decompressed."""
    asked: list[Any] = []

    def relax(
        packing: ld.Packing, part: float, loose: float, report: Report, rigid: Any
    ) -> RelaxedDisks:
        asked.append(rigid)
        return relax_in_box(packing, part, loose, report, rigid)

    monkeypatch.setattr(jamming, "_MANY", many)
    monkeypatch.setattr(jamming, "relax_in_box", relax)
    jammed = ld.jam(ld.bidisperse(64, seed=1), pressure=1e-7, tolerance=1e-6).packing
    assert asked[0] is asked[-1] is None
    assert (jamming._RIGID in asked) == (many == 64)
    assert_at_onset(jammed, rel=1e-4)


def test_clearly_rigid_disks_are_not_relaxed_to_the_end() -> None:
    """At phi = 0.9 the pressure tells before forces are small."""
    packing = ld.bidisperse(400, phi=0.8, seed=1).push_off().at(0.9)
    ends = {}
    for rigid in (0.01, math.inf):  # pressures
        reports: list[int] = []
        found = relax_in_box(packing, 1e-3, 1e-4, lambda *_, to=reports: to.append(1), (rigid, 0.1))
        ends[rigid] = found.residual, len(reports)
        assert found.pressure > 0.01
        assert found.converged
    assert ends[math.inf][0] <= 1e-3 < ends[0.01][0] <= 1.0
    assert ends[0.01][1] < 0.2 * ends[math.inf][1]


def of_kind(kind: str) -> ld.Packing:
    if kind == "particle radii":
        return ld.polydisperse(64, np.geomspace(0.2, 1.2, 64), phi=0.3, seed=1)
    packing = ld.bidisperse(64, seed=1)
    return packing.between([ld.Sphere(6, (0, 0))]) if kind == "walls" else packing


@pytest.mark.parametrize("kind", ["species", "particle radii"])
def test_huge_packings_settle_by_damped_motion(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Disks keep their order; a tiny tolerance is left to the minimizer."""
    monkeypatch.setattr(soft_disks, "HUGE", 64)
    monkeypatch.setattr(jamming, "HUGE", 64)
    monkeypatch.setattr(jamming, "_STEPS", 2000)
    packing = of_kind(kind)
    for tolerance in (0.1, 1e-6) if kind == "species" else (0.1,):
        jammed = ld.jam(packing, pressure=1e-7, tolerance=tolerance).packing
        assert np.array_equal(jammed.radii, packing.radii)
        assert_at_onset(jammed, tolerance, tolerance)


@pytest.mark.parametrize("kind", ["species", "walls"])
def test_conjugate_gradients_jam_disks_too(kind: str) -> None:
    """What LAMMPS has no energy for is relaxed as without a communicator."""
    alone, shared = (
        ld.jam(of_kind(kind), pressure=1e-7, tolerance=1e-6, comm=comm).packing
        for comm in (None, MPI.COMM_SELF)
    )
    assert (kind == "species") != np.array_equal(alone.positions, shared.positions)
    assert_at_onset(shared, rel=1e-4)


def test_rigid_start_is_refused() -> None:
    with pytest.raises(ld.ParameterError, match=r"Packing, not .*: take its `packing`"):
        ld.jam(ld.jam(ld.bidisperse(4, seed=1)))  # type: ignore[arg-type]
    with pytest.raises(ld.ParameterError, match=r"rigid already at phi = 1\.1000"):
        ld.jam(ld.bidisperse(32, phi=1.1, seed=1))
    with pytest.raises(ld.ParameterError, match="pressure must be a positive number"):
        ld.jam(ld.bidisperse(8, seed=1), pressure=0.0)


def in_one_place(number: int) -> ld.Packing:
    """Disks at a corner of a tilted box, in all four cells around it."""
    box = np.array([[4.0, 0.0], [1.0, 4.0]])
    cells = np.array([[0, 0], [1, 0], [0, 1], [1, 1], [0, 0]])[:number]
    return ld.Packing(cells @ box, np.full(number, 0.5), box)


def test_centers_at_one_place_are_pushed_apart() -> None:
    packing = in_one_place(5)
    apart, again = packing.push_off(), packing.push_off()
    assert np.array_equal(apart.positions, again.positions)
    # forces end at 1e-3 of a pressure of 1e-3 times R, and overlaps are forces; a disk has up to 5
    assert distances(apart).min() > 1.0 - 5 * 0.5e-6
    # small boxes jam early, and no disks of one size beyond the triangular lattice
    assert packing.phi + 0.1 < ld.jam(packing).phi < 0.907


def test_other_centers_stay_when_some_are_parted() -> None:
    packing = in_one_place(3)
    alone = np.vstack([packing.positions, [2.5, 2.0]])
    (x, y) = ld.Packing(alone, np.full(4, 0.5), packing.box).push_off().positions[3]
    assert (x, y) == pytest.approx((2.5, 2.0), abs=1e-12)
