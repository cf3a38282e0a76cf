"""Numbers as text for a reader: two or three digits, ranges, lists."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def show(value: Any, digits: int = 2) -> str:
    """A value of a row for a reader; a dash for none."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (list, tuple)):
        return ", ".join(show(each, digits) for each in value)
    if not isinstance(value, float):
        return "∞" if value == "inf" else str(value)
    if value == 0.0:
        return "0"
    mantissa, power = f"{abs(value):.{digits - 1}e}".split("e")
    sign = "−" if value < 0.0 else ""
    if -3 <= int(power) < 4:
        places = 0 if value % 1 == 0 else max(digits - 1 - int(power), 0)
        return f"{sign}{abs(value):.{places}f}"
    exponent = f"10{str(int(power)).translate(_SUPERSCRIPTS)}"
    return sign + (exponent if float(mantissa) == 1.0 else f"{mantissa}\u00a0×\u00a0{exponent}")


def span(values: Iterable[float | None], digits: int = 2) -> str:
    """The range of values, e.g. 0.71 to 0.82; a dash if there are none."""
    known = [value for value in values if value is not None]
    if not known:
        return "–"
    low, high = show(min(known), digits), show(max(known), digits)
    return low if low == high else f"{low} to {high}"


def percent(value: float) -> str:
    return f"{100 * value:g} %"


def listed(parts: Iterable[str]) -> str:
    """Parts of a sentence: a, b and c."""
    *first, last = [*parts] or ["none"]
    return f"{', '.join(first)} and {last}" if first else last
