"""Two droplets bounce: head on with damping, and off center with friction and spins."""

import lammps_deformable as ld
import matplotlib.pyplot as plt
import numpy as np

SPEED, STEP = 1e-4, 0.002
MASS = RADIUS = TENSION = 1.0
STIFFNESS = 2 * np.pi * TENSION / (3 * RADIUS)  # of two droplets, for small indentations
DAMPING = [0.1, 0.3, 0.6, 1.0, 1.5, 2.0]
FRICTION = [0.1, 0.3]
SLOPES = np.arange(0.0, 4.1, 0.5).tolist()  # sideways over approach

BOX, GAP = (12.0, 6.0), 1e-4
DROPLET = ld.Ring(kA=np.inf, kP=0.0, tension=TENSION, contact="curved")


def collide(friction: ld.Friction, sideways: float = 0.0) -> tuple[float, float, float]:
    """Velocities apart and sideways after a collision, in units of those before; energy error.

    Sideways is the velocity at the contact, with what spins add to it.
    """
    x = BOX[0] / 2 + np.array([-1, 1]) * (RADIUS + GAP / 2)
    two = ld.Packing([[x[0], BOX[1] / 2], [x[1], BOX[1] / 2]], RADIUS, BOX)
    with ld.Simulation(two, DROPLET, friction=friction) as sim:
        for atom, sign in ((1, SPEED), (2, -SPEED)):
            sim.lmp.command(f"set atom {atom} vx {sign!r} vy {sign * sideways!r}")
        before = sim.state().kinetic_energy
        state = sim.run(4000, timestep=STEP)[-1]
    after = state.kinetic_energy + state.energy + state.spring_energy + state.lost_energy
    (u1, v1), (u2, v2) = (state.velocities / SPEED).tolist()
    spins = state.spins / SPEED
    return (u2 - u1) / 2, (v1 - v2 + RADIUS * spins.sum()) / 2, after / before - 1


def restitution(damp: float) -> float:
    """Spring and dashpot, until the force of the contact ends (Schwager and Poeschel 2007)."""
    b = damp / MASS
    w = np.sqrt(2 * STIFFNESS / MASS - b**2)
    return float(np.exp(-b / w * (np.pi - np.arctan2(2 * b * w, w**2 - b**2))))


print("damp   restitution   closed form   energy error")
found = []
for damp in DAMPING:
    apart, _, error = collide(ld.Friction(0.0, kt=1.0, damping=damp))
    found.append(apart)
    print(f"{damp:.1f} {apart:13.4f} {restitution(damp):13.4f} {error:14.1e}")

print("\n mu   sideways before   after   if it slides all the time   energy error")
after: dict[float, list[float]] = {}
for mu in FRICTION:
    for slope in SLOPES:
        rough = ld.Friction(mu, kt=0.5 * STIFFNESS, damping=0.3)
        apart, sideways, error = collide(rough, slope)
        # the impulse mu (1 + e) changes the velocity of a disk by itself, its spin by twice that
        slid = slope - 3 * mu * (1 + apart)
        after.setdefault(mu, []).append(sideways)
        print(f"{mu:.1f} {slope:17.2f} {sideways:7.3f} {slid:27.3f} {error:14.1e}")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
fine = np.linspace(0, 2.04, 200)
left.plot(fine, [restitution(damp) for damp in fine], color="0.5", label="closed form")
left.plot(DAMPING, found, "o", label="two droplets")
left.set(xlabel="damping $g_n$", ylabel="coefficient of restitution")
left.legend()
for n, mu in enumerate(FRICTION):
    right.plot(SLOPES, after[mu], "o", color=f"C{n}", label=f"$\\mu$ = {mu}")
    slide = np.array(SLOPES) - 3 * mu * (1 + restitution(0.3))
    right.plot(SLOPES, slide, color=f"C{n}", linewidth=1)
right.axhline(0, color="0.7", linewidth=0.8, zorder=0)
right.set(xlabel="velocity sideways over approach, before", ylabel="after", ylim=(-1, 3.5))
right.legend()
figure.savefig("restitution.png", dpi=130)
