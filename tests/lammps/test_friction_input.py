"""Words of fix deformable/friction, and what it refuses."""

import numpy as np
import pytest
from grains import BOX, SPECIES, Grains
from scene import Scene
from test_friction import cloud
from test_refusals import refuses

PAIR = [[-0.98, 0.0], [0.98, 0.0]]

WRONG = {
    "-0.1 1 0": "Fix rub .*: mu must be 0, positive or inf, not -0.1",
    "0.5 inf 0": "Fix rub .*: kt must be .*, not inf",
    "0.5 1 0 damp -3": "Fix rub .*: damp must be .*, not -3",
    "v_ 1 0": "Expected floating point.*'v_'",
    "0.5 1": "Illegal fix deformable/friction",
    "0.5 1 0 damp": "Illegal fix deformable/friction damp",
    "0.5 1 0 gn 2": "Fix rub .*: unknown word 'gn': .*'damp'.*'types'",
    "0.5 1 0 types 1 1 0.1 1 0": "Illegal fix deformable/friction types",
    "0.5 1 0 types 1 1 0.1 1 0 -2": "Fix rub .*: damp must be .*, not -2",
    "0.5 1 0 types 1 3 0.1 1 0 0": "",
}


def test_words(tmp_path):
    scene = Grains(PAIR, 1, "0.5 1 0", tmp_path)
    for words, message in WRONG.items():
        with refuses(message):
            scene.run(f"unfix rub\nfix rub all deformable/friction {words}")
        scene.run("fix rub all deformable/friction 0.5 1 0")


RUNS = {
    "respa": ("run_style respa 2 2 pair 1", "Fix rub .* run_style respa"),
    "energy": ("fix_modify rub energy yes", "Fix rub .*'fix_modify rub energy yes'.*econserve"),
    "no pair": ("pair_style zero 2\npair_coeff * *", "Fix rub .*deformable/ring.* zero"),
}


@pytest.mark.parametrize(("commands", "message"), RUNS.values(), ids=RUNS)
def test_runs(commands, message, tmp_path):
    scene = Grains(PAIR, 1, "0.5 1 0", tmp_path)
    scene.run(commands)
    scene.run("unfix shape\nuncompute pair")
    with refuses(message):
        scene.run("run 0")


def test_time_step_too_long(tmp_path):
    """The message names one that works."""
    scene = Grains(PAIR, 1, "0.5 1 0.1 damp 0.1", tmp_path, dt=10)
    with refuses("Fix rub .*: the time step 10 is too long .* mass 1: use .* or less") as error:
        scene.run("run 0")
    longest = float(str(error.value).split("use ")[1].split()[0])
    # kt dt^2 + 2 gt dt = m/7 and 2 damp dt = m/2
    assert longest == pytest.approx((-0.1 + np.sqrt(0.01 + 1 / 7)) / 1, abs=1e-3)
    scene.run(f"timestep {0.99 * longest}\nrun 0")
    # a pair that is not pressed any further swings with as long a step
    scene.run("run 300 post no")
    assert np.abs(scene.v).max() < 0.1


def test_a_time_step_that_grows_too_long(tmp_path):
    scene = Grains(PAIR, 1, "0 1 0 damp 2", tmp_path, [[-0.01, 0], [-0.01, 0]], dt=0.01)
    scene.run("fix dt all dt/reset 1 NULL 10 0.1 units box")
    with refuses("Fix rub .*: the time step .* is too long .*: use 0.125 or less"):
        scene.run("run 3")


def test_a_time_step_that_does_not_matter_to_minimizers(tmp_path):
    Grains(PAIR, 1, "0.5 1 0", tmp_path, dt=10).run("minimize 0 1e-3 1 10")


def test_sectors_stick(tmp_path):
    (tmp_path / "species").write_text("# UNITS: lj\nring 1.0 1.0 inf\n")
    coeff = f"pair_coeff * * {tmp_path / 'species'} ring"
    commands = "fix rub all deformable/friction 0.5 1 0"
    with refuses("Fix rub .*deformable/sector stick: use deformable/ring"):
        Scene(
            np.array(PAIR), ["ring"] * 2, BOX, "deformable/sector", coeff=coeff, commands=commands
        ).energy()


def said(folder, words, **options):
    scene = Grains(PAIR, 1, "0.5 1 0", folder, log=folder / "log", **options)
    scene.run("run 0 post no\nrun 0 post no")
    scene.lmp.close()
    return (folder / "log").read_text().count(words)


def test_spins_that_do_not_turn_are_told_once(tmp_path):
    assert said(tmp_path, "no fix turns the particles", move="fix move all nve") == 1
    assert said(tmp_path, "no fix turns the particles") == 0


def test_integrators_that_lose_disc_are_told(tmp_path):
    """LAMMPS' versions for threads take disks for spheres, which rolling shows."""
    words, move = "turns particles as spheres, even where it says 'disc'", "fix move all nve/sphere"
    assert said(tmp_path, words) == 0
    assert said(tmp_path, words, move=f"{move}/omp disc") == 1


def test_velocities_without_the_shear_of_the_box_are_told_once(tmp_path):
    words, shear = "without 'remap v'", "fix shear all deform 1 y erate 0.01"
    assert said(tmp_path, words, commands=f"{shear} remap v") == 0
    assert said(tmp_path, words) == 0
    assert said(tmp_path, words, commands=shear) == 1
    assert said(tmp_path, words, commands=f"{shear} remap none") == 1


def test_atoms_without_spins_translate(tmp_path):
    """It is told once; forces are those of spins that are 0, and momentum is kept."""
    (tmp_path / "species").write_text(SPECIES.format(radius=1))
    scene = Scene(
        np.array(PAIR), ["drop"] * 2, BOX, "deformable/ring", log=tmp_path / "log",
        coeff=f"pair_coeff * * {tmp_path / 'species'} drop",
        commands="fix rub all deformable/friction 0.2 1 0\nfix move all nve\ntimestep 0.02",
    )  # fmt: skip
    scene.run("velocity all set 0 0 0\nset atom 1 vy -0.1\nset atom 2 vy 0.1\nrun 100\nrun 1")
    v = scene.gather("v", 3)
    assert np.abs(v.sum(axis=0)).max() < 1e-16
    assert scene.lmp.extract_fix("rub", 0, 1, 1) > 0
    assert abs(v[1, 1]) < 0.1
    scene.lmp.close()
    assert (tmp_path / "log").read_text().count("have no spins") == 1


def test_coefficients_by_type(tmp_path):
    """types I J, ranges, and walls; the last words count."""
    x = [[-0.98, 0], [0.98, 0]]
    walls = "fix floor all deformable/wall plane 0 -0.98 0 1"
    found = {}
    for words in ("", " types * wall 0 1 0 0", " types 1 1 0 1 0 0 types 1 wall 0.1 1 0 0"):
        scene = Grains(x, 1, "0.5 1 0" + words, tmp_path, commands=walls, dt=0.02)
        scene.v = [[0.3, -0.2], [0.3, 0.2]]
        scene.run("run 5")
        rows = scene.rows
        wall = rows[rows[:, 1] == 0]
        pairs = rows[rows[:, 1] > 0]
        found[words] = [np.abs(r[:, 6] / r[:, 5]).max() for r in (wall, pairs)]
    least = 0.01
    for (wall, pair), (most_wall, most_pair) in zip(
        found.values(), [(0.5, 0.5), (0, 0.5), (0.1, 0)], strict=True
    ):
        assert min(least, most_wall) <= wall <= most_wall + 1e-14
        assert min(least, most_pair) <= pair <= most_pair + 1e-14


def test_groups(tmp_path):
    """Both sides must be of the group."""
    scene = Grains(PAIR, 1, "0.5 1 0", tmp_path, commands="group one id 1")
    scene.run("unfix rub\nfix rub one deformable/friction 0.5 1 0\nrun 1")
    assert scene.terms["contacts"] == 0


def test_no_copies(tmp_path):
    scene = Grains(PAIR, 1, "0.5 1 0", tmp_path)
    with refuses("Cannot replicate with fixes that store"):
        scene.run("replicate 2 1 1")


NUMBERS = {
    "0.5 0.6 0.1 damp 0.2 types * wall 0.1 0.2 0.3 0.4": "",
    "v_mu v_kt v_gt damp v_gn types * wall 0.1 v_kw 0.3 v_gw": (
        "variable mu equal 0.5\nvariable kt equal 0.6\nvariable gt equal 0.1\n"
        "variable gn equal 0.2\nvariable kw equal 0.2\nvariable gw equal 2*v_gn\n"
    ),
}


def test_variables_that_rest_are_numbers(tmp_path):
    """Defined before or after the fix."""
    found = []
    for words, variables in NUMBERS.items():
        walls = "fix floor all deformable/wall plane 0 -0.98 0 1"
        v = [[0.3, -0.2], [0.3, 0.2]]
        scene = Grains(PAIR, 1, words, tmp_path, v, 0.1, commands=walls, dt=0.02)
        scene.run(variables + "run 10")
        assert set(scene.rows[:, 1] > 0) == {True, False}
        found.append(scene.rows)
    np.testing.assert_array_equal(*found)


