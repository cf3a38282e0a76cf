"""The example of grains that flow under pressure: what holds for every run, and its figures."""

from pathlib import Path

import numpy as np
import pytest
from example_modules import committed, example, quick

pytest.importorskip("matplotlib")

inertial_flow = example("inertial_flow", "inertial_flow")

ENERGY = """
compute spins all erotate/sphere
variable held equal pe+(atoms-1)*c_flow+1.25*c_spins
thermo_style custom pe ke v_held f_deformable_friction
thermo_modify norm no
run 0 post no
"""


def test_shear_and_pressure_do_the_work_that_contacts_lose(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also Coulomb's bound at each contact, and no drift across the flow."""
    monkeypatch.setattr(inertial_flow, "GAIN", 0.001)  # the box hardly accelerates
    softness, mu, inertia = 0.1, 0.4, 0.1
    sim, steps = inertial_flow.started(softness, mu, inertia, 40)
    with sim:
        lmp = sim.lmp
        lmp.commands_string(ENERGY)
        lmp.command(f"run {steps} post no")  # the box has its rate from here on
        before, work = lmp.last_thermo(), 0.0
        for _ in range(3):
            lmp.command(f"run {steps} post no")
            work += lmp.extract_fix("means", 0, 1, 4) * steps * inertial_flow.STEP
            end = inertial_flow.at_the_end(lmp, mu)
            assert 0.5 < end["used"] < 1 + 1e-12
            assert abs(end["drift"]) < 0.01 * np.sqrt(lmp.extract_compute("flow", 0, 0))
        after = lmp.last_thermo()
    gained, lost = (after[name] - before[name] for name in ("v_held", "f_deformable_friction"))
    assert lost > 0.5 * work
    assert gained + lost == pytest.approx(work, rel=0.01)


def test_quick_inertial_flow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Faster flows bear more stress and dilate; no contact has more than its friction."""
    runs = quick(inertial_flow, tmp_path, monkeypatch)
    for slow, fast in zip(runs[::2], runs[1::2], strict=True):
        (mu, phi), (more, less) = (
            [inertial_flow.averaged(run)[name][0] for name in ("mu", "phi")] for run in (slow, fast)
        )
        assert 0.2 < mu < more < 0.6
        assert phi > less
    assert min(min(run["blocks"]["used"]) for run in runs) > 0.5
    assert max(max(run["blocks"]["used"]) for run in runs) < 1 + 1e-12


def test_committed_inertial_flow(capsys: pytest.CaptureFixture[str]) -> None:
    """What the page claims: stiff grains are those of da Cruz and others, soft ones slide more."""
    data = committed("inertial_flow", inertial_flow, capsys)
    flows = inertial_flow.by_case(data)
    assert list(flows) == list(inertial_flow.CASES)
    for run in data:
        shown = inertial_flow.averaged(run)
        assert abs(shown["lost"][0] - 1) < 4 * shown["lost"][1]
        assert abs(shown["pressure"][0] - 1) < max(0.02, 4 * shown["pressure"][1])
        assert max(run["blocks"]["used"]) < 1 + 1e-12
    (friction, errors), (packing, _) = (
        np.transpose([inertial_flow.fitted(runs, name)[:2] for runs in flows.values()], (1, 0, 2))
        for name in ("mu", "phi")
    )
    np.testing.assert_allclose(friction[0], [0.25, 1.1], rtol=0.2)
    np.testing.assert_allclose(packing[0], [0.81, -0.3], rtol=0.2)
    assert (np.diff(friction[:3], axis=0) < 0).all()  # at rest, and how it grows
    assert (np.diff(packing[:3, 0]) > 0).all()
    assert friction[3, 0] < friction[1, 0] - 5 * np.hypot(errors[1, 0], errors[3, 0])
