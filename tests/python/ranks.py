"""Python scripts under MPI."""

import subprocess
import sys
from pathlib import Path


def python(script: str, cwd: Path, ranks: int) -> str:
    """Output of a python script, under MPI if there are several ranks."""
    (cwd / "script.py").write_text(script)
    command = [sys.executable, "script.py"]
    if ranks > 1:
        mpiexec = str(Path(sys.executable).parent / "mpiexec")
        command = [mpiexec, "-n", str(ranks), sys.executable, "-m", "mpi4py", "script.py"]
    result = subprocess.run(
        command, cwd=cwd, capture_output=True, text=True, timeout=120, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout
