"""fix deformable/friction with a ledger: where energy is lost, by particle and by contact."""

import numpy as np
import test_friction_runs as plane
import test_friction_space as space
from grains import Grains
from laws import EXACT, ring_laws
from parallel import assert_same, finished, in_process, on_grids, report, reported
from test_refusals import refuses

WORDS = "0.4 0.5 0.1 damp 0.1 film 0.05 0.5"
LOST = [1, 2, 3, 6]  # elements of the vector
SCALARS = " ".join(f"f_rub[{1 + k}]" for k in LOST)
COLUMNS = "f_rub[1] f_rub[2] f_rub[3] f_rub[4]"


def script(fluid):
    """That of another test, with films and a ledger."""
    before, _, after = fluid.partition("fix rub all deformable/friction")
    return f"{before}fix rub all deformable/friction {WORDS} ledger yes\n" + after.split("\n", 1)[1]


def places(dimension):
    count, spacing = (4, 2.0) if dimension == 2 else (3, 1.95)
    x = spacing * (np.array(list(np.ndindex((count,) * dimension))) + 0.5)
    x = np.column_stack([x, np.zeros((len(x), 3 - dimension))])
    x[:, :dimension] += np.random.default_rng(5).uniform(-0.05, 0.05, (len(x), dimension))
    return "\n".join(f"create_atoms 1 single {a} {b} {c}" for a, b, c in x), count * spacing


def fluid(folder, dimension, grids, steps, law="balanced"):
    (folder / "species").write_text("# UNITS: lj\ndrop 1.0 inf 0 tension 1\n")
    particles, side = places(dimension)
    fields = {"particles": particles, "side": side, "skin": 0.3, "law": EXACT[law]}
    text = script((plane if dimension == 2 else space).FLUID)
    text += "".join(report(n, SCALARS, COLUMNS) for n in steps)
    return on_grids(text, folder, grids, lists=plane.EACH_STEP, **fields)


def assert_sums(scalars, rows):
    assert scalars.min() > 1e-6
    np.testing.assert_allclose(rows[:, 2:].sum(axis=0), scalars, rtol=1e-12)
    assert np.ptp(rows[:, 2:].sum(axis=1)) > 0.0


@ring_laws
def test_particles_lose_what_all_lose(law, tmp_path):
    grids = ("1 1 1", "2 2 1") if law == "curved" else ("1 1 1", "2 1 1")
    found = reported(fluid(tmp_path, 2, grids, (60,), law), 60)
    for scalars, rows in found.values():
        assert_sums(scalars, rows)
    assert_same(found, 1e-8)


def test_in_space(tmp_path):
    found = reported(fluid(tmp_path, 3, ("1 1 1", "2 2 1"), (40,)), 40)
    for scalars, rows in found.values():
        assert_sums(scalars, rows)
    assert_same(found, 1e-8)


def test_restart(tmp_path):
    fluid(tmp_path, 2, ("1 1 1",), (0,))
    folder = tmp_path / "111"
    start = (folder / "in.script").read_text().rsplit("run 0", 1)[0].replace("processors", "# ")
    scalars = " ".join(f"$({name}:%.17g)" for name in SCALARS.split())
    end = plane.END.format(columns=COLUMNS, scalars=scalars)
    in_process(start + "run 30\nrun 30\n" + end, folder)
    expected = np.loadtxt(folder / "atoms", skiprows=9), np.loadtxt(folder / "terms")
    head, tail = start.split("atom_style")[0], "pair_style" + start.split("pair_style", 1)[1]
    tail = "\n".join(line for line in tail.splitlines() if not line.startswith("velocity"))
    for write, read in ((1, 2), (2, 1)):
        finished(write, start + "run 30\nwrite_restart half\n", folder)
        finished(read, f"{head}\nread_restart half\n{tail}\nrun 30\n{end}", folder)
        rows, found = np.loadtxt(folder / "atoms", skiprows=9), np.loadtxt(folder / "terms")
        np.testing.assert_allclose(found, expected[1], rtol=1e-9)
        assert np.abs(rows - expected[0])[:, 2:].max() <= 1e-9 * expected[0][:, 2:].max()
        assert_sums(found, rows)


def told(scene):
    """Losses of all, of particles (N, 4), and rows of contacts."""
    lmp = scene.lmp
    lost = [lmp.extract_fix("rub", 0, 1, k) for k in LOST]
    pointer, count = lmp.extract_fix("rub", 2, 2), lmp.extract_fix("rub", 2, 4)
    rows = np.array([[pointer[r][c] for c in range(17)] for r in range(count)])
    return np.array(lost), scene.gather("f_rub", 4), rows


@ring_laws
def test_contacts_tell_the_power_of_a_step(law, tmp_path):
    """Of all contacts it is that of the fix, half of it that of a particle, and all at a wall."""
    rng, dt = np.random.default_rng(3), 0.005
    x = np.array([[0.0, 0.0], [1.9, 0.1], [1.0, 1.65], [2.9, 1.7]])
    wall = "fix floor all deformable/wall plane 0 -0.95 0 1\n"
    scene = Grains(
        x, 1.0, f"0.02{WORDS[3:]} ledger yes", tmp_path, rng.uniform(-0.05, 0.05, (4, 2)),
        rng.uniform(-0.1, 0.1, 4), law=law, dt=dt, commands=wall,
    )  # fmt: skip
    scene.run("run 20 post no")
    kinds = np.zeros(4)
    for _ in range(10):
        before, by_particle, rows = told(scene)
        scene.run("run 1 pre no post no")
        after, now, contacts = told(scene)
        assert len(contacts) == len(rows)
        power = contacts[:, 13:]
        np.testing.assert_allclose(power.sum(axis=0) * dt, after - before, rtol=1e-9, atol=1e-17)
        expected = np.zeros((4, 4))
        for (i, j), lost in zip(contacts[:, :2].astype(int), power, strict=True):
            for k in (i, j) if j else (i,):
                expected[k - 1] += (0.5 if j else 1.0) * dt * lost
        np.testing.assert_allclose(now - by_particle, expected, rtol=1e-9, atol=1e-17)
        kinds += after - before
    assert kinds.min() > 1e-12
    scene.run("run 0 post no")
    atoms = told(scene)[1]
    np.testing.assert_array_equal(atoms, now)
    begun = told(scene)[2][:, 13:]
    assert np.abs(begun - power).max() < 0.1 * np.abs(power).max()


def test_a_contact_that_ends_is_counted(tmp_path):
    x = [[-0.98, 0.0], [0.98, 0.0]]
    scene = Grains(x, 1.0, "inf 0.2 0.1 ledger yes", tmp_path, [[-0.1, 0.05], [0.1, -0.05]])
    scene.run("run 200 post no")
    lost, by_particle, _ = told(scene)
    assert scene.terms["contacts"] == 0
    assert lost[1] > 1e-6
    np.testing.assert_allclose(by_particle.sum(axis=0), lost, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(by_particle[0], by_particle[1], rtol=1e-12, atol=1e-18)


def test_words(tmp_path):
    for words, message in (("perhaps", "perhaps"), ("", "ledger")):
        with refuses(message):
            Grains([[0.0, 0.0]], 1.0, f"0.4 0.5 0.1 ledger {words}", tmp_path)
    scene = Grains([[0.0, 0.0]], 1.0, "0.4 0.5 0.1 ledger no", tmp_path)
    with refuses("does not calculate per-atom"):
        scene.run("compute none all reduce sum f_rub[1]\nrun 0")
