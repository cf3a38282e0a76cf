"""Soft spheres: jamming, protocols, and states that lack what is for the plane."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.state.recorded import numbers_of, particle_values

from validation.finite_strain import bulk_modulus, shear_modulus

networkx = pytest.importorskip("networkx")


@pytest.fixture(scope="module")
def jammed() -> ld.Packing:
    return ld.jam(ld.bidisperse(64, sizes=(0.5, 0.6), dimension=3, seed=1), tolerance=1e-6).packing


@pytest.fixture(scope="module")
def squeezed(jammed: ld.Packing) -> ld.State:
    with ld.Simulation(jammed, ld.SoftContact()) as spheres:
        last = spheres.compress(phi=jammed.phi + 0.03, steps=2)[-1]
    return last


def test_random_close_packing_is_isostatic(jammed: ld.Packing) -> None:
    """3 N' - 2 contacts. 64 spheres jam between 0.58 and 0.67, most near 0.63."""
    with ld.Simulation(jammed, ld.SoftContact()) as spheres:
        state = spheres.relax(1e-8)
    held = int(np.sum(~state.rattlers))
    assert 0.58 < jammed.phi < 0.67
    assert state.pressure == pytest.approx(1.4e-6 / (2.0 * jammed.radii.mean()), rel=1e-2)
    assert state.network_contacts == state.isostatic_contacts == 3 * held - 2
    assert state.coordination == pytest.approx(6.0 - 4.0 / held)
    assert state.network_degree[~state.rattlers].min() >= 4


@pytest.mark.slow
def test_512_spheres_jam_at_random_close_packing() -> None:
    """O'Hern et al., Phys. Rev. E 68, 011306 (2003): 0.639 for large packings.

    One of 512 scatters by some 0.003.
    """
    starts = [ld.bidisperse(512, sizes=(0.5, 0.6), dimension=3, seed=seed) for seed in range(4)]
    phi = np.mean([ld.jam(start).packing.phi for start in starts])
    assert phi == pytest.approx(0.639, abs=0.01)


def test_states_have_stress_contacts_and_motion(squeezed: ld.State) -> None:
    volumes = squeezed.volumes[:, None, None]
    total = np.sum(squeezed.particle_stress * volumes, axis=0) / squeezed.packing.volume
    assert total == pytest.approx(squeezed.pressure_tensor, abs=1e-12 * squeezed.pressure)
    assert squeezed.pressure_tensor == pytest.approx(squeezed.pressure_tensor.T)
    assert squeezed.pressure == pytest.approx(np.trace(squeezed.pressure_tensor) / 3.0)
    assert squeezed.pressures.min() >= 0.0
    graph = squeezed.graph()
    assert graph.number_of_edges() == len(squeezed.contacts) // 2
    energy = sum(edge["force"] ** 2 / 2.0 for *_, edge in graph.edges(data=True))
    assert energy == pytest.approx(squeezed.energy, rel=1e-12)
    assert {"x", "y", "z"} <= set(graph.nodes[0])
    assert numbers_of(squeezed)["lz"] == squeezed.packing.box[2, 2]
    for values in particle_values(squeezed).values():
        assert values.shape == (64,)


def test_pressure_is_the_derivative_of_the_energy(squeezed: ld.State) -> None:
    """All six components, by strains of the box that the centers follow."""
    step, found = 1e-5, np.zeros((3, 3))
    for a, b in ((0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)):
        energies = []
        for sign in (1.0, -1.0):
            strain = np.eye(3)
            strain[a, b] += sign * step
            with ld.Simulation(squeezed.packing, ld.SoftContact()) as spheres:
                spheres.deform(squeezed.packing.box @ strain)
                energies.append(spheres.state().energy)
        found[a, b] = found[b, a] = -(energies[0] - energies[1]) / (2.0 * step)
    expected = squeezed.pressure_tensor * squeezed.packing.volume
    assert found == pytest.approx(expected, abs=1e-4 * expected[0, 0])


