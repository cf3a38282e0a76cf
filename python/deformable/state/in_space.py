"""States in three dimensions: what they lack says so, and names the way out."""

from __future__ import annotations

from typing import Any

from .disk_state import DiskState
from .state import State

# What takes the place of what there is in the plane only.
_FREUD = "freud has {} for `state.to_freud()`"
_STRAIN = "measure with `deformable.shear_modulus` and `bulk_modulus`, which strain the packing"
_WAYS_OUT = {
    "hexatic": _FREUD.format("freud.order.Steinhardt"),
    "hexatic_correlation": _FREUD.format("freud.order.Steinhardt"),
    "cell_sides": _FREUD.format("freud.locality.Voronoi"),
    "local_phi": _FREUD.format("freud.locality.Voronoi"),
    "structure_factor": _FREUD.format("freud.diffraction.StaticStructureFactorDirect"),
    "filled_area": "take filled_volume",
    "area": "take filled_volume",
    "outlines": "take packing.positions and packing.radius",
    "hessian": _STRAIN,
    "modes": _STRAIN,
    "elastic_moduli": _STRAIN,
}


class InSpace:
    """A state in three dimensions. What it has is listed in its class: nothing else is there.

    So nothing of a state in the plane can take x and y of the centers and leave out z.
    """

    def __getattr__(self, name: str) -> Any:
        kind = type(self).__name__
        known = any(
            hasattr(each, name) or name in each.__dataclass_fields__ for each in (State, DiskState)
        )
        if name.startswith("_") or not known:
            raise AttributeError(f"{kind!r} object has no attribute {name!r}")
        way_out = _WAYS_OUT.get(name, f"a {kind} has none")
        raise AttributeError(
            f"{name} is for packings in the plane, and this one has three dimensions: {way_out}"
        )
