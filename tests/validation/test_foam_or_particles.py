"""The study of foam and particles: its small run, its committed results and its page.

Run as a script, this writes tables and sentences into the page, and the log.
"""

from pathlib import Path

import numpy as np
import pytest
from committed_page import check, write
from programs import study

from validation.foam_or_particles import __main__ as fits

pytest.importorskip("matplotlib")

ROOT = Path(__file__).parents[2]
PAGE, FOLDER = ROOT / "docs" / "foam_or_particles.md", ROOT / "validation" / "foam_or_particles"

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


FILES = [FOLDER / f"rows_{number}.json" for number in (512, 64, 2048)]
ROWS = fits.read(FILES)
FOAM = fits.chosen(ROWS, "foam", 512)
LOG = FOLDER / "foam_or_particles.log"


def test_it_is_an_ensemble() -> None:
    for law in fits.NAMES:
        packings = fits.chosen(ROWS, law, 512)
        assert [row["seed"] for row in packings] == list(range(1, 9))
    for row in ROWS:
        assert max(row["residual"]) < 1e-6
    # all laws start from the same packings
    for onsets in zip(*(fits.chosen(ROWS, law, 512) for law in ("foam", "disks")), strict=True):
        assert onsets[0]["phi_J"] == onsets[1]["phi_J"]


def of_law(law: str, shape: str = "sum") -> tuple[np.ndarray, np.ndarray, float]:
    return fits.fit(fits.chosen(ROWS, law, 512), shape)


def shear_modulus(law: str) -> np.ndarray:
    return fits.column(fits.chosen(ROWS, law, 512), "shear_modulus")


CHI = ("chi^2 of the sum", "of the root", "of the line", "of the free line")


def laws() -> list[str]:
    """Fits of each law, 512 particles."""
    rows = [[law, *fits.of_fits(fits.chosen(ROWS, law, 512))[:6]] for law in fits.NAMES]
    return list(fits.table(("law", "a", "b", *CHI), rows))


def thresholds() -> list[str]:
    """Fits to contacts of foam that bear a part of the mean force."""
    rows = [[f"{t:g}", *fits.of_fits(FOAM, fits.WINDOW, t)[:6]] for t in fits.SHOWN]
    return list(fits.table(("threshold", "a", "b", *CHI), rows))


def foam() -> str:
    (a, b), (da, db), chi2 = of_law("foam")
    root, line, free = (
        fits.short(of_law("foam", shape)[2]) for shape in ("root", "line", "free line")
    )
    return (
        f"a = {fits.with_error(a, da)} and b = {fits.with_error(b, db)}. chi^2 per degree of "
        f"freedom is {fits.short(chi2)}, against {root} of a root, {line} of a line and {free} of "
        "a line with an onset of its own."
    )


def disks() -> str:
    (_, b), (_, error), _ = of_law("disks")
    dense = [fits.mean(fits.excess(fits.chosen(ROWS, law, 512)))[-5] for law in ("foam", "disks")]
    return (
        f"Disks have b = {fits.with_error(b, error)} only, and at phi = 0.95 foam has "
        f"{dense[0] / dense[1]:.1f} times their z - z_iso."
    )


def sizes() -> str:
    found = [fits.fit(fits.chosen(ROWS, "foam", number), "sum") for number in (64, 512, 2048)]
    told = [fits.with_error(a, da) for (a, _), (da, _), _ in found]
    return f"a of foam is {told[0]} at N = 64, {told[1]} at 512 and {told[2]} at 2048."


def windows() -> str:
    found = [fits.fit(FOAM, "sum", window)[0][0] for window in fits.WINDOWS]
    (a, _), (da, _), _ = fits.fit(fits.unbroken(FOAM), "sum")
    return (
        f"Other windows of x between 2e-4 and 0.12 give a = {min(found):.2f} to {max(found):.2f}. "
        "After a rearrangement a packing has another onset, which x does not know; without such "
        f"states up to x = 0.007 a is {fits.with_error(a, da)}."
    )


def equal() -> str:
    told = []
    for law in ("foam", "disks"):
        packings = fits.chosen(ROWS, law, 64)
        told += [
            fits.short(fits.at_equal_phi(packings, shape)[2]) for shape in (fits.line, fits.root)
        ]
    return (
        f"With 64 particles foam then looks like a line, chi^2 = {told[0]} against {told[1]} of a "
        f"root; for disks both are as good, {told[2]} and {told[3]}."
    )


def moduli() -> str:
    x = fits.mean(fits.excess_phi(FOAM))
    near = (x > 1.5e-3) & (x < 0.026)
    ratio = fits.mean(shear_modulus("foam"))[near] / np.sqrt(x[near])
    bulk = fits.mean(fits.column(FOAM, "bulk_modulus"))[0]
    dense = [
        fits.with_error(fits.mean(g)[-1], fits.error_of(g)[-1])
        for g in map(shear_modulus, ("foam", "straight films"))
    ]
    hexagonal = np.sqrt(np.sqrt(3.0) / (2.0 * np.pi) * 0.99)
    return (
        f"K is finite at the onset, {bulk:.2f} at x = 1e-4, and G rises as a root: G/sqrt(x) is "
        f"{min(ratio):.2f} to {max(ratio):.2f} from x = 1.6e-3 to 0.025. At phi = 0.99 G is "
        f"{dense[0]}; a hexagonal array of equal droplets has {hexagonal:.3f}. Straight films have "
        f"{dense[1]} there."
    )


def took() -> str:
    seconds = sum(row["seconds"] for row in ROWS if row["number"] == 512)
    return f"takes {seconds / 60:.0f} minutes of processor time"


TABLES = (laws, thresholds)
SENTENCES = (foam, disks, sizes, windows, equal, moduli, took)


def test_the_page_follows_from_the_measurements() -> None:
    check(PAGE, (rows() for rows in TABLES), SENTENCES)


def test_the_log_has_all_tables() -> None:
    assert LOG.read_text().splitlines() == list(fits.page(ROWS))


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


if __name__ == "__main__":
    write(PAGE, (rows() for rows in TABLES), SENTENCES)
    LOG.write_text("\n".join(fits.page(ROWS)) + "\n")
