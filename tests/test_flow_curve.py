"""The example of a flow curve: its script, and its committed figures."""

import json
from pathlib import Path

import numpy as np
import pytest
from example_modules import example
from programs import program
from test_example_materials import part_of
from test_example_scripts import text

pytest.importorskip("matplotlib")

EXAMPLE = Path(__file__).parents[1] / "examples" / "flow_curve"


def test_a_strain_without_blocks_is_refused(tmp_path: Path) -> None:
    result = program("python", EXAMPLE / "flow_curve.py", "--strain", "3", cwd=tmp_path)
    assert result.returncode == 2
    assert "--strain must be above 3" in result.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_script(tmp_path: Path) -> None:
    """A few droplets at a few rates: each flow bears more stress than relaxed steps do.

    128 droplets bear 0.03 at the slowest of these rates, and 0.007 without rate. Means over a
    strain of 1 spread by 0.003 there, so those of 16 droplets by 0.008: the difference is three
    times that. Faster flows of so few may order, and then bear no more than slower ones.
    """
    smaller = {"RATES": (1e-2, 8e-2), "STEP": 0.02, "BEGIN, BLOCK": (1.0, 0.5)}
    part_of(EXAMPLE / "flow_curve.py", tmp_path, **smaller)
    text("python", "flow_curve.py", "--number", "16", "--strain", "2.1", cwd=tmp_path)
    data = json.loads((tmp_path / "flow_curve.json").read_text())
    still, *flows = [np.mean(row["blocks"]) for row in data["runs"]]
    assert len(flows) == 6
    assert min(flows) > still > 0.0
    assert (tmp_path / "flow_curve.png").stat().st_size > 10_000


flow_curve = example("flow_curve", "flow_curve")


def test_committed_figures(capsys: pytest.CaptureFixture[str]) -> None:
    """The log is that of the committed measurements, and shows a yield stress."""
    data = json.loads((EXAMPLE / "flow_curve.json").read_text())
    flow_curve.show(data)
    assert capsys.readouterr().out == (EXAMPLE / "flow_curve.log").read_text()
    page = (EXAMPLE / "README.md").read_text()
    quasistatic, uncertainty = flow_curve.quasistatic(data)
    assert f"The quasistatic mean stress is {quasistatic:.4f} ± {uncertainty:.4f}." in page
    all_fits = []
    for by in flow_curve.UNITS:
        rates, _, _, found, errors, chi2 = flow_curve.results(data, by)
        assert len(rates) == len(flow_curve.RATES)
        assert chi2 < 1.4
        assert 0.3 < found[2] < 0.6
        assert abs(found[0] - quasistatic) < 2.0 * np.hypot(errors[0], uncertainty)
        all_fits.append(np.transpose([found, errors]))
    for k, (name, digits) in enumerate((("yield stress", 4), ("factor", 3), ("power", 3))):
        cells = (
            f"{value:.{digits}f} ± {error:.{digits}f}" for value, error in np.array(all_fits)[:, k]
        )
        assert f"| {name} | {' | '.join(cells)} |" in page
