"""How particles move in LAMMPS: the fixes that move them, and the time steps that these allow."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..common.errors import LammpsError, ParameterError
from ..common.validate import positive, whole, zero_or_more
from ..engine.deforming import Deforming
from ..engine.followed import rub_and_spin
from ..engine.lammps import gather, place, run
from ..io.rubbing import damped_commands
from ..model.friction import Friction
from ..model.laws import Sector
from ..model.timestep import ACCURATE, longest_overdamped_step, longest_step, squeeze_under
from ..state.droplet_state import DeformedState

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

    def longest_step(self, state: DeformedState) -> float:
        """The longest stable time step where the drive pushes particles together [time]."""
        return self._longest(state, self.drive, self._hot(state))

    def default_step(self, state: DeformedState) -> float:
        """The time step that a user gets who gives none [time]."""
        exact = not (self.inertia or self.temperature)  # steps change the energy of noise only
        part = self.part * (1.0 if exact else ACCURATE)
        steps = [part * self.longest_step(state), self.limit]
        if self.drive and self.friction:
            radius = float(state.packing.radius.min())
            steps.append(_MOVED * radius * self.friction / self.drive)
            if self.inertia:  # half a step makes velocities of fix gjf larger
                steps.append(_SETTLED / self.friction)
        if self.persistence is not None:
            steps.append(_PERSISTED * self.persistence)
        if self.rubbing:
            steps.append(self.rubbing.accurate_step)
        return min(steps)

    def _longest(self, state: DeformedState, drive: float, temperature: float) -> float:
        packing, law, squeeze, _ = state.step_limits()
        squeeze = max(squeeze, squeeze_under(drive, packing, law))
        if self.inertia:
            return longest_step(packing, law, squeeze, temperature)
        return longest_overdamped_step(packing, law, squeeze, temperature, self.friction)

    def _hot(self, state: DeformedState) -> float:
        """The temperature of the motion [energy]."""
        return state.temperature if self.inertia else self.temperature or 0.0

    def check(self, state: DeformedState, timestep: float) -> None:
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
    sim: Deforming[Any],
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
def moving(sim: Deforming[Any], dynamics: Dynamics, seed: int) -> Iterator[None]:
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


def refuse_second_motion(sim: Deforming[Any]) -> None:
    """Refuse to begin a motion while another one has not ended.

    Raises:
        ParameterError: there is one.
    """
    if "deformable_move" in sim.lmp.available_ids("fix"):
        raise ParameterError(
            "another move of this simulation has not ended: finish its loop, or close() it first"
        )


def seeds(sim: Deforming[Any], seed: int | None) -> list[int]:
    """Two seeds for LAMMPS, others for each number of steps; without a seed others each time."""
    entropy = sim.comm.bcast(np.random.SeedSequence(seed).entropy)
    words = np.random.SeedSequence([entropy, sim.lmp.extract_global("ntimestep")])
    return [1 + int(word) % _SEEDS for word in words.generate_state(2)]


def advance(sim: Deforming[Any], dynamics: Dynamics, steps: int, timestep: float) -> None:
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


def refuse_restarted(sim: Deforming[Any], lmp: object) -> None:
    """Refuse to go on in another LAMMPS than before the last state.

    Raises:
        LammpsError: the simulation was restarted meanwhile.
    """
    if not sim.closed and sim.lmp is not lmp:
        raise LammpsError(
            "the simulation was restarted while its particles move: begin a new move after restart"
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
