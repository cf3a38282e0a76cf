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

NUMBER, STRAIN, FACTOR, STEPS, MOST = 24, 1e-5, 3.0, 30, 200
SHEAR = np.array([[0.0, 0.5], [0.5, 0.0]])  # weights of the pressure tensor: its component xy

jammed = ld.jam(ld.bidisperse(NUMBER, seed=1)).packing
start = jammed.at(jammed.phi + 0.08).replace(species=np.arange(NUMBER))


class Design:
    """G/K of relaxed states at small strains, and its derivatives by ln kA, exact ones of these."""

    def __init__(self):
        self.relaxations, self.history = 0, []

    def strained(self, law, box, weights):
        """Pressure, or a component of its tensor, in this box; with its derivatives by kA."""
        self.relaxations += 1
        with ld.Simulation(start, law) as sim:
            sim.deform(box)
            state = sim.relax(1e-10)
        if weights is None:
            return state.pressure, state, {"pressure": 1.0}
        return np.sum(weights * state.pressure_tensor), state, {"pressure_tensor": weights}

    def modulus(self, law, change, weights, slopes):
        """A modulus from strains both ways, and its gradient."""
        values, gradients = [], []
        for sign in (1.0, -1.0):
            strain = np.eye(2) + sign * STRAIN * change
            value, state, combination = self.strained(law, start.box @ strain.T, weights)
            values.append(value)
            if slopes:
                gradients.append(state.derivatives(by="kA").vjp(**combination))
        both = np.diff(values)[0] / (2.0 * STRAIN)
        return both, np.diff(gradients, axis=0)[0] / (2.0 * STRAIN) if slopes else None

    def ratio(self, log_kA, slopes=True):
        """G/K, and its derivatives by ln kA."""
        law = ld.Ring(kA=tuple(np.exp(log_kA)))
        G, by_G = self.modulus(law, np.array([[0.0, 1.0], [0.0, 0.0]]), SHEAR, slopes)
        K, by_K = self.modulus(law, 0.5 * np.eye(2), None, slopes)
        gradient = (by_G / K - G * by_K / K**2) * np.exp(log_kA) if slopes else None
        return G / K, gradient

    def miss(self, log_kA, target):
        """How far ln G/K is off, squared, and its gradient."""
        ratio, gradient = self.ratio(log_kA)
        off = np.log(ratio / target)
        return off**2, 2.0 * off / ratio * gradient

    def miss_alone(self, log_kA, target):
        """The same without the gradient."""
        return np.log(self.ratio(log_kA, slopes=False)[0] / target) ** 2


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
        "ratio": found.ratio(result.x, slopes=False)[0],
        "log_kA": np.round(result.x, 6).tolist(),
        "path": path,
    }


def main():
    first, gradient = Design().ratio(np.zeros(NUMBER))
    h, axis = 1e-3, np.eye(NUMBER)[0]
    high, low = (Design().ratio(sign * h * axis, slopes=False)[0] for sign in (1.0, -1.0))
    print(
        f"G/K = {first:.4f} at kA = 1; slope by ln kA of particle 0: {gradient[0]:.6f}, "
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
