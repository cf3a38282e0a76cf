"""What docs/jamming.md says of the committed packings: tables and sentences."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from validation.documented import table_of
from validation.jamming.__main__ import read_table
from validation.jamming.vibrations import exponent

ROOT = Path(__file__).parents[2]
PAGE, FOLDER = ROOT / "docs" / "jamming.md", ROOT / "validation" / "jamming"
SUMMARY = json.loads((FOLDER / "summary.json").read_text())
ONSETS = read_table(FOLDER / "table.csv")
VIBRATIONS = json.loads((FOLDER / "vibrations.json").read_text())


def value(row: Any, name: str, digits: int) -> str:
    """A mean with its standard error, if it has one."""
    found, error = row[name], row[f"{name}_error"]
    if found is None:
        return ""
    return f"{found:.{digits}f}" + ("" if error is None else f" ± {error:.{digits}f}")


# Laws and thresholds with the sizes that the page shows.
SIZES = {
    ("disk", 1e-7): (64, 1024, 4096),
    ("radical", 1e-16): (64, 512),
    ("radical", 1e-7): (128, 512),
    ("balanced", 1e-7): (128,),
}


def onset_table() -> list[str]:
    """Onsets of each law and threshold."""
    found = {(row["law"], row["onset_pressure"], row["number"]): row for row in SUMMARY["onset"]}
    rows = []
    for (law, pressure), numbers in SIZES.items():
        for number in numbers:
            row = found[law, pressure, number]
            means = (value(row, "phi", 4), value(row, "excess_contacts", 2))
            threshold = f"{pressure:.0e}".replace("e-0", "e-")
            rows.append([law, threshold, f"{number}", f"{row['packings']}", *means])
    return table_of(["", "threshold", "N", "packings", "phi_J", "contacts - (2 N' - 1)"], rows)


def exponents_table() -> list[str]:
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


def packings() -> list[dict[str, Any]]:
    """Rows of onsets that have exponents."""
    keys = ("law", "onset_pressure", "number")
    wanted = [tuple(row[key] for key in keys) for row in SUMMARY["exponents"]]
    found = {tuple(row[key] for key in keys): row for row in SUMMARY["onset"]}
    return [found[key] for key in wanted]


def per_contact(law: str) -> list[float]:
    """omega* over z - z_iso of each phi - phi_J and size at which omega* is known."""
    return [
        row["omega_star"] / row["excess_coordination"]
        for row in VIBRATIONS["summary"]
        if row["law"] == law and row["omega_star"]
    ]


def slope(law: str, name: str, lowest: float, highest: float) -> float:
    """Exponent of a quantity of 1024 particles over phi - phi_J between two values of it."""
    rows = [row for row in VIBRATIONS["summary"] if (row["law"], row["number"]) == (law, 1024)]
    return exponent(rows, name, lowest, highest)


def modes() -> str:
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
        f"from x = 1e-3 to 0.1, and with {rings[0]} and {rings[1]} for 1024 rings from x = 3e-3 to "
        f"0.03. Their ratio is {of_disks} for disks and {of_rings} for rings."
    )


def of_size(law: str, wanted: float) -> dict[str, Any]:
    """Means of 1024 particles at a phi - phi_J."""
    (row,) = (
        row
        for row in VIBRATIONS["summary"]
        if (row["law"], row["number"], row["wanted"]) == (law, 1024, wanted)
    )
    return row


def rings() -> str:
    """What the text says of rings beside disks."""
    near, far = (
        np.divide(*(row["shear_modulus"] / row["bulk_modulus"] for row in rows))
        for rows in ([of_size(law, x) for law in ("radical", "disk")] for x in (1e-3, 1e-2))
    )
    return f"G/K of rings is {near:.2f} of that of disks at x = 1e-3, and {far:.2f} at 1e-2."


def units() -> str:
    """Pressure of disks over x, and which x the usual threshold means."""
    row = of_size("disk", 1e-2)
    factor = row["pressure"] / row["excess_phi"]
    return (
        f"p is about {factor:.1f} x for disks, with x = phi - phi_J. At the threshold 1e-7 disks "
        f"have p = 1.4e-7 and x = {1.4e-7 / factor:.0e}."
    ).replace("e-0", "e-")


def isostatic() -> str:
    """Packings where overlaps vanish, up to N = 512; further above the onset N matters."""
    near = [
        row["contacts"] - row["isostatic"]
        for row in ONSETS
        if (row["law"] == "disk" or row["onset_pressure"] == 1e-16) and row["number"] <= 512
    ]
    return (
        f"Of {len(near)} packings of disks at 1e-7 and of `radical` at 1e-16 with up to 512 "
        f"particles {sum(more == 0 for more in near)} are isostatic, and {max(near)} is the most "
        "that others have in addition."
    )


TABLES = (onset_table, exponents_table)
SENTENCES = (units, isostatic, modes, rings)
PAGES = {PAGE: (TABLES, SENTENCES)}
