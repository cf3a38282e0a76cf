"""Droplets in space that stick: closed forms, derivatives, memory, what films lose and gain."""

import numpy as np
import pytest
from droplet_walls import ORIGIN, SIDE
from droplets import CASES, STRESS, Droplets
from parallel import TWO, assert_atoms_change_ranks, assert_same, on_grids, report, reported

W = 0.24
TETRAHEDRON = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / np.sqrt(8)
PACKED = CASES[1]


def droplets(x, folder, w=W, radii=1.0, tensions=1.0, box=(16.0, 12.0, 12.0), **options):
    """All pairs have the adhesion w."""
    of = {
        name: np.broadcast_to(value, len(x)).tolist()
        for name, value in (("radius", radii), ("tension", tensions))
    }
    case = {"x": np.array(x, float), "box": list(box), "adhesion": w} | of
    return Droplets(case, folder, **options)


def doublet(distance, folder, w=W, **options):
    return droplets([[6, 6, 6], [6 + distance, 6, 6]], folder, w, **options)


def at(scene, distance):
    """Energy of two droplets, and the force that presses them."""
    energy = scene.energy_at([[6, 6, 6], [6 + distance, 6, 6]])
    return energy, scene.force[1, 0]


def lost(scene):
    return scene.lmp.extract_compute("pair", 0, 1)[5]


def truncated(angle, films):
    """Exact at rest: U, L, and the indentation of a sphere of the radius L without so many caps."""
    C = np.cos(angle)
    L = (1 - films / 4 * (1 - C) ** 2 * (2 + C)) ** (-1 / 3)
    return 4 * np.pi * (1 / L - 1), L, 1 - L * C


@pytest.mark.parametrize("angle", [0.2, 0.5])
def test_doublet_at_rest(angle, tmp_path):
    energy, L, indentation = truncated(angle, 1)
    scene = doublet(2 - 2 * indentation, tmp_path, 2 * (1 - np.cos(angle)))
    scene.run("fix results all pair 1 deformable/droplet area 0 contacts 0 contact_area 0\nrun 0")
    assert scene.energy == pytest.approx(2 * energy, rel=2e-5)
    assert np.abs(scene.force).max() < 1e-5
    assert scene.sums()[0] == pytest.approx(2 * energy, rel=2e-5)
    rows = scene.contacts()
    assert rows[:, 2] == pytest.approx([indentation] * 2, abs=1e-5)
    assert rows[:, 3] == pytest.approx([L * np.sin(angle)] * 2, rel=1e-4)
    area, contacts, film = scene.lmp.numpy.extract_fix("results", 1, 2)[0]
    assert film == pytest.approx(np.pi * (L * np.sin(angle)) ** 2, rel=2e-4)
    free = 2 * np.pi * L**2 * (1 + np.cos(angle))
    assert area == pytest.approx(free + film, rel=1e-5)
    assert contacts == 1


# forces and energies of one droplet: angle; at touch; where the film is torn, with its indentation
TOUCH = [
    (0.1, -0.00924, -0.000054, -0.01567, -0.00569, 0.000020),
    (0.3, -0.1097, -0.00352, -0.1380, -0.0272, -0.00005),
    (0.5, -0.3317, -0.0222, -0.3668, -0.0463, -0.0058),
]


@pytest.mark.parametrize(("angle", "force", "energy", "pull", "gap", "torn"), TOUCH)
def test_films_form_at_touch_and_are_torn(angle, force, energy, pull, gap, torn, tmp_path):
    scene = doublet(2 + 1e-6, tmp_path, 2 * (1 - np.cos(angle)))
    assert scene.energy == 0.0
    found = at(scene, 2 - 1e-9)
    assert found[0] == pytest.approx(2 * energy, rel=0.02)
    assert found[1] == pytest.approx(force, rel=1e-3)
    low, high = 2.0, 2.2
    while high - low > 1e-8:
        middle = 0.5 * (low + high)
        at(scene, 1.99)
        low, high = (middle, high) if at(scene, middle)[1] else (low, middle)
    # at 0.9999 of the least force; the indentation is about a root of what is left
    assert 2 - low == pytest.approx(2 * gap, rel=0.04)
    at(scene, 1.99)
    found = at(scene, low)
    assert found[1] == pytest.approx(pull, rel=1e-3)
    assert found[0] == pytest.approx(2 * torn, abs=1.2e-3)
    assert at(scene, high) == pytest.approx((0.0, 0.0), abs=1e-14)
    assert at(scene, 2 + 1e-6) == pytest.approx((0.0, 0.0), abs=1e-14)


