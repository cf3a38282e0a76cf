"""How right curved contacts are, and what they cost.

    python benchmarks/curved.py [--out benchmarks/results/curved.json] [--parts accuracy,...]

`accuracy`: bidisperse packings compressed to 5 % beyond jamming, with the laws `balanced` and
`curved` and as smooth polygons of N_v vertices, each relaxed on its own: N = 16, seeds 1 to 3, and
N = 64, seed 1, as they come. `mixtures`: the same to 3 % with small particles of kA = 1, kP = 2
among large ones of kA = 10, kP = 40. Energies are over those of the polygons, extrapolated in
1/N_v^2 from the two largest N_v; `uncertain` is what the extrapolation from the two smaller ones
differs by. `contacts`: the first mixture with polygons whose contacts have springs of one and four
times the stiffness. `steps`, `relaxations`: processor time with curved contacts over that with
balanced ones, of a time step at constant energy and of compressions from jamming to 5 %; the laws
take turns in one process. `energy`: the standard deviation of the total energy of `curved` in runs
at constant energy, over the kinetic part, against the time step, and its growth in four times the
time: a drift would grow fourfold. `drift`: the trend of the total energy in a million steps of 16
particles, the mean over eight or `--runs` runs and its error. `cooling`: the same of 36 particles
at 0.88, where `curved` once cooled, over twelve runs. `films`: processor time of a step of
droplets that stick over that without adhesion.
"""

from __future__ import annotations

import argparse
import itertools
import json
import statistics
import warnings
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
from lammps_deformable.common.versions import machine
from lammps_deformable.particles.polygons import DeformablePolygon
from lammps_deformable.reference.comparison import compressed, compression_rows, standard_polygons
from motion import energies, energy_error, step

HERE = Path(__file__).parent
LAWS = ("balanced", "curved")
PACKINGS = ((16, 1), (16, 2), (16, 3), (64, 1))
VERTICES = {16: (80, 160, 320), 64: (40, 80, 160)}
SKIN = 0.025
RADII = np.array([0.5, 0.7])
TIMESTEPS = (0.2, 0.1, 0.05)
MOTIONS = {"slow": (1e-8, 0.1), "fast": (1e-5, 0.1), "fast, long steps": (1e-5, 0.4)}
ADHESIONS = {0.84: (0.0, 0.05, 0.1), 0.9: (0.0, 0.05, 0.2)}
FILM_MOTIONS = {"slow": (1e-6, 0.05), "fast": (1e-4, 0.05)}


def accuracy() -> list[dict[str, Any]]:
    return [row for number, seed in PACKINGS for row in compared(number, seed, 0.05, 5)]


def mixtures() -> list[dict[str, Any]]:
    return [row for seed in (1, 2, 3) for row in compared(16, seed, 0.03, 3, mixed)]


def contacts() -> list[dict[str, Any]]:
    """A mixture, and polygons whose contacts have stiffer springs."""
    return [
        {"stiffer": times} | row
        for times in (1, 4)
        for row in compared(16, 1, 0.03, 3, lambda count, n=times: mixed(count, n), (40, 80, 160))
    ]


def mixed(count: int, stiffer: float = 1.0) -> DeformablePolygon:
    """Polygons of soft small and stiff large particles."""
    kA, kP = (1.0, 10.0), (2.0, 40.0)
    number = DeformablePolygon(count, radius=SKIN).polygons(RADII).number
    springs = [stiffness * n for stiffness, n in zip(kP, number.tolist(), strict=True)]
    return DeformablePolygon(count, radius=SKIN, kL=springs, kA=kA, kr=10.0 * stiffer * max(kA))


def compared(
    number: int,
    seed: int,
    strain: float,
    steps: int,
    model: Any = None,
    counts: tuple[int, ...] = (),
) -> list[dict[str, Any]]:
    """Energies of the laws that relaxed on their own over those of the extrapolated polygons."""
    counts = counts or VERTICES[number]
    start = ld.jam(ld.bidisperse(number, seed=seed)).packing
    found = {
        count: {
            (row["law"], round(row["strain"], 6)): row
            for row in compression_rows(
                start, model(count) if model else standard_polygons(count), strain, steps
            )
            if row["law"] in LAWS and row["own"]
        }
        for count in counts
    }
    rows = []
    for key in found[counts[0]]:
        each = [found[count][key] for count in counts]
        row = {"N": number, "seed": seed, "law": key[0], "strain": key[1]}
        row["residual"] = max(one["residual"] for one in each)
        row["areas"], row["distance"] = each[-1]["S_rms"], each[-1]["distance"]
        ratios = [one["energy_ratio"] for one in each]
        if all(ratios):
            inverse = 1.0 / np.array(ratios)
            first, last = (
                beyond(inverse[k : k + 2], counts[k : k + 2]) for k in (0, len(counts) - 2)
            )
            row["ratios"] = dict(zip(map(str, counts), ratios, strict=True))
            row["error"], row["uncertain"] = 1.0 / last - 1.0, abs(first / last - 1.0)
        rows.append(row)
        print("  ".join(f"{name} {show(value)}" for name, value in row.items()), flush=True)
    return rows


def beyond(values: np.ndarray, counts: tuple[int, ...]) -> float:
    """The limit of value + c/N_v^2."""
    near, far = (float(n) ** 2 for n in counts)
    return float((far * values[1] - near * values[0]) / (far - near))


