"""Numbers of report.json in README.md and in docs: tables and sentences."""

import json
import statistics
from pathlib import Path
from typing import Any

from validation.documented import table_of
from validation.report.accuracy import (
    energy_errors,
    fastest_as_good,
    label,
    summary,
    whole_percents,
)
from validation.report.section import percent

ROOT = Path(__file__).parents[2]
SEEDS = json.loads((ROOT / "validation" / "report" / "seeds.json").read_text())
REPORT = json.loads((ROOT / "validation" / "report" / "report.json").read_text())


def part(value: float | None) -> str:
    """A relative error in per cent, two digits; empty where there is none."""
    return "" if value is None else f"{float(f'{100 * value:.2g}'):g} %"


def seconds(value: float | None) -> str:
    return "" if value is None else f"{float(f'{value:.2g}'):g} s"


SHOWN = (
    *("sector", "radical", "radical, kP inf", "balanced", "curved"),
    *(f"smooth polygons, {number}" for number in (38, 76, 114)),
    *(f"bead polygons, {number}" for number in (38, 76)),
)


def accuracy_table() -> list[str]:
    """Errors of the energy by strain, of the area deficits, and times; see `summary`."""
    methods = [row for row in summary(REPORT["smooth"], REPORT["pareto"]) if row["name"] in SHOWN]
    assert len(methods) == len(SHOWN)
    strains = [percent(strain) for strain in whole_percents(REPORT["smooth"])]
    at = percent(REPORT["pareto"][0]["strain"])
    rows = [
        [
            row["name"],
            *(energy_error(row.get(strain)) for strain in strains),
            part(row["error"]),
            seconds(row["seconds"]),
        ]
        for row in methods
    ]
    heads = ["error of the energy at", *strains, f"of the areas at {at}", f"time to {at}"]
    return table_of(heads, rows)


def errors(law: str, first: float, last: float) -> list[float]:
    """Errors of the energy of each packing in a range of strains."""
    found = energy_errors(REPORT["smooth"], law)
    return [
        each for strain, of in found.items() if first <= round(strain, 4) <= last for each in of
    ]


def of_balanced() -> str:
    small, large = (100.0 * max(errors("balanced", 0.01, end)) for end in (0.03, 0.05))
    return (
        f"`balanced` is right to {small:.1f} % in energy from 1 to 3 % strain in each packing, and "
        f"to {large:.1f} % up to 5 %."
    )


def of_curved() -> str:
    first, rest = (100.0 * max(errors("curved", *ends)) for ends in ((0.01, 0.01), (0.02, 0.05)))
    return (
        f"`curved` and the polygons agree to {first:.2f} % at 1 % strain, and to {rest:.3f} % from "
        "2 to 5 %, in each packing: closer than the polygons are known."
    )


def of_radical() -> str:
    found = errors("radical", 0.01, 0.05)
    return f"In single packings it is off by {100 * min(found):.0f} to {100 * max(found):.0f} %."


SAID = {
    "radical": (
        '`Ring(contact="radical")`',
        "for comparison: contact lines of [Maharana](docs/citing.md)",
    ),
    "balanced": (
        "`Ring()`",
        "the default: straight lines, placed so that both particles press equally",
    ),
    "curved": (
        '`Ring(contact="curved")`',
        "exact shapes in 2D without friction: foam, mixtures, adhesion",
    ),
}


def energy_error(value: Any) -> str:
    """In per cent, and not below that of the reference."""
    (known,) = (row["limit_error"] for row in REPORT["pareto"] if row["method"] == "reference")
    return f"below {part(known)}" if value is not None and value < known else part(value)


def short_table() -> list[str]:
    """Errors as in `accuracy_table` and times, of the polygons that are as right too.

    No error is told below that of the reference.
    """
    rows, at = REPORT["pareto"], percent(REPORT["pareto"][0]["strain"])
    medians = {row["name"]: row.get(at) for row in summary(REPORT["smooth"], rows)}
    cells = [
        [*SAID[row["method"]], energy_error(medians[row["method"]]), seconds(row["seconds"])]
        for row in rows
        if row["method"] in SAID
    ]
    polygons = fastest_as_good(rows)["smooth"]
    told = energy_error(polygons["energy_error"]), seconds(polygons["seconds"])
    number = polygons["vertices"]
    cells.append(
        [label(polygons), f"for comparison: our deformable polygons, {number} vertices", *told]
    )
    return table_of(["law", "for", f"error of the energy of deformation at {at}", "time"], cells)


