"""A simulation of any law."""

from typing import Any

import lammps_deformable as ld


def simulate(start: ld.Packing | ld.State, law: Any = None) -> ld.Simulation:
    """Of soft contacts, if no law is given."""
    return ld.Simulation(start, ld.SoftContact() if law is None else law)
