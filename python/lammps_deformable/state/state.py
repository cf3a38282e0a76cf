"""A state of a simulation: a snapshot, which later steps do not change."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..io.data_file import Motion
from ..io.directions import as_columns
from ..io.films import Films
from ..io.outlines import polygons_of
from ..io.rubbing import Rubbing, spin_column
from ..io.vtk_files import Shapes
from ..model.filled import filled_area
from ..model.friction import Friction
from ..model.laws import Law
from ..model.marks import Mark
from ..model.packing import Packing
from .contact_forces import ContactForces, forces_of_table
from .contact_network import ContactNetwork
from .contact_table import ContactTable
from .exports import Exports
from .numbers import numbers_of
from .parallels import Parallels
from .pictures import Pictures
from .plane_analysis import PlaneAnalysis
from .ring_response import RingResponse
from .saved import Saved
from .stressed import Stressed

if TYPE_CHECKING:
    from ..model.picture import Halves


@dataclass(frozen=True, eq=False, repr=False)
class State(
    Saved, Stressed, ContactNetwork, RingResponse, Parallels, PlaneAnalysis, Pictures, Exports
):
    """A snapshot, the same on every rank. Particles are numbered from 0.

    Attributes:
        packing: centers, species, undeformed radii, box and walls.
        law: the contact law.
        area: of each particle, within its skin if it has one, shape (N,) [length^2].
        perimeter: of each particle, likewise, shape (N,) [length].
        contacts: number of active contacts of each particle, shape (N,).
        particle_pressure: inside each particle, shape (N,) [energy/length^2].
        arc_radius: smallest radius of curvature of the free outline, shape (N,) [length].
        energy: of the deformation of all particles [energy].
        stress: pressure tensor of the contacts, compression positive, shape (2, 2)
            [energy/length^2]; motion adds N T / `packing.area` to its diagonal. With walls it is
            the derivative of the energy by a strain of particles and walls.
        residual: largest force on a particle over the mean contact force; 0 without contacts.
        stalled: the relaxation stopped before the tolerance.
        beyond: number of particles that the model does not describe (negative radius of curvature).
        velocities: of the centers, zero after a relaxation, shape (N, 2) [length/time].
        contact_table: active contacts, with a row for each side, sorted by (i, j, image):
            structured array with the fields i, j (-1 for a wall), image (2,), angle, distance,
            indentation, length, force, position (2,), tilt, half_angle, force_vector (2,),
            contact_angle, attached, see `contact_table.COLUMNS`. With friction also friction,
            damping, spring, sliding, see `rubbing.RUBBING`, and the forces have these parts.
        root: whether this process writes files (rank 0 of the run).
        time: of all calls of `move`, and of flows, so far, 0 without motion [time].
        strain: shear strain of all calls of `shear` so far; None before the first one.
        wall_forces: force of the particles on each of `packing.walls`, shape (number of walls, 2)
            [energy/length].
        films: contacts that stick, with IDs from 1 as in LAMMPS, see `io.films`, shape (M, 2); None
            without adhesion.
        lost_energy: what particles have lost in all calls of `move` of the simulation, where they
            have attached and let go, and where contacts rub and damp: with it, and with
            `spring_energy`, their energy is conserved [energy].
        directions: in which particles propel themselves, unit vectors, shape (N, 2); None in other
            states than those of `move` with a propulsion.
        friction: of the contacts; None if they slip.
        rubbing: spins, springs of contacts and what was lost, see `io.rubbing`; None without
            friction.
        unsaved: what acts on the contacts by commands to `lmp`, and is not saved: walls, excluded
            pairs; empty without.
    """

    _NAMES: ClassVar[tuple[str, ...]] = (
        *("area_deficit", "particle_pressure", "rattlers", "shape_parameter"),
    )

    packing: Packing
    law: Law
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    contacts: NDArray[np.int64]
    particle_pressure: NDArray[np.float64]
    arc_radius: NDArray[np.float64]
    energy: float
    stress: NDArray[np.float64]
    residual: float
    stalled: bool
    beyond: int
    velocities: NDArray[np.float64]
    contact_table: ContactTable
    root: bool
    time: float = 0.0
    strain: float | None = None
    wall_forces: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    films: Films | None = None
    lost_energy: float = 0.0
    directions: NDArray[np.float64] | None = None
    friction: Friction | None = None
    rubbing: Rubbing | None = None
    unsaved: str = ""

    def __post_init__(self) -> None:
        for array in (*vars(self).values(), *(self.rubbing or ())):
            if isinstance(array, np.ndarray):
                array.setflags(write=False)

    @property
    def phi(self) -> float:
        """Packing fraction: deformed areas, skins included, over the area that walls leave free."""
        return float(np.sum(self.filled_area) / self.packing.area)

    @property
    def filled_area(self) -> NDArray[np.float64]:
        """Area of each particle with its skin, shape (N,) [length^2]."""
        return filled_area(self.area, self.perimeter, self._skin)

    @property
    def area_deficit(self) -> NDArray[np.float64]:
        """S = A0 - A of each particle, shape (N,) [length^2]."""
        return np.pi * (self.packing.radius - self._skin) ** 2 - self.area

    @property
    def shape_parameter(self) -> NDArray[np.float64]:
        """P^2 / (4 pi A) of each particle, 1 for a circle, shape (N,)."""
        return self.perimeter**2 / (4.0 * np.pi * self.area)

    @property
    def kinetic_energy(self) -> float:
        """Sum of v^2/2, as masses are 1; with friction also of R^2 w^2/4 for spins w [energy]."""
        spins = 0.0 if self.rubbing is None else self.packing.radius * self.rubbing.spins
        return super().kinetic_energy + float(np.sum(spins**2) / 4.0)

    @property
    def spins(self) -> NDArray[np.float64] | None:
        """Angular velocities of the particles, shape (N,) [1/time]; None without friction."""
        return None if self.rubbing is None else self.rubbing.spins

    @property
    def spring_energy(self) -> float:
        """Energy of the springs along contacts, sum of kt xi^2/2; 0 without friction [energy]."""
        return 0.0 if self.rubbing is None else self.rubbing.stored

    @property
    def _skin(self) -> NDArray[np.float64]:
        """Thickness of the rigid skin of each particle, shape (N,) [length]."""
        return self.law.species_parameters(self.packing.radii).skin[self.packing.species]

    @property
    def _rubs(self) -> bool:
        return self.friction is not None and self.friction.rubs

    @property
    def _contact_sides(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        return self.contact_table["i"], self.contact_table["j"]

    @property
    def _contact_forces(self) -> ContactForces:
        return forces_of_table(self.packing, self.contact_table)

    @property
    def motion(self) -> Motion:
        """What goes on with a simulation from this state, beside the packing."""
        history = self.velocities, self.time, self.strain, self.films, self.directions
        return Motion(*history, self.rubbing)

    @cached_property
    def outlines(self) -> list[NDArray[np.float64]]:
        """Outline of each particle, closed polygons of its area, of shape (m, 2) [length].

        Points between contacts lie outside of the exact outline by 1e-4 of the radius.
        """
        outlines = self.parallels(same_area=True)
        return [x + line for x, line in zip(self.packing.positions, outlines, strict=True)]

    def _bodies(self) -> tuple[Shapes, NDArray[np.int64], dict[str, NDArray[Any]]]:
        return polygons_of(self.outlines), np.arange(len(self.packing)), {}

    def _values(self) -> dict[str, NDArray[Any]]:
        shape = {"area_deficit": self.area_deficit, "shape_parameter": self.shape_parameter}
        return self.particle_values() | shape

    def _flats(self) -> list[list[NDArray[np.float64]]]:
        from .flats import flats_of

        return flats_of(self.outlines, self.packing.radius, self.contact_tables)

    def _halves(self) -> list[Halves]:
        return [(table["position"], table["force"]) for table in self.contact_tables]

    def _marks(self, contacts: bool, forces: bool, spins: bool) -> list[Mark]:
        if self.rubbing is None:
            return super()._marks(contacts, forces, spins)
        from .rubbing_marks import friction_bars, sliding_contacts, spin_arrows

        packing, tables = self.packing, self.contact_tables
        marks = [sliding_contacts(self.outlines, packing, tables)] if contacts else []
        marks += friction_bars(packing, tables) if forces else []
        return marks + (spin_arrows(packing, self.rubbing.spins) if spins else [])

    def numbers(self) -> dict[str, Any]:
        """The state in numbers, by name.

        `strain` is None without shear.
        """
        return numbers_of(self) | {
            "temperature": self.temperature,
            "time": self.time,
            "shape_parameter": float(np.mean(self.shape_parameter)),
            "beyond": self.beyond,
        }

    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the particles by their names in a trajectory, arrays of shape (N,)."""
        return {
            "radius": self.packing.radius,
            "area": self.area,
            "perimeter": self.perimeter,
            "pressure": self.particle_pressure,
            "contacts": self.contacts,
            "arc_radius": self.arc_radius,
            "rattler": self.rattlers.astype(int),
            "vx": self.velocities[:, 0],
            "vy": self.velocities[:, 1],
            **as_columns(self.directions),
            **spin_column(self.rubbing),
        }

    @property
    def squeezed(self) -> tuple[str, NDArray[np.float64]]:
        """What limits time steps: the pressure in each particle."""
        return "pressure", self.particle_pressure
