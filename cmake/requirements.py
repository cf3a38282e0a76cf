"""Print the requirements of pyproject.toml, a line each: of `build`, of `run`, or of an extra."""

import json
import re
import sys
from pathlib import Path

try:
    import tomllib
except ImportError:  # Python 3.10
    from pip._vendor import tomli as tomllib

PROJECT = tomllib.loads(Path(__file__).parents[1].joinpath("pyproject.toml").read_text())
EXTRAS = PROJECT["project"]["optional-dependencies"]


def requirements(of: str) -> list[str]:
    """The requirements of `build`, of `run`, or of an extra with all that it includes."""
    if of == "build":
        # pip brings these two into an environment of its own; ours gets them once
        return [*PROJECT["build-system"]["requires"], "cmake>=3.20", "ninja"]
    if of == "run":
        tables = PROJECT["tool"]["dynamic-metadata"]
        return [line for table in tables for line in table.get("dependencies", [])]
    found = []
    for requirement in EXTRAS[of]:
        included = re.fullmatch(r"lammps-deformable\[(.*)\]", requirement)
        if included:
            found += [line for extra in included[1].split(",") for line in requirements(extra)]
        else:
            found.append(requirement)
    return found


for argument in sys.argv[1:]:
    for line in requirements(argument):
        print(json.dumps(line))
