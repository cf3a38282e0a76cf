"""Which contacts stick is remembered: in runs, on other ranks, in restart files, beside styles."""

import struct

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts
from lammps import lammps
from laws import EXACT
from parallel import (
    TILED,
    assert_atoms_change_ranks,
    assert_same,
    finished,
    in_process,
    on_grids,
    report,
    reported,
)
from scene import Scene, polygon_walls
from test_films import doublet, droplets, pair_at

W = 0.15
TOUCH, STRETCHED = 2.0 - 1e-3, 2.15


def stretched(folder, **options):
    scene = doublet(TOUCH, folder, W, **options)
    scene.energy()
    return scene, scene.energy(pair_at(STRETCHED))


def test_the_same_distance_is_free_from_afar(tmp_path):
    scene, energy = stretched(tmp_path)
    assert energy > 0.005
    assert scene.energy(pair_at(2.5)) == 0.0
    assert scene.energy(pair_at(STRETCHED)) == 0.0


class Again(Scene):
    """A scene that goes on from a restart file."""

    def __init__(self, file, folder, types="drop0"):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.run(f"atom_modify map yes\nread_restart {file}\npair_style {EXACT['curved']}")
        self.run(f"pair_coeff * * {folder / 'species'} {types}\nneighbor 0.3 bin\n{CONTACTS}")
        self.run("thermo_modify norm no")


def test_a_thousand_neighbor_lists(tmp_path):
    """A doublet that swings beyond the distance of touch and back."""
    scene, energy = stretched(tmp_path, commands=CONTACTS)
    scene.run("fix move all nve\nneigh_modify every 1 delay 0 check no\ntimestep 0.02\nrun 1000")
    assert (contacts(scene)["attached"] == 1).all()
    kinetic = 0.5 * np.sum(scene.gather("v", 3) ** 2)
    assert scene.energy() + kinetic == pytest.approx(energy, abs=1e-4)


@pytest.mark.parametrize("lists", ["every 1 delay 0 check no", "every 100000 delay 0 check no"])
def test_near_pairs_found_again(lists, tmp_path):
    """A pair attaches in flight and swings, with near pairs of many neighbor lists, or of one."""
    scene = doublet(2.021, tmp_path, W, commands=CONTACTS)
    scene.run(f"neighbor 1.0 bin\nneigh_modify {lists}\nfix move all nve\ntimestep 0.01")
    scene.run("thermo_modify norm no\nset atom 1 vx 0.23\nset atom 2 vx -0.23")
    assert scene.energy() == 0.0
    furthest = 0.0
    for _ in range(20):
        scene.run("run 50")
        kinetic = 0.5 * np.sum(scene.gather("v", 3) ** 2)
        lost = scene.vector("pair", 6)[5]
        energy = scene.lmp.get_thermo("pe") + kinetic + lost
        assert energy == pytest.approx(0.23**2, abs=1e-4)
        furthest = max(furthest, np.ptp(scene.gather("x", 3)[:, 0]))
    assert (contacts(scene)["attached"] == 1).all()
    assert furthest > 2.1


def test_restart_file(tmp_path):
    scene, energy = stretched(tmp_path)
    scene.run(f"write_restart {tmp_path / 'restart'}")
    again = Again(tmp_path / "restart", tmp_path)
    assert again.energy() == pytest.approx(energy, rel=1e-12)
    assert (contacts(again)["attached"] == 1).all()


def test_data_file_holds_none(tmp_path):
    """As the manual says: where circles overlap films are there, elsewhere they are not."""
    scene, _ = stretched(tmp_path)
    scene.run(f"write_data {tmp_path / 'data'} nofix")
    again = doublet(3.0, tmp_path, W)
    again.run(f"delete_atoms group all\nread_data {tmp_path / 'data'} add merge")
    assert again.energy() == 0.0


def test_fix_modify(tmp_path):
    """What a caller knows from elsewhere."""
    _, energy = stretched(tmp_path)
    scene = doublet(STRETCHED, tmp_path, W, commands=CONTACTS)
    assert scene.energy() == 0.0
    scene.run("fix_modify deformable_films attached 1 2")
    assert scene.energy() == pytest.approx(energy, rel=1e-11)
    scene.run("fix_modify deformable_films attached none")
    assert scene.energy() == 0.0
    for words, message in {
        "1 2 1": "two IDs for each pair, not 3 words",
        "1 7": "7 is neither the ID of an atom nor the number < 0 of a wall",
        "1 -1": "-1 is neither the ID of an atom nor the number < 0 of a wall",
    }.items():
        with pytest.raises(Exception, match=f"fix_modify deformable_films attached: .*{message}"):
            scene.run(f"fix_modify deformable_films attached {words}")


