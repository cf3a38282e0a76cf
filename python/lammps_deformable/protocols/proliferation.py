"""Cells that grow, divide and die.

The volume V_i of a cell at rest (its area in the plane) grows at a rate, the slower the more others
press on it,

    dV_i/dt = rate V_i max(0, 1 - p_i/pressure),    p_i = sum f h/(d V_i)

over its contacts: f is the force, h the distance of the contact line, or facet, from the center,
and d the dimension; cells cease to grow at `pressure` (Shraiman 2005; Basan et al. 2009). A cell
that has reached a size divides in two, of shares that are drawn, side by side along an axis; each
cell may die at any time. The tissue is at rest all the time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.checks import count, expect, positive, shown, zero_or_more
from ..common.errors import LammpsError, ParameterError
from ..engine.lammps import run
from ..particles.laws import Droplet, Ring, one_or_each, per_species, volumes
from ..state.labels import divided, labels_of, remaining
from .motion import drawn_seed
from .protocol import Protocol, check_tolerance
from .recording import at_rest, next_time, steps_so_far

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ..engine.simulation import Simulation
    from ..state.state import State

Floats = NDArray[np.float64]

# Growth of a volume from one relaxation to the next.
_GROWTH = 0.05

# Packing fraction of undeformed cells that leave no room to grow.
_FULL = 0.9

_AXES = ("random", "long", "stress")


@dataclass(frozen=True, kw_only=True)
class Proliferate(Protocol):
    """See `Simulation.proliferate`."""

    rate: float | Sequence[float] | str
    division: float
    time: float
    axis: str = "random"
    kappa: float | None = None
    asymmetry: float = 0.1
    pressure: float | None = None
    death: float = 0.0
    tolerance: float | None = None
    seed: int | np.random.Generator | None = None

    def check(self, sim: Simulation, recorded: bool) -> Proliferate:
        expect("the law of cells", sim.law, Ring, Droplet)
        if sim.friction:
            raise ParameterError("cells slip: leave friction out of a simulation that proliferates")
        rate: Any = self.rate
        if isinstance(rate, str):
            rates_by_place(sim, rate)
        else:
            rate = one_or_each("rate", rate)
            for value in np.atleast_1d(rate).tolist():
                zero_or_more("rate", value)
        axis, dimension = self.axis, sim.dimension
        if axis not in _AXES:
            raise ParameterError(
                f"axis must be {', '.join(_AXES[:-1])} or stress, not {shown(axis)}"
            )
        if axis == "long" and dimension == 3:
            raise ParameterError("axis 'long' is for cells in the plane: take 'stress' or 'random'")
        kappa = None if self.kappa is None else float(zero_or_more("kappa", self.kappa))
        if kappa is not None and axis == "random":
            raise ParameterError(
                "kappa is that of directions about an axis: take 'long' or 'stress'"
            )
        asymmetry = zero_or_more("asymmetry", self.asymmetry)
        if asymmetry >= 1.0:
            raise ParameterError(f"asymmetry must be below 1, not {asymmetry}")
        pressure = self.pressure
        return Proliferate(
            rate=list(rate) if isinstance(rate, tuple) else rate,
            division=float(positive("division", self.division)),
            time=float(positive("time", self.time)),
            steps=count("steps", self.steps),
            axis=axis,
            kappa=kappa,
            asymmetry=float(asymmetry),
            pressure=math.inf if pressure is None else float(positive("pressure", pressure)),
            death=float(zero_or_more("death", self.death)),
            tolerance=check_tolerance(self.tolerance, recorded),
            seed=drawn_seed(sim, self.seed),
        )

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        """The relaxed start, and what its cells are called."""
        if not isinstance(self.rate, str):
            per_species(self.rate, len(sim.packing.species_radii))
        state = at_rest(sim, self.tolerance)
        return state, {
            "time": sim.time,
            "step": steps_so_far(sim),
            "label": int(labels_of(state).max()) + 1,
            "states": self.steps,
        }

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        state = at_rest(sim, self.tolerance) if before is None else before
        assert self.pressure is not None
        assert isinstance(self.seed, int)
        for n in range(done + 1, self.steps + 1):
            rng = np.random.default_rng([self.seed, start["step"], n])
            end = start["time"] + self.time * n / self.steps
            while state.time < end:
                free: Any = self.rate
                if isinstance(free, str):
                    free = rates_by_place(sim, free)
                rate = growth(state, free, self.pressure)
                fastest = max(float(rate.max()), self.death)
                step, later = next_time(state.time, end, _GROWTH, fastest)
                radii = state.radii * np.exp(rate * step / sim.dimension)
                grown = divide(state, radii, self, start, rng)
                sim.reset(replace(die(grown, self.death * step, rng), time=later))
                try:
                    state = at_rest(sim, self.tolerance)
                except LammpsError:
                    if state.packing.phi < _FULL:
                        raise
                    raise ParameterError(
                        f"the cells have no room to grow at time {state.time:.3g}, where they fill "
                        f"{state.phi:.3g} of the box: give a pressure at which growth ceases, or "
                        "end sooner"
                    ) from None
            yield state


def growth(state: State, rate: Any, pressure: float) -> Floats:
    """Rate of growth of each cell, shape (N,) [1/time].

    Args:
        state: of the cells.
        rate: without pressure, of all, of each species, or of each cell, shape (N,).
        pressure: at which growth ceases.
    """
    if not isinstance(rate, np.ndarray):
        rate = np.array(per_species(rate, len(state.packing.species_radii)))[state.packing.species]
    moments = np.trace(state.particle_stress, axis1=1, axis2=2) * state.volumes  # sum f h
    d = state.packing.dimension
    pressed = moments / (d * volumes(state.radii, d))
    return core.growth_rate(rate, pressed, pressure)


# Name of the variable: one that a user would not take.
_RATE = "deformable_rate"


def rates_by_place(sim: Simulation, formula: str) -> Floats:
    """Values of an atom-style formula of LAMMPS, such as exp(-x/5), shape (N,) [1/time].

    Raises:
        ParameterError: it is no formula, or a value is negative or not finite.
    """
    from lammps import LMP_VAR_ATOM

    lmp = sim.lmp
    try:
        run(lmp, f'variable {_RATE} atom "{formula}"')
        values = np.array(lmp.numpy.extract_variable(_RATE, "all", LMP_VAR_ATOM))
        run(lmp, f"variable {_RATE} delete")
    except Exception as error:  # the lammps module raises bare Exception
        line = str(error).splitlines()[0].partition(" (")[0]
        raise ParameterError(f"rate = {formula!r} is no atom-style formula: {line}") from None
    ids = np.array(lmp.numpy.extract_atom("id"))[: len(values)]
    rows = np.concatenate(sim.comm.allgather(np.column_stack([ids, values])))
    rates = rows[np.argsort(rows[:, 0]), 1]
    wrong = ~((rates >= 0.0) & (rates < math.inf))
    if wrong.any():
        n = int(wrong.argmax())
        raise ParameterError(f"rate = {formula!r} is {rates[n]:g} at particle {n}: not a rate")
    return np.ascontiguousarray(rates)


def die(state: State, chance: float, rng: np.random.Generator) -> State:
    """The state without the cells that die, each with a chance; one stays."""
    if chance == 0.0:
        return state
    left = rng.uniform(size=len(state.packing)) >= -math.expm1(-chance)
    if not left.any():
        left[0] = True
    return remaining(state, left)


def divide(
    state: State,
    radii: Floats,
    cells: Proliferate,
    start: dict[str, Any],
    rng: np.random.Generator,
) -> State:
    """The state with these radii, in which cells of a size have divided, not relaxed.

    Axes are those of the shapes and stresses of the relaxed state.
    """
    grown = replace(state, packing=state.packing.replace(radii=radii))
    mothers = np.flatnonzero(volumes(radii, state.packing.dimension) >= cells.division)
    if not mothers.size:
        return grown
    share = core.first_share(cells.asymmetry, rng.uniform(-1.0, 1.0, mothers.size))
    axes = np.zeros((len(mothers), state.packing.dimension))
    if cells.axis != "random":
        axes = (long_axes if cells.axis == "long" else stretched_axes)(state, mothers)
    free = (axes == 0.0).all(axis=1)  # no direction is different: any
    if cells.kappa is not None:
        axes[~free] = drawn_about(axes[~free], cells.kappa, rng)
    drawn = rng.normal(size=(free.sum(), state.packing.dimension))
    axes[free] = drawn / np.linalg.norm(drawn, axis=1)[:, None]
    label = start["label"]
    start["label"] += len(mothers)
    return divided(grown, mothers, axes, share, label)


def drawn_about(axes: Floats, kappa: float, rng: np.random.Generator) -> Floats:
    """Directions by von Mises' density about each axis, in space by Fisher's, shape (M, d).

    p ~ exp(kappa cos(theta)), with the angle theta to the axis; 0 is any direction.
    """
    if axes.shape[1] == 2:
        x, y = axes.T
        turned = np.arctan2(y, x) + rng.vonmises(0.0, kappa, len(axes))
        return core.unit_vectors(turned)
    if kappa == 0.0:
        drawn = rng.normal(size=axes.shape)
        return np.asarray(drawn / np.linalg.norm(drawn, axis=1)[:, None])
    from scipy.stats import vonmises_fisher

    found = [vonmises_fisher(axis, kappa).rvs(1, random_state=rng)[0] for axis in axes]
    return np.array(found).reshape(-1, 3)


def stretched_axes(state: State, cells: NDArray[np.int64]) -> Floats:
    """Along which a cell is pressed least, or pulled most, shape (M, d); 0 where nothing tells."""
    return core.stretched_axes(state.particle_stress[cells])


def long_axes(state: State, cells: NDArray[np.int64]) -> Floats:
    """The long axes of outlines (Hertwig's rule), shape (M, 2); 0 of those that are round."""
    return np.array([core.long_axis(state.outlines[i] - state.positions[i]) for i in cells])
