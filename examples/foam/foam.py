"""A wet foam that coarsens: gas diffuses from small bubbles to large ones, and small ones vanish.

Bubbles are relaxed, exchange gas for a short time, and so on: diffusion is slow against relaxation.
"""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy import stats

NUMBER = 400  # bubbles at the start
LAST = 80  # and at the end
PHI = 0.90  # their packing fraction: a tenth of the area is liquid
BUBBLE = ld.Ring(kA=300.0, kP=0.0, tension=1.0, reach=1.0)  # gas behind a surface
FILM, BORDER = 1.0, 0.1  # permeabilities of films and of the liquid around bubbles
STEP = 0.03  # time step, over the mean area of a bubble
SMALLEST = 0.04  # a bubble vanishes at this part of the mean area
TOLERANCE = 1e-3  # of the relaxations


def growth(state):
    """Rate of change of the gas of each bubble, its area at rest; the sum is zero, shape (N,).

        dA_i/dt = -FILM sum over neighbors L_ij (p_i - p_j) - BORDER (P_i - sum L_ij) (p_i - p)

    L_ij is the length of the film, the mean of its two sides, and p the pressure of the gas in the
    liquid, which takes up as much as it gives off.
    """
    p, contacts = state.pressures, state.contacts
    i, j, length = contacts["i"], contacts["j"], contacts["length"]
    through_film = 0.5 * FILM * length * (p[i] - p[j])  # each film has two rows
    free = state.perimeters - np.bincount(i, length, len(p))
    through_liquid = BORDER * free * (p - free @ p / free.sum())
    gained = np.bincount(j, through_film, len(p)) - np.bincount(i, through_film, len(p))
    return gained - through_liquid


def coarsen(sim, state):
    """The states of a foam that coarsens, with their times."""
    time = 0.0
    while len(state.packing) > LAST:
        yield time, state
        packing = state.packing
        gas = np.pi * packing.radii**2
        dt = STEP * gas.mean()
        after = gas + dt * growth(state)
        left = after > SMALLEST * gas.mean()
        after = after[left] * gas.sum() / after[left].sum()  # others take what is left of the rest
        radius = np.sqrt(after / np.pi)
        bubbles = ld.Packing(
            packing.positions[left], radius, packing.box, species=packing.species[left]
        )
        sim.reset(bubbles)
        state = sim.relax(TOLERANCE)
        time += dt
    yield time, state


def rates(state):
    """Numbers of contacts from 3 on, and the mean growth of bubbles that have so many."""
    rate, contacts = growth(state), state.n_contacts
    numbers = [n for n in range(3, contacts.max() + 1) if (contacts == n).sum() > 3]
    return np.array(numbers), np.array([rate[contacts == n].mean() for n in numbers])


def relaxed(phi, width, number):
    """Bubbles at a packing fraction, with a lognormal distribution of radii of this width."""
    loose = ld.polydisperse(number, stats.lognorm(width, scale=0.5), phi=phi, seed=1)
    sim = ld.Simulation(loose.push_off(), BUBBLE)
    return sim, sim.relax(TOLERANCE)


# The foam coarsens.
times, states = zip(*coarsen(*relaxed(PHI, 0.25, NUMBER)), strict=True)
times = np.array(times)
radii = [state.packing.radii for state in states]
square = np.array([radius.mean() ** 2 for radius in radii])
for n in [*range(0, len(states), 15), len(states) - 1]:
    print(
        f"time {times[n]:.2f}  bubbles {len(radii[n])}  mean radius {radii[n].mean():.4f}  "
        f"spread {radii[n].std() / radii[n].mean():.3f}  pressure {states[n].pressure:.4f}  "
        f"gas {np.pi * np.sum(radii[n] ** 2):.6f}"
    )
late = times > times[-1] / 4
slope, start = np.polyfit(times[late], square[late], 1)
left = (square - slope * times - start)[late].std() / square[-1]
print(f"square of the mean radius: {slope:.3f} t + {start:.3f}, to {left:.1%} of the last value")

# Growth by the number of contacts, in drier and drier foams.
fractions, dry, steep = (0.90, 0.94, 0.97, 0.985), 2 * np.pi / 3, []
foams = [relaxed(phi, 0.35, 200)[1] for phi in fractions]
for foam in foams:
    most = foam.n_contacts > 2
    per_contact, at_zero = np.polyfit(foam.n_contacts[most], growth(foam)[most], 1)
    steep.append(per_contact)
    print(f"phi {foam.phi:.4f}  growth {per_contact:.3f} (n - {-at_zero / per_contact:.2f})")
liquid = np.array([1 - foam.phi for foam in foams])
limit, of_two = (np.polyfit(np.sqrt(liquid[-n:]), steep[-n:], 1)[1] for n in (4, 2))
print(f"growth per contact without liquid {limit:.3f}, von Neumann {dry:.3f}")
print(f"extrapolated from the two driest foams {of_two:.2f}")

figure = plt.figure(figsize=(8.4, 5.8), layout="constrained")
top, bottom = figure.subfigures(2, 1, height_ratios=(1.0, 1.0))
axes = top.subplots(1, 3)
for ax, number in zip(axes, (NUMBER, NUMBER // 2, LAST), strict=True):
    n = next(n for n, radius in enumerate(radii) if len(radius) <= number)
    title = f"{len(radii[n])} bubbles, t = {times[n]:.1f}"
    colors = {"color": "contacts", "vmin": 2, "vmax": 10, "cmap": "RdYlBu_r"}
    states[n].plot(ax, title=title, colorbar=False, **colors)
top.colorbar(axes[0].collections[0], ax=axes, label="contacts", shrink=0.8)
growing, sizes, rate = bottom.subplots(1, 3)
growing.plot(times, square)
growing.plot(times, slope * times + start, "k--", linewidth=0.8)
growing.set(xlabel="time", ylabel=r"$\langle R\rangle^2$")
for part in (0, 2, 3):
    chosen = [r / r.mean() for r in radii[part * len(radii) // 4 : (part + 1) * len(radii) // 4]]
    ends = [times[part * len(radii) // 4], times[(part + 1) * len(radii) // 4 - 1]]
    label = f"{ends[0]:.1f} < t < {ends[1]:.1f}"
    sizes.hist(
        np.concatenate(chosen), np.arange(0, 2.7, 0.15), density=True, histtype="step", label=label
    )
sizes.set(xlabel=r"$R/\langle R\rangle$", ylabel="probability density")
sizes.legend(fontsize=7)
for foam in foams:
    rate.plot(*rates(foam), "o-", markersize=3, label=f"phi = {foam.phi:.3f}")
sides = np.array([3, 9])
rate.plot(sides, dry * (sides - 6), "k--", linewidth=0.8, label="von Neumann")
rate.set(xlabel="contacts n", ylabel="dA/dt")
rate.legend(fontsize=7)
figure.savefig("foam.png", dpi=68, pil_kwargs={"optimize": True})
