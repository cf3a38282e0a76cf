"""Elastic moduli of a packing, static and at a frequency, by linear response.

And small strains: how closely contacts and forces are balanced relative to them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.checks import numbers, positive, shown
from ..common.errors import ParameterError
from ..state.contacts import forces_of
from .relax import CLOSE, USUAL, balanced_to

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from ..particles.packing import Packing
    from ..state.hessian_matrix import Hessian
    from ..state.state import State
    from .simulation import Simulation


Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class ElasticModuli:
    """Elastic moduli of a packing at rest, at the pressure that it has.

        C_abcd = d(stress_ab)/d(du_c/dx_d)

    is the change of the stress (tension positive, minus the
    `State.pressure_tensor`) with the displacement
    gradient, at rest: particles follow the strain affinely, and then relax.

    Attributes:
        tensor: C, shape (d, d, d, d) in d dimensions [energy/length^d]. At zero stress it has all
            symmetries of an elastic tensor.
        affine: the same if centers only follow the strain (lines of contacts are at rest).
        relaxing: what the relaxation of centers takes away, `affine - tensor`.
    """

    tensor: Floats
    affine: Floats
    relaxing: Floats

    def __repr__(self) -> str:
        return (
            f"<ElasticModuli: shear {self.shear_modulus:.4g}, pure shear "
            f"{self.pure_shear_modulus:.4g}, bulk {self.bulk_modulus:.4g}>"
        )

    @property
    def shear_modulus(self) -> float:
        """Of simple shear along x, C_xyxy [energy/length^d]."""
        return float(self.tensor[0, 1, 0, 1])

    @property
    def pure_shear_modulus(self) -> float:
        """Of a stretch along x and a shrinkage along y [energy/length^d].

        (C_xxxx - C_xxyy - C_yyxx + C_yyyy)/4.
        """
        (xx_xx, xx_yy), (yy_xx, yy_yy) = np.einsum("aacc->ac", self.tensor)[:2, :2]
        return float(xx_xx - xx_yy - yy_xx + yy_yy) / 4.0

    @property
    def mean_shear_modulus(self) -> float:
        """Mean over all directions of shear [energy/length^d].

            [(C_abab + C_abba)/2 - C_aabb/d] / ((d + 2)(d - 1))

        In the plane it is that of simple and of pure shear. A small packing is not isotropic: its
        modulus varies as the sine of four times the angle.
        """
        c, d = self.tensor, len(self.tensor)
        sheared = 0.5 * (np.einsum("abab", c) + np.einsum("abba", c)) - np.einsum("aabb", c) / d
        return float(sheared) / ((d + 2) * (d - 1))

    @property
    def bulk_modulus(self) -> float:
        """K = - V dp/dV, the sum of all C_aacc over d^2 [energy/length^d].

        With lengths l it is (1/(d^2 V)) d^2E/d(ln l)^2 + p.
        """
        return float(np.einsum("aacc", self.tensor)) / len(self.tensor) ** 2


def moduli_of(hessian: Hessian) -> ElasticModuli:
    """See `State.moduli`.

    With E'' = d^2E/de de at fixed centers and lines, its coupling B to them, and M of `Hessian`,
    the second derivatives of the relaxed energy are E'' - B^T M^-1 B. Per area or volume V,

        C_abcd = E''_ab,cd / V + sigma_ad delta_bc - sigma_ab delta_cd,    sigma = -stress
    """
    refuse_walls(hessian)
    n, sigma = hessian.size, -hessian.stress
    coupled = hessian.by_strain
    lines = coupled[n:].T @ hessian.line_response(coupled[n:])
    relaxed = coupled.T @ hessian.response(coupled)
    unit = np.eye(len(sigma))
    by_stress = np.einsum("ad,bc->abcd", sigma, unit) - np.einsum("ab,cd->abcd", sigma, unit)
    affine, tensor = (
        (hessian.strain - part).reshape([len(sigma)] * 4) / hessian.room + by_stress
        for part in (lines, relaxed)
    )
    return ElasticModuli(tensor, affine, affine - tensor)


def refuse_walls(hessian: Hessian) -> None:
    """Refuse walls, which a strain would have to move.

    Raises:
        ParameterError: there are some.
    """
    if hessian.packing.walls:
        raise ParameterError(
            "elastic moduli need a periodic box without walls: `compress` by a small strain, and "
            "take the difference of pressures"
        )


# Place of a simple shear along x among the components xx, xy, ... of a displacement gradient.
_XY = 1


def complex_modulus_of(
    hessian: Hessian, frequencies: ArrayLike, drag: float
) -> NDArray[np.complex128]:
    """See `State.complex_modulus`.

    Lines of contacts are at rest at any time: M of `Hessian` takes the place of H, B that of xi,
    and only centers have a drag.
    """
    from scipy.sparse import diags
    from scipy.sparse.linalg import splu

    refuse_walls(hessian)
    omega, drag = numbers("frequencies", frequencies), positive("drag", drag)
    if (omega < 0.0).any():
        raise ParameterError(f"frequencies must not be negative, not {shown(omega.min())}")
    coupled = hessian.by_strain[:, _XY]
    damped = np.zeros(len(coupled))
    damped[: hessian.size] = drag
    relaxing = np.zeros(omega.shape, dtype=np.complex128)
    for place, rate in np.ndenumerate(omega):
        if rate == 0.0:
            moved = hessian.response(coupled)
        else:
            matrix = (hessian.matrix + diags(1j * rate * damped)).tocsc()
            moved = splu(matrix).solve(coupled.astype(np.complex128))
        relaxing[place] = coupled @ moved
    return (hessian.strain[_XY, _XY] - relaxing) / hessian.room


# Imbalance over a strain at which contacts still follow it: forces change by about the strain.
_OF_STRAIN = 1e-4


def imbalance_under(strain: float) -> float:
    """Imbalance with which contacts follow a strain from a state to the next one."""
    return min(USUAL, max(CLOSE, _OF_STRAIN * strain))


# Tolerance of relaxations over the strain, and the closest one.
_TOLERANCE_OF_STRAIN, _CLOSEST = 1e-4, 1e-11


def tolerance_under(strain: float, most: float) -> float:
    """Of relaxations after a strain, at most this one: forces that remain are an error of stress.

    The same tolerance for a strain that is not small.
    """
    return min(most, max(_CLOSEST, _TOLERANCE_OF_STRAIN * strain))


def following(sim: Simulation, packing: Packing, strain: float) -> AbstractContextManager[None]:
    """Let contacts of a simulation of a packing follow strains as small as this one meanwhile."""
    return balanced_to(sim, packing, imbalance_under(strain))


def unbalanced_modulus(state: State, part: float, strain: float) -> float:
    """Error of a modulus about, part sum |F_c| d_c / (d V strain) [energy/length^d].

    Args:
        state: with forces F_c and distances d_c of contacts, in the room V.
        part: of the contact forces that is not balanced.
        strain: of which the stress is measured.
    """
    contacts, box = forces_of(state), state.packing.box
    pressure = np.sum(np.abs(contacts.push) * contacts.distance) / (len(box) * np.linalg.det(box))
    return part * float(pressure) / strain
