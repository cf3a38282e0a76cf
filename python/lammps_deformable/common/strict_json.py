"""Values as JSON that every program reads, and back with their types.

JSON has no infinity. It becomes the word "inf", and that word becomes {"word": "inf"}.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from .errors import ParameterError
from .validate import expect, shown

# As Python writes them, and reads them again.
_NUMBERS = ("inf", "-inf", "nan")

_WORD = "word"


def as_json(name: str, value: Any) -> Any:
    """A value for `json.dumps`; `from_json` returns it, with tuples and arrays as lists.

    Raises:
        ParameterError: JSON cannot hold it; the message has this name.
    """
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, float) and not math.isfinite(value):
        return str(float(value))
    if isinstance(value, str):
        return {_WORD: str(value)} if value in _NUMBERS else str(value)
    if value is None or isinstance(value, (bool, int, float)):
        return value
    if isinstance(value, (list, tuple)):
        return [as_json(name, each) for each in value]
    if isinstance(value, Mapping):
        for key in value:
            expect(f"a name in {name}", key, str)
        found = {key: as_json(f"{name}[{key!r}]", each) for key, each in value.items()}
        return {_WORD: found} if found.keys() == {_WORD} else found
    raise ParameterError(
        f"{name} must be what JSON can hold, numbers, words, and lists and dictionaries of them, "
        f"not {shown(value)}: give its numbers, or str() of it"
    )


def from_json(value: Any) -> Any:
    """The inverse of `as_json`, of what `json.loads` returns.

    Raises:
        TypeError, ValueError: it is damaged.
    """
    if isinstance(value, str):
        return float(value) if value in _NUMBERS else value
    if isinstance(value, list):
        return [from_json(each) for each in value]
    if isinstance(value, dict):
        marked = value[_WORD] if value.keys() == {_WORD} else value
        if isinstance(marked, str):
            return marked
        return {key: from_json(each) for key, each in dict(marked).items()}
    return value


def check_parameters(parameters: object) -> None:
    """Refuse parameters of a run that its summary cannot hold."""
    expect("parameters", parameters, Mapping, type(None))
    as_json("parameters", parameters)
