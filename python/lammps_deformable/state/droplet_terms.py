"""Tables of the parameters of droplets, see `terms`.

Their dual energy has forces as variables, and its derivative by an overlap is the force.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..particles.laws import Droplet, pair_matrix
from .droplet_hessian import (
    CAP_VARIABLES,
    DAMPING,
    SIDE_VARIABLES,
    TURN_VARIABLES,
    DropletContacts,
    contacts_of_droplets,
)
from .terms import Blocks, Terms, diagonal, sparse, volumes_of_radii, with_places

if TYPE_CHECKING:
    from .state import State

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# Place of the force among the local variables of a side, of the overlap and of the part of it that
# a side has among the columns of `core.droplet_blocks`.
_FORCE, _OVERLAP, _PART = 3, 7, 8


def of_droplets(state: State, law: Droplet) -> Terms:
    """Radii, tensions and adhesions enter by `_Stays`, by overlaps and by facets."""
    found = contacts_of_droplets(state, law, rattlers=False, turning=bool(state.walls))
    sides, blocks, count = found.sides, Blocks.of(found.blocks), len(found.sides.i)
    first = found.variables * np.arange(count)
    terms = Terms.of(found.packing, blocks, found.chain, found.strains, sides, first)
    terms.forces = found.rows[:, -5]
    _follow_turns(terms, found)
    stays = _Stays.of(terms, found)
    by = _ways(state, law, found, stays)
    _parameters(terms, found, stays, by)
    _pressures(state, terms, found, stays, by)
    volumes_of_radii(found.packing, terms)
    force = terms.of_local(1.0, np.arange(count), first + _FORCE, count)
    angles = first[:, None] + np.arange(SIDE_VARIABLES, found.variables)
    return with_places(state, terms, force=(None, force), angles=angles)


@dataclass
class _Stays:
    """n numbers that stay at given local variables, and how the energy depends on them.

    They are ln(lambda), the angle of the film and lambda of that of each side, then the radius and
    the tension of each droplet.

    Attributes:
        film, angle, lean: numbers of the sides, shape (S,).
        radius, tension: numbers of the droplets, shape (N,).
        size: n.
        mixed: derivatives of g, sparse, shape (V, n).
        energy: derivatives of the energy of each droplet without caps, sparse, shape (N, n).
        of_caps: those of all caps of each droplet, sparse, shape (N, n).
    """

    film: Integers
    angle: Integers
    lean: Integers
    radius: Integers
    tension: Integers
    size: int
    mixed: Any = None
    energy: Any = None
    of_caps: Any = None

    @classmethod
    def of(cls, terms: Terms, found: DropletContacts) -> _Stays:
        """Of all blocks."""
        i, count, number = found.sides.i, len(found.sides.i), len(found.packing)
        film, angle, lean = np.arange(3 * count).reshape(3, count)
        radius, tension = 3 * count + np.arange(2 * number).reshape(2, number)
        stays = cls(film, angle, lean, radius, tension, 3 * count + 2 * number)
        size, each = (number, stays.size), np.arange(number)

        def mixed(start: int, columns: Integers, entries: Any) -> Any:
            row, column, value = entries
            return terms.by_local(value, start + row, columns[column], stays.size)

        columns = _with_ends((film, angle), i, (radius, tension))
        turning = found.variables > SIDE_VARIABLES
        by, entries = core.droplet_parameters(found.droplets, found.rows, turning)
        stays.mixed = mixed(0, columns, entries)
        stays.energy = sparse(by, _with_ends((i, i), i, (each, each)), columns, size)
        stays.of_caps = sparse(0.0, 0, 0, size)
        if found.stretches is None:
            return stays
        wet, kept, caps = found.stretches.wet, found.stretches.kept, found.stretches.caps
        (by, entries), (by_caps, entries_of_caps) = found.stretches.parameters()
        place, own = np.searchsorted(wet, i[kept]), i[kept]
        columns = _with_ends((angle[kept], lean[kept]), place, (radius[wet], tension[wet]))
        stays.mixed += mixed(found.films, columns, entries)
        stays.energy += sparse(by, _with_ends((own, own), place, (wet, wet)), columns, size)
        ends = i[caps], i[found.other[caps]]
        of = np.stack([radius[ends[0]], radius[ends[1]], tension[ends[0]], angle[caps]], axis=1)
        stays.mixed += mixed(found.caps, of.ravel(), entries_of_caps)
        for end in ends:
            stays.of_caps += sparse(by_caps.reshape(of.shape), end[:, None], of, size)
        return stays

    @property
    def by(self) -> Floats:
        """Derivatives of the energy of all, shape (n,): a cap has two droplets."""
        found: Floats = np.asarray((self.energy + 0.5 * self.of_caps).sum(axis=0)).ravel()
        return found


def _with_ends(
    of_sides: tuple[Integers, Integers], place: Integers, of_ends: tuple[Integers, Integers]
) -> Integers:
    """Two numbers of each side of a droplet, then two of the droplet itself, and so on.

    Args:
        of_sides: of K sides that are sorted by droplet, shape (K,).
        place: of the droplet of each side, shape (K,).
        of_ends: of n droplets, shape (n,).
    """
    count = np.bincount(place, minlength=len(of_ends[0]))
    found = np.empty(2 * (len(place) + len(count)), int)
    side = 2 * (np.arange(len(place)) + place)
    end = 2 * (np.cumsum(count) + np.arange(len(count)))
    found[side], found[side + 1] = of_sides
    found[end], found[end + 1] = of_ends
    return found


def _ways(state: State, law: Droplet, found: DropletContacts, stays: _Stays) -> dict[str, Any]:
    """How what stays follows each parameter, sparse, shape (n, k)."""
    packing, sides, other = found.packing, found.sides, found.other
    i, j, number, each = sides.i, sides.i[other], len(packing), np.arange(len(packing))
    R, G = packing.radii, found.droplets[:, 2]
    films, size = _of_films(state, law, found), (stays.size, number)
    radii = sparse(1.0, stays.radius, each, size)
    tension = sparse(1.0, stays.tension, each, size)
    radii += sparse(1.0 / (R[i] + R[j]), stays.film, i, size)
    radii += sparse(1.0 / (R[i] + R[j]) - 1.0 / R[j], stays.film, j, size)
    tension += sparse(-1.0 / (G[i] + G[j]), stays.film, i, size)
    tension += sparse(1.0 / G[j] - 1.0 / (G[i] + G[j]), stays.film, j, size)
    rows = np.stack([stays.angle, stays.lean], axis=1)
    for of_end, end in ((0, i), (2, j)):
        radii += sparse(films[:, :, of_end], rows, end[:, None], size)
        tension += sparse(films[:, :, of_end + 1], rows, end[:, None], size)
    ways = {"radii": radii, "tension": tension}
    if found.stretches is None:
        return ways
    kind, kinds = packing.species, int(packing.species.max()) + 1
    low, high = np.sort([kind[i], kind[j]], axis=0)
    stuck, at_wall = found.stuck[:, 0] > 0.0, other == np.arange(len(other))
    for name, kept, column, width in (
        ("adhesion", stuck & ~at_wall, kinds * low + high, kinds**2),
        ("wall_adhesion", stuck & at_wall, -1 - sides.j, len(packing.walls)),
    ):
        size = stays.size, width
        ways[name] = sparse(films[kept, :, 4], rows[kept], column[kept][:, None], size)
    return ways


def _parameters(
    terms: Terms, found: DropletContacts, stays: _Stays, ways: Mapping[str, Any]
) -> None:
    """Add radii, tensions and adhesions."""
    packing, sides, number = found.packing, found.sides, len(found.packing)
    local, explicit, turned = _turns_by_parameters(terms, found)
    part, force = found.rows[:, _PART], terms.forces
    push = found.variables * np.arange(len(sides.i)) + _FORCE
    pair = np.flatnonzero(sides.j >= 0)
    explicit["radii"] += terms.by_local(part, push, sides.i, number)
    explicit["radii"] += terms.by_local(part[pair], push[pair], sides.j[pair], number)
    work = np.bincount(sides.i, part * force, number)
    work += np.bincount(sides.j[pair], (part * force)[pair], number)
    energy = {"radii": work + turned}
    kinds = int(packing.species.max()) + 1
    shapes = {"adhesion": (kinds, kinds), "wall_adhesion": (len(packing.walls),)}
    for name, way in ways.items():
        terms.parameter(
            name,
            shapes.get(name, (number,)),
            local.get(name),
            stays.mixed @ way + explicit.get(name, 0),
            way.T @ stays.by + energy.get(name, 0.0),
        )


def _pressures(
    state: State,
    terms: Terms,
    found: DropletContacts,
    stays: _Stays,
    ways: Mapping[str, Any],
) -> None:
    """Pressures inside, by `droplet_pressure` of src/laws/droplet.h.

        4 pi R^3 p = 8 pi g R^2 + R sum F + sum F a - 2 W

    Of the energy E of a droplet alone, W = sum part F o - E and a = part o - E_F, so that the last
    two terms are 2 E - sum F (part o + E_F). A half of the energies -T of films that turn and -C
    of caps belongs to each droplet; its forces enter T by its facets R t and ln D, too, which
    are proportional to them:

        (F T_F)/2 + T_w (+-R t) + T ln D - T,     (F C_F)/2 - C
    """
    sides, other, of = found.sides, found.other, found.sides.i
    number, count = len(found.packing), len(of)
    R, G = found.droplets[:, 1:].T
    F, g = terms.forces, terms.gradient
    size = found.variables * count
    push = found.variables * np.arange(count) + _FORCE
    overlap, part = found.rows[:, _OVERLAP], found.rows[:, _PART]

    def table(values: Any, droplets: Any, columns: Any) -> Any:
        return terms.of_local(values, droplets, columns, number)

    by_gradient = table(-F, of, push)
    by_local = table(2.0 * g[:size], np.repeat(of, found.variables), np.arange(size))
    by_local += table(R[of] - part * overlap - g[push], of, push)
    out = (part * F / sides.distance)[:, None] * sides.vector
    by_local += table(out, of[:, None], terms.vectors)

    # films that turn: derivatives of T_w by forces are in those of E_F already
    start = size + TURN_VARIABLES * np.arange(len(found.first))
    log_damping = np.log(found.facets[:, 3])
    pull, damp = np.zeros((count, 3)), np.zeros(count)
    for end, sign in ((found.first, 1.0), (other[found.first], -1.0)):
        way = start[:, None] + np.arange(1, 4)
        by_gradient += table(0.5 - log_damping[end], of[end], start + 4)
        by_gradient += table(-sign * found.facets[end, :3], of[end, None], way)
        pull[end], damp[end] = sign * g[way], g[start + 4]
    axes = 3 * np.arange(count)[:, None] + np.arange(3)
    moved = (sparse(pull, of[:, None], axes, (number, 3 * count)) @ found.places).tocoo()
    by_force = moved.col % found.variables == _FORCE
    by_local -= table(moved.data[by_force], moved.row[by_force], moved.col[by_force])
    damped = np.bincount(of, damp, number) * DAMPING / (G * R)
    by_local -= table(damped[of], of, push)

    if found.stretches is not None:
        wet, kept, caps = found.stretches.wet, found.stretches.kept, found.stretches.caps
        place = np.searchsorted(wet, of[kept])
        push = found.films + np.arange(len(kept)) + 2 * place
        by_gradient += table(-F[kept], of[kept], push)
        rows = np.arange(found.films, found.caps)
        owner = np.repeat(wet, np.bincount(place, minlength=len(wet)) + 2)
        by_local += table(2.0 * g[rows], owner, rows) + table(-g[push], of[kept], push)
        push = found.caps + CAP_VARIABLES * np.arange(len(caps))
        rows = push[:, None] + np.arange(CAP_VARIABLES)
        for end in (caps, other[caps]):
            by_gradient += table(-0.5 * F[end], of[end], push)
            by_local += table(g[rows], of[end, None], rows) + table(-0.5 * g[push], of[end], push)

    explicit = {name: (2.0 * stays.energy + stays.of_caps) @ way for name, way in ways.items()}
    pair = np.flatnonzero(sides.j >= 0)
    work = part * F
    explicit["radii"] += sparse(work, of, of, (number, number))
    explicit["radii"] += sparse(work[pair], of[pair], sides.j[pair], (number, number))
    explicit["radii"] += diagonal(np.bincount(of, F, number) + 16.0 * np.pi * G * R)
    explicit["tension"] += diagonal(8.0 * np.pi * R**2)
    room = diagonal(0.25 / (np.pi * R**3))
    explicit = {name: room @ each for name, each in explicit.items()}
    explicit["radii"] -= diagonal(3.0 * state.pressures / R)
    terms.quantity("pressures", (number,), room @ by_gradient, room @ by_local, explicit=explicit)


def _of_films(state: State, law: Droplet, found: DropletContacts) -> Floats:
    """`core.film_slopes` of the film of each side, 0 without, shape (S, 2, 5)."""
    packing, sides, other, droplets = found.packing, found.sides, found.other, found.droplets
    kind, slopes = packing.species, np.zeros((len(other), 2, 5))
    adhesion = pair_matrix("adhesion", law.adhesion, int(kind.max()) + 1)
    for n in np.flatnonzero(found.stuck[:, 0] > 0.0):
        i, j = sides.i[[n, other[n]]].tolist()
        if other[n] == n:
            w, tension = packing.walls[-1 - sides.j[n]].adhesion, np.inf
        else:
            w, tension = adhesion[kind[i], kind[j]], droplets[j, 2]
        (_, radius, own), (_, its_radius, _) = droplets[[i, j]].tolist()
        slopes[n] = core.film_slopes(radius, own, its_radius, float(tension), float(w))
    return slopes


def _follow_turns(terms: Terms, found: DropletContacts) -> None:
    """Facets turn with the vectors of all contacts of their droplets."""
    from scipy.sparse import eye

    of_turns, size = found.of_turns.tocoo(), len(terms.gradient)
    start = found.variables * len(found.sides.i)
    follow = terms.by_local(of_turns.data, start + of_turns.row, of_turns.col, size)
    terms.follow = (eye(size) + follow).tocsr()


def _turns_by_parameters(
    terms: Terms, found: DropletContacts
) -> tuple[dict[str, Any], dict[str, Any], Floats]:
    """q_t and g_t of facets that turn, by radii and tensions, and dE/dR of their energy T.

    T is minus that of `_Turns`, and goes with 1/(R_i + R_j). Where forces and normals stay, the
    places R t go with 1/tension, and the logarithms of D with 1/(R tension).
    """
    first, sides, droplets, number = found.first, found.sides, found.droplets, len(found.packing)
    j = sides.i[found.other]
    R, G, size = droplets[:, 1], droplets[:, 2], found.variables * len(sides.i)
    rows = size + TURN_VARIABLES * np.arange(len(first))[:, None] + np.arange(TURN_VARIABLES)
    g, ends = terms.gradient[rows], (sides.i[first], j[first])
    log_damping = np.zeros(number)
    log_damping[sides.i] = np.log(found.facets[:, 3])
    radii = (R[ends[0]] + R[ends[1]])[:, None]
    local, explicit = {}, {}
    of_log = sum(np.bincount(end, g[:, 4], number) for end in ends)
    push = found.variables * np.arange(len(sides.i)) + 3
    for name, values in (("radii", R), ("tension", G)):
        local[name] = sum(
            terms.by_local(-(log_damping / values)[end], rows[:, 4], end, number) for end in ends
        )
        slope = DAMPING / (G * R) * of_log / values
        explicit[name] = terms.by_local(-slope[sides.i], push, sides.i, number)
    for end, side, sign in ((ends[0], first, -1.0), (ends[1], found.other[first], 1.0)):
        places = sign * found.facets[side, :3] / G[end, None]
        local["tension"] += terms.by_local(places, rows[:, 1:4], end[:, None], number)
        explicit["radii"] += terms.by_local(-g / radii, rows, end[:, None], number)
    pull = np.zeros((len(sides.i), 3))
    pull[first], pull[found.other[first]] = g[:, 1:4], -g[:, 1:4]
    pull /= -G[sides.i, None]
    axes = 3 * np.arange(len(sides.i))[:, None] + np.arange(3)
    pulled = found.places.T @ sparse(pull, axes, sides.i[:, None], (3 * len(pull), number))
    pulled = pulled.tocoo()
    explicit["tension"] += terms.by_local(pulled.data, pulled.row, pulled.col, number)
    by_energy = np.zeros(number)
    for end in ends:
        np.add.at(by_energy, end, -g[:, 4] / radii[:, 0])
    return local, explicit, by_energy
