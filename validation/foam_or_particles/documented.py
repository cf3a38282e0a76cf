"""What docs/foam_or_particles.md says of the committed packings, and the log of the study."""

from pathlib import Path

import numpy as np

from validation.foam_or_particles import __main__ as fits

ROOT = Path(__file__).parents[2]
PAGE, FOLDER = ROOT / "docs" / "foam_or_particles.md", ROOT / "validation" / "foam_or_particles"
FILES = [FOLDER / f"rows_{number}.json" for number in (512, 64, 2048)]
ROWS = fits.read(FILES)
FOAM = fits.chosen(ROWS, "foam", 512)
LOG = FOLDER / "foam_or_particles.log"


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
    return (
        f"Other windows of x between 2e-4 and 0.12 give a = {min(found):.2f} to {max(found):.2f}, "
        "and exclude the line."
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
PAGES = {PAGE: (TABLES, SENTENCES)}
LOGS = {LOG: lambda: fits.page(ROWS)}
