"""Boxes that simple shear tilts.

Flow at a rate: LAMMPS shears the box, and friction holds particles to the mean flow.

Simple shear: quasistatic, tilt the box a little, relax, again; or at a rate.

Oscillatory shear, and the storage and loss modulus.

Creep: a shear stress that stays, under which the box shears.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ._checks import count, expect, finite, number_or_nan, positive, whole
from .errors import ParameterError
from .lammps import run
from .laws import Droplet, Ring, Sector
from .motion import Dynamics, advance, dynamics_of, moving, refuse_restarted, seeds
from .polishing import balanced_to
from .progress import Steps, progress
from .relax import TOLERANCE
from .simulation import Simulation
from .small_strains import (
    following,
    imbalance_under,
    tolerance_under,
    unbalanced_modulus,
)
from .state import State

if TYPE_CHECKING:
    pass


def sheared(points: NDArray[np.float64], strain: float) -> NDArray[np.float64]:
    """Points, or the rows of a box, after simple shear along x, shape (n, d) [length]."""
    moved = np.array(points)
    moved[:, 0] += strain * points[:, 1]
    return moved


def straighten(sim: Any) -> None:
    """Replace the box by the equivalent one with the smallest tilts; the particles stay."""
    box = sim.box
    straight = straightened(box)
    places = {"xy": (1, 0), "xz": (2, 0), "yz": (2, 1)}
    ends = [
        f"{name} final {float(straight[place])!r}"
        for name, place in places.items()
        if max(place) < len(box) and straight[place] != box[place]
    ]
    if ends:
        run(sim.lmp, f"change_box all {' '.join(ends)} units box")


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


def flow_dynamics(
    sim: Simulation,
    friction: float | None,
    temperature: float | None,
    timestep: float | None,
    tolerance: float | None,
    seed: int | None,
) -> tuple[Simulation, Dynamics]:
    """What flows, and overdamped motion relative to the mean flow.

    Raises:
        ParameterError: a value is out of range, the friction is missing, a tolerance is given, or
            the law has no motion.
    """
    if not isinstance(sim.law, Ring | Sector | Droplet):
        raise ParameterError(
            f"a simulation of {sim.law!r} is sheared without a rate only: take Ring or Droplet"
        )
    if friction is None:
        raise ParameterError("a flow needs the friction of particles against it: give friction")
    if tolerance is not None:
        raise ParameterError("states of a flow are not relaxed: leave tolerance out")
    return sim, dynamics_of(sim, temperature, friction, False, timestep, seed)


def refuse_without_flow(name: str, **given: object) -> None:
    """Refuse what belongs to a flow, where the value of this name that makes one is missing.

    Raises:
        ParameterError: some of it is given.
    """
    for other, value in given.items():
        if value is not None:
            raise ParameterError(
                f"{other} has no meaning without a {name}, where each state is relaxed: give a "
                f"{name}, or leave it out"
            )


def flow(
    sim: Simulation,
    dynamics: Dynamics,
    rate: float,
    duration: float,
    strains: Sequence[float | None],
    course: Callable[[float], str],
    seed: int | None,
) -> Iterator[State]:
    """Shear the box, and yield the state after equal times.

    Args:
        sim: ends in the last state.
        dynamics: of the particles.
        rate: the largest one of the flow [1/time].
        duration: from a state to the next one [time].
        strains: of the states; None where the box tells it.
        course: commands for a run that begins so long after the first one, of which the last is a
            `flow_command`.
        seed: of the noise.
    """
    lmp, state = sim.lmp, sim.state()
    _, of_noise = seeds(sim, seed)
    with (
        balanced_to(sim, state.packing, imbalance_under(rate * duration)),
        moving(sim, dynamics, of_noise),
    ):
        drag = dynamics.friction * rate * 2.0 * float(state.packing.radii.max())
        limit = min(dynamics.limit, _OF_A_STEP / rate)
        dynamics = replace(dynamics, drive=drag, limit=limit)
        pieces = math.ceil(rate * duration / _OF_A_PIECE)
        with progress("shearing", unit="state", total=len(strains)) as bar:
            for n, strain in enumerate(strains):
                for k in range(pieces):
                    begin = duration * (n + k / pieces)
                    state = _piece(sim, dynamics, duration / pieces, course(begin), state)
                if strain is not None:
                    sim.strain = strain
                state = replace(state, strain=sim.strain)
                bar.set_postfix(stress=f"{state.shear_stress:.3g}")
                bar.update()
                yield state
                refuse_restarted(sim, lmp)


def flow_command(xy: str, xz: str = "") -> str:
    """*fix deform*, which shears the box with the particles in it.

    Args:
        xy: how the tilt changes.
        xz: how the other tilt along x does, by the part yz/ly of that, in a box that leans along y:
            without it the flow would have a gradient along z too.
    """
    return f"fix deformable_flow all deform 1 xy {xy} {xz and f'xz {xz} '}remap x"


def leans(sim: Any) -> float:
    """Tilt yz of the straightened box, which a shear along x leaves as it is; 0 in the plane."""
    return float(straightened(sim.box)[2, 1]) if sim.dimension == 3 else 0.0


def _piece(
    sim: Simulation, dynamics: Dynamics, duration: float, course: str, state: State
) -> State:
    """The state after a flow with one time step, from the state before."""
    longest = dynamics.timestep or dynamics.default_step(state)
    steps = count("number of time steps to a state", math.ceil(duration / longest))
    dynamics.check(state, duration / steps)
    straighten(sim)
    tilt = float(sim.box[1, 0])
    run(sim.lmp, course)
    try:
        advance(sim, dynamics, steps, duration / steps)
    finally:
        run(sim.lmp, "unfix deformable_flow")
        sim.strain = (sim.strain or 0.0) + _strain_since(sim, tilt)
    return sim.state()


def _strain_since(sim: Simulation, tilt: float) -> float:
    """The smallest strain from a tilt of the box to that of now, as LAMMPS may have flipped it."""
    lx, xy, ly = sim.box[[0, 1, 1], [0, 0, 1]].tolist()
    widths = (xy - tilt) / lx
    return float(widths - round(widths)) * lx / ly


def shear(
    sim: Simulation,
    strain: float,
    steps: int = 10,
    tolerance: float | None = None,
    rate: float | None = None,
    friction: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> Iterator[State]:
    """Shear in equal steps, relaxing after each one, or at a rate; the size of the box stays.

    After step n the upper side of the box has moved along x by strain n / steps times its height.
    A state has the `shear_stress` that resists, and the `strain` of all calls of `shear` for one
    simulation. A box whose tilt exceeds half its width is replaced by the
    equivalent box with the smallest tilt, so that strains may be large.

    With a rate particles are overdamped, with a friction against the mean flow u = rate y along x,

        friction (dr/dt - u) = F + sqrt(2 friction temperature) noise

    as bubbles in Durian's model. LAMMPS' *fix deform* with *remap x* moves the box and the
    particles in it, *fix brownian* adds the rest. Velocities are 0 in all states.

    Args:
        sim: it ends in the last state.
        strain: total shear strain gamma; negative shears in the other direction.
        steps: number of steps, of which each yields a state.
        tolerance: of each relaxation; by default that of `sim.relax`.
        rate: strain per time, above 0 [1/time]; if not given, the shear is quasistatic. The law of
            flows is `Ring` or `Droplet`, and the next arguments belong to them.
        friction: force over velocity relative to the mean flow [1/time], as masses are 1.
        temperature: of the noise [energy]; without, there is none.
        timestep: length of a time step [time]; if not given it follows from the contacts, as in
            `move`, and is at most 5e-4/rate.
        seed: of the noise, as in `move`.

    Yields:
        The state after each step, with its `strain`; without a rate it is relaxed, with a rate it
        has a `time`.

    Raises:
        ParameterError: a value is out of range, or the simulation has walls; or see `move`.
        LammpsError: see `move`.

    Source: drag: Durian, Phys. Rev. Lett. 75, 4780 (1995).
    """
    expect("sim", sim, Simulation)
    check_shear(sim, strain, steps)
    before, strain, steps = sim.strain or 0.0, float(strain), int(steps)
    flowing = {"friction": friction, "temperature": temperature, "timestep": timestep}
    states: Iterator[State]
    if rate is None:
        refuse_without_flow("rate", **flowing, seed=seed)
        states = shear_steps(sim, before, strain, steps, 0, tolerance)
    else:
        rate = positive("rate", rate)
        flows, dynamics = flow_dynamics(sim, **flowing, tolerance=tolerance, seed=seed)
        along = math.copysign(rate, strain)
        yz = leans(flows)
        course = flow_command(f"erate {along!r}", f"vel {along * yz!r}" if yz else "")
        strains = [before + n * strain / steps for n in range(1, steps + 1)]
        duration = abs(strain) / rate / steps
        flowed = flow(flows, dynamics, rate, duration, strains, lambda _: course, seed)
        states = flowed
    return Steps("shear", states, lambda: replace(sim.state(), strain=before))


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
            f"{sim.walls[0].kind}: shear needs a periodic box without walls"
        )


def shear_steps(
    sim: Simulation,
    before: float,
    strain: float,
    steps: int,
    done: int,
    tolerance: float | None,
) -> Iterator[State]:
    """The remaining steps of a shear, after the steps done and the strain before the first one."""
    with progress("shearing", unit="step", total=steps, initial=done) as bar:
        for n in range(done + 1, steps + 1):
            state = sheared_state(sim, strain / steps, before + strain * n / steps, tolerance)
            bar.set_postfix(stress=f"{state.shear_stress:.3g}")
            bar.update()
            yield state


def sheared_state(sim: Simulation, by: float, strain: float, tolerance: float | None) -> State:
    """The relaxed state after a further strain, which leads to this one in all."""
    straighten(sim)
    sim.deform(sheared(sim.box, by))
    sim.strain = strain
    return sim.relax() if tolerance is None else sim.relax(tolerance)


# States of a cycle at least: with three, the first harmonic is not told from a constant and others.
_FEWEST = 8

# Time steps of a cycle at least: the stress lags behind the strain by half a step.
_STEPS = 4000

# Displacement of the upper side of the box since the begin of a run, and its rate, for LAMMPS.
_COURSE = """
variable deformable_phase equal {omega!r}*({begin!r}+elapsed*dt)
variable deformable_tilt equal {width!r}*(sin(v_deformable_phase)-{shift!r})
variable deformable_rate equal {width!r}*{omega!r}*cos(v_deformable_phase)
variable deformable_tilt_z equal {part!r}*v_deformable_tilt
variable deformable_rate_z equal {part!r}*v_deformable_rate
"""


def oscillate(
    sim: Simulation,
    strain: float,
    period: float | None = None,
    cycles: int = 1,
    steps: int = 40,
    tolerance: float | None = None,
    friction: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> Iterator[State]:
    """Shear to and fro, by strain sin(2 pi t/period) about the strain of the start.

    With a period particles flow as in `shear` at a rate: overdamped, with a friction against the
    flow (LAMMPS' *fix deform* with *remap x*, and *fix brownian*). Without a period, or with an
    infinite one, each state is relaxed.

    Args:
        sim: it ends in the last state.
        strain: amplitude of the shear strain, above 0.
        period: of a cycle [time]; None or infinite: quasistatic.
        cycles: number of cycles.
        steps: states of a cycle, 8 or more, after equal parts of it.
        tolerance: of the relaxations without a period; by default 1e-4 of the strain, at most
            1e-6.
        friction: as in `shear`, with a period.
        temperature: as in `shear`.
        timestep: as in `shear`.
        seed: as in `shear`.

    Yields:
        The states, from the first part of the first cycle to the end of the last one.

    Raises:
        ParameterError: see `shear`.
        LammpsError: see `shear`.
    """
    expect("sim", sim, Simulation)
    strain = positive("strain", strain)
    check_shear(sim, strain, count("steps", steps))
    if steps < _FEWEST:
        raise ParameterError(f"steps must be at least {_FEWEST} in a cycle, not {steps}")
    flowing = {"friction": friction, "temperature": temperature, "timestep": timestep}
    before = sim.strain or 0.0
    part = np.arange(1, steps * count("cycles", cycles) + 1) / steps
    strains = (before + strain * np.sin(2.0 * np.pi * (part % 1.0))).tolist()
    states: Iterator[State]
    if period is None or number_or_nan(period) == math.inf:
        refuse_without_flow("period", **flowing, seed=seed)
        if tolerance is None:
            tolerance = tolerance_under(strain, TOLERANCE)
        states = _relaxed(sim, before, strains, tolerance, _step(strain, steps))
    else:
        period = positive("period", period)
        flows, dynamics = flow_dynamics(sim, **flowing, tolerance=tolerance, seed=seed)
        dynamics = replace(dynamics, limit=period / _STEPS)
        omega = 2.0 * math.pi / period
        height = float(sim.box[1, 1])
        course = _course(omega, strain * height, leans(flows) / height)
        flowed = flow(flows, dynamics, strain * omega, period / steps, strains, course, seed)
        states = flowed
    return Steps("oscillate", states, lambda: replace(sim.state(), strain=before))


def _step(strain: float, steps: int) -> float:
    """Strain from a state to the next one at most, of so many in a cycle of this amplitude."""
    return 2.0 * math.pi * strain / steps


def _course(omega: float, width: float, part: float) -> Callable[[float], str]:
    """Commands for a run that begins so long after the start: by width sin(omega t).

    Args:
        omega: of the strain [1/time].
        width: of the displacement of the upper side [length].
        part: of it that the side along z takes in a box that leans along y.
    """
    xz = "variable v_deformable_tilt_z v_deformable_rate_z" if part else ""

    def commands(begin: float) -> str:
        shift = math.sin(omega * begin)
        variables = _COURSE.format(omega=omega, begin=begin, shift=shift, width=width, part=part)
        return variables + flow_command("variable v_deformable_tilt v_deformable_rate", xz)

    return commands


def _relaxed(
    sim: Simulation, before: float, strains: Sequence[float], tolerance: float, step: float
) -> Iterator[State]:
    """The relaxed states at these strains, which differ by this step at most."""
    with (
        following(sim, sim.state().packing, step),
        progress("shearing", unit="state", total=len(strains)) as bar,
    ):
        for strain in strains:
            state = sheared_state(sim, strain - before, strain, tolerance)
            bar.set_postfix(stress=f"{state.shear_stress:.3g}")
            bar.update()
            yield state
            before = strain


@dataclass(frozen=True)
class DynamicModulus:
    """The first harmonic of the stress under a strain gamma sin(omega t), over gamma.

    Attributes:
        storage: G', in phase with the strain [energy/length^d].
        loss: G'', in phase with the rate [energy/length^d].
        storage_error: standard error of the mean of G' over cycles, and what forces that are not
            balanced may add [energy/length^d].
        loss_error: the same of G'' [energy/length^d].
        harmonics: amplitude of the stress that is none of this, over that which is: noise, and
            higher harmonics where the response is not linear.
    """

    storage: float
    loss: float
    storage_error: float
    loss_error: float
    harmonics: float


def dynamic_modulus(
    state: State,
    strain: float,
    period: float | None = None,
    cycles: int = 3,
    discarded: int = 1,
    steps: int = 40,
    tolerance: float | None = None,
    friction: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> DynamicModulus:
    """G' and G'' of a state, which does not change, from the stress of `oscillate`.

    The stress sigma of a cycle of n states gives G' = 2/(n strain) sum sigma sin(omega t), and G''
    with the cosine. A slow flow has the G' of `shear_modulus`. Linear response is
    `state.complex_modulus`, without an amplitude and without noise.

    Contacts and, without a period, relaxed forces are balanced up to a part epsilon of the largest
    or mean contact force. With |F_c| and d_c of the contacts and the room V the error of the stress
    is about epsilon sum |F_c| d_c/(d V), in errors divided by the strain.

    Args:
        state: of a `Simulation`.
        strain: amplitude. Small packings respond linearly up to some hundredth of phi - phi_J.
        period: of a cycle [time]; None or infinite: quasistatic.
        cycles: number of cycles that count, 2 or more for an error.
        discarded: number of cycles before, in which the response settles.
        steps: as in `oscillate`, as all that follows.
        tolerance: of relaxations.
        friction: with a period.
        temperature: of the noise.
        timestep: of the flow.
        seed: of the noise.

    Raises:
        ParameterError: see `oscillate`.
        LammpsError: see `oscillate`.
    """
    expect("state", state, State)
    if count("cycles", cycles) < 2:
        raise ParameterError("cycles must be at least 2, as their scatter is the error, not 1")
    if whole("discarded", discarded) < 0:
        raise ParameterError(f"discarded must not be negative, not {discarded}")
    with Simulation(state, state.law, comm=MPI.COMM_SELF) as sim:
        states = oscillate(
            sim,
            strain,
            period,
            cycles + discarded,
            steps,
            tolerance,
            friction,
            temperature,
            timestep,
            seed,
        )
        stress, left = np.array([(each.shear_stress, each.residual) for each in states]).T
    quasistatic = period is None or number_or_nan(period) == math.inf
    unbalanced = float(left.max()) if quasistatic else imbalance_under(_step(strain, steps))
    bound = unbalanced_modulus(state, unbalanced, strain)
    phase = 2.0 * np.pi * np.arange(1, steps + 1) / steps
    cycle = stress.reshape(-1, steps)[discarded:]
    storage, loss = (
        2.0 / (steps * strain) * np.sum(cycle * wave, axis=1)
        for wave in (np.sin(phase), np.cos(phase))
    )
    rest = cycle - cycle.mean(axis=1, keepdims=True)
    rest -= strain * (np.outer(storage, np.sin(phase)) + np.outer(loss, np.cos(phase)))
    size = strain * np.sqrt(np.mean(storage**2 + loss**2) / 2.0)
    scatter = np.std([storage, loss], axis=1, ddof=1) / np.sqrt(cycles)
    storage_error, loss_error = np.hypot(scatter, bound)
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


def creep(
    sim: Simulation,
    stress: float,
    time: float,
    steps: int = 10,
    friction: float | None = None,
    viscosity: float | None = None,
    temperature: float | None = None,
    timestep: float | None = None,
    seed: int | None = None,
) -> Iterator[State]:
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
    expect("sim", sim, Simulation)
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

    def states() -> Iterator[State]:
        start = sim.state()
        held, radius = start.shear_stress, float(start.packing.radii.mean())
        usual = dynamics.friction / (1.0 if sim.dimension == 2 else 2.0 * radius)
        viscosity = given or usual
        fastest = 2.0 * (abs(stress) + abs(held)) / viscosity
        if fastest == 0.0:
            raise ParameterError("stress must not be 0 in a packing that has none")
        most = fastest * float(sim.box[1, 1])  # velocity of the upper side of the box
        course = _CREEP.format(target=-stress, gain=1.0 / viscosity, most=most).strip()
        damped = replace(dynamics, part=min(1.0, viscosity / usual))
        duration, unknown = time / steps, [None] * steps
        yield from flow(sim, damped, fastest, duration, unknown, lambda _: course, seed)

    return Steps("creep", states(), lambda: replace(sim.state(), strain=before))