def test_shear_and_moduli(squeezed: ld.State) -> None:
    """Shear by small steps follows the shear modulus; the mean of both directions is that of G."""
    shear = shear_modulus(squeezed, 1e-5)
    bulk = bulk_modulus(squeezed, 1e-5)
    assert shear.linear
    assert bulk.linear
    assert 0.0 < shear.value < bulk.value
    with ld.Simulation(squeezed.packing, ld.SoftContact()) as spheres:
        start = spheres.relax(1e-8)
        last = spheres.shear(1e-5, tolerance=1e-8)[-1]
    slope = (last.shear_stress - start.shear_stress) / 1e-5
    assert slope == pytest.approx(shear.value, rel=0.02)
    moved = last.displacements(start)
    assert moved.shape == (64, 3)
    assert last.nonaffine(start) == pytest.approx(
        moved - np.outer(start.packing.positions[:, 1], [1e-5, 0.0, 0.0]), abs=1e-12
    )
    assert ld.Run([start, last]).unwrapped()[1] - start.packing.positions == pytest.approx(moved)


def test_nothing_of_the_plane_is_in_a_state(squeezed: ld.State) -> None:
    """So nothing can take x and y of the centers and leave out z."""
    for name in ("outlines", "hexatic", "area_deficit", "perimeters", "resolve_secondary"):
        assert not hasattr(squeezed, name)
        with pytest.raises(ld.UndefinedError, match=f"^{name} is "):
            getattr(squeezed, name)
    with pytest.raises(AttributeError, match=r"in the plane, and .* dimensions: take steinhardt"):
        squeezed.hexatic()
    with pytest.raises(AttributeError, match="no attribute 'hexagonal'"):
        squeezed.hexagonal  # noqa: B018
    with pytest.raises(ld.ParameterError, match="pure=True is for packings in the plane"):
        shear_modulus(squeezed, 1e-3, pure=True)


def test_a_box_of_another_dimension(squeezed: ld.State) -> None:
    with ld.Simulation(squeezed.packing, ld.SoftContact()) as spheres:
        with pytest.raises(ld.ParameterError, match="box must have 3 sides, not 2"):
            spheres.deform(np.eye(2))
        with pytest.raises(ld.ParameterError, match="without a rate only"):
            spheres.shear(0.01, rate=1.0, drag=1.0, steps=10)
    with pytest.raises(ld.ParameterError, match="before has 2 dimensions"):
        squeezed.displacements(ld.bidisperse(64, seed=1))


def test_centers_at_one_place_come_apart() -> None:
    """Also a whole packing: no plane holds its spheres."""
    heap = ld.Packing(np.zeros((20, 3)), 0.5, (3.0, 3.0, 3.0))
    apart = heap.push_off()
    with ld.Simulation(apart, ld.SoftContact()) as spheres:
        assert spheres.state().pressure < 1e-2
    assert np.ptp(apart.positions, axis=0).min() > 1.0


@pytest.mark.parametrize("lattice", ["fcc", "sc"])
def test_crystals_by_formula(lattice: str) -> None:
    """p = z N o d/(6 V), K = V d^2E/dV^2 of z N/2 springs."""
    contacts, over = {"fcc": 12, "bcc": 8, "sc": 6}[lattice], 0.02
    touching = ld.crystal(lattice, 2)
    crystal = touching.at(touching.phi / (1.0 - over) ** 3)
    with ld.Simulation(crystal, ld.SoftContact()) as spheres:
        state = spheres.state()
    per_volume = contacts * len(crystal) / (6.0 * crystal.volume)
    assert state.pressure == pytest.approx(per_volume * over * (1.0 - over), rel=1e-9)
    assert state.coordination == contacts
    bulk = per_volume * (1.0 - over) / 3.0 * ((1.0 - over) + 2.0 * over)
    found = bulk_modulus(state, 1e-5)
    assert found.value == pytest.approx(bulk, rel=1e-4)
