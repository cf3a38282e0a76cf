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
    assert "jamming" in first and "30step" in first and "phi=0.82" in first
    assert "60step" in second and "phi=0.84" in second
    assert "\r" not in err


def test_nothing_in_the_first_minute(capfd: pytest.CaptureFixture[str]) -> None:
    with progress.progress("jamming", unit="step") as bar:
        bar.update()
    assert capfd.readouterr() == ("", "")
