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
from lammps_deformable.comparison import polygon_outlines, shape_errors
from lammps_deformable.lammps import gather
from lammps_deformable.shape_error import shape_error

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
        np.searchsorted(radii, REFERENCE["radius"]),
        radii,
        REFERENCE["box"] * np.eye(2),
    )
    model = ld.PolygonModel(
        vertices=[len(outlines[REFERENCE["radius"].index(radius)]) for radius in radii],
        radius=REFERENCE["bead_radius"],
        **{name: REFERENCE[name] for name in ("kL", "kA", "kr")},
    )
    with ld.Simulation(packing, model) as sim:
        place(sim, outlines)
        state = sim.state()
        force = np.linalg.norm(gather(sim.lmp, "f", 3), axis=1)
    # stiffness of a bead against its two springs and the beads that it touches
    assert force.max() < 3e-8 + 4.0 * (model.kL + model.kr) * ROUNDING
    return state


def place(sim: ld.Simulation, outlines: list[np.ndarray]) -> None:
    """Put beads at given positions, in whole polygons."""
    x = gather(sim.lmp, "x", 3)
    image = np.array(sim.lmp.gather("image", 0, 3)).reshape(-1, 3)
    x[:, :2] = np.vstack(outlines) - image[:, :2] @ sim.box
    values = np.ctypeslib.as_ctypes(x.ravel())
    sim.lmp.scatter("x", 1, 3, values)


def test_the_independent_packing_is_at_rest_here(independent: ld.State) -> None:
    area, perimeter = np.array(REFERENCE["area"]), independent.perimeter
    assert np.abs(independent.area - area).max() < ROUNDING * perimeter.max()
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
    found = ld.compare(independent, law)
    assert found.shape_error.mean() == pytest.approx(shape, abs=1e-6)
    if deficit is not None:
        assert found.area_deficit_error == pytest.approx(deficit, abs=1e-3)
        both = np.corrcoef(found.state.area_deficit, independent.area_deficit)
        assert both[0, 1] == pytest.approx(correlation, abs=1e-3)


def test_balanced_law_on_the_independent_packing(independent: ld.State) -> None:
    """With the polygons' own stiffness and skin: areas to 1 %, energy to 1 %, outlines to 2e-4."""
    sim = independent.polygons
    kP, skin = 300.0 / sim.number, sim.effective_radius - sim.radius
    found = ld.compare(independent, ld.Ring(kP=kP, skin=skin, contact="balanced"))
    assert found.shape_error.mean() < 2e-4
    assert found.area_deficit_error < 0.01
    assert found.energy_ratio == pytest.approx(1.0, abs=0.01)
    # the forces of both sides of every contact are equal, to 1e-8 of the largest force
    table = found.state.contact_table
    force = {(r["i"], r["j"], *r["image"].tolist()): r["force"] for r in table}
    off = [abs(f - force[j, i, -a, -b]) for (i, j, a, b), f in force.items()]
    assert max(off) < 1e-8 * table["force"].max()
    by_default = ld.compare(independent)
    assert by_default.state.law == found.state.law
    assert by_default.energy_ratio == found.energy_ratio


def test_circles_on_the_independent_packing(independent: ld.State) -> None:
    packing = independent.packing
    errors = []
    for outline, center, kind in zip(
        independent.outlines, packing.positions, packing.species, strict=True
    ):
        circle = core.outline("ring", independent.polygons.radius[kind], [], [], 1440)
        errors.append(shape_error(outline - center, circle, packing.radii[kind]))
    assert np.mean(errors) == pytest.approx(7.690e-3, abs=1e-6)


@pytest.fixture(scope="module")
def small() -> ld.State:
    jammed = ld.jam(ld.bidisperse(6, seed=3)).packing
    with ld.Simulation(jammed, ld.PolygonModel(vertices=40)) as sim:
        (state,) = ld.compress(sim, strain=0.02, steps=1, tolerance=0.02)
    return state


