"""Contacts that rub: closed forms, laws of conservation, Coulomb's bound."""

import numpy as np
import pytest
from grains import Grains
from laws import RING_LAWS, ring_laws, two_laws
from turns import in_turn

BIG = {"boundary": "f f p", "box": (-30, 30, -30, 30)}
PAIR = [[-1.00005, 0], [1.00005, 0]]


@pytest.mark.parametrize(("law", "damp"), in_turn(RING_LAWS, [0.2, 1.0, 2.0]))
def test_restitution_of_droplets(law, damp, tmp_path):
    """A spring k = 2 pi gamma/(3 R) and a dashpot, until the force of the contact ends."""
    speed = 1e-4  # so that k is that of small indentations
    scene = Grains(PAIR, 1, f"0 1 0 damp {damp}", tmp_path, [[speed, 0], [-speed, 0]], law=law)
    scene.run("run 1000")
    b, k = damp, 2 * np.pi / 3
    w = np.sqrt(2 * k - b**2)
    expected = np.exp(-(b / w) * (np.pi - np.arctan2(2 * b * w, w**2 - b**2)))
    found = scene.v[:, 0] / speed
    assert found[1] == -found[0]
    # forces know the velocity of half a step ago: 0.3 % with this step
    assert found[1] == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize(("law", "mu"), [("radical", 0.1), ("balanced", 0.3)])
def test_a_disk_that_slides_begins_to_roll(law, mu, tmp_path):
    """v/(1 + R^2/2 h^2) after (v - that)/(mu G), with the height h of the pressed center."""
    G, speed = 0.01, 0.1
    floor = f"fix floor all deformable/wall plane 0 0 0 1\nfix weight all addforce 0 -{G} 0"
    scene = Grains([[0, 0.99]], 1, f"{mu} 1 1 damp 1", tmp_path, law=law, commands=floor, dt=0.02)
    scene.run("run 2000")  # to rest
    height = scene.x[0, 1]
    scene.v = [[speed, 0]]
    rolling = speed / (1 + 0.5 / height**2)
    time = (speed - rolling) / (mu * G)
    scene.run(f"run {int(0.8 * time / 0.02)}")
    slid = scene.v[0, 0]
    assert slid == pytest.approx(speed - mu * G * 0.02 * int(0.8 * time / 0.02), rel=1e-3)
    assert scene.terms["slide"] == 1
    scene.run(f"run {int(2 * time / 0.02)}")
    assert scene.v[0, 0] == pytest.approx(rolling, rel=2e-3)
    assert -scene.spin[0] * height == pytest.approx(rolling, rel=2e-3)
    assert scene.terms["slide"] == 0


def test_a_block_slides_beyond_the_angle_of_friction(tmp_path):
    """Three grains that do not spin: at rest below tan(angle) = mu, faster and faster above it."""
    mu, G, dt, steps, found = 0.6, 0.01, 0.02, 2000, []
    for part in (0.97, 1.03):
        along, down = G * np.sin(np.arctan(part * mu)), G * np.cos(np.arctan(part * mu))
        floor = "fix floor all deformable/wall plane 0 0 0 1\n"
        slope = f"fix weight all addforce {along} {-down} 0"
        x = [[3 * k, 1 - 3 * down / (4 * np.pi)] for k in range(-1, 2)]  # where weights are borne
        scene = Grains(
            x, 1, f"{mu} 1 1 damp 1", tmp_path, dt=dt,
            commands=floor + slope, move="fix move all nve",
        )  # fmt: skip
        scene.run(f"run {steps}")
        first = scene.v[:, 0]
        scene.run(f"run {steps}")
        found.append((scene.v[:, 0] - first) / (steps * dt))
        assert np.abs(scene.spin).max() == 0
    np.testing.assert_allclose(found[0], 0, atol=1e-6 * G)
    np.testing.assert_allclose(found[1], along - mu * down, rtol=1e-5)


def cloud(number=24, seed=3):
    """Droplets that fly into each other, with spins; the middle of all is at rest."""
    rng = np.random.default_rng(seed)
    places = np.array([[i, j] for i in range(5) for j in range(5)][:number], float)
    x = 2.05 * (places - places.mean(axis=0)) + rng.uniform(-0.05, 0.05, (number, 2))
    v = -0.02 * x + rng.normal(0, 0.03, x.shape)
    return x, rng.uniform(0.7, 1.0, number), v - v.mean(axis=0), rng.normal(0, 0.1, number)


WORDS = "0.5 0.6 0.1 damp 0.1"


