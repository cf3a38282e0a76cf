"""What benchmarks/README.md says of the committed measurements: tables and sentences."""

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent
PAGE = FOLDER / "README.md"


def of(name: str) -> dict:
    return json.loads((FOLDER / "results" / f"{name}.json").read_text())


def select(rows: Iterable[dict], **wanted: object) -> list[dict]:
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def table_of(heads: list[str], rows: Iterable[list[str]]) -> list[str]:
    lines = [f"| {' | '.join(row)} |" for row in (heads, *rows)]
    return [lines[0], "|" + "---|" * len(heads), *lines[1:]]


def count(number: int) -> str:
    return f"{number:,}".replace(",", " ")


def power(value: float) -> str:
    return f"{value:.1e}".replace("e-0", "e-").replace("e+00", "")


def over_fastest(row: dict, rows: list[dict]) -> float:
    """Over the fastest soft ones of that size: their time depends on where their memory is."""
    spheres = row["law"] == "droplet"
    same = (r for r in rows if (r["law"] == "droplet") == spheres and r["n"] == row["n"])
    return row["ns"][1] / min(r["ns"][0] for r in same)


def step() -> list[str]:
    """Times of each law over disks, slow and fast motion; nanoseconds of disks."""
    data = of("in_turns")["rows"]
    sizes = sorted({row["n"] for row in data})

    def both(size: int, law: str) -> list[dict]:
        found = [select(data, n=size, motion=motion, law=law) for motion in ("slow", "fast")]
        return [row for ((row),) in found]

    rows = [
        [
            f"`{law}`",
            *(
                "{:.1f}, {:.1f} times".format(*(over_fastest(row, data) for row in both(n, law)))
                for n in sizes
            ),
        ]
        for law in ("sector", "radical", "balanced", "curved", "droplet")
    ]
    disks = [
        "{:.0f}, {:.0f} ns".format(*(row["ns"][0] for row in both(n, "radical"))) for n in sizes
    ]
    return table_of(
        ["slow, fast motion", *(f"N = {count(size)}" for size in sizes)],
        [["disks, `harmonic/cut`", *disks], *rows],
    )


def plain() -> str:
    ratios = [
        row["ratio_to_disks"]
        for row in select(of("loop_time_plain")["rows"], law="balanced", simd="plain")
    ]
    return (
        f"Without SIMD `balanced` takes {min(ratios):.0f} to {max(ratios):.0f} times as long as "
        "disks."
    )


def threads() -> list[str]:
    """Time on the clock with two threads over that with one."""
    data = of("threads")["rows"]
    sizes = sorted({row["n"] for row in data})
    rows = []
    for law in dict.fromkeys(row["law"] for row in data):
        cells = []
        for n in sizes:
            found = [row["median"][1] for row in select(data, law=law, n=n)]
            cells.append(", ".join(f"{each:.2f}" for each in found))
        rows.append([f"`{law}`", *cells])
    return table_of(["threads; slow, fast motion", *(f"N = {count(size)}" for size in sizes)], rows)


def many() -> list[str]:
    """Nanoseconds of a core for each particle and step, or force call of a relaxation."""
    data = of("large")["rows"]
    sizes = sorted({row["n"] for row in data})
    rows = []
    for name, what in (("ns_motion", "motion"), ("ns_minimization", "relaxation")):
        for law in ("disk", "radical", "balanced"):
            for ranks in (1, 2):
                found = [select(data, law=law, ranks=ranks, n=size)[0].get(name) for size in sizes]
                if law != "radical" and all(found):
                    rows.append([f"{what}, {law}", str(ranks), *(f"{ns:.0f}" for ns in found)])
    return table_of(["ns", "ranks", *(f"N = {count(size)}" for size in sizes)], rows)


def of_a_step() -> str:
    """What README says of the default law and the exact one."""
    rows = of("in_turns")["rows"]
    told = []
    for law in ("balanced", "curved"):
        ratios = [over_fastest(row, rows) for row in select(rows, law=law)]
        told.append(f"{min(ratios):.0f} to {max(ratios):.0f}")
    return (
        f"A time step takes {told[0]} times as long as one of soft disks in LAMMPS with the "
        f"default law, {told[1]} times with the exact one."
    )


def memory() -> str:
    """By the growth of the process from the smallest to the largest packing."""
    rows = of("in_turns")["rows"]
    sizes = [row["n"] for row in rows]

    def each(law: str, version: int = 1) -> float:
        few, many = (
            select(rows, n=size(sizes), motion="slow", law=law)[0]["bytes"][version]
            for size in (min, max)
        )
        return (many - few) / (max(sizes) - min(sizes)) / 1e3

    return (
        f"Memory a particle, of the whole process: {each('balanced', 0):.1f} kB with disks, "
        f"{each('balanced'):.1f} kB with `balanced`, {each('curved'):.1f} kB with `curved`."
    )


