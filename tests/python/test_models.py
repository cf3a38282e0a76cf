"""Contact laws as settings."""

from typing import Any

import deformable
import pytest


def test_parameter_file_has_a_line_a_species() -> None:
    text = deformable.Ring(kA=2.5).parameters([0.5, 0.7])
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert lines == ["s1 0.5 2.5 inf", "s2 0.7 2.5 inf"]
    assert "UNITS: lj" in text.splitlines()[0]


def test_sector_conserves_perimeter_or_area() -> None:
    assert deformable.Sector() == deformable.Sector(kA=1.0)
    assert deformable.Sector().law == "sector"
    assert deformable.Sector(kP=3.0).law == "area_sector"
    assert deformable.Sector(kP=3.0).parameters([1.0]).endswith("s1 1.0 inf 3.0\n")


@pytest.mark.parametrize(
    ("law", "wrong"),
    [
        (deformable.Ring, {"kA": 0.0}),
        (deformable.Ring, {"kA": float("inf")}),
        (deformable.Ring, {"reach": -0.1}),
        (deformable.Sector, {"kA": -1.0}),
        (deformable.Sector, {"kA": 1.0, "kP": 1.0}),
        (deformable.Sector, {"kA": float("inf")}),
    ],
)
def test_bad_stiffness_is_named(law: Any, wrong: dict[str, float]) -> None:
    with pytest.raises(deformable.ParameterError, match=str(next(iter(wrong.values())))):
        law(**wrong)
