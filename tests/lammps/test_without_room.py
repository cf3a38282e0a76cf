"""Particles of kA = inf without room for their area: refused in motion, separated by minimizers."""

import numpy as np
import pytest
from laws import EXACT, LAWS, RING_LAWS, ring_laws, two_laws
from parallel import finished
from programs import program
from scene import SPECIES, Scene
from turns import in_turn

WITHOUT_ROOM = 6  # place in the vector of compute pair
MATERIALS = "drop", "fixed", "firm"
refuses = "has no shape that keeps its area.*leave no room"


def lattice(spacing, shake, seed=0, number=4):
    """A square lattice, shaken, and the length of its box."""
    at = (np.arange(number) + 0.5) * spacing
    x = np.array([(a, b) for a in at for b in at])
    shift = np.random.default_rng(seed).uniform(-shake, shake, x.shape)
    return x + shift, number * spacing


def scene_of(law, species, x, length, log="none"):
    box = (0, length, 0, length)
    scene = Scene(x, [species] * len(x), box, f"{law} reach 1.5", log=log)
    scene.run("compute room all pair deformable/ring")
    return scene


def minimized(scene, x=None, iterations=0):
    """The energy after so many iterations, and how many particles have no room."""
    if x is not None:
        scene.x = x
    step = int(scene.lmp.get_thermo("step")) + 1
    scene.run(f"reset_timestep {step}\nminimize 0 1e-12 {iterations} 100000")
    return scene.lmp.get_thermo("pe"), scene.vector("room", WITHOUT_ROOM + 1)[WITHOUT_ROOM]


@pytest.mark.parametrize(("law", "species"), in_turn(RING_LAWS, ["drop", "firm"]))
def test_forces_without_room(law, species):
    """They are the gradient of the energy that a minimizer sees, to 1e-7."""
    x, length = lattice(0.84, 0.03)
    scene = scene_of(EXACT[law], species, x, length)
    minimized(scene, x)
    force = scene.gather("f", 3)[:, :2]
    step, scale = 1e-6, np.abs(force).max()
    for direction in np.random.default_rng(1).normal(size=(3, *x.shape)):
        (up, here), (down, _) = (minimized(scene, x + s * step * direction) for s in (1, -1))
        assert here == len(x)
        slope = (up - down) / (2 * step)
        assert slope == pytest.approx(-np.sum(force * direction), abs=1e-7 * len(x) * scale)


@pytest.mark.parametrize("law", ["balanced", "curved"])
def test_the_next_error_is_about_what_is_wrong_then(law):
    """Also of fewer particles: what had no room is forgotten."""
    x, length = lattice(0.84, 0.03)
    scene = scene_of(EXACT[law], "drop", x, length)
    with pytest.raises(Exception, match=refuses):
        scene.run("run 0")
    scene.run("delete_atoms group all")
    for at in (1.0, 1.0001):
        scene.run(f"create_atoms 1 single {at} 1 0")
    with pytest.raises(Exception, match="contact line of atoms"):
        scene.run("run 0")


@pytest.mark.parametrize(
    ("law", "species", "style"),
    [
        *in_turn(RING_LAWS, MATERIALS, ["fire"]),
        *in_turn(RING_LAWS, MATERIALS[::-1], ["deformable/lbfgs"]),
    ],
)
def test_minimizer_makes_room(law, species, style, tmp_path):
    """From shaken places, closer than the circles allow: then all areas are conserved again."""
    x, length = lattice(0.93, 0.25, seed=2)
    log = tmp_path / "log"
    scene = scene_of(RING_LAWS[law], species, x, length, log)
    scene.run(f"timestep 0.1\nmin_style {style}")
    assert minimized(scene)[1] > 0
    energy, without_room = minimized(scene, iterations=2000)
    assert without_room == 0
    state = scene.evaluate()
    assert state.energy == pytest.approx(energy, rel=1e-9)  # incompressible ones
    np.testing.assert_allclose(state.shape["area"], np.pi * 0.25, rtol=1e-9)
    scene.lmp.close()
    text = log.read_text()
    assert text.count("WARNING: The contacts of") == 1
    assert text.count("WARNING: At the end of the minimization") == 1  # of the first one, at once
    assert "the energy rises" not in text  # it does, from one iteration to the next


def test_wrong_forces_are_told_once_there_is_room(tmp_path):
    x, length = lattice(0.93, 0.25, seed=3)
    log = tmp_path / "log"
    scene = scene_of("deformable/ring", "drop", x, length, log)
    scene.run(f"""
        variable fx atom 0.05*({0.5 * length}-x)
        variable fy atom 0.05*({0.5 * length}-y)
        variable none atom 0
        fix pull all addforce v_fx v_fy 0 energy v_none
        min_style deformable/lbfgs
    """)
    assert minimized(scene, iterations=3000)[1] == 0
    scene.lmp.close()
    text = log.read_text()
    assert text.index("leave no room") < text.index("the energy rises along the forces")


