"""What sticks: particles to each other by their law, or to walls."""

from __future__ import annotations

from collections.abc import Sequence

from .. import core
from ..common.errors import ParameterError
from .droplet import AnyLaw
from .laws import Ring
from .packing import Packing
from .walls import Wall


def sticks(law: AnyLaw, walls: Sequence[Wall]) -> bool:
    """Whether any particles have an adhesion, to each other or to a wall."""
    return law.sticks or any(wall.adhesion > 0.0 for wall in walls)


def refuse_adhesion(law: AnyLaw, walls: Sequence[Wall], why: str) -> None:
    """Refuse particles that stick, for what does not know adhesion.

    Args:
        law: of the particles.
        walls: around them.
        why: a phrase that completes "particles have an adhesion".

    Raises:
        ParameterError: there is an adhesion.
    """
    if sticks(law, walls):
        raise ParameterError(f"particles have an adhesion{why}: take adhesion=0")


def check_sticky_walls(packing: Packing, law: AnyLaw) -> None:
    """Refuse walls to which particles of this law cannot stick.

    Raises:
        ParameterError: the contacts are not curved, or a species has a tension that is too small,
            an infinite kP, or a skin.
    """
    kinds = sorted({*packing.species.tolist()})
    parameters = law.species_parameters(packing.radii)
    for n, wall in enumerate(packing.walls, start=1):
        if wall.adhesion == 0.0:
            continue
        if not (isinstance(law, Ring) and law.contact == "curved"):
            raise ParameterError(
                f"{wall.kind} {n}: adhesion needs contact lines that bend, to meet outlines at an "
                "angle: use Ring(contact='curved'), or adhesion 0"
            )
        for kind in kinds:
            of_kind = (float(values[kind]) for values in parameters)
            if problem := core.invalid_for_adhesion(wall.adhesion, *of_kind):
                raise ParameterError(f"{wall.kind} {n}, species {kind}: {problem}")
