"""Two droplets that stick: at rest, pushed together and pulled apart; and a drop on a wall."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

RADIUS = TENSION = 1.0
BOX = (8.0, 8.0, 8.0)
ADHESIONS = (0.05, 0.1, 0.2, 0.3, 0.4)
STEP = 0.001  # of the distance [R]
CLOSEST, FARTHEST = 1.7, 2.2


def two(distance: float) -> ld.Packing:
    """Droplets with their centers at this distance."""
    return ld.Packing([[3.0, 4.0, 4.0], [3.0 + distance, 4.0, 4.0]], RADIUS, BOX)


def truncated(cosine: float) -> float:
    """Radius over R of a ball that has the volume of a droplet after a cap is cut off."""
    cap = (1.0 - cosine) ** 2 * (2.0 + cosine) / 4.0
    return float((1.0 - cap) ** (-1.0 / 3.0))


print("   w  angle   distance  closed form     energy  closed form")
for w in ADHESIONS:
    with ld.Simulation(two(1.95), ld.Droplet(TENSION, adhesion=w)) as sim:
        rest = sim.relax()
    cosine = 1.0 - w / (2.0 * TENSION)
    ball = truncated(cosine)
    row, energy = rest.contacts[0], 8.0 * np.pi * (1.0 / ball - 1.0)
    print(
        f"{w:.2f} {row['contact_angle']:6.3f} {row['distance']:10.5f} {2.0 * ball * cosine:12.5f}"
        f" {rest.energy:10.5f} {energy:12.5f}"
    )

together = np.arange(FARTHEST, CLOSEST, -STEP)
path = np.append(together, together[::-1])
print("\n   w  largest pull  at distance  energy at touch  where torn  work of a cycle")
curves = {}
for w in ADHESIONS[1::2]:
    with ld.Simulation(two(path[0]), ld.Droplet(TENSION, adhesion=w)) as sim:
        sim.lmp.command("group second id 2")
        force, energy = [], []
        for step in np.append(0.0, np.diff(path)):
            sim.lmp.command(f"displace_atoms second move {step:.9f} 0 0 units box")
            state = sim.state()
            force.append(float(state.contacts["force"][0]) if len(state.contacts) else 0.0)
            energy.append(state.energy)
    curves[w] = force
    at = int(np.argmin(force))
    touch = int(np.flatnonzero(force)[0])
    work = -float(np.sum(0.5 * np.diff(path) * (np.array(force[1:]) + np.array(force[:-1]))))
    print(
        f"{w:.2f} {-force[at]:13.4f} {path[at]:12.3f} {energy[touch]:16.4f} {energy[at]:11.4f}"
        f" {work:16.4f}"
    )

print("\n   w  angle   height  closed form   film  closed form")
films = []
for w in (0.05, 0.1, 0.15, 0.2):
    floor = ld.Plane((0, 0, 1), (0, 0, 1), adhesion=w)
    lid = ld.Plane((0, 0, 7), (0, 0, -1))
    drop = ld.Packing([[4.0, 4.0, 1.97]], RADIUS, BOX, walls=(floor, lid))
    with ld.Simulation(drop, ld.Droplet(TENSION)) as sim:
        row = sim.relax().contacts[0]
    cosine = 1.0 - w / TENSION
    ball, sine = truncated(cosine), np.sqrt(1.0 - cosine**2)
    films.append((row["contact_angle"], row["facet_radius"]))
    print(
        f"{w:.2f} {row['contact_angle']:6.3f} {row['distance']:8.5f} {ball * cosine:12.5f}"
        f" {row['facet_radius']:6.4f} {ball * sine:12.4f}"
    )

figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
for n, (w, force) in enumerate(curves.items()):
    for part, style in ((slice(0, len(together)), ":"), (slice(len(together), None), "-")):
        left.plot(
            path[part], force[part], style, color=f"C{n}", label=f"w = {w}"[: 9 * (style == "-")]
        )
left.axhline(0.0, color="0.6", linewidth=0.8)
left.set(
    xlabel="distance of centers [R]", ylabel="force [γR]", title="pushed (dotted), pulled apart"
)
left.legend()
angle = np.linspace(0.0, 0.9, 100)
right.plot(angle, [truncated(np.cos(each)) * np.sin(each) for each in angle], label="cut sphere")
right.plot(*zip(*films, strict=True), "o", label="droplet on a wall")
right.set(xlabel="contact angle", ylabel="radius of the film [R]", title="a drop on a wall")
right.legend()
figure.savefig("doublet.png", dpi=120)
