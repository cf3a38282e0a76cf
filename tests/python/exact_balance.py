"""Contacts that are balanced closer than to the default tolerance."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from lammps_deformable.particles import commands
from lammps_deformable.particles.laws import AnyLaw, Droplet


@contextmanager
def exactly_balanced() -> Iterator[None]:
    """Simulations and scripts whose balanced contacts have forces to 1e-13 of the largest one.

    By default they are right to 1e-8, and so are stresses and areas. Two evaluations of the same
    positions agree to that if they begin with other forces, those of other states before.
    """
    arguments = commands.pair_style_arguments

    def exact(law: AnyLaw, threads: int | str | None = None) -> str:
        balances = isinstance(law, Droplet) or law.name in ("balanced", "curved")
        return arguments(law, threads) + " balance 1e-13 100" * balances

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(commands, "pair_style_arguments", exact)
        yield
