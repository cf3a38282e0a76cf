"""The last digits of a relaxation, by Newton's method; and how closely contacts are balanced."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .commands import balance_command
from .errors import ParameterError
from .lammps import has_other_fixes, place_particles, run, setup
from .laws import Droplet, Ring, Sector, SoftContact
from .relax import Iteration, tell
from .response import hessian_of, open_contacts

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .packing import Packing
    from .simulation import Simulation
    from .state import State

# Imbalance of contact lines over the largest force: the default of the pair style, and what
# rounding leaves.
USUAL, CLOSE = 1e-8, 1e-13

# With the usual balance FIRE is not asked for less than this. A relaxation that has stalled below
# the other residual goes on by Newton's method: dense packings amplify the imbalance that far.
_AIM, _STALLED = 1e-7, 1e-6

# Steps at most. A packing is the same one as long as no particle moves farther than this part of
# the smallest radius.
_STEPS, _FARTHEST = 8, 0.01

# Rattlers move away from what they touch by so much more than needed, and than others move.
_FURTHER = 1.1


@contextmanager
def balanced_to(sim: Simulation, packing: Packing, imbalance: float | None) -> Iterator[None]:
    """Leave this imbalance to the contacts of a simulation meanwhile; None: the present one."""
    begun, before = sim._begun, sim._imbalance
    other = imbalance not in (None, before) and isinstance(sim.law, Ring | Sector | Droplet)
    if imbalance is not None and other:
        balance(sim, packing, imbalance)
    try:
        yield
    finally:
        if other and not sim.closed and sim._begun == begun:
            balance(sim, packing, before)


def balance(sim: Simulation, packing: Packing, imbalance: float) -> None:
    """Leave this imbalance to the contacts from now on."""
    run(sim.lmp, balance_command(packing, sim.law, imbalance))
    sim._imbalance = imbalance
    # which knows the former command
    sim._setup = replace(sim._setup, definition=setup(sim.lmp).definition)


def fire_reaches(sim: Simulation, tolerance: float) -> float:
    """The residual that FIRE is asked for at least, where Newton's method does the rest."""
    law = sim.law
    lines = isinstance(law, Ring) and law.contact != "radical" and sim._imbalance >= USUAL
    return _AIM if lines and not sim.friction and not law.sticks and tolerance < USUAL else 0.0


def can_polish(sim: Simulation, state: State) -> bool:
    """Whether Newton's method may go on from a state: in the plane, with a Hessian, near rest."""
    plane = state.packing.dimension == 2 and isinstance(state.law, Ring | SoftContact)
    if not plane or state.residual >= _STALLED or has_other_fixes(sim.lmp, sim._setup):
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
        for number in range(1, _STEPS + 1):
            step = None if best.residual <= tolerance else _step(now)
            if step is None:
                break
            moved += step
            if np.hypot(*moved.T).max() > farthest:
                break
            place_particles(sim.lmp, now.packing.positions + step)
            now = sim.state()
            if sim.callback:
                numbers = now.phi, now.pressure, now.residual, now.root
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
    try:
        step = -hessian.response(hessian.gradient)[: hessian.size]
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
