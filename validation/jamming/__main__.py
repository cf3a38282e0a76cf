"""Ensembles of packings at the onset of jamming, and above.

    python -m validation.jamming 16 32 64 --seeds 10 --law balanced --out ensemble

Writes table.csv (onsets), scaling.csv (compressed packings), summary.json (means and exponents with
standard errors), onset.png and scaling.png. Packings that are in the tables are not computed again:
an interrupted command goes on when it is repeated, and several laws can share a folder. Packings
are shared by the cores of this machine, or by the ranks of mpiexec. docs/jamming.md has the method.

The natural unit of pressure is k for soft disks, k/2R0 with the mean radius R0 for soft spheres,
tension/R0 for droplets, and kA R0^2 for the other laws.

The tables of this folder come from, with `--out validation/jamming` each:

    16 32 64 256 512 1024 --law disk --seeds 20 --pressure 1e-7
    128 --law disk --seeds 20 --pressure 1e-7 --excess-phi 0.01
    4096 --law disk --seeds 4 --pressure 1e-7
    16 32 64 128 256 --law radical --seeds 20 --pressure 1e-7
    512 --law radical --seeds 10 --pressure 1e-7
    16 32 --law radical --seeds 10 --pressure 1e-16
    64 128 --law radical --seeds 10 --pressure 1e-16 --excess-phi 0.01
    256 --law radical --seeds 5 --pressure 1e-16
    512 --law radical --seeds 3 --pressure 1e-16
    16 32 64 128 --law balanced --seeds 20 --pressure 1e-7
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from lammps_deformable.common.errors import FileError, ParameterError
from lammps_deformable.common.files import make_folder, write_whole
from lammps_deformable.common.ranks import print_once
from lammps_deformable.common.versions import versions
from lammps_deformable.particles.laws import ALL_LAWS

from validation.ensembles import over_cores
from validation.jamming.packings import (
    QUANTITIES,
    SOFT,
    Row,
    by_packing,
    dimension_of,
    excess_phi,
    exponents,
    groups,
    is_of_droplets,
    is_significant,
    measure,
    packing_name,
    standard_error,
    summarize,
    with_tension,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TABLE, SCALING, SUMMARY = "table.csv", "scaling.csv", "summary.json"

# These columns identify a packing.
_KEYS = {"law": str, "onset_pressure": float, "number": int, "seed": int}

# Values of phi - phi_J at which a packing is measured, each half of the next one.
_POINTS = 7

# How far the pressure at the onset must lie below that at the first of them. The onset then is at
# 15 % of that phi - phi_J or less.
_BELOW_FIRST = 300.0

_LABELS = {
    "pressure": "pressure $p$",
    "shear_modulus": "shear modulus $G$",
    "coordination": r"$z - z_\mathrm{iso}$",
}


def main(arguments: Sequence[str] | None = None) -> None:
    formatter = argparse.ArgumentDefaultsHelpFormatter
    parser = argparse.ArgumentParser("validation.jamming", formatter_class=formatter)
    parser.add_argument("numbers", type=int, nargs="+", help="of particles, e.g. 16 32 64")
    parser.add_argument("--seeds", type=int, default=10, help="packings of each size")
    parser.add_argument("--law", choices=(*SOFT, *ALL_LAWS), default="disk")
    parser.add_argument("--tension", type=float, default=0.0, help="droplets of this tension")
    parser.add_argument("--pressure", type=float, default=1e-6, help="at the onset, up to twice it")
    parser.add_argument(
        "--excess-phi", type=float, default=0.0, help="compress to this phi - phi_J, with moduli"
    )
    parser.add_argument(
        "--save", action="store_true", help="each packing at its onset, in the folder `packings`"
    )
    parser.add_argument("--workers", type=int, help="packings at a time")
    parser.add_argument("--out", type=Path, default=Path("ensemble"), help="folder")
    ensemble(**vars(parser.parse_args(arguments)))


def ensemble(
    numbers: Sequence[int],
    seeds: int,
    law: str,
    tension: float,
    pressure: float,
    excess_phi: float,
    save: bool,
    workers: int | None,
    out: Path,
) -> None:
    """Measure what the tables in a folder lack, and write them, means, exponents and pictures."""
    began = time.perf_counter()
    values = [excess_phi / 2.0**n for n in reversed(range(_POINTS))] if excess_phi else []
    law = with_tension(law, tension)
    if values:
        _check_excess(law, pressure, values)
    if save and law in SOFT:
        raise ParameterError(
            f"a packing is saved with its law, and soft {law}s have none: give another --law"
        )
    make_folder(out)
    packings = out / "packings" if save else None
    onsets, scaled = read_table(out / TABLE), read_table(out / SCALING)
    wanted = {
        number: {(law, pressure, number, seed) for seed in range(1, seeds + 1)}
        for number in numbers
    }

    def missing(number: int) -> list[tuple[str, float, int, int]]:
        # means above the onset need all packings at the same phi - phi_J
        there = {
            key(row)
            for row in onsets
            if excess_phi in (0.0, row["excess_phi"])
            and (packings is None or (packings / packing_name(*key(row))).exists())
        }
        return sorted(wanted[number] - there)

    def present(number: int) -> None:
        """Print the means of a size, once they are over all packings."""
        if not missing(number):
            write_summary(out, onsets, scaled)
            for row in summarize(onsets):
                if (row["law"], row["onset_pressure"], row["number"]) == (law, pressure, number):
                    print_once(_line(row))

    def keep(found: tuple[Row, list[Row]]) -> None:
        onset, compressed = found
        onsets[:] = [*(row for row in onsets if key(row) != key(onset)), onset]
        scaled[:] = [*(row for row in scaled if key(row) != key(onset)), *compressed]
        write_tables(out, onsets, scaled)
        present(onset["number"])

    for number in wanted:
        present(number)
    runs = [(*packing, values, packings) for number in wanted for packing in missing(number)]
    for found in over_cores(measure, runs, workers, out / "kept"):
        keep(found)
    shutil.rmtree(out / "kept", ignore_errors=True)  # the tables have them
    for row in exponents(scaled):
        found = (f"{name.replace('_', ' ')} {_value(row, name, 3)}" for name in QUANTITIES)
        where = f"{row['law']}, N = {row['number']}"
        print_once(f"{where}, exponents over phi - phi_J: {', '.join(found)}")
    onset_figure(onsets).savefig(out / "onset.png", dpi=110)
    if scaled:
        scaling_figure(scaled).savefig(out / "scaling.png", dpi=110)
    print_once(f"wrote {out} ({time.perf_counter() - began:.0f} s)")


def _check_excess(law: str, pressure: float, excess: Sequence[float]) -> None:
    """Refuse values of phi - phi_J that are out of range, or too near to the onset."""
    first, last = excess[0], excess[-1]
    if not 0.0 < last < 0.1:
        raise ParameterError(f"excess-phi must lie between 0 and 0.1, not {last}")
    # p = 0.4 x for disks, more for droplets, half of that in space, 5 x^3 for rings at
    # x = phi - phi_J, in natural units
    linear = law in SOFT or is_of_droplets(law)
    slope = 0.4 if dimension_of(law) == 2 else 0.2
    largest = (slope * first if linear else 5.0 * first**3) / _BELOW_FIRST
    if pressure > largest:
        raise ParameterError(
            f"a pressure of {pressure:g} at the onset is too near to the first phi - phi_J, "
            f"{first:.2g}: with the {law} law it may be {largest:.1g} at most"
        )


def _line(row: Row) -> str:
    """A line with means over packings at their onset."""
    d = dimension_of(row["law"])
    least = f"{d}N' - {d - 1}"
    return (
        f"{row['law']}, N = {row['number']}: phi_J = {_value(row, 'phi', 5)}, contacts "
        f"{_value(row, 'contacts', 1)}, beyond {least} {_value(row, 'excess_contacts', 2)}, "
        f"{row['seconds']:.2g} s each" + (f", {row['stalled']} STALLED" if row["stalled"] else "")
    )


def _value(row: Row, name: str, digits: int) -> str:
    """A value with its standard error, which is nan for a single packing; - if it is not known."""
    if row[name] != row[name]:
        return "-"
    error = row[f"{name}_error"]
    return f"{row[name]:.{digits}f}" + (f" +- {error:.{digits}f}" if error == error else "")


def key(row: Mapping[str, Any]) -> tuple[Any, ...]:
    """The columns that identify a packing: law, onset pressure, number of particles, seed."""
    return tuple(row[name] for name in _KEYS)


def read_table(path: Path) -> list[Row]:
    """Rows of a table; none if it is missing.

    Raises:
        FileError: it is another table.
    """
    if not path.exists():
        return []
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    if rows and not set(_KEYS) <= set(rows[0]):
        raise FileError(f"{path} is no table of this command: name another folder")
    return [{name: _KEYS.get(name, _typed)(text) for name, text in row.items()} for row in rows]


def _typed(text: str) -> bool | int | float:
    if text in ("True", "False"):
        return text == "True"
    return int(text) if text.isdecimal() else float(text)


def write_tables(folder: Path, onsets: Sequence[Row], scaled: Sequence[Row]) -> None:
    """Write both tables.

    The compressed packings are written first: a row of an onset means that they are complete.

    Args:
        folder: of the ensemble.
        onsets: a row per packing, see `measure`.
        scaled: rows of compressed packings, see `measure`.
    """
    for name, rows in ((SCALING, scaled), (TABLE, onsets)):
        if rows:
            text = io.StringIO(newline="")
            writer = csv.DictWriter(text, rows[0].keys())
            writer.writeheader()
            writer.writerows(sorted(rows, key=key))
            write_whole(folder / name, text.getvalue())


def write_summary(folder: Path, onsets: Sequence[Row], scaled: Sequence[Row]) -> None:
    """Write means over the onsets, and exponents of the compressed packings."""
    summary = {
        "onset": [_without_nan(row) for row in summarize(onsets)],
        "exponents": [_without_nan(row) for row in exponents(scaled)],
        "versions": versions(),
    }
    write_whole(folder / SUMMARY, json.dumps(summary, indent=2) + "\n")


def _without_nan(row: Row) -> Row:
    """JSON has no nan: the error of a single packing, or an exponent that cannot be fitted."""
    return {name: None if value != value else value for name, value in row.items()}


def onset_figure(rows: Sequence[Row]) -> Figure:
    """phi_J and the contacts beyond isostaticity over the number of particles."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    panels = figure.subplots(1, 2)
    summary = summarize(rows)
    sizes = sorted({row["number"] for row in summary})
    for law, pressure in dict.fromkeys((row["law"], row["onset_pressure"]) for row in summary):
        chosen = [row for row in summary if (row["law"], row["onset_pressure"]) == (law, pressure)]
        for ax, name in zip(panels, ("phi", "excess_contacts"), strict=True):
            ax.errorbar(
                [row["number"] for row in chosen],
                [row[name] for row in chosen],
                [row[f"{name}_error"] for row in chosen],
                marker="o",
                capsize=3,
                label=f"{law}, $p$ from {pressure:g}",
            )
    panels[0].set(ylabel=r"$\phi_J$")
    panels[1].set(ylabel=r"$N_\mathrm{contacts} - (2N' - 1)$")
    for ax in panels:
        ax.set(xlabel="number of particles $N$", xscale="log")
        ax.set_xticks(sizes, [str(size) for size in sizes])
        ax.minorticks_off()
        ax.grid(which="major", alpha=0.3)
    panels[0].legend()
    return figure


