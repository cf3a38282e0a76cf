"""The study of foam and particles: its small run, its committed results and its page."""

from pathlib import Path

import numpy as np
import pytest
from programs import study

from validation.foam_or_particles import __main__ as fits
from validation.foam_or_particles.documented import (
    FOAM,
    FOLDER,
    ROWS,
    of_law,
)

pytest.importorskip("matplotlib")
# Forces of relaxed states are balanced to 1e-6 of a contact force. Near the onset the softest modes
# are a thousand times softer than contacts (omega* of docs/jamming.md, squared), so that overlaps
# and pressures are known to 1e-3.
KNOWN = 1e-3


@pytest.mark.slow
def test_small_run(tmp_path: Path) -> None:
    """The rows on record near the onset, and confluence; in between packings rearrange."""
    laws = ("foam", "elastic rings", "disks")
    options = ("--number", "32", "--seeds", "2", "--workers", "1", "--laws", *laws)
    printed = study("foam_or_particles", *options, cwd=tmp_path)
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


def test_it_is_an_ensemble() -> None:
    for law in fits.NAMES:
        packings = fits.chosen(ROWS, law, 512)
        assert [row["seed"] for row in packings] == list(range(1, 9))
    for row in ROWS:
        assert max(row["residual"]) < 1e-6
    # all laws start from the same packings
    for onsets in zip(*(fits.chosen(ROWS, law, 512) for law in ("foam", "disks")), strict=True):
        assert onsets[0]["phi_J"] == onsets[1]["phi_J"]


def test_no_law_is_a_line() -> None:
    for law in fits.NAMES:
        for window in fits.WINDOWS:
            chi2 = {
                shape: fits.fit(fits.chosen(ROWS, law, 512), shape, window)[2]
                for shape in fits.SHAPES
            }
            assert chi2["line"] > 10.0 * chi2["sum"], (law, window)
            assert chi2["free line"] > 3.0 * chi2["sum"], (law, window)


def test_straight_films_have_the_same_contacts_and_disks_have_fewer() -> None:
    (foam, errors, _), (straight, others, _), (disks, less, _) = map(
        of_law, ("foam", "straight films", "disks")
    )
    assert (np.abs(foam - straight) < np.hypot(errors, others)).all()
    assert foam[1] - disks[1] > 2.0 * np.hypot(errors[1], less[1])
    dense = [fits.mean(fits.excess(fits.chosen(ROWS, law, 512)))[-5] for law in ("foam", "disks")]
    assert dense[0] / dense[1] == pytest.approx(1.5, abs=0.05)


def test_missed_contacts_look_like_a_line() -> None:
    chi2 = {shape: fits.fit(FOAM, shape, threshold=0.1)[2] for shape in fits.SHAPES}
    assert min(chi2, key=chi2.__getitem__) == "free line"
    assert fits.fit(FOAM, "sum", threshold=0.1)[0][0] < 0.0


def test_small_packings_at_equal_phi_look_like_a_line() -> None:
    for law, line, root in (("foam", True, False), ("disks", True, True)):
        packings = fits.chosen(ROWS, law, 64)
        assert (fits.at_equal_phi(packings, fits.line)[2] < 4.0) == line
        assert (fits.at_equal_phi(packings, fits.root)[2] < 4.0) == root
