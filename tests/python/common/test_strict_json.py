"""Values come back from JSON with their types, and every program reads that JSON."""

import json
import math
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from lammps_deformable.common.files import as_json, from_json

WORDS = st.text() | st.sampled_from(["inf", "-inf", "nan", "Infinity", "word", "3", "True"])
LEAVES = st.none() | st.booleans() | st.integers() | st.floats() | WORDS
VALUES = st.recursive(
    LEAVES, lambda inner: st.lists(inner) | st.dictionaries(WORDS, inner), max_leaves=20
)


def through(value: Any) -> Any:
    """To strict JSON and back, where Infinity and NaN are no JSON."""
    text = json.dumps(as_json("value", value), allow_nan=False)
    return from_json(json.loads(text, parse_constant=lambda word: pytest.fail(word)))


def same(one: Any, other: Any) -> bool:
    """Equal with all types, nan and the sign of zero."""
    if type(one) is not type(other):
        return False
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(same, one, other))
    return repr(one) == repr(other)


@given(VALUES)
@example({"word": "inf"})
@example({"word": {"word": math.inf}})
@example([[math.inf], {"a": [-math.inf, math.nan]}])
@example(-0.0)
def test_values_come_back(value: Any) -> None:
    assert same(through(value), value)


def test_numbers_of_numpy_are_numbers() -> None:
    for value, back in (
        (np.int64(3), 3),
        (np.float32(0.5), 0.5),
        (np.float64(math.inf), math.inf),
        (np.bool_(True), True),
        (np.str_("inf"), "inf"),
        (np.array([[1.0, math.inf]]), [[1.0, math.inf]]),
        ((1, (2.0,)), [1, [2.0]]),
    ):
        assert same(through({"a": value}), {"a": back}), value


def test_what_json_cannot_hold_is_refused() -> None:
    for value in ({1, 2}, 1j, object, ld.Ring(), {3: 4}, np.array(1j)):
        for given_value in (value, [value], {"a": {"b": value}}):
            with pytest.raises(ld.ParameterError, match=r"^[^\n]*seed[^\n]*$"):
                as_json("seed", given_value)
