"""Radii that relax with the centers."""

import math
import warnings

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.breathing import Radii
from lammps_deformable.state.derivatives import Derivatives
from lammps_deformable.state.law_terms import terms_of
from ranks import python

SPREAD = np.linspace(0.4, 0.6, 12)
CIRCLE = (ld.Sphere(2.6, (0, 0)),)


def start_of(dimension=2, walls=()):
    """Compressed disks or spheres of any sizes."""
    loose = ld.polydisperse(12, SPREAD, dimension=dimension, seed=3)
    if walls:
        loose = loose.between(walls, seed=1)
    jammed = ld.jam(loose).packing
    return jammed.at(jammed.phi + 0.06)


SCENES = {
    "soft": (ld.SoftContact(1.0), {}, None),
    "balanced": (ld.Ring(kA=1.0), {}, None),
    "curved": (ld.Ring(math.inf, kP=0.0, tension=0.1, contact="curved"), {}, None),
    "walls": (ld.Ring(kA=1.0, kP=0.1), {"walls": CIRCLE}, None),
    "gravity": (ld.Ring(kA=1.0, kP=0.1), {"walls": CIRCLE}, (0.0, -1e-5)),
    "droplets": (ld.Droplet(), {"dimension": 3}, None),
}


@pytest.mark.parametrize("name", SCENES)
def test_the_energy_is_least_among_radii_with_the_same_sums(name: str) -> None:
    law, place, gravity = SCENES[name]
    stiffness, moments = 0.05, (1.0, -3.0)
    with ld.Simulation(start_of(**place), law, gravity=gravity) as sim:
        before = sim.relax(1e-9)
        after = sim.relax(1e-7, vary="radii", stiffness=stiffness, moments=moments)
        assert after.converged
        assert after.residual <= 1e-7
        for power in (*moments, after.dimension):
            np.testing.assert_allclose(
                np.sum(after.radii**power), np.sum(before.radii**power), rtol=1e-11
            )
        assert after.packing.phi == pytest.approx(before.packing.phi, rel=1e-11)
        assert after.energy < before.energy
        assert np.abs(after.radii - before.radii).max() > 1e-4

        def total(given):
            sim.reset(after.packing.replace(radii=given))
            state = sim.relax(1e-9)
            return state.energy + 0.5 * stiffness * np.sum((given - before.radii) ** 2)

        rng = np.random.default_rng(1)
        radii = Radii(after.radii, after.dimension, moments)
        least = total(after.radii)
        change = 1e-4 * rng.normal(size=len(SPREAD))
        both = [radii.at(radii.start + sign * change) for sign in (1, -1)]
        higher = [total(found[0]) - least for found in both if found]
        assert min(higher) > 0.0
        assert higher[0] == pytest.approx(higher[1], rel=0.2)  # the slope is zero


def test_stiff_springs_give_linear_response() -> None:
    """R - R0 is minus the slopes, without their parts along sums, over the stiffness."""
    stiffness = 1e3
    with ld.Simulation(start_of(), ld.Ring(kA=1.0)) as sim:
        before = sim.relax(1e-9)
        slopes = Derivatives(terms_of(before), "radii").vjp(energy=1.0)
        after = sim.relax(1e-6, vary="radii", stiffness=stiffness)
    sums = np.stack([np.ones_like(before.radii), before.radii])
    slopes = slopes - sums.T @ np.linalg.solve(sums @ sums.T, sums @ slopes)
    np.testing.assert_allclose(
        stiffness * (after.radii - before.radii), -slopes, atol=1e-3 * np.abs(slopes).max()
    )


def test_derivatives_of_radii_are_those_of_differences() -> None:
    radii = Radii(SPREAD, 2, (-3.0, 1.0))
    rng = np.random.default_rng(2)
    y, weights = radii.start + 0.02 * rng.normal(size=12), rng.normal(size=12)
    found = radii.at(y)
    assert found is not None
    slopes, step = found[1](weights) * radii.length, 1e-6
    for k in range(12):
        change = step * np.eye(12)[k]
        both = [radii.at(y + sign * change) for sign in (1, -1)]
        difference = [weights @ each[0] for each in both if each]
        assert slopes[k] == pytest.approx((difference[0] - difference[1]) / (2 * step), abs=1e-7)
    assert radii.at(-radii.start) is None


