"""What a contact law says about the centres of bead rings, and how far off it is."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .bead_state import BeadState
from .errors import ParameterError
from .models import Model
from .shape_error import shape_error
from .simulation import Simulation
from .state import State

# Corners of an outline: the polygon is nearer to the curve than 2e-6 of its radius.
_POINTS = 1440


@dataclass(frozen=True, eq=False)
class Comparison:
    """A contact law against bead rings with the same centres.

    Attributes:
        beads: the bead rings.
        state: the law's particles, with the effective radii of the rings; not relaxed.
        shape_error: I of each particle, see `shape_error`, shape (N,).
    """

    beads: BeadState
    state: State
    shape_error: NDArray[np.float64]

    @property
    def area_deficit_error(self) -> float:
        """Root mean square of S - S_beads over that of S_beads; inf where there is none."""
        exact = self.beads.area_deficit
        wrong = self.state.area_deficit - exact
        return _over(float(np.linalg.norm(wrong)), float(np.linalg.norm(exact)))

    @property
    def energy_ratio(self) -> float:
        """Energy of the law over that of the beads; inf where they bear none."""
        return _over(self.state.energy, self.beads.energy)

    @property
    def pressure_ratio(self) -> float:
        """Pressure of the law over that of the beads; inf where they bear none."""
        return _over(self.state.pressure, self.beads.pressure)


def _over(ours: float, exact: float) -> float:
    """A ratio, inf where it has no denominator."""
    return ours / exact if exact else math.inf


def predict(beads: BeadState, model: Model, comm: MPI.Comm | None = None) -> State:
    """The state that a contact law gives particles at the centres of bead rings, not relaxed.

    Their radius is the effective one of the rings, `Rings.effective_radius`.
    """
    packing = replace(beads.packing, radii=beads.rings.effective_radius)
    with Simulation(packing, model, comm) as sim:
        return sim.state()


def compare(beads: BeadState, model: Model, comm: MPI.Comm | None = None) -> Comparison:
    """Compare a contact law with bead rings, both with the same centres."""
    state = predict(beads, model, comm)
    return Comparison(beads, state, shape_errors(beads, state))


def ring_outlines(beads: BeadState, state: State) -> list[NDArray[np.float64]]:
    """The lines that a law has the beads draw, about each particle's own centre, arrays (m, 2)."""
    rings = beads.rings.radius[beads.packing.species]
    return state.parallels(state.packing.radius - rings, _POINTS)


def shape_errors(beads: BeadState, state: State) -> NDArray[np.float64]:
    """I of each particle, shape (N,): the outlines of a state against the beads.

    Raises:
        ParameterError: an outline folds, as of particles beyond the model.
    """
    errors = np.zeros(len(beads.packing))
    for n, (ring, centre, outline, radius) in enumerate(
        zip(
            beads.outlines,
            beads.packing.positions,
            ring_outlines(beads, state),
            beads.packing.radius,
            strict=True,
        )
    ):
        try:
            errors[n] = shape_error(ring - centre, outline, radius)
        except ParameterError:
            raise ParameterError(
                f"the outline of particle {n} folds in the {state.model.law} law, which no longer "
                "describes it: compress less"
            ) from None
    return errors
