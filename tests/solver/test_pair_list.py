"""Near pairs, each once, for as long as the list says; and what is remembered of them."""

from itertools import product

import numpy as np
import pytest
from lammps import lammps
from parts import parts

SMALLEST, MARGIN = 0.4, 0.1  # radius; Tuning::margin
UNKNOWN = [[-1e300, 0, 0, 0]] * 3

SCRIPT = """
units lj
dimension {dimension}
atom_style sphere
atom_modify map yes sort 1 0.7
newton off
region box prism 0 {lx} 0 {ly} {bottom} {top} {tilt} 0 0
create_box 1 box
{atoms}
set group all mass 1.0
pair_style zero 1.7
pair_coeff * *
neighbor 0.3 bin
"""
# of the first fix: sides, of the second one: an obstacle; and the codes of their features
WALLS = [["xlo", "0", "ylo", "0"], ["disk", "1.4", "1.5", "0.2"]]
HEIGHTS = {
    -1: lambda x: x[:, 0],
    -257: lambda x: x[:, 1],
    -2: lambda x: np.hypot(x[:, 0] - 1.4, x[:, 1] - 1.5) - 0.2,
}


class Particles:
    """Some are near to several images of another one, or of themselves: the box is small."""

    def __init__(self, *box, tilt=0.0, places=None, walls=()):
        self.random, self.dimension = np.random.default_rng(len(box)), len(box)
        lx, ly, *lz = box
        self.edges = np.diag(box)
        self.edges[1, 0] = tilt
        if places is None:
            places = self.random.random((8, self.dimension)) @ self.edges
        self.bulge = np.zeros(len(places))  # by tag
        atoms = "\n".join(
            f"create_atoms 1 single {' '.join(map(str, [*x, 0][:3]))}\n"
            f"set atom {i} diameter {self.random.uniform(2 * SMALLEST, 1.2)}"
            for i, x in enumerate(places.tolist(), 1)
        )
        bottom, top = (0, lz[0]) if lz else (-0.5, 0.5)
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(
            SCRIPT.format(
                dimension=len(box), lx=lx, ly=ly, tilt=tilt, bottom=bottom, top=top, atoms=atoms
            )
        )
        self.list = parts.PairList(self.lmp, True, SMALLEST, 0.5, list(walls), f"margin={MARGIN}")

    def run(self, commands):
        """Then the neighbor list is new."""
        self.lmp.commands_string(f"{commands}\nrun 0")

    def atoms(self, name):
        """In the order of LAMMPS, which changes."""
        return self.lmp.numpy.extract_atom(name)[: self.lmp.extract_global("nlocal")]

    def by_tag(self, name):
        return self.atoms(name)[np.argsort(self.atoms("id"))]

    def set_bulges(self, bulge):
        self.bulge = np.array(bulge)
        self.list.set_bulges(self.bulge[self.atoms("id") - 1])

    def move(self, tag, by):
        """One particle; the neighbor list stays."""
        self.atoms("x")[self.atoms("id") == tag, : len(by)] += by

    def near(self, margin):
        """Tags and image of the pairs whose gap beyond bulges is at most a margin, each once."""
        x, reach = self.by_tag("x")[:, : self.dimension], self.by_tag("radius") + self.bulge
        images = np.array(list(product(range(-3, 4), repeat=self.dimension)))
        apart = (x - x[:, None])[:, :, None] + images @ self.edges
        gap = np.linalg.norm(apart, axis=-1) - (reach + reach[:, None])[:, :, None]
        near = np.argwhere(gap <= margin).tolist()
        found = {(i + 1, j + 1, *images[n].tolist()) for i, j, n in near}
        return {pair for pair in found if pair < self.back(*pair)}

    @staticmethod
    def back(i, j, *image):
        """The same pair, from its other side."""
        return j, i, *(-n for n in image)

    def found(self):
        x, pairs = self.by_tag("x")[:, : self.dimension], []
        for i, j, d, _ in self.list.pairs[: self.list.segments[1]]:
            away = (d[: self.dimension] - x[j - 1] + x[i - 1]) @ np.linalg.inv(self.edges)
            assert np.abs(away - away.round()).max() < 1e-9
            pair = i, j, *away.round().astype(int).tolist()
            pairs.append(min(pair, self.back(*pair)))
        return pairs


SCENES = {"plane": (1.1, 2.3), "tilted": (1.3, 2.3), "space": (1.9, 1.1, 1.5)}


@pytest.fixture(params=SCENES)
def particles(request):
    return Particles(*SCENES[request.param], tilt=0.5 if request.param == "tilted" else 0.0)


def test_all_near_pairs_once(particles):
    """Also where outlines bulge."""
    for bulge in (0.0, 0.2):
        particles.list.build(bulge == 0)
        found = particles.found()
        assert len(found) == len(set(found))
        assert set(found) == particles.near(MARGIN * SMALLEST)
        assert particles.list.segments == (len(found),) * 3
        assert len({pair[:2] for pair in found}) < len(found)  # several images
        particles.set_bulges(particles.random.uniform(0, 0.2, 8))


def test_a_list_is_sufficient_as_long_as_it_says(particles):
    """For all pairs that may touch, whatever has moved or grown."""
    ended = 0
    for build in range(5):
        particles.list.build(build == 0)
        found, random = set(particles.found()), particles.random
        for _ in range(40):
            particles.move(random.integers(1, 9), random.normal(0, 0.003, particles.dimension))
            particles.set_bulges(particles.bulge + random.uniform(0, 0.001, 8))
            if not particles.list.is_sufficient():
                ended += 1
                break
            assert particles.near(0) <= found
    assert ended == 5


