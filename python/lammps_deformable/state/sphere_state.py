"""A state of soft spheres: a snapshot, which later steps do not change."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.facets import Facets
from .in_space import InSpace
from .soft_state import SoftState
from .space_analysis import SpaceAnalysis
from .space_pictures import SpacePictures


@dataclass(frozen=True, eq=False, repr=False)
class SphereState(InSpace, SoftState, SpaceAnalysis, SpacePictures):
    """A snapshot of soft spheres of contact stiffness k. Particles are numbered from 0.

    Attributes:
        packing: centers, species, radii, box and walls.
        law: None, which stands for soft spheres.
        energy: of all particles [k length^2].
        stress: pressure tensor of the packing, compression positive, shape (3, 3) [k/length].
        pairs: numbers of particles that overlap, each pair once, shape (M, 2).
        residual: largest force on a particle over the mean contact force; 0 without contacts.
        stalled: the relaxation stopped before the tolerance.
        wall_pairs: numbers of particles that overlap with walls, and of these walls in
            `packing.walls`, shape (K, 2).
        strain: shear strain of all calls of `shear`; None before the first one.
    """

    @property
    def filled_volume(self) -> NDArray[np.float64]:
        """4 pi R^3/3 of each particle, shape (N,) [length^3]."""
        return 4.0 / 3.0 * np.pi * self.packing.radius**3

    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the spheres by name, arrays of shape (N,)."""
        i, _ = self._contact_sides
        return {
            "radius": self.packing.radius,
            "volume": self.filled_volume,
            "pressure": self.particle_pressure,
            "contacts": np.bincount(i, minlength=len(self.packing)),
            "rattler": self.rattlers.astype(int),
        }

    def _facets(self) -> Facets:
        contacts = self._contact_forces
        distance, part = contacts.distance, contacts.part
        normal, pair = contacts.vector / distance[:, None], contacts.j >= 0
        return Facets(
            np.append(contacts.i, contacts.j[pair]),
            np.concatenate([normal, -normal[pair]]),
            np.append(part * distance, ((1.0 - part) * distance)[pair]),
        )
