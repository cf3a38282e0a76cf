"""The command `deformable`."""

from __future__ import annotations

import importlib.util
import itertools
import os
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, redirect_stdout
from dataclasses import asdict, fields
from pathlib import Path
from typing import Annotated, Any

import typer
from lammps_deformable_plugin import directory
from mpi4py import MPI
from tqdm import tqdm
from typer import Argument, Option

from .. import potentials
from ..common.errors import DeformableError, ParameterError
from ..common.files import make_folder, written_whole
from ..common.ranks import print_once
from ..common.versions import mpi_of_lammps, mpi_of_python, optional, versions
from ..engine.jamming import jam
from ..engine.lammps import silent_lammps
from ..engine.relax import TOLERANCE
from ..engine.simulation import Simulation
from ..formats.store import refuse, refuse_run
from ..particles.generators import bidisperse
from ..particles.laws import ALL_LAWS
from ..pictures.movies import of_dimension
from ..pictures.plot import title_of
from ..runs.run import Run
from ..state.recorded import numbers_of
from ..state.state import State
from .options import (
    CommandLineError,
    InFile,
    Material,
    Number,
    Out,
    Overwrite,
    RandomStart,
    Resume,
    Seed,
    Settings,
    check_same,
    command,
    law_and_dimension,
    option,
    refuse_ranks,
    unset,
    words_of,
)

