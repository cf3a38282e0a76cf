"""Normal modes and moduli of packings above jamming: density of states, omega*, boson peak.

    python -m validation.jamming.vibrations LAW N [--seeds 4] [--modes M] [--excess-phi 1e-4 ...]

Packings are jammed as soft disks and compressed to each phi - phi_J; there `State.modes` and
`State.moduli` are computed. vibrations.json keeps the packings of earlier calls, which are
not measured again, also with other options; vibrations.png shows all of them. Times are those of
one thread if OMP_NUM_THREADS=1 is set. Those of this folder come from

    disk 1024 --seeds 10
    disk 4096 --seeds 2 --modes 400
    radical 1024 --seeds 8 --excess-phi 0.001 0.003 0.01 0.03
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from lammps_deformable.common.files import make_folder, write_whole
from lammps_deformable.common.jackknife import jackknife
from lammps_deformable.engine.jamming import jam
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.engine.soft_disks import relax_at_pressure
from lammps_deformable.particles.generators import bidisperse
from lammps_deformable.particles.laws import SoftContact, natural_pressure
from lammps_deformable.particles.packing import Packing
from lammps_deformable.state.state import State
from mpi4py import MPI
from numpy.typing import NDArray

from validation.ensembles import power_law
from validation.jamming.packings import Row, contact_law, standard_error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

DISKS = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1]

# Those with second derivatives.
LAWS = ("disk", "radical", "balanced", "curved")

# Intervals of frequency, ten a decade, in units of sqrt(k/m) with the mean stiffness k of contacts.
EDGES: Floats = 10.0 ** np.linspace(-4.0, 0.7, 48)

# Disks are jammed at this pressure, and relaxed to this part of a contact force. At a pressure P
# they are about P/0.4 above phi_J.
_ONSET, _TOLERANCE, _SLOPE = 1e-7, 1e-6, 0.4

# Iterations of a relaxation.
_PATIENCE = 20_000

# The plateau of the density of states is taken between these frequencies. It ends at omega*, where
# the density falls below this part of it.
_PLATEAU, _PART = (0.4, 1.0), 0.5

# Fewest modes in three intervals side by side from which a frequency is read: a packing near an
# instability has single modes of any frequency.
_FEWEST = 10

# Quantities with a power law in phi - phi_J.
QUANTITIES = ("pressure", "excess_coordination", "shear_modulus", "bulk_modulus")


def measure(
    law: str, number: int, seed: int, excess_phi: Sequence[float], modes: int | None = None
) -> list[Row]:
    """Modes and moduli of a packing that is compressed from its onset.

    Rings have the onset of soft disks, so that all laws start from these.

    Args:
        law: `disk`, or a name in `LAWS` with a Hessian.
        number: of particles, an equal mixture of sizes 1 : 1.4.
        seed: of the random start.
        excess_phi: values of phi - phi_J, rising; disks come close to them.
        modes: how many of the lowest modes are counted; all if not given.

    Returns:
        A row for each value at which the packing has not lost its rigidity. Pressures and moduli
        are in natural units, frequencies in units of sqrt(k/m), k = tr H/(2 N_c) with the Hessian H
        and N_c contacts; `counts` are modes between the `EDGES`, complete up to the frequency
        `complete`, of `modes` in all.
    """
    disks = jam(bidisperse(number, seed=seed), pressure=_ONSET, tolerance=_TOLERANCE).packing
    with Simulation(disks, SoftContact()) as soft:
        state = soft.state()
    # dp/dphi = K/phi
    onset = state.phi * (1.0 - state.pressure / state.moduli().bulk_modulus)
    unit = natural_pressure(disks, contact_law(law))
    key = {"law": law, "number": number, "seed": seed, "onset_phi": onset}
    rows = []
    for wanted, found in zip(excess_phi, _states(law, disks, onset, excess_phi), strict=True):
        if found.pressure < _ONSET * unit * wanted:
            continue  # it has rearranged, and is loose
        row = key | {"wanted": wanted, "excess_phi": found.phi - onset}
        rows.append(row | _response(found, unit) | _spectrum(found, modes))
    return rows


def _states(law: str, disks: Packing, onset: float, excess_phi: Sequence[float]) -> Iterator[State]:
    """The packing, relaxed near each phi - phi_J."""
    settings = contact_law(law)
    if isinstance(settings, SoftContact):
        for excess in excess_phi:
            relaxed = relax_at_pressure(
                disks, _SLOPE * excess, _TOLERANCE, _PATIENCE, lambda *values: None
            )
            disks = relaxed.packing
            with Simulation(disks, SoftContact()) as soft:
                yield soft.state()
        return
    with Simulation(disks, settings, comm=MPI.COMM_SELF) as sim:
        for excess in excess_phi:
            sim.deform(disks.at(onset + excess).box)
            yield sim.relax(_TOLERANCE)


def _response(state: State, unit: float) -> Row:
    moduli = state.moduli()
    free = int(np.sum(~state.rattlers))
    return {
        "phi": state.phi,
        "pressure": state.pressure / unit,
        "excess_coordination": 2.0 * (state.network_contacts - state.isostatic_contacts) / free,
        "shear_modulus": moduli.mean_shear_modulus / unit,
        "bulk_modulus": moduli.bulk_modulus / unit,
        "residual": state.residual,
    }


def _spectrum(state: State, modes: int | None) -> Row:
    hessian = state.hessian(rattlers=False)
    # lines of balanced and curved contacts are variables of the sparse matrix
    has_lines = hessian.matrix.shape[0] > hessian.size
    trace = np.trace(hessian.reduced()) if has_lines else hessian.matrix.trace()
    stiffness = trace / (2.0 * state.network_contacts)
    frequencies = state.modes(modes, vectors=False).frequencies / np.sqrt(stiffness)
    complete = np.inf if modes is None else float(frequencies[-1])
    return {
        "stiffness": float(stiffness),
        "modes": hessian.size - hessian.zero_modes,
        "complete": complete if np.isfinite(complete) else None,
        "lowest": float(frequencies[0]),
        "unstable": int(np.sum(frequencies < 0.0)),
        "counts": np.histogram(frequencies, EDGES)[0].tolist(),
    }


def density(rows: Sequence[Row]) -> tuple[Floats, Floats]:
    """Density of states over packings, and its standard error by the number of modes.

    Returns:
        Both for each interval of `EDGES`; nan where no packing has counted all modes.
    """
    counts, modes = np.zeros(len(EDGES) - 1), np.zeros(len(EDGES) - 1)
    for row in rows:
        whole = EDGES[1:] <= (row["complete"] or np.inf)
        counts += np.where(whole, row["counts"], 0)
        modes += np.where(whole, row["modes"], 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        per_count = 1.0 / (modes * np.diff(EDGES))
        return counts * per_count, np.sqrt(counts) * per_count


def plateau(rows: Sequence[Row]) -> float:
    """Mean density of states between 0.4 and 1 sqrt(k/m); nan if those modes were not counted."""
    found, _ = density(rows)
    inside = (EDGES[:-1] >= 0.999 * _PLATEAU[0]) & (EDGES[1:] <= 1.001 * _PLATEAU[1])
    width = np.diff(EDGES)[inside]
    return float(np.sum(found[inside] * width) / np.sum(width))


def onset_frequency(rows: Sequence[Row], level: float) -> float:
    """omega*, where the density of states rises above half of its plateau; nan if it does not.

    Args:
        rows: of packings at the same phi - phi_J.
        level: the plateau.
    """
    smooth, middle = _smoothed(rows), np.sqrt(EDGES[1:] * EDGES[:-1])
    above = np.flatnonzero(smooth >= _PART * level)
    if not above.size or above[0] == 0 or not smooth[above[0] - 1] > 0.0:
        return float("nan")
    low, high = above[0] - 1, above[0]
    steps = np.log(smooth[[low, high]] / (_PART * level))
    part = -steps[0] / (steps[1] - steps[0])
    return float(middle[low] * (middle[high] / middle[low]) ** part)


def boson_peak(rows: Sequence[Row]) -> float:
    """The frequency at which D(omega)/omega is largest; omega is Debye's D in two dimensions.

    A parabola through the three intervals around the maximum, in logarithms; nan if it is at an
    end.
    """
    middle = np.log(np.sqrt(EDGES[1:] * EDGES[:-1]))
    reduced = _smoothed(rows) / np.exp(middle)
    if np.isnan(reduced).all():
        return float("nan")
    top = int(np.nanargmax(reduced))
    if top in (0, len(reduced) - 1) or not (reduced[top - 1 : top + 2] > 0.0).all():
        return float("nan")
    below, at, above = np.log(reduced[top - 1 : top + 2])
    shift = 0.5 * (below - above) / (below - 2.0 * at + above)
    return float(np.exp(middle[top] + shift * (middle[1] - middle[0])))


def _smoothed(rows: Sequence[Row]) -> Floats:
    """Density of states over three intervals; nan where they have too few modes."""
    found, error = density(rows)
    padded = np.pad(found, 1, mode="edge")
    mean: Floats = (padded[:-2] + padded[1:-1] + padded[2:]) / 3.0
    with np.errstate(invalid="ignore", divide="ignore"):
        modes = np.pad(np.rint((found / error) ** 2), 1)
    modes = np.where(np.isnan(modes), 0.0, modes)
    mean[modes[:-2] + modes[1:-1] + modes[2:] < _FEWEST] = np.nan
    return mean


def summarize(rows: Sequence[Row]) -> list[Row]:
    """Means over packings of each law, size and phi - phi_J, with standard errors."""
    summary = []
    for (law, number, wanted), group in grouped(rows).items():
        of_law = [row for row in rows if row["law"] == law and row["complete"] is None]
        level = plateau([row for row in of_law if row["wanted"] == wanted]) if of_law else np.nan
        found: Row = {"law": law, "number": number, "wanted": wanted, "packings": len(group)}
        for name in ("excess_phi", "stiffness", *QUANTITIES):
            values = [row[name] for row in group]
            found[name] = float(np.mean(values))
            found[f"{name}_error"] = standard_error(values)
        found["plateau"] = level
        for name, frequency in (
            ("omega_star", lambda these, level=level: onset_frequency(these, level)),
            ("boson_peak", boson_peak),
        ):
            found[name], found[f"{name}_error"] = _jackknife(frequency, group)
        found["unstable"] = sum(row["unstable"] for row in group)
        summary.append(found)
    return summary


def grouped(rows: Sequence[Row]) -> dict[tuple[Any, ...], list[Row]]:
    """Rows of packings that differ only in their seed."""
    found: dict[tuple[Any, ...], list[Row]] = {}
    for row in rows:
        found.setdefault((row["law"], row["number"], row["wanted"]), []).append(row)
    return dict(sorted(found.items()))


def exponent(summary: Sequence[Row], name: str, lowest: float, highest: float) -> float:
    """Slope of a quantity over phi - phi_J in logarithms, between these values.

    Args:
        summary: rows of one law and size.
        name: of the quantity.
        lowest: phi - phi_J from which rows count.
        highest: phi - phi_J up to which they do.
    """
    points = [
        (row["excess_phi"], row[name])
        for row in summary
        if lowest <= row["wanted"] <= highest and row[name] > 0.0
    ]
    if len(points) < 2:
        return float("nan")
    return power_law(*zip(*points, strict=True))


def _jackknife(value: Callable[[Sequence[Row]], float], rows: list[Row]) -> tuple[float, float]:
    """A value of all packings, and its standard error; nan of less than three."""
    if len(rows) < 3:
        return value(rows), float("nan")
    found, error = jackknife(rows, value)
    return float(found), float(error)


def figure(rows: Sequence[Row]) -> Figure:
    """Density of states of each law, and frequencies and moduli over phi - phi_J."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    laws = list(dict.fromkeys(row["law"] for row in rows))
    figure = Figure(figsize=(4.6 * (len(laws) + 2), 4.2), layout="constrained")
    *spectra, frequencies, moduli = figure.subplots(1, len(laws) + 2)
    middle = np.sqrt(EDGES[1:] * EDGES[:-1])
    for law, ax in zip(laws, spectra, strict=True):
        steps = sorted({row["wanted"] for row in rows if row["law"] == law})
        colors = colormaps["viridis"](np.linspace(0.0, 0.9, len(steps)))
        for step, color in zip(steps, colors, strict=True):
            these = [row for row in rows if (row["law"], row["wanted"]) == (law, step)]
            found, error = density(these)
            there = found > 0.0
            ax.errorbar(
                middle[there], found[there], error[there], color=color, label=f"{step:g}", lw=1.2
            )
        ax.set(
            title=law,
            xlabel=r"$\omega / \sqrt{k/m}$",
            ylabel=r"density of states $D(\omega)$",
            xscale="log",
            yscale="log",
        )
        ax.legend(title=r"$\phi - \phi_J$", fontsize=8)
    summary = summarize(rows)
    for law, number in dict.fromkeys((row["law"], row["number"]) for row in summary):
        chosen = [row for row in summary if (row["law"], row["number"]) == (law, number)]
        at = [row["excess_phi"] for row in chosen]
        label = f"{law}, $N$ = {number}"
        for name, marker in (("omega_star", "o"), ("boson_peak", "x")):
            y, bars = ([row[f"{name}{end}"] for row in chosen] for end in ("", "_error"))
            shown = {"omega_star": r"$\omega^*$", "boson_peak": "boson peak"}[name]
            frequencies.errorbar(at, y, bars, fmt=marker, label=f"{shown}, {label}")
        ratio, bars = (
            [row[f"shear_modulus{end}"] / row["bulk_modulus"] for row in chosen]
            for end in ("", "_error")
        )
        moduli.errorbar(at, ratio, bars, fmt="o", label=label)
    reached = [row["excess_phi"] for row in summary]
    ends = np.array([min(reached), max(reached)])
    frequencies.plot(ends, np.sqrt(ends), "k--", lw=0.8, label="slope 1/2")
    moduli.plot(ends, np.sqrt(ends), "k--", lw=0.8, label="slope 1/2")
    frequencies.set(ylabel=r"frequency / $\sqrt{k/m}$")
    moduli.set(ylabel="$G/K$")
    for ax in (frequencies, moduli):
        ax.set(xlabel=r"$\phi - \phi_J$", xscale="log", yscale="log")
        ax.legend(fontsize=7)
    return figure


