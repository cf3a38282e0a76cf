"""Packings whose radii have relaxed with their centers, beside compressed ones.

    python stable.py

Rings are compressed, then centers and radii relax together (`Simulation.relax(vary="radii")`) while
moments of the radii are kept. Their lowest modes, and the strain at which the first shear stress is
lost, are compared with those before, and with those of a packing that was compressed to the same
pressure.
"""

import json

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.stats import lognorm

NUMBER, SEEDS, ABOVE = 64, 10, 0.1
MOMENTS = (-6, -3, 1, 3, 6)
STEP, MOST, BACK = 1e-3, 0.3, 0.1  # of shear; a loss is a tenth of the first gain
LAW = ld.Ring(kA=1.0)
NAMES = {
    "compressed": "compressed",
    "radii": "radii relaxed",
    "as soft": "compressed, same pressure",
}


def packings(seed):
    """A compressed state, with radii relaxed, and a compressed one of the same pressure."""
    jammed = ld.jam(ld.polydisperse(NUMBER, lognorm(0.2, scale=0.5), seed=seed)).packing
    with ld.Simulation(jammed.at(jammed.phi + ABOVE), LAW) as sim:
        compressed = sim.relax(1e-9)
        sim.relax(1e-7, vary="radii", stiffness=0.0, moments=MOMENTS)
        radii = sim.relax(1e-9)
    with ld.Simulation(jammed.at(jammed.phi + 0.5 * ABOVE), LAW) as sim:
        soft = sim.relax(1e-9, pressure=radii.pressure)
    return {"compressed": compressed, "radii": radii, "as soft": soft}


def sheared(state):
    """Strains and shear stresses until the first loss."""
    stress = [state.shear_stress]

    def lost(now):
        stress.append(now.shear_stress)
        return stress[-1] < stress[-2] - BACK * abs(stress[1] - stress[0])

    with ld.Simulation(state, LAW) as sim:
        sim.shear(MOST, steps=round(MOST / STEP), tolerance=1e-7, callback=lost)
    return STEP * np.arange(len(stress)), np.array(stress)


def main():
    rows, curves = [], {}
    for seed in range(1, SEEDS + 1):
        for name, state in packings(seed).items():
            strain, stress = sheared(state)
            if seed == 1:
                curves[name] = strain, stress - stress[0], state.modes(100).frequencies
                curves[name] = *curves[name], state.pressure
            rows.append(
                {
                    "seed": seed,
                    "packing": name,
                    "pressure": state.pressure,
                    "coordination": state.coordination,
                    "spread": float(state.radii.std() / state.radii.mean()),
                    "lowest": float(state.modes(4).frequencies[0]),
                    "yield_strain": float(strain[-2]),
                    "stress": float(stress.max() - stress[0]),
                }
            )
            print(json.dumps(rows[-1]), flush=True)
    with open("stable.json", "w") as file:
        json.dump(rows, file, indent=1)
    for name, label in NAMES.items():
        of = [row for row in rows if row["packing"] == name]
        median = {key: np.median([row[key] for row in of]) for key in of[0] if key != "packing"}
        print(
            f"{label}: pressure {median['pressure']:.2g}, contacts {median['coordination']:.2f}, "
            f"lowest frequency {median['lowest']:.3f}, yield strain {median['yield_strain']:.3f}"
        )

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6))
    for name, (strain, stress, frequencies, pressure) in curves.items():
        left.plot(strain[:-1], 1e4 * stress[:-1], label=NAMES[name])
        right.step(frequencies / np.sqrt(pressure), np.arange(1, len(frequencies) + 1))
    left.set(xlabel="strain", ylabel="shear stress, $10^{-4}$ $k_A R^2$", title="to the first loss")
    right.set(xscale="log", xlabel=r"frequency over $\sqrt{p}$", ylabel="modes below")
    left.legend()
    figure.tight_layout()
    figure.savefig("stable.png", dpi=120)


if __name__ == "__main__":
    main()
