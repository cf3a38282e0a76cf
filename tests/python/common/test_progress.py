"""Progress off a terminal."""

import re
import sys

import lammps_deformable as ld
import pytest
from lammps_deformable.common import ranks


def test_lines_off_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    assert not sys.stderr.isatty()
    monkeypatch.setattr(ranks, "_LINES", 1e-9)
    with ranks.progress("jamming", unit="step") as bar:
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
    with ranks.progress("jamming", unit="step") as bar:
        bar.update()
        ranks.print_once("step 1")
    assert capfd.readouterr() == ("step 1\n", "")


def test_lines_of_jam_tell_the_stage_and_how_far_it_is(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ranks, "_LINES", 1e-9)
    ld.jam(ld.bidisperse(64, seed=1))
    lines = [line for line in capfd.readouterr().err.splitlines() if "jamming" in line]
    first, last = lines[0], lines[-1]
    assert "jamming, compression: 20" in first
    assert re.search("jamming, decompression to 1.4e-06: [0-9]+ iter", last)
    for line in (first, last):
        for name in ("phi=0.", "pressure=", "residual="):
            assert name in line


def test_calls_side_by_side_have_no_bars_of_their_own(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ranks, "_LINES", 1e-9)
    ld.parallel_map(ld.jam, [ld.bidisperse(16, seed=1)], workers=1)
    assert [line.split(":")[0] for line in capfd.readouterr().err.splitlines()] == ["jam"]


def test_progress_is_hidden(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ranks, "_LINES", 1e-9)
    lines = []
    for hide in (
        lambda: ld.show_progress(False),
        lambda: monkeypatch.setenv("TQDM_DISABLE", "1"),
        lambda: monkeypatch.setenv("TQDM_DISABLE", ""),
    ):
        hide()
        with ranks.progress("jamming", unit="step") as bar:
            bar.update()
        lines.append(capfd.readouterr().err)
        ld.show_progress()
    assert lines[:2] == ["", ""]
    assert "jamming" in lines[2]
    with pytest.raises(ld.ParameterError, match=r"^shown must be of the kind bool"):
        ld.show_progress("no")  # type: ignore[arg-type]
