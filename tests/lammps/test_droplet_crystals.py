"""Crystals of droplets: their pressures and moduli, MODEL 16."""

import numpy as np
import pytest
from droplets import Droplets

PHI = {0.79: 0.072, 0.81: 0.124, 0.83: 0.194, 0.85: 0.285}
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


def test_osmotic_pressure_of_fcc(tmp_path):
    for phi, pressure in PHI.items():
        found = crystal("fcc", phi, tmp_path).lmp.get_thermo("press")
        assert found == pytest.approx(pressure, abs=6e-4), phi


@pytest.mark.parametrize(("kind", "modulus"), [("fcc", 0.2865), ("bcc", 0.2413)])
def test_shear_modulus(kind, modulus, tmp_path):
    """Along the axes of the cube, 0.01 above close packing: d(sxy)/d(strain)."""
    scene = crystal(kind, CLOSE[kind] + 0.01, tmp_path)
    edge, strain = scene.lmp.extract_box()[1][0], 1e-4
    stress = []
    for sign in (1, -1):
        scene.run(f"change_box all xy final {sign * strain * edge} remap\nrun 0")
        stress.append(scene.lmp.get_thermo("pxy"))
    assert (stress[1] - stress[0]) / (2 * strain) == pytest.approx(modulus, rel=1e-3)


@pytest.mark.parametrize(("kind", "modulus"), [("fcc", 0.4928), ("sc", 0.6301)])
def test_modulus_at_constant_volume(kind, modulus, tmp_path):
    """d(s33 - s11)/d(e33)."""
    scene = crystal(kind, CLOSE[kind] + 0.01, tmp_path)
    edge, difference = scene.lmp.extract_box()[1][0], []
    for strain in (1e-4, -1e-4):
        z, x = edge * np.exp(strain), edge * np.exp(-strain / 2)
        scene.run(f"change_box all x final 0 {x} y final 0 {x} z final 0 {z} remap\nrun 0")
        difference.append(scene.lmp.get_thermo("pxx") - scene.lmp.get_thermo("pzz"))
    assert (difference[0] - difference[1]) / 2e-4 == pytest.approx(modulus, rel=1e-3)
