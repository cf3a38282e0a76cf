"""Exact foam: a droplet within n equal ones in a regular polygon, each of which rests on a face.

At rest outlines are arcs and lines with common tangents: free arcs have the radius gamma/p, films
the curvature (p_i - p_j)/(2 gamma). By symmetry half a petal is enough, between its axis and the
film that it shares with the next one, at the angle pi/n.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts
from laws import EXACT
from scene import Scene, polygon_walls
from scipy.optimize import fsolve

GAMMA = 0.7
# petals, radius of the droplet in the middle over theirs, packing fraction
FLOWERS = [
    (5, 0.55, 0.93),
    (6, 1.3, 0.95),
    (7, 1.0, 0.95),
    (8, 1.3, 0.97),
]


def direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def area_and_lengths(points, turns):
    """Of a closed path anticlockwise: its piece from each point turns by this angle."""
    points, turns = np.array(points), np.array(turns)
    chords = np.roll(points, -1, axis=0) - points
    chord = np.hypot(*chords.T)
    with np.errstate(invalid="ignore"):
        segments = chord**2 * (turns - np.sin(turns)) / (8 * np.sin(turns / 2) ** 2)
    straight = 0.5 * (points[:, 0] @ chords[:, 1] - points[:, 1] @ chords[:, 0])
    return straight + np.nansum(segments), chord / np.sinc(turns / (2 * np.pi))


@dataclass
class Flower:
    """Foam of these pressures. The free arcs of the middle are about points at `reach` from it."""

    gap: float  # between the petals, zero at rest
    center: float  # of the petal, from the middle
    areas: np.ndarray  # of the middle, and of a petal
    perimeters: np.ndarray
    half_angle: float  # of a film of the middle, positive where it bulges into the petal
    lengths: dict[str, float]  # of contacts
    forces: dict[str, float]

    @classmethod
    def of(cls, n, face, pressure, reach):
        half = np.pi / n
        along, across = direction(half), direction(half + np.pi / 2)
        q = GAMMA / pressure
        curvature = (pressure[0] - pressure[1]) / (2 * GAMMA)
        # the film ends at half a chord s from the axis, in the direction b: sin b = curvature s
        s = reach * np.sin(half) / (1 - curvature * q[0])
        b = np.arcsin(curvature * s)
        end = reach * along + q[0] * direction(b)
        top = end[0] + s * np.tan(b / 2), 0.0
        first = end + q[1] * direction(b)  # the free arcs of the petal are about these two points
        second = (face - q[1] * (1 + np.sin(half))) / np.cos(half) * along - q[1] * across
        sides = [point + q[1] * across for point in (second, first)]
        area, length = zip(
            area_and_lengths(
                [(0.0, 0.0), top, end, (reach + q[0]) * along], [0.0, b, half - b, 0.0]
            ),
            area_and_lengths(
                [(face, 0.0), (face, second[1]), *sides, end, top],
                [0.0, np.pi / 2 + half, 0.0, np.pi / 2 + b - half, -b, 0.0],
            ),
            strict=True,
        )
        flat = {"side": (second - first) @ along, "face": 2 * second[1]}
        return cls(
            gap=first @ across + q[1],
            # mean over the directions of the outline, where arcs go on to the middle of the film
            center=(first[0] * (np.pi / 2 - half) + second[0] * (np.pi / 2 + half)) / np.pi,
            areas=np.array([2 * n, 2]) * area,
            perimeters=np.array([2 * n * length[0][1:3].sum(), 2 * length[1][:5].sum()]),
            half_angle=b,
            lengths={"film": 2 * length[0][1]} | flat,
            # what presses on the chord, less what both ends of the outline pull
            forces={"film": 2 * (pressure[0] * s - GAMMA * np.sin(b))}
            | {name: pressure[1] * each for name, each in flat.items()},
        )


def at_rest(n, radii, face):
    """Pressures and the flower with these areas."""

    def left(unknown):
        flower = Flower.of(n, face, unknown[:2], unknown[2])
        return [flower.gap, *(flower.areas - np.pi * radii**2)]

    start = [*(1.1 * GAMMA / radii), 0.3 * radii[0]]
    found, _, _, why = fsolve(left, start, xtol=1e-14, full_output=True)
    assert np.abs(left(found)).max() < 1e-13, why
    return found[:2], Flower.of(n, face, found[:2], found[2])


@pytest.mark.parametrize(("n", "middle", "phi"), FLOWERS)
def test_flower(n, middle, phi, tmp_path):
    """At rest: energy, pressures and every contact."""
    radii, turn = np.array([middle, 1.0]), 0.1
    face = np.sqrt(np.pi * (middle**2 + n) / (n * np.tan(np.pi / n) * phi))
    pressure, flower = at_rest(n, radii, face)

    (tmp_path / "species").write_text(
        f"# UNITS: lj\nmiddle {middle} inf 0 tension {GAMMA}\npetal 1.0 inf 0 tension {GAMMA}\n"
    )
    petals = flower.center * direction(turn + 2 * np.pi * np.arange(n) / n).T
    scene = Scene(
        [[0.0, 0.0], *petals],
        ["middle"] + n * ["petal"],
        (-2 * face, 2 * face, -2 * face, 2 * face),
        EXACT["curved"],
        coeff=f"pair_coeff * * {tmp_path / 'species'} middle petal",
        boundary="f f p",
        commands=polygon_walls(n, face, turn) + CONTACTS,
    )
    state = scene.evaluate()
    energy = GAMMA * np.array([1, n]) @ (flower.perimeters - 2 * np.pi * radii)
    largest = max(flower.forces.values())
    np.testing.assert_allclose(state.force, 0, rtol=0, atol=1e-10 * largest)
    assert state.energy == pytest.approx(energy, rel=1e-11)
    np.testing.assert_allclose(state.shape["pressure"], pressure[[0] + n * [1]], rtol=1e-9)
    np.testing.assert_allclose(
        state.shape["perimeter"], flower.perimeters[[0] + n * [1]], rtol=1e-9
    )

    seen = contacts(scene)
    atom, partner = seen["atom"], seen["partner"]
    first = np.minimum(atom, partner)
    rows = {"film": first == 1, "side": first > 1, "face": first < 0}
    for name, its in rows.items():
        assert its.sum() == (n if name == "face" else 2 * n)
        np.testing.assert_allclose(seen["force"][its], flower.forces[name], rtol=1e-9)
        np.testing.assert_allclose(seen["length"][its], flower.lengths[name], rtol=1e-9)
        sign = np.where(atom == 1, 1, -1)[its] * (name == "film")
        np.testing.assert_allclose(
            seen["half_angle"][its], sign * flower.half_angle, rtol=0, atol=1e-10
        )
    assert (np.abs(flower.half_angle) > 0.03) == (n != 6)
