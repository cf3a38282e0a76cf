"""Creep under a constant shear stress, compared with quasistatic shear."""

import lammps_deformable as ld
import numpy as np
import pytest
from refusals import refused


@pytest.fixture(scope="module")
def rest() -> ld.State:
    packing = ld.jam(ld.bidisperse(16, seed=2)).packing
    with ld.Simulation(packing.at(packing.phi + 0.08), ld.Ring()) as sim:
        return sim.relax(1e-10)


@pytest.mark.parametrize(("sign", "viscosity"), [(1.0, None), (-1.0, 2.0)])
def test_it_ends_where_quasistatic_shear_has_the_stress(
    rest: ld.State, sign: float, viscosity: float | None
) -> None:
    modulus = rest.moduli().shear_modulus
    stress = -rest.pressure_tensor[0, 1] + sign * 1e-3 * modulus
    time = 25.0 * (viscosity or 1.0) / modulus  # a solid alone takes viscosity/modulus
    with ld.Simulation(rest, rest.law) as sim:
        *_, before, last = sim.creep(stress, time=time, steps=8, drag=1.0, viscosity=viscosity)[1:]
    assert last.time == pytest.approx(time)
    assert -last.pressure_tensor[0, 1] == pytest.approx(stress, rel=1e-4)
    assert last.shear_strain == pytest.approx(before.shear_strain, rel=1e-4)
    assert 0.5e-3 < sign * last.shear_strain < 2e-3
    with ld.Simulation(rest, rest.law) as sim:
        still = sim.shear(last.shear_strain, steps=2, tolerance=1e-9)[-1]
    assert -still.pressure_tensor[0, 1] == pytest.approx(stress, rel=1e-4)
    assert last.energy == pytest.approx(still.energy, rel=1e-6)
    assert not last.velocities.any()


def test_the_box_moves_by_the_stress_that_contacts_do_not_bear(rest: ld.State) -> None:
    """d(strain)/dt = (stress - sigma)/viscosity, by the trapezium rule."""
    stress, viscosity = 1e-4, 3.0
    with ld.Simulation(rest, rest.law) as sim:
        states = sim.creep(stress, time=1500.0, steps=150, drag=1.0, viscosity=viscosity)
    rate = np.array([stress + state.pressure_tensor[0, 1] for state in states]) / viscosity
    strain = np.trapezoid(rate, [state.time for state in states])
    assert states[-1].shear_strain - states[0].shear_strain == pytest.approx(strain, rel=2e-3)


def test_a_large_stress_makes_it_flow_through_flips(rest: ld.State) -> None:
    """Free of contacts, the rate is stress/viscosity; the box is one of the strain."""
    with ld.Simulation(rest.packing.at(0.3), rest.law) as sim:
        start = sim.relax().packing
        (lx, _), (tilt, ly) = start.box
        states = sim.creep(1e-3, time=1200.0, steps=3, drag=1.0)[1:]
        assert sim.shear_strain == states[-1].shear_strain
    assert states[-1].shear_strain == pytest.approx(1.2, rel=0.1)
    for state in states:
        turns = (tilt + state.shear_strain * ly - state.packing.box[1, 0]) / lx
        assert turns == pytest.approx(round(turns), abs=1e-9)


def test_refusals(rest: ld.State) -> None:
    for values, message in (
        ({"shear_stress": np.nan}, "shear_stress must be a finite number, not nan"),
        ({"drag": 0.0}, "need a drag above 0"),
        ({"drag": None}, "a flow needs the drag of particles"),
        ({"viscosity": 0.0}, "viscosity must be a positive number, not 0"),
        ({"timestep": 1e9}, "timestep = .* take at most"),
    ):
        usual = {"shear_stress": 1e-6, "time": 1e12, "steps": 1, "drag": 1.0}
        with (
            ld.Simulation(rest, rest.law) as sim,
            refused(message),
        ):
            sim.creep(**usual | values)


def test_refused_simulations(rest: ld.State) -> None:
    with (
        ld.Simulation(rest.packing, ld.SoftContact()) as disks,
        pytest.raises(ld.ParameterError, match="sheared without a rate only: take Ring"),
    ):
        disks.creep(1e-6, time=1.0, steps=1, drag=1.0)
    with (
        ld.Simulation(rest.packing, ld.Sector()) as sim,
        pytest.raises(ld.ParameterError, match="energy of Sector jumps"),
    ):
        sim.creep(1e-6, time=1.0, steps=1, drag=1.0)
    loose = rest.packing.at(0.3)
    with ld.Simulation(loose, ld.Ring()) as sim:
        sim.relax()
        with pytest.raises(ld.ParameterError, match="shear_stress must not be 0 in a packing"):
            sim.creep(0.0, time=1.0, steps=1, drag=1.0)