@pytest.mark.parametrize(
    ("law", "kind"), [("radical", "ring"), ("balanced", "drop"), ("curved", "ring")]
)
def test_energy_and_momenta(law, kind, tmp_path):
    """Energy with what is stored and lost, to second order in the time step; momenta exactly."""
    x, radii, v, spin = cloud()
    errors = []
    for dt in (0.04, 0.005):
        options = {"law": law, "kind": kind, "dt": dt, **BIG}
        scene = Grains(x, radii, WORDS, tmp_path, v, spin, **options)
        scene.run("run 0 post no")
        before, turn = scene.balance(), scene.angular_momentum()
        found = []
        for _ in range(10):
            scene.run(f"run {int(2 / dt)} post no")
            found.append(scene.balance())
        errors.append(np.abs(np.array(found) - before).max())
        assert np.abs(np.sum(scene.v, axis=0)).max() < 1e-14
        assert scene.angular_momentum() == pytest.approx(turn, abs=1e-13)
    lost = scene.terms
    kinetic = before - scene.lmp.get_thermo("pe")
    assert sum(lost[name] for name in ("sliding", "dashpots", "damping")) > 0.1 * before
    assert min(lost[name] for name in ("sliding", "dashpots", "damping")) > 1e-3 * kinetic
    assert errors[0] < 2e-3 * before
    assert errors[1] < 0.06 * errors[0]  # 1/64; 1/8 if it were of first order


def test_springs_that_never_slip_are_let_go(tmp_path):
    """With mu = inf nothing slides: contacts that end lose the energy of their springs."""
    x, v = [[-1.2, 0.3], [0.75, -0.3]], [[0.1, 0.02], [0.0, 0.0]]
    scene = Grains(x, 1, "inf 0.7 0", tmp_path, v, [0.2, 0.0], **BIG)
    scene.run("run 0 post no")
    before = scene.balance()
    most = 0.0
    for _ in range(30):
        scene.run("run 50 post no")
        most = max(most, scene.terms["stored"])
    terms = scene.terms
    assert terms["stored"] == 0.0
    assert abs(terms["sliding"]) < 1e-12 * terms["dashpots"]
    assert 1e-6 < terms["dashpots"] <= most
    assert scene.balance() == pytest.approx(before, rel=1e-4)


FRICTION = {
    "springs that never slip": ("drop", "inf 0.6 0"),
    "most contacts slide": ("ring", "0.3 0.6 0.05 damp 0.05"),
    "all slide": ("drop", "0.01 0.6 0.2 damp 0.02"),
    "no springs": ("drop", "0.3 0 0.1"),
}


@pytest.mark.parametrize(("words", "law"), in_turn(FRICTION, RING_LAWS))
def test_half_the_step_is_a_quarter_of_the_error(law, words, tmp_path):
    """A crystal under pressure, whose contacts stay: what is between them has no jumps."""
    kind, words = FRICTION[words]
    rng, a = np.random.default_rng(0), 1.95
    row = a * np.sqrt(0.75)
    x = np.array([[a * (i + 0.5 * (j % 2)), row * j] for j in range(4) for i in range(4)])
    x += rng.uniform(-0.02, 0.02, x.shape)
    v, spin, errors = rng.normal(0, 0.02, x.shape), rng.normal(0, 0.1, len(x)), []
    for dt in (0.04, 0.02):
        options = {"law": law, "kind": kind, "dt": dt, "box": (0, 4 * a, 0, 4 * row)}
        scene = Grains(x, 1, words, tmp_path, v, spin, **options)
        scene.run("run 0 post no")
        before, found = scene.balance(), []
        for _ in range(20):
            scene.run(f"run {int(0.4 / dt)} post no")
            found.append(scene.balance() - before)
        errors.append(np.sqrt(np.mean(np.square(found))))
    # the next term is smaller by (w dt)^2 < 0.01; steps in which sliding begins or ends add chance
    assert errors[0] / errors[1] == pytest.approx(4, abs=0.5)


