"""Ensembles at and above the onset of jamming: packings, means, exponents."""

from __future__ import annotations

import math
import time
import warnings
from dataclasses import replace
from itertools import pairwise, zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np
from lammps_deformable.common.checks import zero_or_more
from lammps_deformable.common.errors import ParameterError, StalledWarning, UnjammedWarning
from lammps_deformable.engine.jamming import jam
from lammps_deformable.engine.relax import TOLERANCE
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.particles.generators import bidisperse
from lammps_deformable.particles.laws import ALL_LAWS, Droplet, Ring, SoftContact, natural_pressure
from lammps_deformable.state.state import State
from mpi4py import MPI
from numpy.typing import NDArray

from validation.ensembles import power_law
from validation.finite_strain import bulk_modulus, shear_modulus

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

# Means are over packings with equal values of these columns.
GROUP = ("law", "onset_pressure", "number")

# Strain of a modulus over phi - phi_J, and tolerance of the states: the forces of balanced contacts
# are exact to 1e-8.
_STRAIN, _TOLERANCE = 0.01, 1e-8

# A packing has rearranged if its pressure rises by so much more or less than the integral of the
# bulk modulus, relative to the latter.
_REARRANGED = 0.25

# A mean is fitted if it is over at least this many packings and at least this many standard errors
# above zero.
_FEWEST_PACKINGS, _STANDARD_ERRORS = 3, 2.0

Row = dict[str, Any]

_TENSION = ", tension "

# Names of soft disks and soft spheres, and their dimension.
SOFT = {"disk": 2, "sphere": 3}


def with_tension(law: str, tension: float) -> str:
    """The name of a law in tables: `balanced`, or `balanced, tension 1.0` of droplets.

    Raises:
        ParameterError: the tension is not 0 or positive, or the law has none.
    """
    if zero_or_more("tension", tension) == 0.0:
        return law
    if not isinstance(contact_law(law), (Ring, Droplet)):
        raise ParameterError(
            f"the law {law} has no tension: leave it out, or take a ring law or droplet"
        )
    return f"{law}{_TENSION}{float(tension)!r}"


def is_of_droplets(law: str) -> bool:
    """Whether a name of `with_tension` is that of droplets."""
    return _TENSION in law or law == Droplet().name


def contact_law(law: str) -> Any:
    """The law of a name of `with_tension`."""
    name, _, tension = law.partition(_TENSION)
    found = SoftContact() if name in SOFT else ALL_LAWS[name]
    if tension and isinstance(found, Ring):
        return replace(found, kA=math.inf, kP=0.0, tension=float(tension))
    return Droplet(float(tension)) if tension and isinstance(found, Droplet) else found


def dimension_of(law: str) -> int:
    """Dimension of the packings of a law of this name."""
    settings = contact_law(law)
    return SOFT.get(law) or settings.dimension


def measure(
    law: str,
    onset_pressure: float,
    number: int,
    seed: int,
    excess_phi: Sequence[float] = (),
    folder: Path | None = None,
) -> tuple[Row, list[Row]]:
    """Jam one packing, and compress it from its onset.

    Args:
        law: `disk`, `sphere`, a name in `ALL_LAWS`, or one of `with_tension`.
        onset_pressure: the pressure at the onset lies between this and twice this, in natural
            units, see `natural_pressure`.
        number: of particles, an equal mixture of sizes 1 : 1.4.
        seed: of the random start.
        excess_phi: values of phi - phi_J, rising, at which moduli are measured.
        folder: the packing at its onset is saved there under its `packing_name`; not of disks
            and spheres.

    Returns:
        The packing at its onset, and a row for each value of phi - phi_J up to where the packing
        loses its rigidity, if it does. Pressures and moduli are in natural units, seconds are
        processor time.
    """
    began = time.process_time()
    settings = contact_law(law)
    with warnings.catch_warnings(record=True) as caught:
        # rows have a column for what stalled; packings may rearrange while they are compressed
        warnings.simplefilter("ignore", UnjammedWarning)
        warnings.simplefilter("always", StalledWarning)
        start = bidisperse(number, dimension=dimension_of(law), seed=seed)
        threshold = onset_pressure * natural_pressure(start, settings)
        packing = jam(
            start, settings, pressure=threshold, tolerance=TOLERANCE
        ).packing  # counts contacts
        stalled = any(issubclass(warning.category, StalledWarning) for warning in caught)
        with Simulation(packing, settings, comm=MPI.COMM_SELF) as sim:
            onset = sim.relax()
            if folder is not None and law not in SOFT:
                name = packing_name(law, onset_pressure, number, seed)
                onset.save(folder / name, mode="w")  # of an interrupted measurement
            unit = natural_pressure(onset.packing, settings)
            key = {"law": law, "onset_pressure": onset_pressure, "number": number, "seed": seed}
            compressed = []
            for excess in excess_phi:
                sim.deform(onset.packing.at(onset.packing.phi + excess).box)
                state = sim.relax(_TOLERANCE)
                if state.pressure < onset_pressure * unit or not state.converged:
                    break  # it lost its rigidity
                reached = key | {"excess_phi": state.phi - onset.phi} | _numbers(state, unit)
                compressed.append(reached | _moduli(state, excess, unit))
    row = key | _numbers(onset, unit) | {"excess_phi": max(excess_phi, default=0.0)}
    row["stalled"] = (not onset.converged) or stalled
    return row | {"seconds": time.process_time() - began}, compressed


def packing_name(law: str, onset_pressure: float, number: int, seed: int) -> str:
    """Name of the folder of a saved packing, e.g. `balanced_1e-07_64_3`."""
    return f"{law.replace(_TENSION, '_')}_{onset_pressure:g}_{number}_{seed}"


