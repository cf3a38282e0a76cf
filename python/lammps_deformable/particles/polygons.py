"""Deformable polygons, the references of the laws: settings, start, walls around a single one."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.box import cartesian, fractional
from ..common.checks import as_array, expect, numbers, positive, shown
from ..common.errors import ParameterError
from ..core import unit_vectors
from .laws import one_or_each, per_species
from .walls import Plane

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .packing import Packing


@dataclass(frozen=True, eq=False)
class Walls:
    """A convex polygon around the origin, for `Simulation` and `squeeze`.

    `planes` are the same sides for a `Packing`.

    Attributes:
        angle: directions from the origin to the sides, increasing, shape (n,), n >= 3 [rad].
        height: distance of each side from the origin, shape (n,) [length].
        stick: beads that touch a side keep their place along it; otherwise they slip.

    Raises:
        ParameterError: the sides do not close a polygon around the origin.
    """

    angle: NDArray[np.float64]
    height: NDArray[np.float64]
    stick: bool = False

    def __post_init__(self) -> None:
        expect("stick", self.stick, bool)
        angle, height = (numbers(f"{n} of walls", getattr(self, n)) for n in ("angle", "height"))
        if angle.ndim != 1 or len(angle) < 3 or not _turns_once(angle):
            raise ParameterError(
                "angles of walls must increase through one turn, by less than half a turn from one "
                f"to the next, not {angle.tolist()}"
            )
        if height.shape != angle.shape or not (height > 0.0).all():
            raise ParameterError(
                f"heights of walls must be {len(angle)} positive numbers, not {height.tolist()}"
            )
        for name, array in (("angle", angle), ("height", height)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward normals, shape (n, 2)."""
        return unit_vectors(self.angle)

    @property
    def planes(self) -> tuple[Plane, ...]:
        """The sides as walls of a `Packing`."""
        return tuple(
            Plane(tuple(height * normal), tuple(-normal))
            for height, normal in zip(self.height, self.normal, strict=True)
        )

    def distances_from(self, center: ArrayLike) -> NDArray[np.float64]:
        """Distance of each side from a point, negative beyond the side, shape (n,) [length]."""
        return self.height - np.sum(self.normal * np.asarray(center), axis=1)


def _turns_once(angle: NDArray[np.float64]) -> bool:
    """Whether directions increase through one turn, by less than half a turn each."""
    turns = np.diff(angle, append=angle[:1] + 2.0 * np.pi)
    return bool(((turns > 0.0) & (turns < np.pi)).all())


# Least spacing of beads over their radius p. LAMMPS lists at most 2000 neighbors of a bead, within
# a distance of 2.5 p, 2.6 p with edges. The part of a polygon in this circle is convex, thus no
# longer than 5.2 pi p, with 273 beads; and no more than 7 particles reach into it, because their
# radii are above 2 p.
_LEAST_SPACING = 0.06