def test_predictions_are_for_the_centers_and_effective_radii(
    small: ld.State,
) -> None:
    state = ld.predict(small, ld.Ring(kA=2.0))
    apart = (state.packing.positions - small.packing.positions) @ np.linalg.inv(small.packing.box)
    assert apart - np.rint(apart) == pytest.approx(0.0, abs=1e-12)
    assert state.packing.radii.tolist() == small.polygons.effective_radius.tolist()
    assert state.packing.box == pytest.approx(small.packing.box)
    assert state.law == ld.Ring(kA=2.0)


def test_measures_of_a_comparison(small: ld.State) -> None:
    found = ld.compare(small, ld.Ring())
    ours, exact = found.state.area_deficit, small.polygons.area[small.packing.species] - small.area
    assert found.area_deficit_error == pytest.approx(
        np.sqrt(np.mean((ours - exact) ** 2) / np.mean(exact**2))
    )
    assert found.energy_ratio == pytest.approx(np.sum(ours**2) / 2.0 / small.energy)
    assert found.pressure_ratio == pytest.approx(
        np.trace(found.state.stress) / np.trace(small.stress)
    )
    assert found.shape_error.shape == (6,)
    assert 0.0 < found.shape_error.mean() < 0.01


@pytest.mark.parametrize("law", [ld.Ring, ld.Sector])
def test_beads_on_the_outlines_have_no_error(
    small: ld.State, law: Callable[[], ld.Ring | ld.Sector]
) -> None:
    state = ld.predict(small, law())
    outlines = polygon_outlines(small, state)
    centers = small.packing.positions
    exact = replace(
        small, outlines=[line + center for line, center in zip(outlines, centers, strict=True)]
    )
    assert shape_errors(exact, state).max() < 1e-14
    pushed = [line * 1.001 for line in outlines]  # each bead 0.001 of its distance too far out
    beyond = replace(
        small, outlines=[line + center for line, center in zip(pushed, centers, strict=True)]
    )
    distance = [np.hypot(*line.T).mean() for line in outlines]
    assert shape_errors(beyond, state) == pytest.approx(
        0.001 * np.array(distance) / small.packing.radius
    )


def test_a_folded_outline_is_named(small: ld.State) -> None:
    packing = small.packing
    pressed = replace(small, packing=packing.at(packing.phi / 0.9**2))
    for law in (ld.Ring(), ld.Sector()):
        with pytest.raises(ld.ParameterError, match="compress less") as error:
            ld.compare(pressed, law)
        state = ld.predict(pressed, law)
        folds = [n for n, line in enumerate(polygon_outlines(pressed, state)) if turns_back(line)]
        assert f"particle {folds[0]} folds in the {law.name} law" in str(error.value)


@pytest.mark.parametrize("wrong", ["balanced", "state", "droplet"])
def test_another_kind_of_law_is_refused(small: ld.State, wrong: str) -> None:
    """Such as a state of a law, which has all that is compared."""
    law: Any = {"state": small, "droplet": ld.Droplet()}.get(wrong, wrong)
    for function in (ld.compare, ld.predict):
        with pytest.raises(ld.ParameterError, match="law must be of the kind Ring or Sec"):
            function(small, law)


def turns_back(outline: np.ndarray) -> bool:
    """Whether an outline turns clockwise anywhere about its center."""
    x, y = outline.T
    return bool((x * np.roll(y, -1) - np.roll(x, -1) * y < -1e-12).any())


def test_no_load_no_ratio(small: ld.State) -> None:
    idle = replace(small, energy=0.0, stress=np.zeros((2, 2)))
    found = ld.compare(idle, ld.Ring())
    assert (found.energy_ratio, found.pressure_ratio) == (math.inf, math.inf)


def test_outlines_have_the_areas_of_the_law(small: ld.State) -> None:
    """Parallel to the particle's outline: the same area deficit, and the radius of the beads."""
    state = ld.predict(small, ld.Ring())
    radius = small.polygons.radius[small.packing.species]
    for line, deficit, r in zip(
        polygon_outlines(small, state), state.area_deficit, radius, strict=True
    ):
        x, y = line.T
        area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
        # chords of 1440 sides cut (2 pi)^3 r^2 / (12 1440^2) off a circle
        assert np.pi * r**2 - area == pytest.approx(deficit, abs=2.2e-5 * r**2 / 2.0)
