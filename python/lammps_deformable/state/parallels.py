"""Outlines of a state, and lines parallel to them."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.validate import count, numbers
from ..model.laws import Law
from ..model.packing import Packing
from ..model.sticking import refuse_adhesion
from .contact_table import ContactTable


class Parallels:
    """Lines parallel to the outlines of a `State`."""

    packing: Packing
    law: Law
    contact_table: ContactTable

    def parallels(
        self,
        inset: NDArray[np.float64] | None = None,
        points: int = 180,
        same_area: bool = False,
    ) -> list[NDArray[np.float64]]:
        """Lines parallel to the outlines, about each particle's center, arrays (m, 2) [length].

        Args:
            inset: distance inward from each outline, shape (N,) [length]; 0 if not given.
            points: number of points on a whole turn.
            same_area: move points between contacts a little outward, see `core.outline`.

        Raises:
            ParameterError: a value is out of range, or there is an inset where particles stick.
        """
        inset = np.zeros(len(self.packing)) if inset is None else numbers("inset", inset)
        if inset.shape != (len(self.packing),):
            raise ParameterError(f"inset must have shape ({len(self.packing)},), not {inset.shape}")
        count("points", points)
        if inset.any():
            why = ", and a line parallel to an outline does not end where a film does"
            refuse_adhesion(self.law, self.packing.walls, why)
        lines = ("force", "half_angle", "contact_angle") if self.law.name == "curved" else ()
        return [
            self.law.outline(
                kind,
                radius,
                rows["angle"],
                rows["indentation"],
                distance,
                points,
                same_area,
                **{name: rows[name] for name in lines},
            )
            for kind, radius, distance, rows in zip(
                self.packing.species,
                self.packing.radius,
                inset,
                self.contact_tables,
                strict=True,
            )
        ]

    @cached_property
    def contact_tables(self) -> list[ContactTable]:
        """The rows of `contact_table` of each particle."""
        first = np.searchsorted(self.contact_table["i"], np.arange(1, len(self.packing)))
        return np.split(self.contact_table, first)
