"""An emulsion that flocculates: droplets in a heat bath stick where they meet.

How much sticks for each adhesion, and the angles at which droplets meet, off their outlines.
"""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

ADHESIONS = (0.02, 0.05, 0.1, 0.15, 0.2)  # over the tension
NUMBER = 100  # droplets, with radii of 0.45 to 0.55
PHI = 0.4
STEPS = 6000
TIMESTEP = 0.02  # contacts are stiff: 10 to 30 times the pressure, which is 2 here
TEMPERATURE, FRICTION = 0.02, 0.3


def droplet(adhesion):
    """Conserves its area, and has a tension of 1."""
    return ld.Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved", adhesion=adhesion)


def free_droplets(seed):
    """At random positions, where they do not touch."""
    radius = np.random.default_rng(seed).uniform(0.45, 0.55, NUMBER)
    start = ld.bidisperse(NUMBER, phi=PHI, seed=seed)
    box = start.box * np.sqrt(np.pi * np.sum(radius**2) / PHI / np.linalg.det(start.box))
    place = start.positions @ np.linalg.solve(start.box, box)
    species = np.zeros(NUMBER, int)
    return ld.Packing(place, radius, box, species=species).push_off()


def films_of(state):
    """Of each film both sides, as rows of the contact table."""
    return state.contacts[state.contacts["attached"]]


def floc_sizes(state):
    """Number of droplets in each floc; a droplet by itself is one of 1."""
    films, number = films_of(state), len(state.packing)
    joined = coo_array((np.ones(len(films)), (films["i"], films["j"])), shape=(number, number))
    return np.bincount(connected_components(joined, directed=False)[1])


def binding_energy(adhesion):
    """Of two droplets of the mean radius, to their state at rest."""
    two = ld.Packing([[0, 0], [0.99, 0]], 0.5, 4 * np.eye(2))
    with ld.Simulation(two, droplet(adhesion)) as sim:
        return -sim.relax().energy


def centers(outline, corners):
    """After each corner, the center of the circle through the points up to the next corner."""
    found = np.full((len(corners), 2), np.nan)
    for n, (first, last) in enumerate(zip(corners, np.roll(corners, -1), strict=True)):
        points = np.roll(outline, -first - 1, axis=0)[: (last - first) % len(outline) - 1]
        if len(points) > 2:  # x^2 + y^2 = 2 x x0 + 2 y y0 + constant
            terms = np.column_stack([2 * points, np.ones(len(points))])
            found[n] = np.linalg.lstsq(terms, np.sum(points**2, axis=1))[0][:2]
    return found


def normals_at_ends(outline, film, sharp):
    """Normals of the free outline at the begin and at the end of its film, counterclockwise.

    Free outlines of droplets at rest are arcs of circles. Films begin and end at the corners.
    """
    edge = np.roll(outline, -1, axis=0) - outline
    direction = np.arctan2(edge[:, 1], edge[:, 0])
    turn = (direction - np.roll(direction, 1) + np.pi) % (2 * np.pi) - np.pi
    corners = np.flatnonzero(turn > sharp)
    circle = centers(outline, corners)
    apart = outline[corners] - film["position"]
    along = apart @ [-np.sin(film["angle"]), np.cos(film["angle"])]
    distance = np.hypot(*apart.T)
    begin = np.argmin(np.where(along < 0, distance, np.inf))
    end = np.argmin(np.where(along > 0, distance, np.inf))
    before, after = outline[corners[begin]] - circle[begin - 1], outline[corners[end]] - circle[end]
    return before / np.hypot(*before), after / np.hypot(*after)


def measured_angles(state, theta):
    """Half of the angle between two outlines, at each end of each film [rad]."""
    ends = {}
    for film in films_of(state):
        i, j, image = film["i"], film["j"], tuple(film["image"])
        ends[i, j, image] = normals_at_ends(state.outlines[i], film, 0.5 * theta)
    angles = []
    for (i, j, image), (before, after) in ends.items():
        if i < j:
            other_before, other_after = ends[j, i, tuple(-n for n in image)]
            for one, two in ((before, other_after), (after, other_before)):
                angles.append(0.5 * np.arccos(-one @ two))
    return np.array(angles)


def flocculate(adhesion, seed=1):
    """The states of a motion in the bath, and the last one relaxed."""
    with ld.Simulation(free_droplets(seed), droplet(adhesion)) as sim:
        states = sim.run(
            STEPS,
            timestep=TIMESTEP,
            temperature=TEMPERATURE,
            drag=FRICTION,
            every=STEPS // 20,
            seed=seed,
        )[1:]
        return states, sim.relax()


def main():
    figure, axes = plt.subplots(2, 2, figsize=(8, 8.2), layout="constrained")
    shown = dict(zip((ADHESIONS[0], ADHESIONS[-3], ADHESIONS[-1]), axes.flat, strict=False))
    films, sizes = [], []
    for adhesion in ADHESIONS:
        states, last = flocculate(adhesion)
        late = states[len(states) // 2 :]
        films.append(np.mean([len(films_of(state)) / NUMBER for state in late]))
        # of the floc that a droplet is in
        sizes.append(np.mean([np.sum(floc_sizes(state) ** 2) / NUMBER for state in late]))
        theta = np.arccos(1 - adhesion / 2)
        angles = np.degrees(measured_angles(last, theta))
        known = angles[np.isfinite(angles)]
        print(
            f"adhesion {adhesion:.2f}  binding {binding_energy(adhesion) / TEMPERATURE:.2f}  "
            f"films {films[-1]:.2f}  floc {sizes[-1]:.1f}  angle {np.degrees(theta):.3f}  "
            f"outlines {known.min():.3f} to {known.max():.3f} at {len(known)} of {len(angles)} ends"
        )
        if adhesion in shown:
            last.plot(shown[adhesion], title=f"w = {adhesion}", colorbar=False)
    left, right = axes[1, 1], axes[1, 1].twinx()
    left.plot(ADHESIONS, films, "o-", color="C0")
    left.set(xlabel="w [tension]", xlim=(0, None), ylim=(0, 6))
    left.set_ylabel("films of a droplet", color="C0")
    right.plot(ADHESIONS, sizes, "s-", color="C1")
    right.set(ylim=(0, None))
    right.set_ylabel("droplets in its floc", color="C1")
    figure.savefig("flocs.png", dpi=72, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    main()
