"""The inputs of docs/lammps_recipes.md run as they are printed, and show what the page says."""

import re
from pathlib import Path

import numpy as np
import pytest
from programs import output

PAGE = Path(__file__).parents[1] / "docs" / "lammps_recipes.md"
RECIPE = re.compile(r"^## (.+?)\n.*?```lammps\n(.*?)```", re.DOTALL | re.MULTILINE)
RECIPES = dict(RECIPE.findall(PAGE.read_text()))


def run(name: str, folder: Path, ranks: int = 0, steps: int | None = None) -> str:
    """What LAMMPS says to a recipe; with `steps`, runs are that long."""
    script = RECIPES[name]
    if steps is not None:
        script = re.sub(r"^run .*", f"run {steps}", script, flags=re.MULTILINE)
        script = re.sub(r"^thermo  .*", f"thermo {steps}", script, flags=re.MULTILINE)
    (folder / "in.recipe").write_text(script)
    return output("lmp", "-in", "in.recipe", "-log", "none", cwd=folder, ranks=ranks)


def rows(log: str) -> np.ndarray:
    """The last table of thermodynamic output."""
    lines = log[log.rindex("\n   Step ") : log.rindex("Loop time")].splitlines()[2:]
    return np.array([line.split() for line in lines], dtype=float)


def test_scripts_are_short() -> None:
    assert len(RECIPES) == 7
    assert {name for name, script in RECIPES.items() if script.count("\n") > 25} == set()


# Words of the page beside a recipe, and of the warnings that LAMMPS prints.
WARNINGS = {
    "Steady shear": {"beyond the model", "no room"},
    "Biaxial compression": {"beyond the model"},
    "Oscillation": {"beyond the model", "no room"},
}


@pytest.mark.parametrize("name", RECIPES)
def test_warnings(name: str, tmp_path: Path) -> None:
    """The page names each, and no more."""
    steps = {"Oscillation": 4000}.get(name, 10)
    log = " ".join(line for line in run(name, tmp_path, steps=steps).splitlines() if "WARN" in line)
    text = " ".join(PAGE.read_text().partition(f"## {name}\n")[2].partition("```")[0].split())
    for words in ("beyond the model", "no room"):
        assert (words in log) == (words in text) == (words in WARNINGS.get(name, ()))
    assert log.count("WARNING") == len(WARNINGS.get(name, ()))


def test_steady_shear(tmp_path: Path) -> None:
    """The stress rises, and then goes up and down."""
    _, strain, stress, pressure = rows(run("Steady shear", tmp_path)).T
    steady = stress[strain > 0.25]
    assert stress[0] < 0.3 * steady.mean()
    assert steady.mean() == pytest.approx(0.08, rel=0.15)
    assert np.ptp(steady) < 0.8 * steady.mean()
    assert pressure[strain > 0.25] == pytest.approx(0.68, rel=0.05)


def test_drag_of_droplets_in_water() -> None:
    """The numbers of docs/units.md."""
    page = (PAGE.parent / "units.md").read_text()
    mass, drag = 4 / 3 * np.pi * 1e-5**3 * 1000.0, 6 * np.pi * 1e-3 * 1e-5
    unit = (mass * 5e-3) ** 0.5
    assert f"6 π η R = {drag:.1e}".replace("e-0", "e-") in page
    assert f"sqrt(m γ) = {unit:.1e} kg/s: `drag={drag / unit:.1f}`".replace("e-0", "e-") in page


def test_tissue(tmp_path: Path) -> None:
    """It orders, and moves as one."""
    _, order, contacts, x, y = rows(run("A tissue that crawls", tmp_path)).T
    assert order[0] < 0.1
    assert order[3:] == pytest.approx(0.95, abs=0.05)
    assert contacts == pytest.approx(contacts[0], rel=0.02)
    assert np.hypot(x[-1] - x[2], y[-1] - y[2]) == pytest.approx(0.03 * 120, rel=0.1)


def test_silo(tmp_path: Path) -> None:
    """It empties evenly once the first grains have come down."""
    _, _, _, out, _ = rows(run("A silo", tmp_path)).T
    flow = np.diff(out[3:])
    assert flow.mean() == pytest.approx(12, abs=3)
    assert (abs(flow - flow.mean()) < 0.6 * flow.mean()).all()


def test_couette(tmp_path: Path) -> None:
    """The velocity rises from 0 to 0.1, and the lid is dragged back."""
    _, _, drag, _, height = rows(run("Couette flow", tmp_path)).T
    assert drag[1:].mean() < 0
    assert height[1:] == pytest.approx(19.2, abs=0.6)
    lines = (tmp_path / "couette.profile").read_text().splitlines()
    chunks = np.array([line.split() for line in lines[-14:]], dtype=float)
    y, count, v = chunks[:, 1:].T
    full = count > 15
    assert v[full] == pytest.approx(0.1 * y[full] / height[-1], abs=0.02)


def test_biaxial(tmp_path: Path) -> None:
    """The sides keep their pressure; the stress across rises, and no further."""
    _, lx, ly, pxx, pyy = rows(run("Biaxial compression", tmp_path)).T
    assert ly[-1] == pytest.approx(0.8 * ly[0], rel=0.001)
    assert lx[-1] > 1.2 * lx[0]
    assert pxx[1:] == pytest.approx(0.107, abs=0.007)
    assert 1.1 < (pyy / 0.1)[1:].mean() < 1.3


def test_oscillation(tmp_path: Path) -> None:
    """Moduli of the second period and the third are equal, and far from zero."""
    _, _, pressure, storage, loss = rows(run("Oscillation", tmp_path)).T
    # of the packing that the minimization finds
    assert pressure == pytest.approx(0.52, abs=0.04)
    assert storage[-1] == pytest.approx(storage[-2], rel=1e-4)
    assert 0.7 < storage[-1] < 1.2
    assert 0 < loss[-1] < 0.3 * storage[-1]


def test_chain(tmp_path: Path) -> None:
    """Two links are one run, with the springs of friction and what was lost."""
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    name = "A chain of restarts"
    whole = rows(run(name, tmp_path / "one", steps=2000))
    first, second = (rows(run(name, tmp_path / "two", steps=1000)) for _ in range(2))
    assert first[-1, 0] == second[0, 0] == 1000
    assert second[-1] == pytest.approx(whole[-1], rel=1e-7)
    assert second[-1, 4] > second[0, 4] > 0


@pytest.mark.parametrize(
    "name", ["A silo", "Couette flow", "Biaxial compression", "A chain of restarts"]
)
def test_two_ranks_are_one(name: str, tmp_path: Path) -> None:
    """Until collisions have magnified rounding."""
    found = []
    for ranks in (1, 2):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        found.append(rows(run(name, folder, ranks, steps=600)))
    assert found[0] == pytest.approx(found[1], rel=1e-6, abs=1e-9)


def test_oscillation_on_two_ranks(tmp_path: Path) -> None:
    """Its minimization finds another packing, of nearly the same pressure."""
    _, _, pressure, *_ = rows(run("Oscillation", tmp_path, ranks=2, steps=4000)).T
    assert pressure == pytest.approx(0.52, abs=0.04)
