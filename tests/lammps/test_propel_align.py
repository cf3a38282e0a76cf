"""fix deformable/propel: directions that align to velocities, to neighbors and to free space."""

import numpy as np
import pytest
from laws import BALANCED, LAWS
from parallel import FEW, assert_atoms_change_ranks, assert_same, on_grids, report, reported
from scene import HEADER, SPECIES
from scipy.special import ive
from test_propel import SPACE, WORLD, Active, vectors
from test_refusals import refuses

RATE, DT = 0.7, 0.05
STILL = f"fix move all move linear 0 0 0\ntimestep {DT}\n"


def propel(words, tau="inf", force=1e-9):
    return f"fix propel all deformable/propel {force} {tau} 4711 {words}\n"


def place(active, directions):
    flat = np.ctypeslib.as_ctypes(np.ascontiguousarray(directions, dtype=float).ravel())
    active.lmp.scatter("f_propel", 1, np.shape(directions)[1], flat)


def cosine(start, rate, steps):
    """Of an angle phi to a field that stays, tan(phi/2) = tan(phi(0)/2) exp(-rate t)."""
    return np.cos(2 * np.arctan(np.tan(np.arccos(start) / 2) * np.exp(-rate * DT * steps)))


@pytest.mark.parametrize("rate", [RATE, -0.3, 1000.0])
@pytest.mark.parametrize("world", [WORLD, SPACE], ids=["plane", "space"])
def test_directions_turn_to_a_velocity(world, rate):
    """Exactly, for any time step; in space along a great circle."""
    along = np.array([0.6, 0.8, 0.0])
    active = Active("create_atoms 1 random 20 4711 box\n" + propel(f"velocity {rate}"), world)
    active.run(STILL.replace("linear 0 0 0", "linear 0.3 0.4 0"))
    d = 2 if world == WORLD else 3
    along, start = along[:d], active.gather("f_propel", d, d)
    axis = np.cross(start, along) if d == 3 else None
    active.run("run 8")
    end = active.gather("f_propel", d, d)
    found = end @ along
    np.testing.assert_allclose(found, cosine(start @ along, rate, 8), rtol=0, atol=2e-12)
    np.testing.assert_allclose(np.linalg.norm(end, axis=1), 1.0, rtol=0, atol=1e-14)
    if d == 3:
        assert np.abs(np.sum(end * axis, axis=1)).max() < 1e-12


def orders(x, dimension):
    """<cos phi> and <cos 2 phi>, in space <P2>, in a field x times the diffusivity."""
    if dimension == 2:
        return ive(1, x) / ive(0, x), ive(2, x) / ive(0, x)
    first = 1 / np.tanh(x) - 1 / x
    return first, 1 - 3 * first / x


@pytest.mark.parametrize("dimension", [2, 3])
def test_velocity_against_noise(dimension):
    """The stationary density exp(k cos(phi)/D), within 5 errors and a part of the time step."""
    tau, number = 2.0, 4000
    diffusivity = 1 / ((dimension - 1) * tau)
    world = WORLD if dimension == 2 else SPACE
    atoms = f"create_atoms 1 random {number} 4711 box\n"
    active = Active(atoms + propel(f"velocity {RATE}", tau), world)
    active.run(STILL.replace("linear 0", "linear 1") + "timestep 0.01\nrun 800")
    c = active.gather("f_propel", dimension, dimension)[:, 0]
    second = 2 * c**2 - 1 if dimension == 2 else 1.5 * c**2 - 0.5
    for values, expected in zip((c, second), orders(RATE / diffusivity, dimension), strict=True):
        error = 5 * values.std() / np.sqrt(number) + 0.01 * RATE
        assert values.mean() == pytest.approx(expected, abs=error)


def test_inertia_slows_the_decay_of_aligned_directions():
    """Directions diffuse with D/(1 + k m/gamma)^2, as the velocity turns behind them.

    For small D angles are linear: phi' = k (psi - phi) + noise, psi' = (gamma/m) (phi - psi), so
    (gamma/m) phi + k psi has no drift.
    """
    tau, number, gap, steps = 100.0, 4000, 20.0, 600
    atoms = f"create_atoms 1 random {number} 4711 box\n"
    for rate in (0.0, 1.5):
        active = Active(atoms + propel(f"velocity {rate}", tau, force=1.0))
        active.run(f"fix move all nve\nfix drag all viscous 1.0\ntimestep {gap / steps}")
        active.run(f"run {steps} post no")
        before = active.directions
        active.run(f"run {steps} post no")
        cosines = np.sum(before * active.directions, axis=1)
        decay = np.exp(-gap / (tau * (1.0 + rate) ** 2))
        error = 5 * cosines.std() / np.sqrt(number) + 0.005
        assert cosines.mean() == pytest.approx(decay, abs=error)


