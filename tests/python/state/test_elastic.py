"""Moduli that are read off an elastic tensor."""

import numpy as np
import pytest
from lammps_deformable.moduli import ElasticModuli


def test_the_mean_shear_modulus_is_that_of_all_directions() -> None:
    """Of a tensor without symmetry but that of an elastic one, turned by many angles."""
    c = np.random.default_rng(2).normal(size=(2, 2, 2, 2))
    c = c + c.transpose(1, 0, 2, 3)
    c = c + c.transpose(0, 1, 3, 2)
    c = c + c.transpose(2, 3, 0, 1)
    turned = []
    for angle in np.linspace(0.0, np.pi, 8, endpoint=False):
        q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned.append(np.einsum("ai,bj,ck,dl,ijkl->abcd", q, q, q, q, c)[0, 1, 0, 1])
    moduli = ElasticModuli(c, c, 0.0 * c)
    assert moduli.mean_shear_modulus == pytest.approx(np.mean(turned), rel=1e-12)
    assert max(turned) - min(turned) > 0.1
