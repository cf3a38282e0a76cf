"""Rest at a pressure, with friction and without."""

import math

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused

DROPLETS = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)


def simulation(mu: float | None, number: int = 16, seed: int = 1) -> ld.Simulation:
    """A loose packing whose contacts rub and damp, or slip if there is no mu."""
    friction = None if mu is None else ld.Friction(mu, kt=1.0, gt=0.5, damping=1.0)
    loose = ld.bidisperse(number, phi=0.65, seed=seed).push_off()
    return ld.Simulation(loose, DROPLETS, friction=friction)


@pytest.mark.parametrize("mu", [0.3, math.inf])
def test_every_particle_is_in_balance(mu: float) -> None:
    """Forces and torques of the contacts of each add up to nothing, within Coulomb's bound."""
    with simulation(mu) as sim:
        state = sim.run(4_000_000, pressure=1e-3, inertial_number=0.02, tolerance=1e-5)[-1]
    packing, table = state.packing, state.contacts
    normal, along, i = table["force"], table["friction"], table["i"]
    tension = normal.mean()
    assert state.converged
    assert state.pressure == pytest.approx(1e-3, rel=1e-5)
    assert (np.abs(along) <= mu * normal * (1.0 + 1e-12)).all()
    assert (np.abs(along).max() > 0.01 * tension) == (mu > 0.0)
    lever = table["position"] - packing.positions[i]
    lever -= packing.box.diagonal() * np.rint(lever / packing.box.diagonal())
    torque = np.bincount(i, along * np.linalg.norm(lever, axis=1)) / packing.radii
    force = np.zeros_like(packing.positions)
    np.add.at(force, i, table["force_vector"])
    assert np.abs(force).max() < 2e-5 * tension
    assert np.abs(torque).max() < 2e-5 * tension


def in_space(mu: float | None, tilt: float = 0.0) -> ld.Simulation:
    friction = None if mu is None else ld.Friction(mu, kt=1.0, gt=0.5, damping=1.0)
    loose = ld.bidisperse(24, phi=0.45, dimension=3, seed=1, tilt=tilt).push_off()
    return ld.Simulation(loose, ld.Droplet(), friction=friction)


@pytest.mark.parametrize("mu", [None, 0.3, math.inf])
def test_droplets_in_space_come_to_rest(mu: float | None) -> None:
    """Forces and torques are balanced, at the pressure, in a box of the same shape."""
    with in_space(mu, tilt=0.3) as sim:
        before = sim.box
        state = sim.run(400_000, pressure=0.02, inertial_number=0.02, tolerance=1e-4)[-1]
        size = sim.box[0, 0] / before[0, 0]
        assert sim.box == pytest.approx(size * before, rel=1e-6)
        assert not {"deformable_xy", "deformable_rate"} & set(sim.lmp.available_ids("variable"))
        sim.state()  # without the drag
        torque = np.array(sim.lmp.gather("torque", 1, 3)) if mu else np.zeros(1)
        relaxed = None if mu else sim.relax(1e-8)
    table, tension = state.contacts, state.contacts["force"].mean()
    assert state.converged
    assert state.pressure == pytest.approx(0.02, rel=1e-4)
    assert size < 0.95
    force = np.zeros_like(state.packing.positions)
    np.add.at(force, table["i"], table["force_vector"])
    assert np.abs(force).max() < 1e-4 * tension
    assert np.abs(torque).max() < 1e-4 * tension
    if relaxed:
        assert relaxed.energy == pytest.approx(state.energy, rel=1e-5)
        return
    along = np.linalg.norm(table["friction"].reshape(len(table), -1), axis=1)
    assert (along <= (mu or 0.0) * table["force"] * (1.0 + 1e-12)).all()
    assert along.max() > 0.01 * tension


def test_friction_in_space_keeps_packings_loose() -> None:
    """Fewer contacts at a lower packing fraction, at the same small pressure."""
    found = []
    for mu in (None, math.inf):
        with in_space(mu) as sim:
            found.append(sim.run(400_000, pressure=5e-3, inertial_number=0.02)[-1])
    smooth, rough = found
    assert rough.phi < smooth.phi - 0.03
    assert rough.coordination < smooth.coordination - 0.5


def test_a_tilted_box_keeps_its_shape() -> None:
    loose = ld.bidisperse(16, phi=0.65, seed=1, tilt=0.3).push_off()
    with ld.Simulation(loose, ld.Ring()) as sim:
        before = sim.box
        state = sim.run(4_000_000, pressure=2e-3, inertial_number=0.02)[-1]
        assert sim.box == pytest.approx(sim.box[0, 0] / before[0, 0] * before, rel=1e-9)
    assert state.converged


