"""A contact law at the centers of bead polygons, and its errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ._checks import expect
from .core import norm
from .errors import ParameterError
from .laws import Law, Ring, Sector, refuse_adhesion
from .matching import matching_laws
from .shape_error import shape_error
from .simulation import Simulation
from .state import PolygonState, State

# Corners of an outline: the polygon is nearer to the curve than 2e-6 of its radius.
_POINTS = 1440


@dataclass(frozen=True, eq=False)
class Comparison:
    """A contact law against bead polygons with the same centers.

    Attributes:
        reference: the polygons.
        state: the law's particles, with the effective radii of the polygons; not relaxed.
        shape_error: I of each particle, see `shape_error`, shape (N,).
    """

    reference: PolygonState
    state: State
    shape_error: NDArray[np.float64]

    @property
    def area_deficit_error(self) -> float:
        """Root mean square of S - S_exact over that of S_exact; inf if all S_exact are zero."""
        exact = self.reference.area_deficit
        wrong = self.state.area_deficit - exact
        return _over(norm(wrong), norm(exact))

    @property
    def energy_ratio(self) -> float:
        """Energy of the law over that of the polygons; inf if that is zero."""
        return _over(self.state.energy, self.reference.energy)

    @property
    def pressure_ratio(self) -> float:
        """Pressure of the law over that of the polygons; inf if that is zero."""
        return _over(self.state.pressure, self.reference.pressure)


def _over(ours: float, exact: float) -> float:
    """A ratio, inf if the denominator is zero."""
    return ours / exact if exact else math.inf


def predict(reference: PolygonState, law: Law | None = None, comm: MPI.Comm | None = None) -> State:
    """The state of a contact law for particles at the centers of bead polygons, not relaxed.

    Their radii are the effective ones of the polygons, `Polygons.effective_radius`.

    Args:
        reference: the polygons.
        law: by default `balanced` with the kA of the polygons, their kP = kL/N_v, and their beads
            as a rigid skin.
        comm: MPI ranks, as in `Simulation`.

    Raises:
        ParameterError: an argument is of another kind, or particles stick.
        LammpsError: see `Simulation.relax`.
    """
    expect("reference", reference, PolygonState)
    if law is None:
        law = matching_laws(reference.model, reference.polygons)["balanced"]
    expect("law", law, Ring, Sector)
    refuse_adhesion(law, (), ", and polygons have none")
    packing = replace(reference.packing, radii=reference.polygons.effective_radius)
    with Simulation(packing, law, comm) as sim:
        return sim.state()


def compare(
    reference: PolygonState, law: Law | None = None, comm: MPI.Comm | None = None
) -> Comparison:
    """Compare a contact law, as in `predict`, with polygons at the same centers."""
    state = predict(reference, law, comm)
    return Comparison(reference, state, shape_errors(reference, state))


def polygon_outlines(reference: PolygonState, state: State) -> list[NDArray[np.float64]]:
    """Lines of bead centers in a law, about each particle's own center, arrays (m, 2) [length]."""
    polygons = reference.polygons.radius[reference.packing.species]
    return state.parallels(state.packing.radius - polygons, _POINTS)


def shape_errors(reference: PolygonState, state: State) -> NDArray[np.float64]:
    """I of each particle, shape (N,): the outlines of a state against the beads.

    Raises:
        ParameterError: an outline folds: the particle is beyond the model.
    """
    errors = np.zeros(len(reference.packing))
    for n, (polygon, center, outline, radius) in enumerate(
        zip(
            reference.outlines,
            reference.packing.positions,
            polygon_outlines(reference, state),
            reference.packing.radius,
            strict=True,
        )
    ):
        try:
            errors[n] = shape_error(polygon - center, outline, radius)
        except ParameterError:
            raise ParameterError(
                f"the outline of particle {n} folds in the {state.law.name} law, which does not "
                "describe particles pressed that much: compress less"
            ) from None
    return errors
