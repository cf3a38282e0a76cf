"""How particles move in LAMMPS: the fixes that move them, and the time steps that these allow.

Motion in time: at constant energy, in a heat bath, damped, or overdamped.
"""

from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._checks import count, expect, number_or_nan, positive, whole, zero_or_more
from .box import refuse_space
from .core import unit_vectors
from .errors import LammpsError, ParameterError
from .friction import Friction, damped_commands
from .lammps import gather, place, rub_and_spin, run
from .laws import (
    ACCURATE,
    Droplet,
    Ring,
    Sector,
    longest_overdamped_step,
    longest_step,
    squeeze_under,
)
from .polishing import balanced_to
from .progress import Steps, progress
from .simulation import Simulation
from .state import State

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

# The integrator of the heat bath by Gronbech-Jensen and Farago keeps positions and half-step
# velocities of an oscillator at their temperature for any time step. Unlike fix langevin, it does
# not draw its forces anew where a run begins. But it also moves particles along z, which matters
# for neighbor lists in the end; so z is set to 0 after every _FLATTEN steps.
_BATH = "fix deformable_move all gjf {temperature!r} {temperature!r} {time!r} {seed}"
_FLATTEN = 1000

# dr/dt = F/friction + noise, by Euler's method. It draws the noise within a step, not at its ends.
_BROWNIAN = "fix deformable_move all brownian {temperature!r} {seed} gamma_t {friction!r} rng {rng}"

# Forces along directions that diffuse, as a fix of this package.
_PROPULSION = "fix deformable_propel all deformable/propel {force!r} {persistence!r} {seed}"
_DIRECTIONS = "f_deformable_propel"

# Parts that a time step takes at most: of the smallest radius, by which a drive moves particles, of
# the persistence time, and of the time in which velocities settle.
_MOVED, _PERSISTED, _SETTLED = 0.02, 0.05, 0.02

# LAMMPS takes seeds up to 9e8, and adds the rank to them.
_SEEDS = 890_000_000


