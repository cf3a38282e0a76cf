"""Moduli of droplets that stick, under tension."""

import math
from collections.abc import Callable

import lammps_deformable as ld
import numpy as np
import pytest
from mpi4py import MPI
from numpy.typing import NDArray

from validation.finite_strain import Modulus, bulk_modulus, shear_modulus

Box = NDArray[np.float64]


@pytest.fixture(scope="module")
def expanded() -> ld.State:
    """A jammed packing that sticks, expanded until films hold droplets beyond their touch."""
    law = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved", adhesion=0.1)
    jammed = ld.jam(ld.bidisperse(12, seed=1)).packing
    with ld.Simulation(jammed, law, comm=MPI.COMM_SELF) as sim:
        phi = sim.relax().packing.phi
        sim.deform(sim.box * math.sqrt(phi / 0.75))
        state = sim.relax(1e-8)
    table, radius = state.contacts, state.packing.radii
    assert (table["distance"] > radius[table["i"]] + radius[table["j"]]).any()
    assert state.pressure < -0.1
    return state


def stretched(box: Box, gamma: float) -> Box:
    return box * np.exp([gamma / 2.0, -gamma / 2.0])


def compressed(box: Box, compression: float) -> Box:
    return box * math.sqrt(1.0 - compression)


@pytest.mark.parametrize(
    ("modulus", "settings", "deformed"),
    [
        (shear_modulus, {"pure": True}, stretched),
        (bulk_modulus, {}, compressed),
    ],
)
def test_modulus_is_the_second_derivative_of_the_energy(
    expanded: ld.State,
    modulus: Callable[..., Modulus],
    settings: dict[str, bool],
    deformed: Callable[[Box, float], Box],
) -> None:
    """V sigma = dU/dgamma and V0 p = dU/de with V = V0 (1 - e): U'' is V0 times the modulus."""
    found = modulus(expanded, 1e-3, **settings)
    assert found.linear
    energies = []
    for strain in (-found.strain, found.strain):
        with ld.Simulation(expanded, expanded.law, comm=MPI.COMM_SELF) as sim:
            sim.deform(deformed(sim.box, strain))
            state = sim.relax(1e-8)
        assert state.films is not None
        assert expanded.films is not None
        assert set(map(tuple, state.films)) == set(map(tuple, expanded.films))
        energies.append(state.energy)
    second = (sum(energies) - 2.0 * expanded.energy) / found.strain**2
    # central differences over the strains of a film: (1e-3 / 0.03)^2, a factor
    area = np.linalg.det(expanded.packing.box)
    assert found.value == pytest.approx(second / area, rel=1e-3)
