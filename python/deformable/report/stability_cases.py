"""Stability of states: stiffnesses, densities, sizes, contacts many, close, light and deep.

Each family of cases is a function that returns rows: what was varied (`case`), for which law
(`parameter`), what was measured (`quantity`, `value`), the `limit` that it must not exceed, and
whether it does not (`ok`). Limits come from rounding, from the tolerance of relaxations, or from a
bound that stands beside them. Where a law fails by nature the row says why (`reason`).
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
from ..engine.simulation import Simulation
from ..model.laws import Law, Ring, Sector
from ..model.packing import Packing, bidisperse
from ..protocols.jamming import jam
from ..state.state import State
from ..studies import paper

LAWS: dict[str, Law] = {
    "ring radical": Ring(contact="radical"),
    "ring balanced": Ring(contact="balanced"),
    "sector": Sector(),
}
KERNELS = {"ring": core.ring, "sector": core.sector}

# Relaxations are asked for this residual, and sums of N energies round by N eps.
TOLERANCE = 1e-6
ROUNDING = 16 * np.finfo(float).eps

# What the kernels promise (docs/theory.md), of area deficits and contact lengths.
PRECISION = 1e-10

JUMPS = "its energy jumps where contacts appear"


def row(
    case: str,
    parameter: str,
    quantity: str,
    value: float | None,
    limit: float,
    reason: str = "",
) -> dict[str, Any]:
    """A row; a value that is no number, or none, is not ok."""
    known = value is not None and math.isfinite(value)
    ok = known and value is not None and value <= limit
    return {
        "case": case,
        "parameter": parameter,
        "quantity": quantity,
        "value": float(value) if known and value is not None else None,
        "limit": limit,
        "ok": bool(ok),
        "reason": "" if ok else reason,
    }


def strained(packing: Packing, law: Law, strain: float = 0.01) -> State:
    """Relaxed after one step of strain; what it has to say shows in its rows."""
    with Simulation(packing, law, MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim.deform(sim.box * (1.0 - strain))
        return sim.relax(TOLERANCE)


def at_rest(packing: Packing, law: Law) -> State:
    with Simulation(packing, law, MPI.COMM_SELF) as sim:
        return sim.state()


def stiffness_rows(jammed: Packing) -> Iterator[dict[str, Any]]:
    """kA scales energies and nothing else; kP leads from soft rings to those of kP = inf.

    At kP the energy is less than at kP = inf by (p sum L)^2/(8 pi^2 kP) to leading order, the work
    of a ring that breathes. With p = kA S, U = kA S^2/2 and sum L <= 2 pi R that is at most
    U kA R^2/kP.
    """
    kA = 10.0 ** np.arange(-6, 7, 3)
    packing = jammed.at(0.9)
    for name, law in LAWS.items():
        laws = {k: replace(law, kA=k) for k in kA.tolist()}
        one = at_rest(packing, law).energy
        off = max(abs(at_rest(packing, each).energy / k / one - 1.0) for k, each in laws.items())
        # sides that balance to 1e-8 err in the energy by its square
        yield row("kA 1e-6 to 1e6", name, "energy/kA against kA = 1", off, ROUNDING)
        left = max(strained(jammed, each).residual for each in laws.values())
        why = JUMPS if name == "sector" else ""
        yield row("kA 1e-6 to 1e6", name, "largest residual of FIRE", left, TOLERANCE, why)

    kP = 10.0 ** np.arange(-6, 13, 2)
    for contact in ("radical", "balanced"):
        stiff = at_rest(packing, Ring(contact=contact)).energy
        energies = np.array(
            [at_rest(packing, Ring(kP=float(k), contact=contact, reach=1.0)).energy for k in kP]
        )
        short = 1.0 - energies / stiff
        bound = float(packing.radii.max()) ** 2 / kP + PRECISION
        case, name = "kP/kA 1e-6 to 1e12", f"ring {contact}"
        off = float((short / bound).max())
        yield row(case, name, "energy below kP = inf, over the bound", off, 1.0)
        falls = float(-np.diff(energies).min() / stiff)
        yield row(case, name, "fall of the energy with kP", max(falls, 0.0), PRECISION)


def density_rows(jammed: Packing) -> Iterator[dict[str, Any]]:
    """From a gas to past confluence: finite, and particles beyond the model are said."""
    case, fractions = "phi 0.5 to 1.2", [0.5, 0.7, 0.8, *np.arange(0.84, 1.201, 0.04).tolist()]
    for name, law in LAWS.items():
        wrong, unsaid, beyond = 0, 0, 0
        try:
            with Simulation(jammed.at(fractions[0]), law, MPI.COMM_SELF) as sim:
                for fraction in fractions:
                    with warnings.catch_warnings(record=True) as caught:
                        warnings.simplefilter("always")
                        sim.deform(jammed.at(fraction).box)
                        state = sim.relax(TOLERANCE)
                    said = any(issubclass(each.category, BeyondModelWarning) for each in caught)
                    beyond = state.beyond
                    unsaid += beyond > 0 and not said
                    wrong += not _finite(state)
            refused = ""
        except LammpsError as error:
            refused = str(error)
        yield row(case, name, "states with numbers that are none", wrong, 0.0)
        yield row(case, name, "states beyond the model without a warning", unsaid, 0.0)
        yield row(case, name, "states refused", float(refused != ""), 0.0, refused)
        yield row(case, name, "no particle beyond the model at 1.2", float(beyond == 0), 0.0)


def _finite(state: State) -> bool:
    numbers = (state.energy, state.stress, state.area, state.perimeter, state.packing.positions)
    return all(np.isfinite(each).all() for each in numbers)


def size_rows() -> Iterator[dict[str, Any]]:
    """Large particles among small ones: outlines reach further, which needs more reach."""
    for ratio, reach in ((1.4, 0.3), (3.0, 0.5), (10.0, 3.0)):
        case, jammed = f"sizes 1 to {ratio:g}", jam(bidisperse(16, ratio=ratio, seed=1))
        for contact in ("radical", "balanced"):
            state = strained(jammed, Ring(contact=contact, reach=reach))
            yield row(case, f"ring {contact}", "residual of FIRE", state.residual, TOLERANCE)
        state = strained(jammed, Sector())
        yield row(case, "sector", "residual of FIRE", state.residual, TOLERANCE, JUMPS)


def kernel_rows() -> Iterator[dict[str, Any]]:
    """Single particles: 0 to 40 contacts, two side by side, the lightest and the deepest."""
    for name, kernel in KERNELS.items():
        worst = max(_slope(kernel, *_contacts(z, seed)) for z in range(41) for seed in range(5))
        yield row("0 to 40 contacts", name, "dS/da against S at a (1 +- 1e-6)", worst, 1e-5)
        yield _side_by_side(name, kernel)
        for sides in (3, 4, 6):
            K, least = paper.polygon_stiffness(sides), math.pi / (sides * math.tan(math.pi / sides))
            # free arcs vanish where the perimeter of the polygon is that of the circle
            a = np.append(10.0 ** np.arange(-12.0, -1.0), 0.999 * (1.0 - least))
            angle = 2.0 * np.pi * np.arange(sides) / sides
            off = max(
                abs(kernel(1.0, angle, np.full(sides, x)).area_deficit / (K * x * x) - 1.0)
                for x in a
            )
            case = f"1e-12 R to the end of {sides} sides"
            yield row(case, name, "S against K a^2", off, PRECISION)


def _contacts(z: int, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions and indentations of z contacts, all different."""
    random = np.random.default_rng((z, seed))
    return random.uniform(-np.pi, np.pi, z), random.uniform(0.001, 0.05, z)


def _slope(kernel: Callable[..., Any], angle: NDArray[np.float64], a: NDArray[np.float64]) -> float:
    """Largest error of dS/da over its largest value.

    S is quadratic, so that difference quotients are exact but for rounding, z eps/1e-6, and for
    contacts that open or close within the step, which count for parts of 1e-6.
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
    """A second contact 1e-6 rad beside one of three: the same wall, turned by that.

    The first presses a flat of length L; at the angle t beside it the outline sticks out by L t/2.
    So S changes by no more than that of an indentation deeper by L t, dS = L dS/da t.
    """
    apart, angle, a = 1e-6, np.array([0.0, 2.0, 4.0]), np.full(3, 0.02)
    one = kernel(1.0, angle, a)
    two = kernel(1.0, np.append(angle, apart), np.append(a, a[0]))
    change = abs(two.area_deficit / one.area_deficit - 1.0)
    L = float(one.d_indentation[0])
    limit = L * L * apart / one.area_deficit + PRECISION
    why = "the narrow sector between them keeps its own perimeter"
    return row("contacts 1e-6 rad apart", name, "change of S by the second", change, limit, why)


def convergence_rows(packings: int) -> Iterator[dict[str, Any]]:
    """How many relaxations of small packings FIRE does not end."""
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
