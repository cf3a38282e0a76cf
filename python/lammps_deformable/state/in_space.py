"""States in three dimensions: what they lack says so, and names the way out."""

from __future__ import annotations

from typing import Any

from .disk_state import DiskState
from .exports import Exports
from .state import State

# What takes the place of what there is in the plane only.
_WAYS_OUT = {
    "hexatic": "take steinhardt",
    "hexatic_correlation": "take steinhardt",
    "filled_area": "take filled_volume",
    "area": "take filled_volume",
    "outlines": "take packing.positions and packing.radius",
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
        if hasattr(Exports, name):
            raise AttributeError(
                f"{name} is for states of a Simulation, and a {kind} has none: take its packing"
            )
        way_out = _WAYS_OUT.get(name, f"a {kind} has none")
        raise AttributeError(
            f"{name} is for packings in the plane, and this one has three dimensions: {way_out}"
        )
