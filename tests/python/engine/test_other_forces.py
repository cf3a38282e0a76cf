"""Relaxations with forces that a user's fixes add."""

import lammps_deformable as ld
import pytest

GRAVITY = 1e-3


@pytest.fixture(scope="module")
def start() -> ld.Packing:
    """Loose in a box with walls: no contact bears a force."""
    walls = ld.BoxWall((10, 12)).parts
    return ld.bidisperse(30, seed=1).between(walls).push_off()


def test_a_heap_under_its_weight(start: ld.Packing) -> None:
    """Particles that touch nothing fall; the floor bears all of them in the end."""
    with ld.Simulation(start, ld.Ring(kA=10.0, kP=0.0, tension=0.05)) as sim:
        assert sim.relax().residual == 0.0
        sim.lmp.command(f"fix down all addforce 0 {-GRAVITY} 0")
        heap = sim.relax()
    assert heap.converged
    assert 0.0 < heap.residual <= 1e-6
    weight = len(start) * GRAVITY
    error = 1e-6 * heap.contacts["force"].mean() * len(start)
    assert heap.wall_forces.sum(axis=0) == pytest.approx([0.0, -weight], abs=error)
    fallen = start.positions[:, 1].mean() - heap.packing.positions[:, 1].mean()
    assert fallen > 1.0


def test_free_fall_has_no_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("lammps_deformable.engine.engines.Deformables.patience", 3000)
    loose = ld.bidisperse(8, phi=0.4, seed=1).push_off()
    with ld.Simulation(loose, ld.Ring()) as sim:
        sim.lmp.command(f"fix down all addforce 0 {-GRAVITY} 0")
        with pytest.warns(ld.StalledWarning):
            state = sim.relax()
    assert state.residual == pytest.approx(1.0)


def test_forces_of_motion_are_refused(start: ld.Packing) -> None:
    """Minimizers of LAMMPS pass over them: the state would not be at rest under them."""
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.lmp.command("fix mine all gravity 1e-3 vector 0 -1 0")
        with pytest.raises(ld.LammpsError, match="balance with fix mine, which acts in"):
            sim.relax()
        sim.lmp.command("unfix mine")
        assert sim.relax().residual == 0.0


def test_fixes_without_forces_change_nothing() -> None:
    """Contacts that hardly overlap bear next to nothing: the packing is loose, with any output."""
    packing = ld.Packing([[2, 2], [3 - 1e-9, 2]], 0.5, [[9, 0], [0, 9]])
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.lmp.command("compute t all temp")
        sim.lmp.command("fix out all ave/time 1 1 1 c_t")
        state = sim.relax()
    assert (state.residual, (not state.converged)) == (0.0, False)
