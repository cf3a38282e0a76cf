"""Contact laws as settings."""

import math
import re
from typing import Any

import deformable
import numpy as np
import pytest


def test_parameter_file_has_a_line_a_species() -> None:
    text = deformable.Ring(kA=2.5).parameters([0.5, 0.7])
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    assert lines == ["s1 0.5 2.5 inf 0.0", "s2 0.7 2.5 inf 0.0"]
    assert "UNITS: lj" in text.splitlines()[0]


def test_species_with_stiffnesses_of_their_own() -> None:
    ring = deformable.Ring(kA=[1.0, math.inf], kP=np.array([math.inf, 2.0]), skin=0.1)
    assert ring == deformable.Ring(kA=(1, math.inf), kP=(math.inf, 2), skin=0.1)
    text = ring.parameters([0.5, 0.7])
    assert text.endswith("s1 0.5 1.0 inf 0.1\ns2 0.7 inf 2.0 0.1\n")
    with pytest.raises(deformable.ParameterError, match="there are 3 species"):
        ring.parameters([0.5, 0.6, 0.7])
    with pytest.raises(deformable.ParameterError, match="not 2, 3 and 1 numbers"):
        deformable.Ring(kA=[1.0, 2.0], kP=[1.0, 2.0, 3.0])


def test_outline_of_a_ring_that_breathes() -> None:
    """In a hexagon: area and perimeter of the outline are those of the kernel, skin and all."""
    angle, a, skin = np.arange(6) * np.pi / 3, np.full(6, 0.03), 0.05
    ring = deformable.Ring(kA=1.0, kP=0.5, skin=skin)
    shape = deformable.core.soft_ring(1.0, angle, a, 1.0, 0.5, skin)
    x, y = ring.outline(0, 1.0, angle, a, inset=skin, points=4000).T
    area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    # the polygon lacks R^2 (2 pi/4000)^2/6 of each unit of angle
    assert area == pytest.approx(shape.area, rel=2e-6)
    foot = ring.outline(0, 1.0, angle, a) @ np.array([1.0, 0.0])
    assert foot.max() == pytest.approx(0.97, abs=1e-12)


def test_sector_conserves_perimeter_or_area() -> None:
    assert deformable.Sector() == deformable.Sector(kA=1.0)
    assert deformable.Sector().law == "sector"
    assert deformable.Sector(kP=3.0).law == "area_sector"
    assert deformable.Sector(kP=3.0).parameters([1.0]).endswith("s1 1.0 inf 3.0 0.0\n")


@pytest.mark.parametrize(
    ("law", "wrong"),
    [
        (deformable.Ring, {"kA": 0.0}),
        (deformable.Ring, {"kA": float("inf")}),
        (deformable.Ring, {"reach": -0.1}),
        (deformable.Ring, {"kP": 0.0}),
        (deformable.Ring, {"skin": -0.5}),
        (deformable.Ring, {"kA": [1.0, -2.0]}),
        (deformable.Ring, {"kA": "a"}),
        (deformable.Ring, {"kA": None}),
        (deformable.Ring, {"kA": []}),
        (deformable.Ring, {"kP": [[1, 2], [3, 4]]}),
        (deformable.Ring, {"skin": [0, [1]]}),
        (deformable.Ring, {"reach": "far"}),
        (deformable.Ring, {"reach": 3.001}),
        (deformable.Sector, {"kA": -1.0}),
        (deformable.Sector, {"kA": 1.0, "kP": 1.0}),
        (deformable.Sector, {"kA": float("inf")}),
        (deformable.Sector, {"kA": "a"}),
        (deformable.Sector, {"kP": [1.0, 2.0]}),
    ],
)
def test_bad_stiffness_is_named(law: Any, wrong: dict[str, Any]) -> None:
    with pytest.raises(deformable.ParameterError, match=re.escape(str(next(iter(wrong.values()))))):
        law(**wrong)


def test_a_skin_is_thinner_than_its_particle() -> None:
    skins = deformable.Ring(skin=[0.1, 0.7])
    assert skins.parameters([0.5, 0.71]).endswith("0.71 1.0 inf 0.7\n")
    with pytest.raises(deformable.ParameterError, match=r"skin of 0\.7 .* of radius 0\.7: it must"):
        skins.parameters([0.5, 0.7])


def test_settings_may_be_numpy_numbers() -> None:
    ring = deformable.Ring(kA=np.array(2.0), reach=np.float64(0.4), kP=np.array([1, 2]))
    assert ring.arguments == "contact balanced reach 0.4"
    assert ring == deformable.Ring(kA=2.0, reach=0.4, kP=(1.0, 2.0))
