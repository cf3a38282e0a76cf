"""Minimizers of LAMMPS and droplets: energies and forces that they can rely on."""

import numpy as np
import pytest
from droplets import CASES, EXACT, Droplets
from turns import in_turn

FIRE = "min_style fire\ntimestep 0.05\nmin_modify dmax 0.02\n"
# other line searches of cg end near the rounding of the energy
CG = "min_style cg\nmin_modify dmax 0.02 line forcezero\n"


def shaken(x, by, seed=1):
    return x + by * np.random.default_rng(seed).normal(size=x.shape)


@pytest.mark.parametrize("number", [1, 3])
def test_minimizers(number, tmp_path):
    """A packing at rest, shaken a little: FIRE and cg find it again, to 1e-8 of a contact force."""
    scene = Droplets(CASES[number], tmp_path)
    scene.run(f"{FIRE}minimize 0 1e-9 9999 99999")
    x = shaken(scene.x, 1e-3)
    mean, found = scene.contacts()[:, 4].mean(), []
    for style in (FIRE, CG):
        scene.energy_at(x)
        assert np.abs(scene.force).max() > 1e-4 * mean
        scene.run(f"{style}minimize 0 {0.5e-8 * mean:.17g} 9999 99999")
        assert np.linalg.norm(scene.force, axis=1).max() < 1e-8 * mean
        found.append(scene.energy)
    # of second order in forces and in the balance of 1e-12: rounding is left
    assert found[0] == pytest.approx(found[1], rel=1e-12)


@pytest.mark.parametrize(("number", "tolerance"), [(0, 1e-8), (2, 1e-10)])
def test_cg_relaxes_as_far_as_contacts_are_balanced(number, tolerance, tmp_path):
    """To *tol* of the largest contact force, for each of some ten contacts of a droplet."""
    scene = Droplets(CASES[number], tmp_path, style=f"deformable/droplet balance {tolerance} 100")
    scene.run(f"{FIRE}minimize 0 1e-9 9999 99999")
    at_rest, most = scene.x, 3 * tolerance * scene.contacts()[:, 4].max()
    for seed in range(3):
        scene.energy_at(shaken(at_rest, 1e-3, seed))
        scene.run(f"{CG}min_modify norm max\nminimize 0 {most:.17g} 9999 99999")
        assert np.abs(scene.force).max() <= most


@pytest.mark.parametrize(("number", "moved"), in_turn(range(4), [1e-3, 1e-5, 1e-4]))
def test_energies_in_a_minimizer(number, moved, tmp_path):
    """An imbalance of 1e-8 changes the energy by its square, 1e-16, as it is stationary in the
    forces of contacts. cg fails where an energy is off by 1e-12."""
    scene = Droplets(CASES[number], tmp_path, style="deformable/droplet")
    scene.lmp.scatter("x", 1, 3, np.ascontiguousarray(shaken(scene.x, moved)).ctypes)
    scene.run("minimize 0 0 0 0")
    energy = scene.energy
    scene.run(f"pair_style {EXACT}\nrun 0")
    assert energy == pytest.approx(scene.energy, rel=1e-14)  # sums of some 100 terms