@pytest.mark.parametrize(
    ("distance", "force", "energy"),
    [
        (1.95, -0.319915, -0.343163),
        (1.85, -0.159142, -0.492021),
        (1.75, 0.065528, -0.521009),
        (1.65, 0.279351, -0.416084),
        (1.58, 0.410843, -0.270632),
        (1.8, -0.049021224778, -0.523505477838),
    ],
)
def test_tetrahedron(distance, force, energy, tmp_path):
    """Of another program, with films that turn."""
    scene = droplets(6 + distance * TETRAHEDRON, tmp_path)
    digits = 1e-11 if distance == 1.8 else 6e-7
    assert scene.energy == pytest.approx(energy, abs=digits)
    rows = scene.contacts()
    assert rows[:, 4] == pytest.approx([force] * 12, abs=digits)


def test_unlike_doublet(tmp_path):
    """At the exact distance of rest, with a film that is a cap: 0.03 % of the exact energy."""
    scene = doublet(2.690785573552, tmp_path, radii=(1.0, 2.0))
    assert scene.energy == pytest.approx(-0.153016491631, rel=5e-4)
    assert abs(scene.force[1, 0]) < 2e-3
    for radii, tensions in (((1.0, 2.0), 1.0), ((1.0, 1.4), (1.0, 1.5))):
        scene = doublet(1.9 * np.mean(radii), tmp_path, radii=radii, tensions=tensions)
        h, d = 1e-4, 1.95 * np.mean(radii)
        at(scene, 1.8 * np.mean(radii))
        energy = [at(scene, d + s * h)[0] for s in (1, -1, 2, -2)]
        slope = (8 * (energy[0] - energy[1]) - (energy[2] - energy[3])) / (12 * h)
        assert at(scene, d)[1] == pytest.approx(-slope, abs=1e-9)


def test_a_film_has_one_radius(tmp_path):
    """The middle droplet of a row has another pressure than those at its ends."""
    row = droplets([[3, 6, 6], [4.9, 6, 6], [6.8, 6, 6]], tmp_path).contacts()
    assert len(row) == 4
    assert np.ptp(row[:, 3]) < 1e-9


@pytest.mark.parametrize("radii", [1.0, (1.0, 1.3, 0.8, 1.0)])
def test_forces_of_a_cluster(radii, tmp_path):
    """By the change of the energy: some films are pressed, others pulled."""
    x = 6 + 1.77 * np.mean(radii) * TETRAHEDRON
    x += np.random.default_rng(1).normal(0, 0.03, x.shape)
    scene = droplets(x, tmp_path, radii=radii)
    force = scene.force
    if radii == 1.0:
        assert np.ptp(np.sign(scene.contacts()[:, 4])) == 2
    rng, h = np.random.default_rng(2), 1e-4
    for _ in range(4):
        along = rng.normal(size=x.shape)
        energy = [scene.energy_at(x + s * h * along) for s in (1, -1, 2, -2)]
        slope = (8 * (energy[0] - energy[1]) - (energy[2] - energy[3])) / (12 * h)
        assert slope == pytest.approx(-(force * along).sum(), abs=1e-8)


