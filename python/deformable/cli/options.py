"""Options that several commands have."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

import typer


def law_option(names: Iterable[str], help: str) -> Any:
    """The option --law: one of the names."""
    names = tuple(names)

    def law(name: str) -> str:
        if name == "ring":
            warnings.warn("the law 'ring' is now named 'balanced'", UserWarning, stacklevel=2)
            return "balanced"
        if name not in names:
            raise typer.BadParameter(f"'{name}' is none of {', '.join(names)}")
        return name

    return typer.Option(parser=law, metavar="|".join(names), help=help)
