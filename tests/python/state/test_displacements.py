"""Particles that are followed: over boundaries, in boxes that change, and as LAMMPS counts them."""

import warnings

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused

Points = np.ndarray


def state_of(packing: ld.Packing) -> ld.State:
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        return disks.state()


def moved(packing: ld.Packing, box: list[list[float]], step: Points, images: Points) -> ld.Packing:
    """The packing after the strain of its box, steps of the particles, and jumps to images."""
    box = np.array(box)
    fractions = packing.positions @ np.linalg.inv(packing.box)
    places = fractions @ box + step + images @ box
    return packing.replace(positions=places, box=box)


@pytest.mark.filterwarnings("ignore::lammps_deformable.JumpWarning")
@pytest.mark.parametrize(("tilt", "flips"), [(0.4, 1), (-7.3, -3)])
def test_steps_come_back(tilt: float, flips: int) -> None:
    """Beside a strain, in any images, and in an equivalent box."""
    rng = np.random.default_rng(1)
    packing = ld.bidisperse(30, phi=0.3, aspect=1.4, tilt=tilt, seed=1)
    (lx, _), (xy, ly) = packing.box.tolist()
    step = rng.uniform(-0.49, 0.49, (30, 2)) * [1.1 * lx, 0.9 * ly]
    box = [[1.1 * lx, 0.0], [xy * 0.9 + 0.1 * lx, 0.9 * ly]]
    images = rng.integers(-3, 4, (30, 2))
    now = moved(packing, box, step, images)
    now = now.replace(box=now.box + np.array([[0.0, 0.0], [flips * 1.1 * lx, 0.0]]))
    start, end = state_of(packing), state_of(now)
    assert end.nonaffine(start) == pytest.approx(step, abs=1e-11)
    strained = packing.positions @ np.linalg.inv(packing.box) @ np.array(box)
    expected = strained + step - packing.positions
    assert end.displacements(start) == pytest.approx(expected, abs=1e-11)
    assert end.displacements(packing) == pytest.approx(end.displacements(start), abs=1e-12)
    assert ld.Run([start, end]).unwrapped()[1] == pytest.approx(strained + step, abs=1e-11)


def test_a_shear_is_told_by_the_strain() -> None:
    """Twice around, so that the box at the end is that of the start: at once, and step by step."""
    packing = ld.jam(ld.bidisperse(16, seed=1)).packing
    with ld.Simulation(packing.at(packing.phi + 0.02), ld.SoftContact()) as disks:
        start = disks.relax(1e-2)
        sides = start.packing.box.diagonal()
        strain = float(2.0 * sides[0] / sides[1])
        states = [start, *disks.shear(strain, steps=40, tolerance=1e-2)[1:]]
    end = states[-1]
    assert end.packing.box == pytest.approx(start.packing.box, abs=1e-9)
    first, *_, last = ld.Run(states).unwrapped()
    beside = last - first - np.outer(first[:, 1], [strain, 0.0])
    near = (np.abs(beside) < 0.499 * sides).all(axis=1)
    assert near.any()
    assert end.nonaffine(start)[near] == pytest.approx(beside[near], abs=1e-9)
    assert end.displacements(start)[near] == pytest.approx((last - first)[near], abs=1e-9)


def test_between_walls_nothing_is_across() -> None:
    walls = ld.BoxWall((8.0, 6.0), (-2.0, 1.0)).parts
    packing = ld.bidisperse(12, seed=1).between(walls)
    middle = np.array([2.0, 4.0])
    away = packing.replace(positions=2.0 * middle - packing.positions)
    expected = away.positions - packing.positions
    assert np.abs(expected).max() > 4.0
    assert state_of(away).nonaffine(packing) == pytest.approx(expected, abs=1e-13)
    channel = packing.between(walls[2:])
    across = channel.replace(positions=channel.positions + np.array([8.5, 0.0]))
    assert state_of(across).nonaffine(channel) == pytest.approx(
        np.tile([0.5, 0.0], (12, 1)), abs=1e-12
    )
    with pytest.raises(ld.ParameterError, match="walls, which close other directions"):
        state_of(across).displacements(packing)


@pytest.mark.parametrize("walled", [False, True])
def test_jumps_of_half_a_box_are_told(walled: bool) -> None:
    """A fluid that drifts: by 0.2 of the box from state to state it is followed, by 0.45 not."""
    packing = ld.bidisperse(8, phi=0.3, seed=1)
    if walled:
        packing = packing.between(ld.BoxWall(packing.box.diagonal()).parts[2:])
    drift = np.array([packing.box[0, 0], 0.0])
    slow, fast = (
        [state_of(packing.replace(positions=packing.positions + part * drift * n)) for n in (0, 1)]
        for part in (0.2, 0.45)
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        places = ld.Run(slow).unwrapped()
    assert places[1] - places[0] == pytest.approx(np.broadcast_to(0.2 * drift, (8, 2)))
    told = r"\Aa particle moves by 0\.45 of the box from state 1 to state 2, [^\n]*\Z"
    with pytest.warns(ld.JumpWarning, match=told) as found:
        ld.Run([slow[0], *fast, fast[1]]).unwrapped()
    assert len(found) == 1


@pytest.mark.parametrize(
    ("tilt", "flow"),
    [(0.4, ""), (0.0, "fix flow all deform 1 xy erate 0.01 remap x flip yes")],
)
def test_images_of_lammps(tilt: float, flow: str) -> None:
    """A fluid that drifts over several boxes, also in one that is sheared and flips."""
    fluid = ld.bidisperse(16, phi=0.7, tilt=tilt, seed=2).push_off()
    states, expected, images = [], [], []
    with ld.Simulation(fluid, ld.Ring()) as sim:
        sim.lmp.commands_string(
            "velocity all create 1e-4 1\n"
            "velocity all set 0.1 0.07 0 sum yes\n"
            f"fix motion all nve\nfix plane all enforce2d\n{flow}\ntimestep 0.2"
        )
        for _ in range(21):
            states.append(sim.state())
            images.append(np.array(sim.lmp.gather("image", 0, 3)).reshape(-1, 3)[:, :2])
            expected.append(states[-1].packing.positions + images[-1] @ sim.box)
            sim.lmp.command("run 50 post no")
    assert np.abs(images[-1]).max() >= 2
    tilts = [state.packing.box[1, 0] for state in states]
    assert (min(np.diff(tilts)) < 0.0) == bool(flow)
    assert not images[0].any()
    assert ld.Run(states).unwrapped() == pytest.approx(np.array(expected), abs=1e-10)


def test_refusals() -> None:
    packing = ld.bidisperse(30, phi=0.3, seed=1)
    state = state_of(packing)
    for before, told in (
        (ld.bidisperse(16, seed=1), "before has 16 particles and this state 30"),
        (3, "before must be a state or a Packing, not 3"),
    ):
        for method in (state.displacements, state.nonaffine, state.local_strain):
            with refused(told):
                method(before)
    with refused("at least one state"):
        ld.Run([]).unwrapped()
    with refused("a state must be .* not 3"):
        ld.Run([3]).unwrapped()
    for given in (0.0, "near"):
        with refused("r_max"):
            state.local_strain(state, r_max=given)
