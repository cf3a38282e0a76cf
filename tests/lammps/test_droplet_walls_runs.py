"""Droplets between walls that move, on ranks, in runs and from restart files."""

import numpy as np
import pytest
from droplet_walls import CUBE, SCENES, SIDE, force_on_walls, region, walled
from meshes import box, words
from parallel import TWO, assert_atoms_change_ranks, assert_same, on_grids, report, reported

START = CUBE + 0.02 * np.random.default_rng(5).normal(size=CUBE.shape)
NEAR = "block -1.99 1.98 -1.96 1.98 -1.97 1.97"
RUN = "velocity all create 2e-4 125\nfix move all nve\n"

MACHINES = {
    "a lid": "variable top equal 1.97-0.1*sin(0.05*step*dt)\n"
    "fix walls all deformable/wall xlo -1.97 xhi 1.98 ylo -1.96 yhi 1.98 zlo -1.97 zhi v_top\n",
    "a cross that turns": "variable angle equal 0.01*step*dt\n"
    + region(
        f"room {NEAR}",
        "bar block -0.4 0.4 -0.3 0.4 -0.9 0.9 side out rotate v_angle 0.1 0 0.05 1 2 3",
    ),
    "rooms that shift and turn": "variable angle equal 0.2*sin(0.02*step*dt)\n"
    "variable dx equal 0.05*sin(0.04*step*dt)\n"
    + region(
        "room prism -1.97 1.98 -1.96 1.98 -1.97 1.96 0.1 -0.05 0.08 move v_dx NULL v_dx "
        "rotate v_angle 0.1 0 0.05 1 -2 3"
    ),
    "a sphere and a ball that breathe": "variable room equal 2.7-0.05*sin(0.05*step*dt)\n"
    "variable post equal 0.72+0.05*sin(0.06*step*dt)\nvariable dx equal 0.05*sin(0.04*step*dt)\n"
    + region("room sphere v_dx 0.01 -0.01 v_room", "post sphere 0 v_dx 0 v_post side out"),
    "a tube that breathes": "variable radius equal 2.39-0.04*sin(0.05*step*dt)\n"
    "variable dx equal 0.03*sin(0.04*step*dt)\nvariable angle equal 0.1*sin(0.03*step*dt)\n"
    + region(
        "room cylinder y v_dx 0.01 v_radius -1.97 1.96 rotate v_angle 0 0 0 1 0 0",
        "post cylinder y 0.01 v_dx 0.45 -0.5 0.5 side out move NULL v_dx NULL",
    ),
    "a cone that moves": "variable dx equal 0.05*sin(0.04*step*dt)\n"
    "variable angle equal 0.2*sin(0.03*step*dt)\n"
    + region(
        "room cone x 0.01 0.02 2.5 2.33 -1.97 1.97 move v_dx NULL v_dx rotate v_angle 0 0 0 1 1 0"
    ),
    "a mesh that turns in a mesh": "variable angle equal 0.01*step*dt\n"
    "variable dx equal 0.05*sin(0.04*step*dt)\nfix room all deformable/wall "
    + words("room", box((-1.97, -1.96, -1.97), (1.98, 1.98, 1.96)))
    + "\nfix walls all deformable/wall "
    + words("surface", box((-0.4, -0.3, -0.9), (0.4, 0.4, 0.9)))
    + " move v_dx NULL v_dx rotate v_angle 0.1 0 0.05 1 2 3\n",
    "wedges that close": "variable out equal 0.15+0.02*sin(0.05*step*dt)\n"
    + region(f"room {NEAR}", "post union 4 a b c d").replace(
        "region post",
        "region a plane 0 0 0 1 1 1 move v_out v_out v_out\n"
        "region b plane 0.15 -0.15 -0.15 1 -1 -1\n"
        "region c plane -0.15 0.15 -0.15 -1 1 -1\n"
        "region d plane -0.15 -0.15 0.15 -1 -1 1\nregion post",
    ),
}


def given(scene):
    return scene.lmp.extract_fix("walls", 0, 0)


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_energy_that_walls_take(machine, tmp_path):
    """The error of the total energy is of second order in the time step, with their work."""
    errors = []
    for step in (0.1, 0.025):
        scene = walled(START, machine, tmp_path, style="deformable/droplet balance 1e-10 100")
        scene.run(f"{RUN}timestep {step}\nthermo_style custom step etotal econserve")
        scene.run("thermo_modify norm no\nrun 0")
        assert given(scene) == 0.0
        before, wrong, most = scene.lmp.get_thermo("etotal"), 0.0, 0.0
        for _ in range(10):
            scene.run(f"run {round(8 / step)} post no")
            total = scene.lmp.get_thermo("etotal")
            assert scene.lmp.get_thermo("econserve") == pytest.approx(
                total + given(scene), abs=1e-13
            )
            most = max(most, abs(given(scene)))
            wrong = max(wrong, abs(total + given(scene) - before))
        errors.append(wrong)
        assert most > 0.01 * before  # the walls do work
    assert errors[1] < 1e-3 * max(most, before)
    assert errors[0] > 6 * errors[1]  # 16, but for where a run has its largest error


