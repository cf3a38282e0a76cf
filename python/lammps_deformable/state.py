"""Pressure and shear stress of a packing, from its stress.

A state in numbers: a row of a table.

States of particles that move in time, and the folders that keep them.

What states of soft disks and of soft spheres have in common.

A state of soft disks: a snapshot, which later steps do not change.

A state of a simulation: a snapshot, which later steps do not change.

States in three dimensions: what they lack says so, and names the way out.

A state of droplets in three dimensions: a snapshot, which later steps do not change.

A state of soft spheres: a snapshot, which later steps do not change.

A state of bead polygons: a snapshot, which later steps do not change.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from ._files import check_parameters
from .analysis import Analysis, PlaneAnalysis, SpaceAnalysis
from .contacts import (
    ContactForces,
    ContactNetwork,
    ContactTable,
    DropletTable,
    chords,
    forces_of_droplets,
    forces_of_table,
    halves,
)
from .core import angles
from .errors import UnsavedWarning
from .friction import Friction, Rubbing, spin_column
from .laws import AnyLaw, Droplet, Law, accurate_step, filled_area
from .plot import Parallels, Pictures
from .plot3d import Facets, SpacePictures, surfaces_of
from .response import DropletResponse, RingResponse, SoftResponse
from .shapes import Exports, Shapes, polygons_of
from .store import TEMPERATURE, Motion, as_columns, drop_frames, frames_in, refuse_run, save

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from .commands import Films
    from .drawing import Halves, Mark
    from .packing import Packing
    from .polygons import DeformablePolygon, Polygons


class Stressed:
    """A state with a `stress`."""

    stress: NDArray[np.float64]

    @property
    def pressure(self) -> float:
        """Pressure of the packing, trace of `stress` over the dimension d [energy/length^d]."""
        return float(np.trace(self.stress) / len(self.stress))

    @property
    def shear_stress(self) -> float:
        """Shear stress that resists a shear along x, -`stress[0, 1]` [energy/length^d]."""
        return -float(self.stress[0, 1])


class _Snapshot(Protocol):
    """What a state has."""

    @property
    def packing(self) -> Packing: ...
    @property
    def strain(self) -> float | None: ...
    @property
    def phi(self) -> float: ...
    @property
    def pressure(self) -> float: ...
    @property
    def shear_stress(self) -> float: ...
    @property
    def energy(self) -> float: ...
    @property
    def coordination(self) -> float: ...
    @property
    def rattlers(self) -> NDArray[np.bool_]: ...
    @property
    def residual(self) -> float: ...
    @property
    def stalled(self) -> bool: ...


def numbers_of(state: _Snapshot) -> dict[str, Any]:
    """The numbers, by name, of particles and of soft disks; `strain` is None without shear."""
    box, axes = state.packing.box, "xyz"[: state.packing.dimension]
    sides = {f"l{axis}": float(box[k, k]) for k, axis in enumerate(axes)}
    tilts = {
        a + b: float(box[k, n]) for n, a in enumerate(axes) for k, b in enumerate(axes) if n < k
    }
    return {
        "particles": len(state.packing),
        **sides,
        **tilts,
        "strain": state.strain,
        "phi": state.phi,
        "pressure": state.pressure,
        "shear_stress": state.shear_stress,
        "energy": state.energy,
        "coordination": state.coordination,
        "rattlers": int(np.sum(state.rattlers)),
        "residual": state.residual,
        "stalled": state.stalled,
    }


class Saved(ABC):
    """A state of a simulation in the plane or of droplets, which has a motion and can be saved."""

    packing: Packing
    law: Any
    velocities: NDArray[np.float64]
    root: bool
    time: float = 0.0
    strain: float | None = None
    friction: Friction | None = None
    unsaved: str = ""

    def __getattr__(self, name: str) -> Any:
        """A field of a state that was read from a file, which has to be evaluated."""
        evaluate = vars(self).get("_missing")
        if evaluate is None or name not in type(self).__dataclass_fields__:  # type: ignore[attr-defined]
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        del vars(self)["_missing"]
        vars(self).update(vars(evaluate()) | vars(self))
        return vars(self)[name]

    @abstractmethod
    def numbers(self) -> dict[str, Any]:
        """The state in numbers, by name."""

    @property
    @abstractmethod
    def squeezed(self) -> tuple[str, NDArray[np.float64]]:
        """What limits time steps, see `longest_step`: its name, and values of the particles."""

    @property
    def kinetic_energy(self) -> float:
        """Sum of v^2/2, as masses are 1; with friction also of R^2 w^2/4 for spins w [energy]."""
        return float(np.sum(self.velocities**2) / 2.0)

    @property
    def temperature(self) -> float:
        """Temperature of the motion, sum (v - mean v)^2 / (d N - d) in d dimensions [energy].

        Masses and k_B are 1.
        """
        relative = self.velocities - self.velocities.mean(axis=0)
        number, dimension = relative.shape
        return float(np.sum(relative**2) / (dimension * max(number - 1, 1)))

    @property
    def motion(self) -> Motion:
        """What goes on with a simulation from this state, beside the packing."""
        return Motion(self.velocities, self.time, self.strain, images=self.images)

    def step_limits(self) -> tuple[Packing, AnyLaw, float, float]:
        """The arguments of `longest_step` and `accurate_step`."""
        return self.packing, self.law, float(self.squeezed[1].max()), self.temperature

    def save(
        self,
        folder: str | Path,
        parameters: Mapping[str, Any] | None = None,
        overwrite: bool = False,
    ) -> None:
        """Write the state for `ld.Run`, and for LAMMPS with the script `in.lammps`.

        Args:
            folder: made if missing.
            parameters: for the summary, e.g. seed and protocol: what JSON can hold.
            overwrite: replace a state or a run that is there.

        Raises:
            ParameterError: an argument is of another kind.
            FileError: the folder has a state or a run and `overwrite` is not given, or it holds
                something else, or a file cannot be written.

        Warns:
            UnsavedWarning: the files lack what `unsaved` names.
        """
        check_parameters(parameters)
        if not self.root:
            return
        place = refuse_run(folder, overwrite)
        if frames_in(place):
            drop_frames(place)
        if self.unsaved:
            warnings.warn(
                f"'{folder}' has the particles and the law, but not the {self.unsaved} that were "
                "given to lmp",
                UnsavedWarning,
                stacklevel=2,
            )
        self._write(place, parameters)

    def _write(
        self, folder: Path, parameters: Mapping[str, Any] | None, frames: int | None = None
    ) -> None:
        """Write the state behind so many recorded frames up to it, if any."""
        packing, law, squeeze, now = self.step_limits()
        longest = self.friction.accurate_step if self.friction else np.inf
        steps = (
            min(accurate_step(packing, law, squeeze, now), longest),
            min(accurate_step(packing, law, squeeze, max(now, TEMPERATURE)), longest),
        )
        numbers = self.numbers()
        save(folder, packing, law, steps, numbers, self.motion, parameters, frames, self.friction)


@dataclass(frozen=True, eq=False, repr=False)
class SoftState(SoftResponse, Stressed, ContactNetwork, Analysis):
    """Soft particles that overlap, of contact stiffness k; attributes are those of `DiskState`."""

    packing: Packing
    law: None
    energy: float
    stress: NDArray[np.float64]
    pairs: NDArray[np.int64]
    residual: float
    stalled: bool
    wall_pairs: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    strain: float | None = None

    @property
    def phi(self) -> float:
        """Packing fraction, sum pi R^2 / `packing.volume`; overlaps count twice."""
        return self.packing.phi

    @property
    def particle_pressure(self) -> NDArray[np.float64]:
        """Pressure of each particle, trace of `particle_stress` over the dimension, (N,)."""
        return np.trace(self.particle_stress, axis1=1, axis2=2) / self.packing.dimension

    def numbers(self) -> dict[str, Any]:
        """The state in numbers, by name; `strain` is None without shear."""
        return numbers_of(self)

    @property
    def _contact_sides(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        i, j = self.pairs.T
        walled = self.wall_pairs[:, 0]
        return np.concatenate([i, j, walled]), np.concatenate([j, i, np.full_like(walled, -1)])


@dataclass(frozen=True, eq=False, repr=False)
class DiskState(SoftState, PlaneAnalysis, Pictures):
    """A snapshot of soft disks of contact stiffness k. Particles are numbered from 0.

    Attributes:
        packing: centers, species, radii and box.
        law: None, which stands for soft disks.
        energy: of all particles [k length^2].
        stress: pressure tensor of the packing, compression positive, shape (2, 2) [k].
        pairs: numbers of particles that overlap, each pair once, shape (M, 2).
        residual: largest force on a particle over the mean contact force; 0 without contacts.
        stalled: the relaxation stopped before the tolerance.
        wall_pairs: numbers of particles that overlap with walls, and of these walls in
            `packing.walls`, shape (K, 2).
        strain: shear strain of all calls of `shear`; None before the first one.
    """

    _NAMES: ClassVar[tuple[str, ...]] = ("filled_area", "particle_pressure", "rattlers")

    @property
    def filled_area(self) -> NDArray[np.float64]:
        """pi R^2 of each particle, shape (N,) [length^2]."""
        return np.pi * self.packing.radii**2

    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the disks by the names of a trajectory, arrays of shape (N,)."""
        i, _ = self._contact_sides
        return {
            "radius": self.packing.radii,
            "area": self.filled_area,
            "pressure": self.particle_pressure,
            "contacts": np.bincount(i, minlength=len(self.packing)),
            "rattler": self.rattlers.astype(int),
        }

    @property
    def outlines(self) -> list[NDArray[np.float64]]:
        """Circles, closed polygons of shape (m, 2) [length]."""
        return self.packing.outlines

    def _flats(self) -> list[list[NDArray[np.float64]]]:
        return chords(self.packing, self._contact_forces)

    def _halves(self) -> list[Halves]:
        return halves(self.packing, self._contact_forces)


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
            [energy/length^2]; motion adds N T / `packing.volume` to its diagonal. With walls it is
            the derivative of the energy by a strain of particles and walls.
        residual: largest force on a particle over the mean contact force; 0 without contacts.
        stalled: the relaxation stopped before the tolerance.
        beyond: number of particles that the model does not describe (negative radius of curvature).
        velocities: of the centers, zero after a relaxation, shape (N, 2) [length/time].
        contact_table: active contacts, with a row for each side, sorted by (i, j, image):
            structured array with the fields i, j (-1 for a wall), image (2,), angle, distance,
            indentation, length, force, position (2,), tilt, half_angle, force_vector (2,),
            contact_angle, attached, see `contacts.COLUMNS`. With friction also friction,
            damping, spring, sliding, see `friction.RUBBING`, and the forces have these parts.
        root: whether this process writes files (rank 0 of the run).
        time: of all calls of `move`, and of flows, so far, 0 without motion [time].
        strain: shear strain of all calls of `shear` so far; None before the first one.
        wall_forces: force of the particles on each of `packing.walls`, shape (number of walls, 2)
            [energy/length].
        films: contacts that stick, with IDs from 1 as in LAMMPS, see `commands.Films`, shape
            (M, 2); None without adhesion.
        lost_energy: what particles have lost in all calls of `move` of the simulation, where they
            have attached and let go, and where contacts rub and damp: with it, and with
            `spring_energy`, their energy is conserved [energy].
        directions: in which particles propel themselves, unit vectors, shape (N, 2); None in other
            states than those of `move` with a propulsion.
        friction: of the contacts; None if they slip.
        rubbing: spins, springs of contacts and what was lost, see `friction.Rubbing`; None without
            friction.
        unsaved: what acts on the contacts by commands to `lmp`, and is not saved: walls, excluded
            pairs; empty without.
        images: how often each particle has left the box through each side, shape (N, 2).
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
    images: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))

    def __post_init__(self) -> None:
        for array in (*vars(self).values(), *(self.rubbing or ())):
            if isinstance(array, np.ndarray):
                array.setflags(write=False)

    @property
    def phi(self) -> float:
        """Packing fraction: deformed areas, skins included, over the area that walls leave free."""
        return float(np.sum(self.filled_area) / self.packing.volume)

    @property
    def filled_area(self) -> NDArray[np.float64]:
        """Area of each particle with its skin, shape (N,) [length^2]."""
        return filled_area(self.area, self.perimeter, self._skin)

    @property
    def area_deficit(self) -> NDArray[np.float64]:
        """S = A0 - A of each particle, shape (N,) [length^2]."""
        return np.pi * (self.packing.radii - self._skin) ** 2 - self.area

    @property
    def shape_parameter(self) -> NDArray[np.float64]:
        """P^2 / (4 pi A) of each particle, 1 for a circle, shape (N,)."""
        return self.perimeter**2 / (4.0 * np.pi * self.area)

    @property
    def kinetic_energy(self) -> float:
        """Sum of v^2/2, as masses are 1; with friction also of R^2 w^2/4 for spins w [energy]."""
        spins = 0.0 if self.rubbing is None else self.packing.radii * self.rubbing.spins
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
        return self.law.species_parameters(self.packing._species_radii).skin[self.packing.species]

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
        lost = self.lost_energy - sum(self.rubbing.lost if self.rubbing else ())
        return Motion(*history, self.rubbing, self.images, lost)

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
        from .plot import flats_of

        return flats_of(self.outlines, self.packing.radii, self.contact_tables)

    def _halves(self) -> list[Halves]:
        return [(table["position"], table["force"]) for table in self.contact_tables]

    def _marks(self, contacts: bool, forces: bool, spins: bool) -> list[Mark]:
        if self.rubbing is None:
            return super()._marks(contacts, forces, spins)
        from .friction import friction_bars, sliding_contacts, spin_arrows

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
            "radius": self.packing.radii,
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


