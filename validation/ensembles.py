"""Calls over cores whose results are kept, and exponents: what several studies need."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from statistics import linear_regression
from typing import Any

import joblib
from lammps_deformable import core, parallel_map


def over_cores(
    f: Callable[..., Any],
    calls: Iterable[tuple[Any, ...]],
    workers: int | None = None,
    keep: str | Path | None = None,
) -> list[Any]:
    """f(*call) for all calls, by `parallel_map`; results may be kept in a folder."""
    function = f if keep is None else partial(once, keep, f)
    return parallel_map(lambda call: function(*call), calls, workers=workers)


def once(folder: str | Path, f: Callable[..., Any], /, *arguments: Any, **keywords: Any) -> Any:
    """The result of a call: from a folder that has it, or computed and kept there as a pickle.

    The folder has a folder for each version of the package. Reading a pickle runs the code in it:
    give folders that only you write to.
    """
    kept = Path(folder, core.version, "joblib")
    name = getattr(f, "__name__", "call")
    file = kept / f"{name}-{joblib.hash((name, arguments, keywords))}.pkl"
    if file.exists():
        return joblib.load(file)
    result = f(*arguments, **keywords)
    kept.mkdir(parents=True, exist_ok=True)
    partly = file.with_suffix(f".{os.getpid()}")
    joblib.dump(result, partly)
    partly.replace(file)
    return result


def power_law(x: Iterable[float], y: Iterable[float]) -> float:
    """n of y ~ x^n: the slope of log |y| over log x by least squares, with equal weights."""
    log_x, log_y = ([math.log(abs(value)) for value in values] for values in (x, y))
    return linear_regression(log_x, log_y).slope
