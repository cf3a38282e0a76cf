"""Tables of the parameters of each law, see `terms`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import core
from ..core import disk_blocks
from ..particles.laws import Droplet, Ring, SoftContact, pair_matrix, volumes
from .contacts import by_centers, by_strains
from .droplet_hessian import (
    DAMPING,
    SIDE_VARIABLES,
    TURN_VARIABLES,
    DropletContacts,
    contacts_of_droplets,
)
from .hessian import balanced, bearing_soft, lines_of
from .terms import Blocks, Terms, diagonal, sparse, with_places

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from .state import State

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


def terms_of(state: State) -> Terms:
    """Of a state at rest, without contacts of rattlers."""
    if isinstance(state.law, SoftContact):
        return _of_soft_contacts(state, state.law)
    return (
        _of_rings(state, state.law) if state.law.dimension == 2 else _of_droplets(state, state.law)
    )


# Parameters of a particle as local variables of `core.ring_blocks`, after those of its sides.
_OF_RING = ("radii", "kA", "kP", "skin", "tension", "area")
_OF_SIDE, _SHIFT, _DIRECTION = 5, 2, 3


def _of_rings(state: State, law: Ring) -> Terms:
    """Lines that are balanced to rounding, and parameters of rings.

    Shift and direction of a side move its line at given places: by the shift its derivative is the
    force, by the area A0 of a particle it is the pressure.
    """
    lines = balanced(lines_of(state.packing, law, state.contacts, rattlers=False))
    packing, sides = lines.packing, lines.sides
    number, count, each = len(packing), len(sides.i), np.arange(len(packing))
    blocks = Blocks.of(lines.blocks(parameters=True))
    own = _OF_SIDE * np.cumsum(np.bincount(sides.i, minlength=number)) + len(_OF_RING) * each
    of = {name: own + n for n, name in enumerate(_OF_RING)}
    first = _OF_SIDE * np.arange(count) + len(_OF_RING) * sides.i
    place = (first[:, None] + np.arange(_OF_SIDE)).ravel()
    placed = sparse(1.0, place, np.arange(len(place)), (len(blocks.gradient), len(place)))
    chain, strains = placed @ lines.chain(_OF_SIDE), placed @ by_strains(sides, _OF_SIDE)
    terms = Terms.of(packing, blocks, chain.tocsr(), strains, sides, first)
    g, shift = terms.gradient, first + _SHIFT
    terms.forces = g[shift]

    kA, kP, skin, tension = law.species_parameters(packing.species_radii).of(packing.species)
    for name in ("kA", "kP", "skin", "tension"):
        if name != "tension" or np.isfinite(kP).all():
            terms.parameter(name, (number,), terms.by_local(1.0, of[name], each, number))
    _radii_of_rings(terms, packing, law, of["radii"], shift)

    # with r = R - skin, D = (p - tension/r)/kA and P = 2 pi r + U_tension - D/r the volume is
    # pi r^2 - D + skin P + pi skin^2
    r = packing.radii - skin
    deficit, outer = (g[of["area"]] - tension / r) / kA, 1.0 + skin / r
    by_r = 2.0 * np.pi * packing.radii - outer * tension / (r**2 * kA) + skin * deficit / r**2
    explicit = {
        "radii": by_r,
        "skin": 2.0 * np.pi * packing.radii + g[of["tension"]] - deficit / r - by_r,
        "kA": outer * deficit / kA,
        "tension": outer / (r * kA),
    }
    volume = terms.of_local(-outer / kA, each, of["area"], number)
    volume += terms.of_local(skin, each, of["tension"], number)
    diagonals = {name: diagonal(values) for name, values in explicit.items()}
    terms.quantity("volumes", (number,), volume, explicit=diagonals)
    terms.quantity("pressures", (number,), terms.of_local(1.0, each, of["area"], number))
    force = terms.of_local(1.0, np.arange(count), shift, count)
    turned = terms.by_local(1.0, first + _DIRECTION, np.arange(count), count)
    return with_places(state, terms, force=(force, None), turned=turned)


def _radii_of_rings(
    terms: Terms, packing: Packing, law: Ring, ring: Integers, shift: Integers
) -> None:
    """Radii change rings, at given indentations, and the indentations by lines at given places.

    These are (R_i + R_j - d)/2, at a wall R - h, and from a radical axis R_i - (d^2 + R_i^2 -
    R_j^2)/(2 d), where the change depends on d.

    Args:
        terms: to which they are added.
        packing: the particles.
        law: of them.
        ring: local variable of each particle, shape (N,).
        shift: of each side, shape (S,).
    """
    sides, number, radius = terms.sides, len(packing), packing.radii
    pair, wall = np.flatnonzero(sides.j >= 0), np.flatnonzero(sides.j < 0)
    i, j, d = sides.i[pair], sides.j[pair], sides.distance[pair]
    of_i: Any = 0.5
    of_j: Any = 0.5
    explicit = None
    if law.contact == "radical":
        of_i, of_j = 1.0 - radius[i] / d, radius[j] / d
        steep = (terms.gradient[shift[pair]] / d**3)[:, None] * sides.vector[pair]
        explicit = sum(
            terms.by_local(r[:, None] * steep, terms.vectors[pair], k[:, None], number)
            for r, k in ((radius[i], i), (-radius[j], j))
        )
    local = terms.by_local(1.0, ring, np.arange(number), number)
    local += terms.by_local(of_i, shift[pair], i, number)
    local += terms.by_local(of_j, shift[pair], j, number)
    local += terms.by_local(1.0, shift[wall], sides.i[wall], number)
    terms.parameter("radii", (number,), local, explicit)


def _of_soft_contacts(state: State, law: SoftContact) -> Terms:
    """k o^2/2 of each contact; the derivative by its length is the force."""
    packing = state.packing
    sides, contact, kept = bearing_soft(packing)
    sides, contact = sides.part(kept), contact[kept]
    number, count, variables = len(packing), len(sides.i), packing.dimension + 1
    unit = disk_blocks(sides.vector, sides.turn, contact, sides.axis)
    first = variables * np.arange(count)
    chain, strains = by_centers(sides, number, variables), by_strains(sides, variables)
    terms = Terms.of(packing, Blocks.of(unit, law.k), chain, strains, sides, first)
    length, pair = first + packing.dimension, np.flatnonzero(sides.j >= 0)
    terms.forces = terms.gradient[length]
    by_radii = terms.by_local(1.0, length, sides.i, number)
    by_radii += terms.by_local(1.0, length[pair], sides.j[pair], number)
    terms.parameter("radii", (number,), by_radii)
    explicit = terms.by_local(unit.gradient, np.arange(len(unit.gradient)), 0, 1)
    terms.parameter("k", (), explicit=explicit, energy=unit.energy)
    _volumes_of_radii(packing, terms)
    force = terms.of_local(1.0, np.arange(count), length, count)
    return with_places(state, terms, force=(force, None))


def _volumes_of_radii(packing: Packing, terms: Terms) -> None:
    """Volumes that do not change but with the radii."""
    surface = packing.dimension * volumes(packing.radii, packing.dimension) / packing.radii
    terms.quantity("volumes", (len(packing),), explicit={"radii": diagonal(surface)})


def _of_droplets(state: State, law: Droplet) -> Terms:
    """The dual energy, in which the derivative by an overlap is the force.

    Radii, tensions and adhesions enter by those of droplets, and by the ln(lambda) of each side,
    the contact angle of its film and lambda of that, all of which stay at given local variables.
    """
    found = contacts_of_droplets(state, law, rattlers=False)
    packing, sides, other, droplets = found.packing, found.sides, found.other, found.droplets
    number, count, each = len(packing), len(sides.i), np.arange(len(packing))
    first = SIDE_VARIABLES * np.arange(count)
    blocks = Blocks.of(found.blocks)
    terms = Terms.of(packing, blocks, found.chain, found.strains, sides, first)
    push = first + 3
    terms.forces = found.rows[:, -5]
    _follow_turns(terms, found)

    # of what stays: ln(lambda), angle and lambda of each side, radius and tension of each droplet
    film, angle, lean, radius = np.cumsum([0, count, count, count])
    tension = radius + number
    width = tension + number
    side_column = 2 * np.arange(count) + 2 * sides.i
    last = 2 * np.cumsum(droplets[:, 0].astype(int)) + 2 * each
    place = np.empty(2 * (count + number), int)
    place[side_column], place[side_column + 1] = film + np.arange(count), angle + np.arange(count)
    place[last], place[last + 1] = radius + each, tension + each
    kinds = [(0, place, core.droplet_parameters(droplets, found.rows))]
    if found.stretches is not None:
        of_films, of_caps = found.stretches.parameters()
        wet, kept, caps = found.stretches.wet, found.stretches.kept, found.stretches.caps
        start = SIDE_VARIABLES * count + TURN_VARIABLES * len(found.first)
        in_wet = np.searchsorted(wet, sides.i[kept])
        at, ends = 2 * np.arange(len(kept)) + 2 * in_wet, np.cumsum(np.bincount(in_wet))
        place = np.empty(2 * (len(kept) + len(wet)), int)
        place[at], place[at + 1] = angle + kept, lean + kept
        at = 2 * ends + 2 * np.arange(len(wet))
        place[at], place[at + 1] = radius + wet, tension + wet
        kinds.append((start, place, of_films))
        i, j = sides.i[caps], sides.i[other[caps]]
        place = np.stack([radius + i, radius + j, tension + i, angle + caps], axis=1).ravel()
        kinds.append((start + len(kept) + 2 * len(wet), place, of_caps))
    energy, entries = np.zeros(width), []
    for start, place, (by, (row, column, value)) in kinds:
        np.add.at(energy, place, by)
        entries.append((value, start + row, place[column]))
    values, rows, columns = (np.concatenate(part) for part in zip(*entries, strict=True))
    stays = terms.by_local(values, rows, columns, width)

    ways = _of_films(state, law, found)
    own = np.arange(number)
    R, G = packing.radii, droplets[:, 2]
    i, j = sides.i, sides.i[other]
    of_radii = sparse(1.0, radius + own, own, (width, number))
    of_tension = sparse(1.0, tension + own, own, (width, number))
    side = film + np.arange(count)
    of_radii += sparse(1.0 / (R[i] + R[j]), side, i, (width, number))
    of_radii += sparse(1.0 / (R[i] + R[j]) - 1.0 / R[j], side, j, (width, number))
    of_tension += sparse(-1.0 / (G[i] + G[j]), side, i, (width, number))
    of_tension += sparse(1.0 / G[j] - 1.0 / (G[i] + G[j]), side, j, (width, number))
    for row, slopes in ((angle, ways[:, 0]), (lean, ways[:, 1])):
        at = row + np.arange(count)
        for entry, whose in ((0, i), (2, j)):
            of_radii += sparse(slopes[:, entry], at, whose, (width, number))
        for entry, whose in ((1, i), (3, j)):
            of_tension += sparse(slopes[:, entry], at, whose, (width, number))

    part, force = found.rows[:, 8], terms.forces
    overlap = terms.by_local(part, push, i, number)
    pair = np.flatnonzero(sides.j >= 0)
    overlap += terms.by_local(part[pair], push[pair], j[pair], number)
    work = np.bincount(i, part * force, number) + np.bincount(j[pair], (part * force)[pair], number)
    local, explicit, turned = _turns_by_parameters(terms, found)
    terms.parameter(
        "radii",
        (number,),
        local["radii"],
        stays @ of_radii + overlap + explicit["radii"],
        of_radii.T @ energy + work + turned,
    )
    terms.parameter(
        "tension",
        (number,),
        local["tension"],
        stays @ of_tension + explicit["tension"],
        of_tension.T @ energy,
    )
    if found.stretches is not None:
        kind, kinds_there = packing.species, int(packing.species.max()) + 1
        stuck = np.flatnonzero(found.stuck[:, 0] > 0.0)
        at_wall = other[stuck] == stuck
        for name, at in (("adhesion", stuck[~at_wall]), ("wall_adhesion", stuck[at_wall])):
            if name == "adhesion":
                shape: tuple[int, ...] = (kinds_there, kinds_there)
                low, high = np.sort([kind[i[at]], kind[j[at]]], axis=0)
                column = kinds_there * low + high
            else:
                shape, column = (len(packing.walls),), -1 - sides.j[at]
            size = int(np.prod(shape))
            by = sparse(ways[at, 0, 4], angle + at, column, (width, size))
            by += sparse(ways[at, 1, 4], lean + at, column, (width, size))
            terms.parameter(name, shape, None, stays @ by, by.T @ energy)
    _volumes_of_radii(packing, terms)
    of_force = terms.of_local(1.0, np.arange(count), push, count)
    return with_places(state, terms, force=(None, of_force))


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
    start = SIDE_VARIABLES * len(found.sides.i)
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
    R, G, size = droplets[:, 1], droplets[:, 2], SIDE_VARIABLES * len(sides.i)
    rows = size + TURN_VARIABLES * np.arange(len(first))[:, None] + np.arange(TURN_VARIABLES)
    g, ends = terms.gradient[rows], (sides.i[first], j[first])
    log_damping = np.zeros(number)
    log_damping[sides.i] = np.log(found.facets[:, 3])
    radii = (R[ends[0]] + R[ends[1]])[:, None]
    local, explicit = {}, {}
    of_log = sum(np.bincount(end, g[:, 4], number) for end in ends)
    push = SIDE_VARIABLES * np.arange(len(sides.i)) + 3
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
