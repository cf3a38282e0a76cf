"""Contact laws against bead polygons: a packing of an independent code, and small ones."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import core
from lammps_deformable.engine.lammps import gather
from lammps_deformable.reference import comparison
from lammps_deformable.reference.comparison import (
    centers_rms,
    matching_laws,
    polygon_outlines,
    predict,
    shape_error,
    shape_errors,
    standard_polygons,
)
from refusals import refused

# Made by a bead code that shares nothing with this project; coordinates have nine decimals. The
# key `about` describes it.
REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "bead_packing.json").read_text())
ROUNDING = 5e-10


@pytest.fixture(scope="module")
def independent() -> ld.State:
    """The polygons of the independent code in ours, not moved."""
    outlines = [np.array(outline) for outline in REFERENCE["beads"]]
    radii = np.unique(REFERENCE["radius"])
    packing = ld.Packing(
        [outline.mean(axis=0) for outline in outlines],
        REFERENCE["radius"],
        REFERENCE["box"] * np.eye(2),
        species=np.searchsorted(radii, REFERENCE["radius"]),
    )
    model = ld.DeformablePolygon(
        vertices=[len(outlines[REFERENCE["radius"].index(radius)]) for radius in radii],
        smooth=False,
        radius=REFERENCE["bead_radius"],
        **{name: REFERENCE[name] for name in ("kL", "kA", "kr")},
    )
    with ld.Simulation(packing, model) as sim:
        comparison.place_outlines(sim, outlines)
        state = sim.state()
        force = np.linalg.norm(gather(sim.lmp, "f", 3), axis=1)
    # stiffness of a bead against its two springs and the beads that it touches
    assert force.max() < 3e-8 + 4.0 * (model.kL + model.kr) * ROUNDING
    return state


def test_the_independent_packing_is_at_rest_here(independent: ld.State) -> None:
    area, perimeter = np.array(REFERENCE["area"]), independent.perimeters
    assert np.abs(independent.results["area"] - area).max() < ROUNDING * perimeter.max()
    rest = independent.polygons.area[independent.packing.species]
    assert rest == pytest.approx(REFERENCE["rest_area"], rel=1e-10)
    assert independent.energy == pytest.approx(3.378e-6, rel=1e-3)


@pytest.mark.parametrize(
    ("law", "shape", "deficit", "correlation"),
    [
        (ld.Ring(contact="radical"), 2.584e-3, 0.818, 0.732),
        (ld.Sector(), 3.610e-3, None, None),
    ],
)
def test_laws_on_the_independent_packing(
    independent: ld.State,
    law: ld.Ring | ld.Sector,
    shape: float,
    deficit: float | None,
    correlation: float | None,
) -> None:
    (found,) = ld.compare(independent, law=law).rows
    assert found["shape_error"] == pytest.approx(shape, abs=1e-6)
    if deficit is not None:
        assert found["area_error"] == pytest.approx(deficit, abs=1e-3)
        both = np.corrcoef(predict(independent, law).area_deficit, independent.area_deficit)
        assert both[0, 1] == pytest.approx(correlation, abs=1e-3)


def test_balanced_law_on_the_independent_packing(independent: ld.State) -> None:
    """With the polygons' own stiffness and skin: areas to 1 %, energy to 1 %, outlines to 2e-4."""
    sim = independent.polygons
    kP, skin = 300.0 / sim.number, sim.effective_radius - sim.radius
    law = ld.Ring(kP=kP, skin=skin, contact="balanced")
    (found,) = ld.compare(independent, law=law).rows
    assert found["shape_error"] < 2e-4
    assert found["area_error"] < 0.01
    assert found["energy_error"] < 0.01
    # the forces of both sides of every contact are equal, to 1e-8 of the largest force
    table = predict(independent, law).contacts
    force = {(r["i"], r["j"], *r["image"].tolist()): r["force"] for r in table}
    off = [abs(f - force[j, i, -a, -b]) for (i, j, a, b), f in force.items()]
    assert max(off) < 1e-8 * table["force"].max()
    by_name = {row["method"]: row for row in ld.compare(independent).rows}
    assert list(by_name) == ["sector", "radical, kP inf", "radical", "balanced", "curved"]
    assert by_name["balanced"] == found
    assert predict(independent).law == law


