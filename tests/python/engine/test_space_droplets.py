"""Droplets in three dimensions: known answers, states, protocols, and what is refused."""

import inspect
import warnings
from collections.abc import Callable

import lammps_deformable as ld
import numpy as np
import pytest
from droplet_formula import crystal as crystal_of
from lammps_deformable import Droplet, Packing, Simulation, State
from lammps_deformable.engine import engines
from lammps_deformable.state.recorded import numbers_of, particle_values
from numpy.typing import NDArray
from polyhedra import FACES
from refusals import refused

from validation.finite_strain import shear_modulus

CONTACTS = {"fcc": 12, "bcc": 8, "sc": 6}


@pytest.fixture(scope="module")
def jammed() -> Packing:
    start = ld.bidisperse(32, sizes=(1.0, 1.2), dimension=3, seed=1)
    return ld.jam(start, tolerance=1e-2).packing


@pytest.fixture(scope="module")
def emulsion(jammed: Packing) -> State:
    """Of two tensions."""
    with ld.Simulation(jammed.at(0.72), Droplet([1.0, 1.5])) as sim:
        assert isinstance(sim, Simulation)
        return sim.relax(1e-8)


def at_indentation(lattice: str, a: float) -> Packing:
    """A crystal of droplets of radius 1 with this indentation."""
    touching = ld.crystal(lattice, 2, radius=1.0)
    return touching.at(touching.phi / (1.0 - a) ** 3)


@pytest.mark.parametrize(("lattice", "a"), [("fcc", 0.03), ("bcc", 0.03), ("sc", 0.05)])
def test_equal_contacts(lattice: str, a: float) -> None:
    """Forces and energies of the formula; f is balanced to 1e-8."""
    energy, forces = crystal_of(2.0 * (1.0 - a) * FACES[lattice])
    force = forces.mean()
    with ld.Simulation(at_indentation(lattice, a), Droplet(2.0)) as sim:
        state = sim.state()
    z, number = CONTACTS[lattice], len(state.packing)
    assert (state.n_contacts == z).all()
    assert state.contacts["force"] == pytest.approx(2.0 * force, rel=1e-7)
    assert state.contacts["indentation"] == pytest.approx(a, rel=1e-7)
    assert state.contacts["facet_radius"] == pytest.approx(np.sqrt(force / (2.0 * np.pi)))
    assert state.loads == pytest.approx(z * force / (8.0 * np.pi), rel=1e-7)
    pressure = z * number * 2.0 * force * (1.0 - a) / (3.0 * state.packing.volume)
    assert state.pressure == pytest.approx(pressure, rel=1e-7)
    assert state.energy / number == pytest.approx(2.0 * energy, rel=1e-6)


@pytest.mark.parametrize(
    ("lattice", "shear", "stretch"),
    [("fcc", 0.28696, 0.49403), ("sc", None, 0.63313)],
)
def test_moduli_of_crystals(lattice: str, shear: float | None, stretch: float | None) -> None:
    """At 0.01 above their close packing [tension/radius]; tests/lammps/test_droplet_crystals.py has
    them from the formula.

    Sites of cubic crystals have a center of symmetry, so that they stay at rest under any strain.
    """
    touching = ld.crystal(lattice, 2, radius=1.0)
    crystal, small = touching.at(touching.phi + 0.01), 1e-4

    def slope(strained: Callable[[float], NDArray[np.float64]]) -> NDArray[np.float64]:
        stresses = []
        for sign in (1.0, -1.0):
            with ld.Simulation(crystal, Droplet()) as sim:
                sim.deform(crystal.box @ strained(sign * small))
                state = sim.state()
            assert state.residual < 1e-6
            stresses.append(state.pressure_tensor)
        return (stresses[0] - stresses[1]) / (2.0 * small)

    if shear is not None:
        change = slope(lambda g: np.array([[1.0, 0.0, 0.0], [g, 1.0, 0.0], [0.0, 0.0, 1.0]]))
        assert -change[0, 1] == pytest.approx(shear, abs=2e-5)
    if stretch is not None:
        change = slope(lambda e: np.diag([(1.0 + e) ** -0.5, (1.0 + e) ** -0.5, 1.0 + e]))
        assert change[0, 0] - change[2, 2] == pytest.approx(stretch, abs=2e-5)


