"""Runs cases in LAMMPS, each a line of JSON, in a process of its own that may crash or hang.

A case is {"files": {name: text}, "commands": [...]}. Files are in the working directory; a
character of their text is a byte. The answer is {"error": message} of the command that was refused,
or {"energy": ..., "finite": ...} after the last command, which has to be a run. It also has the kB
of memory and the open files of this process. A case without commands is a saved run, for
`deformable.load`.
"""

import json
import os
import resource
import sys
from pathlib import Path

import deformable
import numpy as np
from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps() is called

# a case with wrong sizes must not use up the memory of the machine
resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))


def outcome(case):
    for name, text in case["files"].items():
        Path(name).write_bytes(text.encode("latin-1"))
    if not case["commands"]:
        return loaded()
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    try:
        for command in case["commands"]:
            lmp.command(command)
        energy = lmp.get_thermo("pe")
        arrays = (np.array(lmp.gather(name, 1, 3)) for name in ("x", "f"))
        finite = np.isfinite(energy) and all(np.isfinite(array).all() for array in arrays)
        return {"energy": energy, "finite": bool(finite)}
    except Exception as error:  # the lammps module raises bare Exception
        return {"error": str(error)}
    finally:
        lmp.close()


def loaded():
    try:
        with deformable.load(".") as sim:
            state = sim.state()
        return {"energy": state.energy, "finite": bool(np.isfinite(state.packing.positions).all())}
    except Exception as error:
        return {"error": f"{type(error).__name__}: {error}"}


def held():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return {"kB": pages * resource.getpagesize() // 1024, "open": len(os.listdir("/proc/self/fd"))}


for line in sys.stdin:
    print(json.dumps(outcome(json.loads(line)) | held()), flush=True)
