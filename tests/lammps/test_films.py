"""Contacts that stick: closed forms, memory, what is lost where films come and go."""

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts
from derivatives import assert_forces
from laws import EXACT
from scene import Scene, polygon_walls
from scipy.optimize import fsolve

BOX = (-5, 5, -5, 5)
# radius of the second droplet, w, energy and force at touch, distance of pull-off
DOUBLETS = [
    (1.0, 0.1, -0.0324704035, -0.1986160424, 2.2360),
    (1.0, 0.3, -0.1334220180, -0.5838445247, 2.2872),
    (1.4, 0.3, -0.1579199896, -0.5713620922, None),
]
doublets = pytest.mark.parametrize(("radius", "w", "energy", "force", "pull_off"), DOUBLETS)


def droplets(x, folder, w, radii=(1.0,), box=BOX, style=EXACT["curved"], kind="inf 0", **options):
    """Droplets of tension 1; all pairs have the adhesion w. radii: by particle, or one for all."""
    radii = np.broadcast_to(radii, len(x))
    kinds = list(dict.fromkeys(radii))
    lines = [f"drop{n} {radius} {kind} tension 1" for n, radius in enumerate(kinds)]
    lines += [
        f"adhesion drop{a} drop{b} {w}" for a in range(len(kinds)) for b in range(a, len(kinds))
    ]
    (folder / "species").write_text("\n".join(["# UNITS: lj", *lines, ""]))
    names = [f"drop{kinds.index(radius)}" for radius in radii]
    coeff = f"pair_coeff * * {folder / 'species'} {' '.join(dict.fromkeys(names))}"
    return Scene(np.asarray(x, float), names, box, style, coeff=coeff, **options)


def doublet(distance, folder, w, radius=1.0, **options):
    return droplets([[0, 0], [distance, 0]], folder, w, (1.0, radius), **options)


def test_an_adhesion_that_leaves_no_room_is_named(tmp_path):
    """Six films of an angle of 60 degrees, 2 theta, need two turns."""
    angle = np.arange(6) * np.pi / 3
    ring = 1.9 * np.column_stack([np.cos(angle), np.sin(angle)])
    scene = droplets([[0, 0], *ring], tmp_path, 1.0)
    told = "Atom 1 has no shape that keeps its area: its 6 contacts of adhesion 1 leave no room. "
    told += (
        "Begin with .minimize., which makes room, take a smaller adhesion, compress less, or give"
    )
    with pytest.raises(Exception, match=told):
        scene.energy()


def pair_at(distance):
    return np.array([[0, 0], [distance, 0.0]])


def double_bubble(radius, w):
    """Energy, film and distance at rest: three arcs that meet at Neumann's angles."""
    areas, theta = np.pi * np.array([1.0, radius**2]), np.arccos(1 - 0.5 * w)

    def shape(unknown):
        q, beta = unknown[:2], unknown[2]
        alpha = theta + np.array([beta, -beta])
        half = q * np.sin(alpha)  # of the chord, from both sides
        arc = beta / np.sin(beta) if beta else 1.0
        segment = half.mean() ** 2 * (arc - np.cos(beta)) / np.sin(beta) if beta else 0.0
        area = q**2 * (np.pi - alpha + np.sin(alpha) * np.cos(alpha)) + [segment, -segment]
        return area, half, 2 * half.mean() * arc, 2 * q * (np.pi - alpha), q * np.cos(alpha)

    def left(unknown):
        area, half, *_ = shape(unknown)
        return [*(area - areas), half[0] - half[1]]

    found = fsolve(left, [1.1, 1.1 * radius, 0.1 * (radius - 1)], xtol=1e-14)
    assert np.abs(left(found)).max() < 1e-12
    # the curvature of the film is that of the pressures
    _, half, film, free, heights = shape(found)
    p = 1 / found[:2]
    assert np.sin(found[2]) / half[0] == pytest.approx((p[0] - p[1]) / (2 - w), abs=1e-12)
    return (2 - w) * film + np.sum(free) - 2 * np.pi * (1 + radius), film, np.sum(heights)


@pytest.mark.parametrize(("radius", "w"), [(1.0, 0.1), (1.4, 0.1), (2.0, 0.3)])
def test_two_droplets_at_rest(radius, w, tmp_path):
    energy, film, distance = double_bubble(radius, w)
    scene = doublet(distance, tmp_path, w, radius, commands=CONTACTS)
    state = scene.evaluate()
    assert state.energy == pytest.approx(energy, rel=1e-10)
    assert np.abs(state.force).max() < 1e-9
    assert state.atom_energy.sum() == pytest.approx(energy, rel=1e-10)
    seen = contacts(scene)
    np.testing.assert_allclose(seen["length"], film, rtol=1e-9)
    np.testing.assert_allclose(np.cos(seen["contact_angle"]), 1 - 0.5 * w, rtol=1e-12)
    assert (seen["attached"] == 1).all()