def friction() -> list[str]:
    data = of("friction_cost")["rows"]
    rows = []
    for style in ("granular", "gran/hooke/history", "radical", "balanced", "curved"):
        cells = []
        for name in (style, f"{style}, friction"):
            found = [
                row["over_granular"]
                for motion in ("slow", "fast")
                for row in select(data, style=name, motion=motion)
            ]
            cells.append("{:.2f}, {:.2f}".format(*found) if found else "")
        rows.append([f"`{style}`", *cells])
    return table_of(["slow, fast motion", "without the fix", "with friction"], rows)


def films() -> str:
    rows = of("curved")["films"]
    intact, torn = (
        [row["ratio"] for row in rows if row["phi"] == phi and row["w"] > 0] for phi in (0.9, 0.84)
    )
    return (
        f"Films cost {min(intact):.1f} to {max(intact):.1f} times a step of `curved` without "
        f"adhesion in a packing that holds, and {min(torn):.1f} to {max(torn):.1f} times in one "
        "that tears."
    )


def energies() -> list[str]:
    """Errors of the energy over the kinetic energy, drifts, and orders."""
    rows = []
    for row in of("nve")["rows"]:
        told = f"order {row['order']:.2f} in the time step"
        rows.append(
            [
                f"`radical`, phi = {row['phi']:.2f}, step 0.025",
                power(row["energy_error"][-1] / row["kinetic_energy"]),
                told,
            ]
        )
    data = of("conservation")["rows"]
    for row in (row for row in data if row["steps"] == 1_000_000 and row["temperature"] != 1e-7):
        drift = f"drift {power(row['drift'])} ± {power(row['drift_uncertainty'])}"
        label = (
            f"`balanced`, phi = {row['phi']:.2f}, temperature {row['temperature']:.0e}, 1e6 steps"
        )
        rows.append([label.replace("e-0", "e-"), power(row["error"]), drift])
    return table_of(["constant energy", "error over the kinetic energy", ""], rows)


def energies_in_space() -> list[str]:
    """Order of the error, error and drift of droplets at constant energy."""
    data, rows = of("droplet_energy"), []
    for order in data["order"]:
        for row in (row for row in data["drift"] if round(row["phi"], 9) == order["phi"]):
            rows.append(
                [
                    f"{row['phi']:.2f}",
                    f"{row['temperature']:.0e}".replace("e-0", "e-"),
                    f"{order['order']:.2f}",
                    power(row["error"]),
                    f"{power(row['drift'])} ± {power(row['drift_uncertainty'])}",
                ]
            )
    return table_of(["phi", "temperature", "order", "error", "drift"], rows)


def rubbing() -> str:
    worst = [max(row["error_over_lost"] for row in of("friction_energy")["rows"] if row["dt"] == dt)
             for dt in (0.08, 0.04, 0.02)]  # fmt: skip
    return (
        "With friction and damping the balance of all energies is right to "
        f"{power(worst[0])}, {power(worst[1])} and {power(worst[2])} of what is lost, at steps of "
        "0.08, 0.04 and 0.02."
    )


def ranks() -> list[str]:
    """Of two ranks: messages, their bytes and sums over all ranks; time over one rank."""
    data = select(of("ranks")["rows"], ranks=2)
    rows = []
    for law in dict.fromkeys(row["law"] for row in data):
        cells = [
            f"{row['messages']:.0f}, {row['bytes'] / 1e3:.0f} kB, {row['sums']:.1f}; "
            f"{row['over_one']:.2f}"
            for motion in ("slow", "fast")
            for row in select(data, law=law, motion=motion)
        ]
        rows.append([f"`{law}`", *cells])
    return table_of(["two ranks", "slow", "fast"], rows)


def at_rest() -> list[str]:
    """FIRE over L-BFGS: force calls, and processor time."""
    data = select(of("at_rest")["summary"], minimizer="lbfgs", step=0.001)
    rows = []
    for law in ("radical", "balanced", "curved", "droplet"):
        cells = []
        for above in (0.001, 0.05):
            for strain in ("compression", "shear"):
                (row,) = select(data, law=law, N=64, above=above, strain=strain)
                cells.append(f"{row['calls']:.1f}, {row['seconds']:.1f}")
        rows.append([f"`{law}`", *cells])
    heads = ["0.1 % compression", "0.1 % shear"]
    return table_of(
        ["N = 64", *(f"{what}, {at}" for at in ("0.1 %", "5 %") for what in heads)], rows
    )


