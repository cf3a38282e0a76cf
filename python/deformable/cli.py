"""The command `deformable`."""

from __future__ import annotations

import importlib.util
import math
import sys
import time
import warnings
from concurrent.futures.process import BrokenProcessPool
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer
from mpi4py import MPI
from tqdm import tqdm

from .beads import Beads
from .compression import check_protocol
from .engine import silent_lammps
from .errors import FileError, LammpsError, ParameterError
from .files import frames_in, load, numbers
from .jam_command import jam_command
from .jamming import jam
from .models import Model, Ring, Sector
from .movies import movie as draw_movie
from .packing import Packing, bidisperse, polydisperse, positive
from .plugin import directory
from .runs import compress_in
from .runs import resume as finish
from .simulation import Simulation
from .versions import mpi_of_lammps, mpi_of_python, versions

app = typer.Typer(
    help="Two-dimensional deformable particles in LAMMPS.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

STYLES = (
    ("pair", "deformable/ring"),
    ("pair", "deformable/sector"),
    ("fix", "deformable/wall"),
    ("fix", "deformable/stick"),
    ("fix", "deformable/polygon"),
    ("compute", "deformable/contact"),
)


app.command("jam")(jam_command)


# What describes a packing and its law; the rest describes what is done to it.
PACKING_OPTIONS = (
    *("number", "radii", "fraction", "polydispersity", "aspect", "tilt", "seed"),
    *("law", "ka", "kp", "contact", "reach"),
)


# Residual above which a relaxation of a law fell short: the default of `Simulation.relax`.
TOLERANCE = 1e-6


class Lines(str, Enum):
    """Where contact lines are."""

    RADICAL = "radical"
    BALANCED = "balanced"


class Law(str, Enum):
    """Contact laws by name."""

    RING = "ring"
    SECTOR = "sector"


def main() -> None:
    """Run the command; errors of the user are one line and exit code 2."""
    warnings.showwarning = lambda message, *_: tqdm.write(f"warning: {message}", file=sys.stderr)
    warnings.simplefilter("always", UserWarning)
    try:
        app()
    except (
        ParameterError,
        FileError,
        LammpsError,
        ImportError,
        OSError,
        BrokenProcessPool,
    ) as error:
        world = MPI.COMM_WORLD
        if world.rank > 0:
            time.sleep(1.0)  # rank 0 speaks for all if it failed as well, and ends them
        print(f"error: {error}", file=sys.stderr, flush=True)
        if world.size > 1:
            time.sleep(0.5)  # mpiexec may lose a line that it has not passed on yet
            world.Abort(2)  # the others may be waiting for this rank
        sys.exit(2)


@app.command()
def compress(
    context: typer.Context,
    number: Annotated[int, typer.Option(help="Number of particles.")] = 128,
    radii: Annotated[
        tuple[float, float], typer.Option(help="Radii of small and large particles.")
    ] = (0.5, 0.7),
    fraction: Annotated[float, typer.Option(help="Number fraction of large particles.")] = 0.5,
    polydispersity: Annotated[
        float | None,
        typer.Option(
            help="Instead of two sizes, log-normal radii of mean 0.5 with this standard deviation "
            "over the mean.",
            show_default=False,
        ),
    ] = None,
    aspect: Annotated[float, typer.Option(help="Height over width of the box.")] = 1.0,
    tilt: Annotated[float, typer.Option(help="Shear of the box, xy / ly.")] = 0.0,
    seed: Annotated[int, typer.Option(help="Seed of the random start.")] = 1,
    law: Annotated[Law, typer.Option(help="Contacts slip (ring) or stick (sector).")] = Law.RING,
    ka: Annotated[
        float, typer.Option("--kA", help="Area stiffness, or inf to keep the area.")
    ] = 1.0,
    kp: Annotated[
        float,
        typer.Option("--kP", help="Perimeter stiffness, or inf to keep the perimeter."),
    ] = math.inf,
    contact: Annotated[
        Lines, typer.Option(help="Contact lines geometric or where both sides press alike (ring).")
    ] = Lines.BALANCED,
    reach: Annotated[float, typer.Option(help="Range of neighbours beyond touching (ring).")] = 0.3,
    strain: Annotated[float, typer.Option(help="Linear strain in all.")] = 0.01,
    steps: Annotated[int, typer.Option(help="Number of steps.")] = 10,
    tolerance: Annotated[
        float, typer.Option(help="Largest force over the mean contact force.")
    ] = TOLERANCE,
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("compress"),
    resume: Annotated[
        bool,
        typer.Option(
            "--resume",
            help="Finish the interrupted compression in the output folder or, with --strain or "
            "--steps, compress further what is there.",
        ),
    ] = False,
) -> None:
    """Jam a random packing and compress it quasistatically.

    Writes packing.data, summary.json, series.csv, trajectory.lammpstrj and, with matplotlib,
    packing.png into the output folder as the run goes.
    """
    began = time.perf_counter()
    check_protocol(strain, steps)
    first = frames_in(out) if resume else 0
    if resume:
        given = [f"--{name}" for name in PACKING_OPTIONS if _is_given(context, name)]
        if given:
            raise ParameterError(
                f"--resume goes on with the packing and law in '{out}': leave out "
                + ", ".join(given).replace("--ka", "--kA").replace("--kp", "--kP")
            )
        if _is_given(context, "strain") or _is_given(context, "steps"):
            states = compress_in(out, load(out), strain, steps, tolerance, append=True)
        elif _is_given(context, "tolerance"):
            raise ParameterError(
                f"--resume finishes the compression in '{out}' with its own tolerance: leave out "
                "--tolerance, or give --strain or --steps to compress further"
            )
        else:
            states = finish(out)
    else:
        if MPI.COMM_WORLD.rank == 0:
            out.mkdir(parents=True, exist_ok=True)  # or fail before the work
        values = context.params
        parameters = {name: values[name] for name in PACKING_OPTIONS}
        if law is Law.SECTOR:
            if contact is Lines.BALANCED and _is_given(context, "contact"):
                raise ParameterError("contacts of the sector law are radical, not balanced")
            parameters["contact"] = Lines.RADICAL
        model: Model = (
            Ring(ka, reach, kp, contact=contact.value) if law is Law.RING else Sector(ka, kp)
        )
        if polydispersity is None:
            start = bidisperse(number, radii, fraction, aspect=aspect, tilt=tilt, seed=seed)
        elif _is_given(context, "radii") or _is_given(context, "fraction"):
            raise ParameterError("give a polydispersity, or radii and fraction of two sizes")
        else:
            start = _log_normal(number, polydispersity, aspect, tilt, seed)
        packing = jam(start)
        _say(f"jammed at phi = {packing.phi:.5f} ({time.perf_counter() - began:.1f} s)")
        sim = Simulation(packing, model)
        states = compress_in(out, sim, strain, steps, tolerance, parameters)

    columns = ("phi", "pressure", "energy", "coordination", "rattlers", "residual")
    _say("step " + " ".join(f"{name:>12}" for name in columns))
    for step, state in enumerate(states, start=first + 1):
        row = numbers(state)
        _say(f"{step:4d} " + " ".join(f"{row[name]:12.6g}" for name in columns))
    if state.root and importlib.util.find_spec("matplotlib"):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.4, 5.6), layout="constrained")
        state.plot(figure.subplots())
        figure.savefig(out / "packing.png", dpi=150)
    _say(f"wrote {out} ({time.perf_counter() - began:.1f} s)")


