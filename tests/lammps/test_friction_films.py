"""Films that drag their sides against each other: closed forms, stability at rest, words."""

import numpy as np
import pytest
from grains import Grains
from laws import RING_LAWS, two_laws
from test_friction import BIG, cloud
from test_friction_space import Balls
from test_refusals import refuses
from turns import in_turn

STILL = "fix move all nve"  # no spins
FILMS = 6  # of the outputs, from 0


@pytest.mark.parametrize(("law", "power"), [*in_turn(RING_LAWS, [1.0, 0.5, 0.5]), ("space", 0.5)])
def test_two_droplets_that_drag_each_other(law, power, tmp_path):
    """By dv/dt = -2 c S v^n: exponential, or to a stop at v^(1-n)/(2 (1-n) c S)."""
    speed, dt, box = 1e-4, 1e-4, (-1.96, 1.96, -4, 4)  # they touch on both sides
    c = 8.0 if power == 1.0 else 0.5
    words, v = f"0 0 0 film {c} {power}", np.array([[0, 0.5], [0, -0.5]]) * speed
    x = np.array([[-0.98, 0.0], [0.98, 0.0]])
    if law == "space":
        x, v = (np.column_stack([each, [0.0, 0.0]]) for each in (x, v))
        sides = np.reshape([*box, -4, 4], (3, 2))
        scene = Balls(
            x, 1, words, tmp_path, v, box=sides, boundary="p p p", dt=dt, move=STILL,
            commands="compute rows all deformable/contact",
        )  # fmt: skip
        scene.run("run 0")
        facets = scene.lmp.numpy.extract_compute("rows", 2, 2)[:, 3]
        size = 0.5 * np.sum(np.pi * facets**2)
    else:
        kind = "ring" if law == "radical" else "drop"
        scene = Grains(x, 1, words, tmp_path, v, law=law, kind=kind, box=box, dt=dt, move=STILL)
        size = scene.evaluate().shape["contact_length"][0]
    assert size > 0.02
    time = 0.5 * np.sqrt(speed) / (c * size) if power < 1 else 1 / (2 * c * size)
    scene.run(f"run {round(time / dt)}")
    found = np.linalg.norm(scene.v[1] - scene.v[0])
    expected = speed * (0.25 if power < 1 else np.exp(-1))
    assert found == pytest.approx(expected, rel=1e-2)
    assert scene.lmp.extract_fix("rub", 0, 1, FILMS) == pytest.approx(
        0.25 * (speed**2 - found**2), rel=1e-2
    )
    if power < 1:
        scene.run(f"run {round(1.1 * time / dt)}")
        assert np.linalg.norm(scene.v[1] - scene.v[0]) < 1e-3 * speed


FILM_WORDS = "0 0 0 film 0.2 1", "0.3 0.6 0 film 0.05 0.5"


@pytest.mark.parametrize(("law", "words"), in_turn(RING_LAWS, FILM_WORDS))
def test_energy_and_momenta(law, words, tmp_path):
    """Energy with what films lose, to second order in the time step; momenta exactly."""
    x, radii, v, spin = cloud()
    errors = []
    for dt in (0.04, 0.01):
        scene = Grains(x, radii, words, tmp_path, v, spin, law=law, kind="ring", dt=dt, **BIG)
        scene.run("run 0 post no")
        before, turn, found = scene.balance(), scene.angular_momentum(), []
        for _ in range(10):
            scene.run(f"run {int(2 / dt)} post no")
            found.append(scene.balance())
        errors.append(np.abs(np.array(found) - before).max())
        assert np.abs(np.sum(scene.v, axis=0)).max() < 1e-14
        assert scene.angular_momentum() == pytest.approx(turn, abs=1e-13)
    assert scene.lmp.extract_fix("rub", 0, 1, FILMS) > 0.1 * before
    assert errors[0] < 1e-3 * before
    assert errors[1] < 0.15 * errors[0]


@pytest.mark.parametrize("dimension", [2, 3])
def test_crystals_come_to_rest(dimension, tmp_path):
    """At rest all of their films are linear: no time step makes them tremble."""
    rng, a = np.random.default_rng(0), 1.9
    if dimension == 2:
        row = a * np.sqrt(0.75)
        x = np.array([[a * (i + 0.5 * (j % 2)), row * j] for j in range(4) for i in range(4)])
        box = (0, 4 * a, 0, 4 * row)
        make = lambda **more: Grains(x, 1, WORDS, tmp_path, law="radical", kind="ring", **more)  # noqa: E731
    else:
        cell = a * np.sqrt(2)
        base = np.array([[0, 0, 0], [0, 0.5, 0.5], [0.5, 0, 0.5], [0.5, 0.5, 0]])
        x = np.concatenate([base + shift for shift in np.ndindex(2, 2, 2)]) * cell
        box = (0, 2 * cell)
        make = lambda **more: Balls(x, 1, WORDS, tmp_path, boundary="p p p", **more)  # noqa: E731
    v = rng.normal(0, 1e-3, x.shape)
    scene = make(v=v - v.mean(axis=0), box=box, dt=0.1, move="fix move all nve/sphere")
    scene.run("run 500 post no\nrun 500 post no")
    assert scene.lmp.get_thermo("ke") < 1e-10 * 0.5 * 1e-6 * x.size


