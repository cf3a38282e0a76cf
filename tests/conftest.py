"""Random tests draw the same examples in every run: what passes here passes there.

Tolerances of `pytest.approx` are relative, unless a test asks for an absolute one. Energies are as
small as 1e-8: the 1e-12 that pytest adds would let a ten-thousandth of them pass.
"""

import pytest
from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")

type(pytest.approx(1.0)).DEFAULT_ABSOLUTE_TOLERANCE = 0.0
assert pytest.approx(1e-13) != 1.1e-13

# Files that take longest begin first: no process is left alone with one of them at the end.
FIRST = (
    *("test_examples.py", "test_force_lanes.py", "test_main.py", "test_mpi.py", "test_digits.py"),
    *("test_example_scripts.py", "test_processes.py", "test_lammps_recipes.py", "test_site.py"),
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.path.name not in FIRST)
