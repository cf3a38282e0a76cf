"""What is refused, in one line; a failure says what was expected."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

import lammps_deformable as ld
import pytest


@contextmanager
def refused(
    told: str, error: type[Exception] | tuple[type[Exception], ...] = ld.ParameterError
) -> Iterator[None]:
    """The block ends with such an error, whose only line matches the pattern."""
    try:
        yield
    except error as found:
        line = str(found)
    else:
        pytest.fail(f"it is not refused: {told}")
    assert re.search(told, line), (told, line)
    assert "\n" not in line
