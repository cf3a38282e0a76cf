"""What several studies need: calls whose results are kept, exponents."""

import math
from pathlib import Path

import pytest
from lammps_deformable import __version__

from validation.ensembles import once, over_cores, power_law


def inverse(value: float, folder: str) -> float:
    """Leaves a mark in a folder when it is called."""
    with Path(folder, f"calls-{value:g}").open("a") as file:
        file.write("x")
    return 1.0 / value


def calls(folder: Path) -> dict[str, int]:
    return {path.name: len(path.read_text()) for path in folder.glob("calls-*")}


def test_interrupted_calls_go_on(tmp_path: Path) -> None:
    """Results that are kept are not computed again."""
    keep = tmp_path / "kept"
    runs = [(value, str(tmp_path)) for value in (1.0, 2.0, 4.0, 0.0)]
    with pytest.raises(ZeroDivisionError):
        over_cores(inverse, runs, 1, keep)
    for _ in range(2):
        assert over_cores(inverse, runs[:3], 2, keep) == [1, 0.5, 0.25]
    assert calls(tmp_path) == {"calls-1": 1, "calls-2": 1, "calls-0": 1, "calls-4": 1}
    assert [path.name for path in keep.iterdir()] == [__version__]


def test_calls_are_known_by_function_and_arguments(tmp_path: Path) -> None:
    for value in (2.0, 4.0, 2.0):
        assert once(tmp_path, inverse, value, str(tmp_path)) == 1.0 / value
        assert once(tmp_path, math.sqrt, value) == math.sqrt(value)
    assert calls(tmp_path) == {"calls-2": 1, "calls-4": 1}


def test_exponent_of_a_power_law() -> None:
    x = [0.1, 0.3, 2.0, 5.0]
    assert power_law(x, [-4.0 * value**-1.5 for value in x]) == pytest.approx(-1.5, rel=1e-14)


def test_least_squares() -> None:
    """Points at log x = -1, 0, 1 and log y = 1, 0, 2: the slope is (2 - 1)/2."""
    e = 2.718281828459045
    assert power_law([1 / e, 1.0, e], [e, 1.0, e * e]) == pytest.approx(0.5, rel=1e-14)