def test_free_radii_undo_a_little_compression() -> None:
    loose = ld.polydisperse(32, np.random.default_rng(1).lognormal(-0.7, 0.2, 32), seed=1)
    jammed = ld.jam(loose).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.01), ld.SoftContact()) as sim:
        sim.relax()
        with pytest.warns(ld.UnjammedWarning, match="the packing came apart: with these radii"):
            apart = sim.relax(vary="radii", stiffness=0.0, moments=(-3, 1, 6))
    assert apart.pressure < 1e-9
    with ld.Simulation(ld.bidisperse(8, phi=0.2, seed=1).push_off(), ld.Ring()) as sim:
        nothing = sim.relax(vary="radii", stiffness=0.0)  # where nothing touches
        assert nothing.energy == 0.0


def test_few_steps_are_told() -> None:
    with ld.Simulation(start_of(), ld.Ring()) as sim:
        with pytest.warns(ld.StalledWarning, match="radii stalled: the largest derivative"):
            state = sim.relax(vary="radii", stiffness=0.01, max_steps=1)
        assert not state.converged
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert sim.relax(vary="radii", stiffness=0.01).converged


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"vary": "box", "stiffness": 1.0}, "vary takes 'radii', with a stiffness"),
        ({"vary": "radii"}, "vary takes 'radii', with a stiffness and without a pressure"),
        ({"vary": "radii", "stiffness": 1.0, "pressure": 0.1}, "without a pressure, not vary"),
        ({"stiffness": 1.0}, "stiffness=1.0 is of radii: give vary='radii' too"),
        ({"vary": "radii", "stiffness": -1.0}, "stiffness must not be negative, not -1.0"),
        ({"vary": "radii", "stiffness": 1.0, "moments": (1.0, 0.0)}, "moments must be powers"),
        ({"vary": "radii", "stiffness": 1.0, "moments": "all"}, "moments must be"),
        ({"vary": "radii", "stiffness": 1.0, "tolerance": 0.0}, "tolerance must be a positive"),
        (
            {"vary": "radii", "stiffness": 1.0, "moments": (-3, 1, 6)},
            "4 sums of powers of the radii cannot be kept with 8 particles of 2 different radii",
        ),
    ],
)
def test_refusals(arguments, message: str) -> None:
    packing = ld.bidisperse(8, phi=0.8, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim, pytest.raises(ld.ParameterError, match=message):
        sim.relax(**arguments)


def test_laws_without_derivatives_are_refused() -> None:
    packing = ld.bidisperse(8, phi=0.8, seed=1).push_off()
    refused = [
        (ld.Sector(kA=1.0), {}, "the energy of Sector has no derivatives by radii"),
        (ld.Ring(), {"friction": ld.Friction(0.3, kt=0.01)}, "friction has no energy to vary"),
    ]
    for law, more, told in refused:
        sim = ld.Simulation(packing, law, **more)
        with sim, pytest.raises(ld.ParameterError, match=told):
            sim.relax(vary="radii", stiffness=1.0)


def test_ranks_find_the_same(tmp_path) -> None:
    script = """
from mpi4py import MPI
import lammps_deformable as ld, numpy as np
x, radii, box = (np.load(f"{name}.npy") for name in ("positions", "radii", "box"))
start = ld.Packing(x, radii, box)
with ld.Simulation(start, ld.Ring()) as sim:
    state = sim.relax(1e-8, vary="radii", stiffness=2.0)
assert len(set(MPI.COMM_WORLD.allgather(state.radii.tobytes()))) == 1
if MPI.COMM_WORLD.rank == 0:
    print(*state.radii.tolist())
"""
    with ld.Simulation(start_of(), ld.Ring()) as sim:
        relaxed = sim.relax(1e-8).packing
    for name in ("positions", "radii", "box"):
        np.save(tmp_path / name, getattr(relaxed, name))
    one, two = (np.array(python(script, tmp_path, ranks).split(), float) for ranks in (1, 2))
    np.testing.assert_allclose(one, two, atol=1e-8)
