"""Droplets that rub in space, and films: states, energies, and motion that goes on."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

ROUGH = ld.Friction(
    [[0.5, 0.3], [0.3, 0.5]], kt=0.3, gt=0.05, damping=0.05, film=0.05, power=2 / 3,
    walls=ld.Friction(0.2, kt=0.3, film=0.1, power=0.5),
)  # fmt: skip
STEP = {"timestep": 0.03, "every": 100}


def begun(dimension: int, walls: bool = True) -> ld.Simulation:
    """In motion, with springs and films."""
    phi = 0.84 if dimension == 2 else 0.66
    packing = ld.bidisperse(16, seed=3, dimension=dimension).at(phi).push_off()
    if walls:
        room = (ld.BoxWall((5.5,) * dimension),)
        packing = ld.bidisperse(16, seed=3, dimension=dimension).between(room, seed=1).at(phi)
        packing = packing.push_off()
    law = ld.Ring(kA=np.inf, kP=0.0, tension=1.0) if dimension == 2 else ld.Droplet()
    sim = ld.Simulation(packing, law, friction=ROUGH)
    sim.run(100, temperature=1e-3, seed=1, **STEP)
    return sim


@pytest.mark.parametrize("dimension", [2, 3])
def test_motion_goes_on(dimension: int, tmp_path: Path) -> None:
    """From a state, a saved one and a recorded one as if it had never stopped, to rounding."""
    with begun(dimension) as sim:
        state = sim.run(100, **STEP, record=tmp_path / "run")[-1]
        end = sim.run(100, **STEP)[-1]
    assert (state.contacts["j"] < 0).any()
    assert np.abs(state.contacts["film_vector"]).max() > 1e-5
    assert state.spins.shape == (16,) if dimension == 2 else (16, 3)
    state.save(tmp_path / "saved")
    recorded = ld.Run(tmp_path / "run")[-1]
    assert recorded.lost_energy == state.lost_energy
    for again in (
        ld.Simulation(state, state.law),
        ld.Run(tmp_path / "saved").simulation(),
        ld.Run(tmp_path / "run").simulation(),
        ld.Simulation(recorded, state.law),
    ):
        with again:
            found = again.run(100, **STEP)[-1]
        x, v = end.packing.positions, end.velocities
        np.testing.assert_allclose(found.packing.positions, x, rtol=0, atol=1e-8)
        np.testing.assert_allclose(found.velocities, v, rtol=0, atol=1e-8)
        np.testing.assert_allclose(found.spins, end.spins, rtol=0, atol=1e-8)
        assert found.rubbing.lost == pytest.approx(end.rubbing.lost, rel=1e-6)


def test_states(tmp_path: Path) -> None:
    """Forces, stress, Coulomb's bound and energies of droplets."""
    with begun(3, walls=False) as sim:
        states = [sim.state(), *sim.run(200, **STEP)[1:]]
        state, force = sim.state(), np.reshape(sim.lmp.gather("f", 1, 3), (-1, 3))
    table, species = state.contacts, state.packing.species
    i, j, n = table["i"], table["j"], table["normal"]
    sums = np.zeros_like(force)
    np.add.at(sums, i, table["force_vector"])
    np.testing.assert_allclose(sums, force, rtol=0, atol=1e-12 * np.abs(force).max())
    mu = np.where(species[i] == species[j], 0.5, 0.3)
    friction = np.linalg.norm(table["friction"], axis=1)
    assert (friction <= mu * table["force"] * (1 + 1e-12)).all()
    for name in ("friction", "spring"):
        assert np.abs(np.sum(n * table[name], axis=1)).max() < 1e-14
    assert 0 < table["sliding"].sum() < len(table)
    # the forces of a contact on both of its sides are opposite
    for name in ("friction", "spring", "film_vector"):
        both = np.zeros_like(force)
        np.add.at(both, i, table[name])
        assert np.abs(both).max() > 1e-5
        assert np.abs(both.sum(axis=0)).max() < 1e-13
    assert state.spring_energy == pytest.approx(0.5 * 0.15 * np.sum(table["spring"] ** 2))
    total = np.einsum("n,nab->ab", state.volumes, state.particle_stress) / state.packing.volume
    np.testing.assert_allclose(total, state.pressure_tensor, rtol=0, atol=1e-6 * state.pressure)
    columns = state.to_pandas("contacts")
    for name in ("friction", "spring", "film_vector", "tilt"):
        found = columns[[f"{name}_{axis}" for axis in "xyz"]]
        np.testing.assert_array_equal(found, table[name])
    energies = [s.energy + s.kinetic_energy + s.spring_energy + s.lost_energy for s in states]
    assert state.rubbing.lost[3] > 1e-5
    assert energies == pytest.approx([energies[0]] * len(energies), rel=1e-3)


def test_rest_and_strain() -> None:
    """Damped motion brings droplets to rest; a spring follows a strain as its contact does."""
    smooth = ld.Friction(np.inf, kt=0.3)
    with begun(3, walls=False) as sim:
        packing, law = sim.state().packing, sim.law
    with ld.Simulation(packing, law, friction=smooth) as sim:
        rests = sim.relax(tolerance=1e-3)
        assert rests.residual <= 1e-3
        before = sim.state()
        strain = np.eye(3)
        strain[1, 0] = strain[2, 1] = 1e-5
        sim.deform(sim.box @ strain)
        after = sim.state()
    table, n = before.contacts, before.contacts["normal"]
    apart = table["distance"][:, None] * n
    way = apart @ (strain - np.eye(3))
    way -= np.sum(way * n, axis=1)[:, None] * n
    change = after.contacts["spring"] - table["spring"]
    # springs also turn with their contacts
    turning = 2e-5 * np.abs(table["spring"]).max()
    np.testing.assert_allclose(change, way, rtol=0, atol=turning + 1e-9)


def test_it_lasts(tmp_path: Path) -> None:
    """The file of an older version has three losses, and springs without films."""
    rough = ld.Friction(0.5, kt=0.3)
    packing = ld.bidisperse(16, seed=3).at(0.84).push_off()
    with ld.Simulation(packing, ld.Ring(), friction=rough) as sim:
        sim.run(100, temperature=1e-4, seed=1, every=100)[-1].save(tmp_path)
    file = tmp_path / "packing.data"
    text = file.read_text()
    (line,) = (each for each in text.splitlines() if each.startswith("# lost by friction"))
    file.write_text(text.replace(line, line.rsplit(maxsplit=1)[0]))
    with ld.Run(tmp_path).simulation() as sim:
        state = sim.state()
    assert state.rubbing.springs.shape[1] == 7
    assert state.rubbing.lost[3] == 0.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_another_friction(dimension: int) -> None:
    """Springs go on where films come or go."""
    with begun(dimension, walls=False) as sim:
        state = sim.state()
    dry = ld.Friction(0.5, kt=0.3)
    with ld.Simulation(state, state.law, friction=dry) as sim:
        found = sim.state()
        assert not found.contacts["film_vector"].any()
    np.testing.assert_allclose(found.contacts["spring"], state.contacts["spring"], atol=1e-12)
    with ld.Simulation(found, state.law, friction=ROUGH) as sim:
        again = sim.state()
    np.testing.assert_allclose(again.contacts["spring"], state.contacts["spring"], atol=1e-12)