def test_stress_of_a_packing(tmp_path):
    """By strains, in a periodic box; and sums over atoms."""
    case = PACKED | {"adhesion": 0.1}
    scene = Droplets(case, tmp_path)
    box = np.array(case["box"])
    x, stress, force = scene.x, scene.stress(), scene.force
    sums = scene.sums()
    assert sums[0] == pytest.approx(scene.energy, rel=1e-12)
    assert -sums[1:] / box.prod() == pytest.approx(stress, abs=1e-12)
    h, along = 1e-4, np.random.default_rng(3).normal(size=x.shape)
    energy = [scene.energy_at(x + s * h * along) for s in (1, -1, 2, -2)]
    slope = (8 * (energy[0] - energy[1]) - (energy[2] - energy[3])) / (12 * h)
    assert slope == pytest.approx(-(force * along).sum(), abs=1e-7)
    scene.energy_at(x)
    scene.run("change_box all triclinic")
    moves = {"pxx": "x scale {0}", "pzz": "z scale {0}", "pxy": "xy final {1}"}
    for name, words in moves.items():
        energy = []
        for e in (h, -h, 2 * h, -2 * h):
            scene.run(f"change_box all {words.format(1 + e, e * box[1])} remap\nrun 0")
            energy.append(scene.energy)
            back = " ".join(f"{a} final 0 {edge:.17g}" for a, edge in zip("xyz", box, strict=True))
            scene.run(f"change_box all {back} xy final 0 xz final 0 yz final 0 remap")
        slope = (8 * (energy[0] - energy[1]) - (energy[2] - energy[3])) / (12 * h)
        assert slope == pytest.approx(-stress[STRESS.index(name)] * box.prod(), abs=1e-6), name


def collide(folder, speed, dt, time, **options):
    """Two droplets that meet off center: errors of energy and losses, losses, and the distance."""
    scene = droplets([[6, 6, 6], [8.3, 6.3, 6]], folder, style="deformable/droplet", **options)
    scene.run(f"set atom 1 vx {speed}\nset atom 2 vx {-speed}\nfix move all nve\ntimestep {dt}")
    scene.run("thermo_style custom step pe ke econserve c_pair[*]\nvariable kept equal econserve")
    scene.run("thermo_modify norm no\nrun 0")
    begin, rows = scene.lmp.extract_variable("kept"), []
    for _ in range(10):
        scene.run(f"run {round(0.1 * time / dt)} post no")
        distance = np.linalg.norm(np.diff(scene.x, axis=0))
        rows.append((scene.lmp.extract_variable("kept") - begin, lost(scene), distance))
    return np.array(rows).T


def test_two_droplets_collide_and_ring(tmp_path):
    """Energy and what is lost are constant to second order in the time step."""
    errors = []
    for dt in (0.02, 0.01):
        error, losses, distance = collide(tmp_path, 0.05, dt, 20)
        errors.append(np.abs(error).max())
        assert losses[-1] == pytest.approx(0.043, abs=1e-3)
        assert distance.max() < 2.2
    assert errors[0] < 3e-5
    assert errors[1] < 0.4 * errors[0]


def test_two_droplets_collide_and_part(tmp_path):
    """What the film has when it is torn, below the energy of free droplets, comes back."""
    errors = []
    for dt in (0.02, 0.005):
        error, losses, distance = collide(tmp_path, 0.3, dt, 10)
        errors.append(np.abs(error).max())
        assert losses.max() > 0.04
        assert losses[-1] == pytest.approx(0.0297, abs=3e-3)
        assert distance[-1] > 3
    assert errors[0] < 1e-4
    assert errors[1] < 0.2 * errors[0]


STYLE = "deformable/droplet balance 1e-11 100"
STRETCHED = 2.05


def stretched(folder, **options):
    scene = doublet(1.99, folder, **options)
    return scene, at(scene, STRETCHED)[0]


def test_restart(tmp_path):
    """A stretched film, and a run that goes on in its middle."""
    scene, energy = stretched(tmp_path, style=STYLE)
    assert energy < -0.02
    scene.run("fix move all nve\ntimestep 0.02\nthermo_modify norm no\nrun 50")
    scene.run(f"write_restart {tmp_path}/half\nrun 50")
    x, losses = scene.x, lost(scene)
    scene.run(f"clear\natom_modify map yes\nread_restart {tmp_path}/half\npair_style {STYLE}")
    scene.run(f"pair_coeff * * {tmp_path}/species.deformable s0\nfix move all nve\ntimestep 0.02")
    scene.run("compute pair all pair deformable/droplet\nthermo_style custom step pe c_pair[*]")
    scene.run("run 50")
    assert scene.x == pytest.approx(x, abs=1e-9)
    assert lost(scene) == losses


