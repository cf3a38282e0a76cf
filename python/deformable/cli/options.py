"""Options and checks that several commands share."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

import typer
from mpi4py import MPI

from ..common.errors import ParameterError


def law_option(names: Iterable[str], help: str) -> Any:
    """The option --law: one of the names."""
    names = tuple(names)

    def law(name: str) -> str:
        if name == "ring":
            if MPI.COMM_WORLD.rank == 0:
                warnings.warn("the law 'ring' is now named 'balanced'", UserWarning, stacklevel=2)
            return "balanced"
        if name not in names:
            raise typer.BadParameter(f"'{name}' is none of {', '.join(names)}")
        return name

    return typer.Option(parser=law, metavar="|".join(names), help=help)


def refuse_ranks(reason: str) -> None:
    """Refuse mpiexec for a command that does not share its work over ranks."""
    if MPI.COMM_WORLD.size > 1:
        raise ParameterError(f"{reason}: start it without mpiexec")
