"""Particles in batches against the laws for one particle, at each level of SIMD instructions."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from lammps_deformable import core, core_for_tests

LEVELS = core.simd_levels()
OUTPUTS = ("energy", "pressure", "area_deficit", "perimeter_excess", "arc_radius", "force")


@dataclass(frozen=True)
class Particles:
    """Many particles, each with its partners at random places around it."""

    contacts: np.ndarray
    dx: np.ndarray
    dy: np.ndarray
    partner_radius: np.ndarray
    radius: np.ndarray
    kA: np.ndarray
    kP: np.ndarray
    skin: np.ndarray
    tension: np.ndarray

    def shaped(self, law, level):
        return core_for_tests.batch(
            law, level, **{f: getattr(self, f) for f in self.__dataclass_fields__}
        )


def particles(seed, n=400, least=0, most=7, overlap=(-0.05, 0.12), spread=0.8, scale=1.0, turns=1):
    """Contacts at almost equal spacing; overlaps in units of R_i + R_j, some of them negative. With
    two turns, contacts come in pairs of one direction."""
    rng = np.random.default_rng(seed)
    contacts = turns * rng.integers(least, most + 1, n)
    radius = scale * rng.uniform(0.3, 1.5, n)
    z = np.repeat(contacts, contacts)
    step = np.concatenate([np.arange(k) for k in contacts]).astype(float)
    angle = np.repeat(rng.uniform(-np.pi, np.pi, n), contacts)
    angle += turns * 2 * np.pi * (step + spread * rng.uniform(-0.5, 0.5, len(z))) / np.maximum(z, 1)
    mine = np.repeat(radius, contacts)
    partner = mine * rng.uniform(0.7, 1.4, len(z))
    distance = (mine + partner) * (1 - rng.uniform(*overlap, len(z)))
    return Particles(
        contacts,
        distance * np.cos(angle),
        distance * np.sin(angle),
        partner,
        radius,
        10.0 ** rng.uniform(-3, 3, n),
        np.full(n, np.inf),
        np.zeros(n),
        np.zeros(n),
    )


def mixture(seed, area_conserved=False, **options):
    """Stiffness over decades, kP infinite for a quarter, skins for half of the particles."""
    some = particles(seed, **options)
    rng = np.random.default_rng(seed)
    n = len(some.radius)
    kind = rng.integers(0, 4, n)
    return replace(
        some,
        kA=np.where((kind == 1) & area_conserved, np.inf, some.kA),
        kP=np.where(kind == 0, np.inf, 10.0 ** rng.uniform(-3, 3, n)),
        skin=rng.uniform(0, 0.2, n) * some.radius * (rng.random(n) < 0.5),
    )


def tense(seed, **options):
    """A quarter each of a mixture, droplets, droplets of finite kP, and bubbles of finite kA."""
    some = mixture(seed, **options)
    rng = np.random.default_rng(seed)
    n = len(some.radius)
    kind, r = rng.integers(0, 4, n), some.radius - some.skin
    kA = np.select([kind == 0, kind == 3], [some.kA, 10.0 ** rng.uniform(-3, 3, n)], np.inf)
    kP = np.select([kind == 0, kind == 1], [some.kP, 0.0], 10.0 ** rng.uniform(-3, 3, n))
    most = np.where(kind == 3, np.pi * r * (kP + kA * r**2), 1.0)  # half of what is stable
    return replace(some, kA=kA, kP=kP, tension=(kind > 0) * most * 10.0 ** rng.uniform(-3, 0, n))


# the case, and whether all particles with eight contacts at most must come out of batches
RINGS = {
    "usual": (lambda seed: particles(seed), True),
    "mixture": (lambda seed: mixture(seed, overlap=(-0.05, 0.03)), True),
    "past confluence": (lambda seed: mixture(seed, overlap=(-0.02, 0.25)), False),
    "area": (lambda seed: mixture(seed, True, overlap=(-0.02, 0.01)), True),
    "tension": (lambda seed: tense(seed, overlap=(-0.02, 0.01)), True),
    "tension, small": (lambda seed: tense(seed, scale=1e-6, overlap=(-0.02, 0.01)), False),
    "tension, barely": (lambda seed: tense(seed, overlap=(-1e-8, 1e-8)), False),
    "more contacts": (lambda seed: mixture(seed, most=12, overlap=(-0.02, 0.05)), False),
    "close directions": (lambda seed: mixture(seed, spread=2.5), False),
    "same direction": (lambda seed: mixture(seed, spread=0.0, turns=2), False),
    "barely touching": (lambda seed: mixture(seed, overlap=(-1e-8, 1e-8)), False),
    "small": (lambda seed: mixture(seed, scale=1e-6), False),
    "few": (lambda seed: mixture(seed, n=3), False),
}
SECTORS = {
    "usual": (dict(overlap=(1e-3, 0.12), least=2), True),
    "more contacts": (dict(overlap=(1e-3, 0.05), least=2, most=12), False),
    "close directions": (dict(overlap=(1e-3, 0.05), least=2, spread=1.8), False),
    "barely touching": (dict(overlap=(1e-12, 1e-8), least=2), True),
    "small": (dict(overlap=(1e-3, 0.12), least=2, scale=1e-6), True),
}


def assert_agree(law, some, most_in_batches):
    """Batches do the same operations in the same order as the law for one particle.

    The compiler may contract products and sums of the latter only: the tolerance is that of such a
    difference, enlarged by the condition of nearly coinciding contacts. All levels agree to the
    last bit.
    """
    found, expected = some.shaped(law, LEVELS[0]), some.shaped(law, "one")
    for name in OUTPUTS:
        values, reference = getattr(found, name), getattr(expected, name)
        # of contacts and areas on the scale of all, because they may cancel
        scale = np.abs(reference) if name in ("energy", "pressure") else np.abs(reference).max()
        assert np.all(np.abs(values - reference) <= 1e-11 * scale), name
    if most_in_batches:
        assert found.one_by_one <= 0.1 * len(some.radius)
    for level in LEVELS[1:]:
        other = some.shaped(law, level)
        for name in OUTPUTS:
            np.testing.assert_array_equal(getattr(other, name), getattr(found, name), level)


@pytest.mark.parametrize("case", RINGS)
def test_ring(case):
    draw, most_in_batches = RINGS[case]
    for seed in range(6):
        assert_agree("ring", draw(seed), most_in_batches)


@pytest.mark.parametrize("case", SECTORS)
def test_sector(case):
    options, most_in_batches = SECTORS[case]
    for seed in range(6):
        assert_agree("sector", particles(seed, **options), most_in_batches)


@pytest.mark.parametrize(
    ("law", "level"), [("ring", LEVELS[-1]), ("sector", "one"), ("sector", LEVELS[-1])]
)
def test_forces_are_derivatives(law, level):
    some = particles(3, n=40, overlap=(1e-3, 0.1), least=2)
    force = some.shaped(law, level).force
    step = 1e-6
    for axis, name in enumerate(("dx", "dy")):
        for c in range(len(some.dx)):
            energy = []
            for sign in (1, -1):
                moved = getattr(some, name).copy()
                moved[c] += sign * step
                energy.append(replace(some, **{name: moved}).shaped(law, level).energy.sum())
            slope = (energy[0] - energy[1]) / (2 * step)
            # the force on the particle is minus that on the partner, -dU/dx
            assert force[c, axis] == pytest.approx(slope, abs=2e-7 * np.abs(force).max())


def test_a_result_does_not_depend_on_its_batch():
    some = mixture(5, n=50)
    together = some.shaped("ring", LEVELS[-1])
    first = np.concatenate([[0], np.cumsum(some.contacts)])
    for i in range(len(some.radius)):
        at = slice(first[i], first[i + 1])
        alone = Particles(
            *(
                getattr(some, name)[
                    at if name in ("dx", "dy", "partner_radius") else slice(i, i + 1)
                ]
                for name in some.__dataclass_fields__
            )
        ).shaped("ring", LEVELS[-1])
        assert alone.energy[0] == together.energy[i]
        np.testing.assert_array_equal(alone.force, together.force[at])


def test_refusals():
    good = particles(1)
    with pytest.raises(ValueError, match="disk"):
        good.shaped("disk", "plain")
    with pytest.raises(ValueError, match="sse9"):
        good.shaped("ring", "sse9")
    with pytest.raises(ValueError, match="contacts"):
        replace(good, contacts=good.contacts[:-1]).shaped("ring", "plain")
    with pytest.raises(ValueError, match="kA"):
        replace(good, kA=good.kA[:-1]).shaped("ring", "plain")
    behind = replace(good, dx=good.dx * 0.1, dy=good.dy * 0.1)
    for level in [*LEVELS, "one"]:
        with pytest.raises(ValueError, match="center"):
            behind.shaped("ring", level)
    coincident = particles(1, least=2, overlap=(1e-3, 0.05), spread=0.0, turns=2)
    for level in [*LEVELS, "one"]:
        with pytest.raises(ValueError, match="same direction"):
            coincident.shaped("sector", level)