@app.command()
def compare(
    number: Annotated[int, typer.Option(help="Number of particles.")] = 16,
    beads: Annotated[int, typer.Option(help="Beads on a ring of the small particles.")] = 50,
    strain: Annotated[float, typer.Option(help="Linear strain from jamming, in one step.")] = 0.01,
    seed: Annotated[int, typer.Option(help="Seed of the random start.")] = 1,
) -> None:
    """Compress a packing of bead rings, and show what each contact law makes of it in which time.

    The laws are given the rings' centres: I is the mean distance of their outlines from the beads
    over the radius, S_rms the error of the area deficits. The seconds are those of the same strain
    step from the same start. To the sector law a particle with one contact is a soft disk, so that
    its energy may be far off.
    """
    _refuse_ranks("compare times one core")
    from .report.packings import packing_rows

    if not 0.0 < strain < 1.0:
        raise ParameterError(f"strain must lie between 0 and 1, not {strain}")
    _say(f"{number} rings, {beads} beads on the small ones, {100 * strain:g} % strain from jamming")
    rows, _ = packing_rows(number, seed, strain, Beads(number=beads))
    _say(f"{'model':9} {'I':>9} {'S_rms':>9} {'energy/beads':>12} {'seconds':>9} {'speed-up':>9}")
    took = rows[0]["seconds_beads"]
    _say(f"{'beads':9} {'-':>9} {'-':>9} {1:12d} {took:9.3g} {1:9d}")
    for row in rows:
        ratio, residual = row["energy_ratio"], row["residual"]
        shown = "-" if ratio is None else f"{ratio:.3g}"
        error = "-" if row["S_rms"] is None else f"{row['S_rms']:.2g}"
        stalled = residual is not None and residual > TOLERANCE
        faster = "did not converge" if stalled else f"{took / row['seconds']:9.0f}"
        _say(
            f"{row['model']:9} {row['I']:9.2e} {error:>9} {shown:>12} "
            f"{row['seconds']:9.2g} {faster}"
        )
    if not any(row["energy_ratio"] for row in rows):
        _say("no law has particles that touch: the rings interlock, strain more or take more beads")


