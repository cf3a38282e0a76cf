"""A state in numbers: a row of a table."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..model.packing import Packing


class _Snapshot(Protocol):
    """What a state has."""

    @property
    def packing(self) -> Packing: ...
    @property
    def strain(self) -> float | None: ...
    @property
    def phi(self) -> float: ...
    @property
    def pressure(self) -> float: ...
    @property
    def shear_stress(self) -> float: ...
    @property
    def energy(self) -> float: ...
    @property
    def coordination(self) -> float: ...
    @property
    def rattlers(self) -> NDArray[np.bool_]: ...
    @property
    def residual(self) -> float: ...
    @property
    def stalled(self) -> bool: ...


def numbers_of(state: _Snapshot) -> dict[str, Any]:
    """The numbers, by name, of particles and of soft disks; `strain` is None without shear."""
    box, axes = state.packing.box, "xyz"[: state.packing.dimension]
    sides = {f"l{axis}": float(box[k, k]) for k, axis in enumerate(axes)}
    tilts = {
        a + b: float(box[k, n]) for n, a in enumerate(axes) for k, b in enumerate(axes) if n < k
    }
    return {
        "particles": len(state.packing),
        **sides,
        **tilts,
        "strain": state.strain,
        "phi": state.phi,
        "pressure": state.pressure,
        "shear_stress": state.shear_stress,
        "energy": state.energy,
        "coordination": state.coordination,
        "rattlers": int(np.sum(state.rattlers)),
        "residual": state.residual,
        "stalled": state.stalled,
    }