WORDS = "0 0 0 film 20 0.5"


@two_laws
def test_one_direction(law, tmp_path):
    """A film that only shears, or is only squeezed."""
    x, v = [[-0.98, 0.0], [0.98, 0.0]], np.array([[0.01, 0.02], [-0.01, -0.02]])
    for word, expected in (("tangential", [0, 1]), ("normal", [1, 0]), ("", [1, 1])):
        scene = Grains(x, 1, f"0 0 0 film 0.5 1 {word}", tmp_path, v, law=law)
        scene.run("run 2")
        row = scene.rows_and_films[0]
        assert list(np.array(row[[12, 11]]) != 0) == [bool(e) for e in expected]


def test_films_of_types(tmp_path):
    """The words after types are those of these types alone."""
    x, v = [[-1.96, 0.0], [0.0, 0.0], [1.96, 0.0]], [[0, 0], [0, 0.01], [0, 0]]
    words = "0 0 0 film 0.5 1 types 1 2 0 0 0 0 film 0.1 1 types 2 2 0 0 0 0"
    scene = Grains(x, 1, words, tmp_path, v, kind=["drop", "drop", "ring"])
    scene.run("run 2")
    pairs = {tuple(sorted(row[:2].astype(int))): abs(row[11]) for row in scene.rows_and_films}
    size = scene.evaluate().shape["contact_length"]
    first, second = (size[0], 0.5 * (size[1] - size[0] + size[2]))
    assert pairs[1, 2] == pytest.approx(0.005 * first, rel=0.05)
    assert pairs[2, 3] == pytest.approx(0.001 * second, rel=0.05)


REFUSED = {
    "0 0 0 film -1 1": "Fix rub .*: film must be .*, not -1",
    "0 0 0 film 1 1.5": "Fix rub .*: the power of a film must be .*, not 1.5",
    "0 0 0 film 1 0": "Fix rub .*: the power of a film must be .*, not 0",
    "0 0 0 film 1": "Illegal fix deformable/friction film",
    "0 0 0 film 1 1 both": "Fix rub .*: unknown word 'both'.*'film'",
    "0 0 0 film 1000 1": "Fix rub .*: the time step 0.01 is too long for a film",
}


def test_what_is_refused(tmp_path):
    scene = Grains([[-0.98, 0.0], [0.98, 0.0]], 1, "0 0 0", tmp_path)
    for words, message in REFUSED.items():
        scene.run("unfix rub")
        with refuses(message):
            scene.run(f"fix rub all deformable/friction {words}\nrun 1")
        if "too long" not in message:
            scene.run("fix rub all deformable/friction 0 0 0")


@pytest.mark.parametrize("law", [*RING_LAWS, "space"])
def test_unequal_droplets(law, tmp_path):
    """The size of a film is the mean of those that both sides have, whose IDs do not matter."""
    radii, found = np.array([1.0, 0.6]), []
    for order in (slice(None), slice(None, None, -1)):
        words, commands = "0 0 0 film 0.5 1", "compute rows all deformable/contact"
        x = np.array([[-0.93, 0.0], [0.6, 0.0]])[order]
        v = np.array([[0, 0.01], [0, -0.01]])[order]
        if law == "space":
            x, v = (np.column_stack([each, [0.0, 0.0]]) for each in (x, v))
            scene = Balls(x, radii[order], words, tmp_path, v, commands=commands)
        else:
            kind = "ring" if law == "radical" else "drop"
            scene = Grains(
                x, radii[order], words, tmp_path, v, law=law, kind=kind, commands=commands
            )  # fmt: skip
        scene.run("run 1")
        sizes = np.array(scene.lmp.numpy.extract_compute("rows", 2, 2))[:, 3]
        size = np.mean(np.pi * sizes**2 if law == "space" else sizes)
        assert law == "curved" or abs(sizes[0] / sizes[1] - 1) > 0.02
        lost = scene.lmp.extract_fix("rub", 0, 1, FILMS)
        assert lost == pytest.approx(0.5 * size * 0.02**2 * 0.01, rel=0.02)
        found.append(lost)
    assert found[0] == pytest.approx(found[1], rel=1e-9)
