"""Storage and loss modulus of a packing by linear response."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.errors import ParameterError
from ..common.validate import numbers, positive, shown
from .elastic import refuse_walls
from .hessian import Hessian

# Place of a simple shear along x among the components xx, xy, ... of a displacement gradient.
_XY = 1


def complex_modulus_of(
    hessian: Hessian, frequencies: ArrayLike, friction: float
) -> NDArray[np.complex128]:
    """See `LinearResponse.complex_modulus`.

    Lines of contacts are at rest at any time: M of `Hessian` takes the place of H, B that of xi,
    and only centers have a friction.
    """
    from scipy.sparse import diags
    from scipy.sparse.linalg import splu

    refuse_walls(hessian)
    omega, friction = numbers("frequencies", frequencies), positive("friction", friction)
    if (omega < 0.0).any():
        raise ParameterError(f"frequencies must not be negative, not {shown(omega.min())}")
    coupled = hessian.by_strain[:, _XY]
    damped = np.zeros(len(coupled))
    damped[: hessian.size] = friction
    relaxing = np.zeros(omega.shape, dtype=np.complex128)
    for place, rate in np.ndenumerate(omega):
        if rate == 0.0:
            moved = hessian.response(coupled)
        else:
            matrix = (hessian.matrix + diags(1j * rate * damped)).tocsc()
            moved = splu(matrix).solve(coupled.astype(np.complex128))
        relaxing[place] = coupled @ moved
    return (hessian.strain[_XY, _XY] - relaxing) / hessian.room
