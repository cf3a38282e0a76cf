"""The command `deformable jam`: ensembles at the onset of jamming, kept in a folder."""

from __future__ import annotations

import importlib.util
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from ..common.errors import FileError, ParameterError
from ..common.files import make_folder
from ..common.parallel import parallel_map
from ..common.progress import print_once
from ..common.ranks import led
from ..common.validate import positive
from ..io.run_folder import TABLE, refuse
from ..model.droplet import ALL_LAWS
from ..model.packing import Packing
from ..studies.ensemble.packings import (
    QUANTITIES,
    SOFT,
    Row,
    dimension_of,
    exponents,
    is_of_droplets,
    measure,
    packing_name,
    summarize,
    with_tension,
)
from ..studies.ensemble.tables import (
    SCALING,
    key,
    origin_of,
    read_table,
    write_summary,
    write_tables,
)
from .material_options import Dimension, FromFile, FromFrame, FromRadii
from .options import CommandLineError, choice_option, is_given
from .settings import FILE, InFile, check_in_file, law_and_dimension

# Values of phi - phi_J at which a packing is measured, each half of the next one.
_POINTS = 7

# How far the pressure at the onset must lie below that at the first of them. The onset then is at
# 15 % of that phi - phi_J or less.
_BELOW_FIRST = 300.0


@led
def jam_command(
    context: typer.Context,
    numbers: Annotated[
        list[int] | None, typer.Argument(help="Numbers of particles, e.g. 16 32 64.")
    ] = None,
    from_file: FromFile = None,
    from_radii: FromRadii = None,
    from_frame: FromFrame = -1,
    seeds: Annotated[int, typer.Option(help="Packings of each size: seeds 1, 2, ...")] = 10,
    law: Annotated[
        str | None,
        choice_option(
            (*SOFT, *ALL_LAWS),
            "Contact law: soft disks (disk, the default), in three dimensions soft spheres "
            "(sphere), or as in `deformable compress`.",
        ),
    ] = None,
    dimension: Dimension = None,
    tension: Annotated[
        float,
        typer.Option(
            help="Ring laws: droplets of this line tension [energy/length] that conserve their "
            "area, in the place of particles that conserve their perimeter (kA = 1). Of droplets "
            "in three dimensions surface tension, 1 if not given."
        ),
    ] = 0.0,
    pressure: Annotated[
        float,
        typer.Option(help="Pressure at the onset, between this and twice this [natural units]."),
    ] = 1e-6,
    excess_phi: Annotated[
        float,
        typer.Option(
            help="Compress each packing to this phi - phi_J, and measure its moduli on the way; "
            "0: only measure the onset."
        ),
    ] = 0.0,
    save: Annotated[
        bool,
        typer.Option(
            "--save",
            help="Save each packing at its onset in `packings` of the output folder, as a run of "
            "one state.",
        ),
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(help="Packings at a time; by default one a core, or one a rank of mpiexec."),
    ] = None,
    out: Annotated[str, typer.Option(metavar="PATH", help="Output folder.")] = "jam",
) -> None:
    """Jam random bidisperse packings, and average over their onsets; or jam one from a file.

    The natural unit of pressure is k for soft disks, k/2R0 with the mean radius R0 for soft
    spheres, tension/R0 for droplets, and kA R0^2 for the other laws. Writes table.csv (onsets),
    scaling.csv (compressed packings), summary.json (means and exponents with standard errors) and,
    if matplotlib is installed, onset.png and scaling.png. Packings that are in the tables are not
    computed again:
    an interrupted command goes on when it is repeated, and several laws can share a folder.
    Packings are shared by the cores of this machine, or by the ranks of mpiexec.
    """
    began = time.perf_counter()
    values = [excess_phi / 2.0**n for n in reversed(range(_POINTS))] if excess_phi else []
    given = tuple(name for name in ("seeds", *FILE) if is_given(context, name))
    law, dimension = law_and_dimension(law, dimension, SOFT)
    start = _start(numbers, InFile(from_file, from_radii, from_frame), given, dimension)
    numbers, seeds = (numbers or [], seeds) if start is None else ([len(start)], 1)
    for name, count in (*(("number", number) for number in numbers), ("seeds", seeds)):
        if count < 1:
            raise ParameterError(f"{name} must be at least 1, not {count}")
    positive("pressure", pressure)
    law = with_tension(law, tension)
    if workers is not None and workers < 1:
        raise ParameterError(f"workers must be at least 1, not {workers}")
    if values:
        _check_excess(law, pressure, values)
    if save and law in SOFT:
        raise ParameterError(
            f"a packing is saved with its law, and soft {law}s have none: give another --law"
        )
    folder = refuse(out, but="jamming")
    origin = {"from_file": from_file, "from_radii": from_radii, "from_frame": from_frame}
    origin = {} if start is None else origin
    _check_origin(folder, origin)
    make_folder(folder)
    packings = folder / "packings" if save else None
    onsets, scaling = read_table(folder / TABLE), read_table(folder / SCALING)
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
            write_summary(folder, onsets, scaling, origin)
            for row in summarize(onsets):
                if (row["law"], row["onset_pressure"], row["number"]) == (law, pressure, number):
                    print_once(_means(row))

    def keep(found: tuple[Row, list[Row]]) -> None:
        onset, compressed = found
        onsets[:] = [*(row for row in onsets if key(row) != key(onset)), onset]
        scaling[:] = [*(row for row in scaling if key(row) != key(onset)), *compressed]
        write_tables(folder, onsets, scaling)
        present(onset["number"])

    for number in wanted:
        present(number)
    runs = [(*packing, values, packings, start) for number in wanted for packing in missing(number)]
    parallel_map(measure, runs, workers, "packings", keep)
    for row in exponents(scaling):
        print_once(_exponents(row))
    if importlib.util.find_spec("matplotlib"):
        from ..studies.ensemble import figures

        figures.onset(onsets).savefig(folder / "onset.png", dpi=110)
        if scaling:
            figures.scaling(scaling).savefig(folder / "scaling.png", dpi=110)
    print_once(f"wrote {out} ({time.perf_counter() - began:.0f} s)")


