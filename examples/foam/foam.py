"""A wet foam that coarsens: gas flows from small bubbles to large ones, and small ones vanish."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy import stats

NUMBER = 400  # bubbles at the start
LAST = 80  # and at the end
PHI = 0.90  # their packing fraction: a tenth of the area is liquid
BUBBLE = ld.Ring(kA=np.inf, kP=0.0, tension=1.0, contact="curved", reach=2.0)
BORDER = 0.02  # thickness of films
TOLERANCE = 1e-3  # of the relaxations


def rates(state):
    """Numbers of contacts from 3 on, and the mean growth of bubbles that have so many."""
    rate, contacts = state.gas_flow(1.0), state.n_contacts
    numbers = [n for n in range(3, contacts.max() + 1) if (contacts == n).sum() > 3]
    return np.array(numbers), np.array([rate[contacts == n].mean() for n in numbers])


def relaxed(phi, width, number):
    """Bubbles at a packing fraction, with a lognormal distribution of radii of this width."""
    loose = ld.polydisperse(number, stats.lognorm(width, scale=0.5), phi=phi, seed=1)
    sim = ld.Simulation(loose.push_off(), BUBBLE)
    return sim, sim.relax(TOLERANCE)


# The foam coarsens.
sim, _ = relaxed(PHI, 0.25, NUMBER)
states = sim.coarsen(
    1.0,
    time=100.0,
    steps=1000,
    border=BORDER,
    tolerance=TOLERANCE,
    callback=lambda state: len(state.packing) <= LAST,
)
times = np.array([state.time for state in states])
radii = [state.radii for state in states]
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
    per_contact, at_zero = np.polyfit(foam.n_contacts[most], foam.gas_flow(1.0)[most], 1)
    steep.append(per_contact)
    print(f"phi {foam.phi:.4f}  growth {per_contact:.3f} (n - {-at_zero / per_contact:.2f})")
liquid = np.array([1 - foam.phi for foam in foams])
limit = np.polyfit(np.sqrt(liquid[-2:]), steep[-2:], 1)[1]  # from the two driest foams
print(f"growth per contact without liquid {limit:.3f}, von Neumann {dry:.3f}")

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
