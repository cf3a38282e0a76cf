"""fix deformable/propel: directions that diffuse, the same on any ranks."""

import numpy as np
import pytest
from lammps import lammps
from parallel import FEW, assert_atoms_change_ranks, on_grids, report, reported
from scene import HEADER
from test_refusals import refuses

FORCE, TAU, SEED, DT = 0.5, 2.0, 4711, 0.05
PROPEL = f"fix propel all deformable/propel {FORCE} {TAU} {SEED}\n"
MOVE = f"fix move all brownian 1.0 1 gamma_t 1.0 rng none\ntimestep {DT}\n"
WORLD = """
region box block -10 10 -10 10 -0.5 0.5
create_box 2 box
mass * 1.0
pair_style zero 1.0
pair_coeff * *
"""
ATOMS = "create_atoms 1 random 20 4711 box\n"


def mixed(bits):
    """The finalizer of SplitMix64, of arrays."""
    with np.errstate(over="ignore"):
        bits = bits + np.uint64(0x9E3779B97F4A7C15)
        bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return bits ^ (bits >> np.uint64(31))


def uniforms(seed, particle, step, number):
    """Random numbers between 0 and 1, shape (number, ...)."""
    state = mixed(mixed(mixed(np.uint64(seed)) ^ np.uint64(particle)) ^ np.uint64(step))
    values = []
    for _ in range(number):
        state = mixed(state)
        values.append(((state >> np.uint64(11)) + 0.5) * 2.0**-53)
    return np.array(values)


def gaussian(seed, particle, step):
    radius, angle = uniforms(seed, particle, step, 2)
    return np.sqrt(-2.0 * np.log(radius)) * np.cos(2.0 * np.pi * angle)


def angles(tags, step):
    """Directions after so many steps from 0."""
    angle = 2.0 * np.pi * uniforms(SEED, tags, np.uint64(2**64 - 1), 1)[0]
    return angle + np.sqrt(2.0 * DT / TAU) * sum(gaussian(SEED, tags, n + 1) for n in range(step))


class Active:
    """Particles without contacts."""

    def __init__(self, commands, world=WORLD):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(HEADER.format(boundary="p p p") + world + commands)

    def run(self, commands):
        self.lmp.commands_string(commands)

    def gather(self, name, columns, dimension=2):
        return np.array(self.lmp.gather(name, 1, columns)).reshape(-1, columns)[:, :dimension]

    @property
    def directions(self):
        return self.gather("f_propel", 2)

    @property
    def directions_in_space(self):
        return self.gather("f_propel", 3, 3)


def vectors(angle):
    return np.column_stack([np.cos(angle), np.sin(angle)])


def test_random_numbers_are_normal_and_independent():
    """Moments of 10^5 numbers at five standard errors, along particles, steps and seeds."""
    n = np.arange(1, 100_001)
    series = [gaussian(SEED, n, 7), gaussian(SEED, 7, n), gaussian(n, 7, 7)]
    for values in series:
        assert abs(values.mean()) < 5.0 / np.sqrt(len(n))
        assert values.var() == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / len(n)))
        assert np.mean(values**4) == pytest.approx(3.0, abs=5.0 * np.sqrt(96.0 / len(n)))
        assert abs(np.mean(values[1:] * values[:-1])) < 5.0 / np.sqrt(len(n))
    for a, b in ((0, 1), (1, 2), (2, 0)):
        assert abs(np.mean(series[a] * series[b])) < 5.0 / np.sqrt(len(n))


def test_directions_and_forces():
    """Those of the reference; a run that is cut in two goes on."""
    active = Active(ATOMS + PROPEL + MOVE)
    tags = np.arange(1, 21)
    np.testing.assert_allclose(active.directions, vectors(angles(tags, 0)), rtol=0, atol=1e-14)
    active.run("run 4")
    active.run("run 3")
    np.testing.assert_allclose(active.directions, vectors(angles(tags, 7)), rtol=0, atol=1e-13)
    np.testing.assert_allclose(active.gather("f", 3), FORCE * active.directions, rtol=1e-15)


def test_positions_follow_the_directions():
    """Each step moves by those at the end of the step before."""
    active = Active(ATOMS + PROPEL + MOVE)
    start, tags = active.gather("x", 3), np.arange(1, 21)
    active.run("run 10")
    moved = FORCE * DT * sum(vectors(angles(tags, n)) for n in range(10))
    np.testing.assert_allclose(active.gather("x", 3) - start, moved, rtol=0, atol=1e-13)


def test_only_the_group_is_pushed_and_new_particles_get_directions():
    group = "group some id 1:10\n" + PROPEL.replace(" all ", " some ")
    active = Active(ATOMS + group + MOVE)
    active.run("run 5")
    force = active.gather("f", 3)
    assert not force[10:].any()
    np.testing.assert_allclose(np.hypot(*force[:10].T), FORCE, rtol=1e-14)
    active.run("create_atoms 1 single 0 0 0\ngroup some id 21\nrun 2")
    np.testing.assert_allclose(np.hypot(*active.gather("f", 3)[20]), FORCE, rtol=1e-14)
    active.run("group out id 3\ndelete_atoms group out compress no\nrun 2")
    assert active.lmp.get_natoms() == 20


