"""Recorded runs whose particles change: radii, species and number."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import deformable
import numpy as np
import pytest
from deformable import FileError, Packing, Ring
from exact_balance import exactly_balanced

LAW = Ring(kA=5.0, kP=0.0, tension=1.0)


@pytest.fixture(scope="module", autouse=True)
def exact_states() -> Iterator[None]:
    """States that are read back agree with the former ones to rounding."""
    with exactly_balanced():
        yield


@pytest.fixture(scope="module")
def start() -> Packing:
    radii = np.random.default_rng(1).uniform(0.4, 0.6, 20)
    return deformable.push_off(deformable.polydisperse(20, radii, phi=0.9))


def test_growth_and_death(start: Packing, tmp_path: Path) -> None:
    """Each frame has the radii and the particles of its own, not those of the last one."""
    with deformable.Simulation(start, LAW) as sim:
        states = [sim.state()]
        for _ in range(2):
            packing = states[-1].packing
            radius = 1.02 * packing.radius[:-3]
            sim.restart(
                replace(
                    packing,
                    positions=packing.positions[:-3],
                    species=packing.species[:-3],
                    radii=[radius.max()],
                    particle_radii=radius,
                )
            )
            states.append(sim.state())
    list(deformable.record(states, tmp_path))
    again = list(deformable.replay(tmp_path))
    assert [len(state.packing) for state in again] == [20, 17, 14]
    for found, state in zip(again, states, strict=True):
        assert np.array_equal(found.packing.radius, state.packing.radius)
        assert found.energy == pytest.approx(state.energy, rel=1e-10)
        assert found.area == pytest.approx(state.area, rel=1e-10)
    with pytest.raises(FileError, match="14 to 20 particles"):
        deformable.universe(tmp_path)


def test_other_species(tmp_path: Path) -> None:
    """As after `fix atom/swap`: a small particle takes the place of a large one."""
    packing = deformable.push_off(deformable.bidisperse(16, phi=0.8, seed=2))
    swapped = replace(packing, species=packing.species[::-1])
    states = []
    for each in (packing, swapped):
        with deformable.Simulation(each, Ring(kA=[1.0, 2.0])) as sim:
            states.append(sim.state())
    list(deformable.record(states, tmp_path))
    for found, state in zip(deformable.replay(tmp_path), states, strict=True):
        assert np.array_equal(found.packing.species, state.packing.species)
        assert found.energy == pytest.approx(state.energy, rel=1e-10)