def packing_table() -> list[str]:
    """Laws at the centers of bead polygons in a large packing, over the beads."""
    rows = [
        [
            f"`{row['law']}`",
            f"{row['I']:.1e}".replace("e-0", "e-"),
            *(f"{row[name]:.2f}" for name in ("S_rms", "energy_ratio", "pressure_ratio")),
        ]
        for row in REPORT["packing"]
        if row["law"] != "disk"
    ]
    return table_of(["law", "I", "S_rms", "energy", "pressure"], rows)


def mixtures(law: str) -> list[dict[str, Any]]:
    return [row for row in REPORT["stiffness_packing"] if row["law"] == law]


def mixture_table() -> list[str]:
    """Areas and energies of two laws at the centers of smooth polygons, seed 1 of each mixture."""
    heads = ["small kA, kP", "large kA, kP", "`radical` S_rms", "energy"]
    rows = []
    for radical, balanced in zip(mixtures("radical"), mixtures("balanced"), strict=True):
        of_both = (radical, balanced)
        assert len({(str(row["kA"]), str(row["kP"]), row["seed"]) for row in of_both}) == 1
        if balanced["seed"] != 1:
            continue
        species = [
            ", ".join(f"{each[n]:.2g}" for each in (balanced["kA"], balanced["kP"])) for n in (0, 1)
        ]
        cells = [f(row) for row in of_both for f in (spread, energy)]
        rows.append([*species, *cells])
    return table_of([*heads, "`balanced` S_rms", "energy"], rows)


def spread(row: dict[str, Any]) -> str:
    return f"{row['S_rms']:.2g}"


def energy(row: dict[str, Any]) -> str:
    return f"{row['energy_ratio']:.2f}"


def exact_in_mixtures() -> str:
    """Errors of the laws with balanced forces, at the centers of the polygons and alone."""
    told = []
    for law in ("balanced", "curved"):
        areas = max(row["S_rms"] for row in mixtures(law))
        energies = max(abs(row["energy_ratio"] - 1.0) for row in mixtures(law))
        told += [f"{100.0 * areas:.1f} %", f"{100.0 * energies:.1f} %"]
    alone = max(
        abs(row["own_energy_ratio"] / row["energy_ratio"] - 1.0) for row in mixtures("balanced")
    )
    return (
        f"`balanced` has areas to {told[0]} and energies to {told[1]}, and the same energies to "
        f"{100.0 * alone:.1f} % if it relaxes on its own. `curved` has areas to {told[2]} and "
        f"energies to {told[3]}."
    )


def largest(name: str, **wanted: Any) -> str:
    """Of a shape error, over all indentations."""
    found = [
        row[name]
        for row in REPORT["single"]
        if all(row[key] == value for key, value in wanted.items())
    ]
    return f"{max(found):.1e}".replace("e-0", "e-")


def single_rings() -> str:
    """Shape errors in regular and asymmetric polygons."""
    irregular = [{"polygon": "irregular", "n_v": 188, "sides": sides} for sides in (3, 4)]
    stick, slip = (
        [
            " and ".join(largest(name, walls=walls, **polygon) for polygon in irregular)
            for name in ("I_sector", "I_ring_kP_inf")
        ]
        for walls in ("stick", "slip")
    )
    return (
        "In regular polygons both laws have the same I, at most "
        f"{largest('I_sector', polygon='regular', n_v=188)}. In the asymmetric triangle and "
        f"quadrangle each is right where its contacts are those of the walls. If walls stick, I of "
        f"`sector` is at most {stick[0]}, and that of the ring law {stick[1]}. If they slip, I of "
        f"`sector` is at most {slip[0]}, and that of the ring law {slip[1]}."
    )


def springs() -> str:
    """Shape errors in a hexagon by the stiffness of the springs."""
    at = {
        (kL, name): largest(name, n_v=314, kL=kL, a_over_R=0.05)
        for kL in (1.0, 1e3, 1e5)
        for name in ("I_sector", "I_ring")
    }
    return (
        f"At a = 0.05 I of `sector` falls from {at[1.0, 'I_sector']} at kL = 1 to "
        f"{at[1e3, 'I_sector']} at 1e3 and {at[1e5, 'I_sector']} at 1e5, as in the paper. The "
        f"ring law takes the stiffness of the springs: its I is {at[1.0, 'I_ring']} at kL = 1 and "
        f"{at[1e3, 'I_ring']} at 1e3."
    )


