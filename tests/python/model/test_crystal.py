"""The triangular lattice, and what is refused."""

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import crystal


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


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((4, 3), "rows must be even, not 3"),
        ((0, 4), "columns must be at least 1"),
        ((4, -2), "rows must be at least 1"),
        ((4.5, 4), "columns must be"),
        ((4, 4, 0.0), "radius must"),
        ((4, 4, 0.5, 95.0), "phi is a fraction"),
        ((4, 4, 0.5, np.nan), "phi must"),
    ],
)
def test_refusals(arguments: tuple, told: str) -> None:
    with pytest.raises(ld.ParameterError, match=told):
        ld.triangular(*arguments)