def test_a_state_at_rest(emulsion: State) -> None:
    """Balanced forces, stress from contacts and from droplets, and facets on both sides."""
    table, packing = emulsion.contacts, emulsion.packing
    assert emulsion.converged
    assert emulsion.residual <= 1e-8
    assert emulsion.phi == packing.phi == pytest.approx(0.72)
    total = np.zeros((32, 3))
    np.add.at(total, table["i"], table["force_vector"])
    assert total == pytest.approx(np.zeros((32, 3)), abs=1e-7 * table["force"].mean())
    volumes = emulsion.volumes[:, None, None]
    stress = np.sum(emulsion.particle_stress * volumes, axis=0) / packing.volume
    assert stress == pytest.approx(emulsion.pressure_tensor, abs=1e-10)
    # pressure = sum F d/(3 V) over pairs
    lever = np.sum(table["force"] * table["distance"]) / 2.0
    assert emulsion.pressure == pytest.approx(lever / (3.0 * packing.volume), rel=1e-9)
    assert np.linalg.norm(table["normal"], axis=1) == pytest.approx(1.0)
    shift = table["image"] @ packing.box
    apart = packing.positions[table["j"]] + shift - packing.positions[table["i"]]
    assert apart == pytest.approx(table["distance"][:, None] * table["normal"], abs=1e-9)
    # facets of both sides are at one place, since the normal is the line of centers
    height = packing.radii[table["i"]] - table["indentation"]
    middle = packing.positions[table["i"]] + height[:, None] * table["normal"]
    assert table["position"] == pytest.approx(middle, abs=1e-9)
    key = {(r["i"], r["j"], *r["image"]): r for r in table}
    for row in table:
        other = key[(row["j"], row["i"], *-row["image"])]
        assert other["force"] == row["force"]
        assert row["indentation"] + other["indentation"] == pytest.approx(
            packing.radii[row["i"]] + packing.radii[row["j"]] - row["distance"], abs=1e-7
        )
    tension = np.array([1.0, 1.5])[packing.species]
    force = np.bincount(table["i"], table["force"], minlength=32)
    assert emulsion.loads == pytest.approx(force / (tension * packing.radii) / (8.0 * np.pi))
    facets = np.bincount(table["i"], np.pi * table["facet_radius"] ** 2, minlength=32)
    assert emulsion.contact_areas == pytest.approx(facets)
    grown = emulsion.surface_areas - 4.0 * np.pi * packing.radii**2
    assert np.sum(tension * grown) == pytest.approx(emulsion.energy, rel=1e-6)
    assert (emulsion.pressures > 2.0 * tension / packing.radii).all()
    assert emulsion.graph().number_of_edges() == len(table) // 2
    assert {"load", "lz"} <= set(numbers_of(emulsion))
    assert all(values.shape == (32,) for values in particle_values(emulsion).values())


def test_stress_is_the_derivative_of_the_energy(emulsion: State) -> None:
    """All six components, by strains that all centers follow."""
    step, found = 1e-4, np.zeros((3, 3))
    with ld.Simulation(emulsion.packing, emulsion.law) as sim:
        for a, b in ((0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1)):
            energies = []
            for sign in (1.0, -1.0):
                strain = np.eye(3)
                strain[a, b] += sign * step
                sim.reset(emulsion.packing)
                sim.deform(emulsion.packing.box @ strain)
                energies.append(sim.state().energy)
            found[a, b] = found[b, a] = -(energies[0] - energies[1]) / (2.0 * step)
    expected = emulsion.pressure_tensor * emulsion.packing.volume
    assert found == pytest.approx(expected, abs=1e-4 * expected[0, 0])


def test_droplets_jam_where_spheres_do() -> None:
    """They touch at the same phi, and are isostatic there. Minimizers may lead them elsewhere."""
    start = ld.bidisperse(32, sizes=(1.0, 1.2), dimension=3, seed=2)
    jammed = ld.jam(start, tolerance=1e-2).packing
    with ld.Simulation(ld.jam(start, Droplet()).packing, Droplet()) as sim:
        onset = sim.relax(1e-6)
    assert 1e-6 < onset.pressure * onset.packing.radii.mean() <= 2.1e-6
    assert onset.phi == pytest.approx(jammed.phi, abs=3e-4)
    held = int(np.sum(~onset.rattlers))
    # weak contacts across gaps, as droplets bulge, may be more than isostatic
    assert 0 <= onset.network_contacts - (3 * held - 2) <= 3


