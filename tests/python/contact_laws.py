"""The laws of the package, for tests of all of them: a new one takes part by itself."""

import lammps_deformable as ld
import pytest
from lammps_deformable.laws import LAWS

CONTACTS = [name for name, law in LAWS.items() if isinstance(law, ld.Ring)]

contacts = pytest.mark.parametrize("contact", CONTACTS)
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
