"""Drops on a floor and below a ceiling, in space, beside their exact shapes."""

from functools import cache
from typing import NamedTuple

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

# Drops have the radius 1 at rest and a tension of 1, so that their weight is 4 pi/3 times the Bond
# number, the difference of densities times g R^2/tension. That of drops that hang is negative here.
WEIGHT = 4.0 * np.pi / 3.0
ADHESIONS = (0.02, 0.08, 0.16, 0.235)  # of the wall, which drops meet at cos(angle) = 1 - w
SHOWN = 0.16  # of the shapes in the picture
BONDS = (0.0, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2)
STEP = 0.005  # of the Bond number where a drop falls
FLOOR, CEILING = 1.0, 7.0


class Drop(NamedTuple):
    """Bond number, height of the center over the film, radius of the film, energy of surfaces."""

    bond: float
    height: float
    film: float
    energy: float


def young_laplace(beta: float, w: float) -> tuple[np.ndarray, Drop | None]:
    """The shape of a drop (r, z) by its arc from the apex, and the drop; it hangs for beta < 0.

    Bashforth and Adams: p' = 2 + beta z - sin(p)/r of the slope p, in units of the radius at the
    apex. The drop ends where p = pi - angle: nowhere if the neck is too thin, and then it is None.
    """
    cosine = 1.0 - w

    def along(_: float, y: np.ndarray) -> tuple[float, ...]:
        r, z, p = y[:3]
        disk = np.pi * r**2 * np.sin(p)
        bend = 2.0 + beta * z - (np.sin(p) / r if r else 1.0)
        return np.cos(p), np.sin(p), bend, disk, disk * z, 2.0 * np.pi * r

    def meets(_: float, y: np.ndarray) -> float:
        return y[2] + np.arccos(cosine) - np.pi

    meets.terminal = True
    arc = solve_ivp(along, (0.0, 4.0), np.zeros(6), "DOP853", events=meets, rtol=1e-10, atol=1e-12)
    r, z, _, volume, moment, area = arc.y[:, -1]
    unit = (volume / WEIGHT) ** (1.0 / 3.0)
    shape = np.array([arc.y[0], z - arc.y[1]]) / unit
    if not arc.t_events[0].size:
        return shape, None
    energy = (area + cosine * np.pi * r**2) / unit**2 - 4.0 * np.pi
    return shape, Drop(beta * unit**2, (z - moment / volume) / unit, r / unit, energy)


@cache
def where_it_falls(w: float) -> float:
    """The largest |beta| of a drop that hangs."""
    low, high = 0.0, 1.0
    while high - low > 1e-7:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if young_laplace(-middle, w)[1] else (low, middle)
    return low


def exact(bond: float, w: float) -> tuple[np.ndarray, Drop]:
    """Shape and drop of a Bond number."""
    ends = (-where_it_falls(w), 0.0) if bond < 0.0 else (0.0, 2.0 * bond + 0.01)
    return young_laplace(brentq(lambda b: young_laplace(b, w)[1].bond - bond, *ends), w)


def drops(bonds, w: float) -> list[Drop]:
    """The droplet of the law, which goes on from one Bond number to the next until it falls."""
    hangs = min(bonds) < 0.0
    floor = ld.Plane((0, 0, FLOOR), (0, 0, 1), adhesion=0.0 if hangs else w)
    ceiling = ld.Plane((0, 0, CEILING), (0, 0, -1), adhesion=w if hangs else 0.0)
    z = CEILING - 0.99 if hangs else FLOOR + 0.99
    state = ld.Packing([[4.0, 4.0, z]], 1.0, (8.0, 8.0, 8.0), walls=(floor, ceiling))
    found = []
    for bond in bonds:
        weight = WEIGHT * abs(bond)
        with ld.Simulation(state, ld.Droplet(1.0), gravity=(0, 0, -weight)) as sim:
            state = sim.relax()
        (row,) = state.contacts
        if hangs and row["j"] != -2:
            break
        energy = state.energy - weight * state.packing.positions[0, 2]
        found.append(Drop(bond, row["distance"], row["facet_radius"], energy))
    return found


