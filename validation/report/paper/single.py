"""One ring of beads between walls against the contact laws: the paper's first test."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from lammps_deformable import core
from lammps_deformable._checks import expect, numbers, positive
from lammps_deformable.errors import ParameterError
from lammps_deformable.laws import Ring
from lammps_deformable.packing import Packing
from lammps_deformable.polygon_simulation import PolygonSimulation
from lammps_deformable.polygons import PolygonModel, Walls
from lammps_deformable.shape_error import deviation
from lammps_deformable.state import PolygonState
from mpi4py import MPI
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

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
    walls stick, and the center of the beads if they slip, see `PolygonState.packing`.

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
    reference: PolygonState
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
    model: PolygonModel,
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
        tolerance: of each relaxation, see `PolygonSimulation.relax`.
        step: largest step of walls that stick between two relaxations, in R0. Results of walls
            that slip do not depend on the way; they move by up to half the radius of a bead.

    Returns:
        One result for each indentation.

    Raises:
        ParameterError: indentations do not rise, or the walls would reach the center; a step or a
            tolerance is not positive; an argument is of another kind.
    """
    expect("model", model, PolygonModel)
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
    packing = Packing(
        np.zeros((1, 2)), np.zeros(1, int), np.array([outer]), 4.0 * outer * np.eye(2)
    )
    results: list[Squeezed] = []
    walls = Walls(angle, np.full(len(angle), outer), stick)
    with PolygonSimulation(packing, model, walls, MPI.COMM_SELF) as ring:
        for before, a in pairwise([0.0, *indentations]):
            began = time.process_time()
            count = max(math.ceil((a - before) / step - 1e-9), 1)  # often an integer up to rounding
            for part in np.linspace(before, a, count + 1)[1:]:
                walls = replace(walls, height=np.full(len(angle), outer - part))
                ring.confine(walls)
                state = ring.relax(tolerance)
            results.append(_measure(walls, a, state, time.process_time() - began))
    return results


def _measure(walls: Walls, a: float, reference: PolygonState, seconds: float) -> Squeezed:
    center = np.zeros(2) if walls.stick else reference.packing.positions[0]
    pressed = 1.0 + reference.model.radius - walls.distances_from(center)
    touching = pressed >= 0.0  # contacts of the sector law; the ring law finds its own
    stuck, slipping = (walls.angle[touching], pressed[touching]), (walls.angle, pressed)
    rest, skin = reference.polygons, reference.model.radius
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