def test_ramps(tmp_path):
    """Each step has the coefficients of its variables; those of types stay."""
    x, radii, v, spin = cloud()
    scene = Grains(
        x, radii, "v_mu v_kt 0 damp v_gn", tmp_path, v, spin, dt=0.04,
        commands="variable mu equal ramp(0,0.1)\nvariable kt equal 0.5+0.1*step*dt\n"
        "variable gn equal vdisplace(0,0.05)",
    )  # fmt: skip
    slid = 0
    for _ in range(4):
        scene.run("run 50")
        _, _, _, _, _, force, friction, _, xi, slides = scene.rows.T
        kt = 0.5 + 0.1 * 0.04 * scene.lmp.get_thermo("step")
        np.testing.assert_allclose(friction, kt * xi, rtol=1e-12, atol=1e-15)
        held = np.abs(friction[slides > 0])
        np.testing.assert_allclose(held, 0.1 * force[slides > 0], rtol=1e-12)
        slid += len(held)
        assert scene.terms["stored"] == pytest.approx(0.5 * kt * np.sum(xi**2), rel=1e-12)
    assert slid > 10
    assert scene.terms["damping"] > 0


def test_the_work_of_a_ramp_is_no_loss(tmp_path):
    """While kt grows the spring gains xi^2/2 dkt, which nothing has lost."""
    lost = []
    for dt in (0.02, 0.01):
        scene = Grains(
            PAIR, 1, "inf v_kt 0", tmp_path, [[-0.01, -0.05], [-0.01, 0.05]], 0.02, dt=dt,
            commands="variable kt equal 0.1+0.2*step*dt\n"
            "group a id 1\ngroup b id 2\nfix press a spring couple b 0.5 0 0 0 1.8",
        )  # fmt: skip
        scene.run(f"run {int(2 / dt)}")
        assert scene.terms["contacts"] == 1
        lost.append(abs(scene.terms["dashpots"]))
    assert lost[0] < 0.01 * scene.terms["stored"]
    assert lost[1] < 0.3 * lost[0]  # second order in the step


VARIABLES = {
    "nothing": ("", "Fix rub .*: v_mu needs an equal-style variable: use 'variable mu equal"),
    "atom": ("variable mu atom x", "Fix rub .*: v_mu needs an equal-style variable"),
    "negative": (
        "variable mu equal 0.1-step",
        "Fix rub .*: mu must be 0, positive or inf, not -0.9",
    ),
    "too stiff": (
        "variable mu equal 1\nvariable kt equal step*step",
        "Fix rub .*the time step 0.5",
    ),
}


@pytest.mark.parametrize(("commands", "message"), VARIABLES.values(), ids=VARIABLES)
def test_variables_that_are_refused(commands, message, tmp_path):
    kt = "v_kt" if "kt" in commands else "0.1"
    scene = Grains(PAIR, 1, f"v_mu {kt} 0", tmp_path, dt=0.5)
    scene.run(commands)
    with refuses(message):
        scene.run("run 4")


SPRINGS = {
    "springs 1 2 3": "fix_modify rub springs: .* 7 numbers for each contact, not 3",
    "springs 1 2 0 0 x 0 0": "Expected floating point parameter.*x",
    "lost 1 2": "",
    "spring none": "",
}


def test_springs_that_are_refused(tmp_path):
    scene = Grains(PAIR, 1, "0.5 1 0", tmp_path)
    for words, message in SPRINGS.items():
        with refuses(message):
            scene.run(f"fix_modify rub {words}")


def test_springs_are_given(tmp_path):
    """A contact that is stretched from the begin; that of particles apart is forgotten."""
    x = [[-0.99, 0], [0.99, 0], [0, 4]]
    scene = Grains(x, 1, "0.5 0.1 0", tmp_path, dt=1e-3)
    scene.run("fix_modify rub lost 3 4 5")
    for words, missing in (("9 1", 9), ("1 9", 9), ("1 -1", -1)):
        with refuses(f"springs: {missing} is neither the ID of an atom"):
            scene.run(f"fix_modify rub springs {words} 0 0 0 0 0")
    scene.run("fix_modify rub springs 1 2 1.98 0 0.05 0.005 0 1 3 1 4 0.5 0.05 0\nrun 1")
    ((*_, force, friction, _, xi, slides),) = scene.rows
    assert xi == pytest.approx(0.05, rel=1e-4)
    assert friction == pytest.approx(0.005, rel=1e-4)
    assert friction < 0.5 * force
    assert not slides
    terms = scene.terms
    assert terms["stored"] == pytest.approx(0.1 * 0.05**2 / 2, rel=1e-3)
    assert [round(terms[name]) for name in ("sliding", "dashpots", "damping")] == [3, 4, 5]
    scene.run("fix_modify rub springs none\nrun 0")
    assert scene.rows[0, 8] == 0


def test_a_pair_of_types_in_both_orders(tmp_path):
    """Two drops beside a ring that slides between them: its ID is the higher one, and the lower."""
    x, v = [[-1.98, 0], [0, 0], [1.98, 0]], [[0, 0], [0, 0.1], [0, 0]]
    scene = Grains(x, 1, "0 1 0 types 1 2 0.5 1 0 0", tmp_path, v, kind=["drop", "ring", "drop"])
    scene.run("run 10")
    left, _, right = scene.gather("f", 3)[:, 1]
    assert left > 1e-5
    assert right == pytest.approx(left, rel=1e-9)
