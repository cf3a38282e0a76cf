"""Options and checks that several commands share."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from itertools import islice
from typing import Annotated, Any

import typer
from mpi4py import MPI
from typer.core import TyperCommand, TyperGroup, TyperOption

from ..errors import ParameterError
from ..recording import LARGEST_TOLERANCE

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


class CommandLineError(ParameterError):
    """A command that cannot begin. All ranks read the same command line, so that rank 0 tells."""


class Command(TyperCommand):
    """A command whose errors are one line that names the option and its value.

    Its options do not take the name of another option for their value.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Check the words of the command line, then read them."""
        counts = {
            name: option.nargs
            for option in self.get_params(ctx)
            if isinstance(option, TyperOption) and not option.is_flag
            for name in option.opts
        }
        given: dict[str, list[str]] = {}  # values by option; those of no option by ""
        words = iter(args)
        for word in words:
            name, sign, value = word.partition("=")
            if name not in counts:
                given.setdefault("", []).extend([] if word.startswith("-") else [word])
                continue
            given[name] = [value] if sign else list(islice(words, counts[name]))
            for value in given[name]:
                if value.startswith("--"):
                    raise CommandLineError(_needs(name, counts[name], value))
        with _one_line(given):
            return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command. Its warnings and errors may be those of one rank: all may print."""
        if MPI.COMM_WORLD.rank == 0:
            return super().invoke(ctx)
        with redirect_stdout(sys.__stdout__), redirect_stderr(sys.__stderr__):
            return super().invoke(ctx)


class Group(TyperGroup):
    """Commands; the error of an unknown name is one line."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command of this name."""
        with _one_line({}):
            return super().resolve_command(ctx, args)


@contextmanager
def _one_line(given: Mapping[str, list[str]]) -> Iterator[None]:
    """Raise errors of typer as ours, with the values that were given to the option."""
    try:
        yield
    except Exception as error:
        if not hasattr(error, "format_message"):
            raise
        message = error.format_message()
        if isinstance(error, typer.BadParameter) and error.param and error.message:
            names = error.param.opts
            values = next((given[name] for name in (*names, "") if name in given), [])
            message = f"{shlex.join([names[0], *values])}: {error.message}"
        raise CommandLineError(message) from None


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
        raise CommandLineError(f"{reason}: start it without mpiexec")
