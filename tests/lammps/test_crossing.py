"""Centers do not pass each other or a thin wall without an error, and walls may go between runs."""

import numpy as np
import pytest
from laws import LAWS, balanced_laws, two_laws
from scene import Scene
from turns import in_turn

STYLES = {law: style if law == "sector" else f"{style} reach 2" for law, style in LAWS.items()}
ROOM = (-4, 4, -4, 4)


def collide(law, x, v, walls=""):
    """Particles of radius 0.5 in motion at constant energy, with steps of 0.001."""
    scene = Scene(x, ["small"] * len(x), ROOM, STYLES[law], commands=walls)
    scene.run("fix move all nve\nfix plane all enforce2d\ntimestep 0.001")
    scene.lmp.scatter("v", 1, 3, np.ctypeslib.as_ctypes(np.ravel(v).astype(float)))
    scene.run("run 3000")
    return np.array(scene.lmp.gather("x", 1, 3)).reshape(-1, 3)


@pytest.mark.parametrize(("law", "aside"), in_turn(LAWS, [0.0, 0.01]))
def test_a_thin_segment_is_not_crossed(law, aside):
    """A center that has crossed would be pushed on, away from its own side."""
    walls = "fix walls all deformable/wall segment 0 -2 0 2\n"
    with pytest.raises(Exception, match=r"atom 1 at .* is only 0\.02.* from 'segment 1' of fix"):
        collide(law, [[-0.8, aside]], [[1.2, 0.0, 0.0]], walls)
    stopped = collide(law, [[-0.8, aside]], [[0.2, 0.0, 0.0]], walls)
    assert stopped[0, 0] < -0.1  # on its way back


@pytest.mark.parametrize(("law", "aside"), in_turn(LAWS, [0.0, 0.01]))
def test_particles_do_not_cross_each_other(law, aside):
    x = [[-0.7, 0.0], [0.7, aside]]
    with pytest.raises(
        Exception, match=r"contact line of atoms 1 and 2 does not lie well in front"
    ):
        collide(law, x, [[2.5, 0.0, 0.0], [-2.5, 0.0, 0.0]])
    stopped = collide(law, x, [[0.2, 0.0, 0.0], [-0.2, 0.0, 0.0]])
    assert stopped[0, 0] < stopped[1, 0] - 0.2  # on their way back


@two_laws
def test_unfix_of_walls_before_a_run_without_setup(law):
    """It was a crash of LAMMPS: the run called the fix that was gone."""
    x = [[-0.5, 0.0], [1.5, 0.0]]
    commands = "fix walls all deformable/wall segment 0 -2 0 2\n"
    scene = Scene(x, ["small"] * 2, ROOM, STYLES[law], commands=commands)
    scene.run("fix move all nve\nfix plane all enforce2d\nrun 2\nunfix walls\nrun 5 pre no")
    assert scene.energy() == 0.0


@balanced_laws
def test_positions_that_are_no_numbers(law):
    scene = Scene([[0.0, 0.0], [0.9, 0.0]], ["small", "small"], ROOM, LAWS[law])
    scene.energy()
    scene.x = np.array([[0.0, 0.0], [np.nan, 0.0]])
    with pytest.raises(Exception, match=r"positions of atoms 1 and 2 are no numbers"):
        scene.run("run 1 pre no")
