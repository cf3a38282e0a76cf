"""Exact shapes of one droplet between planes and of whole packings, on coarse meshes."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.reference import exact_droplets
from lammps_deformable.reference.exact_droplets import ExactPacking, exact_packing, osmotic, shape

DATA = Path(__file__).parents[1] / "data"
CAGES = {
    cage["name"]: cage for cage in json.loads((DATA / "droplet_cages.json").read_text())["cages"]
}
PACKINGS = {
    each["name"]: each
    for each in json.loads((DATA / "droplet_packings.json").read_text())["packings"]
}


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_droplets, "ALONE", (200, 1))
    monkeypatch.setattr(exact_droplets, "PACKED", (200, 1))
    monkeypatch.setattr(exact_droplets, "SMALL", 0)


@pytest.mark.parametrize("name", ["plates_0.05", "mono_1_0.74_16"])
def test_another_program_finds_the_same(name: str, coarse: None) -> None:
    cage = CAGES[name]
    found = shape(cage["normals"], cage["a"])
    mean = np.mean(cage["f"])
    np.testing.assert_allclose(found.forces, cage["f"], atol=4e-3 * mean)
    assert found.pressure == pytest.approx(cage["pressure"], abs=1e-4)
    assert found.energy == pytest.approx(cage["energy"], rel=2e-3)
    assert found.energy_error < 5e-3 * found.energy
    assert found.force_error < 0.02 * mean


def stored(name: str) -> ld.State:
    """A packing of which another program has found the exact shapes, at rest with the law."""
    packing = PACKINGS[name]
    start = ld.Packing(packing["law"]["x"], packing["radius"], (packing["box"],) * 3)
    with ld.Simulation(start, ld.Droplet()) as sim:
        return sim.relax(1e-10)


def errors(name: str, state: ld.State, exact: ExactPacking) -> tuple[float, float, float]:
    """Of energy, pressure, and the largest of a force over their mean, as the other program."""
    packing = PACKINGS[name]
    box, other = packing["box"], packing["exact"]
    moved = np.rint((state.packing.positions - packing["law"]["x"]) / box).astype(int)
    images = exact.image + moved[exact.j] - moved[exact.i]
    forces: dict[tuple[int, ...], float] = {}
    for i, j, image, force in zip(exact.i, exact.j, images, exact.found.forces, strict=True):
        forces[(i, j, *image)] = forces[(j, i, *-image)] = force
    rows = other["contacts"]
    known = np.array([row[5] for row in rows])
    off = [forces.pop(tuple(map(int, row[:5]))) - row[5] for row in rows]
    energy = exact.found.energies.sum() / other["energy"] - 1.0
    pressure = osmotic(state, exact.found) / other["pressure"] - 1.0
    return abs(energy), abs(pressure), float(np.abs(off).max() / known.mean())


@pytest.mark.slow
def test_a_crystal(coarse: None) -> None:
    """Has the shapes of one droplet between planes, and a contact that is not told is found."""
    with ld.Simulation(ld.crystal("fcc", 1, phi=0.79), ld.Droplet(tension=2.0)) as sim:
        state = sim.relax()
    table = state.contacts
    first = (table["i"] + table["j"] == 1) & (np.abs(table["image"]).sum(axis=1) == 0)
    table = table[~first]
    start: Any = SimpleNamespace(packing=state.packing, law=state.law, contacts=table)
    exact, radius = exact_packing(start), state.packing.radii[0]
    touch = exact.found.forces > 0.0
    assert touch.sum() == 24
    around = state.contacts[state.contacts["i"] == 0]
    single = shape(around["normal"], 1.0 - around["distance"] / (2.0 * radius))
    np.testing.assert_allclose(exact.found.pressures * radius / 2.0, single.pressure, rtol=2e-4)
    np.testing.assert_allclose(exact.found.energies / (2.0 * radius**2), single.energy, rtol=2e-2)
    forces = exact.found.forces[touch] / (2.0 * radius)
    np.testing.assert_allclose(forces, single.forces.mean(), rtol=2e-2)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["8_1.4_1_0.78", "12_1.4_4_0.74", "10_1_5_0.85"])
def test_packings(name: str) -> None:
    """To what the extrapolations are uncertain by, too."""
    state = stored(name)
    exact = exact_packing(state)
    energy, pressure, force = errors(name, state, exact)
    found, levels = exact.found, [osmotic(state, level) for level in exact.levels]
    before, last = ((4.0 * levels[k] - levels[k - 1]) / 3.0 for k in (-2, -1))
    assert energy < 3e-4
    assert pressure < 6e-4 + abs(last / before - 1.0)
    assert force < 5e-3 + found.force_error / found.forces[found.forces > 0.0].mean()


def test_films_in_space(coarse: None) -> None:
    """Energies of a droplet behind films that turn and bend: forces and stiffnesses are exact."""
    cage = CAGES["mono_1_0.74_16"]
    normals, heights = np.array(cage["normals"]), 1.0 - np.array(cage["a"])
    count, random = len(heights), np.random.default_rng(1)
    none = np.full(count, -1)
    films = exact_droplets._Films(np.zeros(count, int), none, normals, heights, heights)
    films.numbers[:, 1:3] += 0.01 * random.normal(size=(count, 2))
    films.numbers[:, 3:] += 0.05 * random.normal(size=(count, 3))
    mesh = exact_droplets._Mesh.of(exact_droplets.spiral(1000))
    numbers = films.numbers.copy()

    def at(change: Any) -> Any:
        drop = exact_droplets._Drop(mesh, 1.0)
        films.numbers = numbers + change
        drop.settle(*films.seen(*films.of(0)))
        return drop

    drop = at(0.0)
    stiffness, step = drop.stiffness(), 1e-6
    for k in range(12):
        change = np.zeros(numbers.size)
        change[k] = step
        more, less = at(change.reshape(-1, 6)), at(-change.reshape(-1, 6))
        force = (less.area - more.area) / (2.0 * step)
        assert drop.forces()[k] == pytest.approx(force, rel=1e-3, abs=1e-8)
        of_forces = (less.forces() - more.forces()) / (2.0 * step)
        np.testing.assert_allclose(
            stiffness[k], of_forces, rtol=0, atol=2e-3 * abs(of_forces).max()
        )


@pytest.mark.slow
def test_forces_are_derivatives_of_the_energy() -> None:
    """And the shape knows no direction."""
    normals = np.array([(1.0, 0.0, 0.0), (-0.6, 0.8, 0.0), (-0.6, -0.8, 0.0)])
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    a, step = np.array([0.06, 0.05, 0.04]), 0.01
    middle = shape(normals, a)
    turned = shape(normals @ turn.T, a)
    np.testing.assert_allclose(turned.forces, middle.forces, rtol=3e-3)
    change = shape(normals, a + step).energy - shape(normals, a - step).energy
    assert change / (2.0 * step) == pytest.approx(middle.forces.sum(), rel=1e-2)


def test_bad_input() -> None:
    with pytest.raises(ValueError, match=r"planes must be beyond the origin, .* not 1.5"):
        shape([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)], [1.5, -2.0])
    disks: Any = SimpleNamespace(packing=ld.bidisperse(4, seed=1), law=ld.Ring())
    with pytest.raises(ValueError, match="droplets of one tension, and no walls"):
        exact_packing(disks)


def test_no_shape(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_droplets, "_ITERATIONS", 1)
    with pytest.raises(ArithmeticError, match="no shape was found in 1 iterations"):
        shape([(0.0, 0.0, 1.0)], [0.1])


def test_errors_in_space(coarse: None) -> None:
    """Of droplets and soft spheres against exact shapes, in their units."""
    start = ld.crystal("bcc", 1, phi=0.75)
    compared = ld.compare(start, law=ld.Droplet(tension=2.0), strain=0.02, steps=1, workers=1)
    methods = [row["method"] for row in compared.rows]
    assert methods == ["sphere", "droplet", "elements", "elements", "elements", "reference"]
    table = compared.table()
    energy, area, seconds = (table[name] for name in ("energy_error", "area_error", "seconds"))
    assert energy[0] < 1e-9  # all contacts are alike, and the stiffness is fitted
    assert energy[1] < 0.01
    assert area[1] < 0.01
    assert energy[2] > energy[3] > energy[4] > 3.0 * compared.rows[-1]["limit_error"]
    assert energy[-1] == 0.0
    assert (np.diff(seconds[2:]) >= 0.0).all()
    assert seconds[2] > seconds[1] > 0.0
    pytest.importorskip("matplotlib")
    assert "finite elements" in [text.get_text() for text in compared.plot().get_legend().texts]
    for wrong, told in (
        (ld.Ring(), "law must be of the kind Droplet"),
        (ld.Droplet(tension=(1.0, 2.0)), "one tension"),
    ):
        with pytest.raises(ld.ParameterError, match=told):
            ld.compare(start, law=wrong)


def test_a_loose_droplet_is_a_ball() -> None:
    """As rattlers are: no film holds it."""
    drop = exact_droplets._Drop(exact_droplets._Mesh.of(exact_droplets.spiral(300)), 0.5)
    drop.settle(np.empty((0, 3, 3)), np.empty((0, 6)))
    assert drop.area == pytest.approx(np.pi, rel=0.02)
    assert drop.pressure == pytest.approx(4.0, rel=0.02)
    assert np.ptp(np.exp(drop.rho)) < 0.01
    assert drop.forces().size == drop.nodes_on_films().size == drop.stiffness().size == 0