app = typer.Typer(
    help="Deformable particles in LAMMPS: in two dimensions, and droplets in three.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _print_version(asked: bool) -> None:
    if asked:
        print_once(versions()["deformable"])
        raise typer.Exit


@app.callback()
def app_options(
    version: Annotated[
        bool,
        Option("--version", callback=_print_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Options before a subcommand."""


# Exit code of typer after Ctrl-C.
_INTERRUPTED = 130

STYLES = (
    ("pair", "deformable/ring"),
    ("pair", "deformable/sector"),
    ("pair", "deformable/droplet"),
    ("pair", "deformable/edge"),
    ("fix", "deformable/wall"),
    ("fix", "deformable/films"),
    ("fix", "deformable/restart"),
    ("fix", "deformable/friction"),
    ("fix", "deformable/propel"),
    ("fix", "deformable/outline"),
    ("fix", "deformable/proliferate"),
    ("fix", "deformable/stick"),
    ("fix", "deformable/polygon"),
    ("compute", "deformable/contact"),
    ("compute", "deformable/outline"),
)


def main() -> None:
    """Run the command; errors of a user are one line, with exit code 2."""
    warnings.showwarning = lambda message, *_: tqdm.write(f"warning: {message}", file=sys.stderr)
    warnings.simplefilter("always", UserWarning)
    world = MPI.COMM_WORLD
    try:
        with ExitStack() as stack:
            if world.rank > 0:  # which prints warnings and errors of its own only
                nowhere = stack.enter_context(open(os.devnull, "w"))
                stack.enter_context(redirect_stdout(nowhere))
            sys.exit(app(standalone_mode=False))
    except SystemExit as end:
        if end.code == _INTERRUPTED:
            _tell("interrupted: --resume finishes a run; `deformable report` goes on if repeated")
        raise
    except CommandLineError as error:
        _tell(f"error: {error}")
        sys.exit(2)
    except (DeformableError, ImportError, OSError, BrokenProcessPool) as error:
        if world.rank > 0:
            time.sleep(1.0)  # if rank 0 has failed as well, it prints the error and ends all
        print(f"error: {error}", file=sys.stderr, flush=True)
        if world.size > 1:
            time.sleep(0.5)  # mpiexec may lose a line that it has not yet passed on
            world.Abort(2)  # other ranks may be waiting for this one
        sys.exit(2)
    except Exception as error:
        if hasattr(error, "format_message"):  # of typer: the command line is wrong
            message = " ".join(error.format_message().split())
            _tell(error.format_message() if "Usage:" in message else f"error: {message}")
            sys.exit(2)
        if world.size == 1:
            raise
        traceback.print_exc()
        world.Abort(1)


def _tell(line: str) -> None:
    if MPI.COMM_WORLD.rank == 0:
        print(line, file=sys.stderr)


# Runs


def _printing(columns: Sequence[str], done: int = 0) -> Callable[[State], None]:
    """A callback that prints these of `numbers_of`, after so many steps before."""
    steps = itertools.count(done + 1)

    def show(state: State) -> None:
        step = next(steps)
        if step == done + 1:
            print_once("step " + " ".join(f"{name:>12}" for name in columns))
        row = numbers_of(state)
        print_once(f"{step:4d} " + " ".join(f"{row[name]:12.6g}" for name in columns))

    return show


def _finish(state: State, folder: Path, began: float) -> None:
    """Draw the last state."""
    if MPI.COMM_WORLD.rank == 0 and importlib.util.find_spec("matplotlib"):
        _draw(state, folder / "packing.png")
    print_once(f"wrote {folder} ({time.perf_counter() - began:.1f} s)")


def _draw(state: State, out: Path, **settings: Any) -> None:
    if settings.get("title") is None:
        settings["title"] = title_of(state)
    figure: Any = state.plot(**settings).figure
    with written_whole(out) as part:
        figure.savefig(part, dpi=150)


_COLUMNS = ("phi", "pressure", "energy", "coordination", "rattlers", "residual")
_WAYS_OUT = ("finish it with --resume", "replace it with --overwrite")


@command(app)
def compress_command(
    settings: Settings,
    given: dict[str, Any],
    out: Out = "compress",
    resume: Resume = False,
    append: Annotated[
        bool, Option(help="Compress the finished run in the output folder further.")
    ] = False,
    overwrite: Overwrite = False,
) -> None:
    """Jam a random packing, or take one from a file, and compress it quasistatically.

    Writes packing.data, summary.json, series.csv and trajectory.lammpstrj into the output folder,
    for the packing before the first step and after each step, and packing.png at the end if
    matplotlib is installed.
    """
    began = time.perf_counter()
    settings = settings.usual(given)
    if resume + append + overwrite > 1:
        raise ParameterError("give one of --resume, --append and --overwrite")
    first, last = _WAYS_OUT
    ways = first, "compress it further with --append", last
    folder = refuse(out, "run" if resume or append or overwrite else None, ways)
    protocol = settings.protocol
    done, sim = 0, None
    if resume:
        check_same(folder, given)
        done = Run(folder).steps_done or 0
        run = Run(folder).resume(callback=_printing(_COLUMNS, done))
    elif append:
        target = protocol.settings
        check_same(folder, {name: given[name] for name in given if name not in target})
        show = _printing(_COLUMNS, max(len(Run(folder)) - 1, 0))
        sim = Run(folder).simulation()
        run = sim.play(protocol, record=folder, mode="a", callback=show)
    else:
        settings.check(given, *(field.name for field in fields(RandomStart)))
        if settings.polydispersity is not None and given.keys() & {"radii", "fraction"}:
            raise ParameterError("give --polydispersity, or --radii and --fraction of two sizes")
        law = settings.contact_law()
        protocol.check_for(law, (), recorded=True)
        start = settings.start()
        if MPI.COMM_WORLD.rank == 0:
            make_folder(folder)
        packing = jam(start).packing if settings.from_file is None else start
        begun = "jammed" if settings.from_file is None else f"{len(packing)} particles"
        print_once(f"{begun} at phi = {packing.phi:.5f} ({time.perf_counter() - began:.1f} s)")
        sim = Simulation(packing, law)
        run = sim.play(
            protocol,
            record=folder,
            mode="w" if overwrite else "x",
            callback=_printing(_COLUMNS),
            parameters=settings.parameters,
        )
    if resume and run.steps_done == done:
        print_once(f"the compression in '{folder}' is complete")
    else:
        _finish(sim.state() if sim else run[-1], folder, began)


@command(app)
def shear_command(
    material: Material,
    given: dict[str, Any],
    run: Annotated[
        Path | None,
        Argument(
            help="Folder of a run, e.g. of `deformable compress`; its last packing is sheared."
        ),
    ] = None,
    strain: Annotated[
        float, Option(help="Shear strain of all steps together; negative shears the other way.")
    ] = 0.1,
    steps: Annotated[int, Option(help="Number of steps.")] = 20,
    tolerance: Annotated[float, Option(help="As of `deformable compress`.")] = TOLERANCE,
    out: Out = "shear",
    resume: Resume = False,
    overwrite: Overwrite = False,
) -> None:
    """Shear the last packing of a run, or one from a file, quasistatically along x.

    A run has its law; options of the law are for a packing from a file.

    Writes the same files as `deformable compress` into the output folder, for the packing before
    the first step and after each step. The columns shear_strain and shear_stress of series.csv
    are the strain and the stress that resists.
    """
    began = time.perf_counter()
    if resume and overwrite:
        raise ParameterError("give one of --resume and --overwrite")
    material = material.usual(given)
    folder = refuse(out, "run" if resume or overwrite else None, _WAYS_OUT)
    columns = ("shear_strain", "shear_stress", *_COLUMNS[1:])
    done, sim = 0, None
    if resume:
        check_same(folder, given)
        done = Run(folder).steps_done or 0
        sheared = Run(folder).resume(callback=_printing(columns, done))
    else:
        own = {name: given[name] for name in given if name not in ("strain", "steps", "tolerance")}
        sim, parameters = _sheared(run, folder, material, own)
        sheared = sim.shear(
            strain,
            steps=steps,
            tolerance=tolerance,
            record=folder,
            mode="w" if overwrite else "x",
            callback=_printing(columns),
            parameters=parameters,
        )
    if resume and sheared.steps_done == done:
        print_once(f"the shear in '{folder}' is complete")
    else:
        _finish(sim.state() if sim else sheared[-1], folder, began)


def _sheared(
    run: Path | None, folder: Path, material: Material, given: Mapping[str, Any]
) -> tuple[Simulation, dict[str, Any]]:
    """What is sheared, and the parameters that tell where it comes from."""
    if material.from_file is not None:
        if run is not None:
            raise ParameterError(f"give the folder '{run}' of a run, or --from, not both")
        material.check(given)
        packing = material.packing_in_file(int(material.dimension or 2))
        return Simulation(packing, material.contact_law()), asdict(material)
    if run is None:
        raise ParameterError(
            "give the folder of a run, whose packing is sheared, shear RUN, or --from FILE"
        )
    if given:
        raise ParameterError(
            f"{option(next(iter(given)))} is about the packing in a file, and a run has its own "
            "law: leave it out, or give --from FILE in the place of a run"
        )
    if folder.resolve() == run.resolve():
        raise ParameterError(f"'{run}' is the folder of the packing: give another one to --out")
    return Run(run).simulation(), {"before": Run(run).parameters}


@command(app)
def jam_command(
    material: Material,
    given: dict[str, Any],
    number: Number = 128,
    seed: Seed = 1,
    pressure: Annotated[
        float | None,
        unset(
            "Pressure at the onset, between this and twice this [energy/length^2, "
            "energy/length^3]. 1e-6 of the unit of the law if not given: kA R0^2 with the mean "
            "radius R0, of droplets tension/R0."
        ),
    ] = None,
    out: Out = "jam",
    overwrite: Overwrite = False,
) -> None:
    """Jam a random packing of two sizes, or a loose one from a file, and save it at its onset.

    The output folder is a run of one state, with packing.png if matplotlib is installed. Ensembles
    of packings: docs/jamming.md.
    """
    began = time.perf_counter()
    material = material.usual(given)
    material.check(given, "number", "seed")
    folder = refuse_run(out, overwrite, _WAYS_OUT[1:])
    dimension, law = int(material.dimension or 2), material.contact_law()
    if material.from_file is None:
        start = bidisperse(number, seed=seed, dimension=dimension)
    else:
        start = material.packing_in_file(dimension)
    # of a contact force this is left, so that the weakest contacts are counted
    packing = jam(start, law, pressure=pressure, tolerance=1e-6).packing
    with Simulation(packing, law) as sim:
        state = sim.relax()
        state.save(folder, mode="w" if overwrite else "x")
    print_once(
        f"phi_J = {state.phi:.6g}, pressure {state.pressure:.3g}, coordination "
        f"{state.coordination:.4g}, {int(state.rattlers.sum())} rattlers"
    )
    _finish(state, folder, began)


@command(app)
def report_command(
    material: InFile,
    given: dict[str, Any],
    number: Number = 16,
    seed: Seed = 1,
    dimension: Annotated[int, Option(help="2, or 3 for droplets in space.")] = 2,
    strain: Annotated[float, Option(help="Linear strain of all steps together.")] = 0.02,
    steps: Annotated[int, Option(help="Number of steps.")] = 2,
    vertices: Annotated[
        str,
        Option(
            metavar="N,N,...",
            help="Vertices of the smallest smooth polygons; the most are the reference.",
        ),
    ] = "38,76,152",
    beads: Annotated[
        str, Option(metavar="N,N,...", help="Beads of bead polygons, which interlock.")
    ] = "",
    workers: Annotated[int | None, unset("Methods at a time; by default one a core.")] = None,
    out: Out = "report",
    overwrite: Overwrite = False,
) -> None:
    """Measure errors of the contact laws and of polygons against their run times.

    A random packing of two sizes is jammed; one from a file is to be at the onset of jamming. Each
    method compresses it and relaxes on its own. Writes report.json, report.csv and, if matplotlib
    is installed, error_against_time.png. An interrupted report goes on when the command is
    repeated. Errors are those against the finest polygons: more of them tell more. In three
    dimensions they are those of droplets against their exact shapes by finite elements, and of soft
    spheres. Seconds are processor time.
    """
    refuse_ranks("report times one core")
    from ..reference.report import write_report

    began = time.perf_counter()
    material.check(given, "number", "seed")
    counts = {"vertices": _counts("vertices", vertices), "beads": _counts("beads", beads)}
    if not counts["vertices"]:
        raise ParameterError("vertices must have a number at least")
    law_and_dimension(None, dimension)
    settings: dict[str, Any] = ({} if dimension == 3 else counts) | {
        "strain": strain,
        "steps": steps,
    }
    for name in counts if dimension == 3 else ():
        if name in given:
            raise ParameterError(f"{option(name)} is about polygons in the plane: leave it out")
    if material.from_file is None:
        origin: dict[str, Any] = {"number": number, "seed": seed, "dimension": dimension}
        start = jam(bidisperse(number, seed=seed, dimension=dimension)).packing
    else:
        origin = asdict(material) | {"dimension": dimension}
        start = material.packing_in_file(dimension)
    found = write_report(
        out, start, overwrite=overwrite, parameters=origin | settings, workers=workers, **settings
    )
    print_once(str(found))
    print_once(f"wrote {out} ({time.perf_counter() - began:.0f} s)")


def _counts(name: str, words: str) -> list[int]:
    try:
        return [int(word) for word in words.split(",") if word]
    except ValueError:
        raise ParameterError(f"{name} must be whole numbers such as 38,57, not {words}") from None


# Pictures


Recorded = Annotated[Path, Argument(help="Folder of a run, e.g. of `deformable compress`.")]
ColorBy = Annotated[str, Option(help="Quantity of the particles, e.g. shape_parameter.")]
ColorMap = Annotated[
    str | None, unset("Color map of matplotlib; without, one for the signs of the values.")
]
FirstColor = Annotated[float | None, unset("Value of the first color.")]
LastColor = Annotated[float | None, unset("Value of the last color.")]
Contacts = Annotated[bool, Option("--contacts", help="Draw the contacts.")]
Forces = Annotated[bool, Option("--forces", help="Draw the force chains.")]
Spins = Annotated[bool, Option("--spins", help="Draw the spins, with friction.")]
View = Annotated[
    tuple[float, float] | None,
    unset("Of the viewer, in three dimensions [degree].", metavar="ELEVATION AZIMUTH"),
]
Slice = Annotated[
    float | None, unset("In three dimensions: draw what the plane at this z cuts [length].")
]


def _check_picture(out: Path) -> None:
    """Refuse a file that is no picture of matplotlib."""
    optional("matplotlib", "plot")
    from matplotlib.figure import Figure

    formats = Figure().canvas.get_supported_filetypes()
    if out.suffix.removeprefix(".") not in formats:
        raise ParameterError(f"a picture is one of .{', .'.join(formats)}, not '{out}'")


@command(app)
def plot_command(
    run: Recorded,
    out: Annotated[Path, Option(metavar="PATH", help="Picture, .png, .pdf or .svg.")] = Path(
        "packing.png"
    ),
    frame: Annotated[
        int | None,
        unset("Number of the frame, from 0; -1 is the last one. Without, the saved state."),
    ] = None,
    color_by: ColorBy = "pressures",
    cmap: ColorMap = None,
    vmin: FirstColor = None,
    vmax: LastColor = None,
    title: Annotated[str | None, unset("Title; by default phi and pressure.")] = None,
    contacts: Contacts = False,
    forces: Forces = False,
    spins: Spins = False,
    view: View = None,
    slice: Slice = None,
) -> None:
    """Draw a state of a run."""
    refuse_ranks("a picture is drawn by one process")
    _check_picture(out)
    if frame is None:
        with Run(run).simulation() as sim:
            state = sim.state()
    else:
        try:
            state = Run(run)[frame]
        except IndexError as error:
            raise ParameterError(str(error)) from None
    settings = {"color": color_by, "cmap": cmap, "vmin": vmin, "vmax": vmax, "title": title}
    own = of_dimension(state.packing.dimension, spins=spins, view=view, slice=slice)
    _draw(state, out, contacts=contacts, forces=forces, **settings, **own)
    print_once(f"wrote {out}")


@command(app)
def movie_command(
    run: Recorded,
    out: Annotated[Path, Option(metavar="PATH", help="Movie, .gif or .mp4.")] = Path("movie.gif"),
    color_by: ColorBy = "pressures",
    cmap: ColorMap = None,
    vmin: FirstColor = None,
    vmax: LastColor = None,
    contacts: Contacts = False,
    forces: Forces = False,
    spins: Spins = False,
    view: View = None,
    slice: Slice = None,
    rate: Annotated[int, Option(help="Pictures per second.")] = 10,
) -> None:
    """Draw each state of a recorded run as a movie."""
    refuse_ranks("a movie is drawn by one process")
    colors = {"color": color_by, "cmap": cmap, "vmin": vmin, "vmax": vmax}
    drawn = {"contacts": contacts, "forces": forces, "spins": spins, "view": view, "slice": slice}
    Run(run).movie(out, mode="w", rate=rate, **drawn, **colors)
    print_once(f"wrote {out}")


@command(app)
def outline_command(
    dump: Annotated[
        Path, Argument(help="LAMMPS dump, or another file of particles in a periodic box.")
    ],
    species: Annotated[
        str, Option(metavar="FILE", help="Species file of pair_coeff, or one of the package.")
    ],
    law: Annotated[
        str | None,
        unset(
            "Contact law; by default that of the run with these files, or balanced.",
            metavar="|".join(ALL_LAWS),
        ),
    ] = None,
    types: Annotated[
        str | None,
        unset(
            "Species of atom types 1, 2, ..., as in pair_coeff, or of names of types, as "
            "A=small,B=large; by default those of the file in their order.",
            metavar="NAME,NAME,...",
        ),
    ] = None,
    frame: Annotated[int, Option(help="Number of the frame, from 0; -1 is the last one.")] = -1,
    radii: Annotated[
        str | None,
        unset(
            "Column of the dump with the radius of each particle; by default radii are those of "
            "the species.",
            metavar="COLUMN",
        ),
    ] = None,
    out: Annotated[
        list[Path] | None,
        unset(
            "Picture (.png, .pdf, .svg) or shapes (.vtp, .geojson); may be repeated. By default "
            "outlines.png and outlines.vtp.",
            metavar="PATH",
        ),
    ] = None,
    color_by: ColorBy = "pressures",
    vmin: FirstColor = None,
    vmax: LastColor = None,
    contacts: Contacts = False,
    forces: Forces = False,
    view: View = None,
    slice: Slice = None,
) -> None:
    """Write the outlines of particles in a dump, made by LAMMPS alone.

    With --law droplet the dump is of three dimensions, and the .vtp has droplets with facets.
    """
    refuse_ranks("outlines are written by one process")
    paths = out or [Path("outlines.png"), Path("outlines.vtp")]
    pictures = [path for path in paths if path.suffix not in (".vtp", ".geojson")]
    for path in pictures:
        _check_picture(path)
    names: Any = None if types is None else types.split(",")
    if types is not None and "=" in types:
        names = dict(pair.partition("=")[::2] for pair in names)
    with words_of("State.from_file"):
        state = State.from_file(dump, species, law=law, types=names, frame=frame, radii=radii)
    if law is None:
        print_once(f"contact law {state.law.name}: give --law for another")
    for path in paths:
        if path in pictures:
            settings = {"color": color_by, "vmin": vmin, "vmax": vmax}
            own = of_dimension(state.packing.dimension, view=view, slice=slice)
            _draw(state, path, contacts=contacts, forces=forces, **settings, **own)
        else:
            state.export(path, mode="w")
        print_once(f"wrote {path}")


@command(app)
def info() -> None:
    """Print versions, the path of the plugin, the styles that LAMMPS knows and its MPI."""
    for name, version in versions().items():
        print_once(f"{name:14} {version}")
    print_once(f"{'plugin':14} {directory() or 'not found: install the package again'}")
    shipped = sorted(path.name for path in potentials.glob("*.deformable"))
    print_once(f"{'species files':14} {', '.join(shipped) or 'MISSING'}")
    lmp = silent_lammps(MPI.COMM_WORLD)
    complete = True
    for kind, style in STYLES:
        known = lmp.has_style(kind, style)
        complete &= known
        print_once(f"{kind + ' style':14} {style}: {'registered' if known else 'MISSING'}")
    theirs = mpi_of_lammps(lmp.lib)
    match = theirs == mpi_of_python()
    print_once(
        f"{'mpi of lammps':14} {theirs}: {'the same' if match else 'DIFFERENT, ranks cannot talk'}"
    )
    lmp.close()
    if not (complete and match):
        raise typer.Exit(1)


if __name__ == "__main__":
    main()
