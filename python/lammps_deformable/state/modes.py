"""Normal modes of a packing: frequencies, displacements, and how many particles take part."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..common.checks import count, shown, whole
from ..common.errors import ParameterError
from ..common.versions import optional
from ..particles.containers import in_box

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.axes import Axes

    from ..particles.packing import Packing
    from .hessian_matrix import Hessian


Floats = NDArray[np.float64]

# Stiffness at which modes are sought, in mean diagonal entries of the Hessian: below those of all
# modes of a stable packing, and close to the softest of them.
_SHIFT = 1e-8

# All modes of packings up to so many coordinates are computed, and if more than this part of them
# is asked for.
_SMALL, _MANY = 300, 0.2

# Dense matrices at a time, with their eigenvectors and work space.
_MATRICES = 4

# Frequencies that differ by less than this part of them are the same up to rounding. A mode is
# softer than another one by more than rounding of its stiffness, 1e-16 mean diagonal entries.
_SAME, _SOFTER = 1e-9, 1e-6

# Length of the longest arrow, in mean radii.
_ARROW = 2.0

# Label of the colors in a picture.
_LABEL = "displacement over the largest one"


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """Normal modes, by increasing stiffness, without those that have none.

    Attributes:
        packing: the particles; their masses are 1.
        stiffness: eigenvalues of the Hessian, shape (k,) [energy/length^2].
        vectors: displacements of each mode, orthonormal, shape (k, N, d); None if not asked for.
        zero_modes: number of motions without stiffness, which are left out: of all particles
            together (d translations in a periodic box), and d of each free particle.
        free: particles without contacts, shape (N,).
        outlines: of the particles, for pictures; none in three dimensions.
    """

    packing: Packing
    stiffness: Floats
    vectors: Floats | None
    zero_modes: int
    free: NDArray[np.bool_]
    outlines: Sequence[Floats]

    def __len__(self) -> int:
        return len(self.stiffness)

    def __repr__(self) -> str:
        ends = "" if len(self) == 0 else f", frequencies {self.frequencies[0]:.3g}"
        ends += "" if len(self) == 0 else f" to {self.frequencies[-1]:.3g}"
        return f"<Modes: {len(self)} of {len(self.packing)} particles{ends}>"

    @property
    def frequencies(self) -> Floats:
        """Angular frequencies, the roots of `stiffness`, shape (k,) [1/time].

        Those of unstable modes, which are imaginary, have a negative sign here.
        """
        return np.copysign(np.sqrt(np.abs(self.stiffness)), self.stiffness)

    @property
    def participation(self) -> Floats:
        """Participation ratio of each mode, (sum e_i^2)^2 / (N sum e_i^4), shape (k,).

        It is 1 if all particles move equally far, and 1/N if one moves alone.

        Raises:
            ParameterError: the modes were computed without vectors.
        """
        square = np.sum(self._vectors**2, axis=2)
        ratio: Floats = square.sum(axis=1) ** 2 / (square.shape[1] * np.sum(square**2, axis=1))
        return ratio

    def density(self, bins: int = 50) -> tuple[Floats, Floats]:
        """Density of states: part of these modes per frequency.

        Args:
            bins: number of intervals of equal width between the lowest and the highest frequency.

        Returns:
            Middle of each interval, shape (bins,) [1/time], and density, shape (bins,) [time].

        Raises:
            ParameterError: all modes have the same frequency, or there are none.
        """
        found = self.frequencies
        if len(found) == 0 or np.ptp(found) <= _SAME * np.abs(found).max():
            raise ParameterError(
                f"a density of states needs modes of different frequencies, not {shown(found[:3])}"
            )
        density, edges = np.histogram(found, count("bins", bins), density=True)
        return 0.5 * (edges[1:] + edges[:-1]), density

    def plot(
        self,
        index: int = 0,
        ax: Axes | None = None,
        *,
        view: tuple[float, float] | None = None,
    ) -> Axes:
        """Draw a mode as arrows over the outlines, in space over the centers; returns the axes.

        Args:
            index: of the mode.
            ax: axes to draw into; a new figure if not given.
            view: in space, elevation and azimuth of the viewer, as in `State.plot` [degree].

        Raises:
            ParameterError: there is no such mode, or no vectors, or the view is no two numbers.
            ImportError: matplotlib is missing (`pip install lammps-deformable[plot]`).
        """
        if view is not None and self.packing.dimension == 2:
            raise ParameterError("view is for packings in three dimensions")
        number = whole("index", index)
        if not -len(self) <= number < len(self):
            raise ParameterError(f"there are {len(self)} modes: index must not be {number}")
        vector = self._vectors[number]
        length = _ARROW * float(self.packing.radii.mean())
        optional("matplotlib", "plot")
        from ..pictures import drawing, plot3d

        size = np.linalg.norm(vector, axis=1)
        part = size / size.max()
        title = f"$\\omega$ = {self.frequencies[number]:.3g},  "
        title += f"participation {self.participation[number]:.2g}"
        look, packing = drawing.Look(color=_LABEL, title=title), self.packing
        arrows = length / size.max() * vector
        if packing.dimension == 3:
            seen = (20.0, 30.0) if view is None else view
            return plot3d.draw_arrows(packing, arrows, part, look, ax, seen)
        ax = drawing.draw(packing, self.outlines, part, look, ax)
        places = in_box(packing.walls, packing.box, packing.positions)
        ax.quiver(*places.T, *arrows.T, angles="xy", scale_units="xy", scale=1.0, color="tab:red")
        return ax

    @property
    def _vectors(self) -> Floats:
        if self.vectors is None:
            raise ParameterError("these modes have no vectors: compute them with vectors=True")
        return self.vectors


def modes_of(
    hessian: Hessian, outlines: Sequence[Floats], number: int | None, vectors: bool
) -> Modes:
    """The modes of lowest stiffness, see `State.modes`."""
    most = hessian.size - hessian.zero_modes
    wanted = most if number is None else count("number", number)
    if wanted > most:
        raise ParameterError(
            f"number must be at most {most}, not {wanted}: {hessian.zero_modes} of the "
            f"{hessian.size} motions of these particles have no stiffness"
        )
    if most <= _SMALL or wanted > _MANY * most:
        _check_memory(hessian.size)
        stiffness, found = _all(hessian, wanted, vectors)
    else:
        stiffness, found = _softest(hessian, wanted)
    each = (wanted, len(hessian.packing), hessian.packing.dimension)
    shaped = found.T.reshape(each) if vectors and found is not None else None
    return Modes(
        hessian.packing, stiffness, shaped, hessian.zero_modes, hessian.free.copy(), outlines
    )


def _check_memory(size: int) -> None:
    """Refuse dense matrices that do not fit: the system would kill the process."""
    needed = 8.0 * _MATRICES * size**2
    there = float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        raise ParameterError(
            f"these modes need {needed / 2**30:.0f} GB of memory and this machine has "
            f"{there / 2**30:.0f}: ask for a few of them, such as modes(10)"
        )


def _all(hessian: Hessian, number: int, vectors: bool) -> tuple[Floats, Floats | None]:
    """Eigenvalues, and eigenvectors as columns, of the dense matrix.

    Motions without a stiffness get one above all others, and free particles are left out.
    """
    from scipy.linalg import eigh

    kept = np.flatnonzero(hessian.held)
    if number == 0:
        return np.empty(0), np.empty((hessian.size, 0))
    dense = hessian.reduced()
    if len(kept) < hessian.size:
        dense = dense[np.ix_(kept, kept)]
    together = hessian.motions[kept]
    dense += (2.0 * float(np.abs(dense).sum(axis=0).max()) * together) @ together.T
    # LAPACK is faster for all modes than for many of them
    subset = None if number == len(kept) - together.shape[1] else (0, number - 1)
    driver = "evd" if subset is None else "evr"
    options = {"overwrite_a": True, "check_finite": False, "subset_by_index": subset}
    if not vectors:
        driver = "ev" if subset is None else "evr"
        return eigh(dense, eigvals_only=True, driver=driver, **options)[:number], None
    stiffness, found = eigh(dense, driver=driver, **options)
    full = np.zeros((hessian.size, number))
    full[kept] = found[:, :number]
    return stiffness[:number], full


def _softest(hessian: Hessian, number: int) -> tuple[Floats, Floats]:
    """The same by Lanczos' method with the inverse of the sparse matrix.

    It may miss one of several modes of the same stiffness, as crystals have them: the softest mode
    perpendicular to those found must not be softer than they are.
    """
    shift = _SHIFT * hessian.scale
    inverse = hessian.factored(shift)
    stiffness, found = _lanczos(hessian, inverse, number, np.empty((hessian.size, 0)))
    for _ in range(number):
        further, vector = _lanczos(hessian, inverse, 1, found)
        distance = np.abs(stiffness + shift)
        last = int(distance.argmax())
        if abs(further[0] + shift) >= (1.0 - _SOFTER) * distance[last]:
            break
        stiffness[last], found[:, last] = further[0], vector[:, 0]
    order = np.argsort(stiffness)
    return stiffness[order], found[:, order]


def _lanczos(
    hessian: Hessian, inverse: Callable[[Floats], Floats], number: int, without: Floats
) -> tuple[Floats, Floats]:
    """Modes of lowest stiffness perpendicular to those of the columns of `without`."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    padded = np.zeros(len(hessian.gradient))

    def project(vector: Floats) -> Floats:
        kept = hessian.project(vector.ravel())
        return kept - without @ (without.T @ kept)

    def product(vector: Floats) -> Floats:
        padded[: hessian.size] = project(vector)
        return project(inverse(padded)[: hessian.size])

    shape = (hessian.size, hessian.size)
    stiffness, found = eigsh(
        hessian.operator,
        number,
        sigma=-_SHIFT * hessian.scale,
        OPinv=LinearOperator(shape, matvec=product, dtype=float),
        v0=project(np.random.default_rng(1).standard_normal(hessian.size)),
    )
    return stiffness, found
