"""Friction of contacts as settings."""

import math

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.particles.friction import friction_commands, longest_rubbing_step
from refusals import refused

MATRIX = [[0.3, 0.1], [0.1, 0.0]]
FIX = "fix deformable_friction all deformable/friction "


def test_the_fix() -> None:
    walls = ld.Friction(0.1, kt=2.0, gt=0.3, damping=0.4)
    for friction, words in (
        (ld.Friction(0.5, kt=1), "0.5 1.0 0.0 damp 0.0"),
        (ld.Friction(math.inf, kt=1.0, damping=np.float32(0.25)), "inf 1.0 0.0 damp 0.25"),
        (
            ld.Friction(MATRIX, kt=1.0, damping=np.array(MATRIX)),
            "0.3 1.0 0.0 damp 0.3 types 1 1 0.3 1.0 0.0 0.3 types 1 2 0.1 1.0 0.0 0.1 "
            "types 2 2 0.0 1.0 0.0 0.0",
        ),
        (
            ld.Friction(0.5, kt=1.0, walls=walls),
            "0.5 1.0 0.0 damp 0.0 types * wall 0.1 2.0 0.3 0.4",
        ),
        (
            ld.Friction(0.5, kt=1.0, film=[[1.0, 0.0], [0.0, 2.0]], power=0.5),
            "0.5 1.0 0.0 damp 0.0 film 1.0 0.5 types 1 1 0.5 1.0 0.0 0.0 film 1.0 0.5 "
            "types 1 2 0.5 1.0 0.0 0.0 types 2 2 0.5 1.0 0.0 0.0 film 2.0 0.5",
        ),
        (
            ld.Friction(0.5, kt=1.0, restitution=0.7, film=1.0),
            "0.5 1.0 0.0 damp 0.0 restitution 0.7 film 1.0 1.0",
        ),
    ):
        assert friction_commands(friction, 2) == FIX + words + "\n"
        assert eval(repr(friction), {"Friction": ld.Friction, "inf": math.inf}) == friction
        assert hash(friction) != hash(ld.Friction(9.0, kt=9.0))


def test_hard_springs_have_short_steps() -> None:
    """Also where nothing moves: LAMMPS' own step would be refused."""
    touching = ld.Packing([[1.0, 1.0], [1.9, 1.0]], 0.5, [4.0, 2.0])
    rough = ld.Friction(0.5, kt=1e6, damping=1e3)
    with ld.Simulation(touching, ld.Ring(), friction=rough) as sim:
        assert sim.state().energy > 0.0


def test_time_steps() -> None:
    """kt dt^2 + 2 gt dt = m/7 and 2 damping dt = m/2, of the hardest pair."""
    assert longest_rubbing_step(ld.Friction(0.5, kt=1.0)) == pytest.approx(math.sqrt(1 / 7))
    assert longest_rubbing_step(ld.Friction(0.5, kt=0.0, damping=2.0)) == pytest.approx(1 / 8)
    hard = ld.Friction(0.5, kt=[[1.0, 2.0], [2.0, 4.0]])
    assert longest_rubbing_step(hard) == pytest.approx(math.sqrt(1 / 28))
    walled = ld.Friction(0.5, kt=1.0, walls=ld.Friction(0.5, kt=16.0))
    assert longest_rubbing_step(walled) == pytest.approx(math.sqrt(1 / 112))


def test_refused() -> None:
    for values, message in (
        ({"film": -1.0}, "film must be 0 or positive and finite, not -1"),
        ({"power": 1.5}, "the power of a film must be above 0 and 1 at most, not 1.5"),
        ({"mu": -0.1}, "mu must be 0, positive or inf, not -0.1"),
        ({"mu": "rough"}, "mu must be a number, or a matrix.*'rough'"),
        ({"mu": [[0.1, 0.2], [0.3, 0.1]]}, "mu must be symmetric, but species 0 and 1"),
        ({"mu": [[0.1, -0.2], [-0.2, 0.1]]}, "mu must be 0, positive or inf, not -0.2"),
        ({"mu": MATRIX, "kt": np.ones((3, 3))}, "3 species, so the matrix of mu.*not 2"),
        ({"kt": math.inf}, "kt must be 0 or positive and finite, not inf"),
        ({"damping": -1.0}, "damping must be 0 or positive and finite, not -1"),
        ({"restitution": 0.0}, "restitution must be above 0 and 1 at most, not 0"),
        ({"restitution": 0.5, "damping": 1.0}, "damping must be 0 beside a restitution, not 1"),
        ({"walls": 0.5}, "walls must be of the kind Friction"),
        ({"walls": ld.Friction(MATRIX, kt=1.0)}, "walls has one number"),
    ):
        with refused(message):
            ld.Friction(**({"mu": 0.5, "kt": 1.0} | values))


def test_a_small_restitution_has_short_steps() -> None:
    start = ld.bidisperse(16, phi=0.92, seed=1).push_off()
    rough = ld.Friction(0.3, kt=0.01, restitution=0.03)
    with ld.Simulation(start, ld.Ring(), friction=rough) as sim:
        sim.run(100, temperature=1e-4, seed=1)
        assert sim.relax(1e-4).converged


PACKING = ld.Packing([[1.0, 1.0], [3.0, 1.0]], [0.5, 0.7], [4.0, 2.0], species=[0, 1])


def test_simulations_without() -> None:
    for law, friction, walls, message in (
        (ld.Sector(), ld.Friction(0.5, kt=1.0), (), "Sector stick: take Ring"),
        (ld.Ring(), ld.Friction(np.ones((1, 1)), kt=1.0), (), "2 species.*not 1"),
        (
            ld.Ring(),
            ld.Friction(MATRIX, kt=1.0),
            ld.BoxWall((4, 2)),
            r"give it walls=Friction\(",
        ),
        (
            ld.Ring(contact="radical"),
            ld.Friction(0.0, kt=1.0, walls=ld.Friction(0.0, kt=1.0, restitution=0.5)),
            (),
            "a restitution needs contacts with one force",
        ),
        (ld.Ring(), 0.5, (), "friction must be of the kind Friction"),
    ):
        with refused(message):
            ld.Simulation(PACKING.replace(walls=walls), law, friction=friction)