@ring_laws
def test_momenta_of_a_mixture(law, tmp_path):
    """Rings and droplets of many sizes: lines tilt and bend, and types rub in their own ways."""
    x, radii, v, spin = cloud()
    kinds = ["drop" if k // 2 % 2 else "ring" for k in range(len(x))]
    words = WORDS + " types 1 2 inf 0.3 0.2 0 types 2 2 0.1 0.5 0 0.3"
    scene = Grains(x, radii, words, tmp_path, v, spin, law=law, kind=kinds, dt=0.04, **BIG)
    turn, pairs = scene.angular_momentum(), set()
    for _ in range(20):
        scene.run("run 50 post no")
        pairs |= {kinds[int(i) - 1] + kinds[int(j) - 1] for i, j in scene.rows[:, :2]}
        assert np.abs(np.sum(scene.v, axis=0)).max() < 1e-14
        assert scene.angular_momentum() == pytest.approx(turn, abs=1e-13)
    assert len(pairs) == 4


@two_laws
def test_coulombs_bound_and_the_losses_of_each_step(law, tmp_path):
    """No contact bears more than mu f, in no step; nothing that is lost comes back."""
    x, radii, v, spin = cloud()
    scene = Grains(x, radii, WORDS, tmp_path, v, spin, law=law, dt=0.04, **BIG)
    slides, most = 0, 0.0
    for _ in range(200):
        before = scene.terms
        scene.run("run 1 pre no post no")
        *_, force, friction, damping, _, sliding = scene.rows.T
        assert (np.abs(friction) <= 0.5 * np.abs(force) * (1 + 1e-14)).all()
        assert (damping <= np.maximum(force, 0)).all()
        weight = 0.5 if law == "radical" else 1.0  # each side has a row of its own
        after = scene.terms
        assert after["contacts"] == weight * len(force)
        assert after["slide"] == weight * sliding.sum()
        slides += sliding.sum()
        most = max(most, after["contacts"])
        for name in ("sliding", "damping"):
            assert after[name] >= before[name] * (1 - 1e-12)
    assert slides > 200
    assert most > 5


def turned(x, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(x) @ np.array([[c, s], [-s, c]])


def test_a_rotated_scene(tmp_path):
    """Forces, torques and the stress of friction turn along."""
    x, radii, v, spin = cloud()
    options, angle, found = {"law": "curved", "dt": 0.04, **BIG}, 0.7, []
    for turn in (0.0, angle):
        scene = Grains(
            turned(x, turn), radii, WORDS, tmp_path, turned(v, turn), spin,
            commands="compute rub all pressure NULL fix", **options,
        )  # fmt: skip
        scene.run("thermo_style custom step pe c_rub[*]\nrun 150")
        stress = scene.vector("rub", 6)[[0, 3, 3, 1]].reshape(2, 2)
        found.append((turned(scene.v, -turn), scene.spin, stress))
    for a, b in zip(found[0][:2], found[1][:2], strict=True):
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-10)
    expected = turned(turned(found[0][2], angle).T, angle)
    assert np.abs(expected).max() > 1e-6
    np.testing.assert_allclose(found[1][2], expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_the_stress_of_friction(tmp_path):
    """The sum of f (x) r over the contacts, and of the particles."""
    x, radii, v, spin = cloud()
    commands = "compute rub all pressure NULL fix\ncompute each all stress/atom NULL fix"
    options = {"law": "curved", "commands": commands, "dt": 0.04, **BIG}
    scene = Grains(x, radii, WORDS, tmp_path, v, spin, **options)
    scene.run("compute whole all reduce sum c_each[1] c_each[2] c_each[4]")
    scene.run("thermo_style custom step pe c_rub[*] c_whole[*]\nrun 100")
    i, j, _, _, angle, _, friction, damping, *_ = scene.rows.T
    n = np.column_stack([np.cos(angle), np.sin(angle)])
    force = damping[:, None] * n + friction[:, None] * np.column_stack([-n[:, 1], n[:, 0]])
    r = scene.x[i.astype(int) - 1] - scene.x[j.astype(int) - 1]
    expected = [
        np.sum(r[:, 0] * force[:, 0]),
        np.sum(r[:, 1] * force[:, 1]),
        0.5 * np.sum(r[:, 0] * force[:, 1] + r[:, 1] * force[:, 0]),
    ]
    area = scene.lmp.get_thermo("lx") * scene.lmp.get_thermo("ly")
    np.testing.assert_allclose(scene.vector("rub", 6)[[0, 1, 3]] * area, expected, rtol=1e-9)
    np.testing.assert_allclose(-scene.vector("whole", 3), expected, rtol=1e-9)


MACHINES = {
    "a floor that moves along itself": """
variable s equal -0.1*step*dt
region room plane 0 -3 0 0 1 0 move v_s NULL NULL
fix wall all deformable/wall room""",
    "a drum that turns": """
variable a equal 0.05*step*dt
region room cylinder z 0.3 0 3 INF INF rotate v_a 0.3 0 0 0 0 1
fix wall all deformable/wall room""",
    "a post that turns and a room": """
variable a equal 0.1*step*dt
region room block -3 3 -3 3 INF INF
region post block -0.5 0.5 -0.4 0.4 INF INF side out rotate v_a 0 0 0 0 0 1
region both intersect 2 room post
fix wall all deformable/wall both""",
}


@pytest.mark.parametrize(("law", "machine"), in_turn(RING_LAWS, MACHINES))
def test_walls_that_move_do_work(law, machine, tmp_path):
    """What they give, by friction too, is in the balance."""
    x = np.array([[-1.5, -1.7], [0.9, -1.7], [1.7, 0.3], [-1.4, 0.2], [0.2, 1.7]])
    errors = []
    for dt in (0.04, 0.005):
        weight = "\nfix weight all addforce 0 -0.01 0\nfix_modify weight energy yes"
        walls = MACHINES[machine] + weight
        options = {"law": law, "dt": dt, "commands": walls, "boundary": "f f p"}
        scene = Grains(x, 0.9, "0.5 0.5 0.1 damp 0.02", tmp_path, **options)
        scene.run("run 0 post no")
        before, found = scene.balance(), []
        for _ in range(10):
            scene.run(f"run {int(3 / dt)} post no")
            found.append(scene.balance() - before)
        errors.append(np.abs(found).max())
    given = scene.lmp.extract_fix("wall", 0, 0)
    assert scene.terms["sliding"] > 1e-4
    assert abs(given) > 1e-4
    assert errors[0] < 0.02 * abs(given)
    assert errors[1] < 0.06 * errors[0]  # 1/64; 1/8 if it were of first order
