"""Derivatives of what is at rest by parameters, with one linear system for any number of them.

The energy E(z, t) of a packing at rest is stationary in z, the centers and the lines or forces of
contacts, and depends on parameters t. With the matrix M = E_zz of `Hessian`, for any O(z, t)

    dE/dt = E_t,    dz/dt = -M^-1 E_zt,    dO/dt = O_t - (M^-1 O_z) E_zt.

`terms` and `law_terms` have E_t, E_zt, O_t and O_z.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..common.checks import numbers, shown
from ..common.errors import OpeningWarning, ParameterError, warn
from .hessian import check_at_rest, check_smooth
from .law_terms import terms_of
from .terms import Quantity, Terms

if TYPE_CHECKING:
    from .state import State

Floats = NDArray[np.float64]

# A contact is about to open where its force is below this part of the mean.
_OPENING = 1e-5

# Quantities that need other states, without walls.
_MODULI = ("moduli", "shear_modulus", "bulk_modulus")
_Moduli = Callable[[Terms], Mapping[str, Quantity]]


class Derivatives:
    """Derivatives of a state at rest by its parameters t.

    Positions and contacts follow the parameters, so that the state stays at rest: with the energy
    E(z, t) of centers and lines z, and M of `Hessian`,

        dE/dt = E_t,    dz/dt = -M^-1 E_zt,    dO/dt = O_t - (M^-1 O_z) E_zt

    for any quantity O. `vjp` has the derivatives of one combination of quantities by all parameters
    from one linear system, `jvp` those of all quantities along one direction of the parameters, as
    functions of these names in JAX, and `jacobian` is a table of all. Quantities:

        energy            as `State.energy`, shape ()
        pressure          as `State.pressure`, shape ()
        pressure_tensor   shape (d, d)
        positions         shape (N, d)
        forces            of contacts, as the column `force` of `State.contacts`, shape (rows,)
        volumes           shape (N,)
        pressures         shape (N,), not of soft contacts
        moduli            `tensor` of `State.moduli`, without walls, shape (d, d, d, d)
        shear_modulus     shape (), and bulk_modulus

    Third derivatives of the energy, for moduli, are differences of M and E_zt at strains of 1e-5
    or less, of the fourth order, with an error of about 1e-8.

    Motions without a stiffness are left out of positions, as of `Hessian.solve`, and contacts of
    rattlers bear nothing.

    Attributes:
        by: names of the parameters.
        shapes: of the parameters by name.
        parameters: names of all that the state has.
        quantities: names of all that it has.
    """

    def __init__(
        self, terms: Terms, by: str | Sequence[str], moduli: _Moduli | None = None
    ) -> None:
        """Of these parameters, and with these quantities of moduli; use `State.derivatives`."""
        self._terms, self._moduli, self._single = terms, moduli, isinstance(by, str)
        self.parameters, self.quantities = tuple(terms.parameters), tuple(terms.quantities)
        if moduli:
            self.quantities += _MODULI
        names = [by] if isinstance(by, str) or not isinstance(by, Sequence) else by
        self.by = tuple(names)
        for name in self.by:
            if name not in self.parameters:
                there = ", ".join(self.parameters)
                raise ParameterError(f"by must be of {there}, not {shown(name)}")
        self.shapes = {name: terms.parameters[name].shape for name in self.by}

    def __repr__(self) -> str:
        sizes = ", ".join(f"{name} {shape}" for name, shape in self.shapes.items())
        return f"<Derivatives by {sizes}>"

    def vjp(self, **cotangents: ArrayLike) -> Any:
        """Derivatives of sum w.O by all parameters, with one linear system.

            state.derivatives(by="radii").vjp(pressure=1.0)
            state.derivatives(by=["kA", "box"]).vjp(positions=slopes, energy=2.0)

        For a function of your own give its derivatives by the positions, and by other quantities.

        Args:
            cotangents: weights w by the name of the quantity, of its shape.

        Returns:
            An array of the shape of the parameters; a dictionary if `by` had several names.

        Raises:
            ParameterError: there is no such quantity, or its shape is another one; or the packing
                does not resist, see `Hessian.solve`; or moduli jump, as contacts open or close.
        """
        found = self._pulled(
            {
                name: self._given(name, weights, self._quantity(name).shape)
                for name, weights in cotangents.items()
            }
        )
        return self._result(
            {name: each[:, 0].reshape(self.shapes[name]) for name, each in found.items()}
        )

    def jvp(self, **tangents: ArrayLike) -> dict[str, Floats]:
        """Changes of all quantities but moduli with the parameters, with one linear system.

            state.derivatives(by="radii").jvp(radii=change)["positions"]

        Args:
            tangents: rates by the name of the parameter, of its shape; 0 if not given.

        Returns:
            Rates of all quantities by name.

        Raises:
            ParameterError: as for `vjp`.
        """
        for name in tangents:
            if name not in self.by:
                raise ParameterError(f"tangents must be of {', '.join(self.by)}, not {shown(name)}")
        given = {
            name: self._given(name, rates, self.shapes[name]) for name, rates in tangents.items()
        }
        found = self._pushed(given, [each for each in self.quantities if each not in _MODULI])
        return {
            name: each[:, 0].reshape(self._terms.quantities[name].shape)
            for name, each in found.items()
        }

    def jacobian(self, quantity: str) -> Any:
        """All derivatives of a quantity by all parameters.

        With m numbers of the quantity and k of the parameters it solves a linear system with the
        smaller one of both as the number of right sides.

        Args:
            quantity: its name.

        Returns:
            An array of the shape of the quantity, followed by that of the parameters; a dictionary
            of these if `by` had several names.

        Raises:
            ParameterError: as for `vjp`.
        """
        shape = self._quantity(quantity).shape
        m = int(np.prod(shape))
        k = sum(int(np.prod(each)) for each in self.shapes.values())
        if m <= k:
            found = self._pulled({quantity: np.eye(m)})
            return self._result(
                {name: each.T.reshape(shape + self.shapes[name]) for name, each in found.items()}
            )
        columns = {}
        for name in self.by:
            unit = np.eye(int(np.prod(self.shapes[name])))
            columns[name] = self._pushed({name: unit}, [quantity])[quantity]
        return self._result(
            {name: each.reshape(shape + self.shapes[name]) for name, each in columns.items()}
        )

    def _pulled(self, weights: Mapping[str, Floats]) -> dict[str, Floats]:
        """O_t - (M^-1 O_z) E_zt of c combinations of quantities, from arrays (m, c) to (k, c)."""
        terms = self._terms
        count = next(iter(weights.values())).shape[1] if weights else 1
        size, width = terms.chain.shape
        of_gradient, of_local = np.zeros((2, size, count))
        of_variables = np.zeros((width, count))
        for name, w in weights.items():
            quantity = terms.quantities[name]
            of_gradient += quantity.by_gradient.T @ w
            of_local += quantity.by_local.T @ w
            of_variables += quantity.by_variables.T @ w
        of_local += terms.local @ of_gradient
        right = of_variables + terms.chain.T @ of_local
        moved = terms.hessian.response(right) if right.any() else right
        of_moved = terms.chain @ moved
        of_local -= terms.local @ of_moved
        of_gradient -= of_moved
        found = {}
        for name in self.by:
            parameter = terms.parameters[name]
            found[name] = (
                parameter.local.T @ of_local
                + parameter.explicit.T @ of_gradient
                - parameter.on_centers.T @ moved
            )
            for of, w in weights.items():
                found[name] += self._explicit(of, name).T @ w
        return found

    def _pushed(self, rates: Mapping[str, Floats], wanted: Sequence[str]) -> dict[str, Floats]:
        """Changes of quantities along c directions of the parameters, from (k, c) to (m, c)."""
        terms = self._terms
        count = next(iter(rates.values())).shape[1] if rates else 1
        size, width = terms.chain.shape
        local, explicit = np.zeros((2, size, count))
        right = np.zeros((width, count))
        for name, rate in rates.items():
            parameter = terms.parameters[name]
            local += parameter.local @ rate
            explicit += parameter.explicit @ rate
            right += parameter.on_centers @ rate
        right += terms.chain.T @ (terms.local @ local + explicit)
        moved = -terms.hessian.response(right) if right.any() else right
        local += terms.chain @ moved
        gradient = terms.local @ local + explicit
        found = {}
        for name in wanted:
            quantity = terms.quantities[name]
            found[name] = (
                quantity.by_gradient @ gradient
                + quantity.by_local @ local
                + quantity.by_variables @ moved
            )
            for by, rate in rates.items():
                found[name] += self._explicit(name, by) @ rate
        return found

    def _explicit(self, quantity: str, parameter: str) -> Any:
        """O_t at given z and q, shape (m, k)."""
        from scipy.sparse import csr_matrix

        of, by = self._terms.quantities[quantity], self._terms.parameters[parameter]
        if quantity == "energy":
            energy = by.energy + by.local.T @ self._terms.gradient
            return csr_matrix(energy[None, :])
        if parameter not in of.explicit:
            return csr_matrix((int(np.prod(of.shape)), len(by.energy)))
        found = of.explicit[parameter]
        return found() if callable(found) else found

    def _quantity(self, name: str) -> Quantity:
        if name not in self.quantities:
            there = ", ".join(self.quantities)
            raise ParameterError(f"quantity must be of {there}, not {shown(name)}")
        if name not in self._terms.quantities:
            assert self._moduli is not None
            self._terms.quantities.update(self._moduli(self._terms))
        return self._terms.quantities[name]

    def _given(self, name: str, values: ArrayLike, shape: tuple[int, ...]) -> Floats:
        """Numbers of this shape, as a column."""
        found = numbers(name, values)
        if found.shape != shape:
            raise ParameterError(f"{name} must have shape {shape}, not {found.shape}")
        return found.reshape(-1, 1)

    def _result(self, found: dict[str, Floats]) -> Any:
        return found[self.by[0]] if self._single else found


def derivatives_of(state: State, by: str | Sequence[str], moduli: _Moduli) -> Derivatives:
    """See `State.derivatives`; `moduli` makes quantities of a state without walls."""
    check_smooth(state)
    terms = terms_of(state)
    check_at_rest(state.residual)
    _warn_of_opening(terms)
    return Derivatives(terms, by, None if state.walls else moduli)


def _warn_of_opening(terms: Terms) -> None:
    """Derivatives jump where contacts open."""
    size = np.abs(terms.forces)
    weak = np.flatnonzero((size > 0.0) & (size < _OPENING * size.mean()))
    if len(weak):
        i, j = terms.sides.i[weak[0]], terms.sides.j[weak[0]]
        with_whom = f"particle {j}" if j >= 0 else f"wall {-j}"
        warn(
            f"{len(weak)} sides of contacts are about to open, the first one of particle {i} with "
            f"{with_whom}: derivatives hold on one side only, and jump where a contact opens",
            OpeningWarning,
        )
