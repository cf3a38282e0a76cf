"""Derivatives of elastic moduli by parameters: third derivatives of the energy.

U(e, t) is the energy at rest under a displacement gradient e, with parameters t. Its third
derivatives need only how centers x follow each argument to first order (the 2n + 1 theorem):

    d^3U/de de' dt = D (dE/dt + dx/dt dE/dx),    D = derivative along (e, x_e) and (e', x_e')

The derivative along (e, x_e) is that of `Terms`. Along (e', x_e') it is a difference of the
fourth order between states that LAMMPS evaluates, where lines of contacts are at rest.

Source: X. Gonze and J.-P. Vigneron, Phys. Rev. B 39, 13120 (1989).
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from ..common.errors import ParameterError
from ..common.ranks import alone
from ..state.law_terms import terms_of
from ..state.terms import Quantity, Terms
from .moduli import ElasticModuli
from .relax import CLOSE, balanced_to
from .simulation import Simulation

if TYPE_CHECKING:
    from ..state.state import State

Floats = NDArray[np.float64]

# Strain of the states at most, and part of any contact's force that changes meanwhile; parts of it
# that are taken where contacts close, too.
_STRAIN, _OF_FORCE = 1e-5, 1e-2
_PARTS = (1.0, 0.1, 0.01, 1e-3)

# Weights of states after so many steps in a derivative.
_WEIGHTS = {-2: 1.0 / 12.0, -1: -8.0 / 12.0, 1: 8.0 / 12.0, 2: -1.0 / 12.0}


def moduli_quantities(state: State, terms: Terms) -> dict[str, Quantity]:
    """Quantities `moduli`, `shear_modulus` and `bulk_modulus` of a state without walls.

    With U'' = d^2U/de de and the pressure tensor p,

        C_abcd = U''_ab,cd / V - p_ad delta_bc + p_ab delta_cd

    is symmetric in a and b: strains that keep the box without components above its diagonal are
    enough for e'.

    Raises:
        ParameterError: contacts open or close at once; or see `Hessian.solve`.
    """
    d, volume = state.dimension, state.volume
    strains = _strains(terms, terms)
    coupled = terms.chain.T @ (terms.local @ strains)
    followed = -terms.hessian.response(coupled)
    moved = terms.chain @ followed + strains
    second = (strains.T @ (terms.local @ moved)).reshape((d,) * 4)
    steps = _steps(state, terms, followed, moved)

    shape = d, d, d, d
    by_variables = np.zeros((*shape, len(followed)))
    explicit = {
        name: np.zeros((*shape, len(each.energy))) for name, each in terms.parameters.items()
    }
    for a, b in combinations_with_replacement(range(d), 2):
        k = d * a + b
        found = _along(state, terms, followed[: terms.hessian.size], k, steps[k])
        by_variables[a, b] = by_variables[b, a] = found["centers"].T.reshape(d, d, -1)
        found["box"] = _by_box(state, second, found.pop("strain"), found.pop("centers"), (a, b))
        for name, each in found.items():
            explicit[name][a, b] = explicit[name][b, a] = each.T.reshape(d, d, -1)

    stress, unit = terms.quantities["pressure_tensor"], np.eye(d)
    of_stress = np.einsum("ma,nb,cd->abcdmn", unit, unit, unit)
    of_stress -= np.einsum("ma,nd,bc->abcdmn", unit, unit, unit)
    above = np.tri(d, dtype=bool).T[:, :, None, None, None, None]
    of_stress = np.where(above, of_stress, of_stress.swapaxes(0, 1)).reshape(d**4, d**2)

    def quantity(of: tuple[int, ...], weights: Floats) -> Quantity:
        def by(name: str) -> Any:
            found = explicit[name].reshape(d**4, -1) / volume
            if name in stress.explicit:
                found = found + of_stress @ stress.explicit[name]()
            return csr_matrix(weights @ found)

        rows = csr_matrix(weights @ of_stress)
        return Quantity(
            of,
            rows @ stress.by_gradient,
            rows @ stress.by_local,
            csr_matrix(weights @ by_variables.reshape(d**4, -1) / volume),
            {name: by(name) for name in explicit},
        )

    moduli = [ElasticModuli(row.reshape(shape), *np.empty((2, 0))) for row in np.eye(d**4)]
    return {
        "moduli": quantity(shape, np.eye(d**4)),
        "shear_modulus": quantity((), np.array([[one.shear_modulus for one in moduli]])),
        "bulk_modulus": quantity((), np.array([[one.bulk_modulus for one in moduli]])),
    }


def _strains(start: Terms, terms: Terms) -> Floats:
    """Derivatives of local variables by a strain of the vectors at the start, shape (V, d^2)."""
    vector = start.sides.vector
    d = vector.shape[1]
    columns = d * np.arange(d)[:, None] + np.arange(d)
    found = terms.by_vectors(vector[:, None, :], terms.vectors[:, :, None], columns, d**2)
    dense: Floats = found.toarray()
    return dense


def _steps(state: State, terms: Terms, followed: Floats, moved: Floats) -> Floats:
    """Strains by which states differ, for each component, shape (d^2,): no contact opens."""
    of = terms.quantities["forces"]
    rates = (
        of.by_gradient @ (terms.local @ moved) + of.by_local @ moved + of.by_variables @ followed
    )
    force = np.abs(state.contacts["force"])[:, None]
    rates = np.where(force > 0.0, np.abs(rates), 0.0)
    fastest = np.max(rates / np.where(force > 0.0, force, 1.0), axis=0, initial=0.0)
    return _OF_FORCE / np.maximum(fastest, _OF_FORCE / _STRAIN)


def _along(
    state: State, terms: Terms, centers: Floats, component: int, step: float
) -> dict[str, Floats]:
    """Second derivatives along the response to each strain e, and along that to one component.

    Returns:
        Of E by `centers` and lines, 0 for these, shape (Z, d^2), by a `strain` that is added,
        (d^2, d^2), and by each parameter, (k, d^2).
    """
    packing, d = state.packing, state.dimension
    change = np.eye(d**2)[component].reshape(d, d)
    moved = centers[:, component].reshape(-1, d)
    for strain in step * np.array(_PARTS):
        found: dict[str, Floats] = {}
        for steps, weight in _WEIGHTS.items():
            gradient = np.eye(d) + steps * strain * change
            positions = packing.positions @ gradient.T + steps * strain * moved
            there = packing.replace(positions=positions, box=packing.box @ gradient.T)
            here = _balanced(replace(state, packing=there))
            if not _same_contacts(terms, here):
                break
            for name, each in _slopes(terms, here, centers).items():
                found[name] = found.get(name, 0.0) + weight / strain * each
        else:
            return found
    raise ParameterError(
        f"contacts open or close at a strain of {2.0 * strain:.1g}: moduli jump, and have no "
        "derivatives here"
    )


def _balanced(state: State) -> Terms:
    """Of these centers, with lines at rest."""
    with Simulation(state, state.law, comm=alone()) as sim, balanced_to(sim, state.packing, CLOSE):
        return terms_of(sim.state())


def _same_contacts(one: Terms, other: Terms) -> bool:
    """Whether the sides are those of the same particles."""
    before, after = one.sides, other.sides
    return np.array_equal(before.i, after.i) and np.array_equal(before.j, after.j)


def _slopes(start: Terms, here: Terms, centers: Floats) -> dict[str, Floats]:
    """Second derivatives along the responses to strains at the start, see `_along`."""
    size, strains = len(centers), _strains(start, here)
    lines = here.chain[:, size:]
    moved = here.chain[:, :size] @ centers + strains
    moved -= lines @ here.hessian.line_response(lines.T @ (here.local @ moved))
    slopes = here.local @ moved
    by_parameters = {
        name: each.local.T @ slopes + each.explicit.T @ moved
        for name, each in here.parameters.items()
    }
    return {"centers": here.chain.T @ slopes, "strain": strains.T @ slopes, **by_parameters}


def _by_box(
    state: State, second: Floats, by_strain: Floats, by_centers: Floats, component: tuple[int, int]
) -> Floats:
    """V d(U_ee/V)/dL of one component and all others, shape (d^2, d^2), for lattice vectors L.

    L + dL is L after a strain h, with dL = L h^T, where given centers go back by h x. A strain e
    after it is e + e h beside it:  dU_ee[e, e'] = U_eee[e, e', h] + U_ee[e h, e'] + U_ee[e, e' h].
    """
    d, (a, b) = state.dimension, component
    strain = np.einsum("pl,qk->klpq", np.eye(d), np.linalg.inv(state.box))
    x = state.positions
    back = by_centers[: x.size].reshape(*x.shape, d, d)
    found = np.einsum("klpq,pqcd->klcd", strain, by_strain.reshape((d,) * 4))
    found -= np.einsum("klpq,nq,npcd->klcd", strain, x, back)
    found += np.einsum("kldm,cm->klcd", strain, second[:, :, a, b])
    found += np.einsum("klm,mcd->klcd", strain[:, :, b], second[a])
    found -= np.einsum("klpp,cd->klcd", strain, second[a, b])
    return np.where(np.tri(d, dtype=bool)[:, :, None, None], found, 0.0).reshape(d**2, d**2)
