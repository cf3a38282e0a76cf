"""Stiffnesses of particles that give a packing a ratio of shear and bulk modulus.

    python moduli.py

Every particle is a species with an area stiffness of its own. scipy's minimizer finds the
logarithms of all of them with the gradient of `State.derivatives`, and again with differences.
"""

import json
import time

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import minimize

NUMBER, FACTOR, STEPS, MOST = 24, 3.0, 30, 200

jammed = ld.jam(ld.bidisperse(NUMBER, seed=2)).packing
start = jammed.at(jammed.phi + 0.08).replace(species=np.arange(NUMBER))


class Design:
    """G/K of a relaxed state, and its derivatives by ln kA."""

    def __init__(self):
        self.relaxations = 0

    def relaxed(self, log_kA):
        self.relaxations += 1
        with ld.Simulation(start, ld.Ring(kA=tuple(np.exp(log_kA)))) as sim:
            return sim.relax(1e-10)

    def ratio(self, log_kA):
        moduli = self.relaxed(log_kA).moduli()
        return moduli.shear_modulus / moduli.bulk_modulus

    def slopes(self, log_kA):
        """The ratio too."""
        state = self.relaxed(log_kA)
        moduli = state.moduli()
        G, K = moduli.shear_modulus, moduli.bulk_modulus
        by_kA = state.derivatives(by="kA").vjp(shear_modulus=1.0 / K, bulk_modulus=-G / K**2)
        return G / K, by_kA * np.exp(log_kA)

    def miss(self, log_kA, target):
        """How far ln G/K is off, squared, and its gradient."""
        ratio, slopes = self.slopes(log_kA)
        off = np.log(ratio / target)
        return off**2, 2.0 * off / ratio * slopes

    def miss_alone(self, log_kA, target):
        """The same without the gradient."""
        return np.log(self.ratio(log_kA) / target) ** 2


def design(target, with_gradient):
    """How far ln G/K is off after each step of the minimizer, and what it took."""
    found, began, path = Design(), time.process_time(), []

    def told(intermediate_result):
        path.append((found.relaxations, float(np.sqrt(intermediate_result.fun))))

    result = minimize(
        found.miss if with_gradient else found.miss_alone,
        np.zeros(NUMBER),
        (target,),
        "L-BFGS-B",
        jac=with_gradient,
        bounds=[(np.log(0.1), np.log(10.0))] * NUMBER,
        callback=told,
        options={"maxiter": STEPS, "ftol": 1e-16, "gtol": 1e-8, "maxfun": MOST},
    )
    seconds = time.process_time() - began
    return {
        "steps": result.nit,
        "relaxations": found.relaxations,
        "seconds": round(seconds, 1),
        "off": float(np.sqrt(result.fun)),
        "ratio": found.ratio(result.x),
        "log_kA": np.round(result.x, 6).tolist(),
        "path": path,
    }


def main():
    first, slopes = Design().slopes(np.zeros(NUMBER))
    h, axis = 1e-3, np.eye(NUMBER)[0]
    high, low = (Design().ratio(sign * h * axis) for sign in (1.0, -1.0))
    print(
        f"G/K = {first:.4f} at kA = 1; slope by ln kA of particle 0: {slopes[0]:.6f}, "
        f"by differences {(high - low) / (2 * h):.6f}"
    )
    results = {"first": first}
    for way in ("gradient", "differences"):
        results[way] = design(FACTOR * first, way == "gradient")
        print(
            f"{way}: G/K = {results[way]['ratio']:.4f} of {FACTOR * first:.4f} after "
            f"{results[way]['steps']} steps, {results[way]['relaxations']} relaxations, "
            f"{results[way]['seconds']} s"
        )
    with open("moduli.json", "w") as file:
        json.dump(results, file, indent=1)

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6))
    for way in ("gradient", "differences"):
        relaxations, off = np.array(results[way]["path"]).T
        left.loglog(relaxations, off, "o-", label=way)
    left.set(xlabel="relaxations", ylabel="$|\\ln(G/K) - \\ln(target)|$")
    left.legend()
    law = ld.Ring(kA=tuple(np.exp(results["gradient"]["log_kA"])))
    with ld.Simulation(start, law) as sim:
        sim.relax(1e-8).plot(
            ax=right, color=np.array(results["gradient"]["log_kA"]), label="$\\ln k_A$"
        )
    figure.tight_layout()
    figure.savefig("moduli.png", dpi=120)


if __name__ == "__main__":
    main()
