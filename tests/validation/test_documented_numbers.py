"""Tables of README.md and of docs have the numbers of validation/report/report.json.

Run as a script, this writes the numbers of the report into the pages.
"""

import json
import re
from pathlib import Path

from committed_page import check

from validation.report.accuracy import (
    CONVERGED,
    fastest_as_good,
    label,
    summary,
    whole_percents,
)
from validation.report.section import percent

ROOT = Path(__file__).parents[2]
REPORT = json.loads((ROOT / "validation" / "report" / "report.json").read_text())


def part(value):
    """A relative error in per cent, two digits; empty where there is none."""
    return "" if value is None else f"{float(f'{100 * value:.2g}'):g} %"


def seconds(value):
    return "" if value is None else f"{float(f'{value:.2g}'):g} s"


def table_of(heads, rows):
    """Lines of a table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return ["|" + "|".join(f" {cell} " if cell else " " for cell in line) + "|" for line in lines]


def accuracy_table():
    """Errors of the energy by strain, of the area deficits, and times; see `summary`."""
    methods = summary(REPORT["smooth"], REPORT["pareto"])
    strains = [percent(strain) for strain in whole_percents(REPORT["smooth"])]
    at = percent(REPORT["pareto"][0]["strain"])
    rows = [
        [
            row["name"],
            *(part(row.get(strain)) for strain in strains),
            part(row["error"]),
            seconds(row["seconds"]),
        ]
        for row in methods
    ]
    heads = ["error of the energy at", *strains, f"of the areas at {at}", f"time to {at}"]
    return table_of(heads, rows)


SAID = {
    "radical": ("`radical`", "comparison: the paper's lines"),
    "balanced": ("`balanced`", "default: lines where forces agree"),
    "curved": ("`curved`", "exact if contacts slip; foam, mixtures, adhesion"),
}


def short_table():
    """Errors and time at the strain of the picture, of the polygons that are as right too.

    No error is told below that of the reference.
    """
    rows, at = REPORT["pareto"], percent(REPORT["pareto"][0]["strain"])
    (known,) = (row["limit_error"] for row in rows if row["method"] == "reference")

    def error(row):
        value = row["energy_error"]
        return f"below {part(known)}" if value is not None and value < known else part(value) or "–"

    cells = [
        [*SAID[row["method"]], error(row), seconds(row["seconds"])]
        for row in rows
        if row["method"] in SAID
    ]
    polygons = fastest_as_good(rows)["smooth"]
    cells.append(
        [label(polygons), "reference model", error(polygons), seconds(polygons["seconds"])]
    )
    return table_of(["law", "for", f"error of the energy at {at}", "time"], cells)


def mixture_table():
    """S_rms, energy at the rings' centers and alone, over that of the rings, of each mixture."""
    rows = []
    for row in REPORT["stiffness_packing"]:
        if row["law"] != "balanced":
            continue
        same = {key: row[key] for key in ("kA", "kP", "strain", "seed")}
        (radical,) = (
            other
            for other in REPORT["stiffness_packing"]
            if other["law"] == "radical" and same.items() <= other.items()
        )
        species = [", ".join(f"{each[n]:.2g}" for each in (row["kA"], row["kP"])) for n in (0, 1)]
        rows.append([*species, f"{row['seed']}", mixed(radical), mixed(row), f"{row['I']:.1e}"])
    return table_of(["small kA, kP", "large kA, kP", "seed", "`radical`", "`balanced`", "I"], rows)


def mixed(row):
    own = row["own_energy_ratio"]
    alone = "none" if own is None else f"{own:.2f}"
    return f"{row['S_rms']:.2g}, {row['energy_ratio']:.2f}, {alone}"


def compression_table():
    """Energy of balanced over that of smooth polygons of 160 vertices that have converged."""
    own = [
        row
        for row in REPORT["smooth"]
        if (row["law"], row["n_v"], row["own"]) == ("balanced", 160, True)
    ]
    strains = list(dict.fromkeys(row["strain"] for row in own))
    rows = []
    for seed in dict.fromkeys(row["seed"] for row in own):
        ratios = {
            row["strain"]: f"{row['energy_ratio']:.3f}" if row["residual"] <= CONVERGED else "–"
            for row in own
            if row["seed"] == seed
        }
        rows.append([f"seed {seed}", *(ratios[strain] for strain in strains)])
    return table_of(["strain", *map(percent, strains)], rows)


def stability_table():
    """Bold values exceed their limit."""
    laws = ("radical", "balanced", "curved", "sector")
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


PAGES = {
    "README.md": short_table,
    "docs/accuracy.md": accuracy_table,
    "docs/paper.md": mixture_table,
    "docs/theory.md": compression_table,
    "docs/stability.md": stability_table,
}


def speed_up():
    """The smooth polygons that are as right as the law balanced, and how much longer they take."""
    (balanced,) = (row for row in REPORT["pareto"] if row["method"] == "balanced")
    polygons = fastest_as_good(REPORT["pareto"])["smooth"]
    longer = float(f"{polygons['seconds'] / balanced['seconds']:.2g}")
    return f"{polygons['vertices']} vertices and take {longer:.0f} times as long"


def uncertainty():
    """What is known of the error of the reference itself."""
    (reference,) = (row for row in REPORT["pareto"] if row["method"] == "reference")
    return f"taken from coarser polygons, that limit changes by {part(reference['limit_error'])}"


SENTENCES = {
    "README.md": {speed_up: r"\d+ vertices and take \d+ times as long"},
    "docs/accuracy.md": {
        speed_up: r"\d+ vertices and take \d+ times as long",
        uncertainty: r"taken from coarser polygons, that limit changes by [\d.]+ %",
    },
}


def test_pages_follow_from_the_report():
    for page, table in PAGES.items():
        check(ROOT / page, [table()], SENTENCES.get(page, ()))


def known():
    """To what the energy of the reference is known."""
    (reference,) = (row for row in REPORT["pareto"] if row["method"] == "reference")
    return f"whose energy is known to {part(reference['limit_error'])}"


SENTENCES["README.md"][known] = r"whose energy is known to [\d.]+ %"


def test_readme_is_read_in_a_minute():
    """At most 550 words, code included."""
    assert len((ROOT / "README.md").read_text().split()) <= 550


def write(page, lines):
    """Replace the table with the same first line, and the sentences."""
    text = (ROOT / page).read_text()
    old = re.compile(re.escape(lines[0]) + r"\n(\|.*\n)*")
    text = old.sub(lambda _: "\n".join(lines) + "\n", text)
    for sentence, pattern in SENTENCES.get(page, {}).items():
        text = re.sub(pattern.replace(" ", r"\s+"), lambda _, s=sentence: s(), text)
    (ROOT / page).write_text(text)


if __name__ == "__main__":
    for page, table in PAGES.items():
        write(page, table())