@app.command()
def report(
    quick: Annotated[bool, typer.Option("--quick", help="Smaller, in minutes.")] = False,
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("report"),
    resume: Annotated[
        bool,
        typer.Option("--resume", help="Go on with an interrupted report in the output folder."),
    ] = False,
) -> None:
    """Measure error against run time, and reproduce the paper: an HTML page, pictures, JSON.

    Writes index.html, its pictures and report.json into the output folder. Takes about half an
    hour on two cores, with --quick three minutes.
    """
    _refuse_ranks("report uses the cores by itself")
    from .report import write_report

    began = time.perf_counter()
    write_report(out, quick, resume, _say)
    _say(f"wrote {out / 'index.html'} ({time.perf_counter() - began:.0f} s)")


@app.command()
def movie(
    run: Annotated[Path, typer.Argument(help="Folder of a recorded run, as compress writes it.")],
    out: Annotated[Path, typer.Option(help="Movie, .gif or .mp4.")] = Path("movie.gif"),
    color_by: Annotated[
        str, typer.Option(help="One number a particle, e.g. shape_parameter.")
    ] = "particle_pressure",
    contacts: Annotated[bool, typer.Option("--contacts", help="Draw the contacts.")] = False,
    forces: Annotated[bool, typer.Option("--forces", help="Draw the force chains.")] = False,
    rate: Annotated[int, typer.Option(help="Pictures a second.")] = 10,
) -> None:
    """Draw each state of a recorded run, and write the pictures as a movie."""
    _refuse_ranks("a movie is drawn by one process")
    draw_movie(run, out, color_by, contacts, forces, rate)
    _say(f"wrote {out}")


@app.command()
def info() -> None:
    """Print versions, where the plugin is, which styles LAMMPS knows, and whether MPIs match."""
    for name, version in versions().items():
        _say(f"{name:14} {version}")
    _say(f"{'plugin':14} {directory() or 'not found: install the package again'}")
    lmp = silent_lammps(MPI.COMM_WORLD)
    complete = True
    for kind, style in STYLES:
        known = lmp.has_style(kind, style)
        complete &= known
        _say(f"{kind + ' style':14} {style}: {'registered' if known else 'MISSING'}")
    theirs = mpi_of_lammps(lmp.lib)
    match = theirs == mpi_of_python()
    _say(
        f"{'mpi of lammps':14} {theirs}: {'the same' if match else 'DIFFERENT, ranks cannot talk'}"
    )
    lmp.close()
    if not (complete and match):
        sys.exit(1)


def _log_normal(
    number: int, polydispersity: float, aspect: float, tilt: float, seed: int
) -> Packing:
    """Radii of mean 0.5 and this relative standard deviation."""
    width = positive("polydispersity", polydispersity)
    variance = math.log1p(width * width)
    return polydisperse(
        number,
        lambda rng: 0.5 * rng.lognormal(-0.5 * variance, math.sqrt(variance), number),
        aspect=aspect,
        tilt=tilt,
        seed=seed,
    )


def _is_given(context: typer.Context, name: str) -> bool:
    """Whether an option stands on the command line."""
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _refuse_ranks(reason: str) -> None:
    """Some commands do not share their work over ranks."""
    if MPI.COMM_WORLD.size > 1:
        raise ParameterError(f"{reason}: start it without mpiexec")


def _say(line: str, file: object = None) -> None:
    """Print a line once, above any progress bar."""
    if MPI.COMM_WORLD.rank == 0:
        tqdm.write(line, file=file or sys.stdout)


if __name__ == "__main__":
    main()
