"""The study of grains that leave a silo: what holds for every run, its figures and its page.

Run as a script, this writes table and sentences into the page.
"""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from committed_page import check, write
from example_modules import committed, quick

from validation.discharge import __main__ as discharge

pytest.importorskip("matplotlib")

FOLDER = Path(str(discharge.__file__)).parent
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


def test_the_page_follows_from_the_measurements() -> None:
    check(FOLDER / "README.md", [table()], SENTENCES)


@pytest.mark.slow
def test_quick_discharge(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """More grains leave a larger opening, fewer those that rub; contacts lose what weight does."""
    runs = quick(discharge, tmp_path, monkeypatch)
    # to first order in the time step, which is a 20th of a collision
    np.testing.assert_allclose([run["balance"] for run in runs], 1.0, rtol=0, atol=0.02)
    rate = {(run["case"]["mu"], run["opening"]): np.mean(run["rate"]) for run in runs}
    assert len(rate) == 4
    for mu in (0.0, 0.5):
        assert rate[mu, 7.0] > 1.2 * rate[mu, 5.0]
    for opening in (5.0, 7.0):
        assert rate[0.5, opening] < rate[0.0, opening]


def test_floor_bears_the_weight() -> None:
    """With the drag, and with what grains gain in momentum."""
    drag, steps = 1.4, 800
    case = discharge.Case(0.02, 0.5, drag)
    with discharge.silo(case, 5.0, 16, 1) as sim:
        lmp = sim.lmp
        lmp.commands_string(discharge.scene(case, 16, steps))
        lmp.commands_string(
            "variable momentum equal atoms*vcm(all,y)\n"
            f"variable dragged equal -{drag}*count(bath)*vcm(bath,y)\n"
            f"fix dragged all ave/time 1 {steps} {steps} v_dragged\n"
            f"run {steps}"
        )
        before = lmp.extract_variable("momentum")
        lmp.command(f"run {steps} post no")
        gained = (lmp.extract_variable("momentum") - before) / (steps * case.step)
        push, dragged = (lmp.extract_fix(name, 0, 0) for name in ("push", "dragged"))
        weight = case.weight * lmp.get_natoms()
    assert push > 0.1 * weight
    assert push + dragged - gained == pytest.approx(weight, rel=0.01)


def test_committed_discharge(capsys: pytest.CaptureFixture[str]) -> None:
    """What the page claims: friction slows, weight clogs less; powers of contacts and of drag."""
    data = committed("discharge", discharge, capsys)
    (light, light_rough), (heavy, heavy_rough) = discharge.LIGHT, discharge.HEAVY
    for smooth, rough in ((light, light_rough), (heavy, heavy_rough)):
        fast, slow = (
            {r["opening"]: r for r in data if r["case"] == vars(c)} for c in (smooth, rough)
        )
        for opening, run in slow.items():
            assert max(run["rate"]) < min(fast[opening]["rate"])
    for run in data:
        if not run["case"]["drag"]:
            flowing = [b for b, rate in zip(run["balance"], run["rate"], strict=True) if rate]
            np.testing.assert_allclose(flowing, 1.0, rtol=0, atol=0.006)
    clogged = [
        sum(run["rate"].count(0.0) for run in data if run["case"] == vars(case))
        for case in discharge.CASES
    ]
    assert clogged[1] > clogged[3] > clogged[0] == clogged[2] == clogged[4] == 0


if __name__ == "__main__":
    write(FOLDER / "README.md", [table()], SENTENCES)
