"""Droplets of unlike sizes and tensions, dense, tiny, nearly in one place, and far away."""

import numpy as np
import pytest
from deformable import bidisperse, jam
from droplets import Droplets, dual

# ratio of radii, tensions of the small and the large ones
CONTRASTS = [(1.0, (1, 1)), (5.0, (1, 1)), (1.4, (1, 100)), (1.4, (100, 1)), (5.0, (1, 100))]


@pytest.fixture(scope="module")
def packings():
    ratios = {ratio for ratio, _ in CONTRASTS}
    return {r: jam(bidisperse(24, ratio=r, dimension=3, seed=1), tolerance=1e-2) for r in ratios}


def case_of(packing, tensions, phi, shake=0.0):
    """The packing at phi; shake: of positions, of the smallest radius."""
    packing = packing.at(phi)
    random = np.random.default_rng(1).normal(size=(len(packing), 3))
    return {
        "x": packing.positions + shake * packing.radius.min() * random,
        "box": np.diag(packing.box),
        "radius": packing.radius,
        "tension": np.array(tensions, float)[packing.species],
    }


@pytest.mark.parametrize("phi", [0.7, 0.8, 0.9, 0.95])
@pytest.mark.parametrize(("ratio", "tensions"), CONTRASTS)
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


@pytest.mark.parametrize("start", [0.1, 3.0])
@pytest.mark.parametrize(("ratio", "tensions", "phi"), [(1.4, (1, 100), 0.8), (5.0, (1, 1), 0.95)])
def test_one_solution(ratio, tensions, phi, start, packings, tmp_path):
    """Beyond the model the dual energy has one largest value, wherever forces begin."""
    case = case_of(packings[ratio], tensions, phi)
    scene = Droplets(case, tmp_path)
    energy, loads = dual(case, start)
    assert loads.max() > 0.4
    assert scene.energy == pytest.approx(energy, rel=1e-8)
    assert scene.outputs()[0] == np.count_nonzero(loads > 0.4)