def exact_limit() -> str:
    """How near the area deficits of beads come to that of a smooth ring."""
    off = max(abs(row["error_n_v"][-1]) for row in REPORT["limit"])
    return f"384 beads of infinite stiffness have S to {100.0 * off:.2f} %."


def speed() -> str:
    (row,) = (row for row in REPORT["packing"] if row["law"] == "radical, kP inf")
    seconds = float(f"{row['seconds_polygons']:.2g}")
    return (
        f"The compression takes {seconds:g} s of processor time with bead polygons, and "
        f"{row['seconds']:.2g} s with `radical, kP inf`."
    )


def worst(case: str, quantity: str) -> float:
    """Largest value of the ring laws in the rows of a case, which are within their limits."""
    rows = [
        row
        for row in REPORT["stability"]
        if row["case"].startswith(case) and quantity in row["quantity"] and row["law"] != "sector"
    ]
    assert all(row["ok"] for row in rows)
    return max(row["value"] for row in rows)


def power(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-")


def drift() -> str:
    return (
        "Energy errors of motion are of second order in the time step, to "
        f"{worst('time step', 'order'):.2f} of the order. In a million steps energies drift by at "
        f"most {power(worst('1e+06 steps', 'drift'))} of the kinetic energy."
    )


def sizes() -> str:
    return (
        "Packings with sizes up to 1 : 10 relax until the largest force is "
        f"{power(worst('sizes', 'residual'))} of the mean contact force."
    )


def sector_fails() -> str:
    (row,) = (
        row
        for row in REPORT["stability"]
        if row["law"] == "sector" and row["case"].startswith("100 packings")
    )
    return (
        f"`sector` fails: of 100 packings at 1 % strain {100 - row['value']:.0f} relax, while all "
        "do with the ring laws."
    )


def speed_up() -> str:
    """The smooth polygons that are as right as the law balanced, and how much longer they take."""
    (balanced,) = (row for row in REPORT["pareto"] if row["method"] == "balanced")
    polygons = fastest_as_good(REPORT["pareto"])["smooth"]
    longer = float(f"{polygons['seconds'] / balanced['seconds']:.2g}")
    return f"{polygons['vertices']} vertices and take {longer:.0f} times as long"


def speed_in_readme() -> str:
    """The same, in full."""
    number, times = speed_up().split(" vertices and take ")
    return (
        f"Our own deformable polygons need {number} vertices to be as accurate as the default law, "
        f"and take {times}."
    )


def limit_in_readme() -> str:
    (reference,) = (row for row in REPORT["pareto"] if row["method"] == "reference")
    return (
        "The reference is deformable polygons, extrapolated to very many vertices; its energy is "
        "uncertain by "
        f"{part(reference['limit_error'])}."
    )


def uncertainty() -> str:
    """What is known of the error of the reference itself."""
    (reference,) = (row for row in REPORT["pareto"] if row["method"] == "reference")
    return f"The uncertainty of this limit is {part(reference['limit_error'])}."


def in_twenty_packings() -> str:
    """Medians of the errors of the energy of all seeds."""

    def middle(method: str, vertices: int | None) -> str:
        found = [
            row["energy_error"]
            for rows in SEEDS.values()
            for row in rows
            if (row["method"], row["vertices"]) == (method, vertices)
        ]
        return f"{100.0 * statistics.median(found):.2g}"

    laws = [middle(law, None) for law in ("curved", "balanced")]
    polygons = [middle(*kind) for kind in (("smooth", 38), ("smooth", 76), ("reference", 152))]
    return (
        f"In {len(SEEDS)} packings of 16 particles the median error of the energy is {laws[0]} % "
        f"of `curved`, {laws[1]} % of `balanced`, and {polygons[0]}, {polygons[1]} and "
        f"{polygons[2]} % of polygons of 38, 76 and 152 vertices"
    )


PAGES = {
    ROOT / "README.md": ((short_table,), (speed_in_readme, limit_in_readme)),
    ROOT / "docs/accuracy.md": (
        (accuracy_table,),
        (speed_up, uncertainty, of_balanced, of_curved, of_radical),
    ),
    ROOT / "docs/guide/polygons.md": ((), (in_twenty_packings,)),
    ROOT / "docs/paper.md": (
        (packing_table, mixture_table),
        (single_rings, springs, exact_limit, speed, exact_in_mixtures),
    ),
    ROOT / "docs/stability.md": (
        (),
        (drift, sizes, sector_fails),
    ),
}
