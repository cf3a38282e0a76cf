"""How smooth the polygons of the reference are: friction of two, hysteresis, and a crystal."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from lammps_deformable.common.errors import ParameterError
from lammps_deformable.engine.jamming import jam
from lammps_deformable.engine.lammps import run
from lammps_deformable.engine.relax import minimize_command
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.particles.generators import bidisperse
from lammps_deformable.particles.packing import Packing
from lammps_deformable.particles.polygons import DeformablePolygon
from lammps_deformable.reference.comparison import compressed, matching_laws, predict, timed
from lammps_deformable.reference.error_plot import POLYGON_NAMES, POLYGONS, SMOOTH
from lammps_deformable.state.state import State
from matplotlib.figure import Figure
from mpi4py import MPI

from validation.report.section import (
    RESIDUAL,
    Column,
    Picture,
    Row,
    Section,
    Table,
    legend_below,
    listed,
    percent,
    show,
)

# Two equal polygons side by side in a row, which meet at both of their sides.
_RADIUS = 0.5

# Steps that press polygons together, each below the radius of a bead.
_STEPS = 8

# Iterations of one call of FIRE, and calls after which forces have stopped falling.
_ITERATIONS, _CALLS = 20_000, 50


def sliding(
    model: DeformablePolygon, indentation: float = 0.04, turns: int = 12, tolerance: float = 1e-4
) -> dict[str, Any]:
    """The forces between two polygons that are pressed together, while one of them turns.

    The polygons stand in a row and meet at their left and right sides. The vertices at the top and
    at the bottom of both are held. Those of the second polygon turn about its center by one vertex
    spacing, in steps, and all others come to rest. The contacts then slide by one spacing.

    Args:
        model: of the polygons, N_v a multiple of 4; its radii are 0.5.
        indentation: a/R of the effective radius R.
        turns: number of steps.
        tolerance: of each relaxation, see `State.residual`.

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
    packing = Packing(centers, np.full(2, _RADIUS), box)
    with Simulation(packing, model, comm=MPI.COMM_SELF) as pair:
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


def _rest(pair: Simulation, tolerance: float) -> State:
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


def _forces(state: State) -> tuple[float, float]:
    """Mean normal and tangential forces of both contacts on the first polygon.

    The second one turns counterclockwise: its left side goes down and its right side up.
    """
    table = state.contacts
    force = table["force_vector"][table["i"] == 0]
    to_left = np.sign(force[:, 0])  # from the second polygon, at the right of the first
    return float(np.abs(force[:, 0]).mean()), float(np.mean(to_left * force[:, 1]))


