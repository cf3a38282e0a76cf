"""Programs of this environment, as a user starts them."""

import contextlib
import io
import os
import subprocess
import sys
import warnings
from pathlib import Path
from unittest import mock

BIN = Path(sys.executable).parent
# Waiting ranks give way: without it, more ranks than cores take a hundred times as long.
PATIENT = {
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE": "1",
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT": "16",
}


def program(
    *words: object, cwd: Path, ranks: int = 0, timeout: float = 300, **environment: str
) -> subprocess.CompletedProcess[str]:
    """`python`, `lmp`, `deformable` and so on to the end; under mpiexec on any number of ranks."""
    mpiexec = (BIN / "mpiexec", "-n", ranks) if ranks else ()
    return subprocess.run(
        [*map(str, mpiexec), str(BIN / str(words[0])), *map(str, words[1:])],
        cwd=cwd,
        env=os.environ | PATIENT | environment,
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )


def output(*words: object, cwd: Path, **options: object) -> str:
    """What a program prints that ends well."""
    done = program(*words, cwd=cwd, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def study(name: str, *words: object, cwd: Path) -> str:
    """What a study of `validation` prints, which writes its results into the folder `cwd`."""
    root = str(Path(__file__).parents[1])
    return output(
        "python", "-m", f"validation.{name}", *words, "--out", ".", cwd=cwd, PYTHONPATH=root
    )


def command(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """The command `deformable` in this process, which has loaded what it loads in half a second."""
    from lammps_deformable.cli.main import main

    arguments = ["deformable", *map(str, words)]
    here, code = Path.cwd(), None
    with (
        contextlib.redirect_stdout(io.StringIO()) as out,
        contextlib.redirect_stderr(io.StringIO()) as error,
        mock.patch("sys.argv", arguments),
        warnings.catch_warnings(),
    ):
        os.chdir(cwd)
        try:
            main()
        except SystemExit as end:
            code = end.code
        finally:
            os.chdir(here)
    return subprocess.CompletedProcess(arguments, code or 0, out.getvalue(), error.getvalue())
