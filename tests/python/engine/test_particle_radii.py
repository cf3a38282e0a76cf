"""Particles with radii of their own, from the onset of jamming to the files."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import core
from lammps_deformable.particles.packing import with_own_radii
from scipy import stats

RADICAL = ld.Ring(kA=2.0, contact="radical")


@pytest.fixture(scope="module")
def start() -> ld.Packing:
    return ld.polydisperse(24, lambda rng, n: rng.lognormal(-0.7, 0.15, 24), tilt=0.3, seed=4)


@pytest.fixture(scope="module")
def jammed(start: ld.Packing) -> ld.Packing:
    return ld.jam(start).packing


@pytest.fixture(scope="module")
def state(jammed: ld.Packing) -> ld.State:
    with ld.Simulation(jammed, RADICAL) as sim:
        (last,) = sim.compress(strain=0.01)[1:]
    return last


def test_two_sizes_are_two_species() -> None:
    """Energy, stress, shapes and contacts of the same packing, defined in both ways."""
    two = ld.jam(ld.bidisperse(24, seed=2)).packing
    two = two.at(1.02 * two.phi)
    many = with_own_radii(two)
    for law in (RADICAL, ld.Ring(kP=5.0, skin=0.02), ld.Sector()):
        states = []
        for packing in (two, many):
            with ld.Simulation(packing, law) as sim:
                states.append(sim.state())
        expected, found = states
        assert found.energy == expected.energy
        assert np.array_equal(found.pressure_tensor, expected.pressure_tensor)
        assert np.array_equal(found.contacts, expected.contacts)
        for name in ("volumes", "area_deficit", "perimeters", "arc_radii", "pressures"):
            assert np.array_equal(getattr(found, name), getattr(expected, name)), name


def test_particles_may_grow_up_to_their_species(state: ld.State) -> None:
    """LAMMPS commands may change radii; states have the new ones."""
    with ld.Simulation(state.packing, RADICAL) as sim:
        assert sim.state().energy == pytest.approx(state.energy, rel=1e-9)
        sim.lmp.command("set atom 3 diameter 0.4")
        assert sim.state().packing.radii[2] == 0.2
        sim.lmp.command(f"set atom 3 diameter {2.5 * float(state.packing.radii.max())}")
        with pytest.raises(ld.LammpsError, match=r"Atom 3 has a radius of .* at most"):
            sim.state()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("width", "seed", "contact"), [(0.1, 1, "radical"), (0.5, 2, "balanced"), (0.5, 1, "radical")]
)
def test_wide_distributions_reach_the_tolerance(width: float, seed: int, contact: str) -> None:
    """Radii up to 12 times as large as others."""
    start = ld.polydisperse(64, stats.lognorm(width, scale=0.5), seed=seed)
    with ld.Simulation(ld.jam(start).packing, ld.Ring(contact=contact)) as sim:
        for state in sim.compress(strain=0.02, steps=2)[1:]:
            assert state.converged
            assert state.residual <= 1e-6
            assert state.energy > 0.0


@pytest.mark.parametrize("law", [RADICAL, ld.Sector()])
def test_saved_state_goes_on_as_it_was(
    state: ld.State, law: ld.Ring | ld.Sector, tmp_path: Path
) -> None:
    with ld.Simulation(state.packing, law) as sim:
        sim.state().save(tmp_path)
        expected = sim.state()
    with ld.Run(tmp_path).simulation() as sim:
        again = sim.state()
        masses = np.array(sim.lmp.gather("rmass", 1, 1))
    assert np.array_equal(again.packing.radii, state.packing.radii)
    assert again.energy == pytest.approx(expected.energy, rel=1e-12)
    assert masses == pytest.approx(np.ones(24))


def test_rings_of_beads_refuse_particle_radii(jammed: ld.Packing) -> None:
    with pytest.raises(ld.ParameterError, match="a species of its own"):
        ld.Simulation(jammed, ld.DeformablePolygon(50, smooth=False))


def test_outline_is_of_the_radius_of_its_own(state: ld.State) -> None:
    """Not of that of its species."""
    n = int(state.packing.radii.argmin())
    seen = state._contacts_of_each[n]
    expected = core.outline(
        "ring", state.packing.radii[n], seen["angle"], seen["indentation"], same_area=True
    )
    assert np.array_equal(state.outlines[n], state.packing.positions[n] + expected)
