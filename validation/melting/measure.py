"""Motion of equal droplets in a heat bath, its order, limits that are known, and comparisons."""

import math
import time
from dataclasses import replace

import freud
import lammps_deformable as ld
import numpy as np
from scipy.integrate import simpson
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

from validation.ensembles import once

# Equal droplets in a heat bath: a motion in legs, each of which is kept in a folder.

# Droplets have the radius 1, the line tension 1 and the mass 1, and hardly change their area: hot
# ones that may not change it at all find no shape now and then, which ends a run.
LAW = ld.Ring(kA=30.0, kP=0.0, tension=1.0, contact="curved")
BATH = {"drag": 0.1, "timestep": 0.06, "balance": 1e-4}
STEPS, SAMPLES = 4000, 25  # of a leg
PHI = 0.92


def crystal(number, phi):
    side = math.isqrt(number)
    return ld.crystal("hex", (side, side // 2), radius=1.0, phi=phi)


def spacing(packing):
    """Of the lattice that fits into the box."""
    return packing.box[0, 0] / math.isqrt(len(packing))


def begin(number, phi, start, seed):
    """Positions before the first leg: the crystal, or random ones of droplets that balance."""
    packing = crystal(number, phi)
    if start == "random":
        at = np.random.default_rng(seed).random((number, 2)) @ packing.box
        packing = packing.replace(positions=at).push_off()
        with ld.Simulation(packing, LAW) as sim:
            packing = sim.relax(1e-2).packing
    return packing.positions


def leg(number, phi, temperature, seed, positions, law=LAW, bath=BATH, steps=STEPS):
    """Some thousand steps from given positions: energies, stresses, places and psi_6 of samples.

    Velocities are drawn anew, as the bath would. A droplet may find no shape: then the run ends.
    """
    begun, packing = time.process_time(), crystal(number, phi).replace(positions=positions)
    rows, places, order = [], [], []
    try:
        with ld.Simulation(packing, law) as sim:
            for state in sim.run(
                steps, temperature=temperature, every=steps // SAMPLES, seed=seed, **bath
            )[1:]:
                rows.append(
                    {
                        "energy": state.energy / number,
                        "pressure": state.pressure + number * temperature / packing.volume,
                        "stress": state.pressure_tensor.tolist(),
                        "z": state.coordination,
                        "bath": state.temperature / temperature,
                        "beyond": state.beyond / number,
                    }
                )
                places.append(state.packing.positions)
                order.append(state.hexatic())
    except ld.LammpsError as error:
        return {"ended": str(error), "seconds": time.process_time() - begun}
    return {
        "rows": rows,
        "places": np.array(places),
        "order": np.array(order),
        "seconds": time.process_time() - begun,
    }


def kept(function, arguments, folder):
    """The result of a call, from a folder of pickles that has it."""
    return once(folder, function, *arguments)


# What is measured of the places in a leg: order, its correlations, defects, and elasticity.

BINS = 48  # of the distance, in correlations up to half of the box
SPARED = 5  # correlations are of each fifth sample
SHELLS = 3  # wave vectors of elasticity have up to this many waves in the box


def apart(box, between):
    """Vectors between the nearest images."""
    return between - box * np.rint(between / box)


def neighbors(places, box):
    """Pairs i < j that share a side of their Voronoi cells (Delaunay), with periodic images."""
    places, margin = places % box, 4.0 * math.sqrt(np.prod(box) / len(places))
    shifts = np.array([(x, y) for x in (0, -1, 1) for y in (0, -1, 1)]) * box  # itself first
    images = (places + shifts[:, None]).reshape(-1, 2)
    near = np.flatnonzero(((images > -margin) & (images < box + margin)).all(axis=1))
    corners = near[Delaunay(images[near]).simplices]
    i, j = np.concatenate([corners[:, (0, 1)], corners[:, (1, 2)], corners[:, (2, 0)]]).T
    inside = (i < len(places)) | (j < len(places))
    pairs = np.column_stack([i[inside], j[inside]]) % len(places)
    return np.unique(np.sort(pairs, axis=1), axis=0).T


def defects(pairs, number):
    """Particles without six neighbors, as clusters of neighbors; counts over N.

    A pair of 5 and 7 is a dislocation, two such pairs side by side are bound ones. A cluster whose
    charges, 6 minus the neighbors, do not sum to 0 is a disclination.
    """
    i, j = pairs
    charge = 6 - np.bincount(np.concatenate(pairs), minlength=number)
    wrong = charge[i].astype(bool) & charge[j].astype(bool)
    edges = coo_array((np.ones(wrong.sum()), (i[wrong], j[wrong])), shape=(number, number))
    _, cluster = connected_components(edges, directed=False)
    of = charge != 0
    size = np.bincount(cluster[of], minlength=cluster.max() + 1)
    total = np.bincount(cluster, charge)
    neutral = (total == 0) & (size > 0)
    counts = {
        "defects": of.sum(),
        "dislocations": (neutral & (size == 2)).sum(),
        "bound": (neutral & (size == 4)).sum(),
        "larger": size[neutral & (size != 2) & (size != 4)].sum(),
        "disclinations": (total != 0).sum(),
    }
    return {name: count / number for name, count in counts.items()}


def strongest_wave(places, box, length):
    """Wave vector of about this length with the largest density wave, and that, |rho|^2."""
    most = np.ceil(1.1 * length * box / (2.0 * np.pi)).astype(int)
    m, n = (np.arange(-count, count + 1) for count in most)
    x, y = (np.exp(2j * np.pi * np.outer(c, places[:, d] / box[d])) for d, c in ((0, m), (1, n)))
    waves = np.abs(x @ y.T / len(places)) ** 2
    kx, ky = np.meshgrid(2.0 * np.pi * m / box[0], 2.0 * np.pi * n / box[1], indexing="ij")
    waves[np.abs(np.hypot(kx, ky) / length - 1.0) > 0.1] = 0.0
    best = np.unravel_index(waves.argmax(), waves.shape)
    return np.array([kx[best], ky[best]]), waves[best]


def correlation(places, box, values):
    """Distances up to half of the box, sums of Re conj(a_i) a_j over pairs, numbers of pairs."""
    points = np.column_stack([places % box - 0.5 * box, np.zeros(len(places))])
    found = freud.density.CorrelationFunction(BINS, 0.495 * box.min())
    found.compute(
        (freud.box.Box(*box), points),
        values=values,
        neighbors={"r_max": 0.495 * box.min(), "exclude_ii": True},
    )
    counts = np.array(found.bin_counts)
    return np.array(found.bin_centers), np.array(found.correlation).real * counts, counts


def displacements(places, sites, a):
    """From the nearest sites of the lattice, which drifts with the particles.

    So a row that has slipped by a spacing is back in its lattice.
    """
    lattice = a * np.array([[1.0, 0.0], [0.5, math.sqrt(0.75)]])
    u = (places - sites) @ np.linalg.inv(lattice)  # in lattice vectors
    u -= np.angle(np.exp(2j * np.pi * u).mean(axis=0)) / (2.0 * np.pi)
    near = (u - np.rint(u))[:, None] + [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    near = near @ lattice
    nearest = np.sum(near**2, axis=2).argmin(axis=1)
    u = near[np.arange(len(u)), nearest]
    return u - u.mean(axis=0)


def waves(box):
    """Wave vectors with up to SHELLS waves in the box, without their opposites."""
    m, n = np.mgrid[-SHELLS : SHELLS + 1, -SHELLS : SHELLS + 1].reshape(2, -1)
    some = ((n > 0) | ((n == 0) & (m > 0))) & (m**2 + n**2 <= SHELLS**2)
    return 2.0 * np.pi * np.column_stack([m, n])[some] / box


def softness(displacements, sites, box):
    """A q^2 |u_q|^2 of transverse and longitudinal waves, with u_q = 1/N sum u exp(-i q r).

    Their means are T over the shear modulus, and T over the sum of bulk and shear modulus.
    """
    q = waves(box)
    u = np.exp(-1j * q @ sites.T) @ displacements / len(sites)
    squares = np.sum(q**2, axis=1)
    along = np.abs(np.sum(q * u, axis=1)) ** 2 / squares
    across = np.sum(np.abs(u) ** 2, axis=1) - along
    return np.prod(box) * np.mean(squares[:, None] * np.column_stack([across, along]), axis=0)


def measured(number, phi, places, order):
    """Means over the samples of a leg, and the series of its order."""
    packing = crystal(number, phi)
    box, sites, a = packing.box.diagonal(), packing.positions, spacing(packing)
    psi = order.mean(axis=1)
    peak = 4.0 * np.pi / (math.sqrt(3.0) * a)
    i, j = neighbors(places[0], box)
    first = apart(box, places[0][j] - places[0][i])
    moved = [apart(box, p[j] - p[i]) - first for p in places]
    rows, curves = [], []
    for n, (at, local) in enumerate(zip(places, order, strict=True)):
        wave, bragg = strongest_wave(at, box, peak)
        across, along = softness(displacements(at, sites, a), sites, box)
        rows.append(
            {"bragg": bragg, "across": across, "along": along} | defects(neighbors(at, box), number)
        )
        if n % SPARED == 0:
            r, six, pairs = correlation(at, box, local)
            curves.append((six, correlation(at, box, np.exp(1j * at @ wave))[1], pairs))
    g6, positional, pairs = np.sum(curves, axis=0)
    return {name: float(np.mean([row[name] for row in rows])) for name in rows[0]} | {
        "psi_x": rounded(psi.real),
        "psi_y": rounded(psi.imag),
        "r": rounded(r),
        "g6": quotient(g6, pairs),
        "positional": quotient(positional, pairs),
        "apart": rounded([np.mean(np.sum(d**2, axis=1)) / (2.0 * a**2) for d in moved]),
    }


def quotient(sums, counts):
    with np.errstate(invalid="ignore"):
        return rounded(sums / counts)


def rounded(values):
    """With five digits; null where there is none."""
    return [float(f"{value:.5g}") if math.isfinite(value) else None for value in values]


# What is known exactly, or by other means: the crystal at rest, and gases.


def harmonic(phi, law=LAW):
    """Pressure and moduli of the crystal at rest, and where its dislocations would unbind.

    Kosterlitz, Thouless, Halperin, Nelson and Young: T = Y a^2 / 16 pi with Y = 4 G K / (G + K), of
    the moduli at this temperature. Those at rest give an estimate.
    """
    with ld.Simulation(crystal(64, phi), law) as sim:
        state = sim.relax(1e-8)
        moduli = state.moduli()
    shear, bulk = moduli.mean_shear_modulus, moduli.bulk_modulus
    young = 4.0 * shear * bulk / (shear + bulk)
    unbinding = young * spacing(state.packing) ** 2 / (16.0 * math.pi)
    return {"pressure": state.pressure, "G": shear, "K": bulk, "unbinding": float(unbinding)}


def pair(distances):
    """Energy and virial -r dU/dr of two droplets at distances, from states of both alone."""
    energies, virials = [], []
    for distance in distances:
        places, box = [[0.0, 0.0], [distance, 0.0]], np.diag([12.0, 12.0])
        with ld.Simulation(ld.Packing(places, 1.0, box), LAW) as sim:
            state = sim.state()
        energies.append(state.energy)
        virials.append(2.0 * state.pressure * state.packing.volume)
    return np.array(energies), np.array(virials)


def second_virial(temperature):
    """B_2 = pi integral (1 - exp(-U/T)) r dr, and the same from the virials.

    Within the nearest distance the weight is 0.
    """
    r = np.linspace(1.6, 2.0, 41)
    energy, virial = pair(r)
    weight = np.exp(-energy / temperature)
    by_energy = np.pi * (r[0] ** 2 / 2.0 + simpson((1.0 - weight) * r, x=r))
    by_pressure = np.pi / (2.0 * temperature) * simpson(r * virial * weight, x=r)
    return by_energy, by_pressure


def dilute(phi, temperature=0.02, number=64, steps=20_000):
    """p A / N T of a gas by motion, and by virial coefficients; the third one is that of disks."""
    packing, rows = crystal(number, phi), []
    with ld.Simulation(packing, LAW) as sim:
        for state in sim.run(steps, temperature=temperature, every=10, seed=1, **BATH)[1:]:
            rows.append(1.0 + state.pressure * packing.volume / number / temperature)
    blocks = np.array_split(rows[len(rows) // 10 :], 20)
    found, error = ld.jackknife([block.mean() for block in blocks])
    x = second_virial(temperature)[0] * number / packing.volume
    return {
        "phi": phi,
        "temperature": temperature,
        "z": float(found),
        "error": float(error),
        "virial": float(1.0 + x + 0.782 * x**2),
    }


# Comparisons: other time steps and laws, energies at rest, and polygons.

EXACT = BATH | {"timestep": 0.03, "balance": 1e-8}
SETTINGS = {
    "curved, 0.06, 1e-4": (LAW, BATH, STEPS),
    "curved, 0.03, 1e-8": (LAW, EXACT, 2 * STEPS),
    "balanced, 0.06, 1e-4": (replace(LAW, contact="balanced"), BATH, STEPS),
}

# Laws whose crystal and whose packings with defects have energies to be compared.
LAWS = {
    "droplets": LAW,
    "soft droplets": ld.Ring(kA=3.0, kP=0.0, tension=1.0, contact="curved"),
    "rings": ld.Ring(kA=1.0, contact="curved"),
    "soft rings": ld.Ring(kA=1.0, kP=0.1, contact="curved"),
}


def check(name, temperature, folder, number=256, legs=3):
    """Energy and pressure with one of the settings, from the crystal; the first leg is left out."""
    law, bath, steps = SETTINGS[name]
    positions, rows, seconds = begin(number, PHI, "crystal", 1), [], 0.0
    for n in range(legs):
        call = number, PHI, temperature, n + 1, positions, law, bath, steps
        found = kept(leg, call, folder)
        positions = found["places"][-1]
        seconds += found["seconds"]
        rows.append([(row["energy"], row["pressure"]) for row in found["rows"]])
    (energy, pressure), errors = ld.jackknife(rows[1:], lambda some: np.mean(some, axis=(0, 1)))
    return {
        "settings": name,
        "T": temperature,
        "energy": [float(energy), float(errors[0])],
        "pressure": [float(pressure), float(errors[1])],
        "microseconds": 1e6 * seconds / (legs * steps * number),
    }


def solid(law, phi):
    """Moduli of the crystal at rest, and where its dislocations would unbind with these."""
    return {"law": law, "phi": phi} | harmonic(phi, LAWS[law])


def quench(law, number, phi, positions, start, temperature):
    """Energy of a particle at rest above that of the crystal, order, and part with defects."""
    packing, energies = crystal(number, phi), []
    scaled = positions * packing.box[0, 0] / crystal(number, PHI).box[0, 0]
    for at in (packing.positions, scaled):
        begun = packing.replace(positions=at).push_off()
        with ld.Simulation(begun, LAWS[law]) as sim:
            state = sim.relax(1e-3)
        energies.append(state.energy / number)
    box, places = state.packing.box.diagonal(), state.packing.positions
    return {
        "law": law,
        "phi": phi,
        "start": start,
        "T": temperature,
        "crystal": energies[0],
        "excess": energies[1] / energies[0] - 1.0,
        "psi": float(abs(state.hexatic().mean())),
    } | defects(neighbors(places, box), number)


def polygons(number=16, vertices=76, steps=2000):
    """Processor time of smooth polygons with the same stiffnesses, cold, at constant energy.

    The mass of a particle is shared by its vertices. Steps are the part 1/2 of the time in which
    the fastest vertex would turn by a radian; twice as long ones are unstable.
    """
    model = ld.DeformablePolygon(vertices, radius=0.02, kL=float(vertices), kA=30.0, kr=300.0)
    with ld.Simulation(crystal(number, 0.88), model) as sim:
        fastest = sim.polygons.fastest_frequency(model.kr) * math.sqrt(vertices)
        step = 0.5 / fastest
        sim.lmp.commands_string(
            f"mass * {1.0 / vertices!r}\nvelocity all create 1e-3 1 dist gaussian\n"
            f"fix move all nve\nfix plane all enforce2d\ntimestep {step!r}\nrun 100 post no"
        )
        begun = time.process_time()
        sim.lmp.command(f"run {steps} post no")
        seconds = time.process_time() - begun
    each = 1e6 * seconds / steps / number
    return {"vertices": vertices, "step": step, "microseconds": each}
