"""Compression to a packing fraction or a pressure."""

import math

import lammps_deformable as ld
import numpy as np
import pytest
from contact_laws import simulate
from refusals import refused

DROPLETS = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)
KINDS = {"ring": ld.Ring(), "droplets": DROPLETS, "disks": None}


def test_steps_of_phi_are_equal(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, DROPLETS) as sim:
        start = sim.relax().phi
        up = sim.compress(phi=0.87, steps=3)[1:]
        down = sim.compress(phi=0.86, steps=2)[1:]
    expected = [*np.linspace(start, 0.87, 4)[1:], 0.865, 0.86]
    assert [state.phi for state in [*up, *down]] == pytest.approx(expected, rel=1e-9)
    assert all(state.residual <= 1e-6 and state.converged for state in [*up, *down])


@pytest.mark.parametrize("kind", ["ring", "disks"])
def test_steps_of_pressure_are_equal(jammed: ld.Packing, kind: str) -> None:
    with simulate(jammed, KINDS[kind]) as sim:
        start = sim.relax().pressure
        up = sim.compress(pressure=1e-3, steps=3)[1:]
        down = sim.compress(pressure=1e-4, steps=2)[1:]
    expected = [*np.linspace(start, 1e-3, 4)[1:], 5.5e-4, 1e-4]
    # the first step down starts where the last one up has ended
    assert [state.pressure for state in [*up, *down]] == pytest.approx(expected, rel=2e-6)
    assert all(state.residual <= 1e-6 and state.converged for state in [*up, *down])


def test_a_loose_packing_is_compressed_until_it_has_a_pressure() -> None:
    loose = ld.bidisperse(32, phi=0.7, seed=2).push_off()
    with ld.Simulation(loose, DROPLETS) as sim:
        states = sim.compress(pressure=2e-3, steps=2)[1:]
    assert [state.pressure for state in states] == pytest.approx([1e-3, 2e-3], rel=1e-6)


def test_polygons_have_a_target_phi() -> None:
    model = ld.DeformablePolygon(40, radius=0.025, kL=240.0, kr=10.0)
    few = ld.jam(ld.bidisperse(8, seed=1)).packing
    with ld.Simulation(few, model) as polygons:
        (state,) = polygons.compress(phi=0.88)[1:]
        assert state.phi == pytest.approx(0.88, rel=1e-9)
        with pytest.raises(ld.ParameterError, match="polygons have no target pressure"):
            polygons.compress(pressure=1e-3, steps=10)
        with pytest.raises(ld.ParameterError, match="polygons have no target pressure"):
            polygons.relax(pressure=1e-3)


def test_nonsense_is_refused_at_once(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        for given, message in (
            ({}, "give one of strain, phi, pressure, not none of them"),
            ({"strain": 0.01, "phi": 0.9}, "give one of strain, phi, pressure, not strain and phi"),
            ({"phi": -0.9}, "phi must be a positive number, not -0.9"),
            ({"phi": 1.0}, "phi must be below 1, where particles that deform fill .*, not 1.0"),
            ({"pressure": 0.0}, "pressure must be a positive number, not 0.0"),
            ({"phi": 0.9, "steps": 0}, "steps must be at least 1"),
        ):
            with refused(message):
                sim.compress(**given)


@pytest.mark.parametrize(
    ("kind", "name"), [("ring", "pressure"), ("disks", "phi"), ("droplets", "pressure")]
)
def test_a_target_is_reached_once_and_kept(jammed: ld.Packing, kind: str, name: str) -> None:
    """A second call, and a third in steps, take no step."""
    target = {"phi": 0.87, "pressure": 1e-3}[name]
    with simulate(jammed, KINDS[kind]) as sim:
        (once,) = sim.compress(**{name: target})[1:]
        again = sim.compress(**{name: target})
        more = sim.compress(steps=3, **{name: getattr(again[0], name)})
    assert len(again) == len(more) == 1
    for state in (*again, *more):
        assert getattr(state, name) == pytest.approx(target, rel=2e-6)
        assert state.packing.box == pytest.approx(once.packing.box, rel=1e-6)
        assert np.abs(state.displacements(once)).max() < 1e-4


@pytest.mark.filterwarnings("ignore")
def test_a_phi_beyond_the_law_is_told_with_what_was_reached(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, DROPLETS) as sim:
        told = r"phi = 0.9999999 was not reached, but 0\.9\d+ at phi = 0\.9\d+: LAMMPS: "
        with pytest.raises(ld.ParameterError, match=told):
            sim.compress(phi=0.9999999, tolerance=1e-3)


@pytest.mark.filterwarnings("ignore")
def test_a_pressure_beyond_the_law_is_told_as_it_was_given(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, DROPLETS) as sim:
        told = r"^pressure = 60 was not reached: in step 1 of 2, pressure = 30\.\d+ was not reached"
        with pytest.raises(ld.ParameterError, match=told):
            sim.compress(pressure=60.0, steps=2, tolerance=1e-3)


@pytest.mark.filterwarnings("ignore::lammps_deformable.StalledWarning")
def test_sectors_that_conserve_their_area_have_a_target_phi() -> None:
    """Their relaxations stall, but that phi is the one of undeformed disks."""
    few = ld.jam(ld.bidisperse(8, seed=1)).packing
    with ld.Simulation(few, ld.Sector(kP=1.0)) as sim:
        (state,) = sim.compress(phi=few.phi + 0.005)[1:]
    assert state.phi == pytest.approx(few.phi + 0.005, rel=1e-9)