@pytest.mark.parametrize("dimension", [2, 3])
def test_order_of_many_neighbors(dimension):
    """R = I1(x)/I0(x), x = k R/D, or coth x - 1/x; none above D = k/d."""
    number, steps = 300, 40
    world = WORLD if dimension == 2 else SPACE
    region = "region near block -0.5 0.5 -0.5 0.5 -0.1 0.1\n"
    atoms = region + f"create_atoms 1 random {number} 4711 near\n"
    for part in (0.3, 0.7, 2.0):  # of the D at which order ends
        diffusivity = part / dimension
        tau = 1 / ((dimension - 1) * diffusivity)
        active = Active(atoms + propel("neighbors 1.0 2.0", tau) + STILL, world)
        active.run("neighbor 2.5 nsq")
        start = np.tile(np.eye(dimension)[0], (number, 1))
        place(active, start)
        active.run("timestep 0.05\nrun 200 post no")
        found = []
        for _ in range(steps):
            active.run("run 20 pre no post no")
            mean = active.gather("f_propel", dimension, dimension).mean(axis=0)
            found.append(np.linalg.norm(mean))
        if part > 1:
            assert np.mean(found) < 3 / np.sqrt(number)
            continue
        order = 1.0
        for _ in range(500):
            order = orders(order / diffusivity, dimension)[0]
        assert np.mean(found) == pytest.approx(order, abs=0.04)


STYLES = {law: f"pair_style {LAWS[law]}\npair_coeff * * {SPECIES} unit\n" for law in LAWS}
STYLES["droplet"] = "pair_style deformable/droplet\npair_coeff * * {folder}/drop drop\n"
ANGLES = np.array([0.9, 2.0, -1.1])


def three(law, words, folder, extra=""):
    """Particles in a row, of which those at the ends have one contact each."""
    (folder / "drop").write_text("drop 1.0 inf 0 tension 1.0\n")
    dimension = 3 if law == "droplet" else 2
    size = "-8 8" if dimension == 3 else "-0.5 0.5"
    world = f"dimension {dimension}\nregion box block -8 8 -8 8 {size}\ncreate_box 1 box\n"
    world += "".join(f"create_atoms 1 single {x} 0 0\n" for x in (-1.9, 0, 1.9))
    world += "mass * 1.0\n" + STYLES[law].format(folder=folder)
    active = Active(extra + propel(words) + STILL, world)
    place(active, np.column_stack([vectors(ANGLES), np.zeros(3)])[:, :dimension])
    return active, dimension


@pytest.mark.parametrize("law", STYLES)
def test_free_space(law, tmp_path):
    """Ends turn away from the middle, which stays; a wall turns it, and one is in the way."""
    active, dimension = three(law, f"free {RATE}", tmp_path)
    active.run("run 4")
    end = active.gather("f_propel", dimension)
    for i, away in ((0, -1.0), (2, 1.0)):
        assert away * end[i, 0] == pytest.approx(
            cosine(away * np.cos(ANGLES[i]), RATE, 4), abs=1e-9
        )
    np.testing.assert_allclose(end[1], vectors(ANGLES)[1], rtol=0, atol=1e-9)
    plane = "plane 0 -0.95 0 0 1 0" if dimension == 3 else "plane 0 -0.95 0 1"
    active, dimension = three(law, f"free {RATE}", tmp_path, f"fix w all deformable/wall {plane}\n")
    active.run("run 4")
    up = active.gather("f_propel", dimension)[1, 1]
    assert up == pytest.approx(cosine(np.sin(ANGLES[1]), RATE, 4), abs=1e-3)


@pytest.mark.parametrize("law", STYLES)
def test_neighbors_in_contact(law, tmp_path):
    active, dimension = three(law, f"neighbors {RATE} contact", tmp_path)
    active.run("run 1")
    found = np.arctan2(*active.gather("f_propel", dimension).T[::-1])
    near = [[1], [0, 2], [1]]
    np.testing.assert_allclose(found, aligned(ANGLES, near), rtol=0, atol=1e-12)


def aligned(angles, near):
    """After a step, to the mean of neighbors."""
    ends = []
    for angle, neighbors in zip(angles, near, strict=True):
        x, y = vectors(angles[neighbors]).mean(axis=0)
        toward = np.arctan2(y, x)
        left = np.tan((angle - toward) / 2) * np.exp(-RATE * np.hypot(x, y) * DT)
        ends.append(toward + 2 * np.arctan(left))
    return np.arctan2(np.sin(ends), np.cos(ends))