def test_films_follow_new_ids(tmp_path):
    x = [[1, 1, 1], [6, 6, 6], [7.99, 6, 6]]
    scene = droplets(x, tmp_path)
    x[2][0] = 6 + STRETCHED
    energy = scene.energy_at(x)
    assert energy < -0.02
    scene.run("group gone id 1\ndelete_atoms group gone compress yes\nrun 0")
    assert sorted(scene.lmp.gather("id", 0, 1)) == [1, 2]
    assert scene.energy == pytest.approx(energy, rel=1e-11)


def test_fix_modify(tmp_path):
    _, energy = stretched(tmp_path)
    scene = doublet(STRETCHED, tmp_path)
    assert scene.energy == 0.0
    scene.run("fix_modify deformable_films attached 1 2\nrun 0")
    assert scene.energy == pytest.approx(energy, rel=1e-11)
    scene.run("fix_modify deformable_films attached none\nrun 0")
    assert scene.energy == 0.0


def test_images_along_z(tmp_path):
    """Two droplets in a box so low that each touches two images of the other."""
    x = [[6, 6, 1.0], [6, 6, 3.0]]
    scene = droplets(x, tmp_path, box=(12.0, 12.0, 3.98))
    assert len(scene.contacts()) == 4
    x[1][2] = 2.96  # one film is stretched, the other is pressed
    scene.energy_at(x)
    rows = scene.contacts()
    assert len(rows) == 4
    assert np.ptp(rows[:, 4]) > 0.05


def test_adhesion_ramps(tmp_path):
    """A fix adapt makes droplets stick, and let go."""
    scene = doublet(1.95, tmp_path, w=1e-3)
    scene.run(
        "variable w equal 1e-3+0.012*step\nfix ramp all adapt 1 pair deformable/droplet adhesion "
        "* * v_w\nrun 20\nunfix ramp\nrun 0"
    )
    there = doublet(1.95, tmp_path, w=0.241)
    assert scene.energy == pytest.approx(there.energy, rel=1e-10)


@pytest.mark.parametrize(
    ("w", "message"),
    [
        (2.0, "tension above half of it, 1, not 1: nothing would bound the film"),
        (1.0, "makes a contact angle of 1.047.* rad, but the law of droplets in space is for 0.7"),
    ],
)
def test_refused_adhesions(w, message, tmp_path):
    with pytest.raises(Exception, match=message):
        doublet(2.1, tmp_path, w)
    with pytest.raises(Exception, match=message):
        wall(1.1, tmp_path, 0.5 * w if w == 1.0 else w)


def test_films_beyond_the_model_are_counted_and_told(tmp_path):
    """Angles above 0.7 rad; and films that meet, as two large ones at 60 degrees."""
    scene = doublet(1.9, tmp_path, w=2 * (1 - np.cos(0.75)))
    assert scene.outputs()[0] == 2
    assert "contact angles are above 0.7 rad" in scene.log.read_text()
    assert doublet(1.9, tmp_path, w=2 * (1 - np.cos(0.65))).outputs()[0] == 0
    triangle = 1.7 * np.array([[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]])
    assert droplets(5 + triangle, tmp_path).outputs()[0] == 3
    assert droplets(5 + 1.1 * triangle, tmp_path).outputs()[0] == 0


def wall(height, folder, w, commands="", tension=1.0):
    """A droplet at this height above a wall with adhesion."""
    walls = f"fix walls all deformable/wall plane 0 0 0 0 0 1 adhesion {w}\n" + commands
    case = {"x": [[0, 0, height]], "box": [SIDE] * 3, "low": -0.5 * SIDE}
    case |= {"radius": [1.0], "tension": [tension]}
    return Droplets(case, folder, commands=walls, boundary="f f f")