def _start(
    numbers: Sequence[int] | None, in_file: InFile, given: Sequence[str], dimension: int
) -> Packing | None:
    """The packing in a file, which is jammed in place of random ones; None without a file."""
    if in_file.from_file is not None and (numbers or "seeds" in given):
        word = "--seeds" if "seeds" in given else "a number of particles"
        raise ParameterError(
            f"the packing is that in '{in_file.from_file}', and {word} is about random ones: leave "
            "it out"
        )
    check_in_file(in_file, given)
    if in_file.from_file is not None:
        return in_file.packing_in_file(dimension)
    if not numbers:
        raise CommandLineError("give numbers of particles, e.g. jam 16 32 64, or --from FILE")
    return None


def _check_origin(folder: Path, origin: Mapping[str, Any]) -> None:
    """Refuse a folder with onsets of other packings: its tables do not tell them apart."""
    if not (folder / TABLE).exists():
        return
    saved = origin_of(folder)
    if saved != origin:
        of = f"the packing in '{saved['from_file']}'" if saved else "random packings"
        raise FileError(f"'{folder}' holds onsets of {of}: name another folder")


def _check_excess(law: str, pressure: float, excess_phi: Sequence[float]) -> None:
    """Refuse values of phi - phi_J that are out of range, or too near to the onset."""
    first, last = excess_phi[0], excess_phi[-1]
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


def _exponents(row: Row) -> str:
    """A line with the exponents of pressure, moduli and coordination."""
    found = (f"{name.replace('_', ' ')} {_value(row, name, 3)}" for name in QUANTITIES)
    return f"{row['law']}, N = {row['number']}, exponents over phi - phi_J: {', '.join(found)}"


def _means(row: Row) -> str:
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
