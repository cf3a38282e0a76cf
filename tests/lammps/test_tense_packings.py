"""Droplets, bubbles and rings with a tension in packings."""

import numpy as np
import pytest
from contact_rows import of_compute_pair
from lammps_deformable import core
from laws import BALANCED, EXACT, RADICAL, RING_LAWS, two_laws
from materials import STIFFNESS
from scene import BOX, PACKINGS, SPECIES, Scene, box_walls
from turns import in_turn

DENSE = np.pi / np.sqrt(12)  # phi of touching circles

# phi, osmotic pressure and perimeter of the hexagonal array of droplets, R = tension = 1
ARRAY = [
    (0.92, 0.07934, 1.00030),
    (0.95, 0.37312, 1.00385),
    (0.98, 1.20330, 1.01496),
    (0.99, 2.14315, 1.02316),
]


@two_laws
def test_alone(law):
    """A droplet that touches nothing has the pressure tension/R, and no energy."""
    scene = Scene([[0, 0], [3, 0]], ["drop", "full"], (-5, 5, -5, 5), EXACT[law])
    state = scene.evaluate()
    assert state.energy == 0.0
    np.testing.assert_allclose(state.shape["pressure"], [0.04, 0.02 / 0.65], rtol=1e-14)
    np.testing.assert_allclose(state.shape["area"], np.pi * np.array([0.5, 0.65]) ** 2)


@pytest.mark.parametrize(("partner", "overlap"), [("small", 1e-9), ("both", 1e-4), ("drop", 0.05)])
def test_pair(partner, overlap):
    """A droplet beside another particle: one force, which takes both indentations together."""
    scene = Scene([[0, 0], [1 - overlap, 0]], ["drop", partner], (-5, 5, -5, 5), EXACT["balanced"])
    state = scene.evaluate()
    force = state.force[1, 0]
    assert force > 0
    kA, kP, skin, tension = STIFFNESS[partner]
    drop = core.forced_ring(0.5, [0.0], [force], np.inf, 0.0, 0.0, 0.02)
    other = core.forced_ring(0.5, [0.0], [force], kA, kP, skin, tension)
    # an overlap of 1e-9 is known to 1e-16/1e-9
    assert drop.indentation[0] + other.indentation[0] == pytest.approx(overlap, rel=1e-6)
    assert drop.energy + other.energy == pytest.approx(state.energy, rel=1e-6)


@two_laws
def test_droplet_between_walls(law):
    """F = 2 pi gamma [(R/2h)^2 - 1/4] at the distance 2h = 0.9, R = 0.5."""
    options = {"boundary": "f f p", "commands": box_walls(-0.45, 0.45, -5, 5)}
    state = Scene([[0, 0]], ["drop"], (-1, 1, -6, 6), EXACT[law], **options).evaluate()
    force = 2 * np.pi * 0.02 * (0.25 / 0.81 - 0.25)
    assert state.shape["pressure"] * state.shape["contact_length"] == pytest.approx(2 * force)


def hexagonal_array(phi, style, shear=0.0):
    """16 droplets of R = 0.5 and tension 0.02; the state and the area of the box."""
    spacing = 0.5 * np.sqrt(4 * DENSE / phi)
    height = spacing * np.sqrt(0.75)
    k, m = (index.ravel() for index in np.meshgrid(np.arange(4), np.arange(4)))
    x = np.column_stack([(k + 0.5 * (m % 2) + shear * np.sqrt(0.75) * m) * spacing, m * height])
    box = (0, 4 * spacing, 0, 4 * height)
    state = Scene(x, ["drop"] * 16, box, style, tilt=shear * 4 * height).evaluate()
    return state, 16 * spacing * height