@dataclass(frozen=True)
class DeformablePolygon:
    """The deformable-polygon model: bead polygons, joined by springs around a soft area.

        U = kL/2 sum (L - L0)^2 + kA/2 sum (A - A0)^2 + contacts

    summed over all springs and all polygons. kL and kA are numbers, or sequences of one number for
    each species. The contacts decide between two models.

    Bead polygons, as in the paper: kr/2 sum (2p - |v - v'|)^2 over overlapping beads of different
    polygons. At rest a particle of radius R is a regular polygon of circumradius R - p, so that its
    beads reach to R. Beads of two polygons interlock, and polygons have friction.

    Smooth polygons: kr/2 sum (2p - d)^2 over the distances d of vertices from edges of other
    polygons, with what counts twice at corners subtracted, see `core.edge_contact`. They have
    hardly any friction. At rest a particle of radius R is a regular polygon of perimeter P0 = N_v
    L0 = 2 pi (R - p), and R is the radius of the particle in the ring laws.

    Args:
        vertices: N_v, beads or vertices of a polygon of the smallest species; larger ones get more,
            N_v ~ R - p. Or a number for each species.
        smooth: smooth polygons, else bead polygons.
        radius: p, of a bead [length]; contacts reach as far as 2p.
        kL: stiffness of a spring [energy/length^2]; the perimeter of a polygon has kP = kL/N_v.
        kA: stiffness of the area of a polygon [energy/length^4].
        kr: stiffness of the contact of two beads, or of a vertex and an edge [energy/length^2].

    Raises:
        ParameterError: a value is not positive and finite, or a polygon has fewer than 3 beads.

    Source: Boromand et al., Phys. Rev. Lett. 121, 248003 (2018); R. Maharana, "Efficient
    Simulation of Deformable Particles", whose rest area lacks a factor cos(pi/N_v).
    docs/theory/numerics.md, "Smooth polygons".
    """

    vertices: int | Sequence[int] = 60
    _: KW_ONLY
    smooth: bool = True
    radius: float = 0.05
    kL: float | Sequence[float] = 300.0
    kA: float | Sequence[float] = 1.0
    kr: float = 30.0

    def __post_init__(self) -> None:
        expect("smooth", self.smooth, bool)
        for name in ("radius", "kr"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        for name in ("kL", "kA"):
            object.__setattr__(self, name, one_or_each(name, getattr(self, name)))
            values = np.asarray(getattr(self, name))
            if not ((values > 0.0) & np.isfinite(values)).all():
                raise ParameterError(f"{name} must be positive and finite, not {shown(values)}")
        counts = np.atleast_1d(as_array(self.vertices))
        whole = counts.ndim == 1 and counts.dtype.kind in "iuf" and np.isfinite(counts).all()
        whole = whole and counts.size > 0
        if not (whole and (counts == np.rint(counts)).all() and (counts >= 3).all()):
            raise ParameterError(
                f"vertices must be whole numbers, at least 3, not {shown(self.vertices)}"
            )

    def polygons(self, radii: NDArray[np.float64]) -> Polygons:
        """The undeformed polygons of species of these radii [length].

        Raises:
            ParameterError: beads are too large for a particle, so few that others slip between
                them, or so many that LAMMPS cannot list their neighbors; or numbers or stiffnesses
                are for fewer species.
        """
        radii = numbers("radii", radii)
        if radii.ndim != 1 or radii.size == 0:
            raise ParameterError(f"radii must have shape (number of species,), not {radii.shape}")
        polygon = radii - self.radius
        if not (polygon > self.radius).all():
            raise ParameterError(
                f"beads of radius {self.radius:g} are too large for a particle of radius "
                f"{radii.min():g}: take less than half of that"
            )
        one = np.ndim(self.vertices) == 0
        vertices = np.asarray(self.vertices, np.float64)
        vertices = vertices if one else vertices[: len(radii)]
        if not one and len(vertices) < len(radii):
            raise ParameterError(
                f"vertices must be one number, or one for each of {len(radii)} species, not "
                f"{self.vertices}"
            )
        share = polygon / polygon.min() if one else np.ones_like(polygon)
        number = np.rint(vertices * share)
        half = np.pi / number  # of the angle of an edge
        cosine, sine = unit_vectors(half).T
        spacing = 2.0 * polygon * (half if self.smooth else sine)
        widest, closest = int(spacing.argmax()), int(spacing.argmin())
        if spacing[widest] >= 4.0 * self.radius and not self.smooth:  # edges have no gaps
            enough = np.floor(_beads_at(4.0 * self.radius, polygon)) + 1.0
            # `vertices` are those of the smallest species: number * share must round to enough
            least = (np.floor((enough - 0.5) / share) + 1.0).max() if one else enough[widest]
            raise ParameterError(
                f"{number[widest]:g} beads of radius {self.radius:g} are too few for a particle of "
                f"radius {radii[widest]:g}, others slip between them: take "
                f"{'vertices = ' if one else ''}{least:g} or more"
            )
        if spacing[closest] < _LEAST_SPACING * self.radius:
            room = np.floor(_beads_at(_LEAST_SPACING * self.radius, polygon))
            most = (np.ceil((room + 0.5) / share) - 1.0).min() if one else room[closest]
            raise ParameterError(
                f"{number[closest]:g} beads of radius {self.radius:g} are too many for a particle "
                f"of radius {radii[closest]:g}, LAMMPS cannot list so many neighbors: take "
                f"{'vertices = ' if one else ''}{most:g} or fewer"
            )
        of_beads = polygon + 0.5 * np.sqrt(
            np.maximum(4.0 * self.radius**2 - 0.25 * spacing**2, 0.0)
        )
        effective_radius = radii.astype(np.float64) if self.smooth else of_beads
        return Polygons(
            number=number.astype(np.int64),
            radius=0.5 * spacing / sine,
            spacing=spacing,
            area=0.25 * number * spacing**2 * cosine / sine,
            effective_radius=effective_radius,
            skin=effective_radius - polygon,
            kL=np.array(per_species(self.kL, len(radii))),
            kA=np.array(per_species(self.kA, len(radii))),
        )


def _beads_at(spacing: float, polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    """Number of beads with this spacing on circles of these radii, pi/arcsin(spacing/2r)."""
    return np.asarray(np.pi / np.arcsin(np.minimum(0.5 * spacing / polygon, 1.0)))


@dataclass(frozen=True, eq=False)
class Polygons:
    """Undeformed polygons, one for each species; arrays of shape (number of species,).

    Attributes:
        number: of beads, N_v.
        radius: of the circle through the beads [length], R - p of bead polygons, and
            L0/(2 sin(pi/N_v)) of smooth ones.
        spacing: rest length of the springs, L0 [length].
        area: rest area, A0 = N_v L0^2/4 cot(pi/N_v) [length^2].
        effective_radius: of the smooth particle that equals a polygon for other polygons [length].
            It is R of a smooth polygon, and R - p + sqrt(4p^2 - L0^2/4)/2 of a bead polygon, as
            facing rows of beads interlock. For a smooth wall the radius is R.
        skin: thickness of the rigid shell around that particle's polygon, `effective_radius` minus
            R - p [length].
        kL: stiffness of the springs [energy/length^2].
        kA: stiffness of the area [energy/length^4].
    """

    number: NDArray[np.int64]
    radius: NDArray[np.float64]
    spacing: NDArray[np.float64]
    area: NDArray[np.float64]
    effective_radius: NDArray[np.float64]
    skin: NDArray[np.float64]
    kL: NDArray[np.float64]
    kA: NDArray[np.float64]

    @property
    def kP(self) -> NDArray[np.float64]:
        """Stiffness of the perimeter against a uniform stretch, kL/N_v [energy/length^2]."""
        return self.kL / self.number

    def fastest_frequency(self, kr: float) -> float:
        """An upper bound of the frequencies of beads of mass 1 with contacts of stiffness kr.

            omega^2 = 4 kL + 4 kr + kA N_v L0^2

        The terms are of a row of springs, of a row of contacts, and of the area, whose derivative
        with respect to the position of a bead is at most L0.
        """
        area = self.kA * self.number * self.spacing**2
        return float(np.sqrt((4.0 * (self.kL + kr) + area).max()))


def undeformed(packing: Packing, polygons: Polygons) -> list[NDArray[np.float64]]:
    """Beads of undeformed polygons around the centers of a packing, arrays (N_v, 2)."""
    positions = []
    for center, kind in zip(packing.positions, packing.species, strict=True):
        angle = 2.0 * np.pi * np.arange(polygons.number[kind]) / polygons.number[kind]
        positions.append(center + polygons.radius[kind] * unit_vectors(angle))
    return positions


def _translations(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """The shortest lattice vectors, one of each pair v, -v, shape (4, 2) [length]."""
    (lx, _), (xy, ly) = box.tolist()
    upright = np.array([[lx, 0.0], [xy - lx * np.rint(xy / lx), ly]])  # a cell of the same lattice
    return cartesian(np.array([(1, 0), (-1, 1), (0, 1), (1, 1)]), upright)


def refuse_packing(packing: Packing) -> None:
    """Refuse a packing that no polygons can have."""
    if packing.walls:
        raise ParameterError("polygons have no walls: replace the packing by one without walls")
    if packing.own_radii:
        raise ParameterError(
            "polygons have the radii of their species: give each size a species of its own, as "
            "packing.replace(species=np.unique(packing.radii, return_inverse=True)[1])"
        )


def refuse_start(
    packing: Packing,
    positions: list[NDArray[np.float64]],
    model: DeformablePolygon,
    walls: Walls | None,
) -> None:
    """Refuse polygons that cannot start where they are."""
    if walls is None:
        refuse_overlap(packing, model)
        refuse_own_image(positions, packing.box, model.radius)
    else:
        _refuse_outside(packing, model, walls)


def refuse_overlap(packing: Packing, model: DeformablePolygon) -> None:
    """Refuse polygons that overlap by more than a bead radius: they could stay entangled."""
    steps = _translations(packing.box)
    cell = steps[[0, 2]]
    steps = np.vstack([np.zeros(2), steps, -steps])
    for n, (center, radius) in enumerate(zip(packing.positions, packing.radii, strict=True)):
        apart = packing.positions[n + 1 :] - center
        apart -= cartesian(np.rint(fractional(apart, cell)), cell)
        distance = np.hypot(*np.moveaxis(apart[:, None] + steps, -1, 0)).min(axis=1)
        overlap = packing.radii[n + 1 :] + radius - distance
        if overlap.max(initial=0.0) > model.radius:
            raise ParameterError(
                f"particles {n} and {n + 1 + int(overlap.argmax())} overlap by "
                f"{overlap.max():.3g}, but polygons may overlap by at most the bead radius "
                f"{model.radius:g} at the start: take a packing at jamming"
            )


def refuse_own_image(
    polygons: list[NDArray[np.float64]], box: NDArray[np.float64], radius: float
) -> None:
    """Refuse a polygon that reaches its own periodic image: beads of one polygon do not repel."""
    for step in _translations(box):
        length = np.hypot(*step)
        for n, polygon in enumerate(polygons):
            if np.ptp(polygon @ step) / length + 2.0 * radius > length:
                raise ParameterError(
                    f"particle {n} reaches its own image, {length:.4g} away, but beads of one "
                    "polygon do not repel each other: repeat the packing in that direction"
                )


def _refuse_outside(packing: Packing, model: DeformablePolygon, walls: Walls) -> None:
    """Refuse a polygon that starts beyond its walls, or beyond the box around them."""
    if len(packing) != 1 or packing.positions.any():
        raise ParameterError("walls must be around a single particle at the origin")
    radius = packing.radii[0]
    if packing.box[1, 0] != 0.0 or not (packing.box.diagonal() > 2.0 * radius).all():
        raise ParameterError(
            f"walls need a rectangular box wider than the particle, {2.0 * radius:g}, not "
            f"{packing.box.tolist()}"
        )
    if walls.height.min() <= radius - model.radius:
        raise ParameterError(
            f"a wall at {walls.height.min():g} cuts through the particle of radius {radius:g}: "
            "start with walls around it, and move them in with confine"
        )
