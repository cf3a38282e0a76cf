"""Read a recorded run with MDAnalysis: coordination number and structure factor."""

import csv

import lammps_deformable as ld
import numpy as np

universe = ld.Run("run").to_mdanalysis()
with open("run/series.csv", newline="") as file:
    phi = [float(row["phi"]) for row in csv.DictReader(file)]

# Wave vectors of the periodic box, k = 2 pi n box^-T with the lattice vectors as rows of box
n = np.stack(np.meshgrid(np.arange(-9, 10), np.arange(1, 10)), axis=-1).reshape(-1, 2)
for frame in universe.trajectory[:: len(universe.trajectory) // 5]:
    rigid = frame.data["rattler"] == 0
    box = frame.triclinic_dimensions[:2, :2].astype(float)
    k = 2.0 * np.pi * n @ np.linalg.inv(box).T
    wave = np.exp(1j * frame.positions[:, :2].astype(float) @ k.T)
    s = np.abs(wave.sum(axis=0)) ** 2 / frame.n_atoms
    length = np.linalg.norm(k, axis=1)
    shell = np.digitize(length, np.arange(0.0, 9.0, 0.75))
    mean = {m: (length[shell == m].mean(), s[shell == m].mean()) for m in np.unique(shell)[:-1]}
    peak, height = max(mean.values(), key=lambda pair: pair[1])
    print(
        f"phi {phi[frame.frame]:.4f}  z {frame.data['contacts'][rigid].mean():.3f}  "
        f"S(k) {height:.2f} at k = {peak:.2f}"
    )