def test_circles_on_the_independent_packing(independent: ld.State) -> None:
    packing = independent.packing
    errors = []
    for outline, center, kind, radius in zip(
        independent.outlines, packing.positions, packing.species, packing.radii, strict=True
    ):
        circle = core.outline("ring", independent.polygons.radius[kind], [], [], 1440)
        errors.append(shape_error(outline - center, circle, radius))
    assert np.mean(errors) == pytest.approx(7.690e-3, abs=1e-6)


@pytest.fixture(scope="module")
def small() -> ld.State:
    jammed = ld.jam(ld.bidisperse(6, seed=3)).packing
    with ld.Simulation(jammed, ld.DeformablePolygon(40, smooth=False)) as sim:
        sim.deform(0.98 * jammed.box)
        state = sim.relax(0.02)
    return state


def test_predictions_are_for_the_centers_and_effective_radii(
    small: ld.State,
) -> None:
    state = predict(small, ld.Ring(kA=2.0))
    apart = (state.packing.positions - small.packing.positions) @ np.linalg.inv(small.packing.box)
    assert apart - np.rint(apart) == pytest.approx(0.0, abs=1e-12)
    radii = small.polygons.effective_radius[small.packing.species]
    assert state.packing.radii.tolist() == radii.tolist()
    assert state.packing.box == pytest.approx(small.packing.box)
    assert state.law == ld.Ring(kA=2.0)


def test_measures_of_a_comparison(small: ld.State) -> None:
    state, (found,) = predict(small, ld.Ring()), ld.compare(small, law=ld.Ring()).rows
    ours, exact = (
        state.area_deficit,
        small.polygons.area[small.packing.species] - small.results["area"],
    )
    assert found["area_error"] == pytest.approx(
        np.sqrt(np.mean((ours - exact) ** 2) / np.mean(exact**2))
    )
    assert found["energy_ratio"] == pytest.approx(np.sum(ours**2) / 2.0 / small.energy)
    assert found["pressure_ratio"] == pytest.approx(
        np.trace(state.pressure_tensor) / np.trace(small.pressure_tensor)
    )
    assert found["energy_error"] == abs(found["energy_ratio"] - 1.0)
    assert found["shape_error"] == shape_errors(small, state).mean()
    assert 0.0 < found["shape_error"] < 0.01
    assert (found["seconds"], found["residual"], found["strain"]) == (None, None, None)


@pytest.mark.parametrize("law", [ld.Ring, ld.Sector])
def test_beads_on_the_outlines_have_no_error(
    small: ld.State, law: Callable[[], ld.Ring | ld.Sector]
) -> None:
    state = predict(small, law())
    outlines = polygon_outlines(small, state)
    centers = small.packing.positions
    exact = replace(
        small, vertices=[line + center for line, center in zip(outlines, centers, strict=True)]
    )
    assert shape_errors(exact, state).max() < 1e-14
    pushed = [line * 1.001 for line in outlines]  # each bead 0.001 of its distance too far out
    beyond = replace(
        small, vertices=[line + center for line, center in zip(pushed, centers, strict=True)]
    )
    distance = [np.hypot(*line.T).mean() for line in outlines]
    assert shape_errors(beyond, state) == pytest.approx(
        0.001 * np.array(distance) / small.packing.radii
    )


def test_a_folded_outline_is_named(small: ld.State) -> None:
    packing = small.packing
    pressed = replace(small, packing=packing.at(packing.phi / 0.9**2))
    for law in (ld.Ring(), ld.Sector()):
        with pytest.raises(ld.ParameterError, match="compress less") as error:
            shape_errors(pressed, predict(pressed, law))
        state = predict(pressed, law)
        folds = [n for n, line in enumerate(polygon_outlines(pressed, state)) if turns_back(line)]
        assert f"particle {folds[0]} folds in the {law.name} law" in str(error.value)


@pytest.mark.parametrize("wrong", ["balanced", "state", "droplet"])
def test_another_kind_of_law_is_refused(small: ld.State, wrong: str) -> None:
    """Such as a state of a law, which has all that is compared."""
    law: Any = {"state": small, "droplet": ld.Droplet()}.get(wrong, wrong)
    for start in (small, small.packing):
        with pytest.raises(ld.ParameterError, match="law must be of the kind Ring or Sec"):
            ld.compare(start, law=law)


