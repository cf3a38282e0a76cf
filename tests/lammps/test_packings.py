"""Periodic packings: known answers, the kernels on the same geometry, reach, any stiffness."""

import numpy as np
import pytest
from closed_forms import polygon_stiffness
from lammps_deformable import core
from laws import LAWS, RADICAL, direct_laws
from materials import MATERIALS, STIFFNESS, packing, radii_of, species_of
from scene import BOX, PACKINGS, RESULTS, Scene, polygon_walls

packings = pytest.mark.parametrize("case", PACKINGS, ids=range(len(PACKINGS)))


@direct_laws
@packings
def test_known_answers(case, law):
    known = case["ring" if law == "radical" else law]
    state = Scene.packing(case, LAWS[law]).evaluate()
    assert state.energy == pytest.approx(known["energy"], rel=1e-9)
    largest = np.abs(known["force"]).max()
    np.testing.assert_allclose(state.force, known["force"], rtol=0, atol=1e-9 * largest)
    np.testing.assert_allclose(state.shape["area"], known["area"], rtol=1e-9)
    np.testing.assert_allclose(state.virial, known["virial_xx_yy_xy"], rtol=1e-9)


def rows(case, reach):
    """Of each particle: angles and indentations of all nearest images within the reach."""
    x, length, radius = np.array(case["x"]), case["L"], radii_of(case)
    for i in range(len(x)):
        d = x - x[i]
        d -= length * np.round(d / length)
        distance = np.hypot(*d.T)
        near = (distance < (1 + reach) * (radius + radius[i])) & (distance > 0)
        own = np.full(near.sum(), radius[i])
        a = core.contact_line(distance[near], own, radius[near])
        yield radius[i], np.arctan2(d[near, 1], d[near, 0]), a


def sector(name, radius, angle, a):
    """Results of the kernel of the sector law; a particle with one contact is a circle."""
    kA, kP = STIFFNESS[name][:2]
    shape = (core.sector if np.isinf(kP) else core.area_sector)(radius, angle, a)
    circle = len(a) < 2
    expected = {
        "area": np.pi * radius**2 - shape.area_deficit,
        "perimeter": 2 * np.pi * radius + shape.perimeter_excess,
        "contacts": 0 if circle else np.count_nonzero(shape.contact_length),
        "arc_radius": radius if circle else np.min(shape.arc_radius),
        "contact_length": np.sum(shape.contact_length),
    }
    return expected | ({"pressure": kA * shape.area_deficit} if np.isfinite(kA) else {})


def ring(name, radius, angle, a):
    shape = core.soft_ring(radius, angle, a, *STIFFNESS[name])
    values = {name: getattr(shape, name) for name in ("area", "perimeter", "pressure")}
    return values | {
        "energy": shape.energy,
        "arc_radius": shape.arc_radius,
        "contacts": np.count_nonzero(shape.contact_length),
        "contact_length": shape.contact_length.sum(),
    }


KERNELS = [
    *((sector, LAWS["sector"], m, 0.0) for m in ("perimeter conserved", "area conserved")),
    *((ring, RADICAL, m, 0.3) for m in ("one of each", "rings", "droplets", "all species")),
    (ring, f"{RADICAL} reach 0.1", "rings", 0.1),
]


@pytest.mark.parametrize(("kernel", "style", "material", "reach"), KERNELS)
def test_results_are_those_of_the_kernel(kernel, style, material, reach):
    """Positions within a box of 5 are known to 1e-15, indentations of 0.01 to 1e-13."""
    case = PACKINGS[1]
    state = packing(case, style, material).evaluate()
    names = species_of(case, material)
    for i, (name, row) in enumerate(zip(names, rows(case, reach), strict=True)):
        expected = kernel(name, *row)
        if "energy" in expected:
            energy = expected.pop("energy")
            assert state.atom_energy[i] == pytest.approx(energy, rel=1e-11, abs=1e-18)
        for result, value in expected.items():
            found = state.shape[result][i]
            assert found == pytest.approx(value, rel=4e-12, abs=1e-13), result
    assert set(names) == {name for words in MATERIALS[material] for name in words.split()}


@packings
def test_reach_does_not_matter_once_it_suffices(case):
    near, far = (Scene.packing(case, f"{RADICAL} reach {f}").evaluate() for f in (0.1, 0.3))
    assert far.energy == pytest.approx(near.energy, rel=1e-12)
    atol = 1e-12 * np.abs(near.force).max()
    np.testing.assert_allclose(far.force, near.force, rtol=0, atol=atol)
    for name in RESULTS:
        np.testing.assert_allclose(far.shape[name], near.shape[name], rtol=1e-12, atol=1e-14)
    assert 0 < far.bulge < near.bulge < 1


