"""Exact osmotic pressures and elastic energies of crystals."""

import lammps_deformable as ld
import pytest

from validation.droplet_shapes.__main__ import exact, strained
from validation.droplet_shapes.clusters import CASES, error, measure


@pytest.mark.slow
def test_crystals() -> None:
    """fcc at phi = 0.81, as the page of the study has it."""
    assert exact("fcc", 0.81)["exact"] == pytest.approx(0.1206, rel=2e-3)


@pytest.mark.slow
def test_a_strained_crystal() -> None:
    """A droplet and its images: unstrained it is one between planes, and pure shears are alike.

    Along a cube axis a stretch by e has the energy 3/4 V (C11 - C12) e^2 for small e.
    """
    rest, less, more = (strained("stretch", e) for e in (0.0, -0.05, 0.05))
    fcc = ld.crystal("fcc", 2, radius=1.0, phi=0.8)
    with ld.Simulation(fcc, ld.Droplet()) as sim:
        state = sim.state()
        modulus = 2.0 * state.moduli().pure_shear_modulus  # C11 - C12
    assert rest["law"] == pytest.approx(state.energy / len(fcc), rel=1e-9)
    for kind in ("exact", "law"):
        gained = 0.5 * (less[kind] + more[kind]) - rest[kind]
        volume = fcc.volume / len(fcc)
        assert gained == pytest.approx(0.75 * volume * modulus * 0.05**2, rel=0.04)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["4 of radii 1 : 1.4, angle 0.5, centers pulled"])
def test_a_cluster(name: str) -> None:
    """Of droplets that stick, as the page of the study has it."""
    row = measure(next(case for case in CASES if str(case) == name))
    assert error(row, "energy") < 0.005
    assert error(row, "position") < 0.01
    assert error(row, "force") < 0.01
