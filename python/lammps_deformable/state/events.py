"""What happens between states: contacts form and break, particles vanish and are born, T1."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .labels import labels_of

if TYPE_CHECKING:
    from .state import State


_Pair = tuple[int, int]


def _contacts_of(state: State) -> set[_Pair]:
    """Pairs of labels that touch, the smaller one first; walls last, as -1 - k."""
    labels, table = labels_of(state), state.contacts
    i, j = labels[table["i"]], table["j"]
    wall = j < 0
    j = np.where(wall, j, labels[np.maximum(j, 0)])
    first = wall | (i < j)
    return set(zip(i[first].tolist(), j[first].tolist(), strict=True))


def _touching(pairs: Iterable[_Pair]) -> dict[int, set[int]]:
    """The neighbors of each particle; walls are none."""
    found: dict[int, set[int]] = {}
    for i, j in pairs:
        if j >= 0:
            found.setdefault(i, set()).add(j)
            found.setdefault(j, set()).add(i)
    return found


def _exchanges(old: set[_Pair], new: set[_Pair]) -> list[tuple[_Pair, _Pair]]:
    """T1 events: a pair that parts, and two of their common neighbors that meet.

    Neighbors before, or afterwards.
    """
    before, after, formed = _touching(old), _touching(new), new - old
    none: set[int] = set()
    found: list[tuple[_Pair, _Pair]] = []
    for i, j in sorted(old - new):
        if j < 0:
            continue
        common = before[i] & before[j] | after.get(i, none) & after.get(j, none)
        for pair in combinations(sorted(common), 2):
            if pair in formed:
                found.append(((i, j), pair))
                formed.remove(pair)
                break
    return found


# Columns of events, and their types, without events too.
_EVENTS: dict[str, type | str] = {
    "frame": int,
    "time": float,
    "event": "U8",
    "i": int,
    "j": int,
    "t1": int,
}


def changes(states: Iterable[State]) -> dict[str, NDArray[Any]]:
    """See `Run.events`; the frames are counted from 0."""
    found: dict[str, list[Any]] = {name: [] for name in _EVENTS}
    former: State | None = None
    number = 0
    for frame, state in enumerate(states):
        if former is not None:
            before, now = _contacts_of(former), _contacts_of(state)
            there, here = (set(labels_of(each).tolist()) for each in (former, state))
            exchanged: dict[_Pair, int] = {}
            for pairs in _exchanges(before, now) if state.packing.dimension == 2 else ():
                exchanged |= dict.fromkeys(pairs, number)
                number += 1
            rows = [
                *(("vanishes", (one, one), -1) for one in sorted(there - here)),
                *(("is born", (one, one), -1) for one in sorted(here - there)),
                *(("breaks", pair, exchanged.get(pair, -1)) for pair in sorted(before - now)),
                *(("forms", pair, exchanged.get(pair, -1)) for pair in sorted(now - before)),
            ]
            for event, (i, j), t1 in rows:
                for name, value in zip(found, (frame, state.time, event, i, j, t1), strict=True):
                    found[name].append(value)
        former = state
    return {name: np.array(found[name], dtype=np.dtype(kind)) for name, kind in _EVENTS.items()}
