"""Packings of polygons against the laws: the paper's one, and mixtures of unequal stiffness.

The laws are at the polygons' centers, and relaxed alone.
"""

from __future__ import annotations

import math
import statistics
import time
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from lammps_deformable import core
from lammps_deformable.engine.engines import open_disks
from lammps_deformable.engine.jamming import jam
from lammps_deformable.engine.lammps import run
from lammps_deformable.engine.relax import TOLERANCE, minimize_command
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.particles.generators import bidisperse
from lammps_deformable.particles.laws import Law, Ring, Sector, per_species
from lammps_deformable.particles.packing import Packing
from lammps_deformable.particles.polygons import DeformablePolygon
from lammps_deformable.reference.comparison import (
    deviation,
    is_unjammed,
    matching_laws,
    polygon_outlines,
    predict,
    shape_error,
    shape_errors,
    stiff_polygons,
    timed,
)
from lammps_deformable.reference.error_plot import BEAD, STYLES
from lammps_deformable.state.state import State
from mpi4py import MPI
from numpy.typing import NDArray

from validation.report import section as c
from validation.report.paper import magnification, short
from validation.report.section import (
    Column,
    Picture,
    Row,
    Section,
    Table,
    listed,
    percent,
    show,
    span,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Runs of a law or of disks, which take milliseconds; the time is their median.
_REPEATS = 5

# This part of the deviations of each law is to stay small after magnification.
_MOST = 0.97


@dataclass(frozen=True, eq=False)
class AtCenters:
    """A law's particles at the centers of polygons, with their effective radii; not relaxed."""

    reference: State
    state: State

    @property
    def shape_error(self) -> NDArray[np.float64]:
        """I of each particle, see `comparison.shape_error`, shape (N,)."""
        return shape_errors(self.reference, self.state)


def strain_polygons(start: Packing, model: DeformablePolygon, strain: float) -> tuple[State, float]:
    """Polygons after one strain step from jamming, and the seconds of processor time."""
    with Simulation(start, model, comm=MPI.COMM_SELF) as polygons:
        polygons.deform(polygons.box * (1.0 - strain))
        began = time.process_time()
        state = polygons.relax()
        return state, time.process_time() - began


def strain_law(start: Packing, law: Law, strain: float) -> tuple[State, float]:
    """Particles after one strain step from jamming, and the seconds of processor time."""
    seconds = []
    for _ in range(_REPEATS):
        with Simulation(start, law, comm=MPI.COMM_SELF) as sim, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the row has the residual
            sim.deform(sim.box * (1.0 - strain))
            began = time.process_time()
            state = sim.relax()
            seconds.append(time.process_time() - began)
    return state, statistics.median(seconds)


def strain_disks(start: Packing, strain: float) -> float:
    """Seconds of processor time of soft disks for the same step, to the tolerance of the laws."""
    force = TOLERANCE * strain * 2.0 * float(start.radii.mean())  # of the overlap, stiffness 1
    seconds = []
    for _ in range(_REPEATS):
        lmp = open_disks(start.at(start.phi / (1.0 - strain) ** 2))
        began = time.process_time()
        run(lmp, minimize_command(force, 1_000_000))
        seconds.append(time.process_time() - began)
        lmp.close()
    return statistics.median(seconds)


def mixed_rows(
    number: int, seed: int, strain: float, count: int, kA: Sequence[float], kP: Sequence[float]
) -> list[Row]:
    """As `packing_rows`, for smooth polygons whose species differ in stiffness.

    Args:
        number: of particles.
        seed: of the random start.
        strain: linear strain.
        count: N_v, of the small particles.
        kA: stiffness of the area of the small and of the large particles [energy/length^4].
        kP: stiffness of their perimeters [energy/length^2]. Where it is infinite, polygons have a
            large one instead, because no spring is rigid; `balanced, kP inf` is the law with the
            infinite value.
    """
    radii = np.array([0.5, 0.7])
    model, rigid = stiff_polygons(radii, count, kA, kP), np.isinf(kP)
    rows, _ = packing_rows(number, seed, strain, model, rigid.tolist())
    return rows


def packing_rows(
    number: int,
    seed: int,
    strain: float,
    model: DeformablePolygon,
    rigid: Sequence[bool] = (),
) -> tuple[list[Row], dict[str, AtCenters]]:
    """One bidisperse packing of polygons, strained from jamming in one step, against every law.

    Args:
        number: of particles.
        seed: of the random start.
        strain: linear strain.
        model: of the polygons.
        rigid: as for `matching_laws`.

    Returns:
        A row for each law, and the comparisons by the law's name. A row has the errors of the
        law's shapes and areas, and its energy and pressure over the beads', all at the beads'
        centers. Its `own_` energy and pressure are those of the packing that the law itself
        relaxes to from the same start, None if that is `unjammed`.
    """
    start = jam(bidisperse(number, seed=seed)).packing
    polygons, seconds_polygons = strain_polygons(start, model, strain)
    common: dict[str, Any] = {
        "n": number,
        "strain": strain,
        "n_v": int(polygons.polygons.number.min()),
        "kA": polygons.polygons.kA.tolist(),
        "kP": polygons.polygons.kP.tolist(),
        "seed": seed,
        "seconds_polygons": seconds_polygons,
        "residual_polygons": polygons.residual,
    }
    disk: dict[str, Any] = {
        "law": "disk",
        "kP_law": None,
        "I": _error_of_disks(polygons),
        "S_rms": 1.0,  # a disk keeps its area, S = 0
        "energy_ratio": None,  # the stiffness of a disk is a free parameter
        "pressure_ratio": None,
        "own_energy_ratio": None,
        "own_pressure_ratio": None,
        "unjammed": False,
        "residual": None,
        "seconds": strain_disks(start, strain),
    }
    rows: list[Row] = [common | disk]
    smooth = start.replace(radii=polygons.polygons.effective_radius[start.species])
    comparisons = {}
    for name, law in matching_laws(model, polygons.polygons, rigid).items():
        comparison = comparisons[name] = AtCenters(polygons, predict(polygons, law, MPI.COMM_SELF))
        there, exact = comparison.state, polygons.area_deficit
        own, seconds = strain_law(smooth, law, strain)
        unjammed = is_unjammed(own, polygons)
        rows.append(
            common
            | {
                "law": name,
                "kP_law": [
                    k if math.isfinite(k) else "inf"
                    for k in per_species(law.kP, len(start.species_radii))
                ],
                "I": float(comparison.shape_error.mean()),
                "S_rms": _over(core.norm(there.area_deficit - exact), core.norm(exact)),
                "energy_ratio": _over(there.energy, polygons.energy),
                "pressure_ratio": _over(there.pressure, polygons.pressure),
                "own_energy_ratio": None if unjammed else own.energy / polygons.energy,
                "own_pressure_ratio": None if unjammed else own.pressure / polygons.pressure,
                "unjammed": unjammed,
                "residual": own.residual,
                "seconds": seconds,
            }
        )
    return rows, comparisons


def _error_of_disks(reference: State) -> float:
    """Mean shape error of the circles through the beads at rest."""
    errors = []
    packing = reference.packing
    for polygon, center, kind, radius in zip(
        reference.outlines, packing.positions, packing.species, packing.radii, strict=True
    ):
        circle = core.outline("ring", reference.polygons.radius[kind], [], [], 1440)
        errors.append(shape_error(polygon - center, circle, radius))
    return float(np.mean(errors))


def _over(value: float, exact: float) -> float | None:
    """A ratio; None to polygons without load, as JSON has no infinity."""
    return value / exact if exact else None


def paper_packing(
    number: int = 128,
    strain: float = 0.01,
    steps: int = 1,
    model: DeformablePolygon | None = None,
    seed: int = 1,
) -> dict[str, AtCenters]:
    """A bidisperse packing of rings of beads beyond jamming, against `sector` and `radical`.

    Args:
        number: of particles, N.
        strain: linear, from the onset of jamming.
        steps: number of strain steps.
        model: of the polygons; by default the paper's, 50 and 72 beads of radius 0.05.
        seed: of the positions at the start.
    """
    jammed = jam(bidisperse(number, seed=seed)).packing
    with Simulation(jammed, model or DeformablePolygon(50, smooth=False)) as polygons:
        state, _ = timed(polygons, strain, steps)[-1]
    laws: dict[str, Law] = {"sector": Sector(), "radical": Ring(contact="radical")}
    return {name: AtCenters(state, predict(state, law)) for name, law in laws.items()}


def large(rows: Sequence[Row]) -> Section:
    first = rows[0]
    laws = [row for row in rows if row["law"] != "disk" and _converged(row)]
    faster = listed(
        f"`{row['law']}` {first['seconds_polygons'] / row['seconds']:.0f} times faster "
        f"({show(row['seconds'])} s)"
        for row in laws
    )
    return Section(
        "The packing of the paper",
        (
            f"{first['n']} bead polygons, {first['n_v']} beads on the small ones, are strained "
            f"by {percent(first['strain'])} in one step from jamming. The laws are compared at "
            "their centers. Few beads are rough, which limits the comparison. The polygons relax "
            f"in {show(first['seconds_polygons'], 3)} s, until no force on a bead exceeds 10⁻³ of "
            "the force on a bead in a contact. The laws relax until no force exceeds "
            f"{show(TOLERANCE, 1)} of the mean contact force: {faster}." + _stalled(rows),
        ),
        pictures=[
            Picture(
                "packing.png",
                "Left: the packing. Right: the part in the frame, where each law is drawn with its "
                "distance from the beads magnified by the factor above it. Deviations are largest "
                "at contacts.",
                "Circles of beads in a periodic box, and an enlarged part with the outlines of "
                "three laws around the beads.",
            )
        ],
        tables=[
            Table(
                "The laws in this packing",
                [c.LAW, c.SHAPE, c.AREA, c.ENERGY, c.PRESSURE, c.SECONDS, c.RESIDUAL],
                rows,
            )
        ],
    )


_RATIOS = ("I", "S_rms", "energy_ratio", "pressure_ratio", "own_energy_ratio")


def mixtures(rows: Sequence[Row]) -> Section:
    best, laws = _by_error(rows)
    energies, own = (
        span((row[key] for row in rows if row["law"] == best), 3)
        for key in ("energy_ratio", "own_energy_ratio")
    )
    return Section(
        "Mixtures of unequal stiffness",
        (
            "The same comparison for particles whose two species differ in the stiffness of the "
            "area (kA) or of the perimeter (kP). A contact line then moves into the softer "
            "particle. The polygons are smooth; errors are at their centers, and the own energy is "
            "that of the law relaxed alone.",
            "Medians of the area error are "
            + listed(f"{show(laws[law])} (`{law}`)" for law in laws)
            + ". "
            f"The most accurate law, `{best}`, has energies of {energies} of the polygons', and "
            f"{own} if it relaxes alone.",
            "No spring is rigid: polygons have kP = 10 kA R² where kP is to be infinite. The law "
            "`balanced, kP inf` has the infinite value there, and is off by about kA q²/kP in the "
            "area deficits, q being the radius of the free arcs. The sector law has a single kA "
            "and takes part where the species agree in it.",
        ),
        tables=[
            Table(
                "Ranges over the packings of each mixture; small | large particles",
                [
                    Column("kA", "kA", "area stiffness of the polygons", show=c.stiffness),
                    Column("kP", "kP", "perimeter stiffness of the polygons", show=c.stiffness),
                    Column("packings", "packings"),
                    *(c.LAW, c.SHAPE, c.AREA, c.ENERGY, c.OWN_ENERGY),
                ],
                c.grouped(rows, ("kA", "kP", "law"), _RATIOS),
            )
        ],
    )


def _by_error(rows: Sequence[Row]) -> tuple[str, dict[str, float]]:
    """The law with the least median area error, and the medians of all laws but disks."""
    medians = {}
    for law in STYLES:
        found = [row["S_rms"] for row in rows if row["law"] == law and row["S_rms"] is not None]
        if found and law != "disk":
            medians[law] = statistics.median(found)
    return min(medians, key=medians.__getitem__), medians


def _converged(row: Row) -> bool:
    return row.get("residual") is None or bool(row["residual"] <= TOLERANCE)


def _stalled(rows: Sequence[Row]) -> str:
    """A sentence on laws that did not converge, if there are any."""
    names = [row.get("law", row.get("method")) for row in rows if not _converged(row)]
    if not names:
        return ""
    return (
        f" The energy of the {listed(f'`{name}`' for name in names)} law jumps where contacts "
        "appear, so that its relaxation does not converge; its time is that until it stopped."
    )


def packing(comparisons: Mapping[str, AtCenters]) -> Figure:
    """The whole box, and a few polygons of it with the deviations of the laws magnified.

    Each law is drawn at |v| + m (g - |v|) in the direction of each bead v: m times as far from the
    beads as it is. The factor m stands in the title.

    Args:
        comparisons: of one packing with laws, by name.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure
    from matplotlib.patches import Polygon, Rectangle

    reference = next(iter(comparisons.values())).reference
    box, radii = reference.packing.box, reference.packing.radii
    figure = Figure(figsize=(8.0, 4.8), dpi=150, layout="constrained")
    whole, zoom = figure.subplots(1, 2)

    polygons = _images(reference.outlines, box)
    whole.add_collection(
        PolyCollection(polygons, facecolor="0.92", edgecolor=BEAD.color, linewidth=0.5)
    )
    frame = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) @ box
    whole.add_patch(Polygon(frame, fill=False, edgecolor="0.5", linewidth=0.8))
    middle = 0.5 * box.sum(axis=0)
    half = min(1.7 * float(radii.max()), 0.5 * float(box.diagonal().min()))
    corner = (middle[0] - half, middle[1] - half)
    window = Rectangle(corner, 2 * half, 2 * half, fill=False, linewidth=1.3, zorder=5)
    whole.add_patch(window)
    margin = 1.05 * float(radii.max())
    low, high = frame.min(axis=0) - margin, frame.max(axis=0) + margin
    whole.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    whole.set_title(f"{len(reference.packing)} bead polygons", fontsize=10)
    whole.set_axis_off()

    factor = _deviations(zoom, comparisons)
    zoom.set(
        xlim=(middle[0] - half, middle[0] + half),
        ylim=(middle[1] - half, middle[1] + half),
        aspect="equal",
        xticks=[],
        yticks=[],
    )
    zoom.set_title(rf"the part in the frame, deviations $\times$ {factor:g}", fontsize=10)
    means = ", ".join(
        f"{name} {short(float(each.shape_error.mean()))}" for name, each in comparisons.items()
    )
    figure.suptitle(f"mean shape error $I$: {means}", fontsize=9)
    figure.legend(*zoom.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def _deviations(ax: Axes, comparisons: Mapping[str, AtCenters]) -> float:
    """Draw beads, and the laws at magnified distances from them; returns the factor."""
    from matplotlib.collections import LineCollection

    reference = next(iter(comparisons.values())).reference
    centers, box = reference.packing.positions, reference.packing.box
    about = [polygon - center for polygon, center in zip(reference.outlines, centers, strict=True)]
    found = {
        name: [
            deviation(polygon, line)
            for polygon, line in zip(about, polygon_outlines(reference, each.state), strict=True)
        ]
        for name, each in comparisons.items()
    }
    large = max(np.quantile(np.abs(np.concatenate(each)), _MOST) for each in found.values())
    factor = magnification(float(large), float(reference.packing.radii.min()))
    dots = np.vstack(_images(reference.outlines, box))
    ax.plot(*dots.T, color=BEAD.color, linestyle="none", marker=".", markersize=4.0, label="beads")
    for name, each in found.items():
        magnified = [
            center + polygon * (1.0 - factor * off / np.hypot(*polygon.T))[:, None]
            for center, polygon, off in zip(centers, about, each, strict=True)
        ]
        closed = [np.vstack([line, line[:1]]) for line in _images(magnified, box)]
        style = STYLES[name]
        lines = LineCollection(
            closed, linewidths=1.2, color=style.color, linestyle=style.line, label=name, zorder=4
        )
        ax.add_collection(lines)
    return factor


def _images(
    outlines: Iterable[NDArray[np.float64]], box: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """All periodic images of closed lines that reach into the box."""
    to_fraction = np.linalg.inv(box)
    images = []
    for outline in outlines:
        fraction = outline @ to_fraction
        low = np.floor(fraction.min(axis=0)).astype(int)
        high = np.floor(fraction.max(axis=0)).astype(int)
        for a in range(low[0], high[0] + 1):
            for b in range(low[1], high[1] + 1):
                images.append(outline - np.array([a, b]) @ box)
    return images
