"""Equal particles on a triangular lattice, from their onset to confluence."""

import lammps_deformable as ld
import numpy as np
import pytest
from crystal import RADIUS, crystal

# Arcs that vanish are differences: they need forces beyond the default tolerance.
pytestmark = pytest.mark.usefixtures("exact_balance")

# A hexagon of inradius h has the perimeter 2 A6 h and the area A6 h^2.
A6 = 6.0 * np.tan(np.pi / 6.0)
CONFLUENCE = 1.0 - np.pi / A6  # a/R where the perimeter 2 pi R is that of the hexagon


def lattice_state(indentation: float) -> ld.State:
    with ld.Simulation(crystal(indentation), ld.Ring()) as sim:
        return sim.state()


def test_confluence_is_where_the_arcs_vanish() -> None:
    assert pytest.approx(0.0931, abs=5e-5) == CONFLUENCE
    for part in (-1e-6, 1e-6):
        state = lattice_state(CONFLUENCE + part)
        assert state.beyond == (16 if part > 0.0 else 0)
        assert state.arc_radii == pytest.approx(-A6 / (A6 - np.pi) * part * RADIUS, rel=1e-6)


@pytest.mark.parametrize("part", [0.1, 1.0 - 1e-9])
def test_pressure_up_to_confluence_is_the_closed_form(part: float) -> None:
    """S = K a^2 with K = pi A6/(A6 - pi), p = -dU/dV with V = A6 h^2 of a cell."""
    a = part * CONFLUENCE * RADIUS
    stiffness = np.pi * A6 / (A6 - np.pi)
    state = lattice_state(part * CONFLUENCE)
    assert state.energy == pytest.approx(16 * (stiffness * a**2) ** 2 / 2.0, rel=1e-9)
    pressure = 2.0 * stiffness**2 * a**3 / (2.0 * A6 * (RADIUS - a))
    assert state.pressure_tensor == pytest.approx(
        pressure * np.eye(2), rel=1e-9, abs=1e-9 * pressure
    )
    assert (state.coordination, state.network_contacts) == (6.0, 48)


@pytest.mark.parametrize(
    ("contact", "constants"),
    [("balanced", {"kP": 0.0, "tension": 1.0}), ("curved", {"kP": 1.0}), ("radical", {"kP": 1.0})],
)
def test_particles_that_keep_their_area_need_room(
    contact: str, constants: dict[str, float]
) -> None:
    """They fill the plane at phi = 1: no forces balance there, and beyond they have no shape."""
    law = ld.Ring(kA=np.inf, contact=contact, **constants)
    for phi, refused in ((0.99, False), (1.0 + 1e-9, True), (1.1, True)):
        with ld.Simulation(crystal(0.0).at(phi), law) as sim:
            if refused:
                with pytest.raises(ld.LammpsError, match="no shape that keeps its area"):
                    sim.state()
            else:
                assert np.isfinite(sim.state().pressure)


def test_mixtures_of_droplets_need_room() -> None:
    law = ld.Ring(kA=np.inf, kP=0.0, tension=1.0)
    jammed = ld.jam(ld.bidisperse(16, seed=1)).packing
    with ld.Simulation(jammed, law) as sim:
        for phi in (0.95, 0.99, 0.999):
            sim.deform(jammed.at(phi).box)
            assert np.isfinite(sim.relax().pressure)
        sim.deform(jammed.at(1.0).box)
        with pytest.raises(ld.LammpsError, match="no shape that keeps its area"):
            sim.relax()
