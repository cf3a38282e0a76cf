"""Ensembles at and above the onset of jamming: rows of a table, means, exponents."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from itertools import pairwise, zip_longest
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import StalledWarning, UnjammedWarning
from ..model.laws import Law, Ring, Sector
from ..model.packing import bidisperse
from ..protocols.jamming import jam, natural_pressure, simulate
from ..protocols.moduli import bulk_modulus, shear_modulus
from ..state.disk_state import DiskState
from ..state.state import State

# Contact laws by name, each in its natural units. "ring" is what it is everywhere, with contacts
# that balance; "radical" has the contact lines of the paper.
LAWS: dict[str, Law | None] = {
    "disk": None,
    "ring": Ring(),
    "radical": Ring(contact="radical"),
    "sector": Sector(),
}

# What packings have in common that are averaged over.
GROUP = ("law", "window", "number")

# Part of phi - phi_J that a packing is strained by for its moduli, to begin with, and the tolerance
# of relaxations there: balanced contacts know their forces to 1e-8.
_STRAIN, _TOLERANCE = 0.01, 1e-8

# Part of the rise of pressure that a packing may miss before it counts as rearranged.
_BROKEN = 0.25

# Packings, of those there are, that a mean over them takes, and the standard errors that it has to
# be above zero to have a logarithm.
_FEWEST, _SIGNIFICANT = 3, 2.0

# Tolerance of the onset, where contacts are counted.
_JAMMED = 1e-6

Row = dict[str, Any]


def measure(
    name: str, window: float, number: int, seed: int, excess: Sequence[float] = ()
) -> tuple[Row, list[Row]]:
    """Jam one packing, and follow it upwards.

    Args:
        law: name in `LAWS`.
        window: pressure at the onset, from here to twice as much, in natural units.
        number: of particles, an equal mixture of sizes 1 : 1.4.
        seed: of its random start.
        excess: values of phi - phi_J, rising, to compress it to one after another.

    Returns:
        The packing at its onset, and a row for each value above with its moduli, up to where it
        loses its rigidity if it does. Pressures and moduli are in natural units, see
        `natural_pressure`; seconds are those of the processor.
    """
    began = time.process_time()
    law = LAWS[name]
    with warnings.catch_warnings(record=True) as heard:
        # the rows say what stalled; packings may rearrange on their way up
        warnings.simplefilter("ignore", UnjammedWarning)
        warnings.simplefilter("always", StalledWarning)
        packing = jam(bidisperse(number, seed=seed), law, window, tolerance=_JAMMED)
        stalled = any(issubclass(warning.category, StalledWarning) for warning in heard)
        with simulate(packing, law) as sim:
            onset = sim.relax()
            unit = natural_pressure(onset.packing, law)
            keys = {"law": name, "window": window, "number": number, "seed": seed}
            above = []
            for delta in excess:
                sim.deform(onset.packing.at(onset.packing.phi + delta).box)
                state = sim.relax(_TOLERANCE)
                if state.pressure < window * unit or state.stalled:  # it lost its rigidity
                    break
                reached = keys | {"excess": state.phi - onset.phi} | _numbers(state, unit)
                above.append(reached | _moduli(state, delta, unit))
    row = keys | _numbers(onset, unit) | {"above": max(excess, default=0.0)}
    row["stalled"] = onset.stalled or stalled
    return row | {"seconds": time.process_time() - began}, above


def _numbers(state: State | DiskState, unit: float) -> Row:
    return {
        "phi": state.phi,
        "pressure": state.pressure / unit,
        "coordination": state.coordination,
        "contacts": state.network_contacts,
        "isostatic": state.isostatic_contacts,
        "rattlers": int(np.sum(state.rattlers)),
        "residual": state.residual,
        "stalled": state.stalled,
    }


def _moduli(state: State | DiskState, excess: float, unit: float) -> Row:
    strain = _STRAIN * excess
    found = {
        "shear": [shear_modulus(state, strain, _TOLERANCE, pure) for pure in (False, True)],
        "bulk": [bulk_modulus(state, strain, _TOLERANCE)],
    }
    row: Row = {}
    for name, moduli in found.items():  # the mean over all directions of shear
        row[f"{name}_modulus"] = float(np.mean([modulus.value for modulus in moduli])) / unit
        row[f"{name}_error"] = max(modulus.error for modulus in moduli) / unit
        row[f"{name}_linear"] = all(modulus.linear for modulus in moduli)
    return row


def groups(rows: Sequence[Row]) -> dict[tuple[Any, ...], list[Row]]:
    """Rows of packings that differ in their seed only."""
    found: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        found.setdefault(tuple(row[name] for name in GROUP), []).append(row)
    return dict(sorted(found.items()))


def summarize(rows: Sequence[Row]) -> list[Row]:
    """Means of packings at their onset over seeds, with their standard errors."""
    summary = []
    for key, group in groups(rows).items():
        values = {name: [row[name] for row in group] for name in group[0]}
        values["excess_contacts"] = [row["contacts"] - row["isostatic"] for row in group]
        found = dict(zip(GROUP, key, strict=True)) | {"packings": len(group)}
        for name in ("phi", "pressure", "coordination", "contacts", "excess_contacts", "rattlers"):
            found[name] = float(np.mean(values[name]))
            found[f"{name}_error"] = standard_error(values[name])
        found["stalled"] = sum(values["stalled"])
        found["seconds"] = float(np.mean(values["seconds"]))
        summary.append(found)
    return summary


def standard_error(values: Sequence[float]) -> float:
    """Of the mean of independent values; nan of a single one."""
    if len(values) < 2:
        return float("nan")
    return float(np.std(values, ddof=1) / np.sqrt(len(values)))


def exponents(rows: Sequence[Row]) -> list[Row]:
    """Exponents of pressure, moduli and coordination over phi - phi_J, with standard errors.

    Each is the slope of a straight line through the logarithms of the means over the packings that
    have not rearranged yet, see `unbroken`. The packings at different phi are the same ones, so
    that errors come from leaving out one packing after another (jackknife). Means of fewer than
    three packings, or less than two standard errors above zero, are left out; nan if one is left.
    """
    summary = []
    for key, group in groups(rows).items():
        found = dict(zip(GROUP, key, strict=True))
        for name, quantity in QUANTITIES.items():
            slope, error = jackknife(table(group, excess), table(group, quantity))
            found |= {name: slope, f"{name}_error": error}
        summary.append(found)
    return summary


def excess(row: Row) -> float:
    """phi - phi_J."""
    return float(row["excess"])


def excess_coordination(row: Row) -> float:
    """z - z_iso, with z_iso that of 2 N' - 1 contacts."""
    return float(4.0 * (row["contacts"] - row["isostatic"]) / (row["isostatic"] + 1))