def springs() -> str:
    data = select(of("at_rest")["summary"], minimizer="lbfgs")
    data = [row for row in data if row["law"] != "disks"]
    same, all_steps = (sum(row[name] for row in data) for name in ("same", "of"))
    return f"{same} of {all_steps} steps end in the minimum of FIRE."


def relaxations() -> str:
    data = of("relaxation")
    laws = [data[law] for law in ("radical", "balanced", "curved", "droplets")]
    (states,) = {law["states"] for law in laws}
    assert all(law["fell_back"] == law["stalled"] == 0 for law in laws)
    assert all(law["largest_residual"] < 1e-8 for law in laws)
    times = [data["time_over_radical"][law]["median"] for law in ("balanced", "curved")]
    return (
        f"L-BFGS brings {states} states with each law below 1e-8 of the "
        f"mean contact force. A packing takes {times[0]:.2f} times the processor time of "
        f"`radical` with `balanced`, and {times[1]:.2f} times with `curved`, in the median."
    )


def statistics() -> str:
    data = of("at_rest_statistics")
    off = max(abs(row["difference over error"]) for row in data["rows"])
    return (
        f"{data['packings']} packings from each have the same phi_J, z, energy, pressure and shear "
        f"modulus, to {off:.2f} standard errors."
    )


def large_packings() -> list[str]:
    rows = [
        [
            count(row["N"]),
            *(
                f"{row[part]['seconds']:.3g} s, {row[part]['iterations']}"
                for part in ("quench", "1 steps", "10 steps")
            ),
            f"{row['megabytes']:.0f} MB",
        ]
        for row in of("large_packings")["rows"]
    ]
    return table_of(["N", "quench", "1 % in one step", "in ten", "memory"], rows)


def jamming() -> list[str]:
    rows = [
        [
            count(row["N"]),
            f"{row['seconds']:.1f}",
            f"{row['phi']:.4f}",
            ", ".join(map(str, row["excess_contacts"])),
            f"{100 * row['rattlers']:.1f} %",
        ]
        for row in of("jamming")["sizes"]
    ]
    return table_of(["N", "seconds", "phi_J", "contacts beyond isostatic", "rattlers"], rows)


def reaches() -> list[str]:
    data = of("reach")
    rows = []
    for row in data["rows"]:
        rows.append([f"`{row['law']}`, fast motion", *(f"{ratio:.2f}" for ratio in row["fast"])])
        rows.append([f"`{row['law']}`, starts", *map(str, row["starts"])])
    return table_of(["reach", *map(str, data["reaches"])], rows)


def polygons() -> str:
    ratios = [row["ratio_to_beads"] for row in of("edges")["rows"] if row["style"] == "edges"]
    return (
        f"A step of smooth polygons takes {min(ratios):.2f} to {max(ratios):.2f} times that "
        "of rings of beads, a vertex."
    )


def smooth() -> str:
    data = of("smooth_minimizers")["rows"]
    fire = [row["residual"] for row in select(data, method="FIRE")]
    newton = select(data, method="Newton, soft contacts first")
    assert max(row["residual"] for row in newton) < 1e-6
    seconds = [row["seconds"] for row in newton]
    return (
        f"FIRE leaves residuals of {power(min(fire))} to {power(max(fire))} after 20 s. Newton's "
        "method with soft contacts first, which `Simulation.relax` takes, comes below 1e-6 in "
        f"{min(seconds):.1f} to {max(seconds):.1f} s."
    )


def minimizers() -> str:
    rows = of("minimizers")["rows"]
    cases = {(row["material"], row["law"]) for row in rows}
    styles = {row["style"] for row in rows}
    for material, law in cases:
        energy = [
            row["energy"]
            for row in select(rows, material=material, law=law)
            if not row["box/relax"]
        ]
        assert np.ptp(energy) < 1e-9 * max(energy)
    return (
        f"The {len(styles)} minimizers of LAMMPS reach the same energy of {len(cases)} packings of "
        "twelve particles, to 1e-9."
    )


TABLES = (
    step,
    threads,
    many,
    friction,
    ranks,
    energies,
    energies_in_space,
    at_rest,
    large_packings,
    jamming,
    reaches,
)
SENTENCES = (
    *(plain, memory, films, rubbing, springs, relaxations, statistics),
    *(polygons, smooth, minimizers),
)
PAGES = {PAGE: (TABLES, SENTENCES), FOLDER.parent / "README.md": ((), (of_a_step,))}
