"""Droplets that stick: doublets and chains at rest, pushed together and pulled apart."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

RADIUS = TENSION = 1.0
ANGLES = (0.1, 0.3, 0.5, 0.7)  # between a film and the free surface
NUMBERS = (2, 3, 6)  # droplets of a chain
STEP = 0.001  # of the distance [R]
SHALLOW, FARTHEST = 0.1, 2.3  # of distances, from so much below that at rest [R]
COLORS = plt.get_cmap("viridis")(np.linspace(0.0, 0.8, len(ANGLES)))


def adhesion(angle: float) -> float:
    """Of droplets that meet at this angle with their film, of the tension 2 T cos(angle)."""
    return float(2.0 * TENSION * (1.0 - np.cos(angle)))


def row(number: int, distance: float) -> ld.Packing:
    """Droplets in a row along x, with their centers at this distance."""
    x = 2.0 + distance * np.arange(number)
    positions = np.column_stack([x, np.full((number, 2), 4.0)])
    return ld.Packing(positions, RADIUS, (2.0 * number + 4.0, 8.0, 8.0))


def truncated(angle: float, films: int) -> float:
    """Radius over R of a ball that has the volume of a droplet after its caps are cut off."""
    cap = (1.0 - np.cos(angle)) ** 2 * (2.0 + np.cos(angle)) / 4.0
    return float((1.0 - films * cap) ** (-1.0 / 3.0))


def rest(number: int, angle: float) -> tuple[float, float]:
    """Length and energy of a row whose droplets are balls without caps: 1 at the ends, 2 inside."""
    balls = np.array(
        [truncated(angle, 1), *[truncated(angle, 2)] * (number - 2), truncated(angle, 1)]
    )
    length = np.cos(angle) * np.sum(balls[1:] + balls[:-1])
    return float(length), float(4.0 * np.pi * np.sum(1.0 / balls - 1.0))


def show_rest() -> None:
    print("angle      w  droplets    length  closed form     energy  closed form")
    for angle in ANGLES:
        for number in NUMBERS:
            law = ld.Droplet(TENSION, adhesion=adhesion(angle))
            with ld.Simulation(row(number, 1.95), law) as sim:
                state = sim.relax()
            x = state.packing.positions[:, 0]
            length, energy = rest(number, angle)
            print(
                f"{angle:5.1f} {adhesion(angle):6.4f} {number:9d} {np.ptp(x):9.5f} {length:12.5f}"
                f" {state.energy:10.5f} {energy:12.5f}"
            )


def cycle(films: int, angle: float) -> np.ndarray:
    """Distance of neighbors, force and energy of a droplet, pushed together and pulled apart.

    Of a doublet, where each droplet has 1 film, or of a row without ends, where it has 2.
    """
    number = 2 * films
    nearest = 2.0 * truncated(angle, films) * np.cos(angle) - SHALLOW
    steps = round((FARTHEST - nearest) / STEP)
    start = row(number, FARTHEST)
    if films == 2:
        start = start.replace(box=(number * FARTHEST, 8.0, 8.0))
    found = []
    with ld.Simulation(start, ld.Droplet(TENSION, adhesion=adhesion(angle))) as sim:
        sim.lmp.command("group second id 2")
        for distance, move in zip(
            FARTHEST - STEP * np.append(np.arange(steps), np.arange(steps, -1, -1)),
            np.repeat([0.0, -STEP, STEP], [1, steps, steps]),
            strict=True,
        ):
            if films == 1:
                sim.lmp.command(f"displace_atoms second move {move:.9f} 0 0 units box")
            else:
                sim.deform(np.diag([number * distance, 8.0, 8.0]))
            state = sim.state()
            forces = state.contacts["force"]
            force = float(forces[0]) if len(forces) else 0.0
            found.append((distance, force, state.energy / number))
    return np.transpose(found)


def main() -> None:
    show_rest()
    figure, panels = plt.subplots(1, 2, figsize=(9.0, 3.6), sharey=True, layout="constrained")
    print("\nfilms  angle     touch    energy    least  distance    energy    jumps      work")
    for films, axes in zip((1, 2), panels, strict=True):
        for angle, color in zip(ANGLES, COLORS, strict=True):
            distance, force, energy = cycle(films, angle)
            middle = len(force) // 2
            touch, torn = int(np.flatnonzero(force)[0]), int(np.flatnonzero(force)[-1])
            # of a droplet: half of each of its films
            work = -0.5 * films * np.trapezoid(force, distance)
            print(
                f"{films:5d} {angle:6.1f} {force[touch]:9.4f} {energy[touch]:9.5f}"
                f" {force[torn]:8.4f} {distance[torn]:9.4f} {energy[torn]:9.5f}"
                f" {energy[torn] - energy[touch]:8.5f} {work:9.5f}"
            )
            for part, style in ((slice(0, middle), ":"), (slice(middle, None), "-")):
                label = f"θ = {angle}" if style == "-" else None
                axes.plot(distance[part], force[part], style, color=color, label=label)
        axes.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
        axes.set(xlabel="distance of centers [R]", title=("doublet", "row without ends")[films - 1])
    panels[0].set(ylabel="force [γR]")
    panels[1].legend(frameon=False)
    figure.savefig("doublet.png", dpi=100)


if __name__ == "__main__":
    main()
