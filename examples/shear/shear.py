"""Shear a packing far beyond yielding: stress over strain, and plastic events."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

PHI, STRAIN, STEPS = 0.90, 1.0, 200

jammed = ld.jam(ld.bidisperse(64, seed=1)).packing
with ld.Simulation(jammed.at(PHI), ld.Ring()) as sim:
    start = sim.relax(1e-4)
    modulus = ld.Simulation(start, sim.law).relax(1e-10).moduli().shear_modulus
    print(f"phi {start.phi:.3f}  pressure {start.pressure:.3e}  shear modulus {modulus:.2e}")
    states = sim.shear(STRAIN, steps=STEPS, tolerance=1e-4)[1:]

strain = STRAIN * np.arange(1, STEPS + 1) / STEPS
stress = np.array([state.shear_stress for state in states])
pressure = np.array([state.pressure for state in states])
flowing = strain > 0.2
# in a plastic event the stress falls by more than it rises in an elastic step
events = np.flatnonzero(np.diff(stress) < -modulus * STRAIN / STEPS)
print(f"largest stress {stress.max():.2e} at a strain of {strain[stress.argmax()]:.3f}")
print(f"beyond 0.2  stress {stress[flowing].mean():.2e}  pressure {pressure[flowing].mean():.2e}")
print(f"ratio of the two {stress[flowing].mean() / pressure[flowing].mean():.3f}")
print(f"plastic events {len(events)} in a strain of {STRAIN:g}")

figure, (curve, picture) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
curve.plot(strain, stress, label="shear stress")
first = np.array([0.0, 0.05])
curve.plot(first, modulus * first + start.shear_stress, "--", label="modulus")
curve.plot(strain[events + 1], stress[events + 1], ".", color="tab:red", label="plastic events")
curve.set(xlabel="shear strain", ylabel="shear stress [kA]")
curve.legend()
states[-1].plot(picture, forces=True)
figure.savefig("shear.png", dpi=90)
