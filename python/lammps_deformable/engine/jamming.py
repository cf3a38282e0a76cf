"""Jamming: the packing at the onset of rigidity, of soft particles or of deformable ones.

Forces of soft particles are computed by kernels of this package, without LAMMPS; with a
communicator, and those of deformable particles, in LAMMPS. `push_off` separates particles that
overlap too far; with a free box the packing is stable against shear too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from tqdm import tqdm

from ..common.checks import expect, positive
from ..common.errors import ParameterError, StalledWarning, UnjammedWarning, collected, warn
from ..common.ranks import alone, progress, world
from ..particles.laws import (
    AnyLaw,
    Droplet,
    Jamming,
    Ring,
    Sector,
    SoftContact,
    check_dimension,
    excess_phi,
    natural_pressure,
    pressure_above_onset,
    refuse_adhesion,
)
from ..particles.packing import Packing, packing_of_species
from ..state.state import State, soft_state
from .engines import separated
from .free_box import check_free
from .relax import TOLERANCE, Callback, Iteration, check_callback, tell
from .simulation import Simulation, relax_above
from .soft_disks import (
    HUGE,
    RelaxedDisks,
    Report,
    relax_at_pressure,
    relax_in_box,
    relax_on_ranks,
    settle_at_pressure,
)

if TYPE_CHECKING:
    from mpi4py import MPI


class Watch:
    """Tells a bar and a callback how jamming goes on.

    Args:
        bar: of progress.
        callback: of the user, if any.
        comm: ranks that share the work, if any.
    """

    def __init__(self, bar: tqdm[Any], callback: Callback | None, comm: MPI.Comm | None) -> None:
        self._bar, self._callback, self._comm, self._iterations = bar, callback, comm, 0
        self._root = (comm or world()).rank == 0

    def begin(self, stage: str) -> None:
        """A stage begins, in words."""
        self._bar.set_description_str(f"jamming, {stage}", refresh=False)

    def tell(self, iterations: int, phi: float, pressure: float, residual: float) -> None:
        """So many iterations were done; see `Report` and `Iteration`."""
        shown = {"phi": f"{phi:.6f}", "pressure": f"{pressure:.1e}", "residual": f"{residual:.1e}"}
        self._bar.set_postfix(**shown)
        self._bar.update(iterations)
        self._iterations += iterations
        if self._callback:
            seen = Iteration("jam", self._iterations, phi, pressure, residual, self._root)
            tell(self._callback, seen, self._comm)


# Pressure of soft disks up to which a packing counts as loose while it is compressed, and step of
# packing fraction at which that ends. From there on the pressure falls.
_LOOSE, _FINEST = 1e-4, 0.0025

# From this number of disks on a packing is certainly rigid at this pressure, once the root mean
# square of the forces on particles is this part of those of contacts: from there on the pressure
# falls by a factor of at most 2. Fewer disks may still find a loose packing.
_MANY, _RIGID = 5000, (1e-3, 0.1)

# Compression only has to tell loose packings from rigid ones: forces on particles may be this part
# of those of contacts. The pressure is lowered in steps by a factor, each relaxed to a part.
_ROUGH, _FACTOR, _PART = 0.1, 0.3, 0.1

# HUGE packings settle by damped motion, in so many steps. Below this part a minimizer takes over.
_STEPS, _SETTLED = 200_000, 0.01

# Iterations at a pressure before the disks are compressed again, by so many of these steps; the
# number, here of a packing in so many dimensions, doubles each time.
_PATIENCE, _LONGEST, _BACK = {2: 1000, 3: 16_000}, 30_000, 4

# Threshold that is usual, and the highest one, over the natural pressure.
_USUAL, _HIGHEST = 1e-6, 0.1

# The pressure of the packing lies between the threshold and twice that.
_ABOVE = 1.4

# About phi at the onset, in so many dimensions, where radii that grow end.
_JAMS = {2: 0.84, 3: 0.64}

# Factors of the tolerance in stages of a relaxation. The energy only falls: a packing that is loose
# after one stage needs no other one. This saves time, because forces fall slowly.
_STAGES = (1000.0, 100.0, 10.0, 1.0)

# Pressure of soft disks where a free shape of the box begins.
_STABILIZED = 1e-3

# Below this part of the threshold the pressure of deformable particles does not tell how far the
# onset is.
_NOTHING = 0.1

# Relaxations of deformable particles in a row that stall: at another phi they may not.
_STALLS = 3

# A rearrangement may leave no packing between one and two thresholds: the search ends at this step.
_SMALLEST_STEP = 1e-10


def jam(
    packing: Packing,
    law: Jamming | None = None,
    *,
    pressure: float | None = None,
    free: str = "iso",
    grow: bool = False,
    tolerance: float = 1e-3,
    step: float = 0.02,
    comm: MPI.Comm | None = None,
    callback: Callback | None = None,
) -> State:
    """Compress particles from a loose start to the onset of rigidity.

    Soft disks are compressed isotropically in steps of packing fraction and relaxed after each one.
    If a packing is rigid, the step is halved and repeated from the last loose one, down to steps of
    0.0025. Then the pressure is lowered to 1.4 times the threshold: the energy and the work against
    this pressure are minimized with respect to the centers and the size of the box. Deformable
    particles start from disks at their phi - phi_J, and phi follows their pressure until it is
    above the threshold by at most a factor two.

    Soft disks have their forces from kernels of this package, by L-BFGS with a factored Hessian; no
    LAMMPS is opened for them. Deformable particles relax in LAMMPS. The same packing leads to the
    same result, to the last bit, on any x86-64 processor and any number of ranks, each of which
    does the same work. With a communicator its ranks share the compression of soft disks, then in
    LAMMPS by conjugate gradients, and the relaxation of deformable particles. That pays from some
    1e4 particles on. The result then depends on the number of ranks, and on nothing else.

    Args:
        packing: a packing below jamming, e.g. from `bidisperse`, or from `Packing.between` with
            walls, which are scaled with the box; particles may overlap.
        law: contact law, in three dimensions `Droplet`; if not given soft disks or spheres,
            `SoftContact()`.
        pressure: threshold of rigidity [energy/length^d]; by default 1e-6 of the unit of the law,
            and at most a tenth of it. With the mean radius R0 this is k of soft disks, k/(2 R0) of
            spheres, kA R0^2 of rings that conserve their perimeter, kP of those that conserve their
            area, tension/R0 of droplets. The distance to the onset depends on the law: p ~ phi -
            phi_J for disks, p ~ (phi - phi_J)^3 for rings.
        free: what is free beside the centers. With its size alone, `iso`, a box keeps a shear
            stress, and many packings would yield if its shape were free. With the shape, `tri`, or
            both lengths, `aniso`, the stress is `pressure` in all free directions, to 1e-6, and the
            shear stress is zero: the packing is stable against shear. The forces are then relaxed
            to 1e-6, which takes about a hundred relaxations: for some thousand particles at most.
        grow: all radii grow by one factor, in the box and between the walls of the start, which
            stay. Of soft disks, and of laws without a length of their own, the packing is that of
            the shrinking box at another scale.
        tolerance: largest force on a particle over that of a contact at the threshold. Take 1e-6 to
            count contacts, because the weakest ones have small forces. Take 0.1 for 30 000 disks
            and more: below 0.01 they may take hours.
        step: first step of packing fraction.
        comm: ranks that share the work; all of them call `jam` with the same packing.
        callback: called with an `Iteration` after each relaxation, and each 20 iterations within
            those of soft disks. Its exception ends `jam`.

    Returns:
        The jammed state, whose `packing` starts simulations of any law; phi is about 0.84 for an
        equal mixture of disks of sizes 1 : 1.4, and about 0.64 for spheres.

    Warns:
        StalledWarning: relaxations stalled, as with the sector law.

    Raises:
        ParameterError: the start is rigid already, a value is out of range, as a pressure far
            above an onset, or particles stick; or the box of walls has no free shape, or shall stay
            and change.

    Source: O'Hern, Silbert, Liu, Nagel, Phys. Rev. E 68, 011306 (2003); stable against shear:
    Dagois-Bohy et al., Phys. Rev. Lett. 109, 095703 (2012).
    """
    expect("packing", packing, Packing)
    if comm is not None:
        from mpi4py import MPI

        expect("comm", comm, MPI.Comm)
    law = SoftContact() if law is None else law
    expect("law", law, Ring, Sector, Droplet, SoftContact)
    if not isinstance(law, SoftContact):
        check_dimension(law, packing.dimension)
    refuse_adhesion(law, packing.walls, ", whose packings have no pressure at an onset")
    if pressure is not None:
        pressure = positive("pressure", pressure)
    positive("step", step)
    positive("tolerance", tolerance)
    expect("grow", grow, bool)
    sized = packing.at(_JAMS[packing.dimension], grow=True) if grow else packing
    unit = natural_pressure(sized, law)
    pressure = _USUAL * unit if pressure is None else pressure
    check_free(free, packing.walls, pressure, law)
    if pressure > _HIGHEST * unit:
        raise ParameterError(
            f"pressure = {pressure:g} is far above an onset: {law!r} has the unit {unit:.3g} of "
            f"pressure at these radii, so take a small part of it, by default {_USUAL * unit:.3g}"
        )
    if grow and free != "iso":
        raise ParameterError(
            f"grow=True keeps the box, and free='{free}' changes it: leave out one"
        )
    check_callback(callback)
    with progress("jamming", unit="iteration") as bar:
        watch = Watch(bar, callback, comm)
        if free != "iso":
            start = _jammed_disks(packing, _STABILIZED, step, _PART, watch, comm).packing
            watch.begin(f"free shape at {pressure:.1e}")
            state = stabilized(start, law, pressure, tolerance, free, comm, watch.tell)
        elif isinstance(law, SoftContact):
            threshold = _ABOVE * pressure / unit * natural_pressure(packing, SoftContact())
            disks = _jammed_disks(packing, threshold, step, tolerance / _ABOVE, watch, comm)
            jammed = _grown(disks.packing, packing) if grow else disks.packing
            state = soft_state(jammed, law, disks.residual, disks.converged)
        else:
            excess = excess_phi(_ABOVE * pressure / unit, packing, law)
            soft = SoftContact()
            near = pressure_above_onset(excess, packing, soft) * natural_pressure(packing, soft)
            start = _jammed_disks(packing, near, step, _PART, watch, comm).packing
            start = _grown(start, packing) if grow else start
            ranks = comm or alone()
            state = _jammed_particles(start, law, pressure, tolerance, watch, ranks, grow)
    if not state.converged:
        warn(
            f"relaxations stalled on the way to phi = {state.packing.phi:.6f}, the last one with a "
            f"largest force of {state.residual:.2g} of the mean contact force: the onset of "
            "jamming is uncertain",
            StalledWarning,
        )
    ranks = comm or world()
    state = comm.bcast(state) if comm else state  # machines may differ in rounding
    return replace(state, _root=ranks.rank == 0)


def _grown(jammed: Packing, start: Packing) -> Packing:
    """The packing at the scale of the start, from which its box and walls have shrunk."""
    factor = start.box[0, 0] / jammed.box[0, 0]
    return packing_of_species(
        factor * jammed.positions,
        start.species,
        factor * jammed.species_radii,
        start.box,
        factor * jammed.radii if jammed.own_radii else None,
        start.walls,
        start.seed,
    )


def _jammed_disks(
    packing: Packing,
    pressure: float,
    step: float,
    tolerance: float,
    watch: Watch,
    comm: MPI.Comm | None,
) -> RelaxedDisks:
    """Soft disks at this pressure [k]; for the other arguments see `jam`."""
    unit = natural_pressure(packing, SoftContact())
    loosest = _LOOSE * unit

    def relax(packing: Packing, rigid: tuple[float, float] | None = None) -> RelaxedDisks:
        if comm is None:
            disks = relax_in_box(packing, _ROUGH, loosest, watch.tell, rigid)
        else:
            disks = relax_on_ranks(packing, _ROUGH, loosest, watch.tell, comm)
        watch.tell(0, disks.packing.phi, disks.pressure, disks.residual)
        return disks

    watch.begin("compression")
    start = relax(separated(packing))
    if start.pressure > loosest:
        raise ParameterError(
            f"packing is rigid already at phi = {packing.phi:.4f}: start from a lower phi, "
            "`packing.at(phi)`"
        )
    loose = start.packing
    while True:
        # the packing of the last step is relaxed further
        rigid = (_RIGID[0] * unit, _RIGID[1]) if len(packing) >= _MANY and step > _FINEST else None
        disks = relax(loose.at(loose.phi + step), rigid)
        if disks.pressure <= loosest:
            loose = disks.packing
        elif step > _FINEST:
            step /= 2.0
        else:
            break
    watch.begin(f"decompression to {pressure:.1e}")
    return _decompressed(disks, pressure, tolerance, watch.tell)


def _decompressed(
    disks: RelaxedDisks, pressure: float, tolerance: float, report: Report
) -> RelaxedDisks:
    """Rigid disks at a lower pressure.

    A packing that rearranges at a low pressure does so in tiny steps, as small as its overlaps. It
    is compressed again, to rearrange there, and gets more time after each attempt.
    """
    highest, patience = disks.pressure, _PATIENCE[disks.packing.dimension]
    applied = highest
    while True:
        applied = max(_FACTOR * applied, pressure)
        part = tolerance if applied == pressure else _PART
        huge = len(disks.packing) >= HUGE
        if huge:
            settled = max(part, _SETTLED)
            disks = settle_at_pressure(disks.packing, applied, settled, _STEPS, report)
        if not huge or part < _SETTLED:
            disks = relax_at_pressure(disks.packing, applied, part, patience, report)
        report(0, disks.packing.phi, disks.pressure, disks.residual)
        if not disks.converged and patience < _LONGEST:
            applied, patience = min(applied / _FACTOR**_BACK, highest), 2 * patience
        elif applied == pressure:
            return disks


def _jammed_particles(
    packing: Packing,
    law: AnyLaw,
    pressure: float,
    tolerance: float,
    watch: Watch,
    comm: MPI.Comm,
    grow: bool,
) -> State:
    """Deformable particles with a pressure in the window of `jam`, from a packing near by.

    phi follows the pressure as `excess_phi` has it. A packing that rearranges has another phi_J:
    where phi has gone too far, the next step is at most half as long, otherwise at most twice as
    long. A packing that is still loose after a step gets one twice as long, up to 0.0025.
    """
    longest, last, stalls = np.inf, 0.0, 0
    watch.begin(f"particles to {pressure:.1e}")
    while True:
        unit = natural_pressure(packing, law)
        state = _relaxed(packing, law, pressure, tolerance, comm)
        found = state.pressure
        watch.tell(1, state.phi, found, state.residual)
        rigid = found > pressure
        stalls = stalls + 1 if not state.converged else 0
        at_rest = rigid and state.converged
        if stalls == _STALLS or (at_rest and (found <= 2.0 * pressure or longest < _SMALLEST_STEP)):
            return state
        target = excess_phi(_ABOVE * pressure / unit, packing, law)
        change = target - excess_phi(found / unit, packing, law)
        if last:
            longest = abs(last) * (2.0 if change * last > 0.0 else 0.5)
        if found < _NOTHING * pressure:
            change = max(change, min(2.0 * last, _FINEST))
        last = float(np.clip(change, -longest, longest))
        packing = state.packing.at(state.packing.phi + last, grow=grow)


def _relaxed(
    packing: Packing, law: AnyLaw, pressure: float, tolerance: float, comm: MPI.Comm
) -> State:
    """The packing, relaxed until its pressure is below the given one, or else to the tolerance."""
    # about the contact force at this pressure
    least = pressure * float(packing.radii.min()) ** (packing.dimension - 1)
    # `jam` warns once for all relaxations, and loose packings are expected below the onset
    quiet = collected(StalledWarning, UnjammedWarning)
    with Simulation(packing, law, comm=comm) as sim, quiet:
        for part in _STAGES:
            state = relax_above(sim, part * tolerance, least)
            if state.pressure <= pressure or not state.converged:
                break
    return state


# The shape is found at this phi - phi_J first, where hardly any contacts change, and then at ever
# lower ones, by this factor. Near the onset a shear changes contacts all the way.
_FAR, _NEARER = 0.01, 0.1


def stabilized(
    packing: Packing,
    law: Jamming,
    pressure: float,
    tolerance: float,
    free: str,
    comm: MPI.Comm | None,
    report: Report,
) -> State:
    """The packing relaxed at a pressure near the onset, with a free box.

    Args:
        packing: jammed, or nearly.
        law: of the particles.
        pressure: of the packing [energy/length^d].
        tolerance: of the relaxation at this pressure; at most that of `relax` is taken.
        free: what is free, see `Simulation.relax`.
        comm: ranks that share the relaxation of deformable particles.
        report: called after each relaxation.
    """
    unit = natural_pressure(packing, law)
    target = excess_phi(pressure / unit, packing, law)
    sim = Simulation(packing, law, comm=comm or alone())
    excess = max(target, _FAR)
    with sim, collected(UnjammedWarning):  # of the start, before it is compressed
        while excess > target:
            state = sim.relax(pressure=pressure_above_onset(excess, packing, law) * unit, free=free)
            report(1, state.phi, state.pressure, state.residual)
            excess = max(_NEARER * excess, target)
        state = sim.relax(min(tolerance, TOLERANCE), pressure=pressure, free=free)
        report(1, state.phi, state.pressure, state.residual)
        return state
