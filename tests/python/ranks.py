"""Python scripts under MPI."""

import subprocess
import sys
from pathlib import Path

MPIEXEC = str(Path(sys.executable).with_name("mpiexec"))


def python(script: str, cwd: Path, ranks: int) -> str:
    """Output of a python script, under MPI if there are several ranks."""
    result = launch(script, cwd, ranks if ranks > 1 else None)
    assert result.returncode == 0, result.stderr
    return result.stdout


def launch(
    script: str, cwd: Path, ranks: int | None, module: str = "mpi4py"
) -> subprocess.CompletedProcess[str]:
    """A python script under mpiexec, if a number of ranks is given, in the care of a module."""
    (cwd / "script.py").write_text(script)
    command = [sys.executable, "script.py"]
    if ranks is not None:
        command = [MPIEXEC, "-n", str(ranks), sys.executable, "-m", module, "script.py"]
    return subprocess.run(
        command, cwd=cwd, capture_output=True, text=True, timeout=120, check=False
    )
