"""The paper's results in small; each tolerance is derived beside it."""

import json
import struct
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lammps_deformable import DeformablePolygon, ParameterError, core
from lammps_deformable.reference.comparison import shape_error

from validation.report import packings, paper
from validation.report.packings import AtCenters
from validation.report.paper import IRREGULAR, Squeezed, regular, squeeze

PAPER = paper.ring_in_walls(188, 1e4)


@pytest.fixture(scope="module")
def sweep() -> list[Squeezed]:
    return paper.stiffness_sweep((1.0, 1e2, 1e4), [0.01, 0.02, 0.03], number=96, workers=1)


@pytest.mark.slow  # test_committed_report.py has the rows of the report
@pytest.mark.parametrize(("sides", "indentation"), [(3, 0.01), (4, 0.03)])
def test_sector_is_right_where_walls_stick(sides: int, indentation: float) -> None:
    # in steps of 0.005 the quadrangle has 1.07e-4
    [result] = squeeze(IRREGULAR[sides], [indentation], PAPER, stick=True)
    assert result.shape_error("sector") < 1e-4
    assert result.shape_error("sector") < 0.5 * result.shape_error("ring, kP inf")


@pytest.mark.slow
@pytest.mark.parametrize("sides", [4])
def test_ring_is_right_where_walls_slip(sides: int) -> None:
    [result] = squeeze(IRREGULAR[sides], [0.05], PAPER, stick=False)
    assert result.shape_error("ring, kP inf") < 5e-4
    assert result.shape_error("ring, kP inf") < 0.5 * result.shape_error("sector")
    # the rest comes from the mean of the beads, which is not the center of the law
    assert paper.steiner_error(result) < 0.5 * result.shape_error("ring, kP inf")


@pytest.mark.slow
def test_error_falls_with_stiffness_and_grows_with_indentation(sweep: list[Squeezed]) -> None:
    error = np.array([r.shape_error("sector") for r in sweep]).reshape(3, 3)
    assert (np.diff(error, axis=0) < 0.0).all()
    # kA p q^2/kP rises with a up to K a/pi = 1/2; the stiffest rings have only the spacing
    assert sweep[2].indentation < 0.5 * np.pi / paper.polygon_stiffness(6)
    assert (np.diff(error[:2], axis=1) > 0.0).all()
    assert (error[-1] < chord(sweep[-1])).all()


def chord(result: Squeezed) -> float:
    """Beads of distance L0 draw an arc of radius q to within L0^2/8q."""
    arc = 1.0 - paper.polygon_stiffness(len(result.walls.angle)) * result.indentation / np.pi
    return float(result.reference.polygons.spacing[0]) ** 2 / (8.0 * arc)


@pytest.mark.parametrize("kL", [1.0, 1e3])
def test_the_ring_law_has_the_stiffness_of_the_springs(kL: float) -> None:
    # walls as stiff as kr = 1e3, or soft springs would press into them
    model = replace(paper.ring_in_walls(192, kL), kr=1e3)
    [result] = squeeze(regular(6), [0.02], model, stick=False)
    # the law with conserved perimeter is off by the stretch of the springs
    assert result.shape_error("ring") < chord(result) < result.shape_error("ring, kP inf")
    off = result.area_deficit["ring"] - float(result.reference.area_deficit[0])
    # the spacing, which matters less where springs stretch; and the residual
    exact = paper.polygon_stiffness(6) * 0.02**2
    assert abs(off) / exact < np.pi**2 / (3.0 * 192**2 * 0.02) + 1e-3


@pytest.mark.slow
def test_sweep_keeps_the_order_of_its_arguments(sweep: list[Squeezed]) -> None:
    assert [r.reference.law.kL for r in sweep[::3]] == [1.0, 1e2, 1e4]
    assert [r.indentation for r in sweep[:3]] == [0.01, 0.02, 0.03]


@pytest.mark.slow
@pytest.mark.parametrize("sides", [6])
def test_stiff_rings_of_many_beads_tend_to_the_exact_deficit(sides: int) -> None:
    found = paper.limit(sides, 0.05, numbers=(96, 192), kP=(10.0, 40.0), workers=1)
    K, a = paper.polygon_stiffness(sides), 0.05
    arc = 1.0 - K * a / np.pi
    # Each of the 2n ends of contacts lies on a segment that counts as straight or bent; a bent one
    # takes the area L0^3/24q from the outline, and as much by its length.
    spacing = 2.0 * np.pi / found.numbers
    ends = 2 * sides * spacing**3 / (24.0 * arc) / (K * a**2)
    assert (np.abs(found.number_error - found.number_prediction) < ends).all()
    assert round(found.number_rate) == -2
    # beyond first order: 1/(1 + x) for x, twice over because delta changes a and q
    x = -found.stiffness_prediction
    assert (np.abs(found.stiffness_error + x) < 2.0 * x**2 + 0.02 * x).all()
    assert found.stiffness_rate == pytest.approx(-1.0, abs=0.1)


@pytest.fixture(scope="module")
def packed() -> dict[str, AtCenters]:
    return packings.paper_packing(8, strain=0.02, seed=2)


@pytest.mark.slow
def test_packing_is_nearer_to_the_laws_than_to_circles(packed: dict[str, AtCenters]) -> None:
    reference = packed["radical"].reference
    assert reference.polygons.number.tolist() == [50, 72]
    assert reference.converged
    circle = np.mean(
        [
            shape_error(outline - center, core.outline("ring", radius, [], []), outer)
            for outline, center, radius, outer in zip(
                reference.outlines,
                reference.packing.positions,
                reference.polygons.radius[reference.packing.species],
                reference.packing.radii,
                strict=True,
            )
        ]
    )
    assert list(packed) == ["sector", "radical"]
    for law, each in packed.items():
        assert each.state.law.name == law
        assert each.shape_error.mean() < circle


