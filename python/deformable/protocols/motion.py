"""Motion in time: at constant energy, in a heat bath, or damped."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np

from ..common.errors import LammpsError, ParameterError
from ..common.progress import progress
from ..common.steps import Steps
from ..common.validate import count, expect, positive, whole, zero_or_more
from ..engine.lammps import gather, run
from ..engine.simulation import Simulation
from ..model.laws import Sector
from ..model.timestep import accurate_step, longest_step
from ..state.state import State

# Default number of steps between states.
_EVERY = 100

# The default time step becomes shorter where it is more than this part of the longest stable one.
_ENOUGH = 0.5

# The integrator of the heat bath by Gronbech-Jensen and Farago keeps positions and half-step
# velocities of an oscillator at their temperature for any time step. Unlike fix langevin, it does
# not draw its forces anew where a run begins. But it also moves particles along z, which matters
# for neighbor lists in the end; so z is set to 0 after every _FLATTEN steps.
_BATH = "fix deformable_move all gjf {temperature!r} {temperature!r} {time!r} {seed}"
_FLATTEN = 1000

# LAMMPS takes seeds up to 9e8, and adds the rank to them.
_SEEDS = 890_000_000


def move(
    sim: Simulation,
    steps: int,
    timestep: float | None = None,
    temperature: float | None = None,
    friction: float = 0.0,
    every: int | None = None,
    seed: int | None = None,
) -> Iterator[State]:
    """Let particles of mass 1 move by their forces F.

        dv/dt = F - friction v + sqrt(2 friction temperature) noise

    Without friction the energy is conserved (velocity Verlet); with friction alone the motion is
    damped; with both the particles are in a heat bath (Langevin).

    Args:
        sim: of the law `Ring`; it ends in the last state.
        steps: number of time steps.
        timestep: length of a step [time]; if not given, a fifth of the longest stable one, which
            depends on the pressure in the particles and on the temperature; where these grow, steps
            become shorter. Give one if other forces than those of contacts, by fixes of `sim.lmp`,
            move particles that are at rest.
        temperature: of the heat bath if there is friction, and of initial velocities [energy].
            These are Maxwell's, with zero total momentum. A bath draws them where all particles are
            at rest, as after `relax`; others go on with the velocities that they have.
            If not given, none are drawn: the velocities are those of the simulation.
        friction: rate at which velocities decay [1/time].
        every: number of steps between states, a divisor of `steps`; if not given 100, or all steps
            if there are fewer.
        seed: of velocities and noise, together with the number of steps of LAMMPS so far: a second
            call draws others. The noise also depends on the number of ranks. If not given, none
            is ever drawn again.

    Yields:
        The state after each `every` steps, with its `velocities`, and the `time` of all calls of
        `move` for this simulation.

    Raises:
        ParameterError: a value is out of range, the time step is too long for the contacts, the law
            is `Sector`, whose energy jumps, or another `move` of this simulation has not ended.
        LammpsError: particles overlap too much, at the start (`push_off` helps) or later; or the
            simulation was restarted between two states.

    Source: heat bath: Gronbech-Jensen and Farago, Mol. Phys. 111, 983 (2013), and Jensen and
    Gronbech-Jensen, Mol. Phys. 117, 2511 (2019); velocity Verlet: Swope et al., J. Chem. Phys. 76,
    637 (1982).
    """
    expect("sim", sim, Simulation)
    if isinstance(sim.law, Sector):
        raise ParameterError(
            "the energy of Sector jumps where contacts appear, so that it is not conserved in "
            "motion: take Ring"
        )
    if timestep is not None:
        timestep = positive("timestep", timestep)
    if temperature is not None:
        temperature = zero_or_more("temperature", temperature)
    friction = zero_or_more("friction", friction)
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
    if seed is not None and not 0 < whole("seed", seed) < 2**31:
        raise ParameterError(f"seed must lie between 1 and 2^31 - 1, not {seed}")
    start = cache(lambda: _start(sim, temperature, friction, seed))
    moved = _move(sim, steps, timestep, temperature, friction, every, seed, start)
    return Steps("move", moved, start)


def _start(sim: Simulation, temperature: float | None, friction: float, seed: int | None) -> State:
    """The state before the first step: particles may get velocities."""
    lmp = sim.lmp
    if "deformable_move" in lmp.available_ids("fix"):
        raise ParameterError(
            "another move of this simulation has not ended: finish its loop, or close() it first"
        )
    # in a bath, particles keep the velocities that they have
    at_rest = not gather(lmp, "v", 3).any()
    if temperature is not None and lmp.get_natoms() > 1 and (at_rest or not friction):
        of_velocities, _ = _seeds(sim, seed)
        drawn = f"{temperature!r} {of_velocities} loop all mom yes dist gaussian"
        run(lmp, f"velocity all create {drawn}")
    return sim.state()


def _move(
    sim: Simulation,
    steps: int,
    timestep: float | None,
    temperature: float | None,
    friction: float,
    every: int,
    seed: int | None,
    start: Callable[[], State],
) -> Iterator[State]:
    lmp, state = sim.lmp, start()
    _, of_noise = _seeds(sim, seed)
    dt = accurate_step(*state.step_limits()) if timestep is None else timestep
    taken, before = 0, sim.time  # steps of this length, and the time before them
    bath = _BATH.format(temperature=temperature or 0.0, time=1.0 / (friction or 1.0), seed=of_noise)
    run(
        lmp,
        (bath if friction else "fix deformable_move all nve")
        + "\nfix deformable_plane all enforce2d",
    )
    try:
        with progress("moving", unit="state", total=steps // every) as bar:
            for _ in range(0, steps, every):
                if timestep is None and dt > _ENOUGH * longest_step(*state.step_limits()):
                    dt, taken, before = accurate_step(*state.step_limits()), 0, sim.time
                _check(state, dt)
                hint = _hint(bool(temperature), None if timestep else dt)
                first = lmp.extract_global("ntimestep")
                try:
                    _advance(sim, every, dt, hint)
                finally:  # Ctrl-C may end it early
                    taken += lmp.extract_global("ntimestep") - first
                    sim.time = before + taken * dt
                state = sim.state()
                bar.set_postfix(temperature=f"{state.temperature:.3g}")
                bar.update()
                yield state
                if not sim.closed and sim.lmp is not lmp:
                    raise LammpsError(
                        "the simulation was restarted while its particles move: begin a new move "
                        "after restart"
                    )
    finally:
        if not sim.closed and sim.lmp is lmp:  # a caller may close it before the motion ends
            run(lmp, "unfix deformable_move\nunfix deformable_plane")


def _seeds(sim: Simulation, seed: int | None) -> list[int]:
    """Two seeds for LAMMPS, others for each number of steps; without a seed others each time."""
    entropy = sim.comm.bcast(np.random.SeedSequence(seed).entropy)
    words = np.random.SeedSequence([entropy, sim.lmp.extract_global("ntimestep")])
    return [1 + int(word) % _SEEDS for word in words.generate_state(2)]


def _advance(sim: Simulation, steps: int, timestep: float, hint: str) -> None:
    motion = f'run {steps} post no every {_FLATTEN} "set group all z 0.0"'
    try:
        run(sim.lmp, f"timestep {timestep!r}\n{motion}")  # `relax` between states changes it
    except LammpsError as error:
        raise LammpsError(f"{error}{hint}") from None


def _hint(thermal: bool, default: float | None) -> str:
    """What else a user may change where a motion fails; the default time step, if it is used."""
    if thermal:
        return "; or lower the temperature"
    if default is None:
        return ""
    return f"; or give a timestep, the default of {default:.3g} is for contacts alone"


def _check(state: State, timestep: float) -> None:
    """Refuse a time step at which contacts are unstable."""
    packing, law, pressure, temperature = state.step_limits()
    longest = longest_step(packing, law, pressure, temperature)
    if timestep > longest:
        n = int(state.particle_pressure.argmax())
        cause = f"particle {n}, whose pressure is {pressure:.3g}, at temperature {temperature:.3g}"
        if longest < longest_step(packing, law, pressure, 0.0):
            cause = f"the temperature of {temperature:.3g}, at which particles collide so hard"
        raise ParameterError(
            f"timestep = {timestep:g} is too long for {cause}: take at most {longest:.2g}, or "
            "leave it out"
        )
