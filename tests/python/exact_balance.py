"""Balanced contacts closer than the default tolerance."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from deformable.io import lammps_commands
from deformable.model.laws import Law


@contextmanager
def exactly_balanced() -> Iterator[None]:
    """Simulations and scripts whose balanced contacts have forces to 1e-13 of the largest one.

    By default they are right to 1e-8, and so are stresses and areas. Two evaluations of the same
    positions agree to that if they begin with other forces, those of other states before.
    """
    arguments = lammps_commands.pair_style_arguments

    def exact(law: Law) -> str:
        balance = " balance 1e-13 100" if law.name in ("balanced", "curved") else ""
        return arguments(law) + balance

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lammps_commands, "pair_style_arguments", exact)
        yield
