"""Motion in time: at constant energy, in a heat bath, damped, overdamped, or to rest at a pressure.

`Simulation.run`; and for flows the fixes that move particles, and the time steps that these allow.
"""

from __future__ import annotations

import math
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..common.checks import count, expect, finite, number_or_nan, positive, whole, zero_or_more
from ..common.errors import LammpsError, ParameterError, StalledWarning, warn
from ..core import unit_vectors
from ..engine.lammps import gather, place, place_velocities, rub_and_spin, run
from ..engine.relax import balanced_to
from ..engine.simulation import Simulation
from ..particles.friction import (
    Friction,
    damped_commands,
    inertia,
    longest_rubbing_step,
    overdamped_part,
    rubbing_step,
)
from ..particles.gravity import largest_weight
from ..particles.laws import (
    ACCURATE,
    Droplet,
    Ring,
    Sector,
    longest_overdamped_step,
    longest_step,
    squeeze_under,
)
from ..particles.walls import kind_of
from ..state.recorded import heat_of, squeeze_of, step_limits
from ..state.state import State
from .protocol import Protocol
from .recording import steps_so_far

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping


# The integrator of the heat bath by Gronbech-Jensen and Farago keeps positions and half-step
# velocities of an oscillator at their temperature for any time step. Unlike fix langevin, it does
# not draw its forces anew where a run begins. But it also moves particles along z, which matters
# for neighbor lists in the end; so z is set to 0 after every _FLATTEN steps.
_BATH = "fix deformable_move all gjf {temperature!r} {temperature!r} {time!r} {seed}"
_FLATTEN = 1000

# dr/dt = F/drag + noise, by Euler's method. It draws the noise within a step, not at its ends.
_BROWNIAN = "fix deformable_move all brownian {temperature!r} {seed} gamma_t {drag!r} rng {rng}"

# Forces along directions that diffuse and align, as a fix of this package.
_PROPULSION = "fix deformable_propel all deformable/propel {force!r} {persistence!r} {seed}{align}"
_DIRECTIONS = "f_deformable_propel"

# Parts that a time step takes at most: of the smallest radius, by which a drive moves particles, of
# the persistence time, and of the time in which velocities settle.
_MOVED, _PERSISTED, _SETTLED = 0.02, 0.05, 0.02

# LAMMPS takes seeds up to 9e8, and adds the rank to them.
_SEEDS = 890_000_000


@dataclass(frozen=True)
class Alignment:
    """How the directions n of particles that propel themselves turn, for `Simulation.run`.

        dn/dt = (n x h) x n + noise,   h = velocity v/|v| + neighbors <n_j> - free sum_c n_c

    In the plane the angle of n turns by |h| sin(angle of h - angle of n). v is the velocity of the
    particle, <n_j> the mean over its neighbors, n_c the normals of its contacts with particles and
    walls, away from it. Negative rates turn against.

    Args:
        velocity: rate toward the own velocity [1/time].
        neighbors: rate toward the mean direction of neighbors [1/time].
        distance: of centers, up to which particles are neighbors [length]; if not given, those in
            contact are.
        free: rate toward free space, of each contact: contact inhibition of locomotion [1/time].

    Raises:
        ParameterError: a rate is not finite, a distance not above 0, or has no rate.

    Source: velocity: Lam, Schindler and Dauchot, New J. Phys. 17, 113056 (2015); free space:
    Zimmermann et al., PNAS 113, 2660 (2016).
    """

    velocity: float = 0.0
    neighbors: float = 0.0
    distance: float | None = None
    free: float = 0.0

    def __post_init__(self) -> None:
        for name in ("velocity", "neighbors", "free"):
            object.__setattr__(self, name, finite(name, getattr(self, name)))
        if self.distance is not None:
            object.__setattr__(self, "distance", positive("distance", self.distance))
            if not self.neighbors:
                raise ParameterError("a distance is that of neighbors: give their rate too")

    def _words(self) -> str:
        """Of *fix deformable/propel*."""
        near = "contact" if self.distance is None else repr(self.distance)
        values = {"velocity": "", "neighbors": f" {near}", "free": ""}
        rates = {name: getattr(self, name) for name in values}
        return "".join(f" {name} {rate!r}{values[name]}" for name, rate in rates.items() if rate)

    def _fastest(self) -> float:
        """Rate at which a direction turns at most, with six contacts on one side [1/time]."""
        return abs(self.velocity) + abs(self.neighbors) + 3.0 * abs(self.free)


