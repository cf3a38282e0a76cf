"""Quasistatic compression."""

from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest

pytestmark = pytest.mark.filterwarnings("error")


def test_ten_line_script() -> None:
    packing = ld.bidisperse(64, sizes=(0.5, 0.7), seed=5)
    jammed = ld.jam(packing).packing
    sim = ld.Simulation(jammed, ld.Ring(kA=1.0))
    seen = []
    for state in sim.compress(strain=0.01, steps=5)[1:]:
        seen.append((state.phi, state.pressure))
    phi, pressure = np.array(seen).T
    assert len(seen) == 5
    assert (np.diff(phi) > 0).all()
    assert (np.diff(pressure) > 0).all()
    assert state.packing.box == pytest.approx(0.99 * jammed.box)
    sim.close()


@pytest.mark.parametrize("strain", [1.0, float("nan")])
def test_compress_refuses_nonsense_at_once(jammed: ld.Packing, strain: float) -> None:
    with (
        ld.Simulation(jammed, ld.Ring()) as sim,
        pytest.raises(ld.ParameterError, match="strain"),
    ):
        sim.compress(strain=strain)


@pytest.mark.parametrize("kind", ["law", "polygons"])
def test_a_packing_that_comes_apart_says_so_once(jammed: ld.Packing, kind: str) -> None:
    """Compressed by 1 %, then expanded by 1 % a step: the first step leaves 1e-4."""
    sim: Any = {
        "law": lambda: ld.Simulation(jammed, ld.Ring()),
        "polygons": lambda: ld.Simulation(
            jammed, ld.DeformablePolygon(40, radius=0.025, kL=240.0, kr=10.0)
        ),
    }[kind]()
    with sim:
        (pressed,) = sim.compress(strain=0.01)[1:]
        with pytest.warns(ld.UnjammedWarning, match="apart at step 2, phi = 0.") as told:
            states = [pressed, *sim.compress(strain=-0.03, steps=3)[1:]]
    assert len(told) == 1
    assert [state.coordination > 0.0 for state in states] == [True, True, False, False]
