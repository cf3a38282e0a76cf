"""All minimizers reach the same minimum; energies at given positions do not depend on who asks."""

import sys
from pathlib import Path

import numpy as np
import pytest
from laws import RING_LAWS
from turns import in_turn

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import minimizers

CASES = [
    ("rings", "sector"),
    *((material, law) for law, material in in_turn(RING_LAWS, minimizers.MATERIALS)),
]

# Several times the tolerance of balanced contacts, 1e-8 of the largest force: forces add up.
BALANCED = 1e-7


@pytest.mark.parametrize(("material", "law"), CASES)
def test_minima_are_the_same(material: str, law: str) -> None:
    """Energies of a minimum are off by the square of what is left of forces."""
    lowest = minimizers.minimum(law, material, "fire")["energy"]
    for style in ("cg", "sd", "quickmin", "hftn", "deformable/lbfgs"):
        found = minimizers.minimum(law, material, style)
        assert found["force"] < 5.0 * minimizers.TOLERANCE, style
        assert found["energy"] == pytest.approx(lowest, rel=1e-9), style


@pytest.mark.parametrize(("material", "law", "style"), in_turn(CASES, minimizers.IN_A_BOX))
def test_box_relax_reaches_the_pressure(material: str, law: str, style: str) -> None:
    found = minimizers.minimum(law, material, style, in_a_box=True)
    assert found["force"] < 5.0 * minimizers.TOLERANCE
    assert found["pressure"] == pytest.approx(1.02 * found["start"], rel=1e-4)


@pytest.mark.parametrize(("material", "law"), CASES)
def test_a_minimization_evaluates_as_a_run_does(material: str, law: str) -> None:
    """At its first step, and at places where others have been evaluated before."""
    expected = evaluated(material, law, "run 0")
    there_and_back = "run 0\nmin_style cg\nminimize 0 0 3 3", "minimize 0 0 0 0"
    for commands in (("minimize 0 0 0 0",), there_and_back):
        found = evaluated(material, law, *commands)
        for name, values in expected.items():
            error = np.abs(found[name] - values).max() / np.abs(values).max()
            assert error < BALANCED, (name, error)


def evaluated(material: str, law: str, *commands: str) -> dict[str, np.ndarray]:
    """Results by the order of atom IDs; each command begins at the first places."""
    lmp = minimizers.scene(law, material)
    style = "sector" if law == "sector" else "ring"
    lmp.command(f"fix shapes all pair 1 deformable/{style} area 0 pressure 0")
    start = lmp.gather_atoms("x", 1, 3)
    for command in commands:
        lmp.command("reset_timestep 0")
        lmp.scatter_atoms("x", 1, 3, start)
        lmp.commands_string(command)
    order = np.argsort(lmp.numpy.extract_atom("id")[:12])
    found = {
        "energy and pressure": np.array([lmp.get_thermo("pe"), lmp.get_thermo("press")]),
        "force": lmp.numpy.extract_atom("f")[:12][order],
        "area": lmp.numpy.extract_fix("shapes", 1, 2)[:12][order, 0],
        "pressure": lmp.numpy.extract_fix("shapes", 1, 2)[:12][order, 1],
    }
    lmp.close()
    return found
