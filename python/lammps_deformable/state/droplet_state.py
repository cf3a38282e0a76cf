"""A state of droplets in three dimensions: a snapshot, which later steps do not change."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..io.vtk_files import Shapes
from ..model.droplet import Droplet
from ..model.facets import Facets, surfaces_of
from ..model.packing import Packing
from .contact_forces import ContactForces
from .contact_network import ContactNetwork
from .droplet_contacts import DropletTable, forces_of_droplets
from .droplet_response import DropletResponse
from .exports import Exports
from .in_space import InSpace
from .numbers import numbers_of
from .saved import Saved
from .space_analysis import SpaceAnalysis
from .space_pictures import SpacePictures
from .state import State
from .stressed import Stressed


@dataclass(frozen=True, eq=False, repr=False)
class DropletState(
    InSpace,
    Saved,
    DropletResponse,
    Stressed,
    ContactNetwork,
    SpaceAnalysis,
    SpacePictures,
    Exports,
):
    """A snapshot of droplets, the same on every rank. Particles are numbered from 0.

    Attributes:
        packing: centers, species, undeformed radii, box and walls.
        law: the law, `Droplet`.
        surface_area: of each droplet, 4 pi R^2 without contacts, shape (N,) [length^2].
        contacts: number of contacts of each droplet that bear a force, shape (N,).
        contact_area: of all facets of each droplet, shape (N,) [length^2].
        particle_pressure: inside each droplet, 2 tension/R without contacts, shape (N,)
            [energy/length^3].
        load: of each droplet, about the part of its surface that facets cover, shape (N,).
        energy: of all droplets, above that of spheres [energy].
        stress: pressure tensor of the contacts, compression positive, shape (3, 3)
            [energy/length^3]; its `pressure` is the osmotic pressure of the emulsion. With walls it
            is the derivative of the energy by a strain of droplets and walls.
        residual: largest force on a droplet over the mean contact force; 0 without contacts.
        stalled: the relaxation stopped before the tolerance.
        beyond: number of droplets beyond the model, whose load is above 0.4, or above 0.05 in the
            mean facet.
        velocities: of the centers, zero after a relaxation, shape (N, 3) [length/time].
        contact_table: contacts that bear a force, with a row for each side, sorted by (i, j,
            image): structured array with the fields i, j (-1 for a wall), image (3,), distance,
            indentation, facet_radius, force, position (3,), normal (3,), force_vector (3,), see
            `droplet_contacts.COLUMNS`.
        root: whether this process writes files (rank 0 of the run).
        time: of all calls of `move`, and of flows, so far, 0 without motion [time].
        strain: shear strain of all calls of `shear` so far; None before the first one.
        unsaved: what acts on the contacts by commands to `lmp`, and is not saved: walls, excluded
            pairs; empty without.
        wall_forces: force of the droplets on each of `packing.walls`, shape (number of walls, 3)
            [energy/length].
    """

    packing: Packing
    law: Droplet
    surface_area: NDArray[np.float64]
    contacts: NDArray[np.int64]
    contact_area: NDArray[np.float64]
    particle_pressure: NDArray[np.float64]
    load: NDArray[np.float64]
    energy: float
    stress: NDArray[np.float64]
    residual: float
    stalled: bool
    beyond: int
    velocities: NDArray[np.float64]
    contact_table: DropletTable
    root: bool
    time: float = 0.0
    strain: float | None = None
    unsaved: str = ""
    wall_forces: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))

    def __post_init__(self) -> None:
        for array in (value for value in vars(self).values() if isinstance(value, np.ndarray)):
            array.setflags(write=False)

    @property
    def phi(self) -> float:
        """Packing fraction, that of the undeformed droplets, whose volume is kept."""
        return self.packing.phi

    @property
    def filled_volume(self) -> NDArray[np.float64]:
        """4 pi R^3/3 of each droplet, shape (N,) [length^3]."""
        return 4.0 / 3.0 * np.pi * self.packing.radius**3

    def numbers(self) -> dict[str, Any]:
        """The state in numbers, by name; `strain` is None without shear."""
        return numbers_of(self) | {
            "temperature": self.temperature,
            "time": self.time,
            "load": float(self.load.mean()),
            "beyond": self.beyond,
        }

    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the droplets by name, arrays of shape (N,)."""
        return {
            "radius": self.packing.radius,
            "surface_area": self.surface_area,
            "pressure": self.particle_pressure,
            "load": self.load,
            "contact_area": self.contact_area,
            "contacts": self.contacts,
            "rattler": self.rattlers.astype(int),
            **dict(zip(("vx", "vy", "vz"), self.velocities.T, strict=True)),
        }

    @property
    def squeezed(self) -> tuple[str, NDArray[np.float64]]:
        """What limits time steps: the load of each droplet."""
        return "load", self.load

    def _facets(self) -> Facets:
        table = self.contact_table
        height = self.packing.radius[table["i"]] - table["indentation"]
        return Facets(table["i"], table["normal"], height)

    def _bodies(self) -> tuple[Shapes, NDArray[np.int64], dict[str, NDArray[Any]]]:
        found = surfaces_of(self.packing.positions, self.packing.radius, self._facets())
        shapes = Shapes(found.points, found.corners, found.ends, normals=found.normals)
        j, force = self.contact_table["j"], self.contact_table["force"]
        # of what is no facet, -1, both are 0
        partners = np.where(j < 0, -1, j + 1)
        values = {"neighbor": np.append(partners, 0), "force": np.append(force, 0.0)}
        return shapes, found.body, {name: each[found.facet] for name, each in values.items()}

    @property
    def _contact_sides(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        return self.contact_table["i"], self.contact_table["j"]

    @property
    def _contact_forces(self) -> ContactForces:
        return forces_of_droplets(self.packing, self.contact_table)


# Of a simulation of deformable particles.
DeformedState = State | DropletState
