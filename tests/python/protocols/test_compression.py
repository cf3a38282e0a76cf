"""Quasistatic compression."""

import sys

import deformable
import numpy as np
import pytest

pytestmark = pytest.mark.filterwarnings("error")


def test_ten_line_script() -> None:
    packing = deformable.bidisperse(128, radii=(0.5, 0.7), seed=5)
    jammed = deformable.jam(packing)
    sim = deformable.Simulation(jammed, deformable.Ring(kA=1.0))
    seen = []
    for state in deformable.compress(sim, strain=0.01, steps=10):
        seen.append((state.phi, state.pressure))
    phi, pressure = np.array(seen).T
    assert len(seen) == 10
    assert (np.diff(phi) > 0).all()
    assert (np.diff(pressure) > 0).all()
    assert state.packing.box == pytest.approx(0.99 * jammed.box)
    sim.close()


@pytest.mark.parametrize(("strain", "steps"), [(1.0, 1), (0.0, 1), (float("nan"), 1), (0.01, 0)])
def test_compress_refuses_nonsense_at_once(
    jammed: deformable.Packing, strain: float, steps: int
) -> None:
    with (
        deformable.Simulation(jammed, deformable.Ring()) as sim,
        pytest.raises(deformable.ParameterError),
    ):
        deformable.compress(sim, strain, steps)


def test_no_progress_bar_off_a_terminal(
    jammed: deformable.Packing, capfd: pytest.CaptureFixture[str]
) -> None:
    assert not sys.stderr.isatty()
    with deformable.Simulation(jammed, deformable.Ring()) as sim:
        list(deformable.compress(sim, strain=0.001, steps=1))
    assert capfd.readouterr() == ("", "")
