"""Two sides of a pair on two ranks: what one of them sends arrives at the other one."""

from pathlib import Path

import pytest
from programs import program

PROGRAM = Path(__file__).with_name("remote_sides.py")


@pytest.mark.parametrize("ranks", [2, 4])
def test_what_ranks_tell_each_other(ranks, tmp_path):
    done = program("python", "-m", "mpi4py", PROGRAM, ranks=ranks, cwd=tmp_path, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == f"{ranks} ranks\n"