def test_fix_modify_before_the_first_run(tmp_path):
    """Pairs that it names are attached, others if their circles overlap."""
    _, energy = stretched(tmp_path)
    scene = doublet(STRETCHED, tmp_path, W, commands=CONTACTS)
    scene.run("fix_modify deformable_films attached 2 1")
    assert scene.energy() == pytest.approx(energy, rel=1e-11)
    assert scene.energy() == pytest.approx(energy, rel=1e-11)


def test_a_new_particle_with_the_id_of_a_former_one(tmp_path):
    """It is free, where the former one hung on a film."""
    scene, _ = stretched(tmp_path)
    scene.run("group gone id 2\ndelete_atoms group gone compress no")
    scene.run(f"create_atoms 1 single {STRETCHED} 0 0")
    assert list(scene.lmp.gather("id", 0, 1)) == [1, 2]
    assert scene.energy() == 0.0


LID = "fix lid all deformable/wall plane 0 4 0 -1\n"


def at_faces(folder):
    """A droplet that hangs on two of the four faces of one fix; another fix may come before it."""
    walls = LID + polygon_walls(4, 1.02).rstrip() + " adhesion 0.3\n"
    scene = droplets([[0, 0]], folder, 1e-9, commands=walls + CONTACTS, boundary="f f p")
    scene.run("run 0 post no\nfix_modify deformable_films attached 1 -258 1 -770")
    return scene, walls


def test_numbers_of_walls_stay_when_another_one_comes(tmp_path):
    """They are those of the fix and its face, however many fixes there are."""
    scene, _ = at_faces(tmp_path)
    before = contacts(scene)
    assert sorted(before["attached"]) == [-770, -258]
    for commands in ("fix post all deformable/wall disk 4 0 0.5", "unfix post"):
        scene.run(commands)
        seen = contacts(scene)
        assert (seen["attached"] == before["attached"]).all()
        np.testing.assert_allclose(seen["angle"], before["angle"], rtol=0, atol=1e-9)
    scene.run("unfix lid")
    seen = contacts(scene)
    assert (seen["attached"] == before["attached"] + 1).all()
    np.testing.assert_allclose(seen["angle"], before["angle"], rtol=0, atol=1e-9)


def test_restart_files_whose_numbers_of_walls_depend_on_how_many_there_are(tmp_path):
    """Face f of fix w of two was -1 - (w + 2 f), and the names had no empty line before them."""
    scene, walls = at_faces(tmp_path)
    before = contacts(scene)
    file = tmp_path / "restart"
    scene.run(f"write_restart {file}")
    written = file.read_bytes()
    names = written[written.index(b"\nlid\t") + 1 :].split(b"\0")[0]
    former = written.replace(b"\n" + names + b"\0", names + b"\0\0")
    for face in (1, 3):
        assert former.count(struct.pack("d", -2 - 256 * face)) == 1
        former = former.replace(struct.pack("d", -2 - 256 * face), struct.pack("d", -2 - 2 * face))
    for text in (written, former):
        file.write_bytes(text)
        again = Again(file, tmp_path)
        again.run("compute_modify thermo_temp extra/dof 0\n" + walls)
        seen = contacts(again)
        assert (seen["attached"] == before["attached"]).all()
        np.testing.assert_allclose(seen["angle"], before["angle"], rtol=0, atol=1e-9)


def test_without_its_fix(tmp_path):
    scene, _ = stretched(tmp_path)
    scene.run("unfix deformable_films")
    with pytest.raises(
        Exception, match="Fix deformable_films was deleted, which knew the attached"
    ):
        scene.run("run 0")
    scene.run(f"pair_style {EXACT['curved']}\npair_coeff * * {tmp_path / 'species'} drop0")
    assert scene.energy() == 0.0


