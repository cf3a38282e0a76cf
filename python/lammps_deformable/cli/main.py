"""The command `deformable`."""

from __future__ import annotations

import sys
import time
import traceback
import warnings
from concurrent.futures.process import BrokenProcessPool

import typer
from lammps_deformable_plugin import directory
from mpi4py import MPI
from tqdm import tqdm

from .. import potentials
from ..errors import CallError, FileError, LammpsError, ParameterError
from ..lammps import silent_lammps
from ..progress import print_once
from ..versions import mpi_of_lammps, mpi_of_python, versions
from .compress import compress_command
from .jam import jam_command
from .options import Command, CommandLineError, Group, one_rank_prints
from .outline import outline_command
from .plot import movie_command, plot_command
from .report import report_command
from .shear import shear_command

app = typer.Typer(
    cls=Group,
    help="Deformable particles in LAMMPS: in two dimensions, and droplets in three.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

# Exit code after Ctrl-C.
_INTERRUPTED = 130
_GOES_ON = "interrupted: add --resume to finish a run; `deformable report` goes on when repeated"

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
    ("fix", "deformable/stick"),
    ("fix", "deformable/polygon"),
    ("compute", "deformable/contact"),
)


app.command("compress", cls=Command)(compress_command)
app.command("jam", cls=Command)(jam_command)
app.command("report", cls=Command)(report_command)
app.command("shear", cls=Command)(shear_command)
app.command("plot", cls=Command)(plot_command)
app.command("movie", cls=Command)(movie_command)
app.command("outline", cls=Command)(outline_command)


def main() -> None:
    """Run the command; errors of a user are one line, with exit code 2."""
    warnings.showwarning = lambda message, *_: tqdm.write(f"warning: {message}", file=sys.stderr)
    warnings.simplefilter("always", UserWarning)
    try:
        with one_rank_prints():
            app()
    except SystemExit as end:
        if end.code == _INTERRUPTED and MPI.COMM_WORLD.rank == 0:
            print(_GOES_ON, file=sys.stderr)
        raise
    except CommandLineError as error:
        if MPI.COMM_WORLD.rank == 0:
            print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except (
        ParameterError,
        FileError,
        LammpsError,
        CallError,
        ImportError,
        OSError,
        BrokenProcessPool,
    ) as error:
        world = MPI.COMM_WORLD
        if world.rank > 0:
            time.sleep(1.0)  # if rank 0 has failed as well, it prints the error and ends all
        print(f"error: {error}", file=sys.stderr, flush=True)
        if world.size > 1:
            time.sleep(0.5)  # mpiexec may lose a line that it has not yet passed on
            world.Abort(2)  # other ranks may be waiting for this one
        sys.exit(2)
    except Exception:
        if MPI.COMM_WORLD.size == 1:
            raise
        traceback.print_exc()
        MPI.COMM_WORLD.Abort(1)


@app.command(cls=Command)
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
        sys.exit(1)


if __name__ == "__main__":
    main()
