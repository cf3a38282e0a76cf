"""What docs/melting.md says of the committed measurements: tables and sentences."""

import json
import math
from pathlib import Path

import numpy as np

from validation.melting import measure, results

ROOT = Path(__file__).parents[2]
FOLDER, PAGE = ROOT / "validation" / "melting", ROOT / "docs" / "melting.md"
RESULT, SMALL = (json.loads((FOLDER / f"{name}.json").read_text()) for name in ("full", "small"))
STAGES = results.stages(RESULT)


def at(number: int, start: str, temperature: float) -> list[dict]:
    return STAGES[number, RESULT["phi"], start, 1, temperature]


def number(quantity: str, temperature: float, start: str = "crystal", size: int = 1024) -> float:
    return results.value(at(size, start, temperature), quantity)[0]


def shown(quantity: str, temperature: float, start: str = "crystal", size: int = 1024) -> str:
    return results.shown(*results.value(at(size, start, temperature), quantity))


def table() -> list[str]:
    """1024 droplets: order from both starts, and defects and stiffness of the crystal."""
    of_both, heated = ("psi_6", "Bragg"), ("defects", "Y a^2/T")
    heads = [f"{name}, {way}" for name in of_both for way in ("heated", "cooled")]
    rows = []
    for size, phi, start, _, temperature in STAGES:
        if (size, phi, start) == (1024, RESULT["phi"], "crystal"):
            cooled = (1024, phi, "random", 1, temperature) in STAGES
            cells = [
                shown(name, temperature, way) if way == "crystal" or cooled else ""
                for name in of_both
                for way in ("crystal", "random")
            ]
            cells += [shown(name, temperature) for name in heated]
            rows.append([f"{temperature:g}", *cells])
    return list(results.lines(["T", *heads, *heated], rows))


def melts() -> str:
    psi, bragg, energy, p = (
        [number(name, temperature) for temperature in (0.0775, 0.08)]
        for name in ("psi_6", "Bragg", "energy", "p")
    )
    step = energy[1] - energy[0]
    crystal = 0.5 * (number("energy", 0.075) - number("energy", 0.07))
    return (
        f"Between T = 0.0775 and 0.08 psi_6 falls from {psi[0]:.2f} to {psi[1]:.2f} and the Bragg "
        f"peak from {bragg[0]:.2f} to {bragg[1]:.2f}. The energy of a droplet rises by {step:.3f}, "
        f"{step / crystal:.0f} times as much as in an equal step of the crystal, and the pressure "
        f"by {100.0 * (p[1] / p[0] - 1.0):.0f} %."
    )


def unbinds() -> str:
    rest = RESULT["crystal"]
    return (
        f"At 0.0775 Y a^2/T is {shown('Y a^2/T', 0.0775)}, and 16 pi is {16.0 * math.pi:.1f}. With "
        f"the moduli of the crystal at rest, G = {rest['G']:.3f} and K = {rest['K']:.2f}, this "
        f"temperature would be {rest['unbinding']:.3f}: motion opens contacts."
    )


def exponents() -> str:
    told = []
    for temperature in (0.06, 0.07, 0.075):
        pair = [at(size, "crystal", temperature) for size in (256, 1024)]
        told.append(results.shown(*results.between_sizes(*pair, "Bragg")))
    moduli = [shown("eta_K by moduli", temperature) for temperature in (0.06, 0.07, 0.075)]
    return (
        f"From 256 to 1024 droplets it falls with the exponents {told[0]}, {told[1]} and {told[2]} "
        f"at T = 0.06, 0.07 and 0.075. The moduli give {moduli[0]}, {moduli[1]} and {moduli[2]}."
    )


def hexatic() -> str:
    return (
        f"The heated packing at 0.0775 has eta_6 = {shown('eta_6', 0.0775)} and a Bragg peak; at "
        f"0.08 eta_6 is {shown('eta_6', 0.08)}."
    )


def slow() -> str:
    late = results.late(at(1024, "random", 0.075))
    forgotten, whole = results.memory(late), results.LEG * len(late)
    return (
        f"1024 cooled droplets at 0.075 forget their order within a time of {forgotten:.0f}, and "
        f"the run has {whole / forgotten:.0f} such times."
    )


def quenched() -> str:
    excess = [100.0 * row["excess"] for row in RESULT["quenches"] if row["defects"]]
    return (
        f"Those from T = 0.09 keep defects, and have {min(excess):.0f} to {max(excess):.0f} % more "
        "energy than it."
    )


def settings() -> str:
    """Largest changes by other steps and balance, and by the law with straight lines."""
    rows = {(row["settings"], row["T"]): row for row in RESULT["checks"]}
    used, *others = measure.SETTINGS
    exact, straight = (
        {
            name: max(
                abs(rows[other, t][name][0] / rows[used, t][name][0] - 1.0) for t in (0.06, 0.1)
            )
            for name in ("energy", "pressure")
        }
        for other in others
    )
    return (
        "Half of the step and a balance of 1e-8 change energy and pressure by at most "
        f"{100.0 * exact['energy']:.1f} and {100.0 * exact['pressure']:.1f} %, within 1.3 errors. "
        f"The law `balanced` changes them by up to {100.0 * straight['energy']:.0f} and "
        f"{100.0 * straight['pressure']:.0f} %, and is not used."
    )


def took() -> str:
    """Processor time of all ramps, and of polygons by the time of one of their steps."""
    cost = RESULT["polygons"]
    legs = [leg for ramp in RESULT["ramps"] if ramp["number"] == 1024 for leg in ramp["legs"]]
    each = 1e6 * np.mean([leg["seconds"] for leg in legs]) / results.LEG / 1024
    slower = cost["microseconds"] / cost["step"] / each
    minutes = results.seconds(RESULT) / 60.0
    return (
        f"All ramps take {minutes:.0f} minutes of processor time; with polygons of "
        f"{cost['vertices']} vertices they would take {minutes / 60.0 * slower:.0f} hours."
    )


TABLES = (table,)
SENTENCES = (
    *(melts, unbinds, exponents, hexatic, slow),
    *(quenched, settings, took),
)
PAGES = {PAGE: (TABLES, SENTENCES)}
