"""Relaxation at a pressure, with a box that is free to change."""

import math
from typing import TYPE_CHECKING, Any

import lammps_deformable as ld
import numpy as np
import pytest
from contact_laws import simulate
from lammps_deformable.engine import free_box
from numpy.typing import NDArray
from refusals import refused

if TYPE_CHECKING:
    from collections.abc import Callable

DROPLETS = ld.Ring(kA=math.inf, kP=0.0, tension=1.0)

# Pressures at which packings of 32 are far enough from the onset to rearrange little.
KINDS: dict[str, tuple[ld.Ring | None, float]] = {
    "disks": (None, 1e-2),
    "balanced": (ld.Ring(), 1e-3),
    "curved": (ld.Ring(contact="curved"), 1e-3),
    "radical": (ld.Ring(contact="radical"), 1e-3),
    "soft": (ld.Ring(kA=1.0, kP=5.0), 1e-3),
    "droplets": (DROPLETS, 3e-2),
}
some_kinds = pytest.mark.parametrize("kind", ["disks", "droplets"])


def excess(state: Any, pressure: float) -> NDArray[np.float64]:
    return state.pressure_tensor / pressure - np.eye(2)


@pytest.mark.parametrize(
    ("kind", "free"),
    [
        ("disks", "iso"),
        ("balanced", "aniso"),
        ("curved", "tri"),
        ("radical", "iso"),
        ("soft", "aniso"),
        ("droplets", "tri"),
    ],
)
def test_the_stress_is_the_pressure_where_the_box_is_free(
    jammed: ld.Packing, kind: str, free: str
) -> None:
    law, pressure = KINDS[kind]
    with simulate(jammed, law) as sim:
        state = sim.relax(pressure=pressure, free=free)
        again = sim.state()
    assert state.converged
    assert state.residual <= 1e-6
    assert state.pressure == pytest.approx(pressure, rel=1e-6)
    assert again.pressure == pytest.approx(pressure, rel=1e-6)
    left = excess(state, pressure)
    balanced = {"iso": [np.trace(left) / 2.0], "aniso": left.diagonal(), "tri": left}[free]
    assert np.abs(balanced).max() <= 1e-6
    tilt = (state.packing.box[1, 0] - jammed.box[1, 0]) / state.packing.box[1, 1]
    aspect = state.packing.box[1, 1] / state.packing.box[0, 0]
    assert (abs(tilt) > 1e-6) == (free == "tri")
    assert (abs(aspect - jammed.box[1, 1] / jammed.box[0, 0]) > 1e-6) == (free != "iso")


def test_packings_come_to_rest_in_few_relaxations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Down to a low pressure, where many contacts change on the way."""
    count = 0

    def counted(self: ld.Simulation, *given: Any, **named: Any) -> ld.State:
        nonlocal count
        count += 1
        return relax(self, *given, **named)

    relax = ld.Simulation._relaxed
    monkeypatch.setattr(ld.Simulation, "_relaxed", counted)
    with ld.Simulation(ld.jam(ld.bidisperse(32, seed=1)).packing, ld.SoftContact()) as disks:
        for pressure in (1e-2, 1e-3, 1e-4):
            count = 0
            state = disks.relax(pressure=pressure, free="tri")
            assert np.abs(excess(state, pressure)).max() <= 1e-6
            assert count < free_box._BOX_RELAXATIONS / 2


@some_kinds
def test_the_enthalpy_is_least(jammed: ld.Packing, kind: str) -> None:
    """Any small strain of the box raises E + p A of the relaxed packing."""
    law, pressure = KINDS[kind]

    def enthalpy(state: Any) -> float:
        return float(state.energy + pressure * state.packing.volume)

    with simulate(jammed, law) as sim:
        rest = sim.relax(1e-8, pressure=pressure, free="tri")
    box, size = rest.packing.box, 1e-4
    for xx, yy, xy in ((1, 1, 0), (1, -1, 0), (0, 0, 1), (1, 0, 1), (1, 1, -1)):
        for sign in (size, -size):
            strain = np.array([[1.0 + sign * xx, 0.0], [sign * xy, 1.0 + sign * yy]])
            with simulate(rest.packing, law) as sim:
                sim.deform(box @ strain)
                assert enthalpy(sim.relax(1e-8)) > enthalpy(rest)


def by_lammps(start: ld.Packing, law: ld.Ring | None, pressure: float) -> Any:
    """Conjugate gradients of centers and box together, by LAMMPS' fix box/relax."""
    free = f"x {pressure!r} y {pressure!r} xy 0.0 couple none vmax 1e-4"
    with simulate(start, law) as sim:
        for _ in range(20):  # its strains count from where a minimization begins
            for command in (
                f"fix free all box/relax {free}",
                "min_style cg",
                "minimize 0 1e-15 1000 10000",
                "unfix free",
            ):
                sim.lmp.command(command)
            state = sim.state()
            if np.abs(excess(state, pressure)).max() <= 1e-6 and state.residual <= 1e-6:
                return state
    raise AssertionError(excess(state, pressure))


