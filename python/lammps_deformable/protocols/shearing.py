"""Simple shear: quasistatic, at a rate, to and fro, or under a stress that stays.

Quasistatic: tilt the box a little, relax, again. At a rate LAMMPS shears the box, and a drag holds
the particles to the mean flow, or they have inertia and move by contacts alone. An oscillation
gives the storage and the loss modulus, creep the strain under a stress.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..common.box import fractional
from ..common.checks import count, expect, finite, number_or_nan, positive, whole
from ..common.errors import ParameterError
from ..engine.lammps import images_of, named_tilts, place_images, place_velocities, run
from ..engine.moduli import (
    following,
    imbalance_under,
    tolerance_under,
    unbalanced_modulus,
)
from ..engine.relax import TOLERANCE, balanced_to
from ..engine.simulation import Simulation
from ..particles.laws import Droplet, Ring, Sector
from ..particles.walls import kind_of
from .motion import (
    Dynamics,
    advance,
    drawn_seed,
    dynamics_of,
    moving,
    refuse_restarted,
    seeds,
)
from .protocol import Protocol, check_tolerance
from .recording import steps_so_far

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from ..runs.run import Run
    from ..state.state import State


def sheared(points: NDArray[np.float64], strain: float) -> NDArray[np.float64]:
    """Points, or the rows of a box, after simple shear along x, shape (n, d) [length]."""
    moved = np.array(points)
    moved[:, 0] += strain * points[:, 1]
    return moved


def straighten(sim: Simulation) -> None:
    """Replace the box by the equivalent one with the smallest tilts; the particles stay."""
    box = sim.box
    straight = straightened(box)
    before, after = named_tilts(box), named_tilts(straight)
    ends = [f"{name} final {tilt!r}" for name, tilt in after.items() if tilt != before[name]]
    if ends:
        images = images_of(sim.lmp)
        run(sim.lmp, f"change_box all {' '.join(ends)} units box")
        if images.any():  # which count the former lattice vectors
            former = np.rint(fractional(box, straight)).astype(np.int64)
            place_images(sim.lmp, images_of(sim.lmp) - images + images @ former)


def straightened(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """The equivalent box with the smallest tilts, shape (d, d) [length]."""
    straight = box.copy()
    for row in range(1, len(box)):
        for column in range(row - 1, -1, -1):
            widths = round(float(straight[row, column] / straight[column, column]))
            straight[row] -= widths * straight[column]
    return straight


# Strain of a time step at most, as forces follow the box with a delay of one step; and strain after
# which the time step is chosen anew.
_OF_A_STEP, _OF_A_PIECE = 5e-4, 0.02


@dataclass(frozen=True, kw_only=True)
class Flow(Protocol, name=""):
    """Settings of a flow of particles that are held to the mean flow, or have inertia."""

    drag: float | None = None
    temperature: float | None = None
    timestep: float | None = None
    seed: int | np.random.Generator | None = None

    def dynamics(self, sim: Simulation) -> Dynamics:
        """Overdamped motion relative to the mean flow, or one with inertia, by these settings.

        Raises:
            ParameterError: a value is out of range, the drag is missing, or given with inertia, a
                tolerance is given, or these of a law without motion.
        """
        if not isinstance(sim.law, Ring | Sector | Droplet):
            raise ParameterError(
                f"a simulation of {sim.law!r} is sheared without a rate only: take Ring or Droplet"
            )
        if getattr(self, "tolerance", None) is not None:
            raise ParameterError("states of a flow are not relaxed: leave tolerance out")
        if getattr(self, "inertia", False):
            for name in ("drag", "temperature"):
                if getattr(self, name) is not None:
                    raise ParameterError(
                        f"a flow with inertia has contacts alone, and no {name}: leave it out"
                    )
            return dynamics_of(sim, None, None, True, self.timestep)
        if self.drag is None:
            raise ParameterError("a flow needs the drag of particles against it: give drag")
        return dynamics_of(sim, self.temperature, self.drag, False, self.timestep)

    def flow_settings(self, sim: Simulation) -> dict[str, Any]:
        """The settings of the flow as numbers of Python, with a seed."""
        self.dynamics(sim)
        values = {name: getattr(self, name) for name in _OF_FLOW}
        numbers = {name: None if each is None else float(each) for name, each in values.items()}
        return numbers | {"seed": drawn_seed(sim, self.seed)}

    def refuse_without(self, name: str) -> None:
        """Refuse what belongs to a flow, where the value of this name that makes one is missing.

        Raises:
            ParameterError: some of it is given.
        """
        for other in (*_OF_FLOW, "seed", "inertia"):
            if getattr(self, other, None) not in (None, False):
                raise ParameterError(
                    f"{other} has no meaning without a {name}, where each state is relaxed: give "
                    f"a {name}, or leave it out"
                )

    def noise(self, start: Mapping[str, Any], done: int) -> int:
        """The seed of the noise from a state on: another one where a record goes on from it."""
        assert isinstance(self.seed, int)
        return seeds(self.seed, start["step"], *[done] * (done > 0))[1]


_OF_FLOW = ("drag", "temperature", "timestep")


def _flow(
    sim: Simulation,
    dynamics: Dynamics,
    rate: float,
    duration: float,
    strains: Sequence[float | None],
    course: Callable[[float, float], str],
    of_noise: int,
    done: int,
    before: State | None,
) -> Iterator[State]:
    """Shear the box, and yield the states after equal times that remain.

    Args:
        sim: ends in the last state.
        dynamics: of the particles.
        rate: the largest one of the flow [1/time].
        duration: from a state to the next one [time].
        strains: of all states; None where the box tells it.
        course: commands for a run that begins so long after the first one, and takes so long, of
            which the last is a `flow_command`.
        of_noise: seed of the noise.
        done: number of states before.
        before: the last state; None if it is not known.
    """
    begun, state = sim.engine.begun, sim.state() if before is None else before
    with (
        balanced_to(sim, state.packing, imbalance_under(rate * duration)),
        moving(sim, dynamics, of_noise),
    ):
        drag = dynamics.drag * rate * 2.0 * float(state.packing.radii.max())
        limit = min(dynamics.limit, _OF_A_STEP / rate)
        dynamics = replace(dynamics, drive=dynamics.drive + drag, limit=limit)
        pieces = math.ceil(rate * duration / _OF_A_PIECE)
        each = duration / pieces
        for n in range(done, len(strains)):
            for k in range(pieces):
                begin = duration * (n + k / pieces)
                state = _piece(sim, dynamics, each, course(begin, each), state)
            strain = strains[n]
            if strain is not None:
                sim.shear_strain = strain
            state = replace(state, shear_strain=sim.shear_strain)
            yield state
            refuse_restarted(sim, begun)


def flow_command(xy: str, xz: str = "", remap: str = "x") -> str:
    """*fix deform*, which shears the box with the particles in it.

    Args:
        xy: how the tilt changes.
        xz: how the other tilt along x does, by the part yz/ly of that, in a box that leans along y:
            without it the flow would have a gradient along z too.
        remap: `x` moves particles with the box, `v` changes velocities across its boundaries.
    """
    return f"fix deformable_flow all deform 1 xy {xy} {xz and f'xz {xz} '}remap {remap}"


def _flow_begins(sim: Simulation, rate: float) -> None:
    """Give particles the mean velocity u = rate y along x, in place of the one that they have."""
    state = sim.state()
    velocities = state.velocities + _mean_flow(state, rate) - _mean_flow(state)
    place_velocities(sim.lmp, velocities)


def _mean_flow(state: State, rate: float | None = None) -> NDArray[np.float64]:
    """The part of the velocities that grows along y, or that of a rate; 0 in the middle."""
    y = state.packing.positions[:, 1] - state.packing.positions[:, 1].mean()
    if rate is None:
        rate = float(y @ state.velocities[:, 0]) / max(float(y @ y), np.finfo(float).tiny)
    flow = np.zeros_like(state.velocities)
    flow[:, 0] = rate * y
    return flow


def leans(sim: Simulation) -> float:
    """Tilt yz of the straightened box, which a shear along x leaves as it is; 0 in the plane."""
    return float(straightened(sim.box)[2, 1]) if sim.dimension == 3 else 0.0


def _piece(
    sim: Simulation, dynamics: Dynamics, duration: float, course: str, state: State
) -> State:
    """The state after a flow with one time step, from the state before."""
    if dynamics.inertia:  # collisions are those of velocities beside the flow
        state = replace(state, velocities=state.velocities - _mean_flow(state))
    longest = dynamics.timestep or dynamics.default_step(state)
    steps = count("number of time steps to a state", math.ceil(duration / longest))
    dynamics.check(state, duration / steps)
    straighten(sim)
    tilt = float(sim.box[1, 0])
    run(sim.lmp, course)
    try:
        advance(sim, dynamics, steps, duration / steps)
        # before the flow ends: it changes velocities of those that have left the box
        return sim.state()
    finally:
        run(sim.lmp, "unfix deformable_flow")
        sim.shear_strain = (sim.shear_strain or 0.0) + _strain_since(sim, tilt)


def _strain_since(sim: Simulation, tilt: float) -> float:
    """The smallest strain from a tilt of the box to that of now, as LAMMPS may have flipped it."""
    lx, xy, ly = sim.box[[0, 1, 1], [0, 0, 1]].tolist()
    widths = (xy - tilt) / lx
    return float(widths - round(widths)) * lx / ly


def _begun(sim: Simulation, states: int) -> tuple[State, dict[str, Any]]:
    """The present state, whose strain is counted from now on."""
    sim.shear_strain = sim.shear_strain or 0.0
    return sim.state(), {"strain": sim.shear_strain, "step": steps_so_far(sim), "states": states}


@dataclass(frozen=True, kw_only=True)
class Shear(Flow):
    """See `Simulation.shear`."""

    strain: float
    rate: float | None = None
    inertia: bool = False
    tolerance: float | None = None

    def check(self, sim: Simulation, recorded: bool) -> Shear:
        check_shear(sim, self.strain, self.steps)
        expect("inertia", self.inertia, bool)
        whole: dict[str, Any] = {"strain": float(self.strain), "steps": int(self.steps)}
        if self.rate is None:
            self.refuse_without("rate")
            return replace(self, **whole, tolerance=check_tolerance(self.tolerance, recorded))
        rate = float(positive("rate", self.rate))
        return replace(self, **whole, rate=rate, **self.flow_settings(sim))

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        return _begun(sim, self.steps)

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        strain, steps, rate = self.strain, self.steps, self.rate
        strains = [start["strain"] + strain * n / steps for n in range(1, steps + 1)]
        if rate is None:
            for each in strains[done:]:
                yield sheared_state(sim, strain / steps, each, self.tolerance)
            return
        along, yz = math.copysign(rate, strain), leans(sim)
        dynamics = self.dynamics(sim)
        course = flow_command(
            f"erate {along!r}",
            f"vel {along * yz!r}" if yz else "",
            "v" if dynamics.inertia else "x",
        )
        of_noise, duration = self.noise(start, done), abs(strain) / rate / steps
        if dynamics.inertia and not done:
            _flow_begins(sim, along)
            before = None
        yield from _flow(
            sim, dynamics, rate, duration, strains, lambda *_: course, of_noise, done, before
        )


def check_shear(sim: Simulation, strain: float, steps: int) -> None:
    """Refuse what `shear` cannot do."""
    count("steps", steps)
    if finite("strain", strain) == 0.0:
        raise ParameterError("strain must not be 0: relax the simulation instead")
    refuse_walls(sim)


def refuse_walls(sim: Simulation) -> None:
    """Refuse walls, which do not follow a shear.

    Raises:
        ParameterError: there are some.
    """
    if sim.walls:
        raise ParameterError(
            f"walls are not sheared, and this simulation has {len(sim.walls)}, the first a "
            f"{kind_of(sim.walls[0])}: shear needs a periodic box without walls"
        )


def sheared_state(sim: Simulation, by: float, strain: float, tolerance: float | None) -> State:
    """The relaxed state after a further strain, which leads to this one in all."""
    straighten(sim)
    sim.deform(sheared(sim.box, by))
    sim.shear_strain = strain
    return sim.relax() if tolerance is None else sim.relax(tolerance)


# States of a cycle at least: with three, the first harmonic is not told from a constant and others.
_FEWEST = 8

# Time steps of a cycle at least, as their error is a part pi/steps of G'', see `harmonic`.
_STEPS = 4000

# Displacement of the upper side of the box since the begin of a run, and its rate, for LAMMPS. Fix
# deform moves the box after the forces of a step, which would lag behind it: so it is one step
# ahead, but not at the end. The second step makes up for the first one, whose forces still lag.
_COURSE = """
variable deformable_ahead equal (elapsed+1+(elapsed==1))*dt
variable deformable_time equal ternary(v_deformable_ahead<{end!r},v_deformable_ahead,{end!r})
variable deformable_phase equal {omega!r}*({begin!r}+v_deformable_time)
variable deformable_tilt equal {width!r}*(sin(v_deformable_phase)-{shift!r})
variable deformable_rate equal {width!r}*{omega!r}*cos(v_deformable_phase)
variable deformable_tilt_z equal {part!r}*v_deformable_tilt
variable deformable_rate_z equal {part!r}*v_deformable_rate
"""


@dataclass(frozen=True, kw_only=True)
class Oscillate(Flow):
    """See `Simulation.oscillate`."""

    amplitude: float
    period: float
    cycles: int = 1
    steps: int = 40
    tolerance: float | None = None

    def check(self, sim: Simulation, recorded: bool) -> Oscillate:
        amplitude = float(positive("amplitude", self.amplitude))
        steps, period = count("steps", self.steps), self.period
        check_shear(sim, amplitude, steps)
        if steps < _FEWEST:
            raise ParameterError(f"steps must be at least {_FEWEST} in a cycle, not {steps}")
        cycles = count("cycles", self.cycles)
        checked = replace(self, amplitude=amplitude, steps=steps, cycles=cycles)
        if number_or_nan(period) == math.inf:
            self.refuse_without("period")
            usual = tolerance_under(amplitude, TOLERANCE)
            tolerance = usual if self.tolerance is None else self.tolerance
            return replace(checked, period=math.inf, tolerance=check_tolerance(tolerance, recorded))
        return replace(checked, period=float(positive("period", period)), **self.flow_settings(sim))

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        return _begun(sim, self.steps * self.cycles)

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        amplitude, steps, period = self.amplitude, self.steps, self.period
        part = np.arange(1, start["states"] + 1) / steps
        begin = start["strain"]
        strains = (begin + amplitude * np.sin(2.0 * np.pi * (part % 1.0))).tolist()
        if period == math.inf:
            with following(sim, sim.state().packing, _step(amplitude, steps)):
                for n in range(done, len(strains)):
                    by = strains[n] - (strains[n - 1] if n else begin)
                    yield sheared_state(sim, by, strains[n], self.tolerance)
            return
        dynamics = replace(self.dynamics(sim), limit=period / _STEPS)
        omega, height = 2.0 * math.pi / period, float(sim.box[1, 1])
        course = _course(omega, amplitude * height, leans(sim) / height)
        rate, duration, of_noise = amplitude * omega, period / steps, self.noise(start, done)
        yield from _flow(sim, dynamics, rate, duration, strains, course, of_noise, done, before)


def _step(strain: float, steps: int) -> float:
    """Strain from a state to the next one at most, of so many in a cycle of this amplitude."""
    return 2.0 * math.pi * strain / steps


def _course(omega: float, width: float, part: float) -> Callable[[float, float], str]:
    """Commands for a run that begins so long after the start, and its length: width sin(omega t).

    Args:
        omega: of the strain [1/time].
        width: of the displacement of the upper side [length].
        part: of it that the side along z takes in a box that leans along y.
    """
    xz = "variable v_deformable_tilt_z v_deformable_rate_z" if part else ""

    def commands(begin: float, duration: float) -> str:
        values = {"begin": begin, "end": duration, "shift": math.sin(omega * begin)}
        variables = _COURSE.format(omega=omega, width=width, part=part, **values)
        return variables + flow_command("variable v_deformable_tilt v_deformable_rate", xz)

    return commands


@dataclass(frozen=True)
class DynamicModulus:
    """The first harmonic of the stress under a strain gamma sin(omega t), over gamma.

    Attributes:
        storage: G', in phase with the strain [energy/length^d].
        loss: G'', in phase with the rate [energy/length^d].
        storage_error: standard error of the mean of G' over cycles, and what forces that are not
            balanced, and time steps, may add [energy/length^d].
        loss_error: the same of G'' [energy/length^d].
        harmonics: amplitude of the stress that is none of this, over that which is: noise, and
            higher harmonics where the response is not linear.
    """

    storage: float
    loss: float
    storage_error: float
    loss_error: float
    harmonics: float


def _of_steps(settings: Mapping[str, Any]) -> float:
    """Error of G' and of G'' by time steps, over G'', at most.

    Euler's method has (exp(i omega dt) - 1)/dt in place of i omega, that is a change of it by
    -omega^2 dt/2. Modes that relax at rates k take w/(k + i omega) from the affine modulus, which
    changes by at most omega dt/2 of their part w omega/(k^2 + omega^2) of G''.
    """
    period = settings["period"]
    if period == math.inf:
        return 0.0
    longest = min(settings["timestep"] or period / _STEPS, period / settings["steps"])
    return math.pi * longest / period


def harmonic(run: Run, skip: int) -> DynamicModulus:
    """See `Run.complex_modulus`."""
    settings = run.parameters
    if settings.get("protocol") != "oscillate":
        raise ParameterError(
            "G' and G'' follow from the stress of oscillate: this run is another one"
        )
    steps, strain = settings["steps"], settings["amplitude"]
    if whole("skip", skip) < 0:
        raise ParameterError(f"skip must not be negative, not {skip}")
    cycles = (len(run) - 1) // steps - skip
    if cycles < 2:
        raise ParameterError(
            f"at least 2 cycles must be left, as their scatter is the error, not {cycles} of "
            f"{(len(run) - 1) // steps}: take more cycles, or a smaller skip"
        )
    numbers = run.table()
    left, stress = (
        numbers[name][1 : 1 + steps * (cycles + skip)] for name in ("residual", "shear_stress")
    )
    quasistatic = settings["period"] == math.inf
    unbalanced = float(left.max()) if quasistatic else imbalance_under(_step(strain, steps))
    bound = unbalanced_modulus(run[0], unbalanced, strain)
    phase = 2.0 * np.pi * np.arange(1, steps + 1) / steps
    cycle = stress.reshape(-1, steps)[skip:]
    storage, loss = (
        2.0 / (steps * strain) * np.sum(cycle * wave, axis=1)
        for wave in (np.sin(phase), np.cos(phase))
    )
    rest = cycle - cycle.mean(axis=1, keepdims=True)
    rest -= strain * (np.outer(storage, np.sin(phase)) + np.outer(loss, np.cos(phase)))
    size = strain * np.sqrt(np.mean(storage**2 + loss**2) / 2.0)
    scatter = np.std([storage, loss], axis=1, ddof=1) / np.sqrt(cycles)
    storage_error, loss_error = np.hypot(scatter, bound + _of_steps(settings) * abs(loss.mean()))
    return DynamicModulus(
        float(storage.mean()),
        float(loss.mean()),
        float(storage_error),
        float(loss_error),
        float(np.sqrt(np.mean(rest**2)) / size) if size else 0.0,
    )


# LAMMPS' pressure tensor has the opposite sign of a stress that resists shear.
_CREEP = """
fix deformable_flow all deform/pressure 1 xy pressure {target!r} {gain!r} max/rate {most!r} remap x
fix_modify deformable_flow press deformable_virial
"""


def _usual_viscosity(drag: float, packing: Packing) -> float:
    """The drag, in space over the mean diameter."""
    return drag / (1.0 if packing.dimension == 2 else 2.0 * float(packing.radii.mean()))


@dataclass(frozen=True, kw_only=True)
class Creep(Flow):
    """See `Simulation.creep`."""

    shear_stress: float
    time: float
    viscosity: float | None = None

    def check(self, sim: Simulation, recorded: bool) -> Creep:
        refuse_walls(sim)
        if leans(sim):
            raise ParameterError(
                f"a box that leans along y, by yz = {leans(sim):.4g}, does not creep: take one "
                "without that tilt, or shear it at a rate"
            )
        viscosity = self.viscosity
        return Creep(
            shear_stress=float(finite("shear_stress", self.shear_stress)),
            time=float(positive("time", self.time)),
            steps=count("steps", self.steps),
            viscosity=None if viscosity is None else float(positive("viscosity", viscosity)),
            **self.flow_settings(sim),
        )

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        """The present state, and the largest rate of the flow under the stress."""
        assert self.drag is not None
        state, start = _begun(sim, self.steps)
        usual = _usual_viscosity(self.drag, state.packing)
        viscosity = self.viscosity or usual
        fastest = 2.0 * (abs(self.shear_stress) + abs(state.shear_stress)) / viscosity
        if fastest == 0.0:
            raise ParameterError("shear_stress must not be 0 in a packing that has none")
        return state, start | {"viscosity": viscosity, "usual": usual, "fastest": fastest}

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        viscosity, fastest, steps = start["viscosity"], start["fastest"], self.steps
        most = fastest * float(sim.box[1, 1])  # velocity of the upper side of the box
        course = _CREEP.format(target=-self.shear_stress, gain=1.0 / viscosity, most=most).strip()
        damped = replace(self.dynamics(sim), part=min(1.0, viscosity / start["usual"]))
        duration, unknown, of_noise = self.time / steps, [None] * steps, self.noise(start, done)
        yield from _flow(
            sim, damped, fastest, duration, unknown, lambda *_: course, of_noise, done, before
        )
