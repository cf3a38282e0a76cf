"""The last digits of a relaxation, by Newton's method."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError, StalledWarning
from ..common.validate import expect, positive
from ..engine.close_balance import closely_balanced
from ..engine.disks import Disks
from ..engine.lammps import place_particles
from ..engine.simulation import Simulation
from ..state.disk_state import DiskState
from ..state.state import State

S = TypeVar("S", State, DiskState)

# Steps at most; a step that moves a particle by more than this part of the smallest radius leads
# elsewhere.
_STEPS, _LONGEST = 6, 0.05

# Rattlers move away from what they touch by so much more than needed, and than others move.
_FURTHER = 1.1


def polish(state: S, tolerance: float = 1e-10) -> S:
    """Relax a relaxed state further, with the same contacts: Newton's method, a few steps.

    A step solves H u = f with the Hessian of the contact network. Rattlers are moved away from what
    they touch. `balanced` and `tilted` contacts are balanced to rounding meanwhile.

        fine = deformable.polish(sim.relax())
        sim.restart(fine.packing)

    Args:
        state: of a `Simulation` or of `Disks`, relaxed, e.g. to the default tolerance; it does not
            change.
        tolerance: largest force on a particle over the mean contact force.

    Returns:
        The polished state. If the contact network would change, or the forces do not fall to the
        tolerance, the state of the smallest forces; its `stalled` is true then.

    Raises:
        ParameterError: a value is out of range, or the state has no Hessian, see `State.hessian`.

    Warns:
        StalledWarning: the tolerance was not reached.
    """
    expect("state", state, State, DiskState)
    positive("tolerance", tolerance)
    state.hessian()  # or refuse the state
    with closely_balanced(state.packing, state.law) as sim:
        best: Any = _newton(sim, sim.state(), tolerance)
    root = getattr(state, "root", True)
    if isinstance(best, State):
        best = replace(best, root=root, velocities=state.velocities, time=state.time)
    if best.residual <= tolerance:
        return best  # type: ignore[no-any-return]
    if root:
        warnings.warn(
            f"Newton's method ended at {best.residual:.2g} of the mean contact force, not "
            f"{tolerance:.2g}: relax to a smaller tolerance first",
            StalledWarning,
            stacklevel=2,
        )
    return replace(best, stalled=True)  # type: ignore[no-any-return]


def _newton(sim: Simulation | Disks, start: State | DiskState, tolerance: float) -> Any:
    """The state of the smallest forces."""
    longest = _LONGEST * float(start.packing.radius.min())
    best = state = start
    for _ in range(_STEPS):
        step = None if best.residual <= tolerance else _step(state)
        if step is None or np.hypot(*step.T).max() > longest:
            break
        place_particles(sim.lmp, state.packing.positions + step)
        state = sim.state()
        if _network(state) != _network(start):
            break
        best = min(best, state, key=lambda each: each.residual)
    return best


def _network(state: State | DiskState) -> list[tuple[int, int]]:
    """Pairs of particles in the contact network, in order; -1 is a wall."""
    i, j = (side[state._in_network] for side in state._contact_sides)
    return sorted(zip(i.tolist(), j.tolist(), strict=True))


def _step(state: State | DiskState) -> NDArray[np.float64] | None:
    """Displacements, shape (N, 2) [length]; None if there is no resistance to the forces."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import lsqr

    hessian = state.hessian(rattlers=False)
    try:
        step = -hessian.response(hessian.gradient)[: hessian.size]
    except ParameterError:
        return None
    sides, needed = state.rattler_contacts()
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
