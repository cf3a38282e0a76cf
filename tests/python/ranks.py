"""Python scripts under MPI."""

import contextlib
import io
import subprocess
from pathlib import Path

from programs import program


def python(script: str, cwd: Path, ranks: int) -> str:
    """Output of a python script, under MPI if there are several ranks."""
    result = launch(script, cwd, ranks if ranks > 1 else None)
    assert result.returncode == 0, result.stderr
    return result.stdout


def here(script: str) -> str:
    """Output of a script in this process, which is one rank and has imported the package."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(script, {"__name__": "__main__"})
    return out.getvalue()


def launch(
    script: str, cwd: Path, ranks: int | None, module: str = "mpi4py"
) -> subprocess.CompletedProcess[str]:
    """A python script under mpiexec, if a number of ranks is given, in the care of a module."""
    (cwd / "script.py").write_text(script)
    care = ("-m", module) if ranks else ()
    return program("python", *care, "script.py", cwd=cwd, ranks=ranks or 0, timeout=120)