@some_kinds
def test_fix_box_relax_comes_to_the_same_packing(jammed: ld.Packing, kind: str) -> None:
    """From a packing a strain of 1e-4 away, so that neither route leads to another one."""
    law, pressure = KINDS[kind]
    with simulate(jammed, law) as sim:
        rest = sim.relax(pressure=pressure, free="tri")
    sim = simulate(rest.packing, law)
    sim.deform(rest.packing.box @ np.array([[1.0 - 1e-4, 0.0], [2e-4, 1.0 + 5e-5]]))
    start = sim.state().packing
    own = sim.relax(1e-8, pressure=pressure, free="tri")
    sim.close()
    other = by_lammps(start, law, pressure)
    assert np.abs(excess(rest, pressure)).max() <= 1e-6
    # both stresses are right to 1e-6 of p, and strains to that over the moduli, which exceed p
    assert own.packing.box == pytest.approx(other.packing.box, rel=1e-5, abs=1e-5)
    assert own.energy == pytest.approx(other.energy, rel=1e-4)
    assert own.coordination == other.coordination


def test_walls_are_scaled_with_the_box() -> None:
    scene = [ld.BoxWall((8, 7)), ld.Sphere(1.0, (3, 3), inside=False)]
    start = ld.bidisperse(24, seed=1).between(scene).at(0.75).push_off()
    for sim in (ld.Simulation(start, ld.Ring()), ld.Simulation(start, ld.SoftContact())):
        with sim:
            state = sim.relax(1e-5, pressure=1e-3)
            assert state.pressure == pytest.approx(1e-3, rel=1e-6)
            scale = state.packing.box[0, 0] / start.box[0, 0]
            assert sim.walls[-1].radius == pytest.approx(scale * start.walls[-1].radius)
            with pytest.raises(ld.ParameterError, match="free='tri' is not for walls"):
                sim.relax(pressure=1e-3, free="tri")


def test_particles_that_stick() -> None:
    sticky = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved", adhesion=0.2)
    start = ld.bidisperse(16, phi=0.9, seed=1).push_off()
    with ld.Simulation(start, sticky) as sim:
        state = sim.relax(1e-5, pressure=0.03, free="tri")
    assert np.abs(excess(state, 0.03)).max() <= 1e-6


@pytest.mark.parametrize("dimension", [2, 3])
def test_particles_that_stick_rest_without_pressure(dimension: int) -> None:
    """Films pull the box together until its stress is 0, from pressures of either sign."""
    law: ld.Ring | ld.Droplet = ld.Droplet(adhesion=0.1)
    if dimension == 2:
        law = ld.Ring(kA=math.inf, kP=0.0, tension=1.0, contact="curved", adhesion=0.1)
    start = ld.jam(ld.bidisperse(24, dimension=dimension, seed=1), ld.SoftContact()).packing
    unit = 1e-6 / start.radii.mean()
    found = []
    for phi in (start.phi + 0.01, start.phi + 0.1):
        with ld.Simulation(start.at(phi), law) as sim:
            begin = sim.relax(1e-5)
            if not found:
                state = sim.compress(pressure=0.0, steps=2, tolerance=1e-5)[-1]
            else:
                state = sim.relax(1e-5, pressure=0.0)
            found.append(begin.pressure)
            assert abs(state.pressure) <= 2.0 * unit
            assert state.energy < begin.energy
            state = sim.relax(1e-5, pressure=0.0, free="tri")
            assert np.abs(state.pressure_tensor).max() <= 2.0 * unit
    assert min(found) < -100.0 * unit