@dataclass(frozen=True)
class Dynamics:
    """How particles of mass 1 move.

    Attributes:
        temperature: of the heat bath [energy]; None or 0 without.
        drag: force over velocity [1/time].
        inertia: whether they have some; without, they are overdamped.
        drive: largest force that drives one, beside contacts and noise [energy/length].
        propulsion: the part of the drive along directions of their own [energy/length].
        persistence: time for which they propel themselves in about one direction; None if they do
            not [time].
        alignment: of these directions, if they align.
        part: of the usual time step that is taken, as the box is less damped than the particles.
        limit: time steps are at most this one because of the drive or the drag [time].
        timestep: that a user has given [time].
        rubbing: friction of the contacts, if they have one.
    """

    temperature: float | None = None
    drag: float = 0.0
    inertia: bool = True
    drive: float = 0.0
    propulsion: float = 0.0
    persistence: float | None = None
    alignment: Alignment | None = None
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
        if self.drive and self.drag:
            radius = float(state.packing.radii.min())
            steps.append(_MOVED * radius * self.drag / self.drive)
            if self.inertia:  # half a step makes velocities of fix gjf larger
                steps.append(_SETTLED / self.drag)
        if self.persistence is not None:
            steps.append(_PERSISTED * self.persistence)
        if self.alignment and (rate := self.alignment._fastest()):
            steps.append(_PERSISTED / rate)
        if self.rubbing:
            steps[0] *= overdamped_part(self.rubbing)
            steps.append(rubbing_step(self.rubbing))
        return min(steps)

    def _longest(self, state: State, drive: float, temperature: float) -> float:
        packing, law, squeeze, _ = step_limits(state)
        squeeze = max(squeeze, squeeze_under(drive, packing, law))
        if self.inertia:
            return longest_step(packing, law, squeeze, temperature)
        return longest_overdamped_step(packing, law, squeeze, temperature, self.drag)

    def _hot(self, state: State) -> float:
        """The temperature of the motion, or the one that a bath will give it [energy]."""
        bath = self.temperature or 0.0
        if not self.inertia:
            return bath
        return max(heat_of(state), bath if self.drag else 0.0)

    def check(self, state: State, timestep: float) -> None:
        """Refuse a time step at which contacts are unstable."""
        if self.persistence is not None and timestep > self.persistence:
            raise ParameterError(
                f"timestep = {timestep:g} is longer than the persistence of {self.persistence:g}: "
                "take a twentieth of it, or leave it out"
            )
        if self.rubbing and timestep > longest_rubbing_step(self.rubbing):
            raise ParameterError(
                f"timestep = {timestep:g} is too long for springs and dashpots of contacts that "
                f"rub: take at most {longest_rubbing_step(self.rubbing):.2g}, or leave it out"
            )
        # without the drive: how hard it pushes is a guess
        longest = self._longest(state, 0.0, self._hot(state))
        if timestep <= longest:
            return
        name, values = squeeze_of(state)
        n, temperature = int(values.argmax()), self._hot(state)
        cause = f"particle {n}, whose {name} is {values[n]:.3g}, at temperature {temperature:.3g}"
        if longest < self._longest(state, 0.0, 0.0):
            cause = f"the temperature of {temperature:.3g}, at which particles collide so hard"
            if temperature not in (state.temperature, self.temperature):
                cause = f"particles that collide as hard as at the temperature {temperature:.3g}"
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
                temperature=temperature or 1.0, seed=seed, drag=self.drag, rng=rng
            )
        elif self.drag and spins:
            mover = damped_commands(self.drag, dimension)
        elif self.drag:
            mover = _BATH.format(temperature=temperature, time=1.0 / self.drag, seed=seed)
        else:
            sphere = "/sphere disc" if dimension == 2 else "/sphere"
            mover = "fix deformable_move all nve" + sphere * spins
        parts = [mover, *["fix deformable_plane all enforce2d"] * (dimension == 2)]
        if self.persistence is not None:
            align = self.alignment._words() if self.alignment else ""
            values = {"force": self.propulsion, "persistence": self.persistence, "seed": seed}
            parts.append(_PROPULSION.format(**values, align=align))
        return "\n".join(parts)


