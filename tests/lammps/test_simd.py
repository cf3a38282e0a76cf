"""The levels of SIMD instructions: DEFORMABLE_SIMD."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import core
from lammps_deformable.engine.lammps import gather
from laws import LAWS
from materials import packing, pushed
from scene import PACKINGS, Scene, box_walls

LEVELS = core.simd_levels()
CASE = PACKINGS[0]
WALLS = box_walls(0, CASE["L"], 0, CASE["L"])
# law, material, its packing, walls
SCENES = [
    ("sector", "perimeter conserved", CASE, ""),
    ("sector", "area conserved", PACKINGS[1], ""),
    *(("radical", kind, CASE, "") for kind in ("rings", "all species")),
    *(("balanced", kind, CASE, "") for kind in ("perimeter conserved", "droplets", "all species")),
    ("radical", "some of finite stiffness", CASE, WALLS),
]
NAMES = [f"{law}, {material}" for law, material, _, _ in SCENES]


@pytest.mark.parametrize(("law", "material", "case", "walls"), SCENES, ids=NAMES)
def test_levels_agree_to_the_last_bit(law, material, case, walls, monkeypatch):
    x, boundary = pushed(case), "p p p"
    if walls:
        x, boundary = np.clip(x, 0.46, case["L"] - 0.46), "f f p"
    states = []
    for level in [*LEVELS, None]:
        if level is None:
            monkeypatch.delenv("DEFORMABLE_SIMD")
        else:
            monkeypatch.setenv("DEFORMABLE_SIMD", level)
        scene = packing(case, LAWS[law], material, boundary=boundary, commands=walls)
        states.append(scene.evaluate(x))
    assert np.abs(states[0].force).max() > 1e-4
    for state in states[1:]:
        assert state.energy == states[0].energy
        np.testing.assert_array_equal(state.force, states[0].force)


def test_unknown_level(monkeypatch):
    monkeypatch.setenv("DEFORMABLE_SIMD", "sse9")
    with pytest.raises(Exception, match="sse9"):
        Scene.packing(CASE, LAWS["sector"])


@pytest.mark.parametrize(
    ("contact", "number", "accuracy", "kP"),
    [("radical", 256, 1e-11, np.inf), ("balanced", 600, 4e-7, 0.1)],
)
def test_forces_in_motion(contact, number, accuracy, kP):
    """Particles lose and find contacts between two neighbor lists: their first guess is that of
    the step before, also if no contact is left. Forces are those of a fresh start; balanced ones,
    in two blocks of particles, up to their tolerance, 1e-8 of the largest contact force for a
    contact that changes alone. Contacts are up to 7 times as soft together (the least eigenvalue is
    0.15), and a particle has 6 of them.
    """
    packing = ld.jam(ld.bidisperse(number, seed=1), tolerance=1e-2).packing.at(0.9)
    law = ld.Ring(contact=contact, kP=kP)
    with (
        ld.Simulation(packing, law) as moving,
        ld.Simulation(packing, law) as still,
    ):
        moving.relax(1e-2)
        moving.lmp.commands_string(
            "neighbor 0.3 bin\nvelocity all create 1e-5 4711 loop all\nfix nve all nve\n"
            "timestep 0.4\nrun 0 post no"
        )
        for _ in range(10):
            moving.lmp.command("run 1 pre no post no")
            x = gather(moving.lmp, "x", 3)
            still.lmp.scatter("x", 1, 3, np.ctypeslib.as_ctypes(x.ravel()))
            still.lmp.command("run 0 post no")
            found, expected = gather(moving.lmp, "f", 3), gather(still.lmp, "f", 3)
            largest = still.state().contacts["force"].max()
            assert found == pytest.approx(expected, rel=0, abs=accuracy * largest)
