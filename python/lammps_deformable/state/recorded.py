"""What is recorded of a state, and which time steps its particles can take."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..formats.store import TEMPERATURE, Motion, as_columns, save
from ..particles.commands import SOFT_STEP
from ..particles.friction import rubbing_as_columns, rubbing_step
from ..particles.laws import (
    HOTTEST,
    AnyLaw,
    Droplet,
    Ring,
    Sector,
    SoftContact,
    accurate_step,
)

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from ..particles.packing import Packing
    from .state import State

Floats = NDArray[np.float64]

# Laws with particles that deform and move; those of which states can be saved.
MOVING = (Ring, Sector, Droplet)
SAVED = (*MOVING, SoftContact)

# Columns of a trajectory by the names of results, where they differ.
COLUMNS = {
    "perimeters": "perimeter",
    "pressures": "pressure",
    "n_contacts": "contacts",
    "arc_radii": "arc_radius",
    "surface_areas": "surface_area",
    "contact_areas": "contact_area",
    "loads": "load",
}


def motion_of(state: State) -> Motion:
    """What goes on with a simulation from this state, beside the packing."""
    history = state.velocities, state.time, state.shear_strain, state.films, state.directions
    lost = state.lost_energy - sum(state.rubbing.lost if state.rubbing else ())
    return Motion(*history, state.rubbing, state.images, lost, state.labels, state.clones)


def numbers_of(state: State) -> dict[str, Any]:
    """The state in numbers, by name; `shear_strain` is None without shear."""
    box, axes = state.packing.box, "xyz"[: state.packing.dimension]
    sides = {f"l{axis}": float(box[k, k]) for k, axis in enumerate(axes)}
    tilts = {
        a + b: float(box[k, n]) for n, a in enumerate(axes) for k, b in enumerate(axes) if n < k
    }
    found = {
        "particles": len(state.packing),
        **sides,
        **tilts,
        "shear_strain": state.shear_strain,
        "phi": state.phi,
        "pressure": state.pressure,
        "shear_stress": state.shear_stress,
        "energy": state.energy,
        "coordination": state.coordination,
        "rattlers": int(np.sum(state.rattlers)),
        "residual": state.residual,
        "stalled": not state.converged,
        "minimizer": state.minimizer or "none",
        "iterations": state.iterations,
    }
    if isinstance(state.law, SAVED):
        found |= {"temperature": state.temperature, "time": state.time}
    if isinstance(state.law, MOVING):
        name = "load" if isinstance(state.law, Droplet) else "shape_parameter"
        mean = np.mean(state.loads if name == "load" else state.shape_parameter)
        found |= {name: float(mean), "beyond": state.beyond}
    return found


def particle_values(state: State) -> dict[str, NDArray[Any]]:
    """Values of the particles by their names in a trajectory, arrays of shape (N,)."""
    found: dict[str, NDArray[Any]] = {"radius": state.packing.radii}
    if isinstance(state.law, SoftContact):
        found["area" if state.packing.dimension == 2 else "volume"] = state.volumes
        found |= {"pressure": state.pressures, "contacts": state.n_contacts}
    for name, values in state.results.items():
        found[COLUMNS.get(name, name)] = values
    found["rattler"] = state.rattlers.astype(int)
    if isinstance(state.law, SAVED):
        found |= dict(zip(("vx", "vy", "vz"), state.velocities.T, strict=False))
        found |= {**as_columns(motion_of(state)), **rubbing_as_columns(state.rubbing)}
    return found


def write_state(
    state: State, folder: Path, parameters: Mapping[str, Any] | None, frames: int | None = None
) -> None:
    """Write the state behind so many recorded frames up to it, if any."""
    steps = _time_steps(state)
    numbers = numbers_of(state)
    packing, law = state.packing, state.law
    forces = state.friction, state.gravity
    save(folder, packing, law, steps, numbers, motion_of(state), parameters, frames, *forces)


def _time_steps(state: State) -> tuple[float, float]:
    """For the script in the folder: of a minimization, and of a motion [time]."""
    if isinstance(state.law, SoftContact):
        return (SOFT_STEP / state.law.k**0.5,) * 2
    packing, law, squeeze, now = step_limits(state)
    longest = rubbing_step(state.friction) if state.friction else np.inf
    return (
        min(accurate_step(packing, law, squeeze, now), longest),
        min(accurate_step(packing, law, squeeze, max(now, TEMPERATURE)), longest),
    )


def step_limits(state: State) -> tuple[Packing, AnyLaw, float, float]:
    """The arguments of `longest_step` and `accurate_step`."""
    return state.packing, state.law, float(squeeze_of(state)[1].max()), heat_of(state)


def squeeze_of(state: State) -> tuple[str, Floats]:
    """What limits time steps: its name, the pressure in each particle or the load."""
    name = "load" if isinstance(state.law, Droplet) else "pressure"
    return name, state.results["loads" if name == "load" else "pressures"]


def heat_of(state: State) -> float:
    """Temperature at which particles collide as hard as in this motion [energy].

    All may hit a wall together, so that their common motion counts where there are walls. The
    fastest particle counts as the fastest one in a heat bath; and none can have more energy
    than all together.
    """
    common = 0.0 if state.packing.walls else state.velocities.mean(axis=0)
    energies = 0.5 * np.sum((state.velocities - common) ** 2, axis=1)
    mean = max(state.temperature, 2.0 * float(energies.mean()) / state.packing.dimension)
    largest, total = float(energies.max()) / HOTTEST, float(energies.sum()) / HOTTEST
    return max(largest, min(mean, total))
