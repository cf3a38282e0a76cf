"""Jamming in a box whose shape is free: packings that are stable against shear."""

import math
from typing import Any

import deformable
import numpy as np
import pytest
from deformable.protocols.jamming import natural_pressure
from deformable.protocols.starts import simulate

KINDS: dict[str, tuple[deformable.Ring | None, float]] = {
    "disks": (None, 1e-6),
    "ring": (deformable.Ring(), 1e-6),
    "droplets": (deformable.Ring(kA=math.inf, kP=0.0, tension=1.0), 1e-4),
}


def state_of(packing: deformable.Packing, law: deformable.Ring | None) -> Any:
    with simulate(packing, law) as sim:
        return sim.state()


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(("law", "pressure"), KINDS.values(), ids=KINDS)
def test_there_is_no_shear_stress_and_a_modulus(
    law: deformable.Ring | None, pressure: float, seed: int
) -> None:
    start = deformable.bidisperse(32, seed=seed)
    state = state_of(deformable.jam(start, law, pressure, box="shape"), law)
    unit = natural_pressure(state.packing, law)
    assert np.abs(state.stress / (pressure * unit) - np.eye(2)).max() <= 2e-6
    assert state.residual <= 2e-6
    assert state.network_contacts >= state.isostatic_contacts
    # A box of free shape adds two motions, and its stability as many contacts.
    moduli = deformable.polish(state, 1e-6).elastic_moduli()
    assert moduli.shear_modulus > 0.0


def test_a_box_of_one_free_size_keeps_a_shear_stress() -> None:
    start = deformable.bidisperse(32, seed=1)
    state = state_of(deformable.jam(start, tolerance=1e-6), None)
    assert np.abs(state.stress / state.pressure - np.eye(2)).max() > 1e-3


def test_sides_keep_the_angle_of_the_box() -> None:
    start = deformable.bidisperse(32, seed=1)
    state = state_of(deformable.jam(start, pressure=1e-4, box="sides"), None)
    assert state.stress.diagonal() == pytest.approx([1e-4, 1e-4], rel=2e-6)
    assert state.packing.box[1, 0] == 0.0


def test_nonsense_is_refused() -> None:
    start = deformable.bidisperse(16, seed=1)
    with pytest.raises(deformable.ParameterError, match="box must be size, sides or shape"):
        deformable.jam(start, box="free")
    walled = start.between(deformable.rectangle(8, 8))
    with pytest.raises(deformable.ParameterError, match="box='shape' is not for walls"):
        deformable.jam(walled, box="shape")
