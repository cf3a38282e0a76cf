"""How accurate tilted contacts are, what they say of their own error, and what they cost.

    python benchmarks/tilted.py [--out benchmarks/results/tilted.json] [--parts accuracy,...]

`accuracy`: bidisperse packings of 16 compressed to 5 % beyond jamming, with the laws `balanced` and
`tilted` and as smooth polygons of N_v = 160, each relaxed on its own. `mixtures`: to 3 % with
small particles of kA = 1, kP = 2 among large ones of kA = 10, kP = 40, N_v = 80. `told` is the part
of the energy by which a law estimates its own to be too large. `steps`, `relaxations`: processor
time with tilted contacts over that with balanced ones, of a time step at constant energy and of
compressions from jamming to 5 %; the laws take turns in one process. `energy`: the standard
deviation of the total energy of `tilted` in runs at constant energy, over the kinetic part, against
the time step, and its growth in four times the time: a drift would grow fourfold.
"""

from __future__ import annotations

import argparse
import json
import statistics
import warnings
from pathlib import Path
from typing import Any

import deformable
import numpy as np
from deformable.common.versions import machine
from deformable.model.polygons import PolygonModel
from deformable.studies.accuracy.compressions import law_path, smooth_rows
from motion import energy_error, step

HERE = Path(__file__).parent
LAWS = ("balanced", "tilted")
SEEDS = (1, 3, 4)  # seed 2 loses its rigidity on the way
KEPT = ("law", "seed", "strain", "energy_ratio", "told", "pressure_ratio", "S_rms", "I", "residual")
SKIN = 0.025
TIMESTEPS = (0.2, 0.1, 0.05)
MOTIONS = {"slow": (1e-8, 0.1), "fast": (1e-5, 0.1), "fast, long steps": (1e-5, 0.4)}


def accuracy() -> list[dict[str, Any]]:
    return [row for seed in SEEDS for row in own(smooth_rows(16, seed, 160))]


def mixtures() -> list[dict[str, Any]]:
    kA, kP, count = (1.0, 10.0), (2.0, 40.0), 80
    number = (
        PolygonModel(vertices=count, radius=SKIN, smooth=True).polygons(np.array([0.5, 0.7])).number
    )
    springs = [stiffness * n for stiffness, n in zip(kP, number.tolist(), strict=True)]
    model = PolygonModel(count, SKIN, springs, kA, kr=10.0 * max(kA), smooth=True)
    return [
        row for seed in SEEDS for row in own(smooth_rows(16, seed, count, 0.03, 6, model=model))
    ]


def own(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The laws that relaxed on their own."""
    found = [{key: row[key] for key in KEPT} for row in rows if row["law"] in LAWS and row["own"]]
    for row in found:
        print("  ".join(f"{key} {show(value)}" for key, value in row.items()), flush=True)
    return found


def show(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def steps(repeats: int = 5) -> list[dict[str, Any]]:
    packing = deformable.jam(deformable.bidisperse(1024, seed=1)).at(0.9)
    rows = []
    for motion, (temperature, dt) in MOTIONS.items():
        runs = [
            [
                step(packing, deformable.Ring(contact=law), temperature, dt, 20.0, 300)
                for law in LAWS
            ]
            for _ in range(repeats)
        ]
        rows.append(
            {
                "motion": motion,
                "N": len(packing),
                "ratio": statistics.median(tilted[0] / balanced[0] for balanced, tilted in runs),
                "evaluations": [evaluations for _, evaluations in runs[0]],
            }
        )
        print("step", rows[-1], flush=True)
    return rows


def relaxations() -> list[dict[str, Any]]:
    rows = []
    for number in (64, 256):
        ratios = []
        for seed in SEEDS:
            start = deformable.jam(deformable.bidisperse(number, seed=seed))
            seconds = [
                sum(spent for _, spent in law_path(start, deformable.Ring(contact=law), 0.05, 10))
                for law in LAWS
            ]
            ratios.append(seconds[1] / seconds[0])
        rows.append({"N": number, "ratios": ratios, "ratio": statistics.median(ratios)})
        print("relaxations", rows[-1], flush=True)
    return rows


def energy() -> list[dict[str, Any]]:
    rows, law = [], deformable.Ring(contact="tilted")
    for phi in (0.80, 0.88, 0.92):
        packing = deformable.jam(deformable.bidisperse(64, seed=1)).at(phi)
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


PARTS = {
    "accuracy": accuracy,
    "mixtures": mixtures,
    "energy": energy,
    "steps": steps,
    "relaxations": relaxations,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE / "results" / "tilted.json")
    parser.add_argument("--parts", default=",".join(PARTS), help="only these; others stay")
    options = parser.parse_args()
    warnings.simplefilter("ignore", UserWarning)  # the rows have what they report
    result = json.loads(options.out.read_text()) if options.out.exists() else {}
    options.out.parent.mkdir(parents=True, exist_ok=True)
    for part in options.parts.split(","):
        result[part] = PARTS[part]()
        result |= {"command": "python benchmarks/tilted.py", "machine": machine()}
        options.out.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
