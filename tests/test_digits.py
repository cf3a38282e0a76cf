"""Packings and figures have the committed bits with all kernels that run here."""

import importlib.util
import json
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "benchmarks"
SCRIPT = FOLDER / "digits.py"


def test_all_kernels_give_the_same_bits() -> None:
    spec = importlib.util.spec_from_file_location("digits", SCRIPT)
    digits = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(digits)
    committed = json.loads((FOLDER / "results" / "digits.json").read_text())
    expected = next(iter(committed.values()))
    for cases in digits.compare(short=True).values():
        assert len(cases) > 10
        assert cases == {case: expected[case] for case in cases}
