"""The command `deformable jam`: ensembles at the onset of jamming, kept in a folder."""

from __future__ import annotations

import csv
import importlib.util
import json
import time
from collections.abc import Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer
from mpi4py import MPI

from ..common.errors import FileError, ParameterError
from ..common.parallel import parallel_map
from ..common.validate import positive
from ..common.versions import versions
from ..io.run_folder import SUMMARY, TABLE, refuse
from ..studies.ensemble import Row, exponents, measure, summarize

SCALING = "scaling.csv"

# Each value of phi - phi_J is half of the next one.
_POINTS = 7

# Pressures at phi - phi_J = x, in natural units, are about 0.4 x (disks) or 4 x^3. An onset has to
# lie so far below the first of them for phi_J not to matter there: at 15 % of that x, or less.
_FAR = 300.0

_KEYS = {"law": str, "window": float, "number": int, "seed": int}


class LawName(str, Enum):
    """Contact laws by name, as in `ensemble.LAWS`."""

    DISK = "disk"
    RING = "ring"
    RADICAL = "radical"
    SECTOR = "sector"


def jam_command(
    number: Annotated[
        list[int] | None, typer.Option(help="Numbers of particles, e.g. 16 32 64.  [default: 64]")
    ] = None,
    more: Annotated[list[int] | None, typer.Argument(hidden=True)] = None,
    seeds: Annotated[int, typer.Option(help="Packings of each size: seeds 1, 2, ...")] = 10,
    law: Annotated[
        LawName, typer.Option(help="Contact law; radical: rings on radical axes.")
    ] = LawName.RING,
    pressure: Annotated[
        float, typer.Option(help="Pressure at the onset in natural units, up to twice as much.")
    ] = 1e-7,
    above: Annotated[
        float,
        typer.Option(help="Follow each packing to this phi - phi_J, with its moduli; 0: do not."),
    ] = 0.0,
    workers: Annotated[int | None, typer.Option(help="Processes; all cores if not given.")] = None,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "jam",
) -> None:
    """Jam random bidisperse packings of one law, and tell what their onsets have in common.

    Natural units of pressure are k of soft disks and kA R0^2 of rings and sectors, with the mean
    radius R0.
    Writes table.csv (the onsets), scaling.csv (above them), summary.json (means, exponents, their
    standard errors) and, with matplotlib, onset.png and scaling.png. What the tables in the folder
    have already is kept and not computed again: so an interrupted run goes on, and several laws
    come together in one folder.
    """
    if MPI.COMM_WORLD.size > 1:
        raise ParameterError("jam uses the cores by itself: start it without mpiexec")
    began = time.perf_counter()
    numbers = [*(number or []), *(more or [])] or [64]
    excess = [above / 2.0**n for n in reversed(range(_POINTS))] if above else []
    _check(numbers, seeds, law, pressure, excess)
    folder = refuse(out, but="jamming")
    folder.mkdir(parents=True, exist_ok=True)
    onsets, beyond = _read(folder / TABLE), _read(folder / SCALING)
    for count in numbers:
        runs = [(law.value, pressure, count, seed, excess) for seed in range(1, seeds + 1)]
        # means above the onset want each packing at the same values of phi - phi_J
        kept = {_key(row) for row in onsets if above in (0.0, row["above"])}
        runs = [run for run in runs if run[:4] not in kept]

        def keep(found: tuple[Row, list[Row]]) -> None:
            row, rows = found
            onsets[:] = [*(other for other in onsets if _key(other) != _key(row)), row]
            beyond[:] = [*(other for other in beyond if _key(other) != _key(row)), *rows]
            _tables(folder, onsets, beyond)

        parallel_map(measure, runs, workers, f"N = {count}", keep)
        _summary(folder, onsets, beyond)
        for row in summarize(onsets):
            if [row["law"], row["window"], row["number"]] == [law.value, pressure, count]:
                _say(row)
    for row in exponents(beyond):
        typer.echo(
            f"{row['law']}, N = {row['number']}, exponents over phi - phi_J: "
            + ", ".join(
                f"{name} {row[name]:.3f} +- {row[f'{name}_error']:.3f}"
                for name in ("pressure", "shear_modulus", "bulk_modulus", "coordination")
            )
        )
    if importlib.util.find_spec("matplotlib"):
        from ..studies import ensemble_figures as figures

        figures.onset(onsets).savefig(folder / "onset.png", dpi=110)
        if beyond:
            figures.scaling(beyond).savefig(folder / "scaling.png", dpi=110)
    typer.echo(f"wrote {out} ({time.perf_counter() - began:.0f} s)")


