"""What ranks tell each other of pairs that they share. Ends with an error at the first fault."""

import random

import numpy as np
from mpi4py import MPI
from parts import LMP, parts

WORLD = MPI.COMM_WORLD
RANK, RANKS = WORLD.rank, WORLD.size
REACH, UNKNOWN = 1.2, [[-1e300, 0, 0, 0]] * 3

# a box that is cut along x only; so narrow that some pairs have two images with the same rank
SCRIPT = """
clear
units lj
dimension 2
newton off
atom_modify map yes
processors {ranks} 1 1
region box block 0 6 0 1.5 -0.5 0.5
create_box 1 box
region filled block 0 {filled} EDGE EDGE EDGE EDGE
create_atoms 1 random 40 4711 filled
mass 1 1.0
pair_style zero {reach}
pair_coeff * *
run 0
"""


def number(*key):
    """A random one for this key, the same on all ranks."""
    return random.Random(str(key)).random()


def from_second(past):
    """As the second particle sees it: bends have the other sign."""
    force, tilt, (bend, *earlier) = past
    return [force, tilt, [bend if bend == UNKNOWN[2][0] else -bend, *(-n for n in earlier)]]


def back(i, j, d):
    """The same pair, from its other side."""
    return j, i, (-d[0], -d[1])


def shared():
    """Key and candidate of each pair of a particle here and one that is elsewhere."""
    here = LMP.extract_global("nlocal")
    tag = LMP.numpy.extract_atom("id", nelem=here + LMP.extract_global("nghost")).tolist()
    x = LMP.numpy.extract_atom("x", nelem=len(tag))
    owner = {t: rank for rank, tags in enumerate(WORLD.allgather(tag[:here])) for t in tags}
    for i in range(here):
        for j in range(here, len(tag)):
            d = x[j] - x[i]
            if owner[tag[j]] != RANK and np.linalg.norm(d) < REACH:
                key = tag[i], tag[j], tuple((np.round(d[:2], 6) + 0.0).tolist())
                yield key, (i, j, owner[tag[j]], d)


def past(key):
    """As one side knows it; not every one does."""
    if number("known", key) < 0.4:
        return UNKNOWN
    return [[number(key, kind, n) for n in range(4)] for kind in range(3)]


def check(filled):
    LMP.commands_string(SCRIPT.format(ranks=RANKS, filled=filled, reach=REACH))
    remote = parts.RemoteSides(LMP)
    candidates = {key: candidate for key, candidate in shared() if number("left out", key) > 0.1}
    matched = remote.match([(*candidate, past(key)) for key, candidate in candidates.items()])

    # those that the other rank has, too, in their order; both sides have the same past
    everywhere = {key for keys in WORLD.allgather(list(candidates)) for key in keys}
    kept = [key for key in candidates if back(*key) in everywhere]
    assert [of[:3] for of in matched] == [candidates[key][:3] for key in kept]
    for key, found in zip(kept, matched, strict=True):
        own, other = past(key), past(back(*key))
        assert found[4] == (own if own != UNKNOWN else from_second(other))

    # what is at the contacts of one side arrives at the other one; twice, in two arrays
    contacts = random.sample(range(3 * len(kept)), len(kept))
    for call in range(2):
        values = np.zeros((2, 3 * len(kept)))
        for key, contact in zip(kept, contacts, strict=True):
            values[:, contact] = number(call, key), number(call, "single", key)
        double, single = remote.exchange(contacts, *values.tolist())
        assert double == [number(call, back(*key)) for key in kept]
        assert single == [np.float32(number(call, "single", back(*key))) for key in kept]

    # numbers of all ranks, and of particles for their ghosts
    assert remote.sum(2.0**RANK) == 2**RANKS - 1
    assert remote.largest(-RANK) == 0
    for worst in range(RANKS):
        assert remote.all_ranks_sufficient(True, False) == (True, False)
        assert remote.all_ranks_sufficient(worst != RANK, False) == (False, False)
        assert remote.all_ranks_sufficient(True, worst == RANK) == (False, True)
    here = LMP.extract_global("nlocal")
    tag = LMP.numpy.extract_atom("id", nelem=here + LMP.extract_global("nghost")).tolist()
    assert remote.to_ghosts([number(t) for t in tag[:here]]) == [number(t) for t in tag]
    return kept, candidates


for filled in (6, 2.9):
    kept, candidates = check(filled)
    if RANKS > 1 and filled == 6:
        assert len(candidates) > len(kept) > 20
        assert len({key[:2] for key in kept}) < len(kept)  # two images
    empty = [here == 0 for here in WORLD.allgather(LMP.extract_global("nlocal"))]
    assert any(empty) == (RANKS > 1 and filled < 6)
if RANK == 0:
    print(f"{RANKS} ranks")