def show(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def steps(repeats: int = 3) -> list[dict[str, Any]]:
    """At N = 1024 and 9216, from the same packing."""
    start = ld.jam(ld.bidisperse(1024, seed=1)).packing.at(0.9)
    with ld.Simulation(start, ld.Ring()) as sim:
        cell = sim.relax(1e-4).packing
    rows = []
    for times, (motion, (temperature, dt)) in itertools.product((1, 3), MOTIONS.items()):
        packing, count = cell.replicate(times, times), 300 if times == 1 else 60
        runs = [
            [step(packing, ld.Ring(contact=law), temperature, dt, 20.0, count) for law in LAWS]
            for _ in range(repeats)
        ]
        rows.append(
            {
                "motion": motion,
                "N": len(packing),
                "ratio": statistics.median(curved[0] / balanced[0] for balanced, curved in runs),
                "evaluations": [evaluations for _, evaluations in runs[0]],
            }
        )
        print("step", rows[-1], flush=True)
    return rows


def films(repeats: int = 3) -> list[dict[str, Any]]:
    """Droplets of tension 1, N = 1024, from the same packing, with and without adhesion."""

    def droplets(w: float) -> ld.Ring:
        return ld.Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved", adhesion=w)

    rows = []
    for phi, (motion, (temperature, dt)) in itertools.product(ADHESIONS, FILM_MOTIONS.items()):
        start = ld.jam(ld.bidisperse(1024, seed=1)).packing.at(phi)
        runs = [
            [step(start, droplets(w), temperature, dt, 10.0, 200) for w in ADHESIONS[phi]]
            for _ in range(repeats)
        ]
        for n, w in enumerate(ADHESIONS[phi]):
            rows.append(
                {
                    "phi": phi,
                    "motion": motion,
                    "w": w,
                    "ratio": statistics.median(run[n][0] / run[0][0] for run in runs),
                    "evaluations": runs[0][n][1],
                }
            )
            print("films", rows[-1], flush=True)
    return rows


def relaxations() -> list[dict[str, Any]]:
    rows = []
    for number in (64, 256):
        ratios = []
        for seed in (1, 2, 3):
            start = ld.jam(ld.bidisperse(number, seed=seed)).packing
            seconds = [
                sum(spent for _, spent in compressed(start, ld.Ring(contact=law), 0.05, 10))
                for law in LAWS
            ]
            ratios.append(seconds[1] / seconds[0])
        rows.append({"N": number, "ratios": ratios, "ratio": statistics.median(ratios)})
        print("relaxations", rows[-1], flush=True)
    return rows


def energy() -> list[dict[str, Any]]:
    rows, law = [], ld.Ring(contact="curved")
    for phi in (0.80, 0.88, 0.92):
        packing = ld.jam(ld.bidisperse(64, seed=1)).packing.at(phi)
        errors = [energy_error(packing, law, dt, 400.0, 100) for dt in TIMESTEPS]
        rows.append(
            {
                "phi": phi,
                "dt": TIMESTEPS,
                "error": errors,
                "order": float(np.polyfit(np.log(TIMESTEPS), np.log(errors), 1)[0]),
                "growth": energy_error(packing, law, TIMESTEPS[0], 1600.0, 400) / errors[0],
            }
        )
        print("energy", rows[-1], flush=True)
    return rows


def drift(
    runs: int = 8,
    number: int = 16,
    fractions: tuple[float, ...] = (0.80, 0.88, 0.92),
    laws: tuple[str, ...] = LAWS,
) -> list[dict[str, Any]]:
    """Trends of the total energy over the kinetic one, of runs with other velocities."""
    rows, dt, samples, seeds = [], 0.1, 500, range(1, runs + 1)
    for phi, contact in itertools.product(fractions, laws):
        packing = ld.jam(ld.bidisperse(number, seed=1)).packing.at(phi)
        trends = []
        for seed in seeds:
            with ld.Simulation(packing, ld.Ring(contact=contact)) as sim:
                sim.lmp.commands_string(
                    f"timestep {dt!r}\nvelocity all create 1e-5 {4710 + seed} loop all\n"
                    "fix nve all nve\nthermo_style custom step ke etotal\n"
                    "thermo_modify norm no\nrun 0 post no"
                )
                kinetic, total = energies(sim, samples, 1_000_000 // samples)
            trends.append(np.polyfit(np.linspace(0, 1, samples), total / kinetic.mean(), 1)[0])
        rows.append(
            {
                "phi": phi,
                "law": contact,
                "N": number,
                "runs": runs,
                "steps": 1_000_000,
                "drift": statistics.fmean(trends),
                "standard_error": statistics.stdev(trends) / len(trends) ** 0.5,
            }
        )
        print("drift", rows[-1], flush=True)
    return rows


def cooling() -> list[dict[str, Any]]:
    return drift(12, 36, (0.88,), ("curved",))


PARTS = {
    "accuracy": accuracy,
    "mixtures": mixtures,
    "contacts": contacts,
    "energy": energy,
    "drift": drift,
    "cooling": cooling,
    "steps": steps,
    "relaxations": relaxations,
    "films": films,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "curved.json")
    parser.add_argument("--parts", default=",".join(PARTS), help="only these; others stay")
    parser.add_argument("--runs", type=int, default=8, help="of drift, for each packing and law")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    result = json.loads(options.out.read_text()) if options.out.exists() else {}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    for part in options.parts.split(","):
        result[part] = drift(options.runs) if part == "drift" else PARTS[part]()
        result |= {"command": "python benchmarks/curved.py", "machine": machine()}
        options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
