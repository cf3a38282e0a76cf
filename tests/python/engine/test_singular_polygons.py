"""Newton's method for smooth polygons where the Hessian is singular."""

import lammps_deformable as ld
import numpy as np
import pytest
import scipy.sparse.linalg
from lammps_deformable.engine.polygon_engine import SmoothPolygons, relax_smooth


@pytest.mark.parametrize("failures", [1, 10**9])
def test_a_singular_hessian(failures: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """More damping helps; if it never does, the polygons stay about where they are."""
    model = ld.DeformablePolygon(20)
    packing = ld.Packing([[0, 0], [0.9, 0]], 0.5, 4.0 * np.eye(2))
    polygons = SmoothPolygons(
        model, model.polygons(packing.species_radii), packing.species, packing.box
    )
    angle = 2.0 * np.pi * np.arange(20) / 20
    circle = 0.48 * np.column_stack([np.cos(angle), np.sin(angle)])
    start = np.concatenate([center + circle for center in packing.positions])
    exact, left = scipy.sparse.linalg.splu, [failures]

    def sometimes(*arguments: object, **options: object) -> object:
        left[0] -= 1
        if left[0] >= 0:
            raise RuntimeError("Factor is exactly singular")
        return exact(*arguments, **options)

    monkeypatch.setattr(scipy.sparse.linalg, "splu", sometimes)
    relaxed = relax_smooth(polygons, start, 1e-6)
    residual = polygons.residual(polygons.energy(relaxed))
    assert residual <= (1e-6 if failures == 1 else polygons.residual(polygons.energy(start)))
    assert np.isfinite(relaxed).all()
