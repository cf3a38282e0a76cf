"""Motion in time: at constant energy, in a heat bath, damped, or overdamped."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.progress import progress
from ..common.steps import Steps
from ..common.validate import count, expect, number_or_nan, positive
from ..core import unit_vectors
from ..engine.close_balance import balanced_to
from ..engine.deforming import Deforming, S
from ..engine.droplet_simulation import DropletSimulation
from ..engine.lammps import gather, run
from ..engine.simulation import Simulation
from ..model.plane import refuse_space
from ..state.state import State
from .dynamics import (
    Dynamics,
    advance,
    dynamics_of,
    moving,
    refuse_restarted,
    refuse_second_motion,
    seeds,
)

# Default number of steps between states.
_EVERY = 100

# The default time step becomes shorter where it is more than this part of the longest stable one.
_ENOUGH = 0.5


def move(
    sim: Deforming[S],
    steps: int,
    timestep: float | None = None,
    temperature: float | None = None,
    friction: float = 0.0,
    every: int | None = None,
    seed: int | None = None,
    inertia: bool = True,
    propulsion: float | None = None,
    persistence: float | None = None,
    tolerance: float | None = None,
) -> Iterator[S]:
    """Let particles of mass 1 move by their forces F.

        dv/dt = F - friction v + sqrt(2 friction temperature) noise

    Without friction the energy is conserved (velocity Verlet, LAMMPS' *fix nve*); with friction
    alone the motion is damped; with both the particles are in a heat bath (Langevin, *fix gjf*).
    Without inertia they are overdamped, or Brownian (Euler's method, *fix brownian*),

        friction dr/dt = F + sqrt(2 friction temperature) noise

    and diffuse freely by <r^2> = 2 d (temperature/friction) t in d dimensions. Then velocities are
    0 in all states.

    In the plane, with a propulsion each particle adds to F a force of this size along its
    direction, which diffuses (*fix deformable/propel* of this package). Without contacts and noise
    its speed is v = propulsion/friction, and in overdamped motion, with the persistence time tau,

        <r^2> = 2 v^2 tau (t - tau (1 - exp(-t/tau)))

    Args:
        sim: of the law `Ring` or `Droplet`; it ends in the last state.
        steps: number of time steps, where other protocols count states.
        timestep: length of a step [time]; if not given, a fifth of the longest stable one, which
            depends on the pressure in particles, or the load of droplets, and on the temperature;
            where these grow, steps become shorter. Give one if other forces than those of contacts,
            by fixes of `sim.lmp`, move particles that are at rest.
        temperature: of the heat bath if there is friction, and of initial velocities [energy].
            These are Maxwell's, with zero total momentum. A bath draws them where all particles are
            at rest, as after `relax`; others go on with the velocities that they have.
            If not given, none are drawn: the velocities are those of the simulation.
        friction: rate at which velocities decay, or force over velocity [1/time].
        every: number of steps between states, a divisor of `steps`; if not given 100, or all steps
            if there are fewer.
        seed: of velocities and noise, together with the number of steps of LAMMPS so far: a second
            call draws others. The noise also depends on the number of ranks. If not given, none
            is ever drawn again.
        inertia: whether particles have some; without, they need a friction.
        propulsion: force with which particles propel themselves, above 0 [energy/length]; they
            need a friction.
        persistence: time tau in which their directions n forget the first one, <n(t).n(0)> =
            exp(-t/tau), above 0 [time]; infinite for directions that stay.
        tolerance: largest imbalance of a `balanced` or `curved` contact over the largest force, in
            steps and states; 1e-8 if not given. In a hot bath 1e-4 halves the time of `curved`.

    Yields:
        The state after each `every` steps, with its `velocities`, the `time` of all calls of `move`
        for this simulation and, with a propulsion, the `directions`, which go on in further calls.

    Raises:
        ParameterError: a value is out of range, the time step is too long for the contacts, the law
            is `Sector`, whose energy jumps, or another `move` of this simulation has not ended.
        LammpsError: particles overlap too much, at the start (`push_off` helps) or later; or the
            simulation was restarted between two states.

    Source: heat bath: Gronbech-Jensen and Farago, Mol. Phys. 111, 983 (2013), and Jensen and
    Gronbech-Jensen, Mol. Phys. 117, 2511 (2019); velocity Verlet: Swope et al., J. Chem. Phys. 76,
    637 (1982).
    """
    expect("sim", sim, Simulation, DropletSimulation)
    dynamics = dynamics_of(sim, temperature, friction, inertia, timestep, seed)
    dynamics = _propelled(dynamics, propulsion, persistence, sim.dimension)
    if tolerance is not None and not positive("tolerance", tolerance) < 1.0:
        raise ParameterError(f"tolerance must be below 1, not {tolerance}")
    steps = count("steps", steps)
    every = min(steps, _EVERY) if every is None else count("every", every)
    if temperature and not friction and sim.lmp.get_natoms() < 2:
        raise ParameterError(
            "a single particle has no temperature without a heat bath: give it friction"
        )
    if steps % every:
        raise ParameterError(
            f"steps must be a multiple of every, not {steps} and {every}: give another every"
        )
    start = cache(lambda: _start(sim, dynamics, seed))
    return Steps("move", _move(sim, dynamics, steps, every, seed, tolerance, start), start)


def _propelled(
    dynamics: Dynamics, propulsion: float | None, persistence: float | None, dimension: int
) -> Dynamics:
    """The dynamics with a propulsion, if there is one.

    Raises:
        ParameterError: one of both values is missing or out of range; or there is no friction, or
            there are three dimensions.
    """
    if propulsion is None and persistence is None:
        return dynamics
    refuse_space("a propulsion", dimension, "take LAMMPS' fix propel/self by `sim.lmp`")
    if propulsion is None or persistence is None:
        raise ParameterError("give propulsion and persistence, or none of them")
    force = positive("propulsion", propulsion)
    if number_or_nan(persistence) != math.inf:
        persistence = positive("persistence", persistence)
    if not dynamics.friction:
        raise ParameterError("with a propulsion particles get faster and faster: give a friction")
    return replace(dynamics, drive=force, persistence=float(persistence))


def _start(sim: Deforming[S], dynamics: Dynamics, seed: int | None) -> S:
    """The state before the first step: particles may get velocities, by Maxwell."""
    refuse_second_motion(sim)
    lmp, temperature = sim.lmp, dynamics.temperature
    # in a bath, particles keep the velocities that they have
    drawn = not dynamics.friction or not gather(lmp, "v", 3).any()
    if dynamics.inertia and temperature is not None and lmp.get_natoms() > 1 and drawn:
        of_velocities, _ = seeds(sim, seed)
        maxwell = f"{temperature!r} {of_velocities} loop all mom yes dist gaussian"
        run(lmp, f"velocity all create {maxwell}")
    if dynamics.persistence is not None:
        sim.directions = _directions(sim, seed)
    return _with_directions(sim, dynamics)


def _directions(sim: Deforming[S], seed: int | None) -> NDArray[np.float64]:
    """Those that particles have, or random ones."""
    number = sim.lmp.get_natoms()
    if sim.directions is not None and len(sim.directions) == number:
        return sim.directions
    of_directions, _ = seeds(sim, seed)
    return unit_vectors(np.random.default_rng(of_directions).uniform(-np.pi, np.pi, number))


def _with_directions(sim: Deforming[S], dynamics: Dynamics) -> S:
    state = sim.state()
    if dynamics.persistence is None:
        return state
    return cast(S, replace(cast(State, state), directions=sim.directions))


def _move(
    sim: Deforming[S],
    dynamics: Dynamics,
    steps: int,
    every: int,
    seed: int | None,
    tolerance: float | None,
    start: Callable[[], S],
) -> Iterator[S]:
    lmp, state = sim.lmp, start()
    _, of_noise = seeds(sim, seed)
    dt = dynamics.timestep or dynamics.default_step(state)
    with (
        balanced_to(sim, state.packing, tolerance),
        moving(sim, dynamics, of_noise),
        progress("moving", unit="state", total=steps // every) as bar,
    ):
        for _ in range(0, steps, every):
            if not dynamics.timestep and dt > _ENOUGH * dynamics.longest_step(state):
                dt = dynamics.default_step(state)
            dynamics.check(state, dt)
            advance(sim, dynamics, every, dt)
            state = _with_directions(sim, dynamics)
            bar.set_postfix(temperature=f"{state.temperature:.3g}")
            bar.update()
            yield state
            refuse_restarted(sim, lmp)
