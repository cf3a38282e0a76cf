"""Examples whose contacts rub: what their pages claim."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from programs import output
from test_example_scripts import EXAMPLES


def tables(printed: str) -> list[np.ndarray]:
    """The numbers of both tables."""
    return [
        np.array([row.split() for row in re.findall(r"^\d\.\d +.*$", part, re.M)], float)
        for part in printed.split("\n\n")
    ]


def rows(printed: str) -> np.ndarray:
    """The columns of a table below its head."""
    return np.array([re.findall(r"\d[.\d]*", row) for row in printed.splitlines()[1:]], float).T


@pytest.mark.slow
def test_restitution(tmp_path: Path) -> None:
    """Restitution and sliding in closed form; energies balance; the log is that of a run."""
    pytest.importorskip("matplotlib")
    folder = shutil.copytree(EXAMPLES / "restitution", tmp_path / "restitution")
    (folder / "restitution.png").unlink()
    head_on, off_center = tables(output("python", "restitution.py", cwd=folder, MPLBACKEND="agg"))
    assert (folder / "restitution.png").stat().st_size > 10_000
    _, found, expected, error = head_on.T
    np.testing.assert_allclose(found, expected, rtol=0, atol=4.1e-4)
    assert np.abs(error).max() < 1e-5
    mu, before, after, slid, error = off_center.T
    slides = before > 4 * mu  # fast enough
    np.testing.assert_allclose(after[slides], slid[slides], rtol=0, atol=0.03)
    assert (after[~slides] > slid[~slides]).all()
    assert after[(mu == 0.3) & (before == 0.5)] < -0.3  # the spring throws it back
    assert np.abs(error).max() < 1e-5
    logged = tables((EXAMPLES / "restitution" / "restitution.log").read_text())
    np.testing.assert_allclose(logged[0][:, :3], head_on[:, :3], rtol=0, atol=2e-4)
    np.testing.assert_allclose(logged[1][:, :4], off_center[:, :4], rtol=0, atol=2e-3)


@pytest.mark.slow
def test_heap(tmp_path: Path) -> None:
    """The angle grows with the friction of contacts; the log is that of a run."""
    pytest.importorskip("matplotlib")
    folder = shutil.copytree(EXAMPLES / "heap", tmp_path / "heap")
    _, angle, error, stay, used = rows(output("python", "heap.py", cwd=folder, MPLBACKEND="agg"))
    assert angle[-1] > angle[0] + 2 * np.hypot(error[0], error[-1])
    assert stay[-1] > stay[0]
    assert (used < 0.6).all()  # at rest
    _, logged, uncertain, *_ = rows((EXAMPLES / "heap" / "heap.log").read_text())
    # other last digits make other heaps
    assert (np.abs(logged - angle) < 4 * np.hypot(uncertain, error) + 1).all()