def moment(film):
    """By which the center of a drop is above that of the sphere that goes on behind its film."""
    return 0.25 * np.pi * film**4 / WEIGHT


def draw(axes: plt.Axes) -> None:
    """Shapes, and the centers and films of the law, of a drop on the floor and one that hangs."""
    for place, bond in ((0.0, 0.0), (2.4, 0.1), (4.8, -0.1)):
        (drop,) = drops([bond], SHOWN)
        radius, height = exact(bond, SHOWN)[0]
        up = np.array([1.0, -1.0][bond < 0.0])
        for side in (-1.0, 1.0):
            axes.plot(place + side * radius, up * height, "k", lw=1)
        axes.plot(place + drop.film * np.array([-1, 1]), [0, 0], "C3", lw=4)
        axes.plot(place, up * drop.height, "C3o", ms=4)
        axes.text(place, up * 1.3, f"Bo = {bond:g}", ha="center", va="center")
    axes.axhline(0.0, color="0.6", lw=1, zorder=0)
    axes.set(aspect="equal", xlabel="x [R]", ylabel="z [R]", title=f"shapes, w = {SHOWN}")


def main() -> None:
    figure, (left, middle, right) = plt.subplots(
        1, 3, figsize=(11.0, 3.8), width_ratios=(1.3, 1, 1), layout="constrained"
    )
    draw(left)
    print("    w      Bo   height    exact   sphere     film    exact    energy     exact")
    falls = []
    for n, w in enumerate(ADHESIONS):
        last = young_laplace(-where_it_falls(w), w)[1]
        hangs = drops([-bond for bond in BONDS if bond < -0.9 * last.bond], w)
        pulled = drops(last.bond * np.arange(0.8, 1.1, STEP), w)
        falls.append((pulled[-1], last))
        for drop in hangs[:0:-1] + drops(BONDS, w):
            judge = exact(drop.bond, w)[1]
            sphere = judge.height - moment(judge.film)
            print(
                f"{w:.3f} {drop.bond:7.2f} {drop.height:8.4f} {judge.height:8.4f} {sphere:8.4f}"
                f" {drop.film:8.4f} {judge.film:8.4f} {drop.energy:9.5f} {judge.energy:9.5f}"
            )
        betas = np.append(
            where_it_falls(w) * (np.linspace(0, 1, 40) ** 2 - 1), np.linspace(0, 0.24, 40)
        )
        bond, height, film, _ = np.transpose([young_laplace(beta, w)[1] for beta in betas])
        color = plt.get_cmap("viridis")(n / len(ADHESIONS))
        found = np.transpose([pulled[-1], *hangs[:0:-1], *drops(BONDS, w)])
        for axes, row, lines in (
            (middle, 2, {"-": film}),
            (right, 1, {"-": height, ":": height - moment(film)}),
        ):
            for style, line in lines.items():
                axes.plot(bond, line, color=color, ls=style, lw=1)
            axes.plot(found[0], found[row], "os^D"[n], color=color, ms=4, label=f"w = {w}")
            axes.plot(*np.transpose([(bond[0], lines["-"][0])]), "x", color=color)
    print("\n    w  falls at    exact     film    exact    energy     exact")
    for w, (drop, judge) in zip(ADHESIONS, falls, strict=True):
        print(
            f"{w:.3f} {-drop.bond:9.4f} {-judge.bond:8.4f} {drop.film:8.4f} {judge.film:8.4f}"
            f" {drop.energy:9.5f} {judge.energy:9.5f}"
        )
    middle.set(ylabel="radius of the film [R]", title="film")
    right.set(ylabel="center above the film [R]", title="center")
    for axes in (middle, right):
        axes.set(xlabel="Bond number (< 0: it hangs)")
    middle.legend(frameon=False)
    figure.savefig("wetting.png", dpi=100)


if __name__ == "__main__":
    main()
