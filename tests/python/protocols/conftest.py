"""Packings whose particles move."""

import deformable
import pytest


@pytest.fixture(scope="module")
def dense() -> deformable.Packing:
    """Particles from random positions far above jamming."""
    return deformable.push_off(deformable.bidisperse(32, phi=0.95, seed=3))


@pytest.fixture(scope="module")
def loose() -> deformable.Packing:
    return deformable.push_off(deformable.bidisperse(64, phi=0.6, seed=3))