@pytest.mark.parametrize("angle", [0.3, 0.6])
def test_droplet_at_a_wall(angle, tmp_path):
    """A sessile droplet is a truncated sphere, with cos theta = 1 - w/g."""
    energy, L, indentation = truncated(angle, 1)
    scene = wall(1 - indentation, tmp_path, 1.3 * (1 - np.cos(angle)), tension=1.3)
    assert scene.energy == pytest.approx(1.3 * energy, rel=2e-5)
    assert np.abs(scene.force).max() < 1e-5
    assert scene.contacts()[0, 3] == pytest.approx(L * np.sin(angle), rel=1e-4)


def test_droplet_between_plates(tmp_path):
    """Pressed and pulled, beside the exact answers."""
    for angle, force, indentation, energy in (
        (0.5, 0.2, 0.165395446208, -0.081499534906),
        (0.3, -0.1, -0.001163462740, -0.007557231686),
    ):
        commands = (
            "variable bottom equal -0.99\nvariable top equal 0.99\n"
            "fix walls all deformable/wall zlo v_bottom zhi v_top "
            f"adhesion {1 - np.cos(angle):.17g}\n"
        )
        case = {"x": ORIGIN, "box": [SIDE] * 3, "low": -0.5 * SIDE}
        case |= {"radius": [1.0], "tension": [1.0]}
        scene = Droplets(case, tmp_path, commands=commands, boundary="f f f")
        h = 1 - indentation
        scene.run(f"variable bottom equal {-h:.17g}\nvariable top equal {h:.17g}\nrun 0")
        assert scene.contacts()[:, 4] == pytest.approx([force] * 2, abs=3e-4)
        assert scene.energy == pytest.approx(energy, abs=5e-5)


FLIGHT = """units lj
dimension 3
boundary p p p
atom_style atomic
atom_modify map yes
processors {grid}
region box block 0 {length} 0 10 0 10
create_box 2 box
{particles}
mass * 1
pair_style deformable/droplet balance 1e-11 1000
pair_coeff * * ../species a b
neighbor 0.1 bin
neigh_modify every 1 delay 0 check no
{balance}
velocity all create 0.03 4711 loop geom
velocity all set 0.6 NULL NULL sum yes
fix move all nve
fix drag all deformable/friction 0 0 0 film 0.02 1
timestep 0.05
compute pair all pair deformable/droplet
compute contacts all deformable/contact
compute attached all reduce sum c_contacts[4] inputs local
thermo_style custom step pe ke c_attached c_pair[*]
thermo_modify norm no
"""
STEPS = 24, 16


def flight(folder, grids, length):
    """Droplets of two sizes and tensions that fly, stick and are torn apart, in a box so long."""
    rng = np.random.default_rng(5)
    x = 2.5 * np.array([[i, j, k] for i in range(4) for j in range(4) for k in range(4)]) + 1.2
    x += rng.uniform(-0.15, 0.15, x.shape)
    lines = [
        "create_atoms {} single {:.17g} {:.17g} {:.17g}".format(1 + n % 2, *at)
        for n, at in enumerate(x)
    ]
    (folder / "species").write_text(
        "a 1.15 inf 0 tension 1\nb 1.25 inf 0 tension 1.2\n"
        "adhesion a a 0.2\nadhesion a b 0.15\nadhesion b b 0.05\n"
    )
    script = FLIGHT + "".join(
        report(n, "pe ke c_attached c_pair[6] f_drag[7]", "x y z vx vy vz fx fy fz") for n in STEPS
    )
    fields = {"particles": "\n".join(lines), "length": length}
    folders = on_grids(script, folder, grids, **fields)
    return [reported(folders, n) for n in STEPS]


def test_ranks(tmp_path):
    """Films, energies, drag and forces are those of one rank, also of films across borders."""
    first, second = flight(tmp_path, TWO, 10)
    for found in (first, second):
        assert_same(found, 1e-7, atol=1e-7)
    assert_atoms_change_ranks(first, second)
    for n in (3, 4):  # by films that attach and are torn, and by those that drag
        losses = [found["1 1 1"][0][n] for found in (first, second)]
        assert losses[1] > losses[0] > 0


def test_an_empty_rank(tmp_path):
    """One of two ranks has no droplets, at first."""
    for found in flight(tmp_path, TWO, 24):
        assert_same(found, 1e-7, atol=1e-7)
