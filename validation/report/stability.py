"""Numerical stability of each law: long and stiff time steps, extreme stiffness, density, sizes.

Each family of cases is a function that returns rows: `case` is varied, for the contact law `law`.
`value` is the measured `quantity`, None after an error. `ok` is true if it is at most `limit`.
Limits come from rounding, from the tolerance of relaxations, or from a bound that stands beside
them. `reason` explains why a law fails. What holds at any setting, such as derivatives and the
number of ranks, is for the tests.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from lammps_deformable import core
from lammps_deformable.common.errors import BeyondModelWarning, LammpsError
from lammps_deformable.common.parallel import parallel_map
from lammps_deformable.engine.jamming import jam
from lammps_deformable.engine.lammps import run
from lammps_deformable.engine.relax import TOLERANCE
from lammps_deformable.engine.simulation import Simulation
from lammps_deformable.particles.generators import bidisperse
from lammps_deformable.particles.laws import LAWS, Law, Ring, Sector
from lammps_deformable.particles.packing import Packing
from lammps_deformable.state.state import State
from mpi4py import MPI
from numpy.typing import NDArray

from validation.ensembles import power_law
from validation.report.paper import polygon_stiffness
from validation.report.section import Column, Row, Section, Table, listed, show, span

T = TypeVar("T")

# The ring laws have one kernel.
KERNELS = {
    "balanced": core.ring,
    "curved": core.ring,
    "radical": core.ring,
    "sector": core.sector,
}

# Sums of N energies round by N eps.
ROUNDING = 16 * np.finfo(float).eps

# Relative precision of area deficits and contact lengths of the kernels (docs/theory.md).
PRECISION = 1e-10

JUMPS = "its energy jumps where contacts appear"


# Temperature at the start, far below the potential energy, which drives the motion.
TEMPERATURE = 1e-6

_RUN = """
fix move all nve
timestep {dt!r}
thermo_style custom step pe ke etotal
thermo_modify norm no
"""


def stability_rows(packings: int = 100, steps: int = 1_000_000, densest: float = 1.2) -> list[Row]:
    """All cases, of 16 particles.

    Args:
        packings: number relaxed by each law.
        steps: of the longest run at constant energy.
        densest: largest packing fraction; past confluence curved contacts take minutes.
    """
    jammed = jam(bidisperse(16, seed=1)).packing
    return [
        *energy_rows(jammed.at(0.88), steps),
        *long_step_rows(jammed.at(0.88)),
        *stiffness_rows(jammed),
        *density_rows(jammed, densest),
        *size_rows(),
        *contact_rows(),
        *convergence_rows(packings),
    ]


def row(
    case: str,
    law: str,
    quantity: str,
    value: float | None,
    limit: float,
    reason: str = "",
) -> Row:
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
    with Simulation(packing, law, comm=MPI.COMM_SELF) as sim, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim.deform(sim.box * (1.0 - strain))
        return sim.relax(TOLERANCE)


def at_rest(packing: Packing, law: Law) -> State:
    with Simulation(packing, law, comm=MPI.COMM_SELF) as sim:
        return sim.state()


def energies(
    packing: Packing, law: Law, dt: float, steps: int, samples: int
) -> tuple[NDArray[np.float64], float]:
    """Total energy at samples + 1 times of a run, and its last kinetic energy."""
    with Simulation(packing, law, comm=MPI.COMM_SELF) as sim:
        run(sim.lmp, f"velocity all create {TEMPERATURE} 4711 loop all{_RUN.format(dt=dt)}")
        run(sim.lmp, "run 0 post no")
        recorded = [sim.lmp.get_thermo("etotal")]
        for _ in range(samples):
            run(sim.lmp, f"run {steps // samples} post no")
            recorded.append(sim.lmp.get_thermo("etotal"))
        return np.array(recorded), float(sim.lmp.get_thermo("ke"))


def energy_rows(packing: Packing, steps: int) -> Iterator[dict[str, Any]]:
    """Energy error of velocity Verlet: against the time step, and over many steps.

    The error falls as dt^2 if the force is continuous, as dt if the force jumps, and not at all if
    the energy jumps. The limit of the order is half way between the first two. Kinks of the force
    add random amounts to the energy: over n samples sqrt(n) times a single one, and hardly ever
    three times that. A drift exceeds this limit.
    """
    for name, law in LAWS.items():
        order, why = _measured(name, _order, packing, law)
        off = None if order is None else abs(order - 2.0)
        yield row(
            "time step 0.4 to 0.025",
            name,
            "order of the energy error, distance from 2",
            off,
            0.5,
            why,
        )

        found, why = _measured(name, _drift, packing, law, steps)
        drift, limit = (None, 0.0) if found is None else found
        case, what = f"{steps:g} steps of 0.1", "energy drift over the kinetic energy"
        yield row(case, name, what, drift, limit, why)


def _measured(name: str, measure: Callable[..., T], *arguments: Any) -> tuple[T | None, str]:
    """The measured value, or None after an error, and the reason of a failure."""
    why = JUMPS if name == "sector" else ""
    try:
        return measure(*arguments), why
    except LammpsError as error:
        return None, ": ".join(filter(None, (why, str(error))))


def _order(packing: Packing, law: Law) -> float:
    """Power of the time step with which the energy error falls."""
    steps = 0.4 / 2.0 ** np.arange(5)
    errors = [energies(packing, law, dt, round(40.0 / dt), 20)[0].std() for dt in steps.tolist()]
    return power_law(steps, errors)


def _drift(packing: Packing, law: Law, steps: int) -> tuple[float, float]:
    """Energy drift from the first to the last quarter over the kinetic energy, and its limit."""
    samples = 200
    total, kinetic = energies(packing, law, 0.1, steps, samples)
    quarter = samples // 4
    drift = abs(total[-quarter:].mean() - total[:quarter].mean())
    return float(drift / kinetic), float(3.0 * np.diff(total).std() * np.sqrt(samples) / kinetic)


def long_step_rows(packing: Packing) -> Iterator[dict[str, Any]]:
    """Impossible time steps end with one line, and all values before are finite."""
    for name, law in LAWS.items():
        silent = 0
        for dt in (1e1, 1e3, 1e6, 1e12):
            try:
                total, _ = energies(packing, law, dt, 200, 20)
                silent += not np.isfinite(total).all()
            except LammpsError as error:
                silent += not re.search(r"atoms? \d+|Lost atoms|Non-numeric", str(error), re.I)
        yield row(
            "time steps 10 to 1e12", name, "runs that end without an error message", silent, 0.0
        )


def stiffness_rows(jammed: Packing) -> Iterator[Row]:
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
    for contact in ("radical", "balanced", "curved"):
        stiff = at_rest(packing, Ring(contact=contact)).energy
        energies = np.array(
            [at_rest(packing, Ring(kP=float(k), contact=contact, reach=1.0)).energy for k in kP]
        )
        short = 1.0 - energies / stiff
        bound = float(packing.radii.max()) ** 2 / kP + PRECISION
        case, name = "kP/kA 1e-6 to 1e12", contact
        off = float((short / bound).max())
        yield row(case, name, "energy below that of kP = inf, over the bound", off, 1.0)


def density_rows(jammed: Packing, densest: float) -> Iterator[Row]:
    """From a gas to beyond confluence: finite values, and warnings beyond the model."""
    case = f"phi 0.5 to {densest:g}"
    fractions = [0.5, 0.7, 0.8, *np.arange(0.84, densest + 0.001, 0.04).tolist()]
    for name, law in LAWS.items():
        infinite, silent = 0, 0
        try:
            with Simulation(jammed.at(fractions[0]), law, comm=MPI.COMM_SELF) as sim:
                for fraction in fractions:
                    with warnings.catch_warnings(record=True) as caught:
                        warnings.simplefilter("always")
                        sim.deform(jammed.at(fraction).box)
                        state = sim.relax(TOLERANCE)
                    warned = any(issubclass(each.category, BeyondModelWarning) for each in caught)
                    silent += state.beyond > 0 and not warned
                    infinite += not _finite(state)
            refused = ""
        except LammpsError as error:
            refused = str(error)
        yield row(case, name, "states with values that are not finite", infinite, 0.0)
        yield row(case, name, "states beyond the model without a warning", silent, 0.0)
        yield row(case, name, "states refused", float(refused != ""), 0.0, refused)


def _finite(state: State) -> bool:
    numbers = (
        state.energy,
        state.pressure_tensor,
        state.volumes,
        state.perimeters,
        state.packing.positions,
    )
    return all(np.isfinite(each).all() for each in numbers)


def size_rows() -> Iterator[Row]:
    """Large particles among small ones: outlines bulge further, which needs more reach."""
    for ratio, reach in ((1.4, 0.3), (3.0, 0.5), (10.0, 3.0)):
        case, jammed = (
            f"sizes 1 to {ratio:g}",
            jam(bidisperse(16, sizes=(0.5, 0.5 * ratio), seed=1)).packing,
        )
        for contact in ("radical", "balanced", "curved"):
            state = strained(jammed, Ring(contact=contact, reach=reach))
            yield row(case, contact, "residual of FIRE", state.residual, TOLERANCE)
        state = strained(jammed, Sector())
        yield row(case, "sector", "residual of FIRE", state.residual, TOLERANCE, JUMPS)


def contact_rows() -> Iterator[Row]:
    """Single particles: two contacts side by side, and all depths of contacts."""
    for name, kernel in KERNELS.items():
        yield _side_by_side(name, kernel)
        for sides in (3, 4, 6):
            K, least = polygon_stiffness(sides), math.pi / (sides * math.tan(math.pi / sides))
            # at the last depth the polygon has the perimeter of the circle: free arcs vanish
            a = np.append(10.0 ** np.arange(-12.0, -1.0), 0.999 * (1.0 - least))
            angle = 2.0 * np.pi * np.arange(sides) / sides
            off = max(
                abs(kernel(1.0, angle, np.full(sides, x)).area_deficit / (K * x * x) - 1.0)
                for x in a
            )
            case = f"contacts 1e-12 R to the deepest, {sides} sides"
            yield row(case, name, "relative error of S = K a²", off, PRECISION)


def _side_by_side(name: str, kernel: Callable[..., Any]) -> Row:
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


def convergence_rows(packings: int) -> Iterator[Row]:
    """Number of relaxations of small packings that do not converge."""
    failed = parallel_map(_failures, range(1, packings + 1))
    for name in LAWS:
        case, count = f"{packings} packings, 1 % strain", sum(each[name] for each in failed)
        why = JUMPS if name == "sector" else ""
        yield row(case, name, "relaxations that do not converge", count, 0.0, why)


def _failures(seed: int) -> dict[str, bool]:
    jammed = jam(bidisperse(16, seed=seed)).packing
    return {name: (not strained(jammed, law).converged) for name, law in LAWS.items()}


def section(rows: Sequence[Row]) -> Section:
    missed = [row for row in rows if not row["ok"]]
    by_law = {name: sum(row["law"] == name for row in missed) for name in LAWS}
    kept = [name for name, count in by_law.items() if count == 0]
    reasons = dict.fromkeys(
        f"`{row['law']}`: {row['reason'].split(': LAMMPS')[0]}" for row in missed if row["reason"]
    )
    return Section(
        "Stability",
        (
            "Each case varies one thing, such as the time step, the stiffness, the density or the "
            "ratio of sizes, and measures a quantity that must not exceed a limit: rounding, the "
            "tolerance of a relaxation, or a derived bound.",
            f"{len(rows) - len(missed)} of {len(rows)} measurements stay within their limits (✓). "
            + (f"All measurements of {listed(f'`{name}`' for name in kept)} do. " if kept else "")
            + (
                "The others (✗) are "
                + listed(f"{count} of `{name}`" for name, count in by_law.items() if count)
                + ". Reasons: "
                + "; ".join(reasons)
                + "."
                if missed
                else ""
            ),
        ),
        tables=[
            Table(
                "Measured values and their limits",
                [
                    Column("case", "case", text=True),
                    Column("quantity", "quantity", text=True),
                    *(Column(name, name) for name in LAWS),
                    Column("limit", "limit", "the value must not exceed it"),
                ],
                _by_case(rows),
            )
        ],
    )


def _by_case(rows: Sequence[Row]) -> list[Row]:
    """A row for each case and quantity, with a value and a mark for each law."""
    found: list[Row] = []
    for case, quantity in dict.fromkeys((row["case"], row["quantity"]) for row in rows):
        same = [row for row in rows if (row["case"], row["quantity"]) == (case, quantity)]
        values = {row["law"]: f"{show(row['value'])} {'✓' if row['ok'] else '✗'}" for row in same}
        limit = span(row["limit"] for row in same if row["value"] is not None)
        found.append({"case": case, "quantity": quantity, "limit": limit} | values)
    return found
