"""A ring of beads between walls."""

from dataclasses import replace

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import core
from lammps_deformable.engine.lammps import gather
from lammps_deformable.particles.polygons import Walls
from naive_polygons import ALONE, LONE_BEADS, naive, square
from refusals import refused

pytestmark = pytest.mark.filterwarnings("error")


def test_walls_press_like_beads() -> None:
    with ld.Simulation._within(ALONE, LONE_BEADS, square(0.5)) as sim:
        assert sim.state().residual == 0.0
        sim._confine(square(0.49))
        state = sim.relax(0.01)
        force = gather(sim.lmp, "f", 3)[:, :2]
    (model,) = state.outlines
    exact = naive(state, [model], state.packing.box)
    walls = square(0.49)
    overlap = np.maximum(LONE_BEADS.radius - (walls.height - model @ walls.normal.T), 0.0)
    assert overlap.any(axis=0).all()
    energy = exact.energy + 0.5 * LONE_BEADS.kr * np.sum(overlap**2)
    assert state.energy == pytest.approx(energy, rel=1e-10)
    pushed = exact.force[0] - LONE_BEADS.kr * overlap @ walls.normal
    assert force == pytest.approx(pushed, abs=1e-12)
    assert state.residual <= 0.01
    assert state.contacts["i"].size == 0


def test_beads_keep_their_place_on_walls_that_stick() -> None:
    slides = {}
    for stick in (True, False):
        angle = np.array([0.0, 1.8, 3.9])
        with ld.Simulation._within(ALONE, LONE_BEADS, Walls(angle, np.full(3, 0.5), stick)) as sim:
            for height in (0.49, 0.48):
                sim._confine(Walls(angle, np.full(3, height), stick))
                before = sim.state().outlines[0]
                state = sim.relax(0.01)
                assert sim.engine.walls is not None
                assert sim.engine.walls.height == pytest.approx(np.full(3, height))
        after = state.outlines[0]
        touching = before @ sim.engine.walls.normal[0] > 0.48 - LONE_BEADS.radius
        assert touching.any()
        slides[stick] = np.abs(after - before)[touching, 1].max()
    assert slides[True] < 0.2 * slides[False]


def test_walls_do_not_jump_over_beads() -> None:
    with ld.Simulation._within(ALONE, LONE_BEADS, square(0.5)) as sim:
        with pytest.raises(
            ld.ParameterError, match=r"a step of 0\.04 puts beads .* wall .* a bead, 0\.03"
        ):
            sim._confine(square(0.46))
        assert sim.engine.walls is not None
        assert sim.engine.walls.height[0] == 0.5
        sim._confine(square(0.48))
        assert sim.state().energy > 0.0


def test_confine_moves_the_walls_that_are_there() -> None:
    for there, walls in (
        (square(0.5), Walls([0.0, 2.0, 4.0], np.full(3, 0.5))),
        (square(0.5), Walls(np.arange(4) * np.pi / 2.0, np.full(4, 0.5), stick=True)),
    ):
        with (
            ld.Simulation._within(ALONE, LONE_BEADS, there) as sim,
            refused(r"number.*stick"),
        ):
            sim._confine(walls)


def test_walls_do_not_follow_the_box() -> None:
    with ld.Simulation._within(ALONE, LONE_BEADS, square(0.5)) as sim:
        with pytest.raises(ld.ParameterError, match="confine"):
            sim.deform(2.0 * np.eye(2))
        assert sim.box == pytest.approx(3.0 * np.eye(2))


def test_walls_press_smooth_polygons_at_their_skin() -> None:
    """The ring law with the skin c/2 has the same area deficit: both touch R + c/2 outside."""
    model = replace(LONE_BEADS, vertices=160, kL=160.0, kr=300.0, smooth=True)
    with ld.Simulation._within(ALONE, model, square(0.5)) as sim:
        for height in (0.49, 0.48):
            sim._confine(square(height))
            state = sim.relax(1e-3)
    (kP,), (skin,) = state.polygons.kP, state.polygons.skin
    walls = square(0.48)
    law = core.soft_ring(0.5, walls.angle, np.full(4, 0.02), 1.0, kP, skin)
    # walls yield by p L0/kr, 3e-5 of the indentation; chords of 160 sides cut (pi/160)^2 off
    assert state.area_deficit[0] == pytest.approx(law.area_deficit, rel=2e-3)
    assert state.packing.positions[0] == pytest.approx([0.0, 0.0], abs=1e-6)
