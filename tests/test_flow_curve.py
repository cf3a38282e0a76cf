"""The example of a flow curve: its input in LAMMPS, its script, and its committed figures."""

import json
import math
import re
import shutil
from pathlib import Path

import deformable
import numpy as np
import pytest
from example_modules import example
from programs import program
from test_example_scripts import text

pytest.importorskip("matplotlib")

EXAMPLE = Path(__file__).parents[1] / "examples" / "flow_curve"
DROPLETS = deformable.Ring(kA=math.inf, kP=0.0, tension=1.0)


def test_droplets_without_contacts_follow_the_mean_flow(tmp_path: Path) -> None:
    """The drag leaves the mean flow as it is, across the sides of the box too."""
    shutil.copy(EXAMPLE / "in.flow", tmp_path)
    number, gap = 8, 1.5  # no two of them ever meet
    centers = [[0.3 * n, gap * (n + 0.5)] for n in range(number)]
    box = [[6.0, 0.0], [0.0, gap * number]]
    loose = deformable.Packing(centers, [0, 1] * (number // 2), [0.5, 0.7], box)
    with deformable.Simulation(loose, DROPLETS) as sim:
        sim.state().save(tmp_path / "start")
    script = (tmp_path / "in.flow").read_text()
    (tmp_path / "in.flow").write_text(f"{script}\nwrite_data end.data nocoeff\n")
    text("lmp", "-in", "in.flow", "-var", "rate", "0.05", "-var", "strain", "1.5", cwd=tmp_path)
    strain, stress, pressure, relative = np.loadtxt(tmp_path / "stress.txt").T[1:]
    assert strain[-1] == pytest.approx(1.5, abs=0.02)
    assert np.abs([stress, pressure]).max() == 0.0
    assert relative.max() < 1e-24
    velocities = (tmp_path / "end.data").read_text().partition("Velocities")[2].split()
    vx = np.array(velocities, float).reshape(-1, 4)[:, 1]
    assert np.ptp(vx) == pytest.approx(0.05 * gap * (number - 1), rel=1e-9)


def test_drag_brings_droplets_back_to_the_mean_flow(tmp_path: Path) -> None:
    """Relative velocities decay at the rate drag/mass, so their squares at twice that."""
    shutil.copy(EXAMPLE / "in.flow", tmp_path)
    loose = deformable.Packing([[2.0, 2.0], [6.0, 6.0]], [0, 1], [0.5, 0.7], 8.0 * np.eye(2))
    with deformable.Simulation(loose, DROPLETS) as sim:
        sim.state().save(tmp_path / "start")
    script = (tmp_path / "in.flow").read_text()
    kick = "\nvelocity all set 0.01 0.02 0 sum yes\nrun"
    assert script.count("\nrun ") == 1
    script = script.replace("\nrun", kick)
    (tmp_path / "in.flow").write_text(script)
    values = {"rate": "0.01", "drag": "0.5", "mass": "2", "strain": "0.1", "dt": "0.01"}
    words = [word for name, value in values.items() for word in ("-var", name, value)]
    text("lmp", "-in", "in.flow", *words, cwd=tmp_path)
    strain, *_, relative = np.loadtxt(tmp_path / "stress.txt").T[1:]
    time = strain / 0.01
    rate, _ = np.polyfit(time, np.log(relative), 1)
    assert rate == pytest.approx(-2.0 * 0.5 / 2.0, rel=0.02)


def test_a_strain_without_blocks_is_refused(tmp_path: Path) -> None:
    result = program("python", EXAMPLE / "flow_curve.py", "--strain", "3", cwd=tmp_path)
    assert result.returncode == 2
    assert "--strain must be above 3" in result.stderr
    assert not list(tmp_path.iterdir())


def test_script(tmp_path: Path) -> None:
    """A few droplets at a few rates: stress rises with the rate, and the mass does not matter."""
    shutil.copy(EXAMPLE / "in.flow", tmp_path)
    script = (EXAMPLE / "flow_curve.py").read_text()
    rates = re.findall(r"^RATES = .*$", script, re.M)
    assert len(rates) == 1
    script = script.replace(rates[0], "RATES = (2e-3, 5e-3, 1e-2, 2e-2)")
    (tmp_path / "flow_curve.py").write_text(script)
    text("python", "flow_curve.py", "--number", "16", "--strain", "3.1", cwd=tmp_path)
    data = json.loads((tmp_path / "flow_curve.json").read_text())
    stress = [np.mean(row["blocks"]) for row in data["runs"]]
    assert stress[3] > 1.5 * stress[0] > 0.0
    assert stress[4] == pytest.approx(stress[3], rel=0.3)
    assert 0.0 < stress[5] < stress[3]
    assert (tmp_path / "flow_curve.png").stat().st_size > 10_000


flow_curve = example("flow_curve", "flow_curve")


def test_committed_figures(capsys: pytest.CaptureFixture[str]) -> None:
    """The log is that of the committed measurements, and shows a yield stress."""
    data = json.loads((EXAMPLE / "flow_curve.json").read_text())
    flow_curve.show(data)
    assert capsys.readouterr().out == (EXAMPLE / "flow_curve.log").read_text()
    rates, stress, error, found, errors, chi2 = flow_curve.results(data)
    assert len(rates) == len(flow_curve.RATES)
    assert chi2 < 3.0
    assert 0.2 < found[2] < 0.8
    (still,) = (row for row in data["runs"] if not row["rate"])
    quasistatic, uncertainty = flow_curve.mean(still["blocks"])
    assert abs(found[0] - quasistatic) < 3.0 * np.hypot(errors[0], uncertainty)
    (light,) = (row for row in data["runs"] if row["mass"] != 1.0)
    inertia, uncertainty = flow_curve.mean(light["blocks"])
    assert abs(inertia - stress[-1]) < 3.0 * np.hypot(error[-1], uncertainty)
