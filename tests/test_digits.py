"""Packings and figures are the same to the last bit with the kernels of other processors."""

import importlib.util
from pathlib import Path

SCRIPT = Path(__file__).parents[1] / "benchmarks" / "digits.py"


def test_all_kernels_give_the_same_bits() -> None:
    spec = importlib.util.spec_from_file_location("digits", SCRIPT)
    digits = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(digits)
    here, *others = digits.compare(short=True).values()
    assert len(here) > 10
    for other in others:
        assert other == here
