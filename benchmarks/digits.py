"""Whether packings and their figures are the same to the last bit on other processors.

    python benchmarks/digits.py [--short] [--out benchmarks/results/digits.json]

A library of linear algebra has kernels for each processor, numpy and the mathematical functions of
the C library too, and so has this package. Environment variables choose the kernels of other
processors than this one. Every case is computed with each choice and reduced to a digest of all its
bits: a minimizer of disks makes another packing of another last digit.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import lammps_deformable as ld
import numpy as np
from lammps_deformable.protocols.shearing import sheared
from scipy import stats

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

HERE = Path(__file__).parent
STRAIN, STEPS = 0.01, 2


def processors() -> dict[str, dict[str, str]]:
    """Environment variables that choose kernels, by what they stand for: those that run here."""
    extensions = np.show_config(mode="dicts")["SIMD Extensions"]
    newer = {"avx512": ("AVX-512", "SkylakeX"), "avx2": ("Haswell", "Haswell")}
    return {
        name: {"OPENBLAS_CORETYPE": kernels}
        for level, (name, kernels) in newer.items()
        if level in ld.core.simd_levels()
    } | {
        "older": {
            "OPENBLAS_CORETYPE": "Prescott",
            "DEFORMABLE_SIMD": "plain",
            "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX2_Usable",
            "NPY_DISABLE_CPU_FEATURES": " ".join(extensions.get("found", [])),
        },
    }


def cases(short: bool) -> Iterator[tuple[str, Callable[[], object]]]:
    """Names of cases, and what they compute: packings and numbers."""
    droplets = ld.Ring(kA=float("inf"), kP=0.0, tension=1.0)
    walls = [ld.Sphere(7.0), ld.Sphere(1.0, (2.0, 0.0), inside=False)]
    yield "bidisperse, tilted box", lambda: ld.bidisperse(256, tilt=0.3, seed=3)
    yield "polydisperse", lambda: ld.polydisperse(64, stats.lognorm(0.1), tilt=0.3, seed=1)
    for number in (64,) if short else (64, 128, 512, 1000, 4096):
        yield f"jam, {number} disks", lambda n=number: ld.jam(ld.bidisperse(n, seed=1)).packing
    yield (
        "jam, 60 disks between walls",
        lambda: ld.jam(ld.bidisperse(60, seed=1).between(walls).at(0.5)).packing,
    )
    for name, law in {"balanced": ld.Ring(), "droplets": droplets, "sector": ld.Sector()}.items():
        yield (
            f"jam, 32 particles, {name}",
            lambda law=law: ld.jam(ld.bidisperse(32, seed=1), law).packing,
        )
    for name, law in {
        "radical": ld.Ring(contact="radical"),
        "curved": ld.Ring(contact="curved"),
    }.items():
        yield f"compress, 64 particles, {name}", lambda law=law: strained(law, "compress")
    yield "shear, 64 particles, balanced", lambda: strained(ld.Ring(), "shear")
    yield "compress, 6 smooth polygons", rings


def strained(law: ld.Ring, protocol: str) -> list[object]:
    """Packings, energies, stresses and areas on the way.

    Without the methods of protocols, whose runs begin with an evaluation of the start: contacts are
    balanced from the forces before.
    """
    with ld.Simulation(ld.jam(ld.bidisperse(64, seed=1)).packing.at(0.86), law) as sim:
        states = list(steps(sim, protocol))
    return [
        [s.packing, s.energy, s.pressure_tensor, s.volumes, s.contacts["force"]] for s in states
    ]


def steps(sim: ld.Simulation, protocol: str) -> Iterator[ld.State]:
    """The relaxed states after small strains."""
    box = sim.box
    for n in range(1, STEPS + 1):
        if protocol == "compress":
            sim.deform(box * (1.0 - STRAIN * n / STEPS))
        else:
            sim.deform(sheared(sim.box, STRAIN / STEPS))
        yield sim.relax()


def rings() -> list[object]:
    """The reference model."""
    with ld.Simulation(
        ld.jam(ld.bidisperse(6, seed=1)).packing, ld.DeformablePolygon(vertices=30, smooth=True)
    ) as sim:
        states = list(steps(sim, "compress"))
    return [[s.energy, s.pressure_tensor, s.area_deficit, *s.outlines] for s in states]


def digest(found: object) -> str:
    """The first digits of a hash of all bits."""
    total = hashlib.sha256()

    def add(value: object) -> None:
        if isinstance(value, list):
            for each in value:
                add(each)
        elif isinstance(value, ld.Packing):
            add([value.positions, value.box, value.radii])
        else:
            total.update(np.ascontiguousarray(value, dtype=np.float64).tobytes())

    add(found)
    return total.hexdigest()[:12]


def compute(short: bool) -> dict[str, str]:
    """The digest of each case, with the kernels of this process."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ld.StalledWarning)
        return {name: digest(function()) for name, function in cases(short)}


def compare(short: bool) -> dict[str, dict[str, str]]:
    """The digest of each case, with the kernels of each processor, in processes side by side."""
    command = [sys.executable, __file__, "--here", *(["--short"] if short else [])]
    started = {
        name: subprocess.Popen(command, env=os.environ | chosen, stdout=subprocess.PIPE, text=True)
        for name, chosen in processors().items()
    }
    written = {name: process.communicate()[0] for name, process in started.items()}
    for name, process in started.items():
        if process.returncode != 0:
            raise RuntimeError(f"no digits with the kernels {name}: status {process.returncode}")
    return {name: json.loads(text) for name, text in written.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="small cases only")
    parser.add_argument("--here", action="store_true", help="with the kernels of this process only")
    parser.add_argument("--out", type=Path, default=HERE / "results" / "digits.json")
    options = parser.parse_args()
    if options.here:
        print(json.dumps(compute(options.short)))
        return
    found = compare(options.short)
    print(f"{'':36}" + "".join(f"{name:>14}" for name in found))
    for case in next(iter(found.values())):
        print(f"{case:36}" + "".join(f"{digests[case]:>14}" for digests in found.values()))
    options.out.write_text(json.dumps(found, indent=1) + "\n")
    print(f"wrote {options.out}")


if __name__ == "__main__":
    main()
