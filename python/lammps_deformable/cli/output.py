"""What commands print and draw of the states of a run."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path
from typing import Any

from ..progress import print_once
from ..state import DeformedState

# Dots per inch of pictures.
DOTS = 150


def printing(done: int, columns: Sequence[str]) -> Callable[[DeformedState], None]:
    """A callback of protocols that prints a line for each state.

    Args:
        done: number of steps before; the lines are numbered from there on.
        columns: names of `State.numbers`.
    """
    steps = count(done + 1)

    def show(state: DeformedState) -> None:
        step = next(steps)
        if step == done + 1:
            print_once("step " + " ".join(f"{name:>12}" for name in columns))
        row = state.numbers()
        print_once(f"{step:4d} " + " ".join(f"{row[name]:12.6g}" for name in columns))

    return show


def draw(state: DeformedState, path: Path) -> None:
    """Draw a state on the rank that has it, if matplotlib is installed."""
    if state.root and importlib.util.find_spec("matplotlib"):
        figure: Any = state.plot().figure
        figure.savefig(path, dpi=DOTS)
