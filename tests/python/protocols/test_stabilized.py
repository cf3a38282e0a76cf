"""Jamming in a box whose shape is free: packings that are stable against shear."""

import math
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from contact_laws import simulate

KINDS: dict[str, tuple[ld.Ring | None, float, int]] = {
    "disks": (None, 1e-6, 1),
    "ring": (ld.Ring(), 1e-6, 2),
    "droplets": (ld.Ring(kA=math.inf, kP=0.0, tension=1.0), 1e-4, 3),
}


def state_of(packing: ld.Packing, law: ld.Ring | None) -> Any:
    with simulate(packing, law) as sim:
        return sim.state()


@pytest.mark.parametrize(("law", "pressure", "seed"), KINDS.values(), ids=KINDS)
def test_there_is_no_shear_stress_and_a_modulus(
    law: ld.Ring | None, pressure: float, seed: int
) -> None:
    start = ld.bidisperse(32, seed=seed)
    state = state_of(ld.jam(start, law, pressure=pressure, free="tri").packing, law)
    assert np.abs(state.pressure_tensor / pressure - np.eye(2)).max() <= 2e-6
    assert state.residual <= 2e-6
    assert state.network_contacts >= state.isostatic_contacts
    # A box of free shape adds two motions, and its stability as many contacts.
    moduli = state.moduli()
    assert moduli.shear_modulus > 0.0


def test_a_box_of_one_free_size_keeps_a_shear_stress() -> None:
    start = ld.bidisperse(32, seed=1)
    state = state_of(ld.jam(start, tolerance=1e-6).packing, None)
    assert np.abs(state.pressure_tensor / state.pressure - np.eye(2)).max() > 1e-3


def test_sides_keep_the_angle_of_the_box() -> None:
    start = ld.bidisperse(32, seed=1)
    state = state_of(ld.jam(start, pressure=1e-4, free="aniso").packing, None)
    assert state.pressure_tensor.diagonal() == pytest.approx([1e-4, 1e-4], rel=2e-6)
    assert state.packing.box[1, 0] == 0.0


def test_nonsense_is_refused() -> None:
    start = ld.bidisperse(16, seed=1)
    with pytest.raises(ld.ParameterError, match="free must be iso, aniso or tri"):
        ld.jam(start, free="free")
    walled = start.between(ld.BoxWall((8, 8)))
    with pytest.raises(ld.ParameterError, match="free='tri' is not for walls"):
        ld.jam(walled, free="tri")
