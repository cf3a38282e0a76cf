"""Stability of states: extreme stiffnesses, densities, sizes and contacts.

Each family of cases is a function that returns rows: `case` is varied, for the contact law `law`.
`value` is the measured `quantity`. `ok` is true if it is at most `limit`.
Limits come from rounding, from the tolerance of relaxations, or from a bound that stands beside
them. `reason` explains why a law fails.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from .. import core
from ..common.errors import BeyondModelWarning, LammpsError
from ..common.parallel import parallel_map
from ..engine.relaxation import TOLERANCE
from ..engine.simulation import Simulation
from ..model.laws import LAWS, Law, Ring, Sector
from ..model.packing import Packing, bidisperse
from ..protocols.jamming import jam
from ..state.state import State
from ..studies import paper

# The ring laws have one kernel.
KERNELS = {
    "balanced": core.ring,
    "tilted": core.ring,
    "radical": core.ring,
    "sector": core.sector,
}

# Sums of N energies round by N eps.
ROUNDING = 16 * np.finfo(float).eps

# Relative precision of area deficits and contact lengths of the kernels (docs/theory.md).
PRECISION = 1e-10

JUMPS = "its energy jumps where contacts appear"


def row(
    case: str,
    law: str,
    quantity: str,
    value: float | None,
    limit: float,
    reason: str = "",
) -> dict[str, Any]:
    """A row; it is not ok if the value is None, nan or infinite."""
    known = value is not None and math.isfinite(value)
    ok = known and value is not None and value <= limit
    return {
        "case": case,
        "law": law,
        "quantity": quantity,
        "value": float(value) if known and value is not None else None,
        "limit": limit,
        "ok": bool(ok),
        "reason": "" if ok else reason,
    }


def strained(packing: Packing, law: Law, strain: float = 0.01) -> State:
    """Relaxed after one step of strain, without warnings: the rows have the residual."""
    with Simulation(packing, law, MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim.deform(sim.box * (1.0 - strain))
        return sim.relax(TOLERANCE)


def at_rest(packing: Packing, law: Law) -> State:
    with Simulation(packing, law, MPI.COMM_SELF) as sim:
        return sim.state()


def stiffness_rows(jammed: Packing) -> Iterator[dict[str, Any]]:
    """Energies are proportional to kA, and tend to those of kP = inf for stiff perimeters.

    At kP the energy is lower than at kP = inf by (p sum L)^2/(8 pi^2 kP) to leading order, the work
    of the radial expansion of the ring. With p = kA S, U = kA S^2/2 and sum L <= 2 pi R this is at
    most U kA R^2/kP.
    """
    kA = 10.0 ** np.arange(-6, 7, 3)
    packing = jammed.at(0.9)
    for name, law in LAWS.items():
        laws = {k: replace(law, kA=k) for k in kA.tolist()}
        one = at_rest(packing, law).energy
        off = max(abs(at_rest(packing, each).energy / k / one - 1.0) for k, each in laws.items())
        # balanced sides are found to 1e-8; the error of the energy is its square
        yield row("kA 1e-6 to 1e6", name, "energy/kA against kA = 1", off, ROUNDING)
        left = max(strained(jammed, each).residual for each in laws.values())
        why = JUMPS if name == "sector" else ""
        yield row("kA 1e-6 to 1e6", name, "largest residual of FIRE", left, TOLERANCE, why)

    kP = 10.0 ** np.arange(-6, 13, 2)
    for contact in ("radical", "balanced", "tilted"):
        stiff = at_rest(packing, Ring(contact=contact)).energy
        energies = np.array(
            [at_rest(packing, Ring(kP=float(k), contact=contact, reach=1.0)).energy for k in kP]
        )
        short = 1.0 - energies / stiff
        bound = float(packing.radii.max()) ** 2 / kP + PRECISION
        case, name = "kP/kA 1e-6 to 1e12", contact
        off = float((short / bound).max())
        yield row(case, name, "energy below that of kP = inf, over the bound", off, 1.0)
        falls = float(-np.diff(energies).min() / stiff)
        yield row(case, name, "decrease of the energy with kP", max(falls, 0.0), PRECISION)


def density_rows(jammed: Packing, densest: float) -> Iterator[dict[str, Any]]:
    """From a gas to beyond confluence: finite values, and warnings beyond the model."""
    case = f"phi 0.5 to {densest:g}"
    fractions = [0.5, 0.7, 0.8, *np.arange(0.84, densest + 0.001, 0.04).tolist()]
    for name, law in LAWS.items():
        infinite, silent, beyond = 0, 0, 0
        try:
            with Simulation(jammed.at(fractions[0]), law, MPI.COMM_SELF) as sim:
                for fraction in fractions:
                    with warnings.catch_warnings(record=True) as caught:
                        warnings.simplefilter("always")
                        sim.deform(jammed.at(fraction).box)
                        state = sim.relax(TOLERANCE)
                    warned = any(issubclass(each.category, BeyondModelWarning) for each in caught)
                    beyond = state.beyond
                    silent += beyond > 0 and not warned
                    infinite += not _finite(state)
            refused = ""
        except LammpsError as error:
            refused = str(error)
        yield row(case, name, "states with values that are not finite", infinite, 0.0)
        yield row(case, name, "states beyond the model without a warning", silent, 0.0)
        yield row(case, name, "states refused", float(refused != ""), 0.0, refused)
        none_beyond = f"no particle beyond the model at phi {densest:g}"
        yield row(case, name, none_beyond, float(beyond == 0), 0.0)


def _finite(state: State) -> bool:
    numbers = (state.energy, state.stress, state.area, state.perimeter, state.packing.positions)
    return all(np.isfinite(each).all() for each in numbers)


def size_rows() -> Iterator[dict[str, Any]]:
    """Large particles among small ones: outlines bulge further, which needs more reach."""
    for ratio, reach in ((1.4, 0.3), (3.0, 0.5), (10.0, 3.0)):
        case, jammed = f"sizes 1 to {ratio:g}", jam(bidisperse(16, ratio=ratio, seed=1))
        for contact in ("radical", "balanced", "tilted"):
            state = strained(jammed, Ring(contact=contact, reach=reach))
            yield row(case, contact, "residual of FIRE", state.residual, TOLERANCE)
        state = strained(jammed, Sector())
        yield row(case, "sector", "residual of FIRE", state.residual, TOLERANCE, JUMPS)


def kernel_rows() -> Iterator[dict[str, Any]]:
    """Single particles: 0 to 40 contacts, two contacts side by side, all depths of contacts."""
    for name, kernel in KERNELS.items():
        worst = max(_slope(kernel, *_contacts(z, seed)) for z in range(41) for seed in range(5))
        yield row("0 to 40 contacts", name, "dS/da against differences of S", worst, 1e-5)
        yield _side_by_side(name, kernel)
        for sides in (3, 4, 6):
            K, least = paper.polygon_stiffness(sides), math.pi / (sides * math.tan(math.pi / sides))
            # at the last depth the polygon has the perimeter of the circle: free arcs vanish
            a = np.append(10.0 ** np.arange(-12.0, -1.0), 0.999 * (1.0 - least))
            angle = 2.0 * np.pi * np.arange(sides) / sides
            off = max(
                abs(kernel(1.0, angle, np.full(sides, x)).area_deficit / (K * x * x) - 1.0)
                for x in a
            )
            case = f"contacts 1e-12 R to the deepest, {sides} sides"
            yield row(case, name, "relative error of S = K a²", off, PRECISION)


def _contacts(z: int, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions and indentations of z contacts, all different."""
    random = np.random.default_rng((z, seed))
    return random.uniform(-np.pi, np.pi, z), random.uniform(0.001, 0.05, z)


