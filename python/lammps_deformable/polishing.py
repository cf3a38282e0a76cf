"""The last digits of a relaxation, by Newton's method."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ._checks import expect, positive
from .box import refuse_space
from .errors import ParameterError, StalledWarning
from .lammps import place_particles
from .ranks import world
from .relax import Callback, Iteration, check_callback, tell
from .small_strains import closely_balanced
from .state import DiskState, DropletState, SphereState, State

if TYPE_CHECKING:
    from .simulation import Simulation
    from .soft_disks import Disks

S = TypeVar("S", State, DiskState)

# Steps at most. A packing is the same one as long as no particle moves farther than this part of
# the smallest radius.
_STEPS, _FARTHEST = 8, 0.01

# Rattlers move away from what they touch by so much more than needed, and than others move.
_FURTHER = 1.1


def polish(state: S, tolerance: float = 1e-10, callback: Callback | None = None) -> S:
    """Relax a relaxed state further, in the same packing: Newton's method, a few steps.

    A step solves H u = f with the Hessian of the contact network. Rattlers are moved away from what
    they touch. Contacts that hardly bear may open or close. `balanced` and `curved` contacts are
    balanced to rounding meanwhile.

        fine = ld.polish(sim.relax())
        sim.restart(fine)

    Args:
        state: of a `Simulation` or of `Disks`, relaxed, e.g. to the default tolerance; it does not
            change.
        tolerance: largest force on a particle over the mean contact force. Close to the onset
            of jamming rounding may keep forces of rings at 1e-9, as they are cubes of tiny
            indentations.
        callback: called with an `Iteration` after each step. Its exception ends `polish`.

    Returns:
        The polished state. If a particle would move by more than a hundredth of the smallest
        radius, or the forces do not fall to the tolerance, it is the state of the smallest forces
        on the way, and `stalled` is true.

    Raises:
        ParameterError: a value is out of range, or the state has no Hessian, see `State.hessian`.

    Warns:
        StalledWarning: the tolerance was not reached.
    """
    expect("state", state, State, DiskState, DropletState, SphereState)
    refuse_space("polish", state.packing.dimension, "relax with a small tolerance, such as 1e-8")
    positive("tolerance", tolerance)
    check_callback(callback)
    root = getattr(state, "root", world().rank == 0)
    state.hessian()  # or refuse the state
    with closely_balanced(state.packing, state.law) as sim:
        best: Any = _newton(sim, sim.state(), tolerance, callback, root)
    best = replace(best, strain=state.strain)
    if isinstance(best, State) and isinstance(state, State):
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


def _newton(
    sim: Simulation | Disks,
    start: State | DiskState,
    tolerance: float,
    callback: Callback | None,
    root: bool,
) -> Any:
    """The state of the smallest forces."""
    farthest = _FARTHEST * float(start.packing.radii.min())
    best, state, moved = start, start, np.zeros((len(start.packing), 2))
    for number in range(1, _STEPS + 1):
        step = None if best.residual <= tolerance else _step(state)
        if step is None:
            break
        moved += step
        if np.hypot(*moved.T).max() > farthest:
            break
        place_particles(sim.lmp, state.packing.positions + step)
        state = sim.state()
        best = min(best, state, key=lambda each: each.residual)
        if callback:
            now = (state.phi, state.pressure, state.residual)
            tell(callback, Iteration("polish", number, *now, root), None)
    return best


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
