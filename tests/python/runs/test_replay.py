"""Recorded runs whose particles change: radii, species and number."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from exact_balance import exactly_balanced
from lammps_deformable import FileError, Packing, Ring
from protocol_helpers import written

LAW = Ring(kA=5.0, kP=0.0, tension=1.0)


@pytest.fixture(scope="module", autouse=True)
def exact_states() -> Iterator[None]:
    """States that are read back agree with the former ones to rounding."""
    with exactly_balanced():
        yield


@pytest.fixture(scope="module")
def start() -> Packing:
    radii = np.random.default_rng(1).uniform(0.4, 0.6, 20)
    return ld.polydisperse(20, radii, phi=0.9, seed=1).push_off()


def test_growth_and_death(start: Packing, tmp_path: Path) -> None:
    """Each frame has the radii and the particles of its own, not those of the last one."""
    with ld.Simulation(start, LAW) as sim:
        states = [sim.state()]
        for _ in range(2):
            packing = states[-1].packing
            radius = 1.02 * packing.radii[:-3]
            sim.reset(
                packing.replace(
                    positions=packing.positions[:-3],
                    species=packing.species[:-3],
                    radii=radius,
                )
            )
            states.append(sim.state())
    written(states, tmp_path)
    again = list(ld.Run(tmp_path))
    assert [len(state.packing) for state in again] == [20, 17, 14]
    for found, state in zip(again, states, strict=True):
        assert np.array_equal(found.packing.radii, state.packing.radii)
        assert found.energy == pytest.approx(state.energy, rel=1e-10)
        assert found.results["area"] == pytest.approx(state.results["area"], rel=1e-10)
    with pytest.raises(FileError, match="14 to 20 particles"):
        ld.Run(tmp_path).to_mdanalysis()


def test_a_frame_has_its_own_radii_law_and_walls(tmp_path: Path) -> None:
    """Those of the last state would give other packing fractions, energies and forces."""
    packing = ld.bidisperse(16, seed=2).at(0.7).push_off()
    grown = packing.replace(radii=1.1 * packing.radii)
    obstacle = ld.Sphere(0.2, packing.positions[0] + [0.0, 1.2], inside=False)
    moved = replace(obstacle, origin=packing.positions[1] + [0.0, 1.2])
    states = []
    for each, law, walls in (
        (packing, Ring(), ()),
        (grown, Ring(kA=2.0), ()),
        (packing, Ring(contact="radical", kP=0.5), ()),
        (packing, Ring(), (obstacle,)),
        (packing, Ring(), (moved,)),
    ):
        with ld.Simulation(each.replace(walls=walls).push_off(), law) as sim:
            states.append(sim.state())
    states += states[:2]
    written(states, tmp_path)
    for found, state in zip(ld.Run(tmp_path), states, strict=True):
        assert found.law == state.law
        assert found.packing.walls == state.packing.walls
        assert found.phi == pytest.approx(state.phi, rel=1e-12)
        assert found.energy == pytest.approx(state.energy, rel=1e-9)
    assert (tmp_path / "setups.jsonl").read_text().count("\n") == 7


def test_a_run_is_indexed(start: Packing, tmp_path: Path) -> None:
    with ld.Simulation(start, LAW) as sim:
        sim.compress(strain=-0.01, steps=4, record=tmp_path)
    run = ld.Run(tmp_path)
    fractions = [state.phi for state in run]
    assert len(run) == len(set(fractions)) == 5
    assert [run[n].phi for n in (0, 4, -1, -5)] == [fractions[n] for n in (0, 4, -1, -5)]
    for part in (slice(1, 3), slice(None, None, -1), slice(9, None)):
        assert [state.phi for state in run[part]] == fractions[part]
    for number in (5, -6):
        with pytest.raises(IndexError, match=f"has 5 states, and no state {number}"):
            run[number]
    assert isinstance(run[1:3], ld.Run)
    assert repr(run[1:3]) == f"Run({str(tmp_path)!r})[1:3]"
    assert [state.phi for state in run[1:][::2]] == fractions[1::2]
    with ld.Run(tmp_path).simulation() as sim:
        more = sim.compress(strain=0.01, record=tmp_path, mode="a")
    assert (len(run), run[-1].phi) == (6, more[-1].phi)
    assert run[1:3].simulation().state().phi == pytest.approx(fractions[2], rel=1e-12)
    assert len(ld.Run(list(run))) == 6


def test_a_saved_state_is_a_run_without_frames(start: Packing, tmp_path: Path) -> None:
    with ld.Simulation(start, LAW) as sim:
        sim.state().save(tmp_path)
    run = ld.Run(tmp_path)
    assert (len(run), list(run), len(run[:])) == (0, [], 0)
    with pytest.raises(IndexError, match="one saved state and no recorded ones"):
        run[-1]