def test_force_on_a_wall_is_its_derivative(tmp_path):
    """Of the energy, by the place of a turned brick."""
    words = (
        "brick block -0.44 0.46 -0.45 0.46 -0.46 0.47 side out rotate v_turn 0.1 0 0 1 2 1 move "
    )

    def scene(shift):
        names = "".join(f"variable d{k} equal {d:.17g}\n" for k, d in enumerate(shift))
        return walled(
            START, names + "variable turn equal 0.4\n" + region(words + "v_d0 v_d1 v_d2"), tmp_path
        )

    force = force_on_walls(scene(np.zeros(3)))
    assert np.abs(force).min() > 1e-3
    for k in range(3):
        h = 2e-5
        up, down, up2, down2 = (scene(s * h * np.eye(3)[k]).energy for s in (1, -1, 2, -2))
        slope = (8 * (up - down) - (up2 - down2)) / (12 * h)
        assert slope == pytest.approx(-force[k], abs=1e-6)


def test_minimization(tmp_path):
    """Forces vanish between walls, and a lid does no work in a minimization."""
    scene = walled(START, SCENES["prism"], tmp_path)
    minimize = "min_style fire\nmin_modify dmax 0.02\ntimestep 0.1\nminimize 0 1e-9 3000 9000"
    scene.run(minimize)
    assert np.abs(scene.force).max() < 1e-9
    assert scene.energy > 0
    scene = walled(START, MACHINES["a lid"], tmp_path)
    scene.run(minimize.replace("3000", "20"))
    assert given(scene) == 0.0


def test_restart(tmp_path):
    style = "deformable/droplet balance 1e-11 100"
    walls = SCENES["brick with edges"]
    scene = walled(START, walls, tmp_path, style=style)
    scene.run(f"{RUN}timestep 0.05\nrun 20\nwrite_restart {tmp_path}/half\nrun 20")
    x = scene.x
    scene.run(f"clear\natom_modify map yes\nread_restart {tmp_path}/half\npair_style {style}")
    scene.run(f"pair_coeff * * {tmp_path}/species.deformable s0\n{walls}")
    scene.run("fix move all nve\ntimestep 0.05\nrun 20")
    assert scene.x == pytest.approx(x, abs=1e-9)


SCRIPT = """
units lj
atom_modify map yes
boundary p f p
processors {grid}
region box block -4 4 -4 4 -4 4
create_box 1 box
{atoms}
mass * 1.0
{balance}
pair_style deformable/droplet balance 1e-12 100
pair_coeff * * {species} a
neighbor 0.2 bin
variable top equal 2.97-0.04*step/30
fix walls all deformable/wall ylo -2.97 yhi v_top ball -3.7 0 -3.6 0.6
fix_modify walls virial yes
compute stress all stress/atom NULL virial
fix shape all pair 1 deformable/droplet pressure 0 load 0
thermo_style custom step pe press pxx pyy pzz pxy pxz pyz
thermo_modify norm no
"""
COLUMNS = "x y z fx fy fz f_shape[1] f_shape[2] c_stress[1] c_stress[4]"


def test_ranks(tmp_path):
    """Walls, one of which moves, and a ball at the periodic boundary; forces on them and work."""
    grid = 2.0 * np.array(
        [
            [i, j, k]
            for i in (-1.5, -0.5, 0.5, 1.5)
            for j in (-1, 0, 1)
            for k in (-1.5, -0.5, 0.5, 1.5)
        ]
    )
    grid += [0.9, 0.0, 0.85]  # some cross the middle of the box
    grid += 0.03 * np.random.default_rng(2).normal(size=grid.shape)
    far = np.linalg.norm((grid - [-3.7, 0, -3.6] + SIDE / 2) % SIDE - SIDE / 2, axis=1)
    atoms = "\n".join(
        "create_atoms 1 single {:.17g} {:.17g} {:.17g}".format(*x) for x in grid[far > 1.3]
    )
    (tmp_path / "species").write_text("a 1.0 inf 0 tension 1.0\n")
    scalars = "pe press pxx pyy pzz pxy pxz pyz f_walls f_walls[1] f_walls[2] f_walls[3]"
    commands = SCRIPT + report(0, scalars, COLUMNS)
    commands += "velocity all create 0.01 5 loop geom\nvelocity all set 0.3 NULL 0.3 sum yes\n"
    commands += "fix move all nve\ntimestep 0.03\n" + report(30, scalars, COLUMNS)
    fields = {"atoms": atoms, "species": tmp_path / "species"}
    folders = on_grids(commands, tmp_path, TWO, **fields)
    before, after = (reported(folders, steps) for steps in (0, 30))
    assert_same(before, 1e-10, atol=1e-11)
    assert_same(after, 1e-9, atol=1e-9)
    assert_atoms_change_ranks(before, after)
    assert abs(after["1 1 1"][0][8]) > 1e-3  # the wall does work