def scaling_figure(rows: Sequence[Row]) -> Figure:
    """Pressure, shear modulus and coordination over phi - phi_J, with the fitted exponents."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13.0, 4.4), layout="constrained")
    panels = dict(zip(_LABELS, figure.subplots(1, len(_LABELS)), strict=True))
    fitted = exponents(rows)
    for (of, group), fit in zip(groups(rows).items(), fitted, strict=True):
        law, _, number = of
        for name, ax in panels.items():
            slope = f"{fit[name]:.2f} ± {fit[f'{name}_error']:.2f}"
            _draw_means(ax, group, QUANTITIES[name], f"{law}, $N$ = {number}: {slope}")
    for name, ax in panels.items():
        ax.set(xlabel=r"$\phi - \phi_J$", ylabel=_LABELS[name], xscale="log", yscale="log")
        ax.grid(which="major", alpha=0.3)
        ax.legend(title="exponent", fontsize=8)
    return figure


def _draw_means(
    ax: Axes, rows: Sequence[Row], quantity: Callable[[Row], float], label: str
) -> None:
    """Draw means over packings with their standard errors, and the fitted line."""
    y = by_packing(rows, quantity)
    x, mean = np.nanmean(by_packing(rows, excess_phi), axis=0), np.nanmean(y, axis=0)
    error = [standard_error(column[np.isfinite(column)]) for column in y.T]
    (points, *_) = ax.errorbar(x, mean, error, fmt="o", capsize=3, label=label)
    fitted = is_significant(y)
    x, mean = x[fitted], mean[fitted]
    if len(x) > 1:
        line = np.polyfit(np.log(x), np.log(mean), 1)
        ax.plot(x, np.exp(np.polyval(line, np.log(x))), color=points.get_color(), linewidth=1.0)


if __name__ == "__main__":
    main()
