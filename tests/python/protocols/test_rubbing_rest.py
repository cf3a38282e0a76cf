"""Rest, compression and shear of particles whose contacts rub, by damped motion."""

from contextlib import nullcontext
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.particles.laws import LAWS
from protocol_helpers import Stop, stop_after

ROUGH = ld.Friction(0.3, kt=0.05)


def pressed(friction: ld.Friction | None, **options: object) -> ld.Simulation:
    packing = ld.bidisperse(16, phi=0.9, seed=2).push_off()
    return ld.Simulation(packing, ld.Ring(), friction=friction, **options)


@pytest.mark.parametrize("contact", ["curved", "radical"])
def test_a_sheared_crystal(contact: str) -> None:
    """Springs add (sqrt(3)/4) kt to the shear modulus of a triangular lattice that does not slip.

    Particles turn with the mean rotation; a contact along n at the distance d is then sheared by
    d t.(strain).n. Radical lines have two springs of kt/2.
    """
    crystal, strain, kt, stress = ld.crystal("hex", (4, 2), phi=0.95), 1e-4, 1e-3, []
    for friction in (None, ld.Friction(np.inf, kt=kt)):
        with ld.Simulation(crystal, LAWS[contact], friction=friction) as sim:
            sim.relax(1e-9)
            state = sim.shear(strain, tolerance=1e-7)[-1]
            stress.append(state.shear_stress)
    assert stress[1] - stress[0] == pytest.approx(np.sqrt(3) / 4 * kt * strain, rel=2e-3)
    d = np.sqrt(crystal.box[0, 0] * crystal.box[1, 1] / 16 * 2 / np.sqrt(3))
    longest = np.abs(state.contacts["spring"]).max()
    # 2 theta of the directions: one contact lies along the shear
    assert longest == pytest.approx(d * strain / 2, rel=2e-2)


def test_rest_compression_and_shear() -> None:
    """Forces and torques balance; bounds hold; stress depends on the way."""
    with pressed(ROUGH) as sim:
        start = sim.relax()
        states = [start, *sim.compress(strain=0.01, steps=2)[1:]]
        states += sim.shear(0.04, steps=2)[1:]
        back = sim.shear(-0.04, steps=2)[1:][-1]
    for state in states:
        table = state.contacts
        assert state.converged
        assert state.residual <= 1e-6
        bound = 0.3 * np.maximum(table["force"], 0.0)
        assert (np.abs(table["friction"]) <= bound * (1 + 1e-9)).all()
        sums, torques = np.zeros((16, 2)), np.zeros(16)
        np.add.at(sums, table["i"], table["force_vector"])
        scale = table["force"].mean()
        assert np.abs(sums).max() < 2e-6 * scale
        assert not state.velocities.any()
        assert not state.spins.any()
        out = np.column_stack([np.cos(table["angle"]), np.sin(table["angle"])])
        lever = np.sum((table["position"] - state.packing.positions[table["i"]]) * out, axis=1)
        np.add.at(torques, table["i"], lever * table["friction"])
        assert np.abs(torques).max() < 2e-6 * scale
    assert states[2].phi > start.phi
    assert max(np.abs(state.contacts["friction"]).max() for state in states) > 1e-5
    assert abs(back.shear_stress - states[2].shear_stress) > 1e-2 * states[2].pressure


def test_without_friction_a_shear_is_reversed() -> None:
    """The hysteresis above is that of friction: mu = 0 stays in a minimum and comes back to it."""
    with pressed(None) as sim:
        minimal = sim.relax()
    with ld.Simulation(minimal.packing, minimal.law, friction=ld.Friction(0.0, kt=2e-3)) as sim:
        sim.shear(0.002)
        back = sim.shear(-0.002)[-1]
    assert back.energy == pytest.approx(minimal.energy, rel=1e-6)


def test_a_target_phi() -> None:
    with pressed(ROUGH) as sim:
        state = sim.compress(phi=0.91)[-1]
        assert state.phi == pytest.approx(0.91, rel=1e-9)
        with pytest.raises(ld.ParameterError, match=r"run\(steps, pressure=\)") as error:
            sim.compress(pressure=1e-3)
        assert "\n" not in str(error.value)


def test_weights_at_rest() -> None:
    """All forces act on the way to rest, those of motion too: walls bear the weight."""
    two = ld.Packing([[1.0, 0.5], [1.6, 1.2]], 0.5, [3.0, 3.0], walls=ld.BoxWall((3, 3)))
    with ld.Simulation(two, ld.Ring(), friction=ld.Friction(9, kt=0.01)) as sim:
        sim.lmp.command("fix down all gravity 1e-4 vector 0 -1 0")
        state = sim.relax(1e-4)
    assert state.wall_forces.sum(axis=0) == pytest.approx([0, -2e-4], abs=1e-7)
    assert state.wall_forces[2:].sum(axis=0)[1] == pytest.approx(-2e-4, rel=1e-2)


def test_a_run_is_resumed(tmp_path: Path) -> None:
    """Interrupted after a step, it ends in the same digits; springs go on."""
    whole, torn = tmp_path / "whole", tmp_path / "torn"
    for folder in (whole, torn):
        with pressed(ROUGH) as sim:
            stop = stop_after(1) if folder is torn else None
            with pytest.raises(Stop) if stop else nullcontext():
                sim.shear(0.03, record=folder, steps=3, tolerance=1e-4, callback=stop)
    end = ld.Run(torn).resume()[-1]
    assert (end.contacts["spring"] != 0).any()
    for name in ("packing.data", "setups.jsonl", "trajectory.lammpstrj", "series.csv"):
        assert (whole / name).read_bytes() == (torn / name).read_bytes(), name


def test_what_has_no_energy() -> None:
    with pressed(ROUGH) as sim:
        state = sim.relax(1e-3)
        for of_energy in (state.hessian, state.modes, state.moduli):
            with pytest.raises(ld.ParameterError, match=r"\Afriction has no energy"):
                of_energy()
        with pytest.raises(ld.ParameterError, match=r"\A[^\n]*whose callback relaxes"):
            sim.run(100, temperature=1e-6, callback=lambda _: sim.relax())
