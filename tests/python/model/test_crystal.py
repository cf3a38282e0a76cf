"""Lattices, and what is refused."""

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import crystal
from lammps_deformable.common.box import lengths
from lammps_deformable.particles.neighbors import near_pairs
from refusals import refused


def test_as_built_by_hand() -> None:
    """A packing fraction of pi/sqrt(12)/(1 - a)^2 indents particles by a part a of their radius."""
    for a, columns, rows in ((0.0, 4, 4), (0.02, 5, 2), (-0.1, 3, 6)):
        made = ld.crystal("hex", (columns, rows // 2), phi=np.pi / np.sqrt(12.0) / (1.0 - a) ** 2)
        expected = crystal(a, columns, rows)
        assert made.positions == pytest.approx(expected.positions, abs=1e-14)
        assert made.box == pytest.approx(expected.box, abs=1e-14)
        assert made.radii == pytest.approx(expected.radii)
    large = ld.crystal("hex", (4, 2), radius=2.0)
    assert large.phi == pytest.approx(np.pi / np.sqrt(12.0))
    assert large.box == pytest.approx(4.0 * ld.crystal("hex", (4, 2)).box)


def test_neighbors_touch() -> None:
    """Also images of a particle itself; all distances are those of touching neighbors."""
    for lattice, cells, phi, neighbors in (
        ("hex", (3, 2), np.pi / np.sqrt(12), 6),
        ("square", (4, 3), np.pi / 4, 4),
        ("sc", (1, 2, 3), np.pi / 6, 6),
        ("bcc", (1, 2, 3), np.sqrt(3) * np.pi / 8, 8),
        ("fcc", 2, np.pi / np.sqrt(18), 12),
        ("hcp", (4, 2, 2), np.pi / np.sqrt(18), 12),
    ):
        made = ld.crystal(lattice, cells, radius=0.7)
        assert made.phi == pytest.approx(phi), lattice
        assert ld.crystal(lattice, cells, phi=0.6).phi == pytest.approx(0.6)
        i, j, shift = near_pairs(made, 1e-9)
        counts = np.bincount(np.concatenate([i, j]), minlength=len(made))
        assert counts.tolist() == [neighbors] * len(made), lattice
        assert lengths(made.positions[j] + shift - made.positions[i]) == pytest.approx(1.4)
        assert len(near_pairs(made, -1e-9)[0]) == 0


def test_refusals() -> None:
    for arguments, told in (
        (("hex", (0, 4)), "cells must be at least 1"),
        (("fcc", (4, 4)), "cells must be one number, or 3 for fcc"),
        (("diamond", 4), "lattice must be square, hex, sc, bcc, fcc, hcp, not 'diamond'"),
    ):
        with refused(told):
            ld.crystal(*arguments)


def test_wrong_numbers() -> None:
    for name, value in (("radius", 0.0), ("phi", 95.0)):
        with pytest.raises(ld.ParameterError, match=f"{name} "):
            ld.crystal("hex", 4, **{name: value})