def turns_back(outline: np.ndarray) -> bool:
    """Whether an outline turns clockwise anywhere about its center."""
    x, y = outline.T
    return bool((x * np.roll(y, -1) - np.roll(x, -1) * y < -1e-12).any())


def test_no_load_no_ratio(small: ld.State) -> None:
    idle = replace(small, energy=0.0, pressure_tensor=np.zeros((2, 2)))
    (found,) = ld.compare(idle, law=ld.Ring()).rows
    assert (found["energy_ratio"], found["pressure_ratio"]) == (None, None)


def test_outlines_have_the_areas_of_the_law(small: ld.State) -> None:
    """Parallel to the particle's outline: the same area deficit, and the radius of the beads."""
    state = predict(small, ld.Ring())
    radius = small.polygons.radius[small.packing.species]
    for line, deficit, r in zip(
        polygon_outlines(small, state), state.area_deficit, radius, strict=True
    ):
        x, y = line.T
        area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        # chords of 1440 sides cut (2 pi)^3 r^2 / (12 1440^2) off a circle
        assert np.pi * r**2 - area == pytest.approx(deficit, abs=2.2e-5 * r**2 / 2.0)


@pytest.fixture(scope="module")
def jammed() -> ld.Packing:
    return ld.jam(ld.bidisperse(6, seed=1)).packing


@pytest.fixture(scope="module")
def compared(jammed: ld.Packing) -> ld.Comparison:
    return ld.compare(jammed, vertices=(38, 19), beads=(38,), strain=0.015, steps=1, workers=1)


def test_a_comparison_is_of_own_relaxations(jammed: ld.Packing, compared: ld.Comparison) -> None:
    """All methods from the same start; the finest polygons are the reference."""
    laws = ["sector", "radical, kP inf", "radical", "balanced", "curved"]
    methods = [(row["method"], row["vertices"]) for row in compared.rows]
    polygons = [("smooth", 19), ("bead", 38), ("reference", 38)]
    assert methods == [("disk", None), *((law, None) for law in laws), *polygons]
    model = ld.DeformablePolygon(38, radius=0.025, kL=6.0 * 38, kr=10.0)
    with ld.Simulation(jammed, model) as sim:
        sim.deform(jammed.box * 0.985)
        exact = sim.relax()
    law = matching_laws(model, exact.polygons)["balanced"]
    with ld.Simulation(jammed, law) as sim:
        sim.deform(jammed.box * 0.985)
        own = sim.relax()
    (balanced,) = (row for row in compared.rows if row["method"] == "balanced")
    *_, reference = compared.rows
    assert balanced["pressure_ratio"] == pytest.approx(own.pressure / exact.pressure, rel=1e-4)
    relative = balanced["energy_ratio"] / reference["energy_ratio"]
    assert relative == pytest.approx(own.energy / exact.energy, rel=1e-4)
    (step,) = (row for row in compared.steps if row["law"] == "balanced" and row["own"])
    assert step["distance"] == pytest.approx(centers_rms(exact, own), abs=1e-4)
    coarse = compared.rows[-3]
    # energies differ from the limit by a part of 1/N_v^2
    by_4 = (coarse["energy_ratio"] - 1.0) / (reference["energy_ratio"] - 1.0)
    assert by_4 == pytest.approx(4.0, rel=1e-9)
    assert reference["limit_error"] == pytest.approx(reference["energy_error"])


def test_table_and_picture_of_a_comparison(compared: ld.Comparison) -> None:
    table = compared.table()
    assert {len(column) for column in table.values()} == {len(compared.rows)}
    assert table["method"].tolist() == [row["method"] for row in compared.rows]
    assert math.isnan(table["energy_error"][0])  # of disks
    assert table["seconds"][-1] == compared.rows[-1]["seconds"] > 0.0
    assert compared.to_pandas()["area_error"].tolist()[0] == 1.0
    lines = str(compared).splitlines()
    assert len(lines) >= 1 + len(compared.rows)
    assert lines[1].split()[:3] == ["disk", "-", "-"]
    pytest.importorskip("matplotlib")
    ax = compared.plot()
    assert ax.get_ylabel() == "error of the energy"
    _, labels = ax.get_legend_handles_labels()
    assert set(labels) >= {"smooth polygons", "bead polygons", "balanced", "curved"}
    with pytest.raises(ld.ParameterError, match=r"quantity must be one of energy_error, .*, not I"):
        compared.plot(quantity="I")