def test_room_beside_another_style(tmp_path):
    x, length = lattice(0.93, 0.25, seed=3)
    log, box = tmp_path / "log", (0, length, 0, length)
    style = "hybrid/overlay deformable/ring contact radical reach 1.5 zero 1.0"
    coeff = f"pair_coeff * * deformable/ring {SPECIES} drop\npair_coeff * * zero"
    scene = Scene(x, ["drop"] * len(x), box, style, coeff=coeff, log=log)
    scene.run("compute room all pair deformable/ring\nmin_style deformable/lbfgs")
    assert minimized(scene, iterations=2000)[1] == 0
    scene.lmp.close()
    assert "leave no room" in log.read_text()
    assert "the energy rises" not in log.read_text()


@two_laws
def test_where_nothing_makes_room(law, tmp_path):
    """Circles that cover more than the box: said at the end, and refused in motion."""
    x, length = lattice(0.87, 0.01)
    log = tmp_path / "log"
    scene = scene_of(RING_LAWS[law], "drop", x, length, log)
    scene.run("min_style fire")
    assert minimized(scene, iterations=20)[1] == 16
    assert "contacts of 16 particles of kA = inf still leave no room" in log.read_text()
    with pytest.raises(Exception, match=refuses):
        scene.energy()


@pytest.mark.parametrize(("law", "shake"), in_turn(RING_LAWS, [0.0, 1e-9, 1e-4]))
def test_motion_is_refused(law, shake):
    """Never forces that vanish, or are no numbers, whatever path the solver takes."""
    for species in ("drop", "fixed"):
        for spacing in (0.8861, 0.884, 0.88):  # of sqrt(pi)/2 = 0.8862 a circle would fit
            x, length = lattice(spacing, shake)
            with pytest.raises(Exception, match=refuses):
                scene_of(RING_LAWS[law], species, x, length).energy()


@ring_laws
def test_particles_with_room_do_not_give_way(law):
    """Also under pressures at which others would: those in a crystal that covers all but 1 %."""
    length = 4 * np.sqrt(np.pi / 4 / 0.99)
    x, _ = lattice(length / 4, 0.001)
    scene = scene_of(EXACT[law], "drop", x, length)
    assert minimized(scene)[1] == 0
    state = scene.evaluate()
    assert state.shape["pressure"].min() > 2 * 0.02 / 0.5
    np.testing.assert_allclose(state.shape["area"], np.pi * 0.25, rtol=1e-9)


def test_sectors_are_refused_as_before():
    x, length = lattice(0.8, 0.05)
    scene = Scene(x, ["fixed"] * 16, (0, length, 0, length), LAWS["sector"])
    with pytest.raises(Exception, match="no shape that keeps the area"):
        scene.run("minimize 0 0 1 1")


SCRIPT = '''
units lj
dimension 2
atom_modify map yes
processors * * 1
region box block 0 4 0 4 -0.5 0.5
create_box 1 box
create_atoms 1 random 18 4711 box overlap 0.6 maxtry 1000
mass * 1.0
print """# drops
drop 0.5 inf 0 tension 1
""" file drops screen no
pair_style deformable/ring contact {law}
pair_coeff * * drops drop
compute room all pair deformable/ring
thermo_style custom step pe c_room[7]
thermo_modify norm no
timestep 0.02
min_style fire
minimize 0 1e-9 {iterations} 100000
print "without room: $(c_room[7])"
print "energy: $(pe:%.9g)"
run 0
print "exact: $(pe:%.9g)"
'''


def told(out, name):
    return float(out.split(f"\n{name}: ")[1].split()[0])


def test_random_start_on_ranks(tmp_path):
    """One rank and two find the same number, warn once, and end with the energy of motion."""
    for ranks in (1, 2):
        out = finished(ranks, SCRIPT.format(law="balanced", iterations=1500), tmp_path)
        assert out.count("WARNING: The contacts of") == 1
        assert told(out, "without room") == 0
        assert told(out, "exact") == pytest.approx(told(out, "energy"), rel=1e-7)
    numbers = set()
    for ranks in (1, 2):
        (tmp_path / "in.soft").write_text(SCRIPT.format(law="radical reach 2.0", iterations=0))
        out = program("lmp", "-in", "in.soft", "-log", "none", cwd=tmp_path, ranks=ranks)
        assert out.returncode != 0  # motion stops
        numbers.add(told(out.stdout, "without room"))
    assert len(numbers) == 1
    assert numbers.pop() > 0


def test_steps_that_are_too_long_name_the_minimizer_of_short_ones():
    x, length = lattice(0.93, 0.03)
    scene = scene_of(EXACT["balanced"], "bubble", x, length)
    with pytest.raises(Exception, match=r"no stable shape.*Use 'min_style deformable/lbfgs'"):
        scene.run("min_style fire\nmin_modify dmax 1\ntimestep 10\nminimize 0 1e-8 200 1000")
    scene.x = x
    scene.run("min_style deformable/lbfgs\nmin_modify dmax 0.05\nminimize 0 1e-8 200 1000")
