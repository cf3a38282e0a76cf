"""Droplets of unlike sizes and tensions, dense, tiny, nearly in one place, and far away."""

import numpy as np
import pytest
from droplet_formula import by_steps, work
from droplets import Droplets, dual
from lammps_deformable import bidisperse, jam
from polyhedra import FORCES
from test_droplet import alone, pair
from turns import in_turn

# ratio of radii, tensions of the small and the large ones
CONTRASTS = [(1.0, (1, 1)), (5.0, (1, 1)), (1.4, (1, 100)), (1.4, (100, 1)), (5.0, (1, 100))]


@pytest.fixture(scope="module")
def packings():
    ratios = {ratio for ratio, _ in CONTRASTS}
    return {
        r: jam(bidisperse(24, sizes=(0.5, 0.5 * r), dimension=3, seed=1), tolerance=1e-2).packing
        for r in ratios
    }


def case_of(packing, tensions, phi, shake=0.0, seed=1):
    """The packing at phi; shake: of positions, of the smallest radius."""
    packing = packing.at(phi)
    random = np.random.default_rng(seed).normal(size=(len(packing), 3))
    return {
        "x": packing.positions + shake * packing.radii.min() * random,
        "box": np.diag(packing.box),
        "radius": packing.radii,
        "tension": np.array(tensions, float)[packing.species],
    }


@pytest.mark.parametrize(
    ("ratio", "tensions", "phi"),
    in_turn(CONTRASTS, [0.95, 0.7, 0.8, 0.9]),
)
def test_contrasts(ratio, tensions, phi, packings, tmp_path):
    """Far beyond the model too: forces are balanced, and known to the last bit but a few."""
    scene = Droplets(case_of(packings[ratio], tensions, phi), tmp_path, "deformable/droplet")
    beyond, _, _, imbalance = scene.outputs()
    assert 0 < scene.energy < np.inf
    assert imbalance <= 1e-8
    assert ("are beyond the model" in scene.log.read_text()) == (beyond > 0)
    push = scene.force
    assert np.abs(push.sum(axis=0)).max() < 1e-9 * np.abs(push).max()
    along = push / np.linalg.norm(push)
    h = 1e-4 * min(packings[ratio].radii)
    at = [scene.energy_at(scene.x + s * h * along) for s in (1, -2)]  # 1 and -1 from the start
    assert (at[1] - at[0]) / (2 * h) == pytest.approx(np.linalg.norm(push), rel=1e-4)


def test_contacts_are_balanced_beyond_the_model(packings, tmp_path):
    """Weak droplets among strong ones, from forces that know nothing of each other: Newton's method
    goes in circles in few scenes at most. Which ones they are is up to rounding."""
    imbalances = [
        Droplets(
            case_of(packings[ratio], (1, 100), phi, shake, seed), tmp_path, "deformable/droplet"
        ).outputs()[3]
        for ratio in (1.4, 5.0)
        for phi in (0.8, 0.9, 0.95)
        for shake in (0.02, 0.05, 0.1)
        for seed in range(4)
    ]
    assert np.count_nonzero(np.array(imbalances) > 1e-8) <= 3


@pytest.mark.parametrize(
    ("ratio", "tensions", "phi", "start"), [(1.4, (1, 100), 0.95, 3.0), (5.0, (1, 1), 0.95, 0.1)]
)
def test_one_solution(ratio, tensions, phi, start, packings, tmp_path):
    """Beyond the model the dual energy has one largest value, wherever forces begin."""
    case = case_of(packings[ratio], tensions, phi)
    scene = Droplets(case, tmp_path)
    energy, loads = dual(case, start)
    assert loads.max() > 0.4
    assert scene.energy == pytest.approx(energy, rel=1e-8)
    rows = scene.contacts()
    f = rows[:, 4] / (case["tension"] * case["radius"])[rows[:, 0].astype(int) - 1]
    sums = [np.bincount(rows[:, 0].astype(int) - 1, each, len(loads)) for each in (f, f**2)]
    facets = sums[1] / (8 * np.pi * np.maximum(sums[0], 1e-300))
    assert scene.outputs()[0] == np.count_nonzero((loads > 0.4) | (facets > 0.05))


def test_tiny_overlaps(tmp_path):
    """a ~ f/(4 pi) [ln(8 pi/f) - 5/6], as far as the digits of positions tell overlaps."""
    for overlap in (1e-14, 1e-8, 1e-4):
        scene = pair(2.0 - overlap, tmp_path)
        distance = np.diff(scene.x[:, 2])[0]
        f = scene.force[1, 2]
        assert 0 < f < overlap
        a = by_steps(lambda f: work(f, np.array([[0.0, 0.0, 1.0]])), np.array([f]))[0]
        assert a == pytest.approx(f / (4 * np.pi) * (np.log(8 * np.pi / f) - 5 / 6), rel=1e-3)
        assert a == pytest.approx((2.0 - distance) / 2, rel=1e-7, abs=4e-16)


