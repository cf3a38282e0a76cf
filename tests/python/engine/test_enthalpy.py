"""Soft disks and spheres without LAMMPS: near pairs, energy, pressure, gradient, preconditioner."""

from itertools import product

import lammps_deformable as ld
import numpy as np
import pytest
from contact_laws import simulate
from lammps_deformable.engine.soft_disks import Enthalpy, minimize, relax_at_pressure
from lammps_deformable.particles.containers import closed
from lammps_deformable.particles.neighbors import near_pairs

SCENE = (ld.Sphere(4, (0, 0)), ld.Sphere(0.6, (1, 0.5), inside=False))
BELOW = (ld.Plane((0, -9), (0, 1)), ld.Plane((0, -4), (0, -1)))
BALLS = (ld.Sphere(2, (1, 2, 3)), ld.Sphere(0.4, (1, 2, 2.5), inside=False))


def in_box(box: tuple[tuple[float, ...], ...]) -> ld.Packing:
    """Spheres of any sizes at random places in a tilted box."""
    rng = np.random.default_rng(4)
    places, radii = rng.random((10, 3)) @ np.array(box), rng.uniform(0.3, 0.5, 10)
    return ld.Packing(places, radii, box)


PACKINGS = {
    "tilted": ld.bidisperse(30, phi=0.95, tilt=-0.7, seed=2),
    "one": ld.bidisperse(1, phi=0.9, tilt=0.3, seed=1),
    "sizes": ld.polydisperse(20, np.linspace(0.1, 1.0, 20), phi=0.95, tilt=2.2, seed=1),
    "circle": ld.bidisperse(40, seed=1).between(SCENE),
    "channel elsewhere": ld.bidisperse(40, phi=0.9, seed=2).between(BELOW),
    "tube": ld.bidisperse(40, dimension=3, seed=1).between(ld.Cylinder(2, "z", (0, 0, 0))),
    "sphere": ld.bidisperse(30, dimension=3, seed=1).between(BALLS),
    "leaning": in_box(((1.6, 0.0, 0.0), (0.9, 1.9, 0.0), (-0.7, 1.2, 1.7))),
}


def strayed(packing: ld.Packing) -> ld.Packing:
    """The same packing, with some particles in other periodic images."""
    if packing.walls:
        return packing
    cells = np.random.default_rng(1).integers(-2, 3, packing.positions.shape)
    return packing.replace(positions=packing.positions + cells @ packing.box)


def test_near_pairs_are_all_pairs() -> None:
    """Against a search through all images."""
    for name, packing in PACKINGS.items():
        packing, skin = strayed(packing), 0.2
        i, j, shift = near_pairs(packing, skin)
        apart = packing.positions[j] + shift - packing.positions[i]
        distance = np.linalg.norm(apart, axis=1)
        assert (distance < packing.radii[i] + packing.radii[j] + skin).all()
        x = packing.positions
        shut = closed(packing.walls, packing.dimension)
        farthest = 12 if packing.dimension == 2 else 8
        spans = [range(1) if closed else range(-farthest, farthest + 1) for closed in shut]
        steps = np.array(list(product(*spans))) @ packing.box
        all_distances = np.linalg.norm((x[:, None] - x)[:, :, None] + steps, axis=-1)
        near = all_distances < (packing.radii[:, None] + packing.radii)[..., None] + skin
        assert 2 * len(i) == near.sum() - len(packing), name  # but itself


def test_energy_and_pressure_are_those_of_disks_in_lammps() -> None:
    for name, packing in PACKINGS.items():
        enthalpy = Enthalpy(strayed(packing), None)
        energy, gradient = enthalpy(enthalpy.start)
        with simulate(packing) as disks:
            state = disks.state()
            forces = np.array(disks.lmp.gather("f", 1, 3)).reshape(-1, 3)[:, : packing.dimension]
        assert energy == pytest.approx(state.energy, rel=1e-12), name
        assert enthalpy.pressure == pytest.approx(state.pressure, rel=1e-12)
        assert gradient[:-1].reshape(forces.shape) == pytest.approx(-forces, abs=1e-12)


