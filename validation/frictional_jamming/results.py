"""Table and picture of jamming with friction, from the numbers of all packings."""

from pathlib import Path

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

# numbers of a packing, with their digits; and powers of p in which some are extrapolated
MEANS = {"phi": 4, "z": 3, "rattlers": 1, "mobilized": 3, "mobilization": 3}
POWERS = {"phi": 1.0, "z": 0.5}


def table(found):
    """Means and errors of each coefficient of friction, rows by mu.

    phi and z are those at p -> 0, of a line through the means; others those of the lowest pressure.
    """
    rows = []
    for mu in sorted({each["mu"] for each in found["packings"]}):
        same = [each["states"] for each in found["packings"] if each["mu"] == mu]
        row = {"mu": mu, "packings": len(same)}
        for name in MEANS:
            values = [[value(name, state, found["number"]) for state in states] for states in same]
            over = np.array(found["pressures"]) ** POWERS.get(name, 1.0)

            def at_onset(some, over=over, extrapolated=name in POWERS):
                means = np.mean(some, axis=0)
                return np.polyfit(over, means, 1)[1] if extrapolated else means[0]

            row[name] = ld.jackknife(values, at_onset)
        rows.append(row)
    return rows


def value(name, state, number):
    """One number of a state; fully mobilized contacts per particle."""
    if name == "rattlers":
        return number - state["rigid"]
    if name == "mobilized":
        return state[name] / state["rigid"]
    return state[name]


def cells(row):
    """Values and errors of a row as text."""
    return [f"{row[name][0]:.{n}f} +- {row[name][1]:.{n}f}" for name, n in MEANS.items()]


def write(found, name):
    """Print and log the table, and draw it."""
    rows = table(found)
    lines = [
        f"{found['number']} droplets, pressures {', '.join(f'{p:g}' for p in found['pressures'])}",
        f"{'mu':8}{'phi_J':20}{'z':19}{'rattlers':16}{'mobilized':19}mobilization",
    ]
    lines += [f"{row['mu']:<6g}  " + "    ".join(cells(row)) for row in rows]
    states = [state for each in found["packings"] for state in each["states"]]
    lines += [
        f"largest force and torque {max(max(s['force'], s['torque']) for s in states):.1e} of the "
        f"mean contact force; beyond Coulomb's bound {max(s['coulomb'] for s in states):.1e}",
        f"{sum(not s['at_rest'] for s in states)} states not at rest; "
        f"{sum(each['seconds'] for each in found['packings']):.0f} s of processor time",
    ]
    text = "\n".join(lines)
    print(text)
    Path(f"{name}.log").write_text(text + "\n")
    draw(rows, f"{name}.png")


def draw(rows, file):
    """z and phi_J over mu; mu = 0 stands at the left end."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    mu = np.array([row["mu"] for row in rows])
    least = mu[mu > 0].min() / 3.0
    for ax, name, label in zip(axes, ("z", "phi"), ("contacts z", "$\\phi_J$"), strict=True):
        mean, error = np.array([row[name] for row in rows]).T
        ax.errorbar(np.where(mu > 0, mu, least), mean, error, fmt="o-")
        ax.set(xscale="log", xlabel="friction of the contacts $\\mu$", ylabel=label)
        ax.axvline(least, color="0.85", zorder=0)
        place = {"transform": ax.get_xaxis_transform(), "va": "bottom", "fontsize": 8}
        ax.text(least, 0.01, " $\\mu$ = 0", color="0.4", **place)
    for level in (3, 4):
        axes[0].axhline(level, color="0.7", linewidth=0.8, zorder=0)
    axes[0].set(ylim=(2.9, 4.1))
    figure.savefig(file, dpi=130)
    plt.close(figure)


def write_beads(found, friction):
    """Print, log and draw which friction of rings polygons of beads have.

    Args:
        found: rows of polygons and of rings.
        friction: of rows of polygons and rings and a name: mu and its error.
    """
    lines = [f"{'beads':8}{'hollow':10}{'z':19}{'mu by z':17}{'phi':20}mu by phi"]
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for color, beads in enumerate(sorted({row["beads"] for row in found["polygons"]})):
        polygons, rings = (
            [row for row in found[kind] if row["beads"] == beads] for kind in ("polygons", "rings")
        )
        cells = [f"{beads:<8d}{np.mean([row['hollow'] for row in polygons]):<6.2f}"]
        for ax, name, digits in zip(axes, ("z", "phi"), (3, 4), strict=True):
            mean, error = jackknife_mean(polygons, name)
            mu, uncertain = friction(polygons, rings, name)
            cells.append(f"{mean:.{digits}f} +- {error:.{digits}f}    {mu:.2f} +- {uncertain:.2f}")
            draw_beads(ax, rings, name, (mu, uncertain), (mean, error), f"C{color}", beads)
        lines.append("    ".join(cells))
    axes[0].legend()
    figure.savefig("beads.png", dpi=130)
    plt.close(figure)
    seconds = sum(row["seconds"] for kind in ("polygons", "rings") for row in found[kind])
    count = len({row["seed"] for row in found["polygons"]})
    lines.append(f"{count} packings of polygons; {seconds:.0f} s of processor time")
    print("\n".join(lines))
    Path("beads.log").write_text("\n".join(lines) + "\n")


def jackknife_mean(rows, name):
    """Mean and standard error of a number."""
    return ld.jackknife([row[name] for row in rows])


def draw_beads(ax, rings, name, mu, value, color, beads):
    """Rings over mu as a line, polygons as a point on it."""
    x = np.array(sorted({row["mu"] for row in rings} - {0.0}))
    same = [[row for row in rings if row["mu"] == each] for each in x]
    mean, error = np.array([jackknife_mean(rows, name) for rows in same]).T
    ax.errorbar(x, mean, error, color=color, linewidth=1)
    label = f"polygons, {beads} beads"
    ax.errorbar(mu[0], value[0], value[1], mu[1], "s", color=color, label=label)
    label = {"z": "contacts z", "phi": "$\\phi$"}[name]
    ax.set(xscale="log", xlabel="friction of the rings $\\mu$", ylabel=label)
