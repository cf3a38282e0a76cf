"""Times that LAMMPS writes into its log."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lammps import lammps

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def timed_run(lmp: lammps, steps: int, log: Path, sections: Sequence[str]) -> dict[str, float]:
    """Seconds per atom-step of a run, in all (`loop`) and by LAMMPS' sections; ends LAMMPS.

    `loop` is processor time. The log is new, and has the timed run only.
    """
    n = lmp.get_natoms()
    lmp.command(f"log {log}")
    lmp.command(f"run {steps}")
    lmp.close()
    seconds = {}
    for line in log.read_text().splitlines():
        words = line.replace("|", " ").split()
        if line.startswith("Loop time"):
            seconds["loop"] = float(words[3]) / (n * steps)
        elif "% CPU use" in line:  # fraction of the time in which this process was running
            seconds["loop"] *= min(1.0, float(words[0].rstrip("%")) / 100)
        elif len(words) > 2 and words[0] in sections:
            average = words[1] if words[0] == "Other" else words[2]
            seconds[words[0].lower()] = float(average) / (n * steps)
    return seconds
