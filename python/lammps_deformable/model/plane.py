"""What is defined in the plane only says so, in one line, to packings in three dimensions."""

from __future__ import annotations

from ..common.errors import AbsentError, ParameterError
from ..common.validate import shown, whole


def refuse_space(what: str, dimension: int, way_out: str, attribute: bool = False) -> None:
    """Refuse three dimensions.

    Args:
        what: name of what is defined in the plane only.
        dimension: of the packing.
        way_out: what to do in three dimensions.
        attribute: it is one of a packing, which `hasattr` may ask for.

    Raises:
        ParameterError: there are three dimensions.
    """
    if dimension == 3:
        raise (AbsentError if attribute else ParameterError)(
            f"{what} is for packings in the plane, and this one has three dimensions: {way_out}"
        )


def dimension_of(dimension: int) -> int:
    """The dimension, if it is 2 or 3."""
    if (number := whole("dimension", dimension)) not in (2, 3):
        raise ParameterError(f"dimension must be 2 or 3, not {shown(dimension)}")
    return number
