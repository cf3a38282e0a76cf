"""Fits."""

from __future__ import annotations

import math
from collections.abc import Iterable
from statistics import linear_regression


def power_law(x: Iterable[float], y: Iterable[float]) -> float:
    """n of y ~ x^n: the slope of log |y| over log x by least squares, with equal weights."""
    log_x, log_y = ([math.log(abs(value)) for value in values] for values in (x, y))
    return linear_regression(log_x, log_y).slope