@pytest.mark.parametrize(
    ("move", "growth", "of", "sufficient"),
    [
        (0.49, 0, 1, True),
        (0.51, 0, 1, False),
        (0, 0.49, 1, True),
        (0, 0.51, 1, False),
        (0.3, 0.3, 1, False),
        (0.3, 0.3, 2, True),
        (-0.51, 0, 1, False),
        (0.3, -0.3, 1, True),
    ],
)
def test_half_of_the_margin(move, growth, of, sufficient):
    """For the move and the growth of a particle together."""
    particles = Particles(1.1, 2.3)
    particles.list.build(True)
    particles.set_bulges(np.full(8, 0.1))
    particles.list.build(False)
    particles.move(1, [0, move * MARGIN * SMALLEST])
    bulge = np.full(8, 0.1)
    bulge[of - 1] += growth * MARGIN * SMALLEST
    particles.set_bulges(bulge)
    assert particles.list.is_sufficient() == sufficient


@pytest.mark.parametrize(("longer", "sufficient"), [(1e-4, True), (0.5, False)])
def test_a_box_that_changes(longer, sufficient):
    """Moves images, but no particle of its own."""
    particles = Particles(1.1, 2.3)
    particles.list.build(True)
    particles.lmp.command(f"change_box all x final 0 {1.1 + longer * MARGIN * SMALLEST}")
    assert particles.list.is_sufficient() == sufficient


def past_of(number):
    """Of all kinds, in numbers that single precision has."""
    return [[n, n + 0.25, n + 0.5, n + 0.75] for n in range(number, number + 3)]


def from_second(past):
    """As the second particle sees it: bends have the other sign."""
    force, tilt, bend = past
    return [force, tilt, [-x for x in bend]]


def test_what_was_known_is_found_again(particles):
    """After particles have other indices, images and sides; of new pairs nothing is known."""
    of = particles.list
    of.build(True)
    assert all(past == UNKNOWN for past in of.past)
    of.past = [past_of(k) for k in range(1, of.segments[2] + 1)]
    before = of.past
    of.build(False)
    assert of.past == before
    known, order = {}, particles.atoms("id").copy()
    for (i, j, d, _), past in zip(of.pairs, before, strict=True):
        known.setdefault((i, j), []).append((np.array(d), past))
        known.setdefault((j, i), []).append((-np.array(d), from_second(past)))
    particles.move(3, [0.6, 0.6])
    particles.run("displace_atoms all move 0.5 1.1 0\ndisplace_atoms all random 0.02 0.02 0 4711")
    assert (particles.atoms("id") != order).any()
    of.build(True)
    found = []
    for (i, j, d, _), past in zip(of.pairs, of.past, strict=True):
        images = [(np.linalg.norm(x - d), old) for x, old in known.get((i, j), [])]
        near = [image for image in images if image[0] <= np.linalg.norm(d)]
        assert past == (min(near)[1] if near else UNKNOWN)
        found.append(past)
    assert UNKNOWN in found
    assert any(past[2][0] > 0 for past in found)
    assert any(past != UNKNOWN and past[2][0] < 0 for past in found)


def test_walls():
    """Each near feature of a wall is a pair of its own, and is known by its code."""
    grid = 0.4 + 0.72 * np.indices((4, 4)).reshape(2, -1).T
    places = grid + np.random.default_rng(1).uniform(0, 0.05, grid.shape)
    particles = Particles(3.0, 3.0, places=places, walls=WALLS)
    of, x, radius = particles.list, particles.by_tag("x"), particles.by_tag("radius")
    of.build(True)
    wall, size = of.segments[1:]
    found = {(i, code): overlap for i, code, _, overlap in of.pairs[wall:]}
    expected = {}
    for code, height in HEIGHTS.items():
        for i in np.flatnonzero(height(x) <= radius + MARGIN * SMALLEST):
            expected[i + 1, code] = (radius - height(x))[i]
    assert found == pytest.approx(expected)
    assert size - wall == len(found) > 6
    of.past = [past_of(k) for k in range(1, of.segments[2] + 1)]
    for new_list in (False, True):
        before = past_of_walls(of)
        particles.move(3, [0.01, 0.01])
        if new_list:
            particles.run("")
        of.build(new_list)
        assert past_of_walls(of) == before


def past_of_walls(of):
    pairs = zip(of.pairs, of.past, strict=True)
    return {(i, code): past for (i, code, *_), past in pairs if code < 0}


def test_history():
    """By the image that is nearest, from either particle; by the code of a wall; bulges by tag."""
    history = parts.PairHistory()
    images = [(0.9, 0.1, 0.0), (-0.9, 0.1, 0.0), (0.9, 0.1, 0.4)]
    for k, x in enumerate(images):
        history.add(4, 9, x, past_of(k + 1))
    history.add(12, 4, images[0], past_of(5))
    history.add(4, -3, (0, 0, 0), past_of(6))
    history.add(4, -1, (0, 0, 0), past_of(7))
    for tag in (9, 4):
        history.add_bulge(tag, 0.1 * tag)
    history.sort()
    for k, x in enumerate(images):
        near = np.array(x) + 0.05
        assert history.find(4, 9, near) == past_of(k + 1)
        assert history.find(9, 4, -near) == from_second(past_of(k + 1))
    assert history.find(4, 12, (-0.9, -0.1, 0)) == from_second(past_of(5))
    assert history.find(4, -3, (0, 0, 0)) == past_of(6)
    assert history.find(4, -1, (0, 0, 0)) == past_of(7)
    for tag, partner, x in [(4, 9, (0, -0.4, 0)), (4, 10, images[0]), (9, -1, (0, 0, 0))]:
        assert history.find(tag, partner, x) == UNKNOWN
    assert [history.bulge(tag) for tag in (3, 4, 9)] == [-1.0, 0.4, 0.9]
