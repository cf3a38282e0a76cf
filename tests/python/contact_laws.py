"""The laws of the package, for tests of all of them: a new one takes part by itself."""

from typing import Any

import lammps_deformable as ld
import pytest
from lammps_deformable.laws import LAWS

CONTACTS = [name for name, law in LAWS.items() if isinstance(law, ld.Ring)]

contacts = pytest.mark.parametrize("contact", CONTACTS)
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


def simulate(start: ld.Packing | ld.State, law: Any = None) -> ld.Simulation:
    """A simulation of a law, or of soft contacts."""
    return ld.Simulation(start, ld.SoftContact() if law is None else law)
