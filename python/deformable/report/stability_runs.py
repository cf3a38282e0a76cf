"""Stability of runs: energy against time step and time, errors that end a run, MPI ranks."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..common.errors import LammpsError
from ..common.fits import power_law
from ..common.ranks import launched
from ..engine.lammps import run
from ..engine.simulation import Simulation
from ..model.laws import LAWS, Law
from ..model.packing import Packing
from .stability_cases import JUMPS, ROUNDING, at_rest, row

T = TypeVar("T")

# Temperature at the start, far below the potential energy, which drives the motion.
TEMPERATURE = 1e-6

_RUN = """
fix move all nve
timestep {dt!r}
thermo_style custom step pe ke etotal
thermo_modify norm no
"""

# Waiting ranks release their core; else more ranks than cores take a hundred times as long.
_PATIENT = {
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE": "1",
    "MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT": "16",
}

# Energies, and forces by atom, of saved runs: independent of the number of ranks.
_RANKS = """
import json, sys
import deformable
from deformable.engine.lammps import gather
from mpi4py import MPI

answers = []
for folder in sys.argv[1:]:
    with deformable.load(folder) as sim:
        answers.append([sim.state().energy, gather(sim.lmp, "f", 3)[:, :2].tolist()])
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(answers))
"""


def energies(
    packing: Packing, law: Law, dt: float, steps: int, samples: int, kick: float = 0.0
) -> tuple[NDArray[np.float64], float]:
    """Total energy at samples + 1 times of a run, and its last kinetic energy.

    Args:
        kick: additional velocity of the first particle.
    """
    with Simulation(packing, law, MPI.COMM_SELF) as sim:
        run(sim.lmp, f"velocity all create {TEMPERATURE} 4711 loop all{_RUN.format(dt=dt)}")
        if kick:
            run(sim.lmp, f"group first id 1\nvelocity first set {kick!r} 0 0 sum yes")
        run(sim.lmp, "run 0 post no")
        recorded = [sim.lmp.get_thermo("etotal")]
        for _ in range(samples):
            run(sim.lmp, f"run {steps // samples} post no")
            recorded.append(sim.lmp.get_thermo("etotal"))
        return np.array(recorded), float(sim.lmp.get_thermo("ke"))


def energy_rows(packing: Packing, steps: int) -> Iterator[dict[str, Any]]:
    """Energy error of velocity Verlet: against the time step, over many steps, after a kick.

    The error falls as dt^2 if the force is continuous, as dt if the force jumps, and not at all if
    the energy jumps. The limit of the order is half way between the first two. Kinks of the force
    add random amounts to the energy: over n samples sqrt(n) times a single one, and hardly ever
    three times that. A drift exceeds this limit.
    """
    for name, law in LAWS.items():
        order, why = _measured(name, _order, packing, law)
        off = None if order is None else abs(order - 2.0)
        yield row(
            "time step 0.4 to 0.025",
            name,
            "order of the energy error, distance from 2",
            off,
            0.5,
            why,
        )

        found, why = _measured(name, _drift, packing, law, steps)
        drift, limit = (None, 0.0) if found is None else found
        case, what = f"{steps:g} steps of 0.1", "energy drift over the kinetic energy"
        yield row(case, name, what, drift, limit, why)

        ratio, why = _measured(name, _kicked, packing, law)
        what = "energy error over that at twice the time step"
        yield row("one particle kicked", name, what, ratio, 0.5, why)


def _measured(name: str, measure: Callable[..., T], *arguments: Any) -> tuple[T | None, str]:
    """The measured value, or None after an error, and the reason of a failure."""
    why = JUMPS if name == "sector" else ""
    try:
        return measure(*arguments), why
    except LammpsError as error:
        return None, ": ".join(filter(None, (why, str(error))))


def _order(packing: Packing, law: Law) -> float:
    """Power of the time step with which the energy error falls."""
    steps = 0.4 / 2.0 ** np.arange(5)
    errors = [energies(packing, law, dt, round(40.0 / dt), 20)[0].std() for dt in steps.tolist()]
    return power_law(steps, errors)


def _drift(packing: Packing, law: Law, steps: int) -> tuple[float, float]:
    """Energy drift from the first to the last quarter over the kinetic energy, and its limit."""
    samples = 200
    total, kinetic = energies(packing, law, 0.1, steps, samples)
    quarter = samples // 4
    drift = abs(total[-quarter:].mean() - total[:quarter].mean())
    return float(drift / kinetic), float(3.0 * np.diff(total).std() * np.sqrt(samples) / kinetic)


def _kicked(packing: Packing, law: Law) -> float:
    """Energy error over that at twice the time step, for one particle of tenfold energy."""
    kick = float(np.sqrt(20.0 * at_rest(packing, law).energy / len(packing)))
    coarse, fine = (
        energies(packing, law, dt, round(20.0 / dt), 20, kick)[0].std() for dt in (0.05, 0.025)
    )
    return float(fine / coarse)


def error_rows(packing: Packing) -> Iterator[dict[str, Any]]:
    """Impossible runs end with one line that names the reason, and all values before are finite."""
    for name, law in LAWS.items():
        silent = 0
        for dt in (1e1, 1e3, 1e6, 1e12):
            try:
                total, _ = energies(packing, law, dt, 200, 20)
                silent += not np.isfinite(total).all()
            except LammpsError as error:
                silent += not re.search(r"atoms? \d+|Lost atoms|Non-numeric", str(error), re.I)
        yield row(
            "time steps 10 to 1e12", name, "runs that end without an error message", silent, 0.0
        )

        silent = 0
        ends = {
            "change_box all boundary f f p\nvelocity all set 1e3 0 0\nrun 100": "Lost atoms",
            "change_box all boundary f f p\nregion room block 1 2 1 2 -0.5 0.5\n"
            "fix room all deformable/wall room\nrun 0": "center of atom",
        }
        for commands, line in ends.items():
            with Simulation(packing, law, MPI.COMM_SELF) as sim:
                try:
                    run(sim.lmp, _RUN.format(dt=0.1) + commands)
                    silent += 1
                except LammpsError as error:
                    silent += line not in str(error)
        yield row("particles lost", name, "runs that go on without them", silent, 0.0)


def rank_rows(packing: Packing, most: int) -> Iterator[dict[str, Any]]:
    """Several ranks add in another order. No rows under mpiexec, where ranks cannot be started."""
    mpiexec = Path(sys.executable).with_name("mpiexec")
    if launched() or not mpiexec.exists():
        return
    with tempfile.TemporaryDirectory() as folder:
        for name, law in LAWS.items():
            at_rest(packing, law).save(Path(folder, name))
        answers = []
        for ranks in range(1, most + 1):
            done = subprocess.run(
                [
                    str(mpiexec),
                    "-n",
                    str(ranks),
                    sys.executable,
                    "-m",
                    "mpi4py",
                    "-c",
                    _RANKS,
                    *LAWS,
                ],
                cwd=folder,
                env=os.environ | _PATIENT,
                capture_output=True,
                text=True,
            )
            answers.append(json.loads(done.stdout) if done.returncode == 0 else None)
    for n, name in enumerate(LAWS):
        alone, *shared = (None if each is None else each[n] for each in answers)
        # some contacts are found by iteration, to 1e-8 of the largest force
        limit = 1e-8 if name in ("balanced", "tilted") else 100.0 * ROUNDING
        change = None
        if alone is not None and all(each is not None for each in shared):
            forces = np.array(alone[1])
            change = max(
                float(np.abs(np.array(each[1]) - forces).max() / np.abs(forces).max())
                for each in shared
                if each is not None
            )
        yield row(f"1 to {most} ranks", name, "change of forces over the largest", change, limit)
