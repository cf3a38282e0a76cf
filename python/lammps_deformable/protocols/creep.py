"""Creep: a shear stress that stays, under which the box shears."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ..common.errors import ParameterError
from ..common.steps import Steps
from ..common.validate import count, expect, finite, positive
from ..engine.deforming import Deforming, S
from ..engine.droplet_simulation import DropletSimulation
from ..engine.simulation import Simulation
from .flow import flow, flow_dynamics, leans
from .shear import refuse_walls

# LAMMPS' pressure tensor has the opposite sign of a stress that resists shear.
_COURSE = """
fix deformable_flow all deform/pressure 1 xy pressure {target!r} {gain!r} max/rate {most!r} remap x
fix_modify deformable_flow press deformable_virial
"""


def creep(
    sim: Deforming[S],
    stress: float,
    time: float,
    steps: int = 10,
    friction: float | None = None,
    viscosity: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> Iterator[S]:
    """Apply a shear stress, and let the box shear along x.

    The box follows the stress that the contacts do not bear, against a liquid of some viscosity,

        viscosity d(strain)/dt = stress - sigma

    with sigma the `shear_stress` of the state. Particles move in it as in `shear` at a rate. Below
    the yield stress the strain ends where sigma is the stress; above it the packing flows. LAMMPS'
    *fix deform/pressure* with *remap x* shears the box, *fix brownian* moves the particles.

    Args:
        sim: of the law `Ring` or `Droplet`, without walls; it ends in the last state.
        stress: shear stress, of either sign [energy/length^d].
        time: in all [time].
        steps: number of states, after equal parts of the time.
        friction: as in `shear` at a rate, must be given [1/time].
        viscosity: of the liquid, in d dimensions [length^(2-d)/time]; if not
            given the friction, in space over the mean diameter.
        temperature: as in `shear`.
        timestep: as in `shear`.
        seed: as in `shear`.

    Yields:
        The states, with their `strain` and `time`.

    Raises:
        ParameterError: see `shear`; or the box has a tilt yz.
        LammpsError: see `move`.
    """
    expect("sim", sim, Simulation, DropletSimulation)
    refuse_walls(sim)
    stress, time, steps = finite("stress", stress), positive("time", time), count("steps", steps)
    if leans(sim):
        raise ParameterError(
            f"a box that leans along y, by yz = {leans(sim):.4g}, does not creep: take one without "
            "that tilt, or shear it at a rate"
        )
    sim, dynamics = flow_dynamics(sim, friction, temperature, timestep, None, seed)
    given = None if viscosity is None else positive("viscosity", viscosity)
    before = sim.strain or 0.0

    def states() -> Iterator[S]:
        start = sim.state()
        held, radius = start.shear_stress, float(start.packing.radius.mean())
        usual = dynamics.friction / (1.0 if sim.dimension == 2 else 2.0 * radius)
        viscosity = given or usual
        fastest = 2.0 * (abs(stress) + abs(held)) / viscosity
        if fastest == 0.0:
            raise ParameterError("stress must not be 0 in a packing that has none")
        most = fastest * float(sim.box[1, 1])  # velocity of the upper side of the box
        course = _COURSE.format(target=-stress, gain=1.0 / viscosity, most=most).strip()
        damped = replace(dynamics, part=min(1.0, viscosity / usual))
        duration, unknown = time / steps, [None] * steps
        yield from flow(sim, damped, fastest, duration, unknown, lambda _: course, seed)

    return Steps("creep", states(), lambda: replace(sim.state(), strain=before))
