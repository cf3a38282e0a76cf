"""The paper's results: one ring of beads in polygons, against the laws.

R. Maharana, "Efficient Simulation of Deformable Particles", sections 4 and 5. docs/paper.md lists
the results.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from lammps_deformable import core
from lammps_deformable.common.checks import expect, numbers, positive
from lammps_deformable.common.errors import ParameterError
from lammps_deformable.engine.polygon_engine import steiner_point
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.particles.laws import Ring
from lammps_deformable.particles.packing import Packing
from lammps_deformable.particles.polygons import DeformablePolygon, Walls
from lammps_deformable.reference.comparison import deviation, shape_error
from lammps_deformable.reference.error_plot import BEAD, STYLES
from lammps_deformable.state.state import State
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter, NullLocator
from mpi4py import MPI
from numpy.typing import NDArray

from validation.ensembles import over_cores, power_law
from validation.report.section import Column, Picture, Row, Section, Table, listed, show, span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Steps of walls that stick, in R0. A step brings beads to the wall beyond the end of the relaxed
# contact, and there they stay. So I depends on the step. It has converged at this one for 188 beads
# and kL = 1e4 (docs/paper.md).
STEP = 0.00125

# Calls of a law; the time is their median.
_CALLS = 21

# Corners of an outline.
_POINTS = 2880

# Directions of the sides of the asymmetric polygons. The paper draws them and lists no numbers.
IRREGULAR = {
    3: np.array([0.0, 1.8, 3.9]),
    4: np.array([0.0, 1.2, 2.9, 4.4]),
}


def regular(sides: int) -> NDArray[np.float64]:
    """Directions of the sides of a regular polygon, shape (sides,) [rad]."""
    return 2.0 * np.pi * np.arange(sides) / sides


@dataclass(frozen=True, eq=False)
class Squeezed:
    """A ring squeezed by walls at the distance R - a from the origin, and the laws' answers.

    Between walls both ring laws have the same contact lines, so that they are one law, `ring`. It
    has the stiffness of the springs, kP = kL/N_v, and the beads as a rigid skin. `sector` and
    `ring, kP inf` keep the perimeter.

    The center that the laws get depends on the walls: the origin, where the particle began, if
    walls stick, and the center of the beads if they slip, see `State.packing`.

    Attributes:
        walls: around the particle.
        indentation: a, of a particle that stays at the origin [length].
        reference: the relaxed polygon.
        seconds: processor time of all relaxations since the result before.
        center: of the particle for the laws, shape (2,) [length].
        outlines: line of bead centers in each law, about the center, by name, arrays (m, 2)
            [length].
        area_deficit: S of each law, by name [length^2].
        deviation: |v| - g(theta) of each bead from each law, less that at rest, by name, shape
            (N_v,) [length].
        law_seconds: processor time of one call of each law, by name.
    """

    walls: Walls
    indentation: float
    reference: State
    seconds: float
    center: NDArray[np.float64]
    outlines: dict[str, NDArray[np.float64]]
    area_deficit: dict[str, float]
    deviation: dict[str, NDArray[np.float64]]
    law_seconds: dict[str, float]

    @property
    def angle(self) -> NDArray[np.float64]:
        """Direction of each bead from the center, shape (N_v,) [rad]."""
        return core.angles(self.reference.outlines[0] - self.center)

    @property
    def kL(self) -> float:
        """Stiffness of the springs [energy/length^2]."""
        return float(self.reference.polygons.kL[0])

    def shape_error(self, law: str) -> float:
        """I = 1/(R N_v) sum | |v| - g(theta) | of a law, by its name."""
        return float(np.mean(np.abs(self.deviation[law])) / self.reference.polygons.radius[0])


def squeeze(
    angle: NDArray[np.float64],
    indentations: Iterable[float],
    model: DeformablePolygon,
    stick: bool,
    tolerance: float = 1e-3,
    step: float = STEP,
) -> list[Squeezed]:
    """Squeeze a polygon whose circle has the radius R0 = 1, as the paper.

    Args:
        angle: directions of the walls, shape (n,) [rad].
        indentations: a/R0 of the results, in rising order.
        model: of the polygon, N_v its number of beads.
        stick: walls that beads stick to, else walls along which they slip.
        tolerance: of each relaxation, see `Simulation.relax`.
        step: largest step of walls that stick between two relaxations, in R0. Results of walls
            that slip do not depend on the way; they move by up to half the radius of a bead.

    Returns:
        One result for each indentation.

    Raises:
        ParameterError: indentations do not rise, or the walls would reach the center; a step or a
            tolerance is not positive; an argument is of another kind.
    """
    expect("model", model, DeformablePolygon)
    angle = numbers("angle", angle)
    positive("step", step)
    largest = 0.5 * model.radius  # so that walls do not pass beads
    step = min(step, largest) if stick else largest
    indentations = list(indentations)
    for before, a in pairwise([0.0, *indentations]):
        if not before < a < 1.0:  # also if one is nan
            raise ParameterError(
                f"walls cannot go from a/R0 = {before:g} to {a:g}: indentations must rise, and "
                "stay below 1"
            )
    outer = 1.0 + model.radius  # walls stop the beads' rims, and R0 is where their centers are
    packing = Packing(np.zeros((1, 2)), np.array([outer]), 4.0 * outer * np.eye(2))
    results: list[Squeezed] = []
    walls = Walls(angle, np.full(len(angle), outer), stick)
    with Simulation._within(packing, model, walls, comm=MPI.COMM_SELF) as ring:
        for before, a in pairwise([0.0, *indentations]):
            began = time.process_time()
            count = max(math.ceil((a - before) / step - 1e-9), 1)  # often an integer up to rounding
            for part in np.linspace(before, a, count + 1)[1:]:
                walls = replace(walls, height=np.full(len(angle), outer - part))
                ring._confine(walls)
                state = ring.relax(tolerance)
            results.append(_measure(walls, a, state, time.process_time() - began))
    return results


def _measure(walls: Walls, a: float, reference: State, seconds: float) -> Squeezed:
    center = np.zeros(2) if walls.stick else reference.packing.positions[0]
    pressed = 1.0 + reference.law.radius - walls.distances_from(center)
    touching = pressed >= 0.0  # contacts of the sector law; the ring law finds its own
    stuck, slipping = (walls.angle[touching], pressed[touching]), (walls.angle, pressed)
    rest, skin = reference.polygons, reference.law.radius
    beyond = rest.radius[0] - 1.0  # corners of a smooth polygon, which has the circle's length
    kA, kP, outer = float(rest.kA[0]), float(rest.kP[0]), 1.0 + skin
    ring = Ring(kA, kP=kP, skin=skin)
    calls: dict[str, Callable[[], core.Shape | core.SoftShape]] = {
        "sector": partial(core.sector, 1.0, *stuck),
        "ring, kP inf": partial(core.ring, 1.0, *slipping),
        "ring": partial(core.soft_ring, outer, *slipping, kA, kP, skin),
    }
    outlines = {
        "sector": core.outline("sector", 1.0, *stuck, _POINTS),
        "ring, kP inf": core.outline("ring", 1.0, *slipping, _POINTS),
        "ring": ring.outline(0, outer, *slipping, inset=skin, points=_POINTS),
    }
    return Squeezed(
        walls=walls,
        indentation=a,
        reference=reference,
        seconds=seconds,
        center=center,
        outlines=outlines,
        area_deficit={law: call().area_deficit for law, call in calls.items()},
        deviation={
            law: deviation(reference.outlines[0] - center, outline) - beyond
            for law, outline in outlines.items()
        },
        law_seconds={law: _call_seconds(call) for law, call in calls.items()},
    )


def _call_seconds(law: Callable[[], object]) -> float:
    """Processor time of one call: the median of several, because the first fill the caches."""
    seconds = []
    for _ in range(_CALLS):
        began = time.process_time()
        law()
        seconds.append(time.process_time() - began)
    return float(np.median(seconds))


# a/R0 of the paper.
INDENTATIONS = tuple(n / 200 for n in range(1, 11))

POLYGONS = (*map(regular, (3, 4, 5, 6)), *IRREGULAR.values())

# The two kP from which the limit of infinite stiffness is extrapolated.
_STIFF_KP = (200.0, 400.0)


def ring_in_walls(number: int, kL: float) -> DeformablePolygon:
    """The ring of beads for walls: R0 = kA = 1.

    Walls are smooth, so that the radius of the beads does not matter; it bounds the steps of walls
    that slip. Walls yield by p L0/kr at the pressure p in the ring: below 3e-6 R0 for 188 beads in
    a hexagon at a/R0 = 0.05, and for soft springs far below p q/(2 pi kP), by which the ring
    expands. Stiffer walls would only cost time steps.
    """
    return DeformablePolygon(number, radius=0.1, kL=kL, kA=1.0, kr=min(kL, 1e3), smooth=False)


def shapes(
    indentations: Sequence[float] = INDENTATIONS,
    number: int = 188,
    kL: float = 1e4,
    workers: int | None = None,
) -> list[Squeezed]:
    """Rings in regular and asymmetric polygons: walls that stick, then walls that slip."""
    model = ring_in_walls(number, kL)
    runs = [(angle, indentations, model, stick) for stick in (True, False) for angle in POLYGONS]
    return _steps(runs, workers)


def stiffness_sweep(
    kL: Sequence[float] = (1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6),
    indentations: Sequence[float] = INDENTATIONS,
    number: int = 314,
    workers: int | None = None,
) -> list[Squeezed]:
    """A ring in a hexagon whose walls stick, for springs from soft to stiff.

    Rings with the stiffest springs relax for minutes: their walls take larger steps, of 0.005.
    """
    runs = [
        (regular(6), indentations, ring_in_walls(number, k), True, 1e-3, STEP if k < 3e5 else 0.005)
        for k in kL
    ]
    return _steps(runs, workers)


def _steps(runs: list[tuple[Any, ...]], workers: int | None) -> list[Squeezed]:
    """The results of all steps of all runs of `squeeze`, in order; the last ones start first."""
    results = over_cores(squeeze, runs[::-1], workers)
    return [step for steps in reversed(results) for step in steps]


def single_row(result: Squeezed) -> dict[str, str | int | float]:
    """One measurement on a single particle for a table; lengths in R0, S in R0^2, times in s.

    I and S of a law have its name behind an underscore: I_ring_kP_inf. Times are
    processor times: seconds_dp of the beads since the indentation before, seconds_law of one call
    of the ring law with kP = inf.
    """
    angle = result.walls.angle
    turns = np.diff(angle, append=angle[0] + 2.0 * np.pi)
    return {
        "polygon": "regular" if np.ptp(turns) < 1e-9 else "irregular",
        "sides": len(angle),
        "walls": "stick" if result.walls.stick else "slip",
        "n_v": int(result.reference.polygons.number[0]),
        "kL": result.kL,
        "a_over_R": float(result.indentation),
        **{f"I_{_key(law)}": result.shape_error(law) for law in result.area_deficit},
        "S_dp": float(result.reference.area_deficit[0]),
        **{f"S_{_key(law)}": float(S) for law, S in result.area_deficit.items()},
        "seconds_dp": float(result.seconds),
        "seconds_law": float(result.law_seconds["ring, kP inf"]),
    }


def _key(law: str) -> str:
    return law.replace(", ", "_").replace(" ", "_")


def steiner_error(result: Squeezed) -> float:
    """I of the ring law with kP = inf about the Steiner point of the beads, the law's own center.

    It differs from the mean of the beads, the center of `Squeezed`, to second order in a.
    """
    beads = result.reference.outlines[0]
    point = steiner_point(beads)
    pressed = 1.0 + result.reference.law.radius - result.walls.distances_from(point)
    points = len(result.outlines["ring, kP inf"])
    outline = core.outline("ring", 1.0, result.walls.angle, pressed, points)
    return shape_error(beads - point, outline, float(result.reference.polygons.radius[0]))


@dataclass(frozen=True, eq=False)
class Limit:
    """Convergence of the area deficit of a ring in a regular polygon to the exact S = K a^2.

    To first order in each small parameter, with R0 = kA = 1 and the arc radius q = 1 - K a/pi,

        S/(K a^2) - 1 = -q^2/kP - pi^2/(3 N_v^2 a) - 2 K a L0/kr .

    kP: the perimeter stretches until p q = kP (P - P0), p = K a^2, as if R0 were larger by
    delta = p q/(2 pi kP); S falls by 2 pi q delta. N_v: the curve through beads that keep their
    distance L0 is longer by L0^3/(24 q^2) a segment where it is bent, and gains
    2 pi L0^2/24 (1/q - 1) when flats shrink its arcs. kr: walls yield by p L0/kr; with kr = 1e4
    that term is at most 2 % of the one before.

    Attributes:
        sides: of the polygon, n.
        indentation: a/R0.
        numbers: of beads, N_v.
        number_error: S/(K a^2) - 1 extrapolated to infinite kP, of each number of beads.
        stiffness: kP.
        stiffness_error: S/(K a^2) - 1 at each kP and the largest number of beads, less its value
            extrapolated to infinite kP.
    """

    sides: int
    indentation: float
    numbers: NDArray[np.int64]
    number_error: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    stiffness_error: NDArray[np.float64]

    @property
    def number_prediction(self) -> NDArray[np.float64]:
        """-pi^2/(3 N_v^2 a)"""
        return np.asarray(-(np.pi**2) / (3.0 * self.numbers**2 * self.indentation))

    @property
    def stiffness_prediction(self) -> NDArray[np.float64]:
        """-q^2/kP"""
        arc = 1.0 - polygon_stiffness(self.sides) * self.indentation / np.pi
        return np.asarray(-(arc**2) / self.stiffness)

    @property
    def number_rate(self) -> float:
        """Slope of the error over N_v in a doubly logarithmic plot; -2 expected."""
        return power_law(self.numbers, self.number_error)

    @property
    def stiffness_rate(self) -> float:
        """Slope of the error over kP in a doubly logarithmic plot; -1 expected."""
        return power_law(self.stiffness, self.stiffness_error)


def polygon_stiffness(sides: int) -> float:
    """K = pi A/(A - pi), A = n tan(pi/n): S = K a^2 in a regular n-gon."""
    area = sides * np.tan(np.pi / sides)
    return float(np.pi * area / (area - np.pi))


def limit(
    sides: int = 6,
    indentation: float = 0.05,
    numbers: Sequence[int] = (48, 96, 192, 384),
    kP: Sequence[float] = (5.0, 10.0, 20.0, 40.0),
    workers: int | None = None,
) -> Limit:
    """S of rings in a regular polygon whose walls slip, for more beads and for stiffer springs."""
    most = max(numbers)
    grid = [(number, k) for number in numbers for k in _STIFF_KP] + [(most, k) for k in kP]
    runs = [
        (
            regular(sides),
            [indentation],
            replace(ring_in_walls(number, k * number), kr=1e4),
            False,
        )
        for number, k in grid
    ]
    results = [steps[0] for steps in over_cores(squeeze, runs, workers)]
    exact = polygon_stiffness(sides) * indentation**2
    error = {
        case: float(result.reference.area_deficit[0]) / exact - 1.0
        for case, result in zip(grid, results, strict=True)
    }
    soft, stiff = _STIFF_KP
    rigid = {
        number: (stiff * error[number, stiff] - soft * error[number, soft]) / (stiff - soft)
        for number in numbers
    }
    return Limit(
        sides=sides,
        indentation=indentation,
        numbers=np.array(numbers),
        number_error=np.array([rigid[number] for number in numbers]),
        stiffness=np.array(kP),
        stiffness_error=np.array([error[most, k] - rigid[most] for k in kP]),
    )


# Deviations are magnified by a round factor so that the largest is this part of R.
_VISIBLE = 0.1

_I = r"shape error $I$"
_A = r"indentation $a/R_0$"

_MARKERS = "osD^vPX"

# Springs at least this stiff set the scale of the lower panel of `deviation_figure`.
_STIFF = 1e4

# The laws of the paper's setting: both keep the perimeter.
_DRAWN = ("sector", "ring, kP inf")


def _new(height: float, rows: int = 1, columns: int = 1) -> tuple[Figure, NDArray[Any]]:
    """A figure 1200 pixels wide, and its axes."""
    figure = Figure(figsize=(8.0, height), dpi=150, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def _series(count: int) -> list[dict[str, Any]]:
    """Styles of a series of lines: a color of a scale, and a marker of its own."""
    shades = colormaps["viridis"](np.linspace(0.0, 0.88, count))
    return [
        {"color": tuple(shade), "marker": _MARKERS[n % len(_MARKERS)]}
        for n, shade in enumerate(shades)
    ]


def _decade(value: float) -> str:
    """1, 10, or 10^n as a formula without dollars."""
    power = np.log10(value)
    return f"10^{{{power:.0f}}}" if power > 1.5 and power % 1.0 == 0.0 else f"{value:g}"


def shapes_figure(results: Sequence[Squeezed], stick: bool) -> Figure:
    """Beads in the polygons at the largest indentation, and magnified deviations of two laws.

    Each law is drawn at |v| + m (g - |v|) in the direction of each bead v: m times as far from the
    beads as it is. The factor m stands in each panel.
    """
    largest = max(result.indentation for result in results)
    chosen = [r for r in results if r.walls.stick == stick and r.indentation == largest]
    figure, axes = _new(5.9, 2, 3)
    for ax, result in zip(axes.flat, chosen, strict=True):
        _shape(ax, result)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.suptitle(
        f"{chosen[0].reference.polygons.number[0]} beads, "
        rf"$k_L = {_decade(chosen[0].kL)}$, $a/R_0 = {largest:g}$, "
        f"walls {'stick' if stick else 'slip'}"
    )
    return figure


def _shape(ax: Axes, result: Squeezed) -> None:
    corners = _corners(result.walls.angle, 1.0 - result.indentation)
    ax.plot(*_closed(corners), color="0.7", linewidth=1.0, label="walls")
    beads = result.reference.outlines[0]
    ax.plot(*beads.T, ".", color=BEAD.color, markersize=2.5, label="beads")
    order = np.argsort(result.angle)
    out = np.column_stack([np.cos(result.angle), np.sin(result.angle)])
    factor = magnification(max(np.abs(result.deviation[law]).max() for law in _DRAWN))
    for law in _DRAWN:
        line = (beads - factor * result.deviation[law][:, None] * out)[order]
        style = STYLES[law]
        ax.plot(*_closed(line), color=style.color, linestyle=style.line, linewidth=1.0, label=law)
    text = [rf"deviations $\times$ {factor:g}"]
    text += [f"$I$ {law} = {short(result.shape_error(law))}" for law in _DRAWN]
    ax.text(0.0, 0.0, "\n".join(text), ha="center", va="center", fontsize=8.5)
    ax.set(xlim=(-1.15, 1.15), ylim=(-1.15, 1.15), aspect="equal")  # far corners are cut off
    ax.set_axis_off()


def magnification(largest: float, radius: float = 1.0) -> float:
    """The factor 1, 2 or 5 times a power of ten that makes the largest deviation visible."""
    if largest <= 0.0:
        return 1.0
    wanted = max(_VISIBLE * radius / largest, 1.0)
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted))


def _closed(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """x and y of a closed line."""
    return np.vstack([points, points[:1]]).T


def short(value: float) -> str:
    """Two digits as a formula."""
    mantissa, power = f"{value:.1e}".split("e")
    return rf"${mantissa}\times 10^{{{int(power)}}}$"


def _corners(angle: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Corners of the polygon whose sides have these directions and this distance."""
    half = np.diff(angle, append=angle[0] + 2.0 * np.pi) / 2.0
    middle = angle + half
    return (height / np.cos(half))[:, None] * np.column_stack([np.cos(middle), np.sin(middle)])


