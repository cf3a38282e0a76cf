"""A relaxation as a function of JAX with a gradient: radii that give packings a pressure.

python in_jax.py
"""

import jax
import lammps_deformable as ld
import numpy as np

jax.config.update("jax_enable_x64", True)
jammed = ld.jam(ld.bidisperse(24, seed=3)).packing
start = jammed.at(jammed.phi + 0.05)
NUMBER = jax.ShapeDtypeStruct((), float)
NUMBERS = jax.ShapeDtypeStruct(start.radii.shape, float)


def at_rest(radii):
    with ld.Simulation(start.replace(radii=np.asarray(radii)), ld.Ring(kP=0.3)) as sim:
        state = sim.relax(1e-9)
    return np.asarray(state.pressure), state.derivatives(by="radii").vjp(pressure=1.0)


@jax.custom_vjp
def pressure(radii):
    return jax.pure_callback(at_rest, (NUMBER, NUMBERS), radii)[0]


def forward(radii):
    return jax.pure_callback(at_rest, (NUMBER, NUMBERS), radii)


pressure.defvjp(forward, lambda slopes, weight: (weight * slopes,))


@jax.jit
def objective(radii):
    return jax.numpy.log(pressure(radii) / 0.002) ** 2


if __name__ == "__main__":
    radii = jax.numpy.array(start.radii)
    for step in range(6):
        off, slopes = jax.value_and_grad(objective)(radii)
        print(f"step {step}: pressure {float(pressure(radii)):.6f}, off {float(off):.2e}")
        radii = radii - 2.0 * off * slopes / jax.numpy.sum(slopes**2)