@doublets
def test_two_droplets_at_touch_and_at_pull_off(radius, w, energy, force, pull_off, tmp_path):
    """They attach at touch; pulled, they let go where T sin theta of both is all the force."""
    touch = 1 + radius
    scene = doublet(touch + 1e-6, tmp_path, w, radius)
    assert scene.energy() == 0.0
    state = scene.evaluate(pair_at(touch - 1e-10))
    assert state.energy == pytest.approx(energy, abs=2e-10)
    assert -state.force[0, 0] == pytest.approx(force, abs=2e-10)
    assert scene.energy(pair_at(touch + 1e-6)) == pytest.approx(energy, abs=1e-6)

    low, high = touch, touch + 0.5
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        scene.energy(pair_at(touch - 1e-3))
        held = scene.evaluate(pair_at(middle)).force[0, 0]
        low, high = (middle, high) if held else (low, middle)
    if pull_off:
        assert low == pytest.approx(pull_off, abs=5e-5)
    scene.energy(pair_at(touch - 1e-3))
    held = scene.evaluate(pair_at(low)).force[0, 0]
    # f falls like the root of the distance that is left
    assert held == pytest.approx(2 * np.sqrt(w - 0.25 * w**2), rel=1e-6)
    assert scene.energy(pair_at(high)) == 0.0
    assert scene.energy(pair_at(touch + 1e-6)) == 0.0


# faces, how far they press, w, energy, force, length, pressure: MODEL 14
FACES = [
    (2, 0.0, 0.05, -0.0357811232644, -0.139189071047, 0.510853398729, 0.95),
    (2, 0.05, 0.15, -0.200373559724, -0.242639140709, 0.906329320997, 0.894736842105),
    (4, 0.02, 0.1, -0.193249757169, -0.447523964077, 0.614828946459, 0.690038793838),
    (6, 0.03, 0.05, -0.126800987297, -0.0130721741832, 0.631829083838, 0.967710479458),
]


@pytest.mark.parametrize(("n", "a", "w", "energy", "force", "length", "pressure"), FACES)
def test_a_droplet_between_walls(n, a, w, energy, force, length, pressure, tmp_path):
    """Attached to each face, also to those that it does not reach by itself."""
    walls = polygon_walls(n, 1.0 - a).rstrip() + f" adhesion {w}\n"
    film = "fix_modify deformable_films attached " + " ".join(f"1 {-1 - 256 * k}" for k in range(n))
    scene = droplets([[0, 0]], tmp_path, 1e-9, commands=walls + CONTACTS, boundary="f f p")
    scene.run("run 0 post no\n" + film)
    state = scene.evaluate()
    seen = contacts(scene)
    assert len(seen["length"]) == n
    assert state.energy == pytest.approx(energy, rel=1e-10)
    np.testing.assert_allclose(seen["force"], force, rtol=1e-10)
    np.testing.assert_allclose(seen["length"], length, rtol=1e-10)
    assert state.shape["pressure"] == pytest.approx([pressure], rel=1e-11)
    assert (seen["attached"] < 0).all()


# the circles of all three pairs overlap by 0.05
THREE = np.array([[0, 0], [2.15, 0.0], [0.8936, 1.6199]])


@pytest.mark.parametrize("kind", ["inf 0", "20 0.5"])
def test_forces_before_and_after_films_go(kind, tmp_path):
    """Minus the gradient of the energy: touching, stretched, and where one pair has let go."""
    scene = droplets(THREE, tmp_path, 0.3, (1.0, 1.2, 0.9), kind=kind, commands=CONTACTS)
    attached = []
    for stretch in (1.0, 1.04, 1.3):
        scene.energy(stretch * THREE)
        # energies are known to 1e-12 of the pull that tears films off
        assert_forces(scene, stretch * THREE, 1e-5)
        attached.append(len(contacts(scene)["attached"]))
    assert attached[0] == attached[1] == 6
    assert attached[2] == 0


def test_a_film_near_the_limit_is_held_and_counted(tmp_path):
    """w = 1.99 T would leave 1 % of the tension to the film's own: the angle is that of 1.96 T."""
    for w, held in ((1.9, 0), (1.99, 1)):
        scene = doublet(0.3, tmp_path, w, commands=CONTACTS)  # nearly merged
        angle = contacts(scene)["contact_angle"]
        np.testing.assert_allclose(np.cos(angle), 1 - 0.5 * min(w, 1.96), rtol=0, atol=1e-12)
        assert scene.vector("pair", 6)[4] == held