@pytest.mark.parametrize(("phi", "osmotic", "perimeter", "law"), in_turn(ARRAY, RING_LAWS))
def test_osmotic_pressure(law, phi, osmotic, perimeter):
    """Princen's, of a hexagonal array."""
    state, area = hexagonal_array(phi, EXACT[law])
    exact = np.sqrt(phi / DENSE) * (np.sqrt((1 - DENSE) / (1 - phi)) - 1)
    assert exact == pytest.approx(osmotic, abs=5.1e-6)
    found = state.virial * 0.5 / 0.02 / area
    np.testing.assert_allclose(found, [exact, exact, 0], rtol=0, atol=1e-6 * exact)
    np.testing.assert_allclose(state.shape["perimeter"] / np.pi, perimeter, atol=5e-6)
    np.testing.assert_allclose(state.shape["area"], np.pi * 0.25, rtol=1e-14)


@pytest.mark.parametrize("phi", [0.92, 0.95, 0.98])
def test_shear_modulus(phi):
    """Princen's with contact lines that tilt; perpendicular ones make the array stiffer.

    Differences of the shear stress at +-strain, extrapolated from two strains: errors of strain^4.
    """
    exact = np.sqrt(np.sqrt(3) / (2 * np.pi) * phi)
    assert exact == pytest.approx(0.52504 * np.sqrt(phi), abs=5e-6)

    def modulus(style):
        found = []
        for strain in (2e-3, 1e-3):
            (up, area), (down, _) = (hexagonal_array(phi, style, s) for s in (strain, -strain))
            found.append((down.virial[2] - up.virial[2]) / (2 * strain) / area * 0.5 / 0.02)
        return (4 * found[1] - found[0]) / 3

    assert modulus(EXACT["curved"]) == pytest.approx(exact, rel=1e-6)
    upright = modulus(EXACT["balanced"])
    assert upright == pytest.approx(modulus(RADICAL), rel=1e-6)  # equal particles
    larger = {0.92: 1.0365, 0.95: 1.1336, 0.98: 1.2683}
    assert upright / exact == pytest.approx(larger[phi], abs=1e-4)


@pytest.mark.parametrize(("law", "distance"), in_turn(RING_LAWS, [0.6, 0.95]))
def test_bubbles_collapse(law, distance, tmp_path):
    """Bubbles near the bound of stability collapse at a small force, and an error says so."""
    file = tmp_path / "gas.txt"
    file.write_text("gas 0.5 1.0 0 tension 0.78\n")
    coeff = f"pair_coeff * * {file} gas"
    style = EXACT[law].replace("1000", "30")  # later its forces balance, and it bulges beyond reach
    scene = Scene([[0, 0], [distance, 0]], ["drop"] * 2, BOX, style, coeff=coeff)
    with pytest.raises(Exception, match=r"no stable shape.*species 'gas' a larger kA"):
        scene.evaluate()


def test_bubbles_in_disorder():
    """First forces that no bubble bears leave nothing behind: those that all bear are found."""
    case, species = PACKINGS[0], ("drop", "bubble")
    scene = Scene.packing(case, f"{BALANCED} reach 1", species)
    for seed in range(14):
        rng = np.random.default_rng(seed)
        x = rng.permutation(np.array(case["x"])) + rng.uniform(-0.1, 0.1, (len(case["x"]), 2))
        scene.run(f"pair_style {BALANCED} reach 1\npair_coeff * * {SPECIES} {' '.join(species)}")
        x = np.column_stack([x, np.zeros(len(x))])
        scene.lmp.scatter("x", 1, 3, np.ctypeslib.as_ctypes(x.ravel()))
        scene.run("run 0 post no")
        evaluations, imbalance = of_compute_pair(scene)
        assert evaluations < 100
        assert imbalance < 1e-8


def test_smallest_bubble(tmp_path):
    """With *radius atom* each radius must be stable."""
    file = tmp_path / "gas.txt"
    file.write_text("gas 0.5 1.0 0 tension 0.2\n")
    coeff, style = f"pair_coeff * * {file} gas", f"{RADICAL} radius atom"
    options = {"coeff": coeff, "radii": [0.5, 0.3]}
    scene = Scene([[0, 0], [1, 0]], ["drop"] * 2, (-3, 3, -3, 3), style, **options)
    with pytest.raises(Exception, match=r"Atom 2 of species gas.*radius 0.3 collapse"):
        scene.evaluate()
