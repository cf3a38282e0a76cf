"""The study of grains that leave a silo: what holds for every run, its figures and its page."""

from pathlib import Path

import numpy as np
import pytest
from example_modules import committed, quick

from validation.discharge import __main__ as discharge

pytest.importorskip("matplotlib")


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
