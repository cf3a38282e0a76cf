"""Runs at constant energy: the time of a step, and the error of the energy."""

from __future__ import annotations

import statistics
import time

import lammps_deformable as ld
import numpy as np
from numpy.typing import NDArray

SKIN = 0.3  # LAMMPS' default


def step(
    packing: ld.Packing,
    law: ld.Ring,
    temperature: float,
    dt: float,
    warm: float,
    count: int,
) -> tuple[float, float]:
    """Seconds of a time step, and the mean number of evaluations of its force calls.

    Args:
        packing: it is relaxed first, so that contacts are balanced.
        law: with balanced or curved contacts; other laws need no evaluations.
        temperature: of the start.
        dt: the time step.
        warm: time of motion before the steps that count.
        count: number of these, a multiple of 10.
    """
    piece = 10
    with ld.Simulation(packing, law) as sim:
        sim.relax(1e-3)
        sim.lmp.commands_string(
            f"neighbor {SKIN} bin\nvelocity all create {temperature!r} 4711 loop all\n"
            f"fix nve all nve\ntimestep {dt!r}\nrun {round(warm / dt)} post no"
        )
        evaluations = []
        began = time.process_time()
        for n in range(count // piece):
            sim.lmp.command(f"run {piece} {'pre no ' if n else ''}post no")
            evaluations.append(sim.lmp.numpy.extract_compute("deformable_beyond", 0, 1)[2])
        return (time.process_time() - began) / count, statistics.fmean(evaluations)


def energy_error(
    packing: ld.Packing,
    law: ld.Ring,
    dt: float,
    duration: float,
    samples: int,
    commands: str = "",
) -> float:
    """Standard deviation of the total energy over its kinetic part, in a run after `commands`."""
    with ld.Simulation(packing, law) as sim:
        sim.lmp.commands_string(
            f"{commands}\ntimestep {dt!r}\nvelocity all create 1e-5 4711 loop all\n"
            "fix nve all nve\nthermo_style custom step ke etotal\nthermo_modify norm no\n"
            "run 0 post no"
        )
        kinetic, total = energies(sim, samples, round(duration / dt / samples))
    return float(total.std() / kinetic.mean())


def energies(
    sim: ld.Simulation, samples: int, steps: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Kinetic and total energies of a simulation in motion, after each of its runs of `steps`."""
    rows = []
    for _ in range(samples):
        sim.lmp.command(f"run {steps} post no")
        rows.append([sim.lmp.get_thermo(name) for name in ("ke", "etotal")])
    kinetic, total = np.array(rows).T
    return kinetic, total