def _slope(kernel: Callable[..., Any], angle: NDArray[np.float64], a: NDArray[np.float64]) -> float:
    """Largest error of dS/da over its largest value.

    S is quadratic, so that difference quotients are exact up to rounding, z eps/1e-6, and up to
    parts of 1e-6 for contacts that open or close within the step.
    """
    exact, step = kernel(1.0, angle, a).d_indentation, 1e-6
    worst = 0.0
    for c in range(len(a)):
        off = step * a[c] * np.eye(len(a))[c]
        more, less = (kernel(1.0, angle, a + s * off).area_deficit for s in (1, -1))
        worst = max(worst, abs((more - less) / (2.0 * step * a[c]) - exact[c]))
    largest = float(np.abs(exact).max(initial=0.0))
    return worst / largest if largest > 0.0 else worst


def _side_by_side(name: str, kernel: Callable[..., Any]) -> dict[str, Any]:
    """A second contact 1e-6 rad beside one of three: the same wall turned by that angle.

    The first contact has the length L. At the angle t beside it the outline lies further out by
    L t/2. So S changes at most as for an indentation deeper by L t, dS = L dS/da t.
    """
    apart, angle, a = 1e-6, np.array([0.0, 2.0, 4.0]), np.full(3, 0.02)
    one = kernel(1.0, angle, a)
    two = kernel(1.0, np.append(angle, apart), np.append(a, a[0]))
    change = abs(two.area_deficit / one.area_deficit - 1.0)
    L = float(one.d_indentation[0])
    limit = L * L * apart / one.area_deficit + PRECISION
    why = "the narrow sector between them keeps its own perimeter"
    return row("contacts 1e-6 rad apart", name, "relative change of S", change, limit, why)


def convergence_rows(packings: int) -> Iterator[dict[str, Any]]:
    """Number of relaxations of small packings that do not converge."""
    failed = parallel_map(
        _failures, [(seed,) for seed in range(1, packings + 1)], description="stability"
    )
    for name in LAWS:
        case, count = f"{packings} packings, 1 % strain", sum(each[name] for each in failed)
        why = JUMPS if name == "sector" else ""
        yield row(case, name, "relaxations that do not converge", count, 0.0, why)


def _failures(seed: int) -> dict[str, bool]:
    jammed = jam(bidisperse(16, seed=seed))
    return {name: strained(jammed, law).stalled for name, law in LAWS.items()}
