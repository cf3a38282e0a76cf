"""A silo with a funnel and a slit of four radii: particles fall through it, energy is kept."""

import numpy as np
import pytest
from laws import LAWS, two_laws
from obstacles import energies
from parallel import assert_same, on_grids, report, reported
from scene import SPECIES, Scene

HOPPER = """
region silo block 0 20 0 40 INF INF
region left prism 7 8 10 18 INF INF -8 0 0 side out
region right prism 12 13 10 18 INF INF 8 0 0 side out
region hopper intersect 3 silo left right
fix hopper all deformable/wall hopper
fix_modify hopper virial yes
fix weight all gravity 5e-4 vector 0 -1 0
fix_modify weight energy yes
fix move all nve
"""
BOX = (-1, 21, -1, 41)
ROWS = np.array([[2 + 2.2 * i + 0.3 * (j % 2), 22 + 2.2 * j] for j in range(5) for i in range(8)])


def hopper(law, commands=""):
    x = ROWS + np.random.default_rng(1).uniform(-0.05, 0.05, ROWS.shape)
    return Scene(x, ["unit"] * 40, BOX, LAWS[law], boundary="f f p", commands=HOPPER + commands)


def through(scene):
    return (scene.x[:, 1] < 10).sum()


@two_laws
@pytest.mark.parametrize(
    ("calls", "steps"), [(10, 1000), pytest.param(50, 6000, marks=pytest.mark.slow)]
)
def test_energy_is_kept(law, calls, steps):
    """To 1e-4 of the energy of motion, without drag; particles pass the slit both ways."""
    scene = hopper(law)
    scene.run("timestep 0.02\nrun 0")
    found = np.array(energies(scene, calls, steps))
    moving = 0.5 * (scene.gather("v", 3) ** 2).sum()
    assert moving > 0.1
    assert np.abs(found - found[0]).max() < 1e-4 * moving
    assert through(scene) >= (0 if calls == 10 else 8)
    assert len(scene.x) == 40


@pytest.mark.slow
@two_laws
def test_run_to_the_end(law):
    """With drag all particles fall through and come to rest on the floor, which bears them."""
    scene = hopper(law, "fix drag all viscous 0.004\n")
    scene.run("timestep 0.05\nrun 60000 post no")
    assert through(scene) == 40
    scene.run("unfix drag\nfix drag all viscous 0.05\nrun 40000 post no")
    floor = scene.force_on_wall("hopper")
    assert floor[1] == pytest.approx(-40 * 5e-4, rel=0.02)
    assert abs(floor[0]) < 0.02 * abs(floor[1])


SCRIPT = """
units lj
dimension 2
boundary f f p
atom_modify map yes
newton on
processors {grid}
read_data {data}
pair_style deformable/ring contact {law}
pair_coeff * * {species} unit
neighbor 0.3 bin
comm_modify vel yes
{walls}
fix balance all balance 100 1.05 shift xy 5 1.05
variable angle equal 0.002*step
region paddle block 8 12 4.9 5.1 INF INF side out rotate v_angle 10 5 0 0 0 1
fix paddle all deformable/wall paddle
timestep 0.05
thermo_style custom step pe f_hopper[1] f_hopper[2] f_paddle f_paddle[1] pxx pxy
thermo_modify norm no
""" + report(20, "pe f_hopper[1] f_hopper[2] f_paddle f_paddle[1] pxx pxy", "x y vx vy fx fy")


@two_laws
def test_two_ranks(law, tmp_path):
    """Forces, the force on each wall and the work of a rotating paddle.

    Twenty steps multiply the rounding, which is that of the last correction of balanced forces.
    """
    scene = hopper(law)
    scene.run("timestep 0.05\nrun 6000 post no")
    data = tmp_path / "data"
    scene.run(f"write_data {data} nofix")
    fields = {"data": data, "law": law, "species": SPECIES, "walls": HOPPER}
    folders = on_grids(SCRIPT, tmp_path, ("1 1 1", "2 1 1", "1 2 1"), **fields)
    found = reported(folders, 20)
    assert np.abs(found["1 1 1"][0][2]) > 1e-6  # forces on the hopper
    assert_same(found, 1e-10, atol=1e-10)