def dynamics_of(
    sim: Simulation,
    temperature: float | None,
    drag: float | None,
    inertia: bool,
    timestep: float | None,
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
    drag = 0.0 if drag is None else zero_or_more("drag", drag)
    if not inertia and not drag:
        raise ParameterError("without inertia particles need a drag above 0 to move against")
    turning = bool(drag and inertia) and rub_and_spin(sim.lmp)
    return Dynamics(
        temperature,
        drag,
        bool(inertia),
        drive=largest_weight(sim.gravity),
        limit=_SETTLED / drag if turning else np.inf,
        timestep=timestep,
        rubbing=sim.friction,
    )


@contextmanager
def moving(sim: Simulation, dynamics: Dynamics, seed: int) -> Iterator[None]:
    """The fixes of a motion, in LAMMPS until its end.

    Raises:
        ParameterError: another motion has not ended; or contacts rub that should turn particles,
            but these move against a drag.
    """
    lmp, begun, spins = sim.lmp, sim.engine.begun, rub_and_spin(sim.lmp)
    if "deformable_move" in lmp.available_ids("fix"):
        raise ParameterError(
            "a motion of this simulation goes on, whose callback begins another one: let the "
            "callback return True, and begin the other one then"
        )
    if spins and dynamics.drag and (dynamics.temperature or not dynamics.inertia):
        how = "in a heat bath do not turn: leave out temperature or drag"
        if not dynamics.inertia:
            how = (
                "without inertia, as in flows with a drag, do not turn: let them have inertia, or "
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
        if not sim.closed and sim.engine.begun == begun:  # a callback may close it
            names = [line.split()[1] for line in fixes.splitlines() if line.startswith("fix ")]
            run(lmp, "\n".join(f"unfix {name}" for name in names))


def drawn_seed(sim: Simulation, seed: int | np.random.Generator | None) -> int:
    """The seed of a motion, or one that is drawn, as for packings; `sim.seed` keeps it.

    Raises:
        ParameterError: LAMMPS takes no such seed.
    """
    if seed is None or isinstance(seed, np.random.Generator):
        drawn = int(np.random.default_rng(seed).integers(1, 2**31))
        sim.seed = int(sim.comm.bcast(drawn))
    elif not 0 < (number := whole("seed", seed)) < 2**31:
        raise ParameterError(f"seed must lie between 1 and 2^31 - 1, not {seed}")
    else:
        sim.seed = number
    return sim.seed


def seeds(seed: int, *places: int) -> list[int]:
    """Two seeds for LAMMPS, others at each place: steps so far, states in a recorded run."""
    words = np.random.SeedSequence([seed, *places])
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
        sim.directions = gather(lmp, _DIRECTIONS, sim.dimension)
    if not dynamics.inertia:
        run(lmp, "velocity all set 0 0 0")  # fix brownian leaves those of its last step


def refuse_restarted(sim: Simulation, begun: int) -> None:
    """Refuse to go on in another LAMMPS than before the last state.

    Raises:
        LammpsError: a callback has restarted or closed the simulation.
    """
    if sim.closed or sim.engine.begun != begun:
        raise LammpsError(
            "the simulation was reset while its particles move: end the motion by a callback "
            "that returns True, then reset it"
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


# Without a number of steps between states, the default time step is chosen anew after so many.
_LOOK = 100

# The default time step becomes shorter where it is more than this part of the longest stable one.
_ENOUGH = 0.5

# d(ln L)/dt = gain (P - p) of all sides L, with P the pressure of states. Tilts would stay: their
# changes since a run began are variables, and follow the sides.
_BOX = """
fix deformable_box all deform/pressure 1 box pressure {pressure!r} {gain!r}{tilts} remap x
fix_modify deformable_box press deformable_virial
"""

# At a pressure: rate at which velocities decay over that of contacts, sqrt(p D^(d-2)/m) with the
# diameter D, and the part of the pressure that this drag bears at most: where the box closes in, it
# pushes N particles together by N^(2/d) m rate drag/(8 D^(d-2)) per area or volume.
_DRAG, _BORNE = 2.0, 0.02

# At a pressure: part of the longest stable time step, as nothing needs to be accurate on the way to
# rest, and time steps between looks at the forces.
_OF_LONGEST, _LOOK_AT_REST = 0.5, 2000


@dataclass(frozen=True, kw_only=True)
class Move(Protocol, name="run"):
    """See `Simulation.run`; `steps` are time steps, of which `every` one gives a state."""

    every: int | None = None
    timestep: float | None = None
    temperature: float | None = None
    drag: float | None = None
    inertia: bool = True
    propulsion: float | None = None
    persistence: float | None = None
    alignment: Alignment | None = None
    pressure: float | None = None
    inertial_number: float | None = None
    tolerance: float | None = None
    balance: float | None = None
    seed: int | np.random.Generator | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.alignment, dict):  # of a recorded run
            object.__setattr__(self, "alignment", Alignment(**self.alignment))

    def check(self, sim: Simulation, recorded: bool) -> Move:
        def checked(check: Callable[[str, Any], float], name: str) -> float | None:
            """A value that is checked, if it is given."""
            value = getattr(self, name)
            return None if value is None else float(check(name, value))

        expect("inertia", self.inertia, bool)
        expect("alignment", self.alignment, Alignment, type(None))
        settings: dict[str, Any] = {
            "steps": count("steps", self.steps),
            "every": None if self.every is None else count("every", self.every),
            "timestep": checked(positive, "timestep"),
            "temperature": checked(zero_or_more, "temperature"),
            "drag": checked(zero_or_more, "drag"),
            "balance": checked(positive, "balance"),
        }
        if settings["balance"] is not None and not settings["balance"] < 1.0:
            raise ParameterError(f"balance must be below 1, not {self.balance}")
        if self.pressure is None:
            for name in ("inertial_number", "tolerance"):
                if getattr(self, name) is not None:
                    raise ParameterError(f"{name} has no meaning without a pressure: leave it out")
            if self.propulsion is not None or self.persistence is not None:
                endless = number_or_nan(self.persistence) == math.inf
                settings["propulsion"] = checked(positive, "propulsion")
                settings["persistence"] = math.inf if endless else checked(positive, "persistence")
        else:
            self._refuse_at_pressure(sim)
            settings["pressure"] = checked(positive, "pressure")
            settings["inertial_number"] = checked(positive, "inertial_number") or 1e-3
            settings["tolerance"] = checked(positive, "tolerance") or 1e-4
        motion = replace(self, **settings)
        dynamics = motion.dynamics(sim)
        if motion.temperature and not dynamics.drag and sim.lmp.get_natoms() < 2:
            raise ParameterError(
                "a single particle has no temperature without a heat bath: give it a drag"
            )
        return replace(motion, seed=drawn_seed(sim, self.seed))

    def _refuse_at_pressure(self, sim: Simulation) -> None:
        """Refuse what has no meaning where particles come to rest at a pressure."""
        if sim.walls:
            raise ParameterError(
                f"walls do not follow a box that settles, and there are {len(sim.walls)}, the "
                f"first a {kind_of(sim.walls[0])}: run(drag=) comes to rest between walls"
            )
        if sim.dimension == 3 and sim.box[1, 0] and sim.box[2, 1]:  # LAMMPS does not change both
            raise ParameterError(
                f"a box that leans along y, by yz = {sim.box[2, 1]:.4g}, and along x, by xy = "
                f"{sim.box[1, 0]:.4g}, does not keep its shape: take one without yz, or "
                "relax(pressure=)"
            )
        if sim.gravity is not None:
            raise ParameterError(
                "with a pressure particles come to rest in a periodic box, where they fall without "
                "end by gravity: take gravity=(0, 0), or walls and run(drag=)"
            )
        own = (self.propulsion, self.persistence, self.alignment)
        propelled = any(value is not None for value in own)
        if self.temperature or not self.inertia or propelled:
            raise ParameterError(
                "with a pressure particles come to rest by inertia and drag: leave out "
                "temperature, inertia=False, propulsion, persistence and alignment"
            )

    def dynamics(self, sim: Simulation) -> Dynamics:
        """The dynamics of the particles.

        Raises:
            ParameterError: see `Simulation.run`.
        """
        drag, pressure = self.drag, self.pressure
        if pressure is not None and drag is None:
            assert self.inertial_number is not None
            number = sim.lmp.get_natoms() ** (2.0 / sim.dimension)
            bears = 8.0 * _BORNE / (self.inertial_number * number)
            drag = _rate_under(sim, pressure) * min(_DRAG, bears)
        dynamics = dynamics_of(sim, self.temperature, drag, self.inertia, self.timestep)
        if pressure is not None:
            # a loose packing does not tell how stiff contacts become
            diameter = 2.0 * float(sim.state().packing.radii.max())
            return replace(dynamics, drive=pressure * diameter ** (sim.dimension - 1))
        return _propelled(dynamics, self.propulsion, self.persistence, self.alignment)

    @property
    def _every(self) -> int:
        """Number of time steps from a state to the next one."""
        return min(self.every or self.steps, self.steps)

    @property
    def _states(self) -> int:
        """Number of states."""
        return math.ceil(self.steps / self._every)

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        """The state before: particles may get velocities, by Maxwell, and directions."""
        assert isinstance(self.seed, int)
        lmp, temperature, dynamics = sim.lmp, self.temperature, self.dynamics(sim)
        step = steps_so_far(sim)
        of_start, _ = seeds(self.seed, step)
        # in a bath, particles keep the velocities that they have
        velocities, directions = gather(lmp, "v", 3), sim.directions
        drawn = not dynamics.drag or not velocities.any()
        if dynamics.inertia and temperature is not None and drawn:
            if lmp.get_natoms() > 1:
                words = "loop all mom yes dist gaussian"
                run(lmp, f"velocity all create {temperature!r} {of_start} {words}")
            else:  # LAMMPS has no temperature of a single particle
                drawn_one = np.random.default_rng(of_start).standard_normal((1, sim.dimension))
                place_velocities(lmp, math.sqrt(temperature) * drawn_one)
        if dynamics.persistence is not None:
            number = lmp.get_natoms()
            if sim.directions is None or len(sim.directions) != number:
                random = np.random.default_rng(of_start)
                angles = random.uniform(-np.pi, np.pi, number)
                sim.directions = unit_vectors(angles)
                if sim.dimension == 3:
                    height = random.uniform(-1.0, 1.0, (number, 1))
                    flat = np.sqrt(1.0 - height**2) * sim.directions
                    sim.directions = np.hstack([flat, height])
        start: dict[str, Any] = {"step": step, "states": self._states}
        state = _with_directions(sim, dynamics)
        if self.pressure is None:
            start["timestep"] = dynamics.timestep or dynamics.default_step(state)
            try:
                dynamics.check(state, start["timestep"])
            except ParameterError:  # a call that is refused leaves the simulation as it was
                place(lmp, "v", velocities)
                sim.directions = directions
                raise
        return state, start

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        assert isinstance(self.seed, int)
        dynamics, begun = self.dynamics(sim), sim.engine.begun
        state = _with_directions(sim, dynamics) if before is None else before
        _, of_noise = seeds(self.seed, start["step"], *[done] * (done > 0))
        if self.pressure is not None:
            yield from self._settled(sim, dynamics, done, state)
            return
        dt = start["timestep"]
        with balanced_to(sim, state.packing, self.balance), moving(sim, dynamics, of_noise):
            for taken, look in self._pieces(done, self.every or _LOOK):
                if not dynamics.timestep and dt > _ENOUGH * dynamics.longest_step(state):
                    dt = dynamics.default_step(state)
                dynamics.check(state, dt)
                advance(sim, dynamics, look, dt)
                state = _with_directions(sim, dynamics)
                if taken is not None:
                    start["timestep"] = dt
                    yield state
                    refuse_restarted(sim, begun)

    def _pieces(self, done: int, look: int) -> Iterator[tuple[int | None, int]]:
        """Numbers of time steps from a look at the forces to the next one.

        Args:
            done: number of states before.
            look: time steps from a look to the next one at most.

        Yields:
            The number of the state after these steps, None where there is none, and their number.
        """
        steps, every = self.steps, self._every
        look = min(look, every)
        for n in range(done, self._states):
            begin, end = n * every, min((n + 1) * every, steps)
            for at in range(begin, end, look):
                yield (n + 1 if at + look >= end else None), min(look, end - at)

    def _settled(
        self, sim: Simulation, dynamics: Dynamics, done: int, state: State
    ) -> Iterator[State]:
        """The states on the way to rest at a pressure, of which the last one rests."""
        pressure, tolerance, begun = self.pressure, self.tolerance, sim.engine.begun
        assert pressure is not None
        assert tolerance is not None
        assert self.inertial_number is not None
        if done and _error_at_rest(sim, state, pressure, dynamics.drag) <= tolerance:
            return
        gain = self.inertial_number * _rate_under(sim, pressure) / pressure
        tilts = {
            f"deformable_{'xyz'[axis]}{'xyz'[row]}": (row, axis)
            for row, axis in zip(*np.nonzero(np.tril(sim.box, -1)), strict=True)
        }
        shape = sim.box / sim.box[0, 0]
        words = "".join(f" {name[-2:]} variable v_{name} v_deformable_rate" for name in tilts)
        usual = self.every or _LOOK_AT_REST
        if tilts:  # `advance` begins anew after so many steps
            usual = min(self.every or _FLATTEN, _FLATTEN)
        with moving(sim, dynamics, seed=1):
            run(sim.lmp, "variable deformable_rate equal 0.0")
            _follow(sim, tilts, shape)
            run(sim.lmp, _BOX.format(pressure=pressure, gain=gain, tilts=words).strip())
            try:
                for taken, look in self._pieces(done, usual):
                    longest = dynamics.longest_step(state)
                    if sim.friction:
                        longest = min(
                            longest * overdamped_part(sim.friction),
                            longest_rubbing_step(sim.friction),
                        )
                    dt = dynamics.timestep or _OF_LONGEST * longest
                    dynamics.check(state, dt)
                    if dt > longest:
                        raise ParameterError(
                            f"timestep = {dt:g} is too long for contacts at the pressure "
                            f"{pressure:g}: take at most {longest:.2g}, or leave it out"
                        )
                    _follow(sim, tilts, shape)
                    advance(sim, dynamics, look, dt)
                    state = sim.state()
                    error = _error_at_rest(sim, state, pressure, dynamics.drag)
                    rests, ends = error <= tolerance, taken == self._states
                    if ends and not rests:
                        warn(
                            f"the particles did not come to rest at the pressure {pressure:g} in "
                            f"{self.steps} steps: forces, torques or the pressure are off by "
                            f"{error:.2g}, not {tolerance:g}; call again to go on",
                            StalledWarning,
                        )
                    if taken is not None or rests:
                        yield replace(state, converged=rests or not ends)
                        refuse_restarted(sim, begun)
                    if rests:
                        return
            finally:
                if not sim.closed and sim.engine.begun == begun:
                    names = ("deformable_rate", *tilts)
                    gone = "\n".join(f"variable {name} delete" for name in names)
                    run(sim.lmp, f"unfix deformable_box\n{gone}")


def _rate_under(sim: Simulation, pressure: float) -> float:
    """Of particles of mass 1 that a pressure moves, sqrt(p D^(d-2)/m) with the mean diameter D."""
    if sim.dimension == 2:
        return math.sqrt(pressure)
    return math.sqrt(2.0 * pressure * float(sim.state().packing.radii.mean()))


def _propelled(
    dynamics: Dynamics,
    propulsion: float | None,
    persistence: float | None,
    alignment: Alignment | None,
) -> Dynamics:
    """The dynamics with a propulsion, if there is one.

    Raises:
        ParameterError: one of both values is missing, or there is no drag.
    """
    if propulsion is None and persistence is None:
        if alignment is not None:
            raise ParameterError("an alignment turns a propulsion: give one, and its persistence")
        return dynamics
    if propulsion is None or persistence is None:
        raise ParameterError("give propulsion and persistence, or none of them")
    if not dynamics.drag:
        raise ParameterError("with a propulsion particles get faster and faster: give a drag")
    drive = dynamics.drive + propulsion
    return replace(
        dynamics,
        drive=drive,
        propulsion=propulsion,
        persistence=persistence,
        alignment=alignment,
    )


def _with_directions(sim: Simulation, dynamics: Dynamics) -> State:
    state = sim.state()
    return state if dynamics.persistence is None else replace(state, directions=sim.directions)


def _follow(sim: Simulation, tilts: Mapping[str, tuple[int, int]], shape: Any) -> None:
    """Let tilts follow the box, of this shape over its first side, in the next run."""
    for name, at in tilts.items():
        ratio, tilt = float(shape[at]), float(sim.box[at])
        run(sim.lmp, f"variable {name} equal {ratio!r}*lx-({tilt!r})")


def _error_at_rest(sim: Simulation, state: State, pressure: float, drag: float) -> float:
    """Error of the pressure over it; or force, torque over the radius, over the mean contact force.

    The largest of them. The drag is left out: it holds up particles that creep.
    """
    if not state.n_contacts.any():
        return math.inf
    force, torque = gather(sim.lmp, "f", 3), np.zeros((1, 3))
    if rub_and_spin(sim.lmp):  # then the drag is in the forces
        radius = state.packing.radii[:, None]
        force += drag * gather(sim.lmp, "v", 3)
        torque = gather(sim.lmp, "torque", 3) / radius
        torque += drag * inertia(sim.dimension) * radius * gather(sim.lmp, "omega", 3)
    largest = max(np.linalg.norm(each, axis=1).max() for each in (force, torque))
    residual = float(largest / state.contacts["force"].mean())
    return max(abs(state.pressure / pressure - 1.0), residual)
