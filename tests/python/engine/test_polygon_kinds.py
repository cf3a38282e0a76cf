"""Polygons of beads and smooth polygons: what both have in common."""

from dataclasses import dataclass

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine import polygon_engine
from naive_polygons import pair

pytestmark = pytest.mark.filterwarnings("error")


@dataclass(frozen=True)
class Kind:
    """Polygons, a tolerance that they reach, and how alike their contacts are then."""

    model: ld.DeformablePolygon
    tolerance: float
    alike: float
    loose: float  # phi below jamming at which they do not touch


KINDS = {
    "beads": Kind(ld.DeformablePolygon(24, smooth=False), 0.01, 0.02, 0.02),
    # 40 vertices with 10 in each quarter: the four contacts are alike
    "smooth": Kind(
        ld.DeformablePolygon(40, radius=0.025, kL=240.0, kr=10.0),
        1e-6,
        1e-3,
        0.03,
    ),
}
kinds = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)


@pytest.fixture(scope="module")
def six() -> ld.Packing:
    return ld.jam(ld.bidisperse(6, seed=1)).packing


@kinds
def test_polygons_that_meet_through_several_images(kind: Kind) -> None:
    with ld.Simulation(pair(1.4), kind.model) as rings:
        state = rings.relax(kind.tolerance)
    assert state.residual <= kind.tolerance
    assert state.contacts["i"].tolist() == [0] * 4 + [1] * 4
    table = state.contacts[:4]
    assert table["j"].tolist() == [1] * 4
    images = {tuple(image) for image in table["image"].tolist()}
    assert images == {(-1, -1), (-1, 0), (0, -1), (0, 0)}
    along = (table["image"] + 0.5) / np.sqrt(0.5)  # unit vectors from 0 to 1
    pushed = -np.sum(table["force_vector"] * along, axis=1)
    assert pushed == pytest.approx(np.full(4, pushed.mean()), rel=kind.alike)
    total = table["force_vector"].sum(axis=0)
    assert total == pytest.approx([0.0, 0.0], abs=kind.alike * pushed.mean())


@kinds
def test_loose_rings_relax_at_once(kind: Kind, six: ld.Packing) -> None:
    with ld.Simulation(six.at(six.phi - kind.loose), kind.model) as rings:
        rings.deform(0.998 * rings.box)
        assert np.isfinite(rings.state().residual)
        state = rings.relax()
        assert rings.lmp.extract_global("ntimestep") < 5000
    assert (state.residual, (not state.converged)) == (0.0, False)
    assert state.energy < 1e-20
    assert len(state.contacts["i"]) == 0


@pytest.mark.parametrize(("smooth", "radius"), [(True, 0.02), (False, 0.1)])
def test_phi_has_the_radius_of_vertices(smooth: bool, radius: float, six: ld.Packing) -> None:
    """Round polygons fill the circles that a law has, whatever the radius of their vertices."""
    model = ld.DeformablePolygon(120, radius=radius, smooth=smooth)
    with ld.Simulation(six.at(0.5), model) as rings:
        state = rings.state()
    circles = np.pi * state.polygons.effective_radius[six.species] ** 2
    area = np.prod(state.packing.box.diagonal())
    assert state.phi == pytest.approx(circles.sum() / area, rel=1e-3)  # 1 - pi^2/(3 N_v^2)
    law = ld.Ring(skin=state.polygons.skin.tolist())
    same = state.packing.replace(radii=state.polygons.effective_radius[six.species])
    with ld.Simulation(same, law) as sim:
        assert state.phi == pytest.approx(sim.state().phi, rel=1e-3)


@kinds
def test_a_stalled_relaxation_warns(
    kind: Kind, six: ld.Packing, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(polygon_engine, "_ITERATIONS", 10)
    monkeypatch.setattr(polygon_engine.PolygonBeads, "patience", 20)
    monkeypatch.setattr(polygon_engine, "_STEPS", 2)
    with ld.Simulation(six, kind.model) as rings:
        rings.deform(0.98 * rings.box)
        with pytest.warns(
            ld.StalledWarning, match=r"stalled at phi = .*: the largest force is .* not"
        ):
            state = rings.relax(1e-9)
    assert not state.converged
    assert state.residual > 1e-9
