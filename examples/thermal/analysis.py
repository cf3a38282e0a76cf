"""Read runs with MDAnalysis: mean-square displacement and pair distribution."""

import sys
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import MDAnalysis
import numpy as np
from MDAnalysis.analysis.msd import EinsteinMSD
from MDAnalysis.analysis.rdf import InterRDF
from MDAnalysis.transformations import NoJump, set_dimensions

warnings.filterwarnings("ignore", module="MDAnalysis")

FRAME_TIME = 25.0  # from one frame to the next
LARGEST_R, BINS = 4.0, 100


def read(dump):
    """A trajectory; its box is high, so that neighbors are only found in the plane."""
    universe = MDAnalysis.Universe(
        dump, format="LAMMPSDUMP", topology_format="LAMMPSDUMP", dt=FRAME_TIME
    )
    lx, ly = universe.dimensions[:2]
    plane = set_dimensions([lx, ly, 10.0 * lx, 90.0, 90.0, 90.0])
    universe.trajectory.add_transformations(plane, NoJump(), subtract_center)
    return universe, len(universe.atoms), lx * ly


def subtract_center(frame):
    """Subtract the motion of the center, which also diffuses in a heat bath."""
    frame.positions -= frame.positions.mean(axis=0)
    return frame


figure, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.2), layout="constrained")
for dump in sys.argv[1:]:
    universe, number, area = read(dump)
    motion = EinsteinMSD(universe, msd_type="xy", fft=False).run().results
    time, msd = motion.delta_t_values[1:], motion.timeseries[1:]
    late = (time > 0.2 * time[-1]) & (time < 0.5 * time[-1])
    slope, _ = np.polyfit(np.log(time[late]), np.log(msd[late]), 1)
    diffusion = np.mean(msd[late] / time[late]) / 4.0
    print(f"{dump}: msd {msd[late].mean():.3g} ~ t^{slope:.2f}, D {diffusion:.2g}", end=", ")

    pairs = InterRDF(
        universe.atoms,
        universe.atoms,
        nbins=BINS,
        range=(0.0, LARGEST_R),
        norm="none",  # other norms are for three dimensions
        exclusion_block=(1, 1),
    )
    r, count = pairs.run().results.bins, pairs.results.rdf
    g = count / (number * (number - 1) / area * 2.0 * np.pi * r * LARGEST_R / BINS)
    print(
        f"g(r) {g.max():.2f} at {r[g.argmax()]:.2f}, {g[r > 0.8 * LARGEST_R].mean():.3f} far away"
    )

    left.loglog(time, msd, label=Path(dump).parent.name)
    right.plot(r, g)

left.set(xlabel="time", ylabel="mean-square displacement")
right.set(xlabel="r", ylabel="g(r)")
left.legend(frameon=False)
figure.savefig("thermal.png", dpi=110)