def deviation_figure(results: Sequence[Squeezed], indentation: float = 0.02) -> Figure:
    """|v| - g(theta) of the sector law along the outline, a line for each stiffness.

    The lower panel shows the stiffest rings with a larger scale.
    """
    chosen = [r for r in results if np.isclose(r.indentation, indentation)]
    figure, axes = _new(6.0, 2, 1)
    for result, style in zip(chosen, _series(len(chosen)), strict=True):
        turn = np.degrees(result.angle) % 360.0
        order = np.argsort(turn)
        label = rf"$k_L = {_decade(result.kL)}$"
        for ax, unit in zip(axes[:, 0], (1e-3, 1e-5), strict=True):
            difference = result.deviation["sector"][order] / unit
            spread = slice(0, None, max(len(order) // 18, 1))
            ax.plot(turn[order], difference, linewidth=0.9, color=style["color"])
            ax.plot(turn[order][spread], difference[spread], linestyle="none", **style, ms=3.5)
            ax.plot([], [], **style, linewidth=0.9, markersize=3.5, label=label)
    stiff = [r for r in chosen if r.kL >= _STIFF]
    stiffest = 1e5 * np.concatenate([r.deviation["sector"] for r in stiff or chosen[-1:]])
    margin = 0.1 * float(np.ptp(stiffest))
    axes[1, 0].set(
        xlabel=r"direction $\theta$ [degrees]",
        ylim=(min(stiffest.min(), 0.0) - margin, stiffest.max() + margin),
    )
    for ax, power in zip(axes[:, 0], (-3, -5), strict=True):
        ax.set(
            ylabel=rf"$(|\mathbf{{v}}| - g(\theta))/R_0$  [$10^{{{power}}}$]",
            xlim=(0.0, 360.0),
            xticks=range(0, 361, 60),
        )
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside right center", fontsize=8)
    figure.suptitle(
        rf"hexagon, $a/R_0 = {indentation:g}$, {chosen[0].reference.polygons.number[0]} beads, "
        "walls stick"
    )
    return figure


def error_by_indentation(results: Sequence[Squeezed]) -> Figure:
    """I of the sector law against a for each stiffness, and against the stiffness for several a.

    Dashed: the ring law, which has the stiffness of the springs.
    """
    figure, axes = _new(4.8, 1, 2)
    left, right = axes[0]
    stiffnesses = sorted({r.kL for r in results})
    for kL, style in zip(stiffnesses, _series(len(stiffnesses)), strict=True):
        line = [r for r in results if r.kL == kL]
        label = rf"$k_L = {_decade(kL)}$"
        _errors(left, [r.indentation for r in line], line, "sector", label=label, **style)
    left.set(xlabel=_A, ylabel=_I, yscale="log")
    depths = sorted({r.indentation for r in results})[1::2]
    for a, style in zip(depths, _series(len(depths)), strict=True):
        line = [r for r in results if r.indentation == a]
        label = rf"$a/R_0 = {a:g}$"
        stiffness = [r.kL for r in line]
        _errors(right, stiffness, line, "sector", label=label, **style)
        if a in depths[::-3]:
            dashed = style | {"linestyle": "--", "fillstyle": "none"}
            _errors(right, stiffness, line, "ring", label=label + ", ring", **dashed)
    right.set(xlabel=r"stiffness of the springs $k_L/k_A R_0^2$", ylabel=_I)
    right.set(xscale="log", yscale="log")
    spacing = float(results[0].reference.polygons.spacing[0])
    for ax in (left, right):
        ax.axhline(spacing**2 / 24.0, color="0.6", linestyle=":", linewidth=1.0)
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8, ncols=3)
        ax.grid(alpha=0.3)
    right.text(1.0, spacing**2 / 22.0, "$L_0^2/24R_0$: spacing of the beads", fontsize=7.5)
    figure.suptitle(f"hexagon, {results[0].reference.polygons.number[0]} beads, walls stick")
    return figure


def _errors(ax: Axes, x: Iterable[float], line: Iterable[Squeezed], law: str, **style: Any) -> None:
    ax.plot(list(x), [r.shape_error(law) for r in line], markersize=3.5, linewidth=1.1, **style)


def limits_figure(found: Sequence[Limit]) -> Figure:
    """The error of S against the number of beads, and against the stiffness of the perimeter."""
    figure, axes = _new(4.3, 1, 2)
    left, right = axes[0]
    for each, style in zip(found, _series(len(found)), strict=True):
        shade = style["color"]
        number = f"n = {each.sides}, slope {each.number_rate:.2f}"
        points = style | {"linestyle": "none"}
        left.plot(each.numbers, -each.number_error, **points, label=number)
        left.plot(each.numbers, -each.number_prediction, color=shade, linewidth=1.0)
        stiffness = f"n = {each.sides}, slope {each.stiffness_rate:.2f}"
        right.plot(each.stiffness, -each.stiffness_error, **points, label=stiffness)
        right.plot(each.stiffness, -each.stiffness_prediction, color=shade, linewidth=1.0)
    left.set(xlabel="number of beads $N_v$", ylabel=r"$1 - S/Ka^2$ at infinite $k_P$")
    right.set(xlabel=r"$k_P/k_A R_0^2$", ylabel=r"share of $k_P$ in $1 - S/Ka^2$")
    _plain_ticks(left, found[0].numbers)
    _plain_ticks(right, found[0].stiffness)
    left.set_title(r"line: expected, $\pi^2/3N_v^2 a$", fontsize=10)
    right.set_title(r"lines: expected, $k_A q^2/k_P$", fontsize=10)
    left.legend(fontsize=8)
    right.legend(fontsize=8)
    figure.suptitle(rf"regular polygons, $a/R_0 = {found[0].indentation:g}$, walls slip")
    return figure


def _plain_ticks(ax: Axes, values: Iterable[float]) -> None:
    """Logarithmic axes with ticks at these x, as plain numbers."""
    ax.set(xscale="log", yscale="log")
    ax.set_xticks(list(values))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_minor_formatter(NullFormatter())


_MAGNIFIED = (
    "Each law is drawn with its distance from the beads magnified by the factor in the panel; "
    "without that the lines would lie on top of each other."
)


def polygons_section(rows: Sequence[Row]) -> Section:
    """The rows of `paper.shapes`: walls that stick, and walls that slip."""
    asymmetric = [row for row in rows if row["polygon"] == "irregular"]
    stick = [row for row in asymmetric if row["walls"] == "stick"]
    slip = [row for row in asymmetric if row["walls"] == "slip"]
    return Section(
        "One particle in a polygon",
        (
            f"A ring of {rows[0]['n_v']} beads is squeezed between the walls of a polygon, as in "
            "the paper. Beads stick to the walls, or slip along them. The sector law describes "
            "contacts that stick, the ring law contacts that slip. Both keep the perimeter here "
            "(kP inf).",
            "In regular polygons both laws agree by symmetry. In asymmetric ones each is right in "
            f"its regime. With walls that stick, I of sector is {_span(stick, 'I_sector')}, of "
            f"ring {_span(stick, 'I_ring_kP_inf')}. With walls that slip, I of ring is "
            f"{_span(slip, 'I_ring_kP_inf')}, of sector {_span(slip, 'I_sector')}.",
            "The rest of I of the ring law comes from the center: the laws get the mean of the "
            "beads, but the law's own center is the Steiner point. About that point I is "
            f"{_span(slip, 'I_ring_kP_inf_steiner')}.",
        ),
        pictures=[
            Picture(
                "shapes_stick.png",
                f"Walls that stick. {_MAGNIFIED} In asymmetric polygons (last two panels) the "
                "sector law stays on the beads.",
                "Six polygons with a ring of beads in each and the magnified outlines of the "
                "sector law and of the ring law.",
            ),
            Picture(
                "shapes_slip.png",
                "Walls that slip, magnified in the same way. In asymmetric polygons the ring law "
                "stays on the beads.",
                "The same six polygons with walls along which beads slip.",
            ),
        ],
        tables=[
            Table(
                "Ranges of the shape error I over all indentations",
                [
                    Column("polygon", "polygon", text=True),
                    Column("walls", "walls", text=True),
                    Column("I_sector", "sector"),
                    Column("I_ring_kP_inf", "ring, kP inf"),
                    Column("I_ring", "ring", "with the stiffness of the springs"),
                ],
                _ranges(rows),
            )
        ],
    )


def _ranges(rows: Sequence[Row]) -> list[Row]:
    laws = ("I_sector", "I_ring_kP_inf", "I_ring")
    cases = dict.fromkeys((row["walls"], row["polygon"], row["sides"]) for row in rows)
    found = []
    for case in cases:
        same = [row for row in rows if (row["walls"], row["polygon"], row["sides"]) == case]
        kind = "regular" if case[1] == "regular" else "asymmetric"
        found.append(
            {"polygon": f"{kind}, {case[2]} sides", "walls": case[0]}
            | {law: _span(same, law) for law in laws}
        )
    return found


def _span(rows: Sequence[Row], key: str) -> str:
    return span(row[key] for row in rows)


def stiffness_section(rows: Sequence[Row]) -> Section:
    """The rows of `paper.stiffness_sweep`."""
    softest, stiffest = (f(row["kL"] for row in rows) for f in (min, max))
    depths = sorted({row["a_over_R"] for row in rows})
    a = depths[len(depths) // 2]
    soft, stiff = (_at(rows, kL, a) for kL in (softest, stiffest))
    return Section(
        "Stiffness of the perimeter",
        (
            f"A ring of {rows[0]['n_v']} beads in a hexagon whose walls stick, with springs from "
            "soft to stiff. The sector law keeps its perimeter; real rings stretch, so that their "
            "beads lie outside its outline.",
            f"At a/R₀ = {a:g} the shape error of the sector law falls from "
            f"{show(soft['I_sector'])} at kL = {show(softest)} to {show(stiff['I_sector'])} at kL "
            f"= {show(stiffest)}, where the spacing of the beads is all that is left. The ring law "
            "with the stiffness of the springs (kP = kL/N) needs no stiff springs: there it has "
            f"{show(soft['I_ring'])} and {show(stiff['I_ring'])}. It lets contacts slip, "
            "though, and these stick: soft rings that are pressed deeper deviate from it.",
        ),
        pictures=[
            Picture(
                "deviation.png",
                "Distance of the beads from the outline of the sector law against the direction. "
                "It vanishes at the six walls and is largest in the middle of the free arcs. The "
                "lower panel magnifies the stiff rings.",
                "Curves with six equal bumps, lower for stiffer springs.",
            ),
            Picture(
                "stiffness.png",
                "Shape error of the sector law against indentation (left) and against the "
                "stiffness of the springs (right). Dashed: the ring law, which has that stiffness "
                "itself.",
                "Rising curves of the shape error against indentation; curves that fall with "
                "stiffness down to the line of the spacing of the beads.",
            ),
        ],
    )


def _at(rows: Sequence[Row], kL: float, a: float) -> Row:
    return next(row for row in rows if (row["kL"], row["a_over_R"]) == (kL, a))


def limits_section(rows: Sequence[Row]) -> Section:
    powers = listed(
        f"{show(row['rate_n_v'], 3)} and {show(row['rate_kP'])} for {row['sides']} sides"
        for row in rows
    )
    return Section(
        "The exact limit",
        (
            "In a regular polygon whose walls slip, the area deficit of the ring law is exactly "
            "S = K a². Rings of beads tend to it with more beads and stiffer springs.",
            "Expected are errors that fall as the power −2 of the number of beads and as the power "
            f"−1 of the perimeter stiffness kP. The measured powers are {powers}.",
        ),
        pictures=[
            Picture(
                "limit.png",
                "Relative error of the beads' area deficit against their number (left) and against "
                "the stiffness (right). Points: measured. Lines: expected.",
                "Two logarithmic plots with points along straight falling lines.",
            )
        ],
    )
