"""Runs whose contacts rub: springs, spins and losses go on from states, files and records."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.particles.laws import LAWS

ROUGH = ld.Friction(
    [[0.4, 0.2], [0.2, np.inf]], kt=1e-2, gt=1e-3, damping=1e-3, walls=ld.Friction(0.2, kt=1e-2)
)
STEP = {"timestep": 0.05, "every": 100}


def begun(law: ld.Ring) -> ld.Simulation:
    """In motion between walls, with springs."""
    walls = (ld.BoxWall((5.5, 5)), ld.Sphere(0.6, (3, 3), inside=False))
    packing = ld.bidisperse(14, seed=3).between(walls, seed=1).at(0.84)
    sim = ld.Simulation(packing.push_off(), law, friction=ROUGH)
    sim.run(100, temperature=1e-4, seed=1, **STEP)
    return sim


# Contacts are balanced to 1e-8 from the forces before: what has none, begins from others.
BALANCE = {"curved": 1e-8, "radical": 1e-13}


def same(a: ld.State, b: ld.State, part: float) -> None:
    """All that goes on, to this part of its size."""
    assert a.friction == b.friction
    assert a.time == b.time
    for name in ("energy", "kinetic_energy", "spring_energy", "lost_energy", "pressure"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), rel=part)
    pairs = [(a.packing.positions, b.packing.positions), (a.velocities, b.velocities)]
    pairs += [(a.spins, b.spins), (a.contacts["friction"], b.contacts["friction"])]
    pairs += [(a.contacts["spring"], b.contacts["spring"])]
    for one, other in pairs:
        np.testing.assert_allclose(one, other, rtol=0, atol=part * np.abs(other).max())
    np.testing.assert_array_equal(a.contacts["sliding"], b.contacts["sliding"])


@pytest.mark.parametrize("contact", ["curved", "radical"])
def test_motion_goes_on(contact: str, tmp_path: Path) -> None:
    """From a state, a saved one and a recorded one as if it had never stopped, to rounding."""
    with begun(LAWS[contact]) as sim:
        _, before, state = sim.run(200, **STEP, record=tmp_path / "run")
        assert 0 < before.contacts["sliding"].sum() < len(before.contacts)
        end = sim.run(200, **STEP)[-1]
    state.save(tmp_path / "saved")
    run = ld.Run(tmp_path / "run")
    same(run[-1], state, BALANCE[contact])
    same(run[1], before, BALANCE[contact])
    for again in (
        ld.Simulation(state, LAWS[contact]),
        ld.Run(tmp_path / "saved").simulation(),
        ld.Run(tmp_path / "run").simulation(),
        ld.Simulation(run[-1], LAWS[contact]),
    ):
        with again:
            found = again.run(200, **STEP)[-1]
        # small differences grow in 200 steps: particles collide once or twice
        same(found, end, 1e3 * BALANCE[contact])


def test_without_springs_it_does_not_go_on(tmp_path: Path) -> None:
    """A packing alone has lost them: the comparison above can fail."""
    with begun(LAWS["balanced"]) as sim:
        state = sim.state()
        end = sim.run(200, **STEP)[-1]
    lost = state.rubbing._replace(springs=state.rubbing.springs[:0])
    forgetful = ld.State(**{**vars(state), "rubbing": lost})
    with ld.Simulation(forgetful, state.law) as sim:
        found = sim.run(200, **STEP)[-1]
    assert np.abs(found.packing.positions - end.packing.positions).max() > 1e-5


def test_a_packing_alone_slips() -> None:
    with begun(LAWS["balanced"]) as sim:
        state = sim.state()
    assert (state.rubbing.springs[:, 1] < 0).any()
    with ld.Simulation(state.packing, state.law) as sim:
        assert sim.state().rubbing is None


def test_lammps_takes_it_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the script that is saved, in a process of its own."""
    from lammps import lammps

    with begun(LAWS["balanced"]) as sim:
        state = sim.state()
        state.save(tmp_path)
        end = sim.run(200, **STEP)[-1]
    monkeypatch.chdir(tmp_path)
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.file("in.lammps")
    assert lmp.get_thermo("pe") == pytest.approx(state.energy, rel=1e-12)
    lmp.commands_string("fix move all nve/sphere disc\nfix plane all enforce2d\ntimestep 0.05")
    lmp.command("run 200")
    found = np.reshape(lmp.gather("x", 1, 3), (-1, 3))[:, :2]
    lost = sum(lmp.extract_fix("deformable_friction", 0, 1, n) for n in (1, 2, 3))
    lmp.close()
    np.testing.assert_allclose(found, end.packing.positions, rtol=0, atol=1e-5)
    assert lost == pytest.approx(end.lost_energy, rel=1e-5)


def test_damaged_springs(tmp_path: Path) -> None:
    with begun(LAWS["balanced"]) as sim:
        sim.state().save(tmp_path)
    file = tmp_path / "packing.data"
    file.write_text(file.read_text().replace("# spring 1", "# spring x 1", 1))
    with pytest.raises(ld.FileError, match=r"\A[^\n]*packing.data"):
        ld.Run(tmp_path).simulation()


def test_nothing_unsaved_is_told(recwarn: pytest.WarningsRecorder, tmp_path: Path) -> None:
    with begun(LAWS["balanced"]) as sim:
        sim.state().save(tmp_path / "one")
        assert not [w for w in recwarn if w.category is ld.UnsavedWarning]
        sim.lmp.command("fix rub all deformable/friction 0.1 1e-3 0")
        with pytest.warns(ld.UnsavedWarning, match="friction of contacts"):
            sim.state().save(tmp_path / "two")