def test_lost_energy_goes_on(tmp_path):
    """What attaching has cost is part of econserve, also after a restart."""
    scene = doublet(2.02, tmp_path, W)
    scene.run("fix move all nve\ntimestep 0.01\nset atom 1 vx 0.1")
    scene.run("thermo_style custom step pe econserve c_pair[6]\nthermo_modify norm no\nrun 0")
    scene.run("variable kept equal econserve")
    begin = scene.lmp.extract_variable("kept")
    scene.run(f"run 100\nwrite_restart {tmp_path / 'restart'}")
    lost = scene.vector("pair", 6)[5]
    assert lost > 0.01
    assert scene.lmp.extract_variable("kept") == pytest.approx(begin, abs=1e-4)
    again = Again(tmp_path / "restart", tmp_path)
    again.run("fix move all nve\ntimestep 0.01\nvariable kept equal econserve")
    again.run(
        "compute pair all pair deformable/ring\nthermo_style custom step pe econserve c_pair[6]"
    )
    again.run("thermo_modify norm no\nrun 100")
    assert again.vector("pair", 6)[5] == lost
    assert again.lmp.extract_variable("kept") == pytest.approx(begin, abs=1e-4)


def test_a_pair_style_that_is_defined_again(tmp_path):
    scene, energy = stretched(tmp_path)
    scene.run(f"pair_style {EXACT['curved']}\npair_coeff * * {tmp_path / 'species'} drop0")
    assert scene.energy() == pytest.approx(energy, rel=1e-12)


def test_images_of_one_partner(tmp_path):
    """Two particles in a box so small that each touches two images of the other."""
    box = (0, 4.1, -5, 5)
    scene = doublet(TOUCH, tmp_path, W, box=box, commands=CONTACTS)
    scene.energy()
    assert len(contacts(scene)["attached"]) == 2
    scene.energy(pair_at(2.15))  # the other image touches now, this one is stretched
    seen = contacts(scene)
    assert (seen["attached"] == 1).all()
    assert len(seen["attached"]) == 4
    for distance in (1.9, 2.2):
        scene.energy(pair_at(distance))
        assert len(contacts(scene)["attached"]) == 4


# droplets that fly, stick and are torn apart; neighbor lists are new every few steps
FLIGHT = """units lj
dimension 2
boundary p p p
atom_style atomic
atom_modify map yes
processors {grid}
region box block 0 12 0 12 -0.5 0.5
create_box 2 box
{particles}
mass * 1
pair_style deformable/ring contact curved balance 1e-11 1000
pair_coeff * * ../species drop0 drop1
neighbor {skin} bin
neigh_modify {lists}
comm_modify cutoff 5.5
{balance}
velocity all create 0.03 4711 loop all
velocity all set NULL NULL 0.0
fix move all nve
fix flat all enforce2d
timestep {dt}
compute pair all pair deformable/ring
compute contacts all deformable/contact
compute attached all reduce sum c_contacts[15] inputs local
thermo_style custom step pe ke c_attached c_pair[*]
thermo_modify norm no
"""


STEPS = 80, 60
EACH_STEP = "every 1 delay 0 check no"


def flight(folder, grids, skin=0.1, steps=STEPS, lists=EACH_STEP, dt=0.02):
    rng = np.random.default_rng(5)
    x = np.array([[1.2 + 2.4 * i, 1.2 + 2.4 * j] for i in range(5) for j in range(5)])
    x += rng.uniform(-0.1, 0.1, x.shape)
    kinds = [1 + (n % 3 == 0) for n in range(25)]
    (folder / "species").write_text(
        "# UNITS: lj\ndrop0 1.0 inf 0 tension 1\ndrop1 1.2 inf 0.3 tension 1.1\n"
        f"adhesion drop0 drop0 {W}\nadhesion drop0 drop1 0.3\nadhesion drop1 drop1 0.05\n"
    )
    lines = [f"create_atoms {k} single {a} {b} 0" for k, (a, b) in zip(kinds, x, strict=True)]
    script = FLIGHT + "".join(
        report(n, "pe ke c_attached c_pair[6]", "x y vx vy fx fy") for n in steps
    )
    fields = {"particles": "\n".join(lines), "skin": skin, "lists": lists, "dt": dt}
    return on_grids(script, folder, grids, **fields)


def test_ranks(tmp_path):
    """Films, energies and forces are those of one rank, while they come and go across borders."""
    folders = flight(tmp_path, ("1 1 1", TILED))
    first, second = (reported(folders, n) for n in STEPS)
    for found in (first, second):
        assert_same(found, 1e-7)
    assert_atoms_change_ranks(first, second)
    attached = [found["1 1 1"][0][2] for found in (first, second)]
    lost = [found["1 1 1"][0][3] for found in (first, second)]
    assert attached[0] > 20
    assert attached[1] > attached[0]
    assert lost[1] > lost[0] > 0


