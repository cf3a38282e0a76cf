"""What commands print and draw of the states of a run."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ..progress import print_once
from ..state import State

# Dots per inch of pictures.
DOTS = 150


def print_states(states: Iterator[State], done: int, columns: Sequence[str]) -> State | None:
    """Print a line for each state as it comes, and return the last one if there is any.

    Args:
        states: of a run.
        done: number of steps before; the lines are numbered from there on.
        columns: names of `State.numbers`.
    """
    first, state = done + 1, None
    for step, state in enumerate(states, start=first):
        if step == first:
            print_once("step " + " ".join(f"{name:>12}" for name in columns))
        row = state.numbers()
        print_once(f"{step:4d} " + " ".join(f"{row[name]:12.6g}" for name in columns))
    return state


def draw(state: State, path: Path) -> None:
    """Draw a state on the rank that has it, if matplotlib is installed."""
    if state.root and importlib.util.find_spec("matplotlib"):
        figure: Any = state.plot().figure
        figure.savefig(path, dpi=DOTS)