def hexagonal(spacing, columns=6, rows=6):
    """Centers of a triangular lattice and its box."""
    k, m = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    height = spacing * np.sqrt(0.75)
    x = np.column_stack([((k + 0.5 * (m % 2)) * spacing).ravel(), (m * height).ravel()])
    return x, (0, columns * spacing, 0, rows * height)


@direct_laws
def test_particles_beyond_the_model_are_counted_and_announced_once(law, tmp_path):
    """Free arcs of a hexagon vanish at an indentation of 0.0931 R."""
    for indentation, beyond in ((0.092, 0), (0.094, 36)):
        log = tmp_path / f"log.{beyond}"
        x, box = hexagonal(2 * 0.5 * (1 - indentation))
        scene = Scene(x, ["small"] * 36, box, LAWS[law], log=log)
        states = [scene.evaluate() for _ in range(3)]
        assert [state.beyond for state in states] == [beyond] * 3
        assert all(np.isfinite(state.force).all() and np.isfinite(state.energy) for state in states)
        scene.lmp.close()
        assert log.read_text().count("beyond the model") == (beyond > 0)
        assert ("36 of 36 particles are beyond" in log.read_text()) == (beyond > 0)


# ---- rings of any stiffness ----


def test_stiff_species_beside_soft_ones():
    """The energy of species that conserve the perimeter does not depend on other species."""
    case = PACKINGS[0]
    stiff = Scene.packing(case, RADICAL).evaluate()
    state, species = packing(case).evaluate(), species_of(case)
    alike = [i for i, name in enumerate(species) if name in ("small", "large", "thick")]
    np.testing.assert_array_equal(state.atom_energy[alike], stiff.atom_energy[alike])
    thick = species.index("thick")
    inner = np.pi * 0.4**2
    lost = np.pi * 0.5**2 - stiff.shape["area"][thick]
    assert state.shape["area"][thick] == pytest.approx(inner - lost, rel=1e-13)
    assert state.shape["perimeter"][thick] == pytest.approx(2 * np.pi * 0.4, rel=1e-15)


@pytest.mark.parametrize("n", [3, 6])
def test_regular_polygon(n):
    """Laplace's law, p q = kP (P - P0), for the results of the pair style."""
    a, radius, kP = 0.01, 0.5, 1.0
    options = {"boundary": "f f p", "commands": polygon_walls(n, radius - a)}
    scene = Scene([[0, 0]], ["both"], BOX, RADICAL, **options)
    shape = {name: values[0] for name, values in scene.evaluate().shape.items()}
    stretch = shape["perimeter"] - 2 * np.pi * radius
    delta = stretch / (2 * np.pi)
    assert delta > 4e-5
    # the perimeter is a sum of 3, which leaves the stretch of 3e-4 to 4e-16/3e-4
    length = 2 * polygon_stiffness(n) * (a + delta)
    assert shape["contact_length"] == pytest.approx(length, rel=1e-11)
    q = radius + delta - length / (2 * np.pi)
    assert shape["arc_radius"] == pytest.approx(q, rel=1e-11)
    assert shape["pressure"] * q == pytest.approx(kP * stretch, rel=1e-11)
    deficit = np.pi * radius**2 - shape["area"]
    assert shape["pressure"] == pytest.approx(deficit, rel=1e-11)


def test_reach_includes_the_expansion():
    """A ring that expands far out of its circle needs a reach that covers that."""
    walls = "region walls block -0.4 0.4 -2 2 -0.5 0.5\nfix walls all deformable/wall walls"
    ratios = []
    for species in ("small", "fixed"):
        scene = Scene([[0, 0]], [species], BOX, f"{RADICAL} reach 0.5", commands=walls)
        ratios.append(scene.evaluate().bulge)
    # between walls 2 h apart the outline ends in half circles of radius h: pi h^2 + 4 h b = pi R^2
    # keeps the area, 2 pi h + 4 b = 2 pi R the perimeter, and it bulges by h + b - R
    h, radius = 0.4, 0.5
    bulge = [
        h + np.pi * (radius - h) / 2 - radius,
        h + np.pi * (radius**2 - h**2) / (4 * h) - radius,
    ]
    np.testing.assert_allclose(ratios, np.array(bulge) / (0.5 * radius), rtol=1e-9)
