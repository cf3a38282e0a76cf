"""A state of a simulation: a snapshot, which later steps do not change.

One class for all laws, in the plane and in space. What a law computes for each particle is data,
`State.results`. What a state cannot have is no attribute of it: `hasattr` says no, and the error
tells what has it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.checks import count, expect, numbers, positive, shown
from ..common.errors import ParameterError, UndefinedError, UnsavedWarning, renamed, warn
from ..common.files import check_parameters, replaces
from ..common.versions import optional
from ..formats.store import (
    drop_frames,
    frames_in,
    refuse_run,
)
from ..particles.containers import free_room
from ..particles.friction import Friction, Rubbing, inertia
from ..particles.gravity import gravity_energy
from ..particles.laws import (
    Droplet,
    Ring,
    Sector,
    SoftContact,
    filled_area,
    volumes,
)
from . import bond_order, contacts, conversions, correlations, displacements
from .contacts import ContactTable
from .hessian import at_rest, hessian_of
from .recorded import MOVING, SAVED, write_state
from .voronoi import Cells, cells_of, space_cells_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from MDAnalysis import Universe

    from ..engine.moduli import ElasticModuli
    from ..particles.commands import Films
    from ..particles.packing import Packing
    from ..particles.walls import Wall
    from ..pictures.drawing import Scale
    from .derivatives import Derivatives
    from .displacements import LocalStrain
    from .hessian_matrix import Hessian
    from .modes import Modes
    from .secondary_contacts import SecondaryOutlines

Floats = NDArray[np.float64]

# The laws that have an attribute, and what the message calls them.
_LAWS: dict[str, tuple[tuple[type, ...], str]] = {
    "rings": ((Ring, Sector), "Ring and Sector"),
    "moving": (MOVING, "Ring, Sector and Droplet"),
    "saved": (SAVED, "Ring, Sector, Droplet and SoftContact"),
    "droplets": ((Droplet,), "Droplet"),
    "bubbles": ((Ring, Droplet), "Ring and Droplet"),
}

# What takes the place of what there is in the plane or in space only.
_WAYS_OUT = {
    "hexatic": "take steinhardt",
    "hexatic_correlation": "take steinhardt",
    "steinhardt": "take hexatic",
    "outlines": "take packing.positions and packing.radii",
}

# Results of single laws.
_RESULTS = {
    "perimeters": "particles of the plane that deform",
    "arc_radii": "Ring and Sector",
    **dict.fromkeys(("surface_areas", "contact_areas", "loads"), "Droplet"),
}


class _Only:
    """A method of some states only: no attribute of others."""

    def __init__(self, wrapped: Any, where: str) -> None:
        self._wrapped, self.where, self.__doc__ = wrapped, where, wrapped.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, state: State | None, owner: type | None = None) -> Any:
        if state is not None:
            state._check_has(self._name, self.where)
        return self._wrapped.__get__(state, owner)


def _only(where: str) -> Callable[[Any], Any]:
    """Leave a method to states in the `plane`, in `space`, or of some of `_LAWS`."""
    return lambda wrapped: _Only(wrapped, where)


def _unknown() -> Any:
    """Of a field that follows from the others."""
    return None


@dataclass(frozen=True, eq=False, repr=False)
class State:
    """A snapshot, the same on every rank. Particles are numbered from 0.

    In space areas below are volumes, and outlines surfaces.

    Attributes:
        packing: centers, species, undeformed radii, box and walls. The center of a polygon of beads
            is the mean of its beads; that of a smooth one its Steiner point, which is the center in
            the ring laws.
        law: of the particles.
        energy: of the deformation of all particles, and with gravity their potential energy, see
            `gravity_energy`: relaxations minimize it [energy].
        pressure_tensor: of the contacts, compression positive, shape (d, d)
            [energy/length^d]; motion adds N T / V to its diagonal. Of droplets its `pressure` is
            the osmotic one. With walls it is the derivative of the energy by a strain of particles
            and walls.
        residual: largest force on a particle over the mean contact force, 0 without contacts; of
            polygons that on a bead over the mean of kA max(A0 - A, 0) L0.
        converged: a relaxation has reached its tolerance; True if there was none.
        minimizer: of the relaxation that made the state, see `Simulation`: `lbfgs, fire` if FIRE
            went on where L-BFGS had failed; None if there was none.
        iterations: of the minimizer; None if there was none.
        results: what the law computes for each particle, by name, arrays of shape (N,); all but the
            first are attributes too:
            `area` of rings and polygons within their skin, see `volumes` [length^2];
            `perimeters` of these, within their skin too [length];
            `pressures`, inside each particle [energy/length^d];
            `n_contacts`, the number of contacts;
            `arc_radii` of rings, the smallest radius of curvature of the free outline [length];
            `surface_areas` of droplets, `contact_areas` of their facets [length^2], and `loads`,
            about the part of the surface that facets cover.
        velocities: of the centers, zero after a relaxation, shape (N, d) [length/time].
        time: of all motion and flows so far, 0 without [time].
        shear_strain: of all calls of `shear` so far; None before the first one.
        beyond: number of particles that the model does not describe: rings with a negative radius
            of curvature, droplets with a load above 0.4, or above 0.05 in the mean facet.
        wall_forces: force of the particles on each of `packing.walls`, shape (number of walls, d)
            [energy/length].
        films: contacts that stick, pairs of IDs that count from 1 as in LAMMPS, or an ID and a code
            below 0 of a wall, shape (M, 2), and as often as it sticks to images of one partner;
            None without adhesion.
        lost_energy: what particles have lost in motion, where they have attached and let go, and
            where contacts rub and damp: with it, and with `spring_energy`, their energy is
            conserved [energy].
        directions: in which particles propel themselves, unit vectors, shape (N, d); None in other
            states than those of motion with a propulsion.
        labels: number, from 0, that each particle keeps where others vanish or are born, shape
            (N,); None as long as none do.
        clones: label of the first ancestor of each particle, shape (N,); None if none divided.
        friction: of the contacts; None if they slip.
        gravity: acceleration of all particles, shape (d,), or of each species; None without
            [length/time^2].
        rubbing: `spins`, `springs` of contacts, and `lost`, the energies lost so far by sliding, in
            the dashpots along contacts, in those along normals, and by films; None without
            friction.
        unsaved: what acts on the contacts by commands to `lmp`, and is not saved: walls, excluded
            pairs; empty without.
        polygons: the undeformed `Polygons`; None of other laws.
        vertices: of each polygon, unwrapped around its center, arrays (N_v, 2) [length].
        images: how often each particle has left the box through each side, shape (N, d); None of
            soft particles and polygons.
    """

    packing: Packing
    law: Any
    energy: float
    pressure_tensor: Floats
    residual: float
    converged: bool
    minimizer: str | None = None
    iterations: int | None = None
    results: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    velocities: Floats = field(default_factory=_unknown)
    _root: bool = True  # whether this process writes files (rank 0 of the run)
    time: float = 0.0
    shear_strain: float | None = None
    beyond: int = 0
    wall_forces: Floats = field(default_factory=_unknown)
    films: Films | None = None
    lost_energy: float = 0.0
    directions: Floats | None = None
    labels: NDArray[np.int64] | None = None
    clones: NDArray[np.int64] | None = None
    friction: Friction | None = None
    gravity: Floats | None = None
    rubbing: Rubbing | None = None
    unsaved: str = ""
    # The contacts where the law has them, see `contacts`, or what makes them from rows of LAMMPS.
    _table: ContactTable | contacts.Later | None = None
    polygons: Any = None
    vertices: tuple[Floats, ...] = ()
    images: NDArray[np.int64] | None = None
    # Evaluates the same particles again, for what was not recorded.
    _evaluate: Callable[[], State] | None = None

    def __post_init__(self) -> None:
        packing = self.packing
        if self.velocities is None:
            object.__setattr__(self, "velocities", np.zeros_like(packing.positions))
        if self.wall_forces is None and self._evaluate and packing.walls:
            object.__delattr__(self, "wall_forces")  # evaluated when it is asked for
        elif self.wall_forces is None:
            none = np.zeros((len(packing.walls), packing.dimension))
            object.__setattr__(self, "wall_forces", none)
        arrays = (*vars(self).values(), *self.results.values(), *(self.rubbing or ()))
        for array in (*arrays, *self.vertices):
            if isinstance(array, np.ndarray):
                array.setflags(write=False)

    @classmethod
    def from_file(
        cls,
        path: str | Path,
        species: str | Path,
        *,
        law: str | None = None,
        types: Sequence[str] | Mapping[Any, str] | None = None,
        frame: int = -1,
        radii: str | None = None,
        walls: Wall | Sequence[Wall] = (),
        box: ArrayLike | None = None,
    ) -> State:
        """The state of particles whose centers are in a file: outlines, energy, stress, contacts.

            ld.State.from_file("shapes.dump", "mixture.deformable").export("shapes.vtp")

        Positions are those of the file; nothing moves. They must be periodic, or between `walls`,
        and, but for droplets, of one plane. Velocities are left out. Particles with an adhesion
        stick where their circles overlap. A file does not tell of the stiffnesses of single
        particles, *kA atom*: they are those of the species.

        Args:
            path: a LAMMPS dump, or what else `Packing.from_file` reads. Near the onset of jamming
                six digits are not enough, which are LAMMPS' default: write it with
                *dump_modify ID format float %20.15g*.
            species: the species file of pair_coeff, or the name of one that comes with the package.
            law: `balanced`, `curved`, `radical`, `sector` or, in three dimensions, `droplet`. If
                not given that of the run in whose folder the file is, or the species file; LAMMPS'
                own files do not tell, and have `balanced`, the default of the pair style.
            types: names of species, one for each atom type, as in pair_coeff; by default those of
                the file in their order. Where the file has names of types, such as the columns
                *element* or *typelabel*, a mapping from these, such as `{"A": "small"}`; not needed
                if they are the names of species.
            frame: number of the frame, from 0, or from the end if negative.
            radii: name of a column with the radius of each particle, as with `radius atom`; by
                default the radii are those of the species.
            walls: of the input, where they were at this frame: a box that is not periodic needs
                them.
            box: in the place of that of the file, as for `Packing.from_file`.

        Raises:
            FileError: a file cannot be read.
            ParameterError: an argument is out of range, or there are more atom types than species,
                or it is unknown which species names of types are.
            LammpsError: LAMMPS refuses the species, or the packing: contacts leave no room, say.

        Warns:
            LackingWarning: rounding of positions changes overlaps by more than 1 % of their mean;
                or particles are left out, by their IDs.
        """
        from ..runs.from_file import state_in_file

        return state_in_file(path, species, law, types, frame, radii, walls, box)

    def __repr__(self) -> str:
        return (
            f"<State: {len(self.packing)} particles, law {self.law!r}, phi = {self.phi:.4f}, "
            f"pressure = {self.pressure:.3g}, z = {self.coordination:.2f}>"
        )

    def __getattr__(self, name: str) -> Any:
        results = self.__dict__.get("results", {})
        if name in results and name != "area":
            return results[name]
        if name == "wall_forces" and self.__dict__.get("_evaluate"):
            return self._again.wall_forces
        # of methods and properties that this state does not have, for their own words
        own: Any = vars(type(self)).get(name)
        if isinstance(own, _Only):
            self._check_has(name, own.where)
        elif isinstance(own, property | cached_property):
            return (own.fget if isinstance(own, property) else own.func)(self)  # type: ignore[misc]
        if name not in _RESULTS:
            raise AttributeError(f"'State' object has no attribute {name!r}")
        if name == "perimeters":
            self._check_has(name, "plane")
        raise UndefinedError(
            f"{name} is a result of {_RESULTS[name]}, and the law of this state is {self.law!r}"
        )

    def _check_has(self, name: str, where: str) -> None:
        """Refuse an attribute that this state does not have.

        Raises:
            UndefinedError: it is of states in the other dimension, or of other laws.
        """
        dimension = self.packing.dimension
        way_out = _WAYS_OUT.get(name, "this state has none")
        if where == "plane" and dimension == 3:
            raise UndefinedError(
                f"{name} is for packings in the plane, and this one has three dimensions: {way_out}"
            )
        if where == "space" and dimension == 2:
            raise UndefinedError(
                f"{name} is for packings in three dimensions, and this one is in the plane: "
                f"{way_out}"
            )
        if where in _LAWS and not isinstance(self.law, _LAWS[where][0]):
            raise UndefinedError(
                f"{name} is for states of {_LAWS[where][1]}, and the law of this one is "
                f"{self.law!r}: take its packing"
            )

    # particles

    @property
    def positions(self) -> Floats:
        """Centers of the particles, those of `packing`, shape (N, d) [length]."""
        return self.packing.positions

    @property
    def radii(self) -> Floats:
        """Undeformed radii, those of `packing`, shape (N,) [length]."""
        return self.packing.radii

    @property
    def species(self) -> NDArray[np.int64]:
        """Species of the particles, those of `packing`, shape (N,)."""
        return self.packing.species

    @property
    def box(self) -> Floats:
        """Lattice vectors as rows, those of `packing`, shape (d, d) [length]."""
        return self.packing.box

    @property
    def walls(self) -> tuple[Wall, ...]:
        """Walls, those of `packing`."""
        return self.packing.walls

    @property
    def dimension(self) -> int:
        """2, or 3 in space."""
        return self.packing.dimension

    @property
    def volume(self) -> float:
        """What walls leave free of the box, in the plane its area, that of `packing` [length^d]."""
        return self.packing.volume

    def __len__(self) -> int:
        """Number of particles."""
        return len(self.packing)

    @cached_property
    def forces(self) -> Floats:
        """Force of its contacts on each particle, shape (N, d) [energy/length].

        The sum of their `force_vector`: fixes of a user and noise are left out.
        """
        table = self.contacts
        forces = np.zeros_like(self.packing.positions)
        np.add.at(forces, table["i"], table["force_vector"])
        forces.setflags(write=False)
        return forces

    # pressure, energy and motion

    @property
    def pressure(self) -> float:
        """Trace of `pressure_tensor` over the dimension d [energy/length^d]."""
        return float(np.trace(self.pressure_tensor) / len(self.pressure_tensor))

    @property
    def shear_stress(self) -> float:
        """Shear stress that resists a shear along x, -`pressure_tensor[0, 1]` [energy/length^d]."""
        return -float(self.pressure_tensor[0, 1])

    @property
    def kinetic_energy(self) -> float:
        """Sum of v^2/2, as masses are 1; with friction also of spins w [energy].

        Those are R^2 w^2/4 of each disk in the plane, R^2 w^2/5 of each ball in space.
        """
        turning = 0.0
        if self.rubbing is not None:
            spins = self.packing.radii * self.rubbing.spins.T
            turning = float(np.sum(spins**2) * inertia(self.packing.dimension) / 2.0)
        return float(np.sum(self.velocities**2) / 2.0) + turning

    @property
    def temperature(self) -> float:
        """Temperature of the motion, sum (v - mean v)^2 / (d N - d) in d dimensions [energy].

        Masses and k_B are 1. That of a single particle is v^2 / d.
        """
        number, dimension = self.velocities.shape
        common = self.velocities.mean(axis=0) if number > 1 else 0.0
        relative = self.velocities - common
        return float(np.sum(relative**2) / (dimension * max(number - 1, 1)))

    @property
    def spins(self) -> Floats | None:
        """Angular velocities of the particles, shape (N,), in space (N, 3) [1/time].

        None without friction.
        """
        return None if self.rubbing is None else self.rubbing.spins

    @property
    def lost_by_particle(self) -> Floats | None:
        """What particles have lost since the ledger began, shape (N, 4) [energy].

        By sliding, in the dashpots along contacts and in those along normals, and by films; half of
        what a contact loses belongs to each side, of one with a wall all. The sums are
        `rubbing.lost`. None without `Friction(ledger=True)`.
        """
        return None if self.rubbing is None else self.rubbing.by_particle

    @property
    def spring_energy(self) -> float:
        """Energy of the springs along contacts, sum of kt xi^2/2; 0 without friction [energy]."""
        return 0.0 if self.rubbing is None else self.rubbing.stored

    @property
    def gravity_energy(self) -> float:
        """The part -sum g.r of `energy`, of unwrapped positions r; 0 without gravity [energy]."""
        return gravity_energy(self.gravity, self.packing, self.images)

    # particles

    @property
    def phi(self) -> float:
        """Packing fraction: what deformed particles fill, skins included, of what walls leave free.

        Of polygons the radius of the vertices counts. Of soft particles overlaps count twice.
        """
        if isinstance(self.law, SoftContact | Droplet):
            return self.packing.phi
        return float(np.sum(self.volumes) / self.packing.volume)

    @property
    def pressures(self) -> Floats:
        """Pressure in each particle, (N,) [energy/length^d].

        Of soft ones the trace of `particle_stress` over the dimension; of droplets 2 tension/R
        without contacts.
        """
        if isinstance(self.law, SoftContact):
            trace: Floats = np.trace(self.particle_stress, axis1=1, axis2=2)
            return trace / self.packing.dimension
        return self.results["pressures"]

    @property
    def n_contacts(self) -> NDArray[np.int64]:
        """Number of active contacts of each particle, shape (N,)."""
        found = self.results.get("n_contacts")
        if found is None:
            found = np.bincount(self.contacts["i"], minlength=len(self.packing))
        return found

    @property
    def volumes(self) -> Floats:
        """Volume of each particle, in the plane its area, with its skin, shape (N,) [length^d].

        pi R^2 of soft disks, 4 pi R^3/3 of spheres and droplets. Beads of other polygons interlock
        with those of a polygon of beads: it is filled up to its `effective_radius`, see `Polygons`.
        """
        if self.packing.dimension == 3 or isinstance(self.law, SoftContact):
            return volumes(self.packing.radii, self.packing.dimension)
        return filled_area(self.results["area"], self.perimeters, self._skin)

    @property
    def _skin(self) -> Floats:
        """Thickness of the rigid skin of each particle, shape (N,) [length]."""
        if self.polygons is not None:
            return self.polygons.skin[self.packing.species]
        skin: Floats = self.law.species_parameters(self.packing.species_radii).skin
        return skin[self.packing.species]

    @property
    def area_deficit(self) -> Floats:
        """S = A0 - A of each particle of the plane that deforms, shape (N,) [length^2]."""
        area = self._area("area_deficit")
        if self.polygons is not None:
            return self.polygons.area[self.packing.species] - area
        return np.pi * (self.packing.radii - self._skin) ** 2 - area

    def _area(self, name: str) -> Floats:
        """Areas within skins, from which an attribute of this name follows."""
        self._check_has(name, "plane")
        if "area" not in self.results:
            raise UndefinedError(f"{name} is of particles that deform, not of {self.law!r}")
        return self.results["area"]

    @property
    def shape_parameter(self) -> Floats:
        """P^2 / (4 pi A) of each particle of the plane that deforms, 1 for a circle, (N,)."""
        area = self._area("shape_parameter")
        shape: Floats = self.perimeters**2 / (4.0 * np.pi * area)
        return shape

    @cached_property
    def outlines(self) -> list[Floats]:
        """Outline of each particle, closed polygons of its area, of shape (m, 2) [length].

        The first point is not repeated at the end. Points between contacts of rings lie outside of
        the exact outline by 1e-4 of the radius. Soft disks are circles; polygons have their
        vertices.
        """
        self._check_has("outlines", "plane")
        if self.vertices:
            return list(self.vertices)
        if isinstance(self.law, SoftContact):
            return self.packing.outlines
        lines = self._parallels(same_area=True)
        return [x + line for x, line in zip(self.packing.positions, lines, strict=True)]

    @_only("rings")
    def _parallels(
        self, inset: Floats | None = None, points: int = 180, same_area: bool = False
    ) -> list[Floats]:
        """Lines parallel to the outlines, about each particle's center, arrays (m, 2) [length].

        Args:
            inset: distance inward from each outline, shape (N,) [length]; 0 if not given.
            points: number of points on a whole turn.
            same_area: move points between contacts a little outward, see `core.outline`.

        Raises:
            ParameterError: a value is out of range, or there is an inset where particles stick.
        """
        from .outlines import parallels

        return parallels(self, inset, points, same_area)

    @_only("rings")
    def resolve_secondary(self, iterations: int = 3) -> SecondaryOutlines:
        """Press overlapping outlines flat against each other, as the sector law does with circles.

        Two arcs overlap if the distance of their centers is less than the sum q_i + q_j of their
        radii, and its direction is normal to both arcs. Their contact is on the radical axis of
        their circles. A contact of indentation a divides its arc into two sectors of a circle of
        radius q, with the indentations 0 at the arc's ends and a in between. So the perimeter is
        conserved, and the tangents at both ends do not change. Each iteration does so for all
        overlaps at once.

        Some overlaps remain, as a part of the residual: the only contact of a particle, because the
        law leaves it a circle; and a contact so close in direction to a deeper one, or to the end
        of its arc, that no arc of positive radius would remain. Primary contacts are not changed:
        the law separates these outlines already, except if a particle has no other contact.

        Args:
            iterations: largest number of iterations; nothing changes once nothing overlaps.

        Raises:
            ParameterError: another law than the sector law at constant perimeter, or a
                negative number of iterations.

        Source: R. Maharana, "Efficient Simulation of Deformable Particles"; docs/theory.md.
        """
        from .secondary_contacts import resolve_secondary

        return resolve_secondary(self, iterations)

    # contacts

    @cached_property
    def contacts(self) -> ContactTable:
        """Active contacts, with a row for each side, sorted by (i, j, image): structured array.

            strong = state.contacts[state.contacts["force"] > 2 * state.contacts["force"].mean()]

        Fields of all laws:

        * `i` and `j`: particles; j is -1 - k for wall k
        * `image`: periodic image of j, in lattice vectors, (d,)
        * `force`: normal to the contact [energy/length]
        * `force_vector`: force on i, tangential parts included, (d,) [energy/length]

        Of all but polygons:

        * `distance` of the centers, or of i from the wall, and `indentation` of i [length]
        * `position`: point of the contact line nearest to i, or middle of a facet, (d,) [length]

        Of rings and sectors:

        * `angle`: direction from i to the contact line, normal to it [rad]
        * `length`: of the contact on i [length]
        * `tilt`: of the line, `angle` less the direction from i to j [rad]
        * `half_angle`: of the line, an arc, positive where it is convex for i [rad]
        * `contact_angle`: at which the outline of i meets the film, 0 without [rad]
        * `attached`: whether it sticks, so that its force may be negative

        Of droplets, and the first one of soft particles too:

        * `normal`: of the facet, from i to j, (d,)
        * `facet_radius`: sqrt(force R / (2 pi tension)); where droplets stick, of the mean of both
          sides' areas [length]
        * `tilt`: of the film, whose normal is normal + tilt, (3,)
        * `curvature`: of the film, positive where it is convex for i [1/length]

        With friction, whose parts the forces have too:

        * `friction`: f_t, along the contact; a vector in space [energy/length]
        * `damping`: f_d, along the normal [energy/length]
        * `spring`: xi, as f_t [length]
        * `sliding`: whether friction has its largest value
        * `film_vector`: force of the film on i, (d,) [energy/length]
        """
        if isinstance(self._table, contacts.Later):
            return self._table.table
        if self._table is not None:
            return self._table
        if self._evaluate:
            return self._again.contacts
        return contacts.soft_table(self.packing, self.law.k)

    @cached_property
    def _again(self) -> State:
        """The state of the same particles, evaluated again."""
        assert self._evaluate is not None
        return self._evaluate()

    @cached_property
    def _contacts_of_each(self) -> list[ContactTable]:
        """The rows of `contacts` of each particle."""
        first = np.searchsorted(self.contacts["i"], np.arange(1, len(self.packing)))
        return np.split(self.contacts, first)

    @property
    def _rubs(self) -> bool:
        return self.friction is not None and self.friction._rubs

    @property
    def _of_rattlers(self) -> int:
        """Contacts of a rattler at most."""
        if self._rubs:
            return 1
        return self.packing.dimension - (self.gravity is not None)

    @cached_property
    def _network(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Particle and partner of each side of the contacts without rattlers."""
        ends = self._table.ends if isinstance(self._table, contacts.Later) else None
        i, j = ends or (self.contacts["i"], self.contacts["j"])
        kept = contacts.without_rattlers(i, j, len(self.packing), self._of_rattlers)
        return i[kept], j[kept]

    @cached_property
    def network_degree(self) -> NDArray[np.int64]:
        """Number of network contacts of each particle, 0 of rattlers, shape (N,)."""
        degree = np.bincount(self._network[0], minlength=len(self.packing))
        degree.setflags(write=False)
        return degree

    @property
    def rattlers(self) -> NDArray[np.bool_]:
        """Particles with fewer than three active contacts with non-rattlers, or walls, shape (N,).

        They are removed one after another. In three dimensions they have fewer than four. With
        gravity one less holds a particle, with friction two do.
        """
        return self.network_degree == 0

    @property
    def coordination(self) -> float:
        """Mean number z of network contacts of a particle that is no rattler; 0 without any."""
        rigid = int(np.sum(~self.rattlers))
        return len(self._network[0]) / rigid if rigid else 0.0

    @property
    def network_contacts(self) -> int:
        """Number of active contacts without those of rattlers, each counted once."""
        wall = self._network[1] < 0
        return int(np.sum(wall) + np.sum(~wall) // 2)

    @property
    def isostatic_contacts(self) -> int:
        """Smallest number of contacts that supports a pressure, d N' - d + 1 in a periodic box.

        That is 2 N' - 1 in the plane, 3 N' - 2 in three dimensions. The N' particles that are not
        rattlers have d N' - m degrees of freedom; one more contact makes a state of self stress
        possible. m is the number of motions of all together that no
        wall resists: d without walls, 1 in a channel or a round container, else 0. The result is 0
        if all are rattlers.

        With friction particles turn, and a contact has d forces, f and f_t: in the plane it is the
        half of 3 N' - 1 in a periodic box, and of 3 N' + 1 between walls, rounded up; in three
        dimensions a third of 6 N' - 2 and of 6 N' + 1. Contacts that use all of their friction have
        one force less, so that each adds 1/d.
        """
        rigid, packing = int(np.sum(~self.rattlers)), self.packing
        return contacts.isostatic(rigid, packing.walls, packing.dimension, self._rubs)

    def excess_coordination(self, threshold: float = 0.0) -> float:
        """z - z_iso: how many more contacts than an isostatic network a particle has.

            z - z_iso = 2 (network_contacts - isostatic_contacts) / N'

        for the N' particles that are no rattlers; 0 if all are. At the onset of jamming it is 0,
        up to a few contacts.

        Args:
            threshold: contacts count from this part of the mean contact force of the network on.
                Rattlers are then particles with too few contacts that count, and so on.

        Raises:
            ParameterError: the threshold is negative or no number.
        """
        return contacts.excess_coordination(
            self.packing, contacts.forces_of(self), self._of_rattlers, self._rubs, threshold
        )

    @cached_property
    def particle_stress(self) -> Floats:
        """Pressure tensor of each particle, compression positive, (N, d, d) [energy/length^d].

        It is the mean stress in a particle under the forces F of its contacts, which act where
        their lines cross the lines of centers, at x from its center:

            stress = -sum x F / filled_area        (symmetric part)

        The sum of stress times `volumes` over the particles is `stress` times `packing.volume`;
        in three dimensions these are volumes.
        Between walls that holds for the trace, the pressure. A wall also exerts a torque on a
        particle, which `stress` has in its other components, and this tensor does not.

        Source: mean stress by Love and Weber; Bagi, Mech. Mater. 22, 165 (1996).
        """
        return contacts.particle_stress(contacts.forces_of(self), self.volumes)

    @_only("bubbles")
    def gas_flow(self, permeability: float, *, border: float = 0.0) -> Floats:
        """dV/dt of each bubble by gas that flows, see `Simulation.coarsen`, (N,) [length^d/time].

        Args:
            permeability: of films [length^(d+1)/(energy time)].
            border: thickness of films [length].
        """
        from ..protocols.coarsening import gas_flow

        return gas_flow(self, permeability, border)

    def graph(self) -> Any:
        """The contacts as a graph of networkx, a `MultiGraph` with particles as nodes.

            networkx.number_connected_components(state.graph())

        Nodes are numbered as particles, and have `x`, `y`, `radius`, `species` and `rattler`. Each
        active contact is an edge, with the `force` along the line of centers, positive where it
        pushes [energy/length], the `distance` of the centers and the vector (`dx`, `dy`) from the
        lower to the higher number [length]; in three dimensions there are `z` and `dz` too, and
        with friction `friction` and `sliding`, see `State.contacts`. Two particles may touch
        through several images. The node -1 stands for all walls, and is there if a particle touches
        one.

        Raises:
            ImportError: networkx is missing (`pip install 'lammps-deformable[networkx]'`).
        """
        return contacts.graph(self.packing, contacts.forces_of(self), self.rattlers)

    # order

    def voronoi(self) -> Cells:
        """Voronoi cells of all particles, see `local_phi`.

        Returns:
            Tuple `size`, area or volume of each cell, shape (N,) [length^d], and of each side that
            is common with a neighbor: its particle `i`, the `direction` to the neighbor and the
            length or area `side`.
        """
        return self._cells

    @cached_property
    def _cells(self) -> Cells:
        cells = cells_of if self.packing.dimension == 2 else space_cells_of
        return cells(self.packing)

    @cached_property
    def local_phi(self) -> Floats:
        """Packing fraction in the Voronoi cell of each particle, shape (N,).

        The sides of cells are the radical axes of the undeformed circles, in three dimensions the
        radical planes of spheres, so that particles of all sizes are within their cells. Cells end
        at walls, and pass through a `Segment`. Weighted by the sizes of cells, `volumes /
        local_phi`, the mean is `phi`. It is infinite of a particle within a larger one, which
        leaves it no cell.
        """
        with np.errstate(divide="ignore"):
            return self.volumes / self._cells.size

    @property
    def cell_sides(self) -> NDArray[np.int64]:
        """Number of neighbors in the Voronoi cells, see `local_phi`, shape (N,).

        In the plane it is 6 on a triangular lattice, and 6 in the mean of all particles of a
        periodic box without walls. Particles with 5 and with 7 are disclinations, pairs of them
        dislocations. In three dimensions it is 12 in fcc, 14 in bcc, and about 14 in disorder.
        """
        return np.bincount(self._cells.i[self._cells.side > 0.0], minlength=len(self.packing))

    @_only("plane")
    def hexatic(self, k: int = 6) -> NDArray[np.complex128]:
        """Bond-orientational order of each particle, shape (N,).

            psi_k = sum l exp(i k theta) / sum l

        over its neighbors, in the directions theta, with l the lengths of the sides of its Voronoi
        cell, see `local_phi`. So it does not jump where neighbors change. |psi_6| is 1 on a
        triangular lattice. The sides at walls do not count; psi is nan without neighbors.

        Args:
            k: number of directions, 4 for square order.

        Raises:
            ParameterError: k is no whole number above 0.

        Source: Mickel et al., J. Chem. Phys. 138, 044501 (2013).
        """
        return bond_order.hexatic(self._cells, len(self.packing), k)

    @_only("plane")
    def hexatic_correlation(self, bins: int, r_max: float, *, k: int = 6) -> tuple[Floats, Floats]:
        """Correlation of the bond-orientational order over the distance, by freud.

            g_k(r) = mean of Re conj(psi_k(i)) psi_k(j)

        over all pairs of particles at the distance r, with psi_k of `hexatic`. On a triangular
        lattice g_6 is 1. It tends to |mean psi_6|^2 in a crystal, falls as a power of r in a
        hexatic phase, and exponentially in a fluid.

        Args:
            r_max: largest distance, below half of the box [length].
            bins: number of intervals of the distance.
            k: number of directions.

        Returns:
            Distances r, the middles of the intervals [length], and g, both of shape (bins,); g is
            nan where no pair has such a distance.

        Raises:
            ParameterError: a value is out of range.
            ImportError: freud is missing (`pip install 'lammps-deformable[freud]'`).

        Source: Nelson and Halperin, Phys. Rev. B 19, 2457 (1979).
        """
        r_max, bins = positive("r_max", r_max), count("bins", bins)
        return correlations.correlation(self.to_freud(), self.hexatic(k), r_max, bins)

    @_only("space")
    def steinhardt(self, l: int = 6) -> Floats:  # noqa: E741
        """Bond-orientational order of each particle, shape (N,).

            q_l^2 = 4 pi/(2 l + 1) sum_m |sum_b A_b Y_lm(n_b)|^2 / (sum_b A_b)^2
                  = sum_bc A_b A_c P_l(n_b n_c) / (sum_b A_b)^2

        over its neighbors in the directions n, with A the areas of the faces of its Voronoi cell,
        see `local_phi`. So it does not jump where neighbors change. q_6 is 0.575 in fcc, 0.567 in
        bcc, and 0.354 in sc; of random packings it has a mean below 0.4. It is nan without a cell.

        Args:
            l: degree of the spherical harmonics, 4 or 6 as a rule.

        Raises:
            ParameterError: l is no whole number above 0.

        Source: Steinhardt, Nelson and Ronchetti, Phys. Rev. B 28, 784 (1983); weights: Mickel et
        al., J. Chem. Phys. 138, 044501 (2013).
        """
        return bond_order.steinhardt(self._cells, len(self.packing), l)

    def radial_distribution(self, bins: int, r_max: float) -> tuple[Floats, Floats]:
        """The radial distribution function g(r) of the centers, by freud.

        Between walls the number of pairs is compared with that of centers at random places, no
        nearer to the walls than the nearest center is: g tends to 1 there too.

        Args:
            r_max: largest distance, below half of the box; between walls below their distance
                [length].
            bins: number of intervals of the distance.

        Returns:
            Distances r, the middles of the intervals [length], and g, both of shape (bins,).

        Raises:
            ParameterError: a value is out of range.
            ImportError: freud is missing (`pip install 'lammps-deformable[freud]'`).
        """
        r_max, bins = positive("r_max", r_max), count("bins", bins)
        return correlations.radial_distribution(self.packing, self.to_freud(), r_max, bins)

    def structure_factor(self, bins: int, k_max: float) -> tuple[Floats, Floats]:
        """The static structure factor S(k) of the centers.

        The mean of |sum exp(i k r)|^2 / N over the wave vectors k of the periodic box with a length
        in each interval, k = 0 left out. The time grows as N^2 k_max^d: in three dimensions 1000
        spheres take a second up to three peaks, k_max = 10/R.

        Args:
            k_max: largest wave number [1/length].
            bins: number of intervals of the wave number.

        Returns:
            Wave numbers k, the middles of the intervals [1/length], and S, both of shape (bins,);
            S is nan where the box has no wave vectors.

        Raises:
            ParameterError: a value is out of range, or walls close a direction.
        """
        return correlations.structure_factor(
            self.packing, positive("k_max", k_max), count("bins", bins)
        )

    def density_waves(self, k: ArrayLike) -> NDArray[np.complex128]:
        """Amplitudes of density waves of the centers, shape (M,).

            rho_k = 1/N sum exp(i k r)

        Its modulus is 1 at the reciprocal lattice of a perfect crystal, 1/sqrt(N) in disorder:
        positional order. N |rho_k|^2 is the structure factor at k.

        Args:
            k: wave vectors of the periodic box, shape (M, d) [1/length].

        Raises:
            ParameterError: wrong shape, or a wave that does not fit into the box, or walls close a
                direction.
        """
        return correlations.density_waves(self.packing, numbers("k", k))

    # motion since an earlier state

    def displacements(self, before: State | Packing) -> Floats:
        """Displacements of the particles since an earlier state, shape (N, d) [length].

        Particles may have crossed the boundaries of the box. Each is followed by the image that is
        nearest to where the strain of the box alone would have brought it: in a box of the lengths
        lx and ly it may move by up to lx/2 and ly/2 beside that. Of boxes whose tilts differ by
        their width, the one is meant that the `shear_strain` of both states leads to or, if that is
        None, the one with the tilt nearest to the earlier one.

        Args:
            before: state or packing of the same particles; where some have come or gone, a state
                of those then. They are followed by their labels, and a new one has nan.

        Raises:
            ParameterError: `before` has another number of particles, which have no labels, or walls
                that close other directions.

        Warns:
            AbsentWarning: not all particles are in both states.
        """
        return displacements.displacements(before, self)

    def nonaffine(self, before: State | Packing) -> Floats:
        """`displacements` without the strain of the box, shape (N, d) [length].

        Without them the centers would keep their places in units of the lattice vectors.
        """
        return displacements.nonaffine(before, self)

    def local_strain(self, before: State | Packing, r_max: float | None = None) -> LocalStrain:
        """Strain around each particle since an earlier state, and D^2_min.

            gradient, d2min, neighbors = state.local_strain(before)

        With vectors v to its neighbors before, and v' now, the displacement gradient G of a
        particle minimizes

            D^2 = sum |v' - v - G v|^2

        Args:
            before: state or packing of the same particles, see `displacements`.
            r_max: distance of neighbors in the earlier state; 3 times the mean radius if not given
                [length].

        Returns:
            Tuple `gradient`, `d2min`, `neighbors`; its `strain` is the symmetric part.

        Raises:
            ParameterError: a value is out of range, or see `displacements`.

        Source: Falk and Langer, Phys. Rev. E 57, 7192 (1998).
        """
        start = displacements.packing_of("before", before)
        r_max = displacements.usual_distance(start) if r_max is None else positive("r_max", r_max)
        return displacements.local_strain(before, self, r_max)

    # linear response

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy by the centers, and by strains, see `Hessian`.

        Args:
            rattlers: False leaves out the contacts of rattlers, which bear nothing; a contact that
                bears a thousandth of the mean contact force or more stays.

        Raises:
            ParameterError: the law is `Sector`, particles stick or rub, walls were given to `lmp`,
                or a line is held at the largest tilt; or the compliance of a droplet is singular,
                far beyond the model.
            UndefinedError: they are polygons.
        """
        expect("rattlers", rattlers, bool)
        return hessian_of(self, rattlers)

    def derivatives(self, by: str | Sequence[str]) -> Derivatives:
        """Derivatives of what is at rest by parameters, see `Derivatives`.

            state.derivatives(by="radii").jacobian("pressure")  # shape (N,)
            state.derivatives(by=["kA", "walls"]).vjp(energy=1.0)["walls"]

        The state changes with the parameters so that it stays at rest. Parameters are

            radii         undeformed, shape (N,) [length]
            kA, kP, skin  of each particle, of `Ring`, shape (N,); sum them over a species
            tension       of each particle, of `Ring` with finite kP, or `Droplet`, shape (N,)
            k             of `SoftContact`, shape ()
            adhesion      of `Droplet` between species, shape (species, species)
            wall_adhesion of `Droplet` with walls, shape (walls,)
            gravity       shape (d,), or (species, d) as it was given
            walls         places of `packing.walls`, shape (walls, d) [length]
            wall_angles   turns of walls about their origin, or the mean of their corners, shape
                          (walls,), in space about the axes x, y, z, (walls, 3) [rad]
            box           lattice vectors as rows, shape (d, d), 0 above the diagonal; centers keep
                          their places, not their fractions [length]

        Args:
            by: name of a parameter, or several.

        Warns:
            OpeningWarning: a contact bears less than 1e-5 of the mean force.

        Raises:
            ParameterError: there is no such parameter; or the state is not at rest (`residual`
                above 1e-3); or see `hessian`.
        """
        from ..engine.third_derivatives import moduli_quantities
        from .derivatives import derivatives_of

        return derivatives_of(self, by, partial(moduli_quantities, self))

    def modes(self, number: int | None = None, vectors: bool = True) -> Modes:
        """The normal modes of lowest stiffness, without those that have none.

        Few modes of many particles are found by Lanczos' method with a sparse factorization; in an
        unstable state they are those with a stiffness closest to zero. Otherwise the matrix is
        dense: all modes of 4000 particles take 1 GB and minutes, in three dimensions those of
        2700. Contacts of rattlers are left out, so that each rattler has a mode without stiffness
        in each direction.

        Args:
            number: of modes; all if not given.
            vectors: whether displacements are computed, which takes longer for all modes.

        Raises:
            ParameterError: there are fewer modes, or all modes do not fit into the memory; or the
                state is not at rest (`residual` above 1e-3); or see `hessian`.
        """
        from .modes import modes_of

        expect("vectors", vectors, bool)
        outlines = self.outlines if self.packing.dimension == 2 else ()
        return modes_of(at_rest(self), outlines, number, vectors)

    def moduli(self) -> ElasticModuli:
        """Elastic tensor, shear and bulk modulus, by one linear system.

        `validation/finite_strain.py` measures the same by finite strains.

        Raises:
            ParameterError: the state is not at rest (`residual` above 1e-3), has walls, or resists
                no strain; or see `hessian`.
        """
        from ..engine.moduli import moduli_of

        return moduli_of(at_rest(self))

    def complex_modulus(self, frequencies: ArrayLike, drag: float = 1.0) -> NDArray[np.complex128]:
        """Shear modulus under a small oscillating strain, G* = G' + i G'', by linear response.

            strain = Re gamma exp(i omega t),  shear stress = Re G*(omega) gamma exp(i omega t)

        Centers are overdamped, with a drag zeta against the mean flow, as in `oscillate` with a
        period of 2 pi/omega. With their displacements u from it, H and xi = d^2E/(du dgamma),

            zeta du/dt = - H u - xi gamma,
            G*(omega) = G_affine - xi^T (H + i omega zeta)^-1 xi / V

        with the area or volume V. At omega = 0 it is the `shear_modulus` of `moduli`, far
        above the rates of relaxation, eigenvalues of H over zeta, its affine part.
        `Run.complex_modulus` of `Simulation.oscillate` is the same by finite strains.

        Args:
            frequencies: angular ones, omega, not negative, any shape [1/time].
            drag: zeta, force over velocity [1/time], as masses are 1.

        Returns:
            G*(omega) of simple shear along x, complex, of the shape of `frequencies`
            [energy/length^d].

        Raises:
            ParameterError: a value is out of range; or see `moduli`.

        Source: Lemaitre and Maloney, J. Stat. Phys. 123, 415 (2006); Tighe, Phys. Rev. Lett. 107,
        158303 (2011).
        """
        from ..engine.moduli import complex_modulus_of

        return complex_modulus_of(at_rest(self), frequencies, drag)

    # pictures

    def _values(self, color_by: str | ArrayLike) -> Floats:
        """One number for each particle, shape (N,).

        Args:
            color_by: name of an attribute, or in a trajectory; or these numbers themselves, of
                which some may be nan.

        Raises:
            ParameterError: there is no such name, or they are no such numbers.
        """
        from ..pictures.plot import values_of

        return values_of(self, color_by)

    def plot(
        self,
        ax: Axes | None = None,
        *,
        color: str | ArrayLike = "pressures",
        contacts: bool = False,
        forces: bool = False,
        scale: Scale | None = None,
        cmap: str | None = None,
        vmin: float | None = None,
        vmax: float | None = None,
        title: str | None = None,
        colorbar: bool = True,
        label: str | None = None,
        spins: bool = False,
        view: tuple[float, float] | None = None,
        slice: float | None = None,
    ) -> Axes:
        """Draw the particles, colored by a value of each; returns the axes.

            state.plot(color="local_phi").figure.savefig("picture.png")
            state.plot(color=state.local_strain(before).d2min, label="$D^2_{min}$")
            state.plot(color="load", view=(30, 60))
            state.plot(slice=2.5, contacts=True)

        In the plane these are the outlines. In space they are spheres that the planes of their
        contacts cut, with their centers in the box, seen from far away; of droplets, which bulge,
        this is a little less than their volume. Colors go from the smallest to the largest value.
        If some values are negative, 0 is in the middle; whole numbers have a color each.

        Args:
            ax: axes to draw into; if not given those of a new figure, which is as long as the box.
                matplotlib.pyplot does not know that figure, so that a loop leaves none open: save
                it, or give `plt.gca()` for `plt.show()`.
            color: name of an attribute with one number for each particle, e.g. `area_deficit`,
                or of a column of the trajectory, e.g. `pressure`; or these numbers, shape (N,).
                A particle whose number is nan is gray.
            contacts: draw the contacts, the straight or curved parts that outlines share; of soft
                disks the chords of their overlaps; in space those of a slice, as facets are always
                drawn. Those that slide are green.
            forces: draw the force chains: lines between centers, with widths proportional to the
                forces; those of films that pull are magenta. Friction is a bar along the contact,
                green where it slides, whose length is that part of the radius that friction is of
                the force, at most all of it. In space they take the place of the particles, those
                behind paler.
            scale: of colors and forces, to use one for several pictures, see
                `lammps_deformable.pictures.drawing.scale`.
            cmap: name of one of matplotlib's color maps. If not given, `YlGnBu`, or `BrBG` if 0 is
                in the middle.
            vmin: value of the first color; that of `scale` if not given.
            vmax: value of the last color; that of `scale` if not given.
            title: of the picture; none if not given.
            colorbar: draw a bar of the colors. One bar of several pictures is
                `figure.colorbar(axes.collections[0], ax=all_axes)`.
            label: of the bar; that of the name if not given.
            spins: draw an arrow in each particle, the longer the faster it turns.
            view: in space, elevation of the viewer above the plane of x and y, and azimuth in it
                [degree]; (20, 30) if not given.
            slice: in space, draw what the plane at this z cuts, seen from above [length].

        Raises:
            ParameterError: `color` is no such attribute and no such numbers, there is no such
                color map, the `vmin` is not below `vmax`, or there are no spins; the view is no two
                numbers; in space, contacts are for slices only, and forces for views.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        optional("matplotlib", "plot")
        from ..pictures.drawing import Look

        look = Look(
            color=color,
            scale=scale,
            cmap=cmap,
            vmin=vmin,
            vmax=vmax,
            title=title,
            label=label,
            colorbar=colorbar,
        )
        for name, flag in {"contacts": contacts, "forces": forces, "spins": spins}.items():
            expect(name, flag, bool)
        if self.packing.dimension == 2:
            if view is not None or slice is not None:
                raise ParameterError("view and slice are for packings in three dimensions")
            from ..pictures.plot import plot

            return plot(self, ax, look, contacts, forces, spins)
        if spins:
            raise ParameterError("spins are for packings in the plane")
        from ..pictures.plot3d import plot as plot_in_space

        seen = (20.0, 30.0) if view is None else view
        return plot_in_space(self, ax, look, contacts, forces, seen, slice)

    def _repr_html_(self) -> str | None:
        """The picture and the line of `repr`, for notebooks; None without matplotlib."""
        from ..pictures.plot import in_notebook

        return in_notebook(self)

    # numbers, tables and files

    def to_freud(self, what: str = "points") -> Any:
        """Box and points as freud takes them, or the contacts as its list of neighbors.

            freud.order.Hexatic().compute(state.to_freud(), neighbors=state.to_freud("contacts"))

        The box has the dimension of the packing and its center at the origin, so that the points
        are moved.
        It is twice as long along directions that walls close, because freud finds no neighbors in
        boxes that are not periodic; walls themselves are left out. freud's densities count the
        empty part: `radial_distribution` does not. Import freud before
        `lammps_deformable` to call `freud.locality.Voronoi`, which crashes on the Voro++ of LAMMPS.

        Args:
            what: `points`, or `contacts`, those between particles, from both sides.

        Returns:
            The tuple (freud.box.Box, array of shape (N, 3)), or a freud.locality.NeighborList with
            the forces along the lines of centers as weights.

        Raises:
            ParameterError: `what` is another word.
            ImportError: freud is missing (`pip install 'lammps-deformable[freud]'`).
        """
        if what not in ("points", "contacts"):
            raise ParameterError(f"what must be points or contacts, not {shown(what)}")
        freud = optional("freud", "freud")
        if what == "points":
            return conversions.system(freud, self.packing)
        return conversions.neighbors(freud, len(self.packing), contacts.forces_of(self))

    def to_mdanalysis(self) -> Universe:
        """A Universe of MDAnalysis with one frame.

        Particles have `ids` and `types` (from 1, as in LAMMPS), `radii` and `masses`. The values of
        a trajectory (area, pressure, contacts, ...) are in `trajectory.ts.data`, by name.
        MDAnalysis has three dimensions: of a plane z is 0, and the box is as high as its longer
        side, so that searches for neighbors find none above. Positions are rounded to 32 bits
        there, and count from the lower left corner of the box, `Packing.origin`. Walls are left
        out.
        """
        return conversions.to_mdanalysis(self)

    def to_pandas(self, table: str = "particles") -> Any:
        """A DataFrame of pandas.

        Args:
            table: `particles`, a row for each, with position, species and all its values; or
                `contacts`, the rows of `contacts`. Particles are numbered from 0, and are the
                index of their table.

        Raises:
            ParameterError: there is no such table.
            ImportError: pandas is missing (`pip install 'lammps-deformable[pandas]'`).
        """
        return conversions.to_pandas(self, table)

    def export(self, path: str | Path, forces: bool = False, mode: str = "x") -> None:
        """Write the shapes of the particles, with their values, or the network of forces.

            state.export("outlines.vtp")
            state.export("network.vtp", forces=True)
            state.export("packing.fe")

        Particles have an `id` and a `type` from 1, as in LAMMPS. In the plane shapes are the
        outlines, a polygon each. In three dimensions they are the spheres of `plot` that facets
        cut: a facet is a polygon with the `force` of the contact and the `neighbor`, which are 0 of
        the triangles between facets; a neighbor of -1 is a wall. Shapes are whole: those of
        particles at the boundary reach beyond the box.

        Droplets go to Surface Evolver too, which finds their exact shapes. There `relax` minimizes
        the energy of all outlines, tension times perimeter, in space times surface, at constant
        areas or volumes in the box; `finer` does it again with edges half as long; and `results >>
        "packing.txt"` writes what `Evolved.from_file` reads. Films are those of the contacts of
        this state, in the order of its rows with i < j or with a wall: no new ones form. Those at
        walls stay on them.

        Args:
            path: `.vtp` for ParaView, OVITO and other programs that read VTK's files, with the
                values as cell data; in the plane also `.geojson` for programs of plane geometry,
                with the values as properties; `.fe` for Surface Evolver.
            forces: write lines between centers in the place of shapes: the contacts, with their
                `force` along the line, positive where it pushes, the `distance`, the ids `i` and
                `j`, of which -1 is a wall, and with friction `friction` and `sliding`.
            mode: `w` replaces a file that is there, `x` refuses to.

        Raises:
            ParameterError: the suffix is another. For Surface Evolver, the law is neither `Droplet`
                nor `Ring(kA=inf, kP=0, tension=...)`; a wall is not flat, or sticks; a particle
                touches its own image; or droplets are squeezed so much that films overlap at the
                start.
            FileError: there is a file, see `mode`, or it cannot be written.

        Source: K. A. Brakke, Experimental Mathematics 1, 141 (1992).
        """
        from ..pictures import vtk

        vtk.export(self, path, forces, mode)

    to_surface_evolver = renamed("to_surface_evolver", "export")

    @_only("saved")
    def save(
        self,
        folder: str | Path,
        parameters: Mapping[str, Any] | None = None,
        mode: str = "x",
    ) -> None:
        """Write the state for `ld.Run`, and for LAMMPS with the script `in.lammps`.

        Args:
            folder: made if missing.
            parameters: for the summary, e.g. seed and protocol: what JSON can hold.
            mode: `w` replaces a state or a run that is there, `x` refuses to.

        Raises:
            ParameterError: an argument is of another kind.
            FileError: the folder has a state or a run, see `mode`, or it holds
                something else, or a file cannot be written.

        Warns:
            UnsavedWarning: the files lack what `unsaved` names.
        """
        check_parameters(parameters)
        if not self._root:
            return
        ways = (f"replace it with save({str(folder)!r}, mode='w')",)
        place = refuse_run(folder, replaces(mode), ways)
        if frames_in(place):
            drop_frames(place)
        if self.unsaved:
            warn(
                f"'{folder}' has the particles and the law, but not the {self.unsaved} that were "
                "given to lmp",
                UnsavedWarning,
            )
        write_state(self, place, parameters)


def writes(state: State) -> bool:
    """Whether this process writes files of a state: rank 0 of its simulation."""
    return state._root


def soft_state(packing: Packing, law: SoftContact, residual: float, converged: bool) -> State:
    """The state of soft particles at these centers, without LAMMPS."""
    found = contacts.soft_forces(packing, law.k)
    moment = -np.einsum("ca,cb->ab", found.vector, found.force)
    energy = float(np.sum(found.force**2) / (2.0 * law.k))
    return State(
        packing, law, energy, moment / free_room(packing.walls, packing.box), residual, converged
    )
