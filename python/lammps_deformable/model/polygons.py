"""Settings of polygons, the deformable-polygon models that the contact laws approximate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.validate import positive, shown
from ..core import unit_vectors
from .laws import one_or_each, per_species

# Least spacing of beads over their radius p. LAMMPS lists at most 2000 neighbors of a bead, within
# a distance of 2.5 p, 2.6 p with edges. The part of a polygon in this circle is convex, thus no
# longer than 5.2 pi p, with 273 beads; and no more than 7 particles reach into it, because their
# radii are above 2 p.
_LEAST_SPACING = 0.06


@dataclass(frozen=True)
class PolygonModel:
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
        radius: p, of a bead [length]; contacts reach as far as 2p.
        kL: stiffness of a spring [energy/length^2]; the perimeter of a polygon has kP = kL/N_v.
        kA: stiffness of the area of a polygon [energy/length^4].
        kr: stiffness of the contact of two beads, or of a vertex and an edge [energy/length^2].
        smooth: smooth polygons, else bead polygons.

    Raises:
        ParameterError: a value is not positive and finite, or a polygon has fewer than 3 beads.

    Source: Boromand et al., Phys. Rev. Lett. 121, 248003 (2018); R. Maharana, "Efficient
    Simulation of Deformable Particles", whose rest area lacks a factor cos(pi/N_v).
    docs/theory.md, "Smooth polygons".
    """

    vertices: int | Sequence[int] = 50
    radius: float = 0.05
    kL: float | Sequence[float] = 300.0
    kA: float | Sequence[float] = 1.0
    kr: float = 30.0
    smooth: bool = False

    def __post_init__(self) -> None:
        for name in ("radius", "kr"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        for name in ("kL", "kA"):
            object.__setattr__(self, name, one_or_each(name, getattr(self, name)))
            values = np.asarray(getattr(self, name))
            if not ((values > 0.0) & np.isfinite(values)).all():
                raise ParameterError(f"{name} must be positive and finite, not {shown(values)}")
        try:
            counts = np.atleast_1d(np.asarray(self.vertices))
        except ValueError:  # rows of unequal length
            counts = np.empty(0)
        whole = counts.ndim == 1 and counts.dtype.kind in "iuf" and np.isfinite(counts).all()
        whole = whole and counts.size > 0
        if not (whole and (counts == np.rint(counts)).all() and (counts >= 3).all()):
            raise ParameterError(
                f"a polygon needs a whole number of beads, at least 3, not {self.vertices}"
            )

    def polygons(self, radii: NDArray[np.float64]) -> Polygons:
        """The undeformed polygons of species of these radii [length].

        Raises:
            ParameterError: beads are too large for a particle, so few that others slip between
                them, or so many that LAMMPS cannot list their neighbors; or numbers or stiffnesses
                are for another number of species.
        """
        polygon = radii - self.radius
        if not (polygon > self.radius).all():
            raise ParameterError(
                f"beads of radius {self.radius:g} are too large for a particle of radius "
                f"{radii.min():g}: take less than half of that"
            )
        one = np.ndim(self.vertices) == 0
        if not one and len(np.asarray(self.vertices)) != len(radii):
            raise ParameterError(
                f"vertices must be one number, or one for each of {len(radii)} species, not "
                f"{self.vertices}"
            )
        share = polygon / polygon.min() if one else np.ones_like(polygon)
        number = np.rint(np.asarray(self.vertices, dtype=np.float64) * share)
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
