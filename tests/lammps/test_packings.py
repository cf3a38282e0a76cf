"""Periodic packings: known answers, sums over atoms, and the kernels on the same geometry."""

import numpy as np
import pytest
from deformable import core
from scene import LAWS, PACKINGS, RESULTS, Scene

laws = pytest.mark.parametrize("law", LAWS)
packings = pytest.mark.parametrize("case", PACKINGS, ids=range(len(PACKINGS)))


@laws
@packings
def test_known_answers(case, law):
    state, known = Scene.packing(case, f"deformable/{law}").evaluate(), case[law.split()[0]]
    assert state.energy == pytest.approx(known["energy"], rel=1e-9)
    largest = np.abs(known["force"]).max()
    np.testing.assert_allclose(state.force, known["force"], rtol=0, atol=1e-9 * largest)
    np.testing.assert_allclose(state.shape["area"], known["area"], rtol=1e-9)
    np.testing.assert_allclose(state.virial, known["virial_xx_yy_xy"], rtol=1e-9)


@laws
@packings
def test_sums_over_atoms(case, law):
    state = Scene.packing(case, f"deformable/{law}").evaluate()
    # sums of 24 particles' worth of rounded terms
    assert state.atom_energy.sum() == pytest.approx(state.energy, rel=1e-14)
    largest = np.abs(state.atom_virial).max()
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=0, atol=1e-13 * largest)
    assert np.abs(state.force.sum(0)).max() <= 1e-14 * np.abs(state.force).sum()


@laws
@packings
def test_virial_by_pairs_is_virial_by_positions(case, law):
    by_positions = Scene.packing(case, f"deformable/{law}").evaluate().virial
    by_pairs = Scene.packing(case, f"deformable/{law}", commands="pair_modify nofdotr")
    # both sum some 100 terms of the size of the largest component
    atol = 1e-13 * np.abs(by_positions).max()
    np.testing.assert_allclose(by_pairs.evaluate().virial, by_positions, rtol=0, atol=atol)


def shapes_by_core(case, law, reach, species_radius):
    """Every particle's shape from the kernel, with contacts from all nearest images."""
    x, length = np.array(case["x"]), case["L"]
    radius = np.array([species_radius[t - 1] for t in case["type"]])
    for i in range(len(x)):
        d = x - x[i]
        d -= length * np.round(d / length)
        distance = np.hypot(*d.T)
        near = (distance < (1 + reach) * (radius + radius[i])) & (distance > 0)
        indentation = [
            core.contact_line(distance[j], radius[i], radius[j]) for j in np.flatnonzero(near)
        ]
        angle = np.arctan2(d[near, 1], d[near, 0])
        yield radius[i], getattr(core, law)(radius[i], angle, np.array(indentation))


@pytest.mark.parametrize(
    ("style", "law", "species", "radii", "kA"),
    [
        ("sector", "sector", ("small", "large"), (0.5, 0.7), (1.0, 1.0)),
        ("ring contact radical", "ring", ("small", "large"), (0.5, 0.7), (1.0, 1.0)),
        ("ring contact radical", "ring", ("small", "soft"), (0.5, 0.7), (1.0, 0.3)),
        ("sector", "area_sector", ("fixed", "fixedlarge"), (0.5, 0.7), None),
    ],
)
def test_results_are_those_of_the_kernel(style, law, species, radii, kA):
    case = PACKINGS[1]
    state = Scene.packing(case, f"deformable/{style}", species).evaluate()
    reach = 0.0 if style == "sector" else 0.3
    for i, (radius, shape) in enumerate(shapes_by_core(case, law, reach, radii)):
        circle = len(shape.contact_length) < 2 and law != "ring"
        expected = {
            "area": np.pi * radius**2 - shape.area_deficit,
            "perimeter": 2 * np.pi * radius + shape.perimeter_excess,
            "contacts": 0 if circle else np.count_nonzero(shape.contact_length),
            "arc_radius": radius if circle else np.min(shape.arc_radius),
            "contact_length": np.sum(shape.contact_length),
        }
        if kA:
            expected["pressure"] = kA[case["type"][i] - 1] * shape.area_deficit
        for name, value in expected.items():
            # positions within a box of 5 are known to 1e-15, indentations of 0.01 to 1e-13
            assert state.shape[name][i] == pytest.approx(value, rel=1e-12, abs=1e-13), name


@packings
def test_reach_does_not_matter_once_it_suffices(case):
    near, far = (
        Scene.packing(case, f"deformable/ring contact radical reach {f}").evaluate()
        for f in (0.1, 0.3)
    )
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


@laws
def test_particles_beyond_the_model_are_counted_and_announced_once(law, tmp_path):
    """Free arcs of a hexagon vanish at an indentation of 0.0931 R."""
    for indentation, beyond in ((0.092, 0), (0.094, 36)):
        log = tmp_path / f"log.{beyond}"
        x, box = hexagonal(2 * 0.5 * (1 - indentation))
        scene = Scene(x, ["small"] * 36, box, f"deformable/{law}", log=log)
        states = [scene.evaluate() for _ in range(3)]
        assert [state.beyond for state in states] == [beyond] * 3
        assert all(np.isfinite(state.force).all() and np.isfinite(state.energy) for state in states)
        scene.lmp.close()
        assert log.read_text().count("beyond the model") == (beyond > 0)
        assert ("36 of 36 particles are beyond" in log.read_text()) == (beyond > 0)
