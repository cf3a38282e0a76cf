"""Tables of README.md and docs/stability.md have the numbers of docs/report/report.json.

Run as a script, this prints the tables of the report.
"""

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
REPORT = json.loads((ROOT / "docs" / "report" / "report.json").read_text())
LAWS = ("disk", "sector", "radical, kP inf", "radical", "balanced")
ACCURACY = {
    "I": "mean distance of outline and beads, over R",
    "S_rms": "relative rms error of the area deficits",
    "energy_ratio": "energy over that of the beads",
}


def short(value):
    """Two digits, or two decimals of numbers of order one."""
    if value >= 0.095:
        return f"{value:.2f}"
    return f"{value:.1e}".replace("e-0", "e-")


def span(values):
    """The range of some values; empty where a law has none."""
    found = [value for value in values if value is not None]
    if not found:
        return ""
    if set(found) == {1.0}:
        return "1"
    low, high = short(min(found)), short(max(found))
    return low if low == high else f"{low} to {high}"


def table_of(heads, rows):
    """Lines of a table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return ["|" + "|".join(f" {cell} " if cell else " " for cell in line) + "|" for line in lines]


def accuracy_table():
    """16 rings of 150 beads and more, all seeds."""
    rows = []
    for name, title in ACCURACY.items():
        for strain in (0.01, 0.02):
            found = {law: [] for law in LAWS}
            for row in REPORT["packing"]:
                if (row["n"], row["beads"], row["strain"]) == (16, 150, strain):
                    found[row["law"]].append(row[name])
            first = title if strain == 0.01 else ""
            rows.append([first, f"{100 * strain:g} %", *(span(found[law]) for law in LAWS)])
    return table_of(["", "strain", *LAWS], rows)


def cost_table():
    """Processor time of a strain step of 1 % with 128 particles."""
    rows = {row["law"]: row for row in REPORT["packing"] if row["n"] == 128}
    laws = ("disk", "radical, kP inf", "balanced")
    seconds = [rows["disk"]["seconds_beads"], *(rows[law]["seconds"] for law in laws)]
    return table_of(["beads", *laws], [[f"{float(f'{s:.2g}'):g} s" for s in seconds]])


def stability_table():
    """Bold values exceed their limit."""
    laws = ("radical", "balanced", "sector")
    found = {}
    for row in REPORT["stability"]:
        found.setdefault((row["case"], row["quantity"]), {})[row["law"]] = row
    rows = []
    for case, by_law in found.items():
        limits = dict.fromkeys(f"{row['limit']:.2g}" for row in by_law.values())
        rows.append([*case, ", ".join(limits), *(measured(by_law.get(law)) for law in laws)])
    return table_of(["case", "quantity", "limit", *laws], rows)


def measured(row):
    """The value of a row of `stability`."""
    if row is None:
        return ""
    value = "none" if row["value"] is None else f"{row['value']:.3g}"
    return value if row["ok"] else f"**{value}**"


@pytest.mark.parametrize(
    ("page", "table"),
    [
        ("README.md", accuracy_table),
        ("README.md", cost_table),
        ("docs/stability.md", stability_table),
    ],
)
def test_tables_are_those_of_the_report(page, table):
    text = (ROOT / page).read_text()
    for line in table():
        assert line in text


if __name__ == "__main__":
    for lines in (accuracy_table(), cost_table(), stability_table()):
        print(*lines, "", sep="\n")
