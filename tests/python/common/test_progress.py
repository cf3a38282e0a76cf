"""Progress off a terminal."""

import sys

import pytest
from deformable.common import progress


def test_lines_off_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    assert not sys.stderr.isatty()
    monkeypatch.setattr(progress, "_LINES", 1e-9)
    with progress.progress("jamming", unit="step") as bar:
        for phi in (0.82, 0.84):
            bar.set_postfix(phi=phi)
            bar.update(30)
    out, err = capfd.readouterr()
    first, second = err.splitlines()
    assert out == ""
    for word in ("jamming", "30 steps [", "phi=0.82"):
        assert word in first
    for word in ("60 steps [", "phi=0.84"):
        assert word in second
    assert "\r" not in err


def test_nothing_in_the_first_minute(capfd: pytest.CaptureFixture[str]) -> None:
    with progress.progress("jamming", unit="step") as bar:
        bar.update()
        progress.print_once("step 1")
    assert capfd.readouterr() == ("step 1\n", "")
