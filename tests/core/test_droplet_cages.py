"""The law of droplets beside exact shapes of single droplets between planes."""

import json
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from droplet_formula import KAPPA, green, load, parts
from lammps_deformable import core

ROOT = Path(__file__).parents[2]
DATA = json.loads((ROOT / "tests" / "data" / "droplet_cages.json").read_text())
CAGES = {cage["name"]: cage for cage in DATA["cages"]}
PAGE = ROOT / "docs" / "theory" / "droplets.md"
LOADS = (0.03, 0.1, 0.2, 0.3, 0.4)
CONTACTS = ((2, 2), (4, 4), (5, 8), (9, 11), (12, 14))


def solved(normals, indentations, forces):
    """The droplet where planes n.x <= 1 - a hold it, at the place where their forces balance.

    W has no part that moves it: dW/df_c = a_c + n_c.v with the sum of f n = 0.
    """
    normals, z = np.array(normals), len(indentations)
    left, sizes, _ = np.linalg.svd(normals, full_matrices=False)
    free = left[:, sizes > 1e-9]
    zero = np.zeros((free.shape[1], free.shape[1]))
    forces = np.array(forces)
    for _ in range(100):
        found = core.droplet(normals, forces)
        matrix = np.block([[found.compliance, free], [free.T, zero]])
        rest = np.concatenate([found.indentation - indentations, free.T @ forces])
        step = -np.linalg.solve(matrix, rest)[:z]
        part = 1.0
        while (forces + part * step <= 0.2 * forces).any():
            part *= 0.6
        forces = forces + part * step
        if np.abs(step).max() < 1e-13:
            break
    return core.droplet(normals, forces), forces


@cache
def errors(name):
    """Load of a cage, errors of its energy, of all forces and of the worst one over the mean."""
    cage = CAGES[name]
    exact = np.array(cage["f"])
    found, forces = solved(cage["normals"], np.array(cage["a"]), exact)
    energy = forces @ cage["a"] - found.work
    off = np.abs(forces - exact) / exact.mean()
    rms = np.sqrt((off**2).mean())
    pressure = found.pressure / cage["pressure"]
    return found.load, energy / cage["energy"] - 1, rms, off.max(), pressure


def test_errors_of_irregular_cages():
    """Up to a load of 0.3, in per cent: energies 0.35, forces 1, and but for two cages each single
    one 1 of the mean."""
    names = [name for name in CAGES if re.match("mono|bi", name)]
    small = [errors(name) for name in names if errors(name)[0] < 0.3]
    assert len(small) >= 45
    _, energy, rms, worst, pressure = np.array(small).T
    assert np.abs(energy).max() < 0.0035
    assert rms.max() < 0.01
    assert np.count_nonzero(worst > 0.01) <= 2
    assert worst.max() < 0.018
    assert pressure == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("name", ["plates", "tetrahedron", "cube", "octahedron", "dodecahedron"])
def test_errors_of_regular_cages(name):
    for cage in CAGES:
        load, energy, rms, *_ = errors(cage)
        if cage.startswith(name) and load < 0.3:
            assert abs(energy) < 0.0025, cage
            assert rms < 0.0075, cage


def test_plates():
    """Their exact forces have a closed form."""
    for indentation, exact in DATA["plates"]:
        if indentation <= 0.25:
            found, forces = solved([[0, 0, 1], [0, 0, -1]], np.full(2, indentation), [exact] * 2)
            assert forces == pytest.approx([exact] * 2, rel=7e-3)
            assert found.indentation == pytest.approx([indentation] * 2)


def test_the_integral_of_the_cube():
    """The closed form of I3 beside the integral, and its part of the energy, as the page says."""
    k = np.arange(100_000) + 0.5
    z, angle = 1 - 2 * k / len(k), np.pi * (1 + np.sqrt(5)) * k
    r = np.sqrt(1 - z * z)
    sphere = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    off, of_energy = [], []
    for cage in CAGES.values():
        f, n = np.array(cage["f"]), np.array(cage["normals"])
        if re.match("mono|bi", cage["name"]) and load(f) < 0.1:
            exact = 4 * np.pi * np.mean((-green(sphere @ n.T) @ f) ** 3)
            wrong = parts(f, n)["I3"] - exact
            off.append(wrong / exact)
            of_energy.append(2 / 3 * np.exp(-4 * KAPPA * load(f)) * wrong / cage["energy"])
    rms, most = np.sqrt(np.mean(np.square(off))), np.abs(of_energy).max()
    text = " ".join(PAGE.read_text().split())
    told = (
        f"I3 is off the integral by {100 * most:.2f} % of the energy at most, in cages of random "
    )
    assert f"{told}packings below x = 0.1." in text
    assert rms < 0.25


def table():
    """Rows of the page: the largest error of a force, in per cent of the mean."""
    rows = []
    for least, most in CONTACTS:
        cells, low = [f"{least} to {most}" if most > least else f"{least}"], 0.0
        for high in LOADS:
            found = [
                errors(name)[3]
                for name in CAGES
                if least <= len(CAGES[name]["f"]) <= most and low < errors(name)[0] <= high
            ]
            cells.append(f"{100 * max(found):.2g} ({len(found)})" if found else "")
            low = high
        rows.append("| " + " | ".join(cells) + " |")
    return rows


def test_table_of_the_page():
    text = PAGE.read_text()
    for row in table():
        assert re.sub(" +", " ", row) in text


if __name__ == "__main__":
    print("\n".join(table()))
