"""Rings of any stiffness side by side in a packing."""

import numpy as np
import pytest
from closed_forms import polygon_stiffness
from deformable import core
from scene import PACKINGS, Scene, box_walls, polygon_walls
from test_forces import BOX, assert_forces

# kA, kP and skin of the species file
STIFFNESS = {
    "small": (1.0, np.inf, 0.0),
    "large": (1.0, np.inf, 0.0),
    "soft": (0.3, np.inf, 0.0),
    "both": (1.0, 1.0, 0.0),
    "bothlarge": (1.0, 0.1, 0.0),
    "fixed": (np.inf, 1.0, 0.0),
    "fixedlarge": (np.inf, 2.0, 0.0),
    "skinned": (2.0, 0.3, 0.05),
    "thick": (1.0, np.inf, 0.1),
}
OF_RADIUS = {
    0.5: ("small", "both", "fixed", "thick"),
    0.7: ("skinned", "fixedlarge", "large", "bothlarge"),
}


def mixture(case, style="deformable/ring contact radical", **options):
    """A packing with all species of the sizes of its particles in turn."""
    radius = np.array([0.5, 0.7])[np.array(case["type"]) - 1]
    species = [OF_RADIUS[r][i // 2 % 4] for i, r in enumerate(radius)]
    box = (0, case["L"], 0, case["L"])
    return Scene(case["x"], species, box, style, **options), species, radius


def pushed(case):
    push = np.random.default_rng(1).uniform(-0.005, 0.005, (case["N"], 2))
    return np.array(case["x"]) + push


def test_forces_of_a_mixture():
    case = PACKINGS[1]
    scene, species, _ = mixture(case)
    assert len(set(species)) == 8
    assert_forces(scene, pushed(case))


@pytest.mark.parametrize("law", ["ring contact radical reach 0.1", "ring contact radical"])
def test_results_are_those_of_the_kernel(law):
    case = PACKINGS[1]
    reach = 0.1 if "reach" in law else 0.3
    scene, species, radius = mixture(case, f"deformable/{law}")
    state, x, length = scene.evaluate(), np.array(case["x"]), case["L"]
    for i, name in enumerate(species):
        d = x - x[i]
        d -= length * np.round(d / length)
        distance = np.hypot(*d.T)
        near = (distance < (1 + reach) * (radius + radius[i])) & (distance > 0)
        indentation = core.contact_line(
            distance[near], np.full(near.sum(), radius[i]), radius[near]
        )
        angle = np.arctan2(d[near, 1], d[near, 0])
        shape = core.soft_ring(radius[i], angle, indentation, *STIFFNESS[name])
        # positions within a box of 6 are known to 1e-15, indentations of 0.01 to 1e-13
        assert state.atom_energy[i] == pytest.approx(shape.energy, rel=4e-12, abs=1e-20)
        expected = {
            "area": shape.area,
            "perimeter": shape.perimeter,
            "contacts": np.count_nonzero(shape.contact_length),
            "pressure": shape.pressure,
            "arc_radius": shape.arc_radius,
            "contact_length": shape.contact_length.sum(),
        }
        for result, value in expected.items():
            assert state.shape[result][i] == pytest.approx(value, rel=2e-12, abs=1e-13), result
    assert (state.shape["contacts"] > 0).sum() > 20


def test_sums_and_virial_of_a_mixture():
    case = PACKINGS[0]
    state = mixture(case)[0].evaluate(pushed(case))
    by_pairs = mixture(case, commands="pair_modify nofdotr")[0].evaluate(pushed(case))
    assert state.atom_energy.sum() == pytest.approx(state.energy, rel=1e-14)
    atol = 1e-13 * np.abs(state.atom_virial).max()
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=0, atol=atol)
    np.testing.assert_allclose(by_pairs.virial, state.virial, rtol=0, atol=atol)
    assert np.abs(state.force.sum(0)).max() <= 1e-14 * np.abs(state.force).sum()


def test_stiff_species_do_not_notice_soft_ones():
    """Species that conserve their perimeter have the same energies with soft ones in the file."""
    case = PACKINGS[0]
    stiff = Scene.packing(case, "deformable/ring contact radical").evaluate()
    scene, species, _ = mixture(case)
    state = scene.evaluate()
    alike = [i for i, name in enumerate(species) if name in ("small", "large", "thick")]
    np.testing.assert_array_equal(state.atom_energy[alike], stiff.atom_energy[alike])
    thick = species.index("thick")
    inner = np.pi * 0.4**2
    lost = np.pi * 0.5**2 - stiff.shape["area"][thick]
    assert state.shape["area"][thick] == pytest.approx(inner - lost, rel=1e-13)
    assert state.shape["perimeter"][thick] == pytest.approx(2 * np.pi * 0.4, rel=1e-15)


@pytest.mark.parametrize("walls", [box_walls(-0.965, 0.97, -0.96, 0.967)])
def test_walls(walls):
    x = np.array([[-0.481, -0.477], [0.483, -0.479], [0.478, 0.482], [-0.479, 0.479]])
    species = ["small", "both", "fixed", "both"]
    options = {"boundary": "f f p", "commands": walls}
    scene = Scene(x, species, BOX, "deformable/ring contact radical reach 0.2", **options)
    state = scene.evaluate()
    assert (state.shape["contacts"] > 2).all()
    np.testing.assert_allclose(scene.force_on_wall("walls"), -state.force.sum(0), rtol=1e-12)
    assert_forces(scene, x)


@pytest.mark.parametrize("n", [3, 4, 5, 6])
def test_regular_polygon(n):
    """Laplace's law, p q = kP (P - P0), with what the pair style says of the particle."""
    a, radius, kP = 0.01, 0.5, 1.0
    scene = Scene(
        np.zeros((1, 2)),
        ["both"],
        BOX,
        "deformable/ring contact radical",
        boundary="f f p",
        commands=polygon_walls(n, radius - a),
    )
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


def test_reach_includes_the_breath():
    """A ring that expands far out of its circle needs a reach that covers that."""
    walls = "region walls block -0.4 0.4 -2 2 -0.5 0.5\nfix walls all deformable/wall walls"
    ratios = []
    for species in ("small", "fixed"):
        scene = Scene(
            np.zeros((1, 2)),
            [species],
            BOX,
            "deformable/ring contact radical reach 0.5",
            commands=walls,
        )
        ratios.append(scene.evaluate().bulge)
    # between walls 2 h apart the outline ends in half circles of radius h: pi h^2 + 4 h b = pi R^2
    # keeps the area, 2 pi h + 4 b = 2 pi R the perimeter, and it bulges by h + b - R
    h, radius = 0.4, 0.5
    bulge = [
        h + np.pi * (radius - h) / 2 - radius,
        h + np.pi * (radius**2 - h**2) / (4 * h) - radius,
    ]
    np.testing.assert_allclose(ratios, np.array(bulge) / (0.5 * radius), rtol=1e-9)


def test_energy_is_conserved():
    """The energy error falls with the square of the time step, for all species at once."""
    error = []
    for halvings in range(4):
        scene, *_ = mixture(PACKINGS[1], "deformable/ring contact radical reach 0.2")
        step = 0.2 / 2**halvings
        scene.run(
            f"velocity all create 1e-5 4711 loop all\nfix move all nve\ntimestep {step}\n"
            "thermo_style custom step etotal\nthermo_modify norm no"
        )
        energy = []
        for _ in range(50):
            scene.run(f"run {2**halvings * 10} post no")
            energy.append(scene.lmp.get_thermo("etotal"))
        error.append(np.std(energy))
    order = -np.polyfit(range(4), np.log2(error), 1)[0]
    # four points of a chaotic trajectory scatter about 2
    assert 1.7 < order < 2.3
    assert error[-1] < 1e-4 * np.mean(energy)