def test_four_ranks(tmp_path):
    found = reported(flight(tmp_path, ("1 1 1", "2 2 1"), steps=(24,), dt=0.04), 24)
    assert found["1 1 1"][0][2] > 10
    assert_same(found, 1e-9)


def test_neighbor_lists(tmp_path):
    """The same where neighbor lists are new in each step, or seldom."""
    found = {}
    for grid, skin in (("1 1 1", 0.1), ("seldom", 0.7)):
        (tmp_path / grid).mkdir()
        every = "every 10 delay 0 check yes" if skin > 0.5 else "every 1 delay 0 check no"
        folders = flight(tmp_path / grid, ("1 1 1",), skin, (100, 400), every)
        found[grid] = reported(folders, 400)["1 1 1"]
    assert_same(found, 1e-5)


def test_energy_and_what_is_lost(tmp_path):
    """Their sum is constant to second order in the time step, while films come and go."""
    errors = []
    for dt in (0.02, 0.0025):
        (tmp_path / str(dt)).mkdir()
        folders = flight(tmp_path / str(dt), ("1 1 1",), steps=(int(8 / dt),), dt=dt)
        potential, kinetic, attached, lost = reported(folders, int(8 / dt))["1 1 1"][0]
        assert attached > 40
        assert lost > 1
        errors.append(potential + kinetic + lost - 24 * 0.03)
    assert abs(errors[0]) < 1e-3
    assert abs(errors[1]) < 0.1 * abs(errors[0])  # 1/64, with room for films at chance times


def test_a_film_stays_where_its_partner_comes_near_fast(tmp_path):
    """From one neighbor list to the next it moves by more than the distance that is left."""
    x = [[3.4, 4.0], [4.6, 4.0]]
    scene = droplets(x, tmp_path, 0.9, (0.5,), (0, 8, 0, 8), commands=CONTACTS)
    scene.run("compute films all pair deformable/ring\nfix move all nve\ntimestep 0.01")
    scene.run("set atom 1 vx 0.4\nset atom 2 vx -0.4\nrun 90")
    assert np.ptp(scene.x[:, 0]) < 0.3
    assert (contacts(scene)["attached"] == 1).all()
    kinetic, lost = 0.5 * np.sum(scene.gather("v", 3) ** 2), scene.vector("films", 6)[5]
    assert 0.0 < lost < 0.3
    assert scene.energy() + kinetic + lost == pytest.approx(0.16, abs=1e-3)


def test_restart_file_of_two_ranks(tmp_path):
    """The first rank has no film: the room that a reader needs is that of all ranks."""
    species = f"# UNITS: lj\ndrop0 1.0 inf 0 tension 1\nadhesion drop0 drop0 {W}\n"
    (tmp_path / "species").write_text(species)
    places = [(2, 6), (8, 6), (9.9, 6), (8.95, 7.6), (7, 7.6), (8, 4.1)]
    start = FLIGHT[: FLIGHT.index("pair_style")].replace("create_box 2", "create_box 1")
    particles = "\n".join(f"create_atoms 1 single {x} {y} 0" for x, y in places)
    start = start.format(grid="2 1 1", particles=particles)
    style = f"""pair_style {EXACT["curved"]}
pair_coeff * * species drop0
comm_modify cutoff 5.5
compute contacts all deformable/contact
compute attached all reduce sum c_contacts[15] inputs local
thermo_style custom step pe c_attached
run 0
"""
    stretch = "change_box all x scale 1.06 y scale 1.06 remap\nrun 0\n"
    show = 'print "$(pe) $(c_attached)" file '
    finished(2, start + style + stretch + show + "two\nwrite_restart half\n", tmp_path)
    in_process("read_restart half\n" + style + show + "one\n", tmp_path)
    two, one = (np.loadtxt(tmp_path / name) for name in ("two", "one"))
    assert two[1] >= 10  # beyond touch
    np.testing.assert_allclose(one, two, rtol=1e-9)


# ---- several styles of a hybrid one ----