def test_a_droplet_alone(tmp_path):
    """It touches nothing, then itself on two sides, as two plates, then on six."""
    assert alone("sc", 3.0, tmp_path).energy == 0.0
    case = {"x": [[0.1, 2.9, 5]], "box": [1.94, 6, 6], "radius": [1.0], "tension": [1.0]}
    scene = Droplets(case, tmp_path)
    assert scene.contacts()[:, 4] == pytest.approx([FORCES["plates"][1]] * 2, rel=1e-8)
    assert np.abs(scene.force).max() < 1e-12
    with pytest.raises(Exception, match=r"have 4\.189 times the volume of their box, 1 x 1 x 1: "):
        alone("sc", 1.0, tmp_path)


@pytest.mark.parametrize("boundary", ["p p p", "p p f"])
def test_far_too_small_boxes_are_refused_before_lists_of_neighbors(boundary, tmp_path):
    """LAMMPS crashes where a particle has some 100 000 neighbors."""
    case = {"x": np.full((3, 3), 0.1), "box": [0.4] * 3, "radius": [5.0] * 3, "tension": [1.0] * 3}
    with pytest.raises(Exception, match=r"the volume of their box, 0\.4 x 0\.4 x 0\.4: "):
        Droplets(case, tmp_path, boundary=boundary)


def test_boxes_in_which_a_droplet_has_its_images_inside_are_refused(tmp_path):
    """It would have thousands of contacts."""
    case = {"x": [[0.1, 0.1, 5]], "box": [0.3, 30, 100], "radius": [1.0], "tension": [1.0]}
    with pytest.raises(Exception, match=r"box is 0\.3 wide along x, less than half of the largest"):
        Droplets(case, tmp_path)


@pytest.mark.parametrize("distance", [1.0, 1e-9])
def test_droplets_nearly_in_one_place(distance, tmp_path):
    """Beyond the model, and counted, with balanced forces that push them apart."""
    scene = pair(distance, tmp_path)
    assert scene.outputs()[0] == 2
    assert scene.outputs()[3] < 1e-11
    assert 0 < scene.force[1, 2] < np.inf
    scene.run("min_style fire\nmin_modify dmax 0.02\ntimestep 0.05\nminimize 0 1e-9 1000 2000")
    assert scene.energy == 0.0


@pytest.mark.parametrize("apart", [0.3, 1e-2, 1e-6, 0.0])
def test_contacts_nearly_in_one_direction(apart, tmp_path):
    """Two droplets that do not feel each other press on a third, until one has its place alone."""
    x = np.array([[5, 5, 5], [5, 5 - apart, 6.97], [5, 5 + apart, 6.97]])
    case = {"x": x, "box": [20.0] * 3, "radius": [1, 1.0001, 1.0001], "tension": [1.0] * 3}
    scene = Droplets(case, tmp_path, commands="neigh_modify exclude type 2 2")
    force = scene.force
    assert scene.outputs()[3] < 1e-11
    assert np.abs(force).max() < 1e6  # G is cut at an angle of 2e-6
    if apart >= 0.1:  # else W is not convex, as the facets cover each other
        h = 1e-3 * apart * np.array([[0, 0, 0], [0, 0, 0], [0, 1, 0]])
        slope = (scene.energy_at(x + h) - scene.energy_at(x - h)) / (2 * h[2, 1])
        assert -slope == pytest.approx(force[2, 1], rel=1e-5)


@pytest.mark.parametrize("axis", [0, 2])
def test_droplets_at_rest_meet_as_their_box_shrinks(axis, tmp_path):
    """Centers keep their places, and images come near between two neighbor lists."""
    x = np.full((2, 3), 4.0)
    x[:, axis] = 1.0, 6.0  # a gap of 1 through the boundary
    case = {"x": x, "box": [8.0, 8.0, 8.0], "radius": [1.0, 1.0], "tension": [1.0, 1.0]}
    once = "neighbor 2.0 bin\nneigh_modify every 1000 delay 0 check no"
    scene = Droplets(case, tmp_path, commands=once)
    assert scene.energy == 0.0
    # the box changes at the end of every tenth step, and not once more at the end of the run
    scene.run(f"fix shrink all deform 10 {'xyz'[axis]} final 0 6.8 remap none\nrun 99")
    energy, force = scene.energy, scene.force
    scene.run("unfix shrink\nrun 0")
    assert energy == pytest.approx(scene.energy, rel=1e-9)
    assert energy > 1e-4
    assert force == pytest.approx(scene.force, rel=1e-7, abs=1e-12)


def test_a_box_that_is_thinner_than_its_droplet(tmp_path):
    """Across a side that is not periodic there is room."""
    case = {"x": [[1.5, 1.5, 0.2]], "box": [3.0, 3.0, 0.4], "radius": [1.0], "tension": [1.0]}
    assert Droplets(case, tmp_path, boundary="p p f").energy == 0.0
