"""Tables of docs/jamming.md have the numbers of validation/jamming.

Run as a script, this writes them into the page.
"""

import json
import re
from pathlib import Path
from textwrap import fill

import numpy as np

from validation.jamming.vibrations import exponent, summarize

ROOT = Path(__file__).parents[2]
PAGE, FOLDER = ROOT / "docs" / "jamming.md", ROOT / "validation" / "jamming"
SUMMARY = json.loads((FOLDER / "summary.json").read_text())
BEFORE = json.loads((FOLDER / "bisection" / "summary.json").read_text())["onset"]
VIBRATIONS = json.loads((FOLDER / "vibrations.json").read_text())


def table_of(heads, rows):
    """Lines of a table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return ["|" + "|".join(f" {cell} " if cell else " " for cell in line) + "|" for line in lines]


def value(row, name, digits):
    """A mean with its standard error, if it has one."""
    found, error = row[name], row[f"{name}_error"]
    if found is None:
        return ""
    return f"{found:.{digits}f}" + ("" if error is None else f" ± {error:.{digits}f}")


def short(found, digits=2):
    """A number with so many digits."""
    text = f"{found:.{digits}g}"
    return f"{float(text):g}" if "e" not in text or 1e-4 <= abs(found) < 1e5 else text


def ensembles_table():
    """Disks by the former bisection and by the method of today."""
    rows = []
    for method, table in (("bisection, FIRE", BEFORE), ("rigid side", SUMMARY["onset"])):
        for row in table:
            if row["law"] == "disk" and row["number"] in (64, 256, 512):
                means = (value(row, *of) for of in (("phi", 4), ("excess_contacts", 2)))
                rattlers = value(row, "rattlers", 1)
                rows.append((row["number"], method, str(row["packings"]), *means, rattlers))
    heads = ["N", "method", "packings", "phi_J", "contacts - (2 N' - 1)", "rattlers"]
    return table_of(heads, [[str(n), *cells] for n, *cells in sorted(rows)])


def onset_table():
    """Onsets of each law and threshold."""
    rows, last = [], None
    for row in SUMMARY["onset"]:
        kind = f"**{row['law']}, threshold {row['onset_pressure']:.0e}**".replace("e-0", "e-")
        if kind != last:
            rows.append([kind, "", "", "", "", ""])
            last = kind
        excess, seconds = value(row, "excess_contacts", 2), short(row["seconds"])
        means = (value(row, "phi", 4), value(row, "contacts", 1), excess, seconds)
        rows.append([f"{row['number']}", f"{row['packings']}", *means])
    heads = ["N", "packings", "phi_J", "contacts", "contacts - (2 N' - 1)", "seconds"]
    return table_of(heads, rows)


def exponents_table():
    """Exponents over phi - phi_J from finite strains."""
    found = SUMMARY["exponents"]
    heads = [
        "exponent in phi - phi_J",
        *(f"{row['law']}, N = {row['number']}, {row['packings']} packings" for row in packings()),
    ]
    names = {
        "pressure": "pressure",
        "bulk_modulus": "bulk modulus",
        "shear_modulus": "shear modulus",
        "coordination": "z - z_iso",
    }
    return table_of(heads, [[text, *(value(r, k, 3) for r in found)] for k, text in names.items()])


def packings():
    """Rows of onsets that have exponents."""
    keys = ("law", "onset_pressure", "number")
    wanted = [tuple(row[key] for key in keys) for row in SUMMARY["exponents"]]
    found = {tuple(row[key] for key in keys): row for row in SUMMARY["onset"]}
    return [found[key] for key in wanted]


def vibrations_table():
    """Means over packings near each phi - phi_J, of modes and moduli."""
    heads = ["law, N", "packings", "phi - phi_J", "p", "z - z_iso", "G", "K", "omega*"]
    rows = [
        [
            f"{row['law']}, {row['number']}",
            str(row["packings"]),
            f"{row['excess_phi']:.1e}",
            f"{row['pressure']:.1e}",
            value(row, "excess_coordination", 3),
            *(two_digits(row, name) for name in ("shear_modulus", "bulk_modulus")),
            *(value(row, name, 4) for name in ("omega_star", "boson_peak")),
        ]
        for row in VIBRATIONS["summary"]
    ]
    return table_of([*heads, "boson peak"], rows)


def two_digits(row, name):
    """A mean with its standard error, in powers of ten."""
    error = row[f"{name}_error"]
    return f"{row[name]:.2e}" + ("" if error is None else f" ± {error:.0e}")


def per_contact(law):
    """omega* over z - z_iso of each phi - phi_J and size at which omega* is known."""
    return [
        row["omega_star"] / row["excess_coordination"]
        for row in VIBRATIONS["summary"]
        if row["law"] == law and row["omega_star"]
    ]


def slope(law, name, lowest, highest):
    """Exponent of a quantity of 1024 particles over phi - phi_J between two values of it."""
    rows = [row for row in VIBRATIONS["summary"] if (row["law"], row["number"]) == (law, 1024)]
    return exponent(rows, name, lowest, highest)


def sentence():
    """What the text says of the modes."""
    names = ("omega_star", "excess_coordination")
    disks, rings = (
        [f"{slope(law, name, *ends):.2f}" for name in names]
        for law, ends in (("disk", (1e-3, 0.1)), ("radical", (3e-3, 0.03)))
    )
    of_disks, of_rings = (
        f"{min(found):.2f} to {max(found):.2f}" for found in map(per_contact, ("disk", "radical"))
    )
    return (
        f"`omega*` rises with the exponent {disks[0]} and z - z_iso with {disks[1]} for 1024 disks "
        f"from x = 1e-3 to 0.1; {rings[0]} and {rings[1]} for 1024 rings from x = 3e-3 to 0.03. "
        f"The ratio of both is {of_disks} for disks and {of_rings} for rings, at every x and N."
    )


def of_size(law, wanted):
    """Means of 1024 particles at a phi - phi_J."""
    (row,) = (
        row
        for row in VIBRATIONS["summary"]
        if (row["law"], row["number"], row["wanted"]) == (law, 1024, wanted)
    )
    return row


def comparison():
    """What the text says of rings beside disks."""
    levels = {
        law: [row["plateau"] for row in VIBRATIONS["summary"] if row["law"] == law]
        for law in ("radical", "disk")
    }
    high, low = (f"{min(level):.2f} to {max(level):.2f}" for level in levels.values())
    near, far = (
        np.divide(*(row["shear_modulus"] / row["bulk_modulus"] for row in rows))
        for rows in ([of_size(law, x) for law in levels] for x in (1e-3, 1e-2))
    )
    below = {
        (row["law"], row["number"], row["wanted"]): row["boson_peak"] / row["omega_star"]
        for row in VIBRATIONS["summary"]
        if row["omega_star"] and row["boson_peak"]
    }
    inner = [ratio for (*_, x), ratio in below.items() if x <= 0.01]
    outer = [ratio for (*_, x), ratio in below.items() if x > 0.01]
    return (
        f"Rings have such a plateau too, once their stiffness is taken out, at D = {high}; that of "
        f"disks is at {low}. Their G/K is {near:.2f} of that of disks at x = 1e-3, and {far:.2f} "
        f"at 1e-2. The boson peak is at {min(inner):.2f} to {max(inner):.2f} of `omega*` up to "
        f"x = 0.01, and at {min(outer):.2f} to {max(outer):.2f} above."
    )


TABLES = (ensembles_table, onset_table, exponents_table, vibrations_table)


def test_the_page_follows_from_the_files():
    text = PAGE.read_text()
    for table in TABLES:
        assert "\n".join(table()) in text
    for said in (sentence(), comparison()):
        assert said in " ".join(text.split())


def test_summary_of_the_modes_is_that_of_the_packings():
    for written, found in zip(VIBRATIONS["summary"], summarize(VIBRATIONS["rows"]), strict=True):
        for name, number in found.items():
            if isinstance(number, float) and not np.isfinite(number):
                assert written[name] is None, name
            else:
                assert written[name] == number or np.isclose(written[name], number, rtol=1e-9), name


def test_the_plateau_begins_in_proportion_to_the_contacts():
    """omega* ~ z - z_iso (Wyart, Nagel, Witten 2005), over a decade of z - z_iso."""
    for law, packings in (("disk", 4), ("radical", 3)):
        found = per_contact(law)
        assert len(found) >= packings
        assert max(found) < 1.5 * min(found)


def test_all_packings_are_at_rest_and_stable():
    assert all(row["residual"] < 1e-5 and row["unstable"] == 0 for row in VIBRATIONS["rows"])


def write():
    text = PAGE.read_text()
    for table in TABLES:
        lines = table()
        old = re.compile(re.escape(lines[0].split("N = ")[0]) + r".*\n(\|.*\n)*")
        assert old.search(text), lines[0]
        text = old.sub(lambda _, lines=lines: "\n".join(lines) + "\n", text, count=1)
    for said, begin in ((sentence(), r"`omega\*` rises with"), (comparison(), "Rings have such")):
        lines = fill(said, 120, break_long_words=False, break_on_hyphens=False)
        old = re.compile(rf"^{begin}.*?\n\n", re.DOTALL | re.MULTILINE)
        assert old.search(text), begin
        text = old.sub(lambda _, lines=lines: lines + "\n\n", text)
    PAGE.write_text(text)


if __name__ == "__main__":
    write()
