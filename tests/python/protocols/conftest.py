"""Packings whose particles move."""

import lammps_deformable as ld
import pytest


@pytest.fixture(scope="module")
def dense() -> ld.Packing:
    """Particles from random positions far above jamming."""
    return ld.bidisperse(32, phi=0.95, seed=3).push_off()


@pytest.fixture(scope="module")
def loose() -> ld.Packing:
    return ld.bidisperse(64, phi=0.6, seed=3).push_off()