@dataclass(frozen=True)
class Dynamics:
    """How particles of mass 1 move.

    Attributes:
        temperature: of the heat bath [energy]; None or 0 without.
        friction: force over velocity [1/time].
        inertia: whether they have some; without, they are overdamped.
        drive: force that drives them, beside contacts and noise [energy/length].
        persistence: time for which they drive themselves in about one direction; None if they do
            not [time].
        part: of the usual time step that is taken, as the box is less damped than the particles.
        limit: time steps are at most this one because of the drive or the drag [time].
        timestep: that a user has given [time].
        rubbing: friction of the contacts, if they have one.
    """

    temperature: float | None = None
    friction: float = 0.0
    inertia: bool = True
    drive: float = 0.0
    persistence: float | None = None
    part: float = 1.0
    limit: float = np.inf
    timestep: float | None = None
    rubbing: Friction | None = None

    def longest_step(self, state: State) -> float:
        """The longest stable time step where the drive pushes particles together [time]."""
        return self._longest(state, self.drive, self._hot(state))

    def default_step(self, state: State) -> float:
        """The time step that a user gets who gives none [time]."""
        exact = not (self.inertia or self.temperature)  # steps change the energy of noise only
        part = self.part * (1.0 if exact else ACCURATE)
        steps = [part * self.longest_step(state), self.limit]
        if self.drive and self.friction:
            radius = float(state.packing.radii.min())
            steps.append(_MOVED * radius * self.friction / self.drive)
            if self.inertia:  # half a step makes velocities of fix gjf larger
                steps.append(_SETTLED / self.friction)
        if self.persistence is not None:
            steps.append(_PERSISTED * self.persistence)
        if self.rubbing:
            steps.append(self.rubbing.accurate_step)
        return min(steps)

    def _longest(self, state: State, drive: float, temperature: float) -> float:
        packing, law, squeeze, _ = state.step_limits()
        squeeze = max(squeeze, squeeze_under(drive, packing, law))
        if self.inertia:
            return longest_step(packing, law, squeeze, temperature)
        return longest_overdamped_step(packing, law, squeeze, temperature, self.friction)

    def _hot(self, state: State) -> float:
        """The temperature of the motion [energy]."""
        return state.temperature if self.inertia else self.temperature or 0.0

    def check(self, state: State, timestep: float) -> None:
        """Refuse a time step at which contacts are unstable."""
        if self.persistence is not None and timestep > self.persistence:
            raise ParameterError(
                f"timestep = {timestep:g} is longer than the persistence of {self.persistence:g}: "
                "take a twentieth of it, or leave it out"
            )
        if self.rubbing and timestep > self.rubbing.longest_step:
            raise ParameterError(
                f"timestep = {timestep:g} is too long for springs and dashpots of contacts that "
                f"rub: take at most {self.rubbing.longest_step:.2g}, or leave it out"
            )
        # without the drive: how hard it pushes is a guess
        longest = self._longest(state, 0.0, self._hot(state))
        if timestep <= longest:
            return
        name, values = state.squeezed
        n, temperature = int(values.argmax()), self._hot(state)
        cause = f"particle {n}, whose {name} is {values[n]:.3g}, at temperature {temperature:.3g}"
        if longest < self._longest(state, 0.0, 0.0):
            cause = f"the temperature of {temperature:.3g}, at which particles collide so hard"
        raise ParameterError(
            f"timestep = {timestep:g} is too long for {cause}: take at most {longest:.2g}, or "
            "leave it out"
        )

    def commands(self, seed: int, dimension: int, spins: bool = False) -> str:
        """Commands that define the fixes; `spins`: whether particles turn."""
        temperature = self.temperature or 0.0
        if not self.inertia:
            rng = "gaussian" if temperature else "none"  # and it wants a temperature then too
            mover = _BROWNIAN.format(
                temperature=temperature or 1.0, seed=seed, friction=self.friction, rng=rng
            )
        elif self.friction and spins:
            mover = damped_commands(self.friction)
        elif self.friction:
            mover = _BATH.format(temperature=temperature, time=1.0 / self.friction, seed=seed)
        else:
            mover = "fix deformable_move all nve" + "/sphere disc" * spins
        parts = [mover, *["fix deformable_plane all enforce2d"] * (dimension == 2)]
        if self.persistence is not None:
            values = {"force": self.drive, "persistence": self.persistence, "seed": seed}
            parts.append(_PROPULSION.format(**values))
        return "\n".join(parts)


def dynamics_of(
    sim: Simulation,
    temperature: float | None,
    friction: float,
    inertia: bool,
    timestep: float | None,
    seed: int | None,
) -> Dynamics:
    """The dynamics that a user asks for.

    Raises:
        ParameterError: the law is `Sector`, or a value is out of range.
    """
    if not isinstance(sim.law, Ring | Sector | Droplet):
        raise ParameterError(f"a simulation of {sim.law!r} does not move: take Ring or Droplet")
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
    if not inertia and not friction:
        raise ParameterError("without inertia particles need a friction above 0 to move against")
    if seed is not None and not 0 < whole("seed", seed) < 2**31:
        raise ParameterError(f"seed must lie between 1 and 2^31 - 1, not {seed}")
    turning = bool(friction and inertia) and rub_and_spin(sim.lmp)
    return Dynamics(
        temperature,
        friction,
        bool(inertia),
        limit=_SETTLED / friction if turning else np.inf,
        timestep=timestep,
        rubbing=sim.friction,
    )


@contextmanager
def moving(sim: Simulation, dynamics: Dynamics, seed: int) -> Iterator[None]:
    """The fixes of a motion, in LAMMPS until its end.

    Raises:
        ParameterError: another motion has not ended; or contacts rub that should turn particles,
            but these move against a friction.
    """
    refuse_second_motion(sim)
    lmp, spins = sim.lmp, rub_and_spin(sim.lmp)
    if spins and dynamics.friction and (dynamics.temperature or not dynamics.inertia):
        how = "in a heat bath do not turn: leave out temperature or friction"
        if not dynamics.inertia:
            how = (
                "without inertia, as in flows at a rate, do not turn: let them have inertia, or "
                "shear without a rate"
            )
        raise ParameterError(f"contacts rub, and particles {how}")
    fixes = dynamics.commands(seed, sim.dimension, spins)
    run(lmp, fixes)
    if dynamics.persistence is not None and sim.directions is not None:
        place(lmp, _DIRECTIONS, sim.directions)
    try:
        yield
    finally:
        if not sim.closed and sim.lmp is lmp:  # a caller may close it before the motion ends
            names = [line.split()[1] for line in fixes.splitlines() if line.startswith("fix ")]
            run(lmp, "\n".join(f"unfix {name}" for name in names))


