"""The paper's results: one ring of beads in polygons, and a packing of rings, against the laws.

Each function computes one result and returns data; `paper_figures` draws it. R. Maharana,
"Efficient Simulation of Deformable Particles", sections 4 and 5. `docs/paper.md` lists the results.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from lammps_deformable import core
from lammps_deformable.comparison import Comparison, compare
from lammps_deformable.compression import compress
from lammps_deformable.jamming import jam
from lammps_deformable.laws import Ring, Sector
from lammps_deformable.polygon_simulation import PolygonSimulation
from lammps_deformable.polygons import PolygonModel
from lammps_deformable.random import bidisperse
from lammps_deformable.shape_error import shape_error
from lammps_deformable.state import steiner_point
from numpy.typing import NDArray

from validation.ensembles import over_cores, power_law
from validation.report.paper.single import IRREGULAR, STEP, Squeezed, regular, squeeze

if TYPE_CHECKING:
    from collections.abc import Sequence

# a/R0 of the paper.
INDENTATIONS = tuple(n / 200 for n in range(1, 11))

POLYGONS = (*map(regular, (3, 4, 5, 6)), *IRREGULAR.values())

# The two kP from which the limit of infinite stiffness is extrapolated.
_STIFF = (200.0, 400.0)


def ring_in_walls(number: int, kL: float) -> PolygonModel:
    """The ring of beads for walls: R0 = kA = 1.

    Walls are smooth, so that the radius of the beads does not matter; it bounds the steps of walls
    that slip. Walls yield by p L0/kr at the pressure p in the ring: below 3e-6 R0 for 188 beads in
    a hexagon at a/R0 = 0.05, and for soft springs far below p q/(2 pi kP), by which the ring
    expands. Stiffer walls would only cost time steps.
    """
    return PolygonModel(vertices=number, radius=0.1, kL=kL, kA=1.0, kr=min(kL, 1e3))


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
    pressed = 1.0 + result.reference.model.radius - result.walls.distances_from(point)
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
    grid = [(number, k) for number in numbers for k in _STIFF] + [(most, k) for k in kP]
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
    soft, stiff = _STIFF
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


def packing(
    number: int = 128,
    strain: float = 0.01,
    steps: int = 1,
    model: PolygonModel | None = None,
    seed: int = 1,
) -> dict[str, Comparison]:
    """A bidisperse packing of rings of beads beyond jamming, against `sector` and `radical`.

    Args:
        number: of particles, N.
        strain: linear, from the onset of jamming.
        steps: number of strain steps.
        model: of the polygons; by default the paper's, 50 and 72 beads of radius 0.05.
        seed: of the positions at the start.
    """
    jammed = jam(bidisperse(number, seed=seed))
    with PolygonSimulation(jammed, model) as polygons:
        *_, state = compress(polygons, strain, steps)
    return {"sector": compare(state, Sector()), "radical": compare(state, Ring(contact="radical"))}