def test_gradient_is_that_of_finite_differences() -> None:
    for name, packing in PACKINGS.items():
        enthalpy = Enthalpy(packing, 0.1)
        rng, step = np.random.default_rng(3), 1e-5
        z = enthalpy.start + np.append(np.zeros(packing.positions.size), 0.3)  # in a larger box
        _, gradient = enthalpy(z)
        for _ in range(4):
            direction = rng.normal(size=len(z))
            (above, _), (below, _) = (enthalpy(z + sign * step * direction) for sign in (1, -1))
            slope = (above - below) / (2 * step)
            assert gradient @ direction == pytest.approx(slope, rel=1e-6), name


@pytest.mark.parametrize("name", ["circle", "tilted"])
def test_preconditioner_is_symmetric_and_follows_the_hessian(name: str) -> None:
    """Contacts count by a half to one, and 5 P is added to stiffnesses of about 1."""
    relaxed = relax_at_pressure(PACKINGS[name], 0.01, 1e-4, 1000, lambda *values: None).packing
    enthalpy = Enthalpy(relaxed, 0.01)
    z, rng = enthalpy.start, np.random.default_rng(5)
    enthalpy(z)
    solve = enthalpy.preconditioner(z)
    one, other = rng.normal(size=(2, len(z)))
    # in single precision
    assert solve(one) @ other == pytest.approx(solve(other) @ one, rel=1e-5)
    assert solve(one) @ one > 0.0
    small = 1e-7
    hessian = (enthalpy(z + small * one)[1] - enthalpy(z - small * one)[1]) / (2 * small)
    assert 0.5 < solve(hessian) @ hessian / (one @ hessian) < 2.0


def test_list_of_pairs_follows_large_steps() -> None:
    """Steps of any size give the energy of a new list."""
    packing = PACKINGS["leaning"]
    enthalpy, rng = Enthalpy(packing, 0.1), np.random.default_rng(6)
    z = enthalpy.start
    for size in (1e-3, 1e-2, 0.1, 1.0):
        z = z + size * rng.normal(size=len(z))
        fresh = Enthalpy(packing, 0.1)
        assert enthalpy(z)[0] == pytest.approx(fresh(z)[0], rel=1e-12)
        there = enthalpy.packing(z)
        with simulate(there) as disks:
            assert disks.state().pressure == pytest.approx(enthalpy.pressure, rel=1e-9)


@pytest.mark.parametrize("name", ["tilted", "sphere"])
def test_relaxation_at_a_pressure(name: str) -> None:
    """The box keeps its shape, and has the pressure."""
    packing = PACKINGS[name]
    found = relax_at_pressure(packing, 0.01, 1e-8, 4000, lambda *values: None)
    assert found.converged
    with simulate(found.packing) as disks:
        state = disks.state()
    assert [state.pressure, found.pressure] == pytest.approx([0.01, 0.01], rel=1e-6)
    assert state.residual < 1e-6
    assert found.packing.box / found.packing.box[0, 0] == pytest.approx(
        packing.box / packing.box[0, 0], rel=1e-12
    )


@pytest.mark.parametrize("offset", [1.0, -1.0])
def test_a_minimizer_knows_rounding_of_any_sign(offset: float) -> None:
    """Where rounding hides that the value falls, the slope tells: a potential may be negative."""
    stiffness = np.array([1.0, 3.0, 10.0])

    def function(z: np.ndarray) -> tuple[float, np.ndarray]:
        rounding = 1e-13 * np.cos(1e12 * z.sum())
        return offset + 0.5 * float(stiffness @ z**2) + rounding, stiffness * z

    def relaxed(gradient: np.ndarray) -> bool:
        return float(np.abs(gradient).max()) < 1e-12

    z, found = minimize(function, np.full(3, 1e-6), relaxed, 1.0, 200)
    assert found
    assert np.abs(z).max() < 1e-12
