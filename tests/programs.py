"""Programs of this environment, as a user starts them."""

import os
import subprocess
import sys
from pathlib import Path

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