def main() -> None:
    parser = argparse.ArgumentParser(description="Modes and moduli above jamming")
    parser.add_argument("law", choices=LAWS)
    parser.add_argument("number", type=int, help="of particles in a packing")
    parser.add_argument("--seeds", type=int, default=4, help="packings")
    parser.add_argument("--modes", type=int, help="lowest ones of each packing; all if omitted")
    parser.add_argument("--excess-phi", type=float, nargs="+", default=DISKS, help="phi - phi_J")
    parser.add_argument(
        "--out", type=Path, default=Path(__file__).parent, help="folder of the results"
    )
    options = parser.parse_args()

    path = make_folder(options.out) / "vibrations.json"
    rows = json.loads(path.read_text())["rows"] if path.exists() else []
    for seed in range(1, options.seeds + 1):
        key = (options.law, options.number, seed)
        if key in {(row["law"], row["number"], row["seed"]) for row in rows}:
            print(*key, "is there", flush=True)
            continue
        began = time.process_time()
        rows += measure(*key, sorted(options.excess_phi), options.modes)
        rows.sort(key=lambda row: (row["law"], row["number"], row["seed"], row["wanted"]))
        lines = ",\n".join(json.dumps(row) for row in rows)
        means = ",\n".join(json.dumps(finite(row)) for row in summarize(rows))
        write_whole(path, f'{{"summary": [\n{means}\n],\n"rows": [\n{lines}\n]}}\n')
        print(*key, f"{time.process_time() - began:.1f} s", flush=True)
    if rows:
        figure(rows).savefig(options.out / "vibrations.png", dpi=110)


def finite(row: dict[str, object]) -> dict[str, object]:
    """JSON has no nan."""
    return {name: None if value != value else value for name, value in row.items()}


if __name__ == "__main__":
    main()
