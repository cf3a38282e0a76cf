"""What the page of this study says of the committed runs: its table and sentences."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from validation.discharge import __main__ as discharge

FOLDER = Path(__file__).parent
DATA = json.loads((FOLDER / "discharge.json").read_text())


def table() -> list[str]:
    """Fits of each case: the power with its offset, and chi^2 of it and of given powers."""
    lines = ["| weight | mu | | power b | k | chi^2 | b = 1/2 | 1 | 3/2 |", "|---" * 9 + "|"]
    for case in discharge.CASES:
        points = discharge.rates(DATA, case)
        (_, k, b), (_, dk, db), _ = discharge.fit(*points)
        chi = [discharge.fit(*points, power)[2] for power in (None, *discharge.POWERS)]
        cells = [f"{case.weight:g}", f"{case.mu:g}", "drag" if case.drag else ""]
        cells += [f"{b:.2f} ± {db:.2f}", f"{k:.1f} ± {dk:.1f}", *(f"{each:.1f}" for each in chi)]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def mean_rates(case: discharge.Case, rows: int = discharge.ROWS) -> dict[float, list[float]]:
    """Rates of the runs of each opening that did not clog."""
    return {
        run["opening"]: [rate for rate in run["rate"] if rate]
        for run in DATA
        if run["case"] == asdict(case) and run["rows"] == rows
    }


def slowed() -> str:
    found = []
    for smooth, rough in (discharge.LIGHT, discharge.HEAVY):
        fast = mean_rates(smooth)
        found += [
            np.mean(rates) / np.mean(fast[opening])
            for opening, rates in mean_rates(rough).items()
            if rates
        ]
    return f"Friction slows the flow to {min(found):.2f} to {max(found):.2f} of that without."


def clogs() -> str:
    told = []
    for case in (discharge.LIGHT[1], discharge.HEAVY[1]):
        runs = [run for run in DATA if run["case"] == asdict(case)]
        widest = max(run["opening"] for run in runs if 0.0 in run["rate"])
        told.append((sum(run["rate"].count(0.0) for run in runs), widest))
    (light, wide), (heavy, narrow) = told
    return (
        f"With it {light} runs of the light grains clog, at openings up to {wide:g}, and {heavy} "
        f"of the soft ones, at {narrow:g}. Without it none clogs."
    )


def taller() -> str:
    """Growth of the flow with the height, with and without friction, and of a liquid."""
    told = []
    for case in discharge.HEAVY:
        low, high = (mean_rates(case, rows)[6.0] for rows in (discharge.ROWS, 27))
        growth = np.mean(high) / np.mean(low) - 1.0
        error = np.hypot(*(np.std(each, ddof=1) / np.mean(each) for each in (low, high)))
        told.append(f"{100.0 * growth:.0f} ± {100.0 * error / np.sqrt(3.0) * (1 + growth):.0f} %")
    liquid = 100.0 * (np.sqrt(27.0 / discharge.ROWS) - 1.0)
    return (
        f"With 27 instead of 18 rows at opening 6 and weight 0.02 the flow grows by {told[0]} "
        f"without friction, and by {told[1]} with it; that of a liquid would grow by "
        f"{liquid:.0f} %."
    )


SENTENCES = (slowed, clogs, taller)
PAGES = {FOLDER / "README.md": ((table,), SENTENCES)}