def test_contacts_at_the_onset() -> None:
    """As many forces as keep N' particles in balance under a pressure; fewer with friction."""
    found = []
    for mu, forces in ((0.0, 1), (10.0, 2)):  # of a contact, and one equation more of a particle
        with simulation(mu, 32) as sim:
            state = sim.run(4_000_000, pressure=1e-3, inertial_number=0.01, timestep=0.08)[-1]
        table = state.contacts
        pairs = np.array([table["i"], table["j"]]).T[table["i"] < table["j"]]
        for _ in range(32):  # rattlers go
            degree = np.bincount(pairs.ravel(), minlength=32)
            pairs = pairs[(degree[pairs] >= 4 - forces).all(axis=1)]
        rigid = len(np.unique(pairs))
        assert np.sum(~state.rattlers) == rigid
        assert state.network_contacts == len(pairs)
        # less the motions of all together, and the pressure
        assert forces * len(pairs) >= (forces + 1) * rigid - 1
        assert state.isostatic_contacts == int(np.ceil(((forces + 1) * rigid - 1) / forces))
        assert state.excess_coordination() >= 0.0
        found.append(state.coordination)
    smooth, rough = found
    assert rough < smooth - 0.2  # of 1, more than five times the scatter of packings


def test_contacts_that_slip_are_at_an_energy_minimum() -> None:
    with simulation(None) as sim:
        state = sim.run(4_000_000, pressure=5e-3, inertial_number=0.02)[-1]
        relaxed = sim.relax(1e-8)
    assert state.converged
    assert relaxed.energy == pytest.approx(state.energy, rel=1e-4)
    assert relaxed.phi == pytest.approx(state.phi, abs=1e-6)


@pytest.mark.parametrize(
    ("law", "pressure"),
    [(ld.Ring(kA=3.0, kP=0.5), 1e-2), (ld.Ring(contact="radical"), 1e-2), (DROPLETS, 1e-3)],
)
def test_the_time_step_knows_the_pressure(law: ld.Ring, pressure: float) -> None:
    """Particles without contacts, of any stiffness: the way to rest at the pressure is stable."""
    loose = ld.bidisperse(32, phi=0.7, seed=1).push_off()
    with ld.Simulation(loose, law) as sim:
        assert not sim.state().n_contacts.any()
        state = sim.run(4_000_000, pressure=pressure, inertial_number=0.01)[-1]
        with pytest.raises(ld.ParameterError, match=r"timestep = 50 is too long [^\n]*"):
            sim.run(4_000_000, pressure=pressure, timestep=50.0)[-1]
        relaxed = sim.relax(1e-8)
    assert state.converged
    assert state.pressure == pytest.approx(pressure, rel=1e-4)
    assert relaxed.pressure == pytest.approx(pressure, rel=1e-2)
    with ld.Simulation(loose, law) as sim:
        with pytest.raises(
            ld.ParameterError, match=r"\Atimestep = 1000 is too long [^\n]* at most"
        ):
            sim.run(4_000_000, pressure=pressure, timestep=1e3)[-1]
        assert sim.time == 0.0


def test_it_goes_on_at_other_pressures() -> None:
    """Along the same packing: springs of the contacts stay."""
    with simulation(0.3) as sim:
        with pytest.warns(ld.StalledWarning, match=r"\A[^\n]*come to rest[^\n]*call again"):
            first = sim.run(10, pressure=1e-3, inertial_number=0.02)[-1]
        assert not first.converged
        states = [
            sim.run(4_000_000, pressure=pressure, inertial_number=0.02)[-1]
            for pressure in (1e-3, 4e-3, 1e-3)
        ]
        low, high, again = states
        assert low.phi < high.phi
        assert again.phi == pytest.approx(low.phi, abs=0.2 * (high.phi - low.phi))
        assert sim.time == again.time > high.time > low.time > first.time > 0.0
        assert "deformable_box" not in sim.lmp.available_ids("fix")


def test_refused() -> None:
    with simulation(0.3) as sim:
        for values, message in (
            ({"pressure": 0.0}, "pressure must be a positive number, not 0"),
            ({"tolerance": 0.0}, "tolerance must be a positive number, not 0"),
            ({"inertial_number": -1.0}, "inertial_number must be a positive number, not -1"),
            ({"timestep": 1.0}, r"timestep = 1 is too long .* at most 0\.13"),
        ):
            with refused(message):
                sim.run(**{"steps": 4_000_000, "pressure": 1e-3} | values)
            assert sim.time == 0.0


def test_what_cannot_settle() -> None:
    walled = ld.bidisperse(8, phi=0.5, seed=1).between(ld.BoxWall((4, 4)))
    with (
        ld.Simulation(walled.push_off(), DROPLETS) as sim,
        pytest.raises(ld.ParameterError, match=r"\A[^\n]*walls do not follow[^\n]*plane"),
    ):
        sim.run(4_000_000, pressure=1e-3)[-1]
    packing = ld.bidisperse(8, phi=0.5, seed=1).push_off()
    with (
        ld.Simulation(packing, ld.Sector()) as sim,
        pytest.raises(ld.ParameterError, match="Sector jumps"),
    ):
        sim.run(4_000_000, pressure=1e-3)[-1]