def hysteresis(
    number: int, seed: int, model: DeformablePolygon, strain: float = 0.03, steps: int = 6
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
    start = jam(bidisperse(number, seed=seed)).packing
    with Simulation(start, model, comm=MPI.COMM_SELF) as polygons, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the rows have the residuals
        forth = [state for state, _ in timed(polygons, strain, steps)]
        back = []
        for n in range(steps - 1, 0, -1):
            polygons.deform(start.box * (1.0 - strain * n / steps))
            back.append(polygons.relax())
    return [
        {
            "seed": seed,
            "n_v": int(forth[0].polygons.number.min()),
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


_SIDE = 4


def crystal_row(model: DeformablePolygon, indentation: float) -> dict[str, Any]:
    """Equal polygons pressed into hexagons, against the exact shape.

    Each polygon is a regular hexagon with round corners, for which the ring laws are exact (docs/
    theory.md, "Regular polygons").

    Args:
        model: of the polygons.
        indentation: a/R.

    Returns:
        `n_v`, `indentation`; `energy_ratio`, of the polygons over the exact one; `residual`.
    """
    ((state, _),) = compressed(_touching(), model, indentation, 1)
    law = matching_laws(model, state.polygons)["balanced"]
    return {
        "n_v": int(state.polygons.number[0]),
        "indentation": indentation,
        "energy_ratio": state.energy / predict(state, law, MPI.COMM_SELF).energy,
        "residual": state.residual,
    }


def _touching() -> Packing:
    """Circles of one size that touch their six neighbors, in a rectangular box."""
    row, column = (index.ravel() for index in np.indices((_SIDE, _SIDE)))
    step, height = 2.0 * _RADIUS, np.sqrt(3.0) * _RADIUS
    return Packing(
        np.column_stack([(column + 0.5 * (row % 2)) * step, row * height]),
        np.full(column.size, _RADIUS),
        np.diag([_SIDE * step, _SIDE * height]),
    )


def figure(friction: Sequence[Row], hysteresis: Sequence[Row], crystal: Sequence[Row]) -> Figure:
    """Friction of two polygons, hysteresis of a packing, and the error of a crystal."""
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    for kind, style in POLYGONS.items():
        look = {"marker": style.marker, "color": style.color, "label": POLYGON_NAMES[kind]}
        same = sorted(
            (r for r in friction if r["smooth"] == (kind == "smooth")), key=lambda r: r["n_v"]
        )
        left.loglog([r["n_v"] for r in same], [r["friction"] for r in same], **look)
        path = [r for r in hysteresis if r["smooth"] == (kind == "smooth")]
        middle.plot([100 * r["strain"] for r in path], [r["ratio"] for r in path], **look)
    left.set(xlabel="vertices of a polygon", ylabel="friction over normal force")
    middle.set(xlabel="strain beyond jamming [%]", ylabel="energy back over energy forth")
    middle.axhline(1.0, color="0.6", linewidth=0.8)
    for indentation, line in zip(sorted({r["indentation"] for r in crystal}), "-:", strict=False):
        same = [r for r in crystal if r["indentation"] == indentation]
        right.loglog(
            [r["n_v"] for r in same],
            [abs(r["energy_ratio"] - 1.0) for r in same],
            SMOOTH.marker + line,
            color=SMOOTH.color,
            label=f"a/R = {100 * indentation:g} %",
        )
    right.set(xlabel="vertices of a polygon", ylabel="error of the energy of a crystal")
    right.legend(fontsize=8)
    numbers = sorted({r["n_v"] for r in (*friction, *crystal)})
    for ax in (left, right):
        ax.set_xticks(numbers, [str(n) for n in numbers])
        ax.set_xticks([], minor=True)
    for ax in (left, middle, right):
        ax.grid(which="major", alpha=0.3)
    legend_below(figure, left)
    return figure


def section(friction: Sequence[Row], hysteresis: Sequence[Row], crystal: Sequence[Row]) -> Section:
    """How smooth the polygons are, and how exact."""
    smooth, bead = ([r for r in hysteresis if r["smooth"] == kind] for kind in (True, False))
    best = max(crystal, key=lambda row: (row["n_v"], row["indentation"]))
    return Section(
        "Friction, hysteresis and a crystal",
        (
            "Two polygons are pressed together while one of them turns by one spacing of its "
            "vertices. The tangential force varies by "
            + listed(
                f"{show(row['friction'])} of the normal force ({row['n_v']} vertices, "
                f"{'smooth polygons' if row['smooth'] else 'bead polygons'})"
                for row in friction
            )
            + ".",
            "A packing is compressed step by step and expanded again. Its energy on the way back "
            f"over that on the way forth is {_ratios(smooth)} for smooth polygons, and "
            f"{_ratios(bead)} for bead polygons. Where contacts are shorter than the spacing of "
            "the vertices, smooth polygons rest in several ways, too.",
            "In a triangular lattice of equal polygons the exact energy of smooth particles is "
            f"known. Smooth polygons of {best['n_v']} vertices have "
            f"{show(best['energy_ratio'], 5)} of it at a/R = {percent(best['indentation'])}.",
        ),
        pictures=[
            Picture(
                "roughness.png",
                "Left: friction of two polygons. Middle: a packing that is compressed and "
                "expanded. Right: smooth polygons in a hexagonal crystal, against the exact "
                "energy.",
                "Three plots: friction against the number of vertices, the ratio of energies "
                "against strain, and the error of the energy against the number of vertices.",
            )
        ],
        tables=[
            Table(
                "Smooth polygons in a hexagonal crystal",
                [
                    Column("n_v", "vertices"),
                    Column("indentation", "a/R", show=percent),
                    Column("energy_ratio", "energy", "over the exact one", show=_five),
                    RESIDUAL,
                ],
                crystal,
            )
        ],
    )


def _ratios(rows: Sequence[Row]) -> str:
    return listed(f"{show(row['ratio'], 4)} at {percent(row['strain'])}" for row in rows)


def _five(value: Any) -> str:
    return show(value, 5)
