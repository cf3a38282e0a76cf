"""Columns of a table of states that a user adds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from ..common.errors import ParameterError
from ..common.validate import shown

Column = Callable[[Any], Any]


def check_columns(columns: Mapping[str, Column], others: Iterable[str]) -> None:
    """Refuse columns that are no functions, or have the name of another."""
    for name, column in columns.items():
        if not callable(column):
            raise ParameterError(
                f"column {name} must be a function of a state, such as "
                f"lambda state: state.arc_radius.min(), not {shown(column)}"
            )
    for name in columns.keys() & {"frame", *others}:
        raise ParameterError(f"each table has a column {name}: give yours another name")
