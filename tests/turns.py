"""Values of several parameters in turn, where a test of all their combinations says no more."""

from collections.abc import Iterable
from itertools import cycle


def in_turn(first: Iterable, *others: Iterable) -> list[tuple]:
    """Each of `first` with one of each of the others, which begin again as often as needed.

    `first` may have several values itself, in a tuple.
    """
    firsts = [value if isinstance(value, tuple) else (value,) for value in first]
    return [(*a, *b) for a, *b in zip(firsts, *map(cycle, others), strict=False)]