def test_methods_are_compared_in_one_minimum(jammed: ld.Packing) -> None:
    """A law and polygons that went to another one come back, from centers and outlines."""
    box, coarse = jammed.box * 0.985, standard_polygons(19)
    away = jammed.replace(positions=jammed.positions[[1, 0, 2, 3, 4, 5]], box=box)
    with ld.Simulation(jammed, standard_polygons(38)) as sim:
        sim.deform(box)
        exact = sim.relax()
    for law in (ld.Ring(kP=6.0), coarse):
        start = jammed if law is coarse else jammed.replace(box=box)
        with ld.Simulation(start, law) as sim:
            sim.deform(box)
            own = sim.relax()
        lost = replace(own, packing=own.packing.replace(positions=away.positions))
        assert comparison._against(exact, lost, 1.0)["energy_ratio"] is None
        ((found, seconds),) = comparison.in_its_minimum(jammed, [(exact, 2.0)], [(lost, 1.0)])
        assert seconds == 1.0
        assert centers_rms(exact, found) < 0.02
        # the energy of polygons of 19 vertices depends on how they have turned
        assert found.energy == pytest.approx(own.energy, rel=0.15 if law is coarse else 1e-6)


def test_outlines_with_other_vertices(jammed: ld.Packing) -> None:
    with ld.Simulation(jammed, standard_polygons(38)) as sim:
        state = sim.state()
    other = standard_polygons(152).polygons(jammed.species_radii)
    for outline, kind in zip(comparison.resampled(state, other), jammed.species, strict=True):
        assert len(outline) == other.number[kind]
        away = np.hypot(*(outline - outline.mean(axis=0)).T)
        assert away == pytest.approx(other.radius[kind], rel=4e-3)


