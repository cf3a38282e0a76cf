"""Particles in space are followed where tilts flip: by protocols, by LAMMPS, in any images."""

import lammps_deformable as ld
import numpy as np
import pytest

LEANING = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [2.4, 0.0, 4.0]]


def state_of(packing: ld.Packing) -> ld.State:
    with ld.Simulation(packing, ld.SoftContact()) as spheres:
        return spheres.state()


def spheres(number: int, box: object, radius: float = 0.4) -> ld.Packing:
    fractions = np.random.default_rng(3).uniform(size=(number, 3))
    return ld.Packing(fractions @ np.array(box), radius, box)


@pytest.mark.filterwarnings("ignore::lammps_deformable.JumpWarning")
@pytest.mark.parametrize(
    ("tilts", "flips"), [((1.2, -0.9, 1.6), (0, 0, 1)), ((-1.9, 1.9, -1.9), (-2, 3, -1))]
)
def test_steps_come_back(tilts: tuple[float, ...], flips: tuple[int, ...]) -> None:
    """Beside a strain, in any images, and in any box with the same images."""
    xy, xz, yz = tilts
    packing = spheres(30, [[4.0, 0.0, 0.0], [xy, 4.4, 0.0], [xz, yz, 3.8]])
    rng = np.random.default_rng(1)
    gradient = np.array([[0.04, 0.05, -0.03], [0.0, -0.02, 0.04], [0.0, 0.0, 0.03]])
    strained = packing.box @ (np.eye(3) + gradient).T
    step = rng.uniform(-0.45, 0.45, (30, 3)) * strained.diagonal()
    affine = packing.positions @ (np.eye(3) + gradient).T
    box = strained.copy()
    box[1] += flips[0] * box[0]
    box[2] += flips[1] * box[0] + flips[2] * box[1]
    places = affine + step + rng.integers(-3, 4, (30, 3)) @ strained
    start, end = state_of(packing), state_of(packing.replace(positions=places, box=box))
    assert end.nonaffine(start) == pytest.approx(step, abs=1e-11)
    assert end.displacements(start) == pytest.approx(affine + step - packing.positions, abs=1e-11)
    assert ld.Run([start, end]).unwrapped()[1] == pytest.approx(affine + step, abs=1e-11)
    local = state_of(packing.replace(positions=affine, box=box)).local_strain(start, 2.5)
    assert local.gradient == pytest.approx(np.broadcast_to(gradient, (30, 3, 3)), abs=1e-9)
    assert local.d2min == pytest.approx(np.zeros(30), abs=1e-12)


def test_a_small_shear_of_a_box_that_leans() -> None:
    """The box leans by more than half its width, so that `shear` replaces it."""
    with ld.Simulation(spheres(20, LEANING), ld.SoftContact()) as sim:
        before = sim.relax(1e-9)
        (now,) = sim.shear(1e-6, tolerance=1e-9)[1:]
    assert now.packing.box[2, 0] == pytest.approx(2.4 - 4.0)
    assert np.abs(now.displacements(before)).max() < 1e-4
    assert np.nanmax(now.local_strain(before, r_max=2.0).d2min) < 1e-8
    assert np.abs(ld.Run([before, now]).unwrapped()[1] - before.packing.positions).max() < 1e-4


def test_a_shear_is_told_by_the_strain() -> None:
    """Twice around, at once and step by step, with yz along."""
    packing = spheres(12, [[4.0, 0.0, 0.0], [0.5, 4.0, 0.0], [-1.0, 1.7, 4.0]], radius=0.3)
    with ld.Simulation(packing, ld.SoftContact()) as sim:
        start = sim.relax(1e-6)
        states = [start, *sim.shear(2.0, steps=40, tolerance=1e-2)[1:]]
    first, *_, last = ld.Run(states).unwrapped()
    end, affine = states[-1], np.outer(first[:, 1], [2.0, 0.0, 0.0])
    near = (np.abs(last - first - affine) < 1.9).all(axis=1)
    assert near.any()
    assert end.displacements(start)[near] == pytest.approx((last - first)[near], abs=1e-9)
    assert end.nonaffine(start)[near] == pytest.approx((last - first - affine)[near], abs=1e-9)


@pytest.mark.parametrize("flow", ["xy erate 0.008 xz erate -0.01", "xz erate 0.02 yz erate -0.01"])
def test_images_of_lammps(flow: str) -> None:
    """Droplets that drift over several boxes, while the box shears and flips in two planes."""
    packing = spheres(20, [[4.0, 0.0, 0.0], [1.8, 4.0, 0.0], [-1.8, 1.7, 4.0]]).push_off()
    states, expected = [], []
    with ld.Simulation(packing, ld.Droplet()) as sim:
        sim.lmp.commands_string(
            "velocity all set 0.1 0.07 0.05\nfix motion all nve\n"
            f"fix flow all deform 1 {flow} remap x flip yes\ntimestep 0.1"
        )
        for _ in range(21):
            states.append(sim.state())
            images = np.array(sim.lmp.gather("image", 0, 3)).reshape(-1, 3)
            expected.append(states[-1].packing.positions + images @ sim.box)
            sim.lmp.command("run 50 post no")
    tilts = np.array([state.packing.box[[1, 2, 2], [0, 0, 1]] for state in states])
    flipped = np.abs(np.diff(tilts, axis=0)).max(axis=0) > 3.0
    assert flipped.tolist() == ["xy" in flow, "xz" in flow, "yz" in flow]
    found = ld.Run(states).unwrapped()
    assert found - found[0] == pytest.approx(np.array(expected) - expected[0], abs=1e-9)
