"""Docstrings name attributes that exist."""

import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterator
from functools import cache
from types import ModuleType
from typing import Any

import lammps_deformable as ld
import pytest
from lammps_deformable.state.recorded import COLUMNS

MODULES = [
    importlib.import_module(module.name)
    for module in pkgutil.walk_packages(ld.__path__, f"{ld.__name__}.")
    if not re.search(r"\.core$|_for_tests$", module.name)
]

# What docstrings call an object of each class.
OBJECTS = {"packing": ld.Packing, "run": ld.Run, "sim": ld.Simulation, "state": ld.State}
CLASSES = {kind.__name__: kind for kind in OBJECTS.values()}

# Ends of names of files, such as packing.data.
FILES = ("data", "fe", "png", "txt")


def documented(module: ModuleType) -> Iterator[Any]:
    """The module, its functions and classes, and their methods."""
    yield module
    for each in vars(module).values():
        if getattr(each, "__module__", "") == module.__name__:
            yield each
            if isinstance(each, type):
                for own in vars(each).values():
                    yield getattr(own, "__func__", own)


@cache
def has(kind: type, name: str) -> bool:
    """Whether objects of a class have the attribute, which a method or a field may make."""
    if hasattr(kind, name) or (kind is ld.State and name in COLUMNS):
        return True
    return any(
        name in vars(base).get("__annotations__", {})
        or re.search(rf"\bself\.{name}\b", inspect.getsource(base))
        for base in kind.__mro__
        if base.__module__.startswith(ld.__name__)
    )


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__.partition(".")[2])
def test_documented_names(module: ModuleType) -> None:
    lacking = []
    for each in documented(module):
        text = getattr(each, "__doc__", None)
        if not isinstance(text, str):
            continue
        for owner, name in re.findall(r"(?<![\w./])(\w+)\.([a-zA-Z]\w*)", text):
            kind = OBJECTS.get(owner) or CLASSES.get(owner)
            if kind and name not in FILES and not has(kind, name):
                lacking.append(f"{owner}.{name}")
        if isinstance(each, type) and "\n    Attributes:\n" in text:
            block = re.split(r"\n\n|\n    \w", text.partition("\n    Attributes:\n")[2])[0]
            for names in re.findall(r"^        (\w[\w, ]*):", block, re.MULTILINE):
                lacking += [
                    f"{each.__name__}.{name}" for name in names.split(", ") if not has(each, name)
                ]
    assert not lacking
