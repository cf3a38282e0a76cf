"""The section on friction, hysteresis and a crystal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from validation.report.section import (
    RESIDUAL,
    Column,
    Picture,
    Row,
    Section,
    Table,
    listed,
    percent,
    show,
)

if TYPE_CHECKING:
    from collections.abc import Sequence


def roughness(
    friction: Sequence[Row], hysteresis: Sequence[Row], crystal: Sequence[Row]
) -> Section:
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
