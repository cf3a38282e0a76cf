"""Soft disks and spheres without LAMMPS, for `jam`: energy, enthalpy, and their minimizers.

L-BFGS, for disks with factored springs that are renewed now and then; damped motion for very many
particles, of which some rearrange at any time. LAMMPS relaxes shares of very many particles on many
ranks, by conjugate gradients.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.box import fractional, lengths
from ..core import axpy, dot, norm
from ..particles.containers import Distances, free_room, stretched
from ..particles.neighbors import near_pairs
from ..particles.packing import Packing
from .engines import open_disks
from .lammps import gather, run
from .relax import force_rounding, largest_force, minimize_command
from .stress import stress

if TYPE_CHECKING:
    from mpi4py import MPI

Floats = NDArray[np.float64]

# Pairs up to this distance from contact are listed, in smallest radii: lists cost more than pairs.
_SKIN = 0.8

# Contacts within this overlap or gap count in part for the stiffness, in diameters of the smallest
# particle times the pressure: overlaps are about as large.
_SMOOTHING = 1.0

# Stiffness that is added to all particles, `softest`: these times the pressure and over N^2. The
# stiffness of the softest modes of a packing falls in proportion to the pressure down to about that
# of the longest chain of isostatic contacts (Wyart, Ann. Phys. Fr. 30, 1 (2005)); of rattlers it is
# zero.
_SHIFT, _SHIFT_OF_SIZE = 5.0, 10.0

# The same at least, in mean elements of the diagonal: springs are factored in single precision.
_LEAST_SHIFT = 1e-4

# Contacts with a smaller share do not count for the stiffness.
_SMALLEST_SHARE = 1e-3


class Enthalpy:
    """Energy of soft disks and walls, and the work against a pressure, of centers and box.

        H = 1/2 sum_c o_c^2 + P A,    o = max(R_i + R_j - d, 0), for walls max(R - h, 0)

    The box keeps its shape: with a size s, lengths are e^s times those of the packing. Variables
    are the centers X in the box of the packing, and t = l s with l^2 = 2 A, so that all have
    stiffnesses near 1:

        dH/dX_i = e^s (sum of the forces of i, with opposite sign)    dH/dt = 2 A (P - p) / l

    For spheres A is the volume, l^2 = 3 A/(2 <R>), and each other 2 in these formulas is a 3.

    Args:
        packing: where the disks start; no two centers at one place.
        pressure: P [k], of spheres [k/length]; None keeps the box, and P A = 0.

    Attributes:
        pressure: p of the last evaluation, (sum_c o_c d_c + sum over walls o h) / (2 A) [k].
        phi: packing fraction of the last evaluation.
    """

    def __init__(self, packing: Packing, pressure: float | None) -> None:
        self._start, self._applied, self._keeps_box = packing, pressure or 0.0, pressure is None
        self._radius, self._smallest = packing.radii, float(packing.radii.min())
        self._distances = Distances(packing.walls, packing.box) if packing.walls else None
        self._dimension, self._phi = packing.dimension, packing.phi
        self._room = free_room(packing.walls, packing.box)
        # a pressure times this length is one over the stiffness of contacts, as that of disks is
        self._thickness = 1.0 if self._dimension == 2 else 2.0 * float(self._radius.mean())
        self._length = float(np.sqrt(self._dimension * self._room / self._thickness))
        self._listed: tuple[Floats, float] | None = None

    @property
    def start(self) -> Floats:
        """Variables of the packing, shape (d N + 1,)."""
        return np.append(self._start.positions, 0.0)

    @property
    def softest(self) -> float:
        """About the stiffness of the softest modes at the pressure."""
        return _SHIFT * self._applied * self._thickness + _SHIFT_OF_SIZE / len(self._radius) ** 2

    @property
    def mass(self) -> Floats:
        """Of the variables: in proportion to the number of contacts that a disk may have."""
        of_each = 0.5 * (1.0 + self._radius / self._smallest)
        return np.append(np.repeat(of_each, self._dimension), 1.0)

    def packing(self, z: Floats) -> Packing:
        """The packing with these variables."""
        x, scale = self._unpacked(z)
        box = self._start.box * scale
        walls = stretched(self._start.walls, self._start.box, box)
        return self._start.replace(positions=x * scale, box=box, walls=walls)

    def __call__(self, z: Floats) -> tuple[float, Floats]:
        """The enthalpy and its gradient."""
        x, scale = self._unpacked(z)
        self._list(x, scale)
        energy, virial, gradient = self._pairs(x, scale)
        if self._distances:
            reach = float(self._radius.max()) / scale
            i, _, out, height = self._distances.contacts(x, reach)
            overlap = np.maximum(self._radius[i] - scale * height, 0.0)
            np.add.at(gradient.reshape(x.shape), i, scale * overlap[:, None] * out)
            energy += 0.5 * float(np.sum(overlap**2))
            virial += scale * float(np.sum(overlap * height))
        larger = scale**self._dimension
        area = self._room * larger
        self.pressure, self.phi = virial / (self._dimension * area), self._phi / larger
        if self._keeps_box:
            return energy, np.append(gradient, 0.0)
        growth = self._dimension * area * (self._applied - self.pressure) / self._length
        return energy + self._applied * area, np.append(gradient, growth)

    def preconditioner(self, z: Floats) -> Callable[[Floats], Floats]:
        """Product of a gradient of disks with the inverse of an approximate Hessian, at a pressure.

        The Hessian is sum_c k_c (do_c/dz)(do_c/dz)^T plus a shift. A contact counts in part,

            k = (1 + o / sqrt(o^2 + 4 m^2)) / 2

        with an overlap or gap o and m in proportion to the pressure, because the minimizer opens
        and closes contacts. Without the negative part of contacts under pressure it is positive
        definite.
        """
        pressure, dimension = self._applied, self._dimension
        x, scale = self._unpacked(z)
        self._list(x, scale)
        apart = x[self._j] - x[self._i] + self._shift
        lever = lengths(apart)
        direction = apart / np.maximum(lever, np.finfo(float).tiny)[:, None]
        gap, i, j = scale * lever - self._contact, self._i, self._j
        if self._distances:  # a wall is a partner that does not move
            out, height = self._distances(x)
            number = np.tile(np.arange(len(x)), len(out))
            lever = np.append(lever, height)
            gap = np.append(gap, scale * height - self._radius)
            direction = np.concatenate([direction, out.reshape(-1, dimension)])
            i, j = np.append(i, number), np.append(j, np.full_like(number, -1))
        smoothing = 2.0 * _SMOOTHING * pressure * self._thickness * self._smallest
        share = 0.5 * (1.0 - gap / np.hypot(gap, 2.0 * smoothing))
        near = share > _SMALLEST_SHARE
        share, lever, direction = share[near], scale * lever[near], direction[near]
        i, j, pair = i[near], j[near], j[near] >= 0
        shift = self.softest
        weight = share * scale**2
        diagonal = (weight.sum() + weight[pair].sum()) / x.size
        epsilon = max(shift / diagonal, _LEAST_SHIFT) if diagonal > 0.0 else 1.0
        inverse = core.DiskSprings(x, i, j, direction, weight, epsilon)
        pull = (share * scale * lever / self._length)[:, None] * direction
        coupling = np.zeros_like(x)
        np.add.at(coupling, i, -pull)
        np.add.at(coupling, j[pair], pull[pair])
        coupling = coupling.ravel()
        response = inverse(coupling)
        area = self._room * scale**dimension
        work = dimension**2 * pressure * area + core.dot(share, lever**2)
        stiffness = work / self._length**2 + shift - core.dot(coupling, response)

        def solve(gradient: Floats) -> Floats:
            centers = inverse(gradient[:-1])
            size = (gradient[-1] - core.dot(coupling, centers)) / stiffness
            return np.append(centers - size * response, size)

        return solve

    def _unpacked(self, z: Floats) -> tuple[Floats, float]:
        """Centers in the box of the packing, and e^s."""
        return z[:-1].reshape(-1, self._dimension), math.exp(z[-1] / self._length)

    def _list(self, x: Floats, scale: float) -> None:
        """List near pairs, unless all that overlap are in the last list."""
        skin = _SKIN * self._smallest
        if self._listed:
            before, size = self._listed
            moved = scale * math.sqrt(float(_squares(x - before).max()))
            ratio = scale / size
            widest = 2.0 * float(self._radius.max() if ratio < 1.0 else self._smallest)
            if ratio * (widest + skin) - 2.0 * moved > widest:
                return
        self._listed = x.copy(), scale
        placed = self.packing(np.append(x, self._length * math.log(scale)))
        self._i, self._j, shift = near_pairs(placed, skin)
        self._shift = shift / scale
        self._contact = self._radius[self._i] + self._radius[self._j]
        kernel = core.SoftDisks if self._dimension == 2 else core.SoftSpheres
        self._pairs = kernel(len(x), self._i, self._j, self._shift, self._contact)


# Called every 20 iterations with their number, phi, the pressure and the residual.
Report = Callable[[int, float, float, float], object]

# Iterations after which a relaxation in a box counts as stalled; largest step in smallest radii.
_PATIENCE, _LARGEST_STEP = 20_000, 0.1

# Springs pay for spheres down to a smaller residual than this: while spheres rearrange they cost
# more than the iterations that they save.
_SPRINGS_BELOW = 0.1

# From this number on a minimizer with one line search for all disks hardly moves, because contacts
# form somewhere: `settle_at_pressure` is better. And disks are sorted in rows: an evaluation finds
# near ones in the cache, which takes half the time.
HUGE = 30_000


class RelaxedDisks(NamedTuple):
    """Soft disks after a relaxation.

    Attributes:
        packing: with the same shape of the box.
        pressure: of the disks [k], of spheres [k/length].
        residual: largest force on a particle over the pressure times the smallest radius, of
            spheres its square, which is about a contact force; 0 if it is rounding.
        converged: whether the residual is within the tolerance.
    """

    packing: Packing
    pressure: float
    residual: float
    converged: bool


def relax_in_box(
    packing: Packing,
    tolerance: float,
    loose: float,
    report: Report,
    rigid: tuple[float, float] | None = None,
) -> RelaxedDisks:
    """Relax soft disks in their box, until the pressure is low or the forces are small.

    Args:
        packing: no two centers at one place.
        tolerance: largest residual.
        loose: pressure at which the packing is relaxed enough [k].
        report: see `Report`.
        rigid: a pressure [k]; above it the packing is relaxed enough where the root mean square of
            the forces on particles, in the unit of the residual, is at most the other number.
    """
    return _relax(packing, None, tolerance, _PATIENCE, report, loose, rigid)


def relax_at_pressure(
    packing: Packing,
    pressure: float,
    tolerance: float,
    patience: int,
    report: Report,
) -> RelaxedDisks:
    """Relax soft disks and the size of their box at a pressure [k], in so many iterations.

    See `relax_in_box`.
    """
    return _relax(packing, pressure, tolerance, patience, report)


def settle_at_pressure(
    packing: Packing, pressure: float, tolerance: float, patience: int, report: Report
) -> RelaxedDisks:
    """As `relax_at_pressure`, by damped motion: for residuals that are not tiny."""
    return _relax(packing, pressure, tolerance, patience, report, damped=True)


def _relax(
    packing: Packing,
    applied: float | None,
    tolerance: float,
    patience: int,
    report: Report,
    loose: float = -math.inf,
    rigid: tuple[float, float] | None = None,
    damped: bool = False,
) -> RelaxedDisks:
    order = _rows(packing) if len(packing) >= HUGE else None
    enthalpy = Enthalpy(packing if order is None else _reordered(packing, order), applied)
    smallest, dimension = float(packing.radii.min()), packing.dimension
    facet = smallest ** (dimension - 1)  # about that of a contact
    rounding = force_rounding(packing.box, stiffness=1.0)
    last = math.inf

    def residual(gradient: Floats) -> float:
        forces = gradient[:-1].reshape(-1, dimension)
        on_particles = math.sqrt(float(_squares(forces).max()))
        largest = max(on_particles, abs(float(gradient[-1])))
        scale = facet * (enthalpy.pressure if applied is None else applied)
        return largest / scale if largest > rounding and scale > 0.0 else 0.0

    def relaxed(gradient: Floats) -> bool:
        nonlocal last
        last = residual(gradient)
        if rigid and enthalpy.pressure >= rigid[0]:
            bearing = rigid[1] * facet * enthalpy.pressure
            if norm(gradient) <= bearing * math.sqrt(len(packing)):
                return True
        return enthalpy.pressure <= loose or last <= tolerance

    def tell(count: int) -> None:
        report(count, enthalpy.phi, enthalpy.pressure, last)

    start, largest_step = enthalpy.start, _LARGEST_STEP * smallest
    if damped:
        mass, softest = enthalpy.mass, enthalpy.softest
        z, enough = settle(enthalpy, start, mass, softest, relaxed, largest_step, patience, tell)
    else:
        springs = applied is not None and (dimension == 2 or tolerance < _SPRINGS_BELOW)
        inverse, lifetime = enthalpy.preconditioner if springs else None, _LIFETIME[dimension]
        z, enough = minimize(
            enthalpy, start, relaxed, largest_step, patience, tell, inverse, lifetime
        )
    _, gradient = enthalpy(z)
    found = enthalpy.packing(z)
    if order is not None:
        found = _reordered(found, np.argsort(order))
    return RelaxedDisks(found, enthalpy.pressure, residual(gradient), enough)


def _squares(vectors: Floats) -> Floats:
    """Of the lengths of vectors, shape (N, d)."""
    found: Floats = sum(part * part for part in vectors.T)
    return found


def _rows(packing: Packing) -> NDArray[np.int64]:
    """The order of disks in rows along x, each about a diameter high."""
    x, y = fractional(packing.positions, packing.box).T[:2] % 1.0
    return np.lexsort((x, np.floor(y * math.sqrt(len(packing)))))


def _reordered(packing: Packing, order: NDArray[np.int64]) -> Packing:
    return packing.replace(
        positions=packing.positions[order],
        species=packing.species[order],
        radii=packing.radii[order],
    )


# Iterations between looks at the pressure, and after which a relaxation counts as stalled.
_LOOK, _CG_PATIENCE = 100, 50_000

# Largest step in smallest radii.
_CG_STEP = 0.1

_CONJUGATE_GRADIENTS = """
min_style cg
min_modify line quadratic dmax {dmax!r} norm max
"""


def relax_on_ranks(
    packing: Packing, tolerance: float, loose: float, report: Report, comm: MPI.Comm
) -> RelaxedDisks:
    """As `relax_in_box`, shared by the ranks; the result depends on their number only.

    Walls and disks with radii of their own have no energy in LAMMPS: each rank relaxes them by
    itself.
    """
    if packing.walls or packing.own_radii:
        return relax_in_box(packing, tolerance, loose, report)
    smallest = float(packing.radii.min())
    facet = smallest ** (packing.dimension - 1)  # about that of a contact
    rounding = force_rounding(packing.box, stiffness=1.0)
    lmp = open_disks(packing, comm)
    try:
        run(lmp, _CONJUGATE_GRADIENTS.format(dmax=_CG_STEP * smallest))
        run(lmp, "run 0 post no")
        for iterations in range(0, _CG_PATIENCE + 1, _LOOK):
            pressure = float(np.trace(stress(lmp))) / packing.dimension
            largest = largest_force(lmp)
            bears = largest > rounding and pressure > 0.0
            residual = largest / (facet * pressure) if bears else 0.0
            relaxed = pressure <= loose or residual <= tolerance
            if relaxed or iterations == _CG_PATIENCE:
                break
            run(lmp, minimize_command(0.0, _LOOK))
            report(_LOOK, packing.phi, pressure, residual)
        positions = gather(lmp, "x", 3)[:, : packing.dimension]
    finally:
        lmp.close()
    return RelaxedDisks(packing.replace(positions=positions), pressure, residual, relaxed)


# Steps that are remembered: [4, 12] were tried.
_MEMORY = 12

# Iterations after which the preconditioner of a packing in so many dimensions is renewed: [20, 400]
# were tried.
_LIFETIME = {2: 20, 3: 300}

# Iterations between reports.
_REPORT = 20

# First part of the gradient that is tried as a step.
_FIRST = 0.2

# A step must reduce the value by this part of what the slope predicts (Armijo), or else, where
# rounding hides that, the slope by a tenth.
_DECREASE, _SLOPE, _ROUNDING = 1e-4, 0.9, 1e-10

# Evaluations along one direction, and directions in a row that fail.
_TRIALS, _FAILURES = 12, 4


# Value and gradient at a point; product of a gradient with an approximate inverse of the Hessian.
Function = Callable[[Floats], tuple[float, Floats]]
Inverse = Callable[[Floats], Floats]


def minimize(
    function: Function,
    z: Floats,
    relaxed: Callable[[Floats], bool],
    largest_step: float,
    patience: int,
    report: Callable[[int], object] = lambda iterations: None,
    preconditioner: Callable[[Floats], Inverse] | None = None,
    lifetime: int = 20,
) -> tuple[Floats, bool]:
    """Minimize a function.

    Args:
        function: it is evaluated last at the point that is returned.
        z: start.
        relaxed: whether a gradient, that of the last evaluation, is small enough.
        largest_step: of each variable in an iteration.
        patience: largest number of iterations.
        report: called every 20 iterations with their number.
        preconditioner: makes an approximate inverse of the Hessian at a point.
        lifetime: iterations after which it is made anew.

    Returns:
        The last point, and whether it is relaxed.

    Source: Nocedal and Wright, Numerical Optimization (2006), chapter 7.
    """
    steps: deque[tuple[Floats, Floats, float]] = deque(maxlen=_MEMORY)
    precondition: Inverse | None = None
    value, gradient = function(z)
    renewal = failures = 0
    for iteration in range(patience):
        if relaxed(gradient):
            return z, True
        if iteration % _REPORT == _REPORT - 1:
            report(_REPORT)
        if preconditioner and iteration >= renewal:
            precondition, renewal = preconditioner(z), iteration + lifetime
            steps.clear()
        direction = _direction(gradient, steps, precondition)
        direction *= min(1.0, largest_step / float(np.abs(direction).max(initial=1e-300)))
        slope = dot(gradient, direction)
        found = _search(function, z, value, direction, slope) if slope < 0.0 else None
        if found is None:
            failures, renewal = failures + 1, iteration
            steps.clear()
            if failures == _FAILURES:
                break
            continue
        failures = 0
        step, change = found[0] - z, found[2] - gradient
        curvature = dot(step, change)
        if curvature > 1e-14 * norm(step) * norm(change):
            steps.append((step, change, 1.0 / curvature))
        z, value, gradient = found
    _, gradient = function(z)
    return z, relaxed(gradient)


def _direction(
    gradient: Floats,
    steps: deque[tuple[Floats, Floats, float]],
    precondition: Inverse | None,
) -> Floats:
    """Minus the gradient times the inverse Hessian that the steps and preconditioner tell."""
    q, weights = -gradient, []
    for step, change, inverse in reversed(steps):
        weights.append(inverse * dot(step, q))
        axpy(q, -weights[-1], change)
    if precondition is not None:
        q = precondition(q)
    elif steps:
        _, change, inverse = steps[-1]
        q /= inverse * dot(change, change)
    else:
        q *= _FIRST
    for (step, change, inverse), weight in zip(steps, reversed(weights), strict=True):
        axpy(q, weight - inverse * dot(change, q), step)
    return q


def _search(
    function: Function, z: Floats, value: float, direction: Floats, slope: float
) -> tuple[Floats, float, Floats] | None:
    """Point, value and gradient of a step along a direction; None if none is good enough."""
    part = 1.0
    for _ in range(_TRIALS):
        there = z + part * direction
        new, gradient = function(there)
        flatter = dot(gradient, direction)
        if new <= value + _DECREASE * part * slope or (
            abs(flatter) <= _SLOPE * abs(slope) and new <= value + _ROUNDING * abs(value)
        ):
            return there, new, gradient
        # where the slope, taken as linear, is zero
        zero = part * slope / (slope - flatter) if flatter > slope else 0.5 * part
        part = min(max(zero, 0.1 * part), 0.6 * part)
    return None


# Time step, where the highest frequency is about 2.5.
_DAMPED_TIMESTEP = 0.5

# Steps between looks at the gradient.
_DAMPED_LOOK = 20


def settle(
    function: Function,
    z: Floats,
    mass: Floats,
    softest: float,
    relaxed: Callable[[Floats], bool],
    largest_step: float,
    patience: int,
    report: Callable[[int], object],
) -> tuple[Floats, bool]:
    """Move by m z'' = -df/dz - 2 sqrt(softest) m z' until the gradient is small.

    Modes of the stiffness `softest` are damped critically. A minimizer has one line search for all
    particles: contacts that form at one place keep all others from moving. Here each place moves
    as fast as it would alone.

    Args:
        function: value and gradient at a point.
        z: start.
        mass: of each variable, so that all have stiffnesses near 1 or less.
        softest: stiffness of the softest modes over their mass.
        relaxed: whether a gradient is small enough.
        largest_step: of each variable in a step.
        patience: largest number of steps.
        report: called with the number of steps since it was called last.

    Returns:
        The last point, and whether it is relaxed.
    """
    keep = max(1.0 - 2.0 * math.sqrt(softest) * _DAMPED_TIMESTEP, 0.0)
    push, fastest = _DAMPED_TIMESTEP / mass, largest_step / _DAMPED_TIMESTEP
    velocity = np.zeros_like(z)
    for step in range(patience):
        _, gradient = function(z)
        if step % _DAMPED_LOOK == 0:
            report(_DAMPED_LOOK if step else 0)
            if relaxed(gradient):
                return z, True
        velocity *= keep
        velocity -= push * gradient
        np.clip(velocity, -fastest, fastest, out=velocity)
        z = z + _DAMPED_TIMESTEP * velocity
    _, gradient = function(z)
    return z, relaxed(gradient)