ONE = "pair_style {law}\npair_coeff * * species drop drop"
EACH = """
pair_coeff * * deformable/ring 1 species drop NULL
pair_coeff * * deformable/ring 2 species NULL drop
pair_coeff 1 2 none
"""
STYLES = {
    "hybrid": f"pair_style hybrid {{law}} {{law}}{EACH}",
    "hybrid/overlay": f"pair_style hybrid/overlay {{law}} {{law}}{EACH}",
}
TWO_PAIRS = """units lj
dimension 2
region box block -6 6 -4 4 -0.5 0.5
create_box 2 box
create_atoms 1 single -4 0 0
create_atoms 1 single {left} 0 0
create_atoms 2 single 1 0 0
create_atoms 2 single {right} 0 0
mass * 1
{style}
group pulled id 2 4
thermo_modify norm no
run 0
displace_atoms pulled move {pull} 0 0
run 0
run 0
print "$(pe:%.17g)" file energy
"""


@pytest.mark.parametrize("style", STYLES.values(), ids=STYLES)
def test_two_styles(style, tmp_path):
    """Each of two curved styles knows its own films."""
    (tmp_path / "species").write_text(f"drop 1.0 inf 0 tension 1\nadhesion drop drop {W}\n")
    places = {"left": -4 + TOUCH, "right": 1 + TOUCH, "pull": STRETCHED - TOUCH}
    found = []
    for text in (ONE, style):
        in_process(TWO_PAIRS.format(style=text.format(law=EXACT["curved"]), **places), tmp_path)
        found.append(float((tmp_path / "energy").read_text()))
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[0] > 0.01


SWAPPED = STYLES["hybrid"].replace("ring 1", "ring 3").replace("ring 2", "ring 1")
SWAPPED = SWAPPED.replace("ring 3", "ring 2")
AGAIN = """{style}
run 0
print "$(pe:%.17g)" file energy
"""


@pytest.mark.parametrize("then", [ONE, SWAPPED], ids=["one style", "another order"])
@pytest.mark.parametrize("style", [ONE, STYLES["hybrid"]], ids=["one", "hybrid"])
def test_styles_are_defined_otherwise(style, then, tmp_path):
    """Films belong to particles, not to a style or its number."""
    (tmp_path / "species").write_text(f"drop 1.0 inf 0 tension 1\nadhesion drop drop {W}\n")
    places = {"left": -4 + TOUCH, "right": 1 + TOUCH, "pull": STRETCHED - TOUCH}
    found = []
    law = EXACT["curved"]
    first = TWO_PAIRS.format(style=style.format(law=law), **places)
    for more in ("", AGAIN.format(style=then.format(law=law))):
        in_process(first + more, tmp_path)
        found.append(float((tmp_path / "energy").read_text()))
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[0] > 0.01


# far droplets, the first of which has films with all: it moves to the one in the middle
MANY = """units lj
dimension 2
boundary p p p
atom_style atomic
atom_modify map yes
processors {grid}
read_data ../data
mass * 1
pair_style deformable/ring contact curved
pair_coeff * * ../species drop0
compute contacts all deformable/contact
compute attached all reduce sum c_contacts[15] inputs local
thermo_style custom step pe c_attached
run 0
fix_modify deformable_films attached {films}
set atom 1 x {x} y {x}
"""


def test_a_particle_with_many_films_changes_ranks(tmp_path):
    """It goes along x and y at once, by way of a rank that knows no particle of this size."""
    side, number = 6.0, 60
    (tmp_path / "species").write_text(
        f"# UNITS: lj\ndrop0 1.0 inf 0 tension 1\nadhesion drop0 drop0 {W}\n"
    )
    x = side * np.stack(np.meshgrid(np.arange(number), np.arange(number)), -1).reshape(-1, 2)
    end = number * side - 1.0
    rows = "\n".join(f"{n} 1 {a} {b} 0" for n, (a, b) in enumerate(x, 1))
    (tmp_path / "data").write_text(
        f"droplets\n\n{len(x)} atoms\n1 atom types\n-1 {end} xlo xhi\n-1 {end} ylo yhi\n"
        f"-0.5 0.5 zlo zhi\n\nAtoms\n\n{rows}\n"
    )
    films = " ".join(f"1 {n}" for n in range(2, len(x) + 1))
    middle = side * (number // 2) + STRETCHED / np.sqrt(2)
    script = MANY + report(0, "pe c_attached", "x y fx fy")
    found = reported(on_grids(script, tmp_path, ("1 1 1", "2 2 1"), films=films, x=middle), 0)
    assert found["1 1 1"][0][1] == 2  # seen from both sides
    assert_same(found)