def test_compression_and_shear(jammed: Packing) -> None:
    with ld.Simulation(jammed.at(jammed.phi + 0.02), Droplet()) as sim:
        first, last = sim.compress(phi=0.7, steps=2)[1:]
        assert last.phi == pytest.approx(0.7, rel=1e-9)
        assert 0.0 < first.pressure < last.pressure
        pressed = sim.compress(pressure=0.05)[-1]
        assert pressed.pressure == pytest.approx(0.05, rel=1e-6)
        again = sim.relax(pressure=0.04)
        assert again.pressure == pytest.approx(0.04, rel=1e-6)
        small, *_ = sim.shear(2e-4, steps=2, tolerance=1e-8)[1:]
        modulus = shear_modulus(again, 1e-4).value
        change = small.shear_stress - again.shear_stress
        assert change == pytest.approx(1e-4 * modulus, rel=0.03)
        assert small.shear_strain == 1e-4
        assert small.displacements(again).shape == (32, 3)
        sim.reset(small)
        assert sim.shear_strain == 1e-4
        assert sim.state().energy == pytest.approx(small.energy, rel=1e-8)


def test_beyond_the_model_is_told(jammed: Packing) -> None:
    crystal = at_indentation("fcc", 0.07)
    with (
        ld.Simulation(crystal, Droplet()) as sim,
        pytest.warns(ld.BeyondModelWarning, match="32 of 32 droplets .* load is above 0.4"),
    ):
        state = sim.relax()
    assert state.beyond == 32
    with ld.Simulation(jammed.at(0.5), Droplet()) as sim, warnings.catch_warnings():
        warnings.simplefilter("error")
        loose = sim.relax()
    assert (loose.energy, loose.pressure, len(loose.contacts)) == (0.0, 0.0, 0)
    assert loose.pressures == pytest.approx(2.0 / loose.packing.radii)


def test_no_number_is_lost_far_beyond_the_model(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where LAMMPS tells one that is none, there is no state."""
    lost = np.zeros((8, 5))
    lost[3, 4] = np.nan
    with ld.Simulation(SPHERES, Droplet()) as sim:
        monkeypatch.setattr(engines, "evaluate", lambda *_: (lost, lost))
        with pytest.raises(ld.LammpsError, match=r"load of droplet 3 is no number .* less"):
            sim.state()


def test_nothing_of_the_plane_is_in_a_state(emulsion: State) -> None:
    for name in {*dir(State), *inspect.get_annotations(State)}:
        if name.startswith("_") or hasattr(type(emulsion), name) or name in vars(emulsion):
            continue
        with pytest.raises(AttributeError, match=f"^{name} is for packings in the plane, and"):
            getattr(emulsion, name)


SPHERES = ld.bidisperse(8, dimension=3, seed=1)


def test_refusals() -> None:
    for make, told in (
        (lambda: ld.Simulation(ld.bidisperse(4, seed=1), Droplet()), r"two: .* Ring\(kA="),
        (lambda: ld.jam(ld.bidisperse(4, seed=1), Droplet()).packing, "Droplet is for three dim"),
        (lambda: ld.Simulation(SPHERES, Droplet([1])), "there are 2 species"),
        (lambda: Droplet(0.0), "tension must be positive, .* not 0.0"),
        (lambda: Droplet("soft"), "tension must be a number, or one number for each species"),
        (
            lambda: ld.Simulation(SPHERES, Droplet()).compress(phi=1.1, steps=10)[1:],
            "phi must be below 1",
        ),
    ):
        with refused(told):
            make()


def test_law_shows_its_call() -> None:
    assert repr(Droplet()) == "Droplet()"
    assert repr(Droplet([1, 2])) == "Droplet(tension=(1.0, 2.0))"
    with ld.Simulation(SPHERES, Droplet()) as sim:
        assert repr(sim).startswith("<Simulation: 8 particles, law Droplet(), box ")
        assert repr(sim.state()).startswith("<State: 8 particles, law Droplet(), phi = 0.3")
    assert repr(sim) == "<Simulation: closed>"