def _numbers(state: State, unit: float) -> Row:
    return {
        "phi": state.phi,
        "pressure": state.pressure / unit,
        "coordination": state.coordination,
        "contacts": state.network_contacts,
        "isostatic": state.isostatic_contacts,
        "rattlers": int(np.sum(state.rattlers)),
        "residual": state.residual,
        "stalled": (not state.converged),
    }


def _moduli(state: State, excess_phi: float, unit: float) -> Row:
    strain = _STRAIN * excess_phi
    ways = (False, True) if state.packing.dimension == 2 else (False,)
    found = {
        "shear": [shear_modulus(state, strain, pure=pure) for pure in ways],
        "bulk": [bulk_modulus(state, strain)],
    }
    row: Row = {}
    for name, moduli in found.items():  # in the plane over all directions of shear
        row[f"{name}_modulus"] = float(np.mean([modulus.value for modulus in moduli])) / unit
        row[f"{name}_error"] = max(modulus.error for modulus in moduli) / unit
        row[f"{name}_linear"] = all(modulus.linear for modulus in moduli)
    return row


def groups(rows: Sequence[Row]) -> dict[tuple[Any, ...], list[Row]]:
    """Rows of packings that differ only in their seed."""
    found: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        found.setdefault(tuple(row[name] for name in GROUP), []).append(row)
    return dict(sorted(found.items()))


def summarize(rows: Sequence[Row]) -> list[Row]:
    """Means over packings at their onset, with standard errors."""
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
    """Standard error of the mean of independent values; nan for a single one."""
    if len(values) < 2:
        return float("nan")
    return float(np.std(values, ddof=1) / np.sqrt(len(values)))


def exponents(rows: Sequence[Row]) -> list[Row]:
    """Exponents of pressure, moduli and coordination over phi - phi_J, with standard errors.

    Each is the slope of a straight line through the logarithms of means over packings that have not
    rearranged yet, see `before_rearrangement`. The packings at different phi are the same ones, so
    that errors come from leaving out one packing after another (jackknife). A mean is fitted if it
    is over at least three packings and at least two standard errors above zero; an exponent from
    fewer than two means is nan.
    """
    summary = []
    for key, group in groups(rows).items():
        found = dict(zip(GROUP, key, strict=True))
        for name, quantity in QUANTITIES.items():
            slope, error = jackknife(by_packing(group, excess_phi), by_packing(group, quantity))
            found |= {name: slope, f"{name}_error": error}
        summary.append(found)
    return summary


def excess_phi(row: Row) -> float:
    """phi - phi_J."""
    return float(row["excess_phi"])


def excess_coordination(row: Row) -> float:
    """z - z_iso, where z_iso is the coordination with d N' - d + 1 contacts."""
    d = dimension_of(row["law"])
    return float(2.0 * d * (row["contacts"] - row["isostatic"]) / (row["isostatic"] + d - 1))


QUANTITIES: dict[str, Callable[[Row], float]] = {
    "pressure": lambda row: float(row["pressure"]),
    "shear_modulus": lambda row: float(row["shear_modulus"]),
    "bulk_modulus": lambda row: float(row["bulk_modulus"]),
    "coordination": excess_coordination,
}


def before_rearrangement(rows: Sequence[Row]) -> list[Row]:
    """The rows of each packing up to where it rearranges and so gets another onset.

        p2 - p1 = int K dphi / phi

    holds as long as a packing keeps its contacts. The trapezoidal rule is good to 7 % in steps that
    double phi - phi_J (p ~ x^3). A packing with a deviation of more than 25 % has rearranged.
    """
    kept = []
    for seed in dict.fromkeys(row["seed"] for row in rows):
        series = sorted((row for row in rows if row["seed"] == seed), key=excess_phi)
        kept.append(series[0])
        for before, now in pairwise(series):
            mean = (before["bulk_modulus"] + now["bulk_modulus"]) / 2.0
            expected = mean * np.log(now["phi"] / before["phi"])
            if abs(now["pressure"] - before["pressure"] - expected) > _REARRANGED * expected:
                break
            kept.append(now)
    return kept


def by_packing(rows: Sequence[Row], quantity: Callable[[Row], float]) -> NDArray[np.float64]:
    """A quantity of each packing at each phi, nan once it has rearranged, shape (packings, phi)."""
    series: dict[int, list[float]] = {}
    for row in before_rearrangement(rows):
        series.setdefault(row["seed"], []).append(quantity(row))
    return np.array(list(zip_longest(*series.values(), fillvalue=np.nan))).T


def is_significant(y: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Columns whose mean is well above zero and over at least three packings, shape (phi,).

    Of one or two packings all have to be there; the error of a single one counts as zero.
    """
    significant = np.sum(np.isfinite(y), axis=0) >= min(_FEWEST_PACKINGS, len(y))
    columns = (column[np.isfinite(column)] for column in y.T)
    error = np.array([standard_error(some) if len(y) > 1 else 0.0 for some in columns])
    return significant & (np.nanmean(y, axis=0) > _STANDARD_ERRORS * error)


def jackknife(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Slope of log <y> over log <x>, where <> is the mean over packings, and its standard error."""
    count, fitted = len(x), is_significant(y)

    def slope(kept: NDArray[np.bool_]) -> float:
        mean_x, mean_y = (np.nanmean(values[kept][:, fitted], axis=0) for values in (x, y))
        if fitted.sum() < 2 or mean_y.min() <= 0.0:
            return float("nan")
        return power_law(mean_x, mean_y)

    of_all = slope(np.ones(count, dtype=bool))
    if count < 2:
        return of_all, float("nan")
    without = np.array([slope(np.arange(count) != n) for n in range(count)])
    spread = np.sum((without - without.mean()) ** 2)
    return of_all, float(np.sqrt((count - 1) / count * spread))
