"""The laws of the package, for tests of all of them: a new one takes part by itself."""

import deformable
import pytest
from deformable.model.laws import LAWS

CONTACTS = [name for name, law in LAWS.items() if isinstance(law, deformable.Ring)]

contacts = pytest.mark.parametrize("contact", CONTACTS)
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