def test_row_of_a_table() -> None:
    model = DeformablePolygon(24, radius=0.1, kL=2400.0, smooth=False)
    row = paper.single_row(squeeze(IRREGULAR[3], [0.02], model, stick=True)[0])
    assert json.loads(json.dumps(row)) == row
    given = {"polygon": "irregular", "sides": 3, "walls": "stick", "n_v": 24, "kL": 2400.0}
    assert row.items() >= {**given, "a_over_R": 0.02}.items()
    assert set(row) - set(given) == {
        *("a_over_R", "I_sector", "I_ring_kP_inf", "I_ring"),
        *("S_dp", "S_sector", "S_ring_kP_inf", "S_ring", "seconds_dp", "seconds_law"),
    }
    row = paper.single_row(squeeze(regular(3), [0.02], model, stick=False)[0])
    assert (row["polygon"], row["walls"]) == ("regular", "slip")
    assert row["S_sector"] == pytest.approx(paper.polygon_stiffness(3) * 0.02**2, rel=1e-12)
    assert row["S_ring_kP_inf"] == pytest.approx(paper.polygon_stiffness(3) * 0.02**2, rel=1e-10)


@pytest.mark.parametrize("stick", [True, False])
def test_results_do_not_depend_on_their_number(stick: bool) -> None:
    # walls that stick make the same steps; where they slip there is one state, to the tolerance
    model = DeformablePolygon(24, radius=0.1, kL=2400.0, smooth=False)
    *_, many = squeeze(regular(4), [0.005, 0.01, 0.015, 0.02], model, stick)
    [one] = squeeze(regular(4), [0.02], model, stick)
    exact = 2e-12 if stick else 1e-3
    assert one.reference.area_deficit == pytest.approx(many.reference.area_deficit, rel=exact)


@pytest.mark.slow
def test_steps_of_walls_that_stick_matter() -> None:
    model = DeformablePolygon(96, radius=0.1, kL=960.0, smooth=False)
    for stick, same in ((True, False), (False, True)):
        [fine] = squeeze(regular(6), [0.02], model, stick)
        [coarse] = squeeze(regular(6), [0.02], model, stick, step=0.01)
        assert (fine.shape_error("sector") == coarse.shape_error("sector")) is same


def test_seconds_are_those_of_a_processor() -> None:
    began = time.process_time()
    first, second = squeeze(
        regular(4),
        [0.01, 0.02],
        DeformablePolygon(24, radius=0.1, kL=2400.0, smooth=False),
        stick=True,
    )
    spent = time.process_time() - began
    assert 0.0 < first.seconds + second.seconds < spent
    assert set(first.law_seconds) == {"sector", "ring, kP inf", "ring"}
    assert all(0.0 < seconds < first.seconds for seconds in first.law_seconds.values())
    assert paper.single_row(first)["seconds_law"] == first.law_seconds["ring, kP inf"]


def test_indentations_that_do_not_rise_are_refused() -> None:
    model = DeformablePolygon(50, radius=0.1, smooth=False)
    for indentations in ([0.0], [0.02, 0.01], [0.05, 1.0]):
        with pytest.raises(ParameterError, match=f"to {indentations[-1]:g}: indentations"):
            squeeze(regular(4), indentations, model, stick=False)
    with pytest.raises(ParameterError, match=r"^step .* 0\.0$"):
        squeeze(regular(4), [0.01], model, stick=True, step=0.0)


@pytest.mark.slow
def test_figures_are_1200_pixels_wide(
    tmp_path: Path, sweep: list[Squeezed], packed: dict[str, AtCenters]
) -> None:
    single = paper.shapes([0.02], number=24, kL=1e3, workers=1)
    assert len(single) == 12
    for figure in (
        paper.shapes_figure(single, stick=True),
        paper.shapes_figure(single, stick=False),
        paper.deviation_figure(sweep),
        paper.error_by_indentation(sweep),
        paper.limits_figure([paper.limit(4, 0.05, numbers=(24, 36), kP=(10.0, 20.0), workers=1)]),
        packings.packing(packed),
    ):
        figure.savefig(tmp_path / "figure.png")
        assert struct.unpack(">I", (tmp_path / "figure.png").read_bytes()[16:20]) == (1200,)


def test_deviations_are_magnified_by_round_factors() -> None:
    """The largest one is then up to a tenth of the radius, and none is reduced."""
    for largest, factor in ((0.3, 1.0), (0.1, 1.0), (0.04, 2.0), (0.013, 5.0), (1e-4, 1000.0)):
        assert paper.magnification(largest) == pytest.approx(factor)
        assert paper.magnification(2.0 * largest, radius=2.0) == pytest.approx(factor)
    assert paper.magnification(0.0) == 1.0


def test_smooth_polygons_have_the_area_of_the_ring_law_between_walls() -> None:
    """Beads on the circle itself have a shorter perimeter, and 94 of them 4 % less area deficit."""
    model = replace(paper.ring_in_walls(94, 1e3), smooth=True)
    (found,) = squeeze(regular(4), [0.02], model, stick=False)
    exact = found.reference.area_deficit[0]
    assert found.area_deficit["ring"] == pytest.approx(exact, rel=3e-3)  # (pi/94)^2 is 1.1e-3
    assert found.shape_error("ring") < 2e-4