def test_directions_can_be_placed():
    active = Active(ATOMS + PROPEL + MOVE)
    right = np.ctypeslib.as_ctypes(np.tile([1.0, 0.0], 20))
    active.lmp.scatter("f_propel", 1, 2, right)
    active.run("run 0")
    np.testing.assert_array_equal(active.gather("f", 3), np.tile([FORCE, 0.0], (20, 1)))


def test_restart(tmp_path):
    active = Active(ATOMS + PROPEL + MOVE)
    active.run(f"run 10\nwrite_restart {tmp_path}/restart\nrun 10")
    again = Active(
        f"clear\nread_restart {tmp_path}/restart\npair_style zero 1.0\npair_coeff * *\n"
        + PROPEL
        + MOVE
        + "run 10"
    )
    np.testing.assert_array_equal(again.directions, active.directions)
    np.testing.assert_allclose(again.gather("x", 3), active.gather("x", 3), rtol=0, atol=1e-14)


def test_beside_fix_deform_and_minimizers():
    """LAMMPS does not take it for a fix deform; minimizers pass over it."""
    active = Active(ATOMS + PROPEL + MOVE + "fix grow all deform 1 y final -11 11\n")
    active.run("run 2 post no")
    assert active.lmp.extract_box()[1][1] == 11.0
    active.run("unfix grow\nunfix move\nmin_style fire\nminimize 0 1e-6 10 10")
    assert not active.gather("f", 3).any()


PARALLEL = (
    HEADER.format(boundary="p p p")
    + "processors {grid}\n"
    + WORLD
    + "create_atoms 1 single -9.9 0.1 0\ncreate_atoms 1 single 0.05 -0.1 0\n"
    + "create_atoms 1 single -0.05 9.9 0\ncreate_atoms 2 single 0.1 0.02 0\n"
    + PROPEL
    + MOVE
    + "{balance}"
    + report(1, "step", "x y f_propel[1] f_propel[2]")
    + report(60, "step", "x y f_propel[1] f_propel[2]")
)


def test_ranks_and_grids(tmp_path):
    """Random numbers belong to particles: the same to the last digit on any ranks."""
    folders = on_grids(PARALLEL, tmp_path, FEW)
    before, found = reported(folders, 1), reported(folders, 60)
    assert_atoms_change_ranks(before, found)
    rows = found["1 1 1"][1]
    np.testing.assert_allclose(
        rows[:, 4:], vectors(angles(np.arange(1, 5), 61)), rtol=0, atol=1e-12
    )
    for grid, (_, theirs) in found.items():
        np.testing.assert_array_equal(theirs[:, 4:], rows[:, 4:], err_msg=grid)
        np.testing.assert_allclose(theirs[:, 2:4], rows[:, 2:4], rtol=0, atol=1e-13, err_msg=grid)


def test_refused_arguments():
    active = Active(ATOMS)
    for arguments, message in (
        ("1.0 2.0", "[Mm]issing|propel"),
        ("0.0 2.0 1", "f is '0.0': it must be positive"),
        ("inf 2.0 1", "instead of 'inf'"),
        ("1.0 0.0 1", "tau is '0.0': it must be positive"),
        ("1.0 2.0 -1", "seed is '-1': it must not be negative"),
        ("1.0 2.0 1 x", "Unknown fix deformable/propel keyword 'x': it must be 'velocity'"),
    ):
        with refuses(message):
            active.run(f"fix propel all deformable/propel {arguments}")


def test_refused_worlds():
    with refuses("cannot be used with run_style respa"):
        Active(ATOMS + PROPEL + "fix move all nve\nrun_style respa 2 2 pair 1\nrun 0")
    with refuses("needs atom IDs.*atom_modify id yes"):
        nameless = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        nameless.commands_string(f"dimension 2\natom_modify id no\n{WORLD}{PROPEL}")


def test_directions_that_stay():
    """An infinite tau."""
    active = Active(ATOMS + PROPEL.replace(f" {TAU} ", " inf ") + MOVE)
    start = active.directions
    active.run("run 10")
    np.testing.assert_allclose(active.directions, start, rtol=0, atol=1e-15)


SPACE = "dimension 3\n" + WORLD.replace("-0.5 0.5", "-10 10")


def in_space(commands):
    return Active(commands, world=SPACE)


def concentration(persisted):
    """kappa of Fisher's density, coth kappa - 1/kappa = exp(-dt/tau)."""
    low, high = 1e-9, 1e9
    for _ in range(200):
        kappa = np.sqrt(low * high)
        mean = 1 / np.tanh(kappa) - 1 / kappa if kappa > 1e-3 else kappa / 3
        low, high = (kappa, high) if mean < np.exp(-persisted) else (low, kappa)
    return kappa


