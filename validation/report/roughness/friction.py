"""How smooth polygons are: the friction of two polygons, and the hysteresis of a packing."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from lammps_deformable.compression import compress
from lammps_deformable.errors import ParameterError
from lammps_deformable.jamming import jam
from lammps_deformable.lammps import run
from lammps_deformable.packing import Packing
from lammps_deformable.polygon_simulation import PolygonSimulation
from lammps_deformable.polygons import PolygonModel
from lammps_deformable.random import bidisperse
from lammps_deformable.relax import minimize_command
from lammps_deformable.state import PolygonState
from mpi4py import MPI

# Two equal polygons side by side in a row, which meet at both of their sides.
_RADIUS = 0.5

# Steps that press polygons together, each below the radius of a bead.
_STEPS = 8

# Iterations of one call of FIRE, and calls after which forces have stopped falling.
_ITERATIONS, _CALLS = 20_000, 50


def sliding(
    model: PolygonModel, indentation: float = 0.04, turns: int = 12, tolerance: float = 1e-4
) -> dict[str, Any]:
    """The forces between two polygons that are pressed together, while one of them turns.

    The polygons stand in a row and meet at their left and right sides. The vertices at the top and
    at the bottom of both are held. Those of the second polygon turn about its center by one vertex
    spacing, in steps, and all others come to rest. The contacts then slide by one spacing.

    Args:
        model: of the polygons, N_v a multiple of 4; its radii are 0.5.
        indentation: a/R of the effective radius R.
        turns: number of steps.
        tolerance: of each relaxation, see `PolygonState.residual`.

    Returns:
        `n_v` and `smooth`; `slide`, in spacings; `normal` and `tangential`, the forces of a contact
        after each step, lists, tangential against the motion [energy/length]; `friction`, the
        difference of the largest and smallest tangential force over the mean normal force;
        `residual`, the largest of all steps.

    Raises:
        ParameterError: N_v is no multiple of 4, or the indentation is not between 0 and 0.2.
    """
    if not 0.0 < indentation < 0.2:
        raise ParameterError(f"indentation must lie between 0 and 0.2, not {indentation}")
    polygons = model.polygons(np.array([_RADIUS]))
    (count,), (touch,) = polygons.number, polygons.effective_radius
    if count % 4:
        raise ParameterError(f"the number of vertices must be a multiple of 4, not {count}")
    # the polygon that turns lies in the middle of the box
    centers = np.array([[0.0, 2.0], [2.0 * touch, 2.0]])
    box = np.diag([4.0 * touch, 4.0])
    packing = Packing(centers, np.zeros(2, np.int64), np.array([_RADIUS]), box)
    with PolygonSimulation(packing, model, comm=MPI.COMM_SELF) as pair:
        lmp = pair.lmp
        top, bottom = 1 + count // 4, 1 + 3 * count // 4  # of the first polygon, by atom ID
        for n in range(1, _STEPS + 1):
            pair.deform(packing.box * [[1.0 - indentation * n / _STEPS, 1.0], [1.0, 1.0]])
            _rest(pair, tolerance)
        run(lmp, f"group held id {top} {bottom} {top + count} {bottom + count}")
        run(lmp, "fix held held setforce 0 0 0")
        run(lmp, "group turning molecule 2")
        states = []
        for _ in range(turns):
            x, y = pair.state().packing.positions[1].tolist()
            step = f"{x!r} {y!r} 0 0 0 1 {360.0 / int(count) / turns!r}"
            run(lmp, f"displace_atoms turning rotate {step} units box")
            states.append(_rest(pair, tolerance))
    forces = np.array([_forces(state) for state in states])
    normal, tangential = forces.T
    return {
        "n_v": int(count),
        "smooth": model.smooth,
        "slide": [(n + 1) / turns for n in range(turns)],
        "normal": normal.tolist(),
        "tangential": tangential.tolist(),
        "friction": float(np.ptp(tangential) / normal.mean()),
        "residual": max(state.residual for state in states),
    }


def _rest(pair: PolygonSimulation, tolerance: float) -> PolygonState:
    """Let vertices that are not held come to rest by FIRE."""
    state = pair.state()
    for _ in range(_CALLS):
        if state.residual <= tolerance:
            break
        pressed = np.maximum(state.polygons.kA[0] * state.area_deficit, 0.0).mean()
        force = tolerance * pressed * float(state.polygons.spacing[0])
        run(pair.lmp, minimize_command(float(0.5 * force), _ITERATIONS))
        state = pair.state()
    return state


def _forces(state: PolygonState) -> tuple[float, float]:
    """Mean normal and tangential forces of both contacts on the first polygon.

    The second one turns counterclockwise: its left side goes down and its right side up.
    """
    to_left = np.sign(
        state.contact_table.force[:, 0]
    )  # from the second polygon, at the right of the first
    normal = np.abs(state.contact_table.force[:, 0]).mean()
    return float(normal), float(np.mean(to_left * state.contact_table.force[:, 1]))


def hysteresis(
    number: int, seed: int, model: PolygonModel, strain: float = 0.03, steps: int = 6
) -> list[dict[str, Any]]:
    """A packing of polygons compressed from jamming, and expanded again.

    Args:
        number: of particles.
        seed: of the random start.
        model: of the polygons.
        strain: largest linear strain.
        steps: number of steps on each way.

    Returns:
        A row for each strain below the largest: `seed`, `n_v`, `smooth`; `energy_forth`,
        `energy_back`, their `ratio` back over forth, and the residuals, `residual_forth` and
        `residual_back`.
    """
    start = jam(bidisperse(number, seed=seed))
    with PolygonSimulation(start, model, comm=MPI.COMM_SELF) as polygons, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the rows have the residuals
        forth = list(compress(polygons, strain, steps))
        back = []
        for n in range(steps - 1, 0, -1):
            polygons.deform(start.box * (1.0 - strain * n / steps))
            back.append(polygons.relax())
    return [
        {
            "seed": seed,
            "n_v": int(polygons.polygons.number.min()),
            "smooth": model.smooth,
            "strain": strain * (n + 1) / steps,
            "energy_forth": there.energy,
            "energy_back": again.energy,
            "ratio": again.energy / there.energy,
            "residual_forth": there.residual,
            "residual_back": again.residual,
        }
        for n, (there, again) in enumerate(zip(forth, reversed(back), strict=False))
    ]