def test_another_strain_where_the_limit_is_not_known(
    jammed: ld.Packing, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken = []

    def found(start: ld.Packing, model: object, strain: float, *more: object, **named: object):
        taken.append(strain)
        rows = smooth_rows((38, 1.04, 0), (76, 1.01, 0))
        away = {"distance": 0.1, "energy_ratio": None, "pressure_ratio": None}
        law = rows[0] | {"law": "curved", "vertices": None, "distance": None}
        loose = {"energy_ratio": None} if strain == 0.003 else {}
        rows = [law | loose, *rows]
        return [row | {"strain": strain} | (away if strain > 0.01 else {}) for row in rows]

    monkeypatch.setattr(comparison, "compression_rows", found)
    with pytest.warns(
        UserWarning, match=r"different minima at a strain of 0\.012: compared at 0\.006"
    ):
        compared = ld.compare(jammed, strain=0.012, steps=1)
    assert taken == [0.012, 0.006]
    assert compared.rows[-1]["strain"] == 0.006
    assert compared.rows[-1]["limit_error"] > 0.0
    with pytest.warns(
        UserWarning, match=r"hardly bears a load at a strain of 0\.003: compared at 0\.006"
    ):
        compared = ld.compare(jammed, strain=0.003, steps=1)
    assert taken[2:] == [0.003, 0.006]


def test_an_error_below_the_uncertainty_is_not_told() -> None:
    rows = comparison.method_rows(smooth_rows((38, 1.04, 0), (57, 1.02, 0), (76, 1.01, 0)), 1.0)
    rows[1]["energy_error"] = 0.5 * rows[-1]["limit_error"]
    rows[2]["distance"] = 0.1
    told = str(ld.Comparison(rows, [])).splitlines()
    assert f" <{rows[-1]['limit_error']:.2g} " in told[2]
    assert told[-2] == (
        "In another minimum, and so without errors: smooth polygons of 57 vertices."
    )
    assert told[-1].startswith("The reference's energy is known to ")


def test_laws_at_given_centers_have_no_time(small: ld.State) -> None:
    pytest.importorskip("matplotlib")
    with pytest.raises(ld.ParameterError, match="no method has a time"):
        ld.compare(small).plot()


def test_a_run_is_compared_from_its_start(jammed: ld.Packing, tmp_path: Path) -> None:
    """Its law, with the kP of polygons in the place of an infinite one; its strain and steps."""
    law = ld.Ring(kA=2.0)
    with ld.Simulation(jammed, law) as sim:
        sim.compress(record=tmp_path / "run", strain=0.02, steps=2)
    run = ld.Run(tmp_path / "run")
    found = ld.compare(run, law=law, vertices=(76,), workers=1)
    assert [row["method"] for row in found.rows] == ["disk", "balanced", "reference"]
    strains = [row["strain"] for row in found.steps if row["own"]]
    assert strains == pytest.approx([0.01, 0.02])
    balanced, reference = found.rows[1:]
    assert reference["energy_ratio"] == 1.0
    assert balanced["energy_error"] < 0.05
    sheared = [run[0], replace(run[1], packing=run[1].packing.replace(box=[[9, 0], [1, 9]]))]
    with pytest.raises(ld.ParameterError, match="no isotropic compression: compare its first"):
        ld.compare(sheared)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"law": ld.Ring(kP=1.0, tension=0.1)}, "have a tension, .* law .* is .*'curved'"),
        ({"vertices": (0,)}, "vertices must be at least 1, not 0"),
        ({"vertices": 38}, "vertices must be several numbers, as .*, not 38"),
        ({"vertices": ()}, "vertices must be at least one number"),
        ({"beads": (2.5,)}, "beads must be .* not 2.5"),
    ],
)
def test_what_cannot_be_compared(
    jammed: ld.Packing, settings: dict[str, Any], message: str
) -> None:
    with pytest.raises(ld.ParameterError, match=message):
        ld.compare(jammed, **settings)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (ld.bidisperse(8, seed=1), "particles . and . overlap by .*: take a packing at jamming"),
        (ld.polydisperse(8, [0.5, 0.6] * 4, seed=1), "radii of their .*species=np.unique"),
        (ld.bidisperse(8, seed=1).between(ld.BoxWall((9, 9))), "polygons have no walls"),
    ],
)
def test_a_start_is_refused_before_anything_is_computed(
    start: ld.Packing, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(comparison, "parallel_map", None)
    with refused(message):
        ld.compare(start)


def smooth_rows(*polygons: tuple[int, float, float]) -> list[dict[str, Any]]:
    """Of polygons of so many vertices, with this energy and residual; the last is the reference."""
    *_, (finest, exact, rest) = polygons
    common = {"n": 8, "strain": 0.02, "n_v": finest, "residual": rest, "seconds_polygons": 1.0}
    common |= {"law": "smooth", "own": True, "seconds": 1.0, "S_rms": 0.0, "I": 0.0}
    return [
        common
        | {"vertices": number, "law_residual": residual}
        | {"energy_ratio": energy / exact, "pressure_ratio": energy / exact}
        for number, energy, residual in polygons[:-1]
    ]


def test_polygons_that_are_not_at_rest_do_not_count() -> None:
    rows = comparison.method_rows(smooth_rows((38, 1.04, 0), (57, 2.0, 9.0), (76, 1.01, 0)), 1.0)
    assert rows[-1]["energy_ratio"] == pytest.approx(1.01)
    with pytest.warns(ld.StalledWarning, match=r"polygons of 57 vertices .* residual is 9, "):
        comparison._warn_of_reference(rows)


def test_a_limit_that_is_not_known_is_told() -> None:
    energies = smooth_rows((38, 2.0, 0), (57, 1.1, 0), (76, 1.0, 0))
    with pytest.warns(UserWarning, match=r"is known to \d\d % only"):
        comparison._warn_of_reference(comparison.method_rows(energies, 1.0))


def test_loose_polygons_are_no_reference(small: ld.State) -> None:
    """Nothing has a ratio to what has no pressure but by rounding."""
    loose = replace(small, energy=1e-20, pressure_tensor=1e-12 * small.pressure_tensor)
    found = comparison._against(loose, predict(small, ld.Ring()), 1.0)
    assert (found["energy_ratio"], found["pressure_ratio"]) == (None, None)
    steps = [row | found | {"law_residual": 0.0} for row in smooth_rows((38, 1, 0), (76, 1, 0))]
    rows = comparison.method_rows(steps, 1.0)
    with pytest.warns(ld.UnjammedWarning, match="the packing is loose, of the finest polygons or"):
        comparison._warn_of_reference(rows)