def random_turns(persisted, start, tags, steps):
    """Directions after these steps: an angle of Fisher's density, toward any side."""
    kappa = concentration(persisted)
    for step in steps:
        u, side = uniforms(SEED, tags, step, 2)
        cosine = 1 + np.log1p(np.expm1(-2 * kappa) * u) / kappa
        unit = np.where(np.abs(start[:, :1]) < 0.5, [[1.0, 0, 0]], [[0, 1.0, 0]])
        out = unit - np.sum(unit * start, axis=1, keepdims=True) * start
        out /= np.linalg.norm(out, axis=1, keepdims=True)
        beside = np.cross(start, out)
        toward = (
            np.cos(2 * np.pi * side)[:, None] * out + np.sin(2 * np.pi * side)[:, None] * beside
        )
        start = cosine[:, None] * start + np.sqrt(1 - cosine**2)[:, None] * toward
    return start


def first_in_space(tags):
    u, w = uniforms(SEED, tags, np.uint64(2**64 - 1), 2)
    height = 2 * w - 1
    return np.column_stack([np.sqrt(1 - height**2)[:, None] * vectors(2 * np.pi * u), height])


@pytest.mark.parametrize("tau", [0.001, 0.05, TAU, 1e5])
def test_directions_and_forces_in_space(tau):
    """Those of the reference, for any time step over tau."""
    active = in_space(ATOMS + PROPEL.replace(f" {TAU} ", f" {tau} ") + MOVE)
    tags = np.arange(1, 21)
    start = first_in_space(tags)
    np.testing.assert_allclose(active.directions_in_space, start, rtol=0, atol=1e-14)
    active.run("run 4\nrun 3")
    expected = random_turns(DT / tau, start, tags, range(1, 8))
    np.testing.assert_allclose(active.directions_in_space, expected, rtol=0, atol=1e-7)
    force = FORCE * active.directions_in_space
    np.testing.assert_allclose(active.gather("f", 3, 3), force, rtol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), FORCE, rtol=1e-14)


def test_directions_in_space_diffuse():
    """Both harmonics of the turn after a time, at five standard errors, with steps of tau/4.

    The first decays by exp(-dt/tau) in a step, the second by 1 - 3 exp(-dt/tau)/kappa.
    """
    number, persisted = 40_000, 0.25
    atoms = f"create_atoms 1 random {number} 4711 box\n"
    active = in_space(atoms + PROPEL.replace(f" {TAU} ", f" {DT / persisted} ") + MOVE)
    start = active.directions_in_space
    assert np.abs(start.mean(axis=0)).max() < 5 / np.sqrt(3 * number)
    decay, few = (1 - 3 * np.exp(-part) / concentration(part) for part in (persisted, 0.01))
    assert np.log(few) / 0.03 == pytest.approx(-1 + 0.01**2 / 3, abs=1e-6)
    for step in range(1, 9):
        active.run("run 1")
        m = np.sum(active.directions_in_space * start, axis=1)
        second = 0.5 * (3 * m**2 - 1)
        for found, expected in ((m, np.exp(-step * persisted)), (second, decay**step)):
            assert abs(found.mean() - expected) < 5 * found.std() / np.sqrt(number)


def test_restart_in_space(tmp_path):
    active = in_space(ATOMS + PROPEL + MOVE)
    active.run(f"run 10\nwrite_restart {tmp_path}/restart\nrun 10")
    again = in_space(
        f"clear\nread_restart {tmp_path}/restart\npair_style zero 1.0\npair_coeff * *\n"
        + PROPEL
        + MOVE
        + "run 10"
    )
    np.testing.assert_array_equal(again.directions_in_space, active.directions_in_space)
    placed = np.tile([0.0, 0.6, -0.8], 20)
    active.lmp.scatter("f_propel", 1, 3, np.ctypeslib.as_ctypes(placed))
    active.run("run 0")
    np.testing.assert_array_equal(active.gather("f", 3, 3).ravel(), FORCE * placed)


IN_SPACE = (
    PARALLEL.replace(WORLD, WORLD.replace("-0.5 0.5", "-10 10"))
    .replace("dimension 2", "dimension 3")
    .replace("-0.1 0\n", "-0.1 9.9\n")
    .replace("0.02 0\n", "0.02 -0.1\n")
    .replace("x y f_propel[1] f_propel[2]", "x y z f_propel[1] f_propel[2] f_propel[3]")
)


def test_ranks_and_grids_in_space(tmp_path):
    folders = on_grids(IN_SPACE, tmp_path, FEW)
    before, found = reported(folders, 1), reported(folders, 60)
    assert_atoms_change_ranks(before, found)
    rows = found["1 1 1"][1]
    tags = np.arange(1, 5)
    expected = random_turns(DT / TAU, first_in_space(tags), tags, range(1, 62))
    np.testing.assert_allclose(rows[:, 5:], expected, rtol=0, atol=1e-11)
    for grid, (_, theirs) in found.items():
        np.testing.assert_array_equal(theirs[:, 5:], rows[:, 5:], err_msg=grid)
        np.testing.assert_allclose(theirs[:, 2:5], rows[:, 2:5], rtol=0, atol=1e-13, err_msg=grid)
