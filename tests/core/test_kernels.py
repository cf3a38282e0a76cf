"""The contact laws against 60-digit arithmetic, finite differences and each other."""

import json
from pathlib import Path

import numpy as np
import pytest

from deformable import core

CASES = json.loads((Path(__file__).parents[1] / "data" / "kernel_cases.json").read_text())["cases"]
LAWS = {"sector": (core.sector, 1e-12), "ring": (core.ring, 1e-10)}


def ids(case):
    return f"{case['case']}-{len(case['angle'])}"


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("case", CASES, ids=ids)
def test_known_answers(case, law):
    if law not in case:
        pytest.skip("the file has no answer of this law")
    kernel, tolerance = LAWS[law]
    shape = kernel(case["radius"], np.array(case["angle"]), np.array(case["indentation"]))
    for name, expected in case[law].items():
        expected = np.asarray(expected)
        error = np.abs(getattr(shape, name) - expected)
        assert error.max() <= tolerance * np.abs(expected).max(), name
