"""What Python prints of packings, laws, simulations and states: one line."""

import lammps_deformable as ld
import pytest


def test_packing() -> None:
    straight = ld.bidisperse(32, phi=0.3, seed=1)
    side = straight.box[0, 0]
    expected = f"<Packing: 32 particles of 2 species, phi = 0.3000, box {side:.4g} x {side:.4g}"
    assert repr(straight) == f"{expected}, seed 1>"
    assert repr(straight.replace(seed=None)) == f"{expected}>"
    tilted = ld.bidisperse(32, tilt=-0.25, seed=1)
    assert repr(tilted).endswith(f" tilted by {-0.25 * side:.4g}, seed 1>")


@pytest.mark.parametrize(
    ("law", "text"),
    [
        (ld.Ring(kA=2, contact="radical"), "Ring(kA=2.0, contact='radical')"),
        (ld.Ring(kA=[1, 2], kP=5), "Ring(kA=(1.0, 2.0), kP=5.0)"),
    ],
)
def test_a_law_is_the_call_that_makes_it(law: object, text: str) -> None:
    assert repr(law) == text
    assert eval(text, {"Ring": ld.Ring, "Sector": ld.Sector}) == law


def test_simulation_and_its_states(jammed: ld.Packing) -> None:
    (lx, _), (_, ly) = jammed.box
    with ld.Simulation(jammed, ld.Ring(kP=3.0)) as sim:
        text = f"<Simulation: 32 particles, law Ring(kP=3.0), box {lx:.4g} x {ly:.4g}>"
        assert repr(sim) == text
        state = sim.relax()
    assert repr(sim) == "<Simulation: closed>"
    numbers = (
        f"phi = {state.phi:.4f}, pressure = {state.pressure:.3g}, z = {state.coordination:.2f}"
    )
    assert repr(state) == f"<State: 32 particles, law Ring(kP=3.0), {numbers}>"


def test_other_states(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.SoftContact()) as disks:
        assert repr(disks.state()).startswith("<State: 32 particles, law SoftContact(), phi = 0.8")
    with ld.Simulation(ld.crystal("fcc", 2, phi=0.8), ld.SoftContact()) as spheres:
        side = f"{spheres.box[0, 0]:.4g}"
        assert (
            repr(spheres)
            == f"<Simulation: 32 particles, law SoftContact(), box {side} x {side} x {side}>"
        )
    assert repr(spheres) == "<Simulation: closed>"
    few = ld.jam(ld.bidisperse(8, seed=1)).packing
    with ld.Simulation(few, ld.DeformablePolygon(20, smooth=False)) as sim:
        assert repr(sim.state()).startswith("<State: 8 particles, law DeformablePolygon(")