def _check(
    numbers: Sequence[int], seeds: int, law: LawName, pressure: float, excess: Sequence[float]
) -> None:
    positive("pressure", pressure)
    for count in numbers:
        if count < 1:
            raise ParameterError(f"number must be at least 1, not {count}")
    if seeds < 1:
        raise ParameterError(f"seeds must be at least 1, not {seeds}")
    if not excess:
        return
    if not 0.0 < excess[-1] < 0.1:
        raise ParameterError(f"above must lie between 0 and 0.1, not {excess[-1]}")
    first = excess[0]
    largest = (0.4 * first if law is LawName.DISK else 4.0 * first**3) / _FAR
    if pressure > largest:
        raise ParameterError(
            f"a packing at the pressure {pressure:g} is not at its onset as seen from phi - phi_J "
            f"= {first:.2g}, the first value: with the {law.value} law take at most {largest:.1g}"
        )


def _key(row: Mapping[str, Any]) -> tuple[Any, ...]:
    return tuple(row[name] for name in _KEYS)


def _say(row: Row) -> None:
    def mean(name: str, digits: int) -> str:
        error = row[f"{name}_error"]  # none of a single packing
        return f"{row[name]:.{digits}f}" + (f" +- {error:.{digits}f}" if error == error else "")

    typer.echo(
        f"{row['law']}, N = {row['number']}: phi_J = {mean('phi', 5)}, contacts "
        f"{mean('contacts', 1)}, beyond 2N' - 1 {mean('excess_contacts', 2)}, "
        f"{row['seconds']:.2g} s each" + (f", {row['stalled']} STALLED" if row["stalled"] else "")
    )


def _finite(row: Row) -> Row:
    """JSON has no nan: the error of a single packing, the exponent of what changes its sign."""
    return {name: None if value != value else value for name, value in row.items()}


def _read(path: Path) -> list[Row]:
    """Rows of a table in the folder, if it is there."""
    if not path.exists():
        return []
    try:
        with path.open(newline="") as file:
            return [
                {name: _KEYS.get(name, _number)(value) for name, value in row.items()}
                for row in csv.DictReader(file)
            ]
    except (ValueError, TypeError, AttributeError) as error:
        raise FileError(f"{path} is no table of this command ({error}): move it away") from None


def _number(text: str) -> bool | int | float:
    if text in ("True", "False"):
        return text == "True"
    return int(text) if text.isdecimal() else float(text)


def _tables(out: Path, onsets: Sequence[Row], beyond: Sequence[Row]) -> None:
    """Each whole or not at all, and what is above the onsets first: an onset says that it is."""
    for name, table in ((SCALING, beyond), (TABLE, onsets)):
        if table:
            part = out / f"{name}.part"
            with part.open("w", newline="") as file:
                writer = csv.DictWriter(file, table[0].keys())
                writer.writeheader()
                writer.writerows(sorted(table, key=_key))
            part.replace(out / name)


def _summary(out: Path, onsets: Sequence[Row], beyond: Sequence[Row]) -> None:
    summary = {
        "onset": [_finite(row) for row in summarize(onsets)],
        "exponents": [_finite(row) for row in exponents(beyond)],
        "versions": versions(),
    }
    part = out / f"{SUMMARY}.part"
    part.write_text(json.dumps(summary, indent=2) + "\n")
    part.replace(out / SUMMARY)
