"""Crystals of droplets: their pressures and moduli."""

import droplet_formula as formula
import numpy as np
import pytest
from droplets import Droplets

# pressure of the law, and of exact shapes, in tension/R, to the digits of the page
PRESSURES = {
    "fcc": {
        0.79: (0.07105, 0.0710),
        0.81: (0.12062, 0.1206),
        0.83: (0.18521, 0.1851),
        0.85: (0.26915, 0.2686),
        0.87: (0.37896, 0.3784),
        0.89: (0.52260, 0.5235),
    },
    "bcc": {
        0.70: (0.01163, 0.0116),
        0.73: (0.03969, 0.0397),
        0.76: (0.07867, 0.07865),
        0.79: (0.12970, 0.1296),
        0.82: (0.19504, 0.1947),
        0.85: (0.27807, 0.2768),
    },
    "sc": {
        0.56: (0.01905, 0.0191),
        0.60: (0.05404, 0.0541),
        0.65: (0.11907, 0.11915),
        0.70: (0.21462, 0.2155),
    },
}
# 0.01 above close packing, in tension/R: along the axes of the cube
SHEAR = {"fcc": 0.28696, "bcc": 0.24207}
EXTENSION = {"fcc": 0.49403, "sc": 0.63313}
CORNERS = {
    "sc": [[0, 0, 0]],
    "bcc": [[0, 0, 0], [0.5, 0.5, 0.5]],
    "fcc": [[0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]],
}
CLOSE = {"sc": np.pi / 6, "bcc": np.pi * np.sqrt(3) / 8, "fcc": np.pi * np.sqrt(2) / 6}


def crystal(kind, phi, folder, cells=2):
    """Unit droplets in cells of this crystal, in a box that may be tilted."""
    edge = np.cbrt(len(CORNERS[kind]) * 4 / 3 * np.pi / phi)
    cell = np.stack(np.meshgrid(*[range(cells)] * 3), axis=-1).reshape(-1, 1, 3)
    x = edge * (np.array(CORNERS[kind]) + cell).reshape(-1, 3) + 0.01
    n = len(x)
    case = {"x": x, "box": [cells * edge] * 3, "radius": [1.0] * n, "tension": [1.0] * n}
    return Droplets(case, folder, commands="change_box all triclinic")


@pytest.mark.parametrize("kind", PRESSURES)
def test_osmotic_pressures(kind, tmp_path):
    """All digits of the law, and the exact ones to half a per cent and their last digit."""
    for phi, (pressure, exact) in PRESSURES[kind].items():
        found = crystal(kind, phi, tmp_path).lmp.get_thermo("press")
        assert found == pytest.approx(pressure, abs=6e-6), phi
        assert found == pytest.approx(exact, rel=3e-3 if kind == "fcc" else 5e-3, abs=6e-5), phi


def energy_of(kind, strain):
    """Of a unit droplet in a crystal 0.01 above close packing, after a strain, by the formula."""
    cells = len(CORNERS[kind])
    edge = np.cbrt(cells * 4 / 3 * np.pi / (CLOSE[kind] + 0.01))
    images = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 1, 3)
    vectors = edge * (np.array(CORNERS[kind]) + images).reshape(-1, 3)
    distance = np.linalg.norm(vectors, axis=1)
    near = (distance > 0) & (distance < 1.01 * distance[distance > 0].min())
    energy, _ = formula.crystal(vectors[near] @ (np.eye(3) + strain).T)
    return energy / (edge**3 / cells)


def second(kind, strain, h=2e-3):
    """Second derivative by the size of a strain e(s), with an error of the fourth order."""
    at = [energy_of(kind, strain(s * h)) for s in (-2, -1, 0, 1, 2)]
    return (-at[0] + 16 * at[1] - 30 * at[2] + 16 * at[3] - at[4]) / (12 * h * h)


@pytest.mark.parametrize("kind", ["fcc", "bcc"])
def test_shear_modulus(kind, tmp_path):
    """Along the axes of the cube, 0.01 above close packing: d(sxy)/d(strain)."""
    modulus = second(kind, lambda s: np.array([[0, s, 0], [0, 0, 0], [0, 0, 0]]))
    assert modulus == pytest.approx(SHEAR[kind], abs=5e-5)
    scene = crystal(kind, CLOSE[kind] + 0.01, tmp_path)
    edge, strain = scene.lmp.extract_box()[1][0], 1e-4
    stress = []
    for sign in (1, -1):
        scene.run(f"change_box all xy final {sign * strain * edge} remap\nrun 0")
        stress.append(scene.lmp.get_thermo("pxy"))
    assert (stress[1] - stress[0]) / (2 * strain) == pytest.approx(modulus, rel=1e-3)


@pytest.mark.parametrize("kind", ["fcc", "sc"])
def test_modulus_at_constant_volume(kind, tmp_path):
    """d(s33 - s11)/d(e33)."""
    modulus = second(kind, lambda s: np.diag(np.exp([-s / 2, -s / 2, s])) - np.eye(3))
    assert modulus == pytest.approx(EXTENSION[kind], abs=5e-5)
    scene = crystal(kind, CLOSE[kind] + 0.01, tmp_path)
    edge, difference = scene.lmp.extract_box()[1][0], []
    for strain in (1e-4, -1e-4):
        z, x = edge * np.exp(strain), edge * np.exp(-strain / 2)
        scene.run(f"change_box all x final 0 {x} y final 0 {x} z final 0 {z} remap\nrun 0")
        difference.append(scene.lmp.get_thermo("pxx") - scene.lmp.get_thermo("pzz"))
    assert (difference[0] - difference[1]) / 2e-4 == pytest.approx(modulus, rel=1e-3)