# What takes the place of what there is in the plane only.
_WAYS_OUT = {
    "hexatic": "take steinhardt",
    "hexatic_correlation": "take steinhardt",
    "filled_area": "take filled_volume",
    "area": "take filled_volume",
    "outlines": "take packing.positions and packing.radii",
}


class InSpace:
    """A state in three dimensions. What it has is listed in its class: nothing else is there.

    So nothing of a state in the plane can take x and y of the centers and leave out z.
    """

    def __getattr__(self, name: str) -> Any:
        if "_missing" in vars(self) and name in DropletState.__dataclass_fields__:
            return Saved.__getattr__(self, name)  # type: ignore[arg-type]
        kind = type(self).__name__
        known = any(
            hasattr(each, name) or name in each.__dataclass_fields__ for each in (State, DiskState)
        )
        if name.startswith("_") or not known:
            raise AttributeError(f"{kind!r} object has no attribute {name!r}")
        if hasattr(Exports, name):
            raise AttributeError(
                f"{name} is for states of a Simulation, and a {kind} has none: take its packing"
            )
        way_out = _WAYS_OUT.get(name, f"a {kind} has none")
        raise AttributeError(
            f"{name} is for packings in the plane, and this one has three dimensions: {way_out}"
        )


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
            `contacts.DROPLET_COLUMNS`.
        root: whether this process writes files (rank 0 of the run).
        time: of all calls of `move`, and of flows, so far, 0 without motion [time].
        strain: shear strain of all calls of `shear` so far; None before the first one.
        unsaved: what acts on the contacts by commands to `lmp`, and is not saved: walls, excluded
            pairs; empty without.
        wall_forces: force of the droplets on each of `packing.walls`, shape (number of walls, 3)
            [energy/length].
        images: how often each droplet has left the box through each side, shape (N, 3).
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
    images: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 3), np.int64))

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
        return 4.0 / 3.0 * np.pi * self.packing.radii**3

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
            "radius": self.packing.radii,
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
        height = self.packing.radii[table["i"]] - table["indentation"]
        return Facets(table["i"], table["normal"], height)

    def _bodies(self) -> tuple[Shapes, NDArray[np.int64], dict[str, NDArray[Any]]]:
        found = surfaces_of(self.packing.positions, self.packing.radii, self._facets())
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
        return 4.0 / 3.0 * np.pi * self.packing.radii**3

    def particle_values(self) -> dict[str, NDArray[Any]]:
        """Values of the spheres by name, arrays of shape (N,)."""
        i, _ = self._contact_sides
        return {
            "radius": self.packing.radii,
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


@dataclass(frozen=True, eq=False, repr=False)
class PolygonContacts:
    """Pairs of polygons in contact, each pair once.

    Attributes:
        i: number of a polygon, shape (M,).
        j: number of the other polygon, larger than i, shape (M,).
        image: periodic image of j in the contact, in lattice vectors, shape (M, 2).
        force: on i, shape (M, 2) [energy/length].
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    image: NDArray[np.int64]
    force: NDArray[np.float64]


def sum_contacts(
    beads: NDArray[np.float64],
    first: NDArray[np.int64],
    pairs: NDArray[np.int64],
    overlaps: NDArray[np.float64],
    box: NDArray[np.float64],
) -> PolygonContacts:
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
    image = np.rint((beads[a] - overlaps[:, :2] - beads[b]) @ np.linalg.inv(box)).astype(np.int64)
    i, j = (np.searchsorted(first, bead, side="right") - 1 for bead in (a, b))
    sign = np.where(i > j, -1, 1)[:, None]  # each pair of polygons once, from its lower number
    sides = np.column_stack([np.minimum(i, j), np.maximum(i, j), sign * image])
    contacts, which = np.unique(sides, axis=0, return_inverse=True)
    force = np.zeros((len(contacts), 2))
    np.add.at(force, which.ravel(), sign * overlaps[:, 2:])
    return PolygonContacts(i=contacts[:, 0], j=contacts[:, 1], image=contacts[:, 2:], force=force)


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


@dataclass(frozen=True, eq=False, repr=False)
class PolygonState(Stressed):
    """A snapshot, the same on every rank. Polygons are numbered from 0.

    Attributes:
        packing: centers, species, radii and box. The center of a bead polygon is the mean of its
            beads; that of a smooth one its Steiner point, which is the center in the ring laws.
        model: the settings.
        polygons: the undeformed polygons.
        outlines: beads of each polygon, unwrapped around its center, arrays (N_v, 2) [length].
        area: of the polygons through their vertices, shape (N,) [length^2].
        perimeter: of the polygons, shape (N,) [length].
        contact_table: pairs of polygons in contact, with their forces.
        energy: of all polygons [energy].
        stress: pressure tensor, compression positive, shape (2, 2) [energy/length^2].
        residual: largest force on a bead over the force on a bead in a contact, which is the mean
            of kA max(A0 - A, 0) L0 over the polygons; 0 if forces are only rounding.
        stalled: the relaxation stopped before the tolerance.
    """

    packing: Packing
    model: DeformablePolygon
    polygons: Polygons
    outlines: list[NDArray[np.float64]]
    area: NDArray[np.float64]
    perimeter: NDArray[np.float64]
    contact_table: PolygonContacts
    energy: float
    stress: NDArray[np.float64]
    residual: float
    stalled: bool

    def __repr__(self) -> str:
        return (
            f"<PolygonState: {len(self.packing)} polygons, phi = {self.phi:.4f}, "
            f"pressure = {self.pressure:.3g}, z = {self.coordination:.2f}>"
        )

    @property
    def phi(self) -> float:
        """Packing fraction, sum of `filled_area` over the area of the box, as that of a law."""
        return float(np.sum(self.filled_area) / np.prod(self.packing.box.diagonal()))

    @property
    def filled_area(self) -> NDArray[np.float64]:
        """Area of each polygon with the radius p of its vertices around it, shape (N,) [length^2].

        Beads of other polygons interlock with those of a bead polygon: it is filled up to its
        `effective_radius`, see `Polygons`.
        """
        skin = self.polygons.skin[self.packing.species]
        return filled_area(self.area, self.perimeter, skin)

    @property
    def area_deficit(self) -> NDArray[np.float64]:
        """S = A0 - A of each polygon, shape (N,) [length^2]."""
        return self.polygons.area[self.packing.species] - self.area

    @property
    def coordination(self) -> float:
        """Mean number of contacts of a polygon, rattlers included."""
        return 2.0 * len(self.contact_table.i) / len(self.packing)
