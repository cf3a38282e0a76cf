"""Jamming: the onset of rigidity of soft disks."""

import deformable
import numpy as np
import pytest


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_equal_mixture_jams_near_084(seed: int) -> None:
    jammed = deformable.jam(deformable.bidisperse(128, seed=seed))
    assert 0.825 < jammed.phi < 0.855


def test_packing_is_at_the_onset() -> None:
    jammed = deformable.jam(deformable.bidisperse(32, aspect=1.5, tilt=0.3, seed=3))
    apart = jammed.positions[:, None] - jammed.positions
    fraction = apart @ np.linalg.inv(jammed.box)
    distance = np.linalg.norm((fraction - np.rint(fraction)) @ jammed.box, axis=2)
    distance[np.diag_indices(32)] = np.inf
    overlap = (jammed.radius[:, None] + jammed.radius - distance)[np.triu_indices(32)]
    assert overlap.max() < 1e-4  # hardly more than touching ...
    assert (overlap > 0).sum() > 1.7 * 28  # ... but about 2N contacts, some rattlers apart


def test_same_seed_same_packing() -> None:
    first, again = (deformable.jam(deformable.bidisperse(16, seed=5)) for _ in range(2))
    assert np.array_equal(first.positions, again.positions)


def test_one_particle_jams_against_its_images() -> None:
    assert deformable.jam(deformable.bidisperse(1)).phi == pytest.approx(np.pi / 4, rel=1e-4)


def test_rigid_start_is_refused() -> None:
    with pytest.raises(deformable.ParameterError, match=r"rigid already at phi = 1\.1000"):
        deformable.jam(deformable.bidisperse(32, phi=1.1))
    with pytest.raises(deformable.ParameterError, match="pressure must be a positive number"):
        deformable.jam(deformable.bidisperse(8), pressure=0.0)