def test_neighbors_within_a_distance():
    """Those of the group, across the sides of the box, and beyond the reach of contacts."""
    places = [(-9.5, 0), (9.0, 0.5), (-7.0, 0.1), (0, 0), (-9.0, 0.2)]
    atoms = "".join(f"create_atoms 1 single {x} {y} 0\n" for x, y in places)
    group = "group some id 1:4\n" + propel(f"neighbors {RATE} 3.0").replace(" all ", " some ")
    active = Active(atoms + group + STILL)
    start = np.array([0.3, 1.4, -2.0, 3.0, 0.1])
    place(active, vectors(start))
    active.run("run 1")
    found = np.arctan2(*active.directions.T[::-1])
    expected = aligned(start[:3], [[1, 2], [0], [0]])
    np.testing.assert_allclose(found[:3], expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found[3:], start[3:], rtol=0, atol=1e-12)


BALL = "velocity 0.4 neighbors {rate} {near} free 0.5"
PARALLEL = (
    HEADER.format(boundary="p p p")
    + "processors {grid}\n"
    + WORLD.replace("pair_style zero 1.0\npair_coeff * *", "")
    + f"pair_style {BALANCED}\npair_coeff * * {SPECIES} unit unit\n"
    + "".join(
        f"create_atoms 1 single {x} {y} 0\n"
        for x, y in [(0.05, 0.1), (1.9, -0.1), (-0.8, 1.7), (0.9, 1.9), (-1.8, -0.1), (0.1, -1.8)]
    )
    + "fix propel all deformable/propel 0.5 2.0 4711 {words}\n"
    + f"fix move all brownian 1.0 1 gamma_t 1.0 rng none\ntimestep {DT}\n"
    + "{balance}"
    + report(1, "step", "x y f_propel[1] f_propel[2]")
    + report(60, "step", "x y f_propel[1] f_propel[2]")
)


@pytest.mark.parametrize("near", ["contact", "2.5"])
def test_ranks_and_grids(near, tmp_path):
    """An empty one too."""
    words = BALL.format(rate=RATE, near=near)
    folders = on_grids(PARALLEL, tmp_path, (*FEW, "4 1 1"), words=words)
    before, found = reported(folders, 1), reported(folders, 60)
    assert_atoms_change_ranks(before, found)
    assert_same(found, tolerance=1e-7)


@pytest.mark.parametrize("near", ["contact", "2.5"])
def test_restart(near, tmp_path):
    words = BALL.format(rate=RATE, near=near)
    begin, pair, *rest = PARALLEL.partition(f"pair_style {BALANCED}\n")
    coeff, create = rest[0].split("\n", 1)
    create, fixes = create.split("fix propel", 1)
    fixes = "fix propel" + fixes[: fixes.index("{balance}")]
    fixes = fixes.format(words=words)
    active = Active(pair + coeff + "\n" + create + fixes, begin.partition("grid}\n")[2])
    active.run(f"run 10\nwrite_restart {tmp_path}/restart\nrun 10")
    again = Active(f"clear\nread_restart {tmp_path}/restart\n{pair}{coeff}\n{fixes}run 10", "")
    np.testing.assert_allclose(again.directions, active.directions, rtol=0, atol=1e-9)
    np.testing.assert_allclose(again.gather("x", 3), active.gather("x", 3), rtol=0, atol=1e-9)


def test_new_particles_align_and_none_do():
    active = Active("create_atoms 1 single 0 0 0\n" + propel("neighbors 1 3.0 velocity 1") + STILL)
    active.run("run 2\ncreate_atoms 1 single 1 0 0\nrun 2\ndelete_atoms group all\nrun 2")
    assert active.lmp.get_natoms() == 0


def test_refused_arguments():
    active = Active("create_atoms 1 single 0 0 0\n")
    for words, message in (
        ("velocity", "[Mm]issing|velocity"),
        ("neighbors 1.0", "[Mm]issing|neighbors"),
        ("neighbors 1.0 0.0", "distance of neighbors is '0.0': it must be positive, or 'contact'"),
        ("velocity nan", "instead of 'nan'"),
        ("speed 1.0", "Unknown fix deformable/propel keyword 'speed': it must be 'velocity'"),
    ):
        with refuses(message):
            active.run(propel(words))
    with refuses("Fix propel deformable/propel.*pair_style"):
        active.run(propel("free 1.0") + STILL + "run 0")
    active = Active(
        "neighbor 0.3 multi\ncomm_modify mode multi\n" + propel("neighbors 1.0 3.0") + STILL
    )
    with refuses("need 'comm_modify mode single'"):
        active.run("run 0")