def refuse_second_motion(sim: Simulation) -> None:
    """Refuse to begin a motion while another one has not ended.

    Raises:
        ParameterError: there is one.
    """
    if "deformable_move" in sim.lmp.available_ids("fix"):
        raise ParameterError(
            "another move of this simulation has not ended: finish its loop, or close() it first"
        )


def seeds(sim: Simulation, seed: int | None) -> list[int]:
    """Two seeds for LAMMPS, others for each number of steps; without a seed others each time."""
    entropy = sim.comm.bcast(np.random.SeedSequence(seed).entropy)
    words = np.random.SeedSequence([entropy, sim.lmp.extract_global("ntimestep")])
    return [1 + int(word) % _SEEDS for word in words.generate_state(2)]


def advance(sim: Simulation, dynamics: Dynamics, steps: int, timestep: float) -> None:
    """Let the particles move, and count the time.

    Raises:
        LammpsError: LAMMPS gave up; with what a user may change.
    """
    lmp = sim.lmp
    first = lmp.extract_global("ntimestep")
    flat = (
        f' every {_FLATTEN} "set group all z 0.0"'
        if dynamics.inertia and sim.dimension == 2
        else ""
    )
    try:  # `relax` between states has changed the time step
        run(lmp, f"timestep {timestep!r}\nrun {steps} post no{flat}")
    except LammpsError as error:
        raise LammpsError(f"{error}{_hint(dynamics, timestep)}") from None
    finally:  # Ctrl-C may end it early
        sim.time += (lmp.extract_global("ntimestep") - first) * timestep
    if dynamics.persistence is not None:
        sim.directions = gather(lmp, _DIRECTIONS, 2)
    if not dynamics.inertia:
        run(lmp, "velocity all set 0 0 0")  # fix brownian leaves those of its last step


def refuse_restarted(sim: Simulation, lmp: object) -> None:
    """Refuse to go on in another LAMMPS than before the last state.

    Raises:
        LammpsError: the simulation was restarted meanwhile.
    """
    if not sim.closed and sim.lmp is not lmp:
        raise LammpsError(
            "the simulation was reset while its particles move: begin a new move after reset"
        )


def _hint(dynamics: Dynamics, timestep: float) -> str:
    """What else a user may change where a motion fails."""
    if dynamics.temperature:
        return "; or lower the temperature"
    if dynamics.timestep is not None:
        return ""
    return (
        f"; or give a smaller timestep than {timestep:.3g}, which was chosen for the contacts alone"
    )


# Default number of steps between states.
_EVERY = 100

# The default time step becomes shorter where it is more than this part of the longest stable one.
_ENOUGH = 0.5


def move(
    sim: Simulation,
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
) -> Iterator[State]:
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
    expect("sim", sim, Simulation)
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


def _start(sim: Simulation, dynamics: Dynamics, seed: int | None) -> State:
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


def _directions(sim: Simulation, seed: int | None) -> NDArray[np.float64]:
    """Those that particles have, or random ones."""
    number = sim.lmp.get_natoms()
    if sim.directions is not None and len(sim.directions) == number:
        return sim.directions
    of_directions, _ = seeds(sim, seed)
    return unit_vectors(np.random.default_rng(of_directions).uniform(-np.pi, np.pi, number))


def _with_directions(sim: Simulation, dynamics: Dynamics) -> State:
    state = sim.state()
    if dynamics.persistence is None:
        return state
    return replace(state, directions=sim.directions)


def _move(
    sim: Simulation,
    dynamics: Dynamics,
    steps: int,
    every: int,
    seed: int | None,
    tolerance: float | None,
    start: Callable[[], State],
) -> Iterator[State]:
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
