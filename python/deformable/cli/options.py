"""Options and checks that several commands share."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from itertools import islice
from typing import Annotated, Any

import typer
from mpi4py import MPI
from typer.core import TyperCommand, TyperOption

from ..common.errors import ParameterError
from ..runs.recording import LARGEST_TOLERANCE

# Options of commands that write a run.
Tolerance = Annotated[
    float,
    typer.Option(
        help="A step is relaxed when the largest force on a particle is this times the mean "
        f"contact force; at most {LARGEST_TOLERANCE:g}."
    ),
]
Resume = Annotated[
    bool,
    typer.Option(
        "--resume",
        help="Finish the interrupted run in the output folder. Its options can be left out.",
    ),
]
Overwrite = Annotated[
    bool, typer.Option("--overwrite", help="Replace the run in the output folder.")
]


def choice_option(names: Iterable[str], help: str) -> Any:
    """An option whose value is one of these names."""
    names = tuple(names)

    def choose(name: str) -> str:
        if name not in names:
            raise typer.BadParameter(f"'{name}' is none of {', '.join(names)}")
        return name

    return typer.Option(parser=choose, metavar="|".join(names), help=help)


class Command(TyperCommand):
    """A command whose options do not take the name of another option for their value."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Check the words of the command line, then read them."""
        values = {
            name: option.nargs
            for option in self.get_params(ctx)
            if isinstance(option, TyperOption) and not option.is_flag
            for name in option.opts
        }
        words = iter(args)
        for word in words:
            for value in islice(words, values.get(word, 0)):
                if value.startswith("--"):
                    raise ParameterError(_needs(word, values[word], value))
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command. Its warnings and errors may be those of one rank: all may print."""
        if MPI.COMM_WORLD.rank == 0:
            return super().invoke(ctx)
        with redirect_stdout(sys.__stdout__), redirect_stderr(sys.__stderr__):
            return super().invoke(ctx)


@contextmanager
def one_rank_prints() -> Iterator[None]:
    """Only rank 0 prints, until a command begins: all ranks read the same command line."""
    if MPI.COMM_WORLD.rank == 0:
        yield
        return
    with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere), redirect_stderr(nowhere):
        yield


def _needs(option: str, count: int, value: str) -> str:
    wanted = "a value" if count == 1 else f"{count} values"
    return f"{option} needs {wanted}, not {value}"


def is_given(context: typer.Context, name: str) -> bool:
    """Whether an option is given on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def refuse_ranks(reason: str) -> None:
    """Refuse mpiexec for a command that does not share its work over ranks."""
    if MPI.COMM_WORLD.size > 1:
        raise ParameterError(f"{reason}: start it without mpiexec")