def test_nonsense_is_refused(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, ld.Ring()) as sim:
        for given, message in (
            ({"pressure": 0.0}, "pressure must be a positive number, not 0.0"),
            ({"pressure": 1e-3, "free": "area"}, "free must be iso, aniso or tri, not 'area'"),
            ({"pressure": 1e-3, "free": np.eye(2)}, "free must be iso, aniso or tri"),
            ({"free": "tri"}, "free='tri' needs a pressure"),
        ):
            with refused(message):
                sim.relax(**given)
            assert sim.box == pytest.approx(jammed.box)  # nothing has moved


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("law", "free"), [(ld.Ring(), "iso"), (DROPLETS, "tri")], ids=["ring", "droplets"]
)
def test_a_pressure_beyond_the_law_is_told_with_what_was_reached(
    jammed: ld.Packing, law: ld.Ring, free: str
) -> None:
    told = r"pressure = 50 was not reached, but [\d.]+ at phi = 0\.\d+: LAMMPS: "
    with (
        ld.Simulation(jammed, law) as sim,
        pytest.raises(ld.ParameterError, match=told),
    ):
        sim.relax(1e-3, pressure=50.0, free=free)


def test_a_search_that_does_not_end_is_told_with_what_was_reached(
    jammed: ld.Packing, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(free_box, "_BOX_RELAXATIONS", 2)
    told = r"the largest difference is 0\.\d+ of it at phi = 0\.\d+: 2 relaxations were not"
    with (
        ld.Simulation(jammed, ld.SoftContact()) as disks,
        pytest.raises(ld.ParameterError, match=told),
    ):
        disks.relax(pressure=1e-3, free="tri")


@pytest.mark.filterwarnings("ignore::lammps_deformable.StalledWarning")
def test_sectors_whose_energy_jumps_have_no_pressure_to_reach() -> None:
    few = ld.jam(ld.bidisperse(8, seed=1)).packing
    with (
        ld.Simulation(few, ld.Sector()) as sim,
        pytest.raises(ld.ParameterError, match="relaxations in a row stalled"),
    ):
        sim.relax(pressure=1e-3)


def test_warnings_are_those_of_the_last_relaxation(jammed: ld.Packing) -> None:
    """On the way to a high pressure particles go beyond the model several times."""
    with (
        ld.Simulation(jammed, ld.Ring()) as sim,
        pytest.warns(ld.BeyondModelWarning) as told,
    ):
        state = sim.relax(pressure=0.15)
    assert len(told) == 1
    assert str(told[0].message).startswith(f"{state.beyond} of 32 particles")


def test_the_first_step_is_downhill(jammed: ld.Packing) -> None:
    """A matrix that is not positive definite would lead to saddles."""
    with ld.Simulation(jammed.at(jammed.phi + 0.01), ld.SoftContact()) as disks:
        state = disks.relax()
    for free in (2, 3):
        inverse, step = free_box._first_inverse(state, state.pressure, free)
        assert np.linalg.eigvalsh(inverse).min() > 0.0
        assert step > 0.0
        strain = np.array([1e-3, -2e-3, 3e-3][:free])
        stiffer: Callable[..., Any] = free_box._updated
        updated = stiffer(inverse, strain, 5.0 * strain)
        assert updated @ (5.0 * strain) == pytest.approx(strain)  # the secant condition
        assert stiffer(inverse, strain, -strain) is inverse  # no curvature of a stable packing
