"""The study of foam and particles: its small run, its committed results and its page.

Run as a script, this writes the tables of the results into the page.
"""

import importlib.util
import shutil
from pathlib import Path

import numpy as np
import pytest
from programs import output

pytest.importorskip("matplotlib")

ROOT = Path(__file__).parents[1]
PAGE, FOLDER = ROOT / "docs" / "foam_or_particles.md", ROOT / "examples" / "foam_or_particles"
spec = importlib.util.spec_from_file_location("fits", FOLDER / "fits.py")
assert spec is not None
assert spec.loader is not None
fits = importlib.util.module_from_spec(spec)
spec.loader.exec_module(fits)

# Forces of relaxed states are balanced to 1e-6 of a contact force. Near the onset the softest modes
# are a thousand times softer than contacts (omega* of docs/jamming.md, squared), so that overlaps
# and pressures are known to 1e-3.
KNOWN = 1e-3


def test_small_run(tmp_path: Path) -> None:
    """The rows on record near the onset, and confluence; in between packings rearrange."""
    for script in ("foam_or_particles.py", "fits.py"):
        shutil.copy(FOLDER / script, tmp_path)
    laws = ("foam", "elastic rings", "disks")
    options = ("--number", "32", "--seeds", "2", "--workers", "1", "--laws", *laws)
    printed = output("python", "foam_or_particles.py", *options, cwd=tmp_path)
    assert (tmp_path / "foam_or_particles_32.png").stat().st_size > 10_000
    rows, expected = (fits.read([folder / "rows_32.json"]) for folder in (tmp_path, FOLDER))
    expected = [row for row in expected if row["law"] in (*laws, "foam, wetted")]
    assert "\n".join(fits.page(rows)) in printed
    assert [(row["law"], row["seed"]) for row in rows] == [
        (row["law"], row["seed"]) for row in expected
    ]
    for row, stored in zip(rows, expected, strict=True):
        assert max(row["residual"]) < 1e-6
        at_onset = 1e-9 if row["law"] != "foam, wetted" else 0.02
        assert row["phi_J"] == pytest.approx(stored["phi_J"], rel=at_onset)
        if row["law"] != "foam, wetted":
            near = slice(0, 4)  # none of these packings rearranges here
            assert row["pressure"][near] == pytest.approx(stored["pressure"][near], rel=KNOWN)
            # contacts of the networks bear 0.05 of the mean force or more, those of rattlers 1e-6
            excess, before = (np.array(of["excess"])[near, :2] for of in (row, stored))
            assert np.abs(excess - before).max() < 1e-5
        if "foam" in row["law"]:
            assert row["coordination"][-1] == pytest.approx(6.0, abs=1e-9)