QUANTITIES: dict[str, Callable[[Row], float]] = {
    "pressure": lambda row: float(row["pressure"]),
    "shear_modulus": lambda row: float(row["shear_modulus"]),
    "bulk_modulus": lambda row: float(row["bulk_modulus"]),
    "coordination": excess_coordination,
}


def unbroken(rows: Sequence[Row]) -> list[Row]:
    """The rows of each packing up to where it rearranges.

    From there on its onset is another one. Pressure rises by the integral of K dphi/phi as long as
    a packing stays what it is; the trapezium rule is good to 7 % in steps that double phi - phi_J
    (p ~ x^3). A packing that misses it by more than `_BROKEN` has rearranged.
    """
    kept = []
    for seed in dict.fromkeys(row["seed"] for row in rows):
        series = sorted((row for row in rows if row["seed"] == seed), key=excess)
        kept.append(series[0])
        for before, now in pairwise(series):
            mean = (before["bulk_modulus"] + now["bulk_modulus"]) / 2.0
            expected = mean * np.log(now["phi"] / before["phi"])
            if abs(now["pressure"] - before["pressure"] - expected) > _BROKEN * expected:
                break
            kept.append(now)
    return kept


def table(rows: Sequence[Row], quantity: Callable[[Row], float]) -> NDArray[np.float64]:
    """A quantity of each packing at each phi, nan once it has rearranged, shape (packings, phi)."""
    series: dict[int, list[float]] = {}
    for row in unbroken(rows):
        series.setdefault(row["seed"], []).append(quantity(row))
    return np.array(list(zip_longest(*series.values(), fillvalue=np.nan))).T


def well_known(y: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Columns of a table whose mean is well above zero and over some packings, shape (phi,)."""
    there = np.sum(np.isfinite(y), axis=0) >= min(_FEWEST, len(y))
    if len(y) > 1:
        error = np.array([standard_error(column[np.isfinite(column)]) for column in y.T])
        there &= np.nanmean(y, axis=0) > _SIGNIFICANT * error
    return there


def jackknife(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Slope of log <y> over log <x>, means over packings, and its standard error."""
    count, there = len(x), well_known(y)

    def slope(kept: NDArray[np.bool_]) -> float:
        mean_x, mean_y = (np.nanmean(values[kept][:, there], axis=0) for values in (x, y))
        if there.sum() < 2 or mean_y.min() <= 0.0:
            return float("nan")
        return float(np.polyfit(np.log(mean_x), np.log(mean_y), 1)[0])

    whole = slope(np.ones(count, dtype=bool))
    if count < 2:
        return whole, float("nan")
    without = np.array([slope(np.arange(count) != n) for n in range(count)])
    spread = np.sum((without - without.mean()) ** 2)
    return whole, float(np.sqrt((count - 1) / count * spread))
