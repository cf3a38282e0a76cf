"""fix deformable/proliferate: growth and division, the same on any ranks."""

import re

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts
from lammps import lammps
from laws import LAWS, laws
from parallel import TILED, TWO, finished, lmp, on_grids, report, reported
from scene import BOX, FOUR, HEADER, SPECIES, Scene
from scipy.special import ive
from test_propel import gaussian, uniforms
from test_refusals import refuses, two_particles

SEED, DT, EVERY = 4711, 0.01, 10
STYLE = LAWS["balanced"] + " radius atom"
WALLED = {"boundary": "f f p", "radii": [0.5]}


def grows(rate, division, more="", group="all"):
    words = f"{EVERY} {rate} {division} {SEED} {more}"
    return f"timestep {DT}\nfix grow {group} deformable/proliferate {words}\n"


def test_growth():
    """V grows exponentially, with the density that it has."""
    scene = Scene([[0, 0]], ["any"], BOX, STYLE, radii=[0.4], commands=grows(2.0, 9.0))
    scene.run("set atom 1 mass 3.0\nrun 9")
    assert scene.radii[0] == 0.4
    scene.run("run 1")
    assert scene.radii[0] == pytest.approx(0.4 * np.exp(0.1), rel=1e-14)
    scene.run("run 25")
    assert scene.radii[0] == pytest.approx(0.4 * np.exp(0.3), rel=1e-14)
    assert scene.gather("rmass", 1)[0, 0] == pytest.approx(3.0 * np.exp(0.6), rel=1e-13)


def test_division():
    """Two of the same mass, center and velocity, along the axis of the mother's random numbers."""
    asymmetry = 0.3
    commands = "fix free all nve\n" + grows(0.0, 0.7, f"asymmetry {asymmetry}", "some")
    scene = Scene(
        [[2.9, -1.0], [0.0, 0.0], [0.0, 2.0]], ["any"] * 3, BOX, STYLE, radii=[0.5, 0.4, 0.5],
        commands="group some id 1 2\n" + commands,
    )  # fmt: skip
    scene.run("set atom 1 mass 3.0 vx 0.5\nrun 10")
    r1, _, other, r2 = scene.radii
    assert other == 0.5  # out of the group
    assert scene.lmp.extract_fix("grow", 0, 0) == 1.0
    assert r1**2 + r2**2 == pytest.approx(0.5**2, rel=1e-14)
    numbers = np.array([gaussian(SEED, 1, 10), 0.0])
    share = (r1 / 0.5) ** 2
    u = uniforms(SEED, 1, 10, 5)
    numbers[1] = np.sqrt(-2.0 * np.log(u[2])) * np.cos(2.0 * np.pi * u[3])
    assert share == pytest.approx(0.5 * (1.0 + asymmetry * (2.0 * u[4] - 1.0)), rel=1e-13)
    axis = numbers / np.hypot(*numbers)
    small, large = sorted((r1, r2))
    apart = 0.5 * (small + np.sqrt(4.0 * large**2 - 3.0 * small**2))
    between = (scene.x[0] - scene.x[3] + 3.0) % 6.0 - 3.0  # one is beyond the boundary
    np.testing.assert_allclose(between, apart * axis, atol=1e-13)
    mass = scene.gather("rmass", 1)[[0, 3], 0]
    np.testing.assert_allclose(mass, 3.0 * np.array([share, 1.0 - share]), rtol=1e-13)
    center = scene.x[0] - (1.0 - share) * between  # after ten steps at 0.5
    np.testing.assert_allclose(center % 6.0, [2.95, 5.0], atol=1e-12)
    np.testing.assert_allclose(scene.gather("v", 3)[[0, 3], :2], [[0.5, 0.0]] * 2, atol=1e-3)
    assert scene.lmp.get_natoms() == 4


@laws
def test_pressure_slows(law):
    """dV/dt = rate V (1 - p/P), with p = sum f h/2V over the contacts."""
    x = [[-0.45, 0.0], [0.45, 0.05]]
    scene = Scene(
        x, ["any"] * 2, BOX, f"{LAWS[law]} radius atom", radii=[0.5, 0.6], commands=CONTACTS
    )
    radii = scene.radii
    seen = contacts(scene)
    i = seen["atom"].astype(int) - 1
    bulk = np.bincount(i, seen["force"] * (radii[i] - seen["indentation"]), minlength=2)
    p = bulk / (2.0 * np.pi * radii**2)
    assert (p > 0.0).all()
    most = 1.5 * p.max()
    scene.run(f"reset_timestep 0\n{grows(2.0, 9.0, f'pressure {most}')}uncompute contacts")
    scene.run("run 10")
    grown = radii * np.exp(0.5 * 2.0 * 0.1 * (1.0 - p / most))
    np.testing.assert_allclose(scene.radii, grown, rtol=1e-9)
    scene.run(f"unfix grow\nreset_timestep 0\n{grows(2.0, 9.0, f'pressure {0.5 * p.min()}')}")
    scene.run("run 10")
    np.testing.assert_allclose(scene.radii, grown, rtol=1e-9)  # no more


def test_pressure_units(tmp_path):
    """P is a pressure as LAMMPS tells it, which in units metal is no energy per area."""
    (tmp_path / "species").write_text("cell 1.5 5.0 0 tension 0.5\n")
    radii = []
    for units, nktv2p in (("lj", 1.0), ("metal", 1.6021765e6)):
        lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        lmp.commands_string(
            f"""
            units {units}
            dimension 2
            atom_style sphere
            boundary f f p
            region box block 0 2 0 2 -0.5 0.5
            create_box 1 box
            create_atoms 1 single 1 1 0
            set atom 1 diameter 2.2 mass 1.0
            pair_style deformable/ring radius atom reach 2
            pair_coeff * * {tmp_path}/species cell
            neighbor 0.3 bin
            fix box all deformable/wall xlo 0 xhi 2 ylo 0 yhi 2
            fix grow all deformable/proliferate 10 0.2 100.0 1 pressure {0.5 * nktv2p}
            timestep 0.01
            run 100"""
        )
        radii.append(np.array(lmp.gather("radius", 1, 1))[0])
    assert radii[1] == pytest.approx(radii[0], rel=1e-12)
    assert 1.1 < radii[0] < 1.1 * np.exp(0.09)  # slower than without contacts


SLIT = "fix slit all deformable/wall plane 0 -0.45 0 1 plane 0 0.45 0 -1\n"


@pytest.mark.parametrize("axis", ["stress", "long"])
def test_axis_between_walls(axis):
    """Pressed along y, a particle divides along x."""
    commands = SLIT + grows(0.0, 0.7, f"axis {axis}")
    scene = Scene([[0, 0]], ["any"], BOX, STYLE, commands=commands, **WALLED)
    scene.run("run 10")
    x = scene.x
    np.testing.assert_allclose(x[:, 1], 0.0, atol=1e-12)
    assert abs(x[1, 0] - x[0, 0]) == pytest.approx(0.5 / np.sqrt(2.0), rel=1e-12)


@pytest.mark.parametrize("kappa", [0.0, 0.6, 8.0, 1e6])
@pytest.mark.parametrize("axis", ["stress", "long", "space"])
def test_axes_are_drawn_about_it(axis, kappa, tmp_path):
    """<cos 2 theta> and <cos 4 theta> are I2/I0 and I4/I0, in space <cos^2> that of Fisher.

    1500 particles in a channel along x, at five standard errors.
    """
    number, apart = 1500, 4.0
    x = np.column_stack([apart * np.arange(number), np.zeros(number)])
    box = -2.0, apart * number, -2.0, 2.0
    words = grows(0.0, 0.7, f"axis {axis.replace('space', 'stress')} kappa {kappa}")
    if axis == "space":
        (tmp_path / "species").write_text("# UNITS: lj\ndrop 0.6 inf 0 tension 1\n")
        scene = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        scene.commands_string(
            f"boundary p f f\natom_style sphere\nregion row block {box[0]} {box[1]} -2 2 -2 2\n"
            "create_box 1 row"
        )
        ids = list(range(1, number + 1))
        scene.create_atoms(number, ids, [1] * number, np.insert(x, 2, 0.0, axis=1).ravel().tolist())
        sides = {"y": 0.48, "z": 0.46}  # which open when droplets divide
        walls = "".join(f" {n}lo v_{n}lo {n}hi v_{n}hi" for n in sides)
        open_at_last = "".join(
            f"variable {n}{end} equal {sign}1.0*({at}+0.6*(step>9))\n"
            for n, at in sides.items()
            for end, sign in (("lo", "-"), ("hi", ""))
        )
        scene.commands_string(
            "set group all diameter 1.0 mass 1.0\npair_style deformable/droplet radius atom\n"
            f"pair_coeff * * {tmp_path}/species drop\n{open_at_last}"
            f"fix slit all deformable/wall{walls}\n{words.replace('0.7', '0.5')}run 10"
        )
        places = np.array(scene.gather("x", 1, 3)).reshape(-1, 3)
    else:
        scene = Scene(
            x, ["any"] * number, box, STYLE, boundary="p f p", radii=[0.5] * number,
            commands=SLIT + words,
        )  # fmt: skip
        scene.run("run 10")
        places = scene.x
    assert len(places) == 2 * number
    along = places[:number] - places[number:]
    cosine = along[:, 0] / np.linalg.norm(along, axis=1)
    if axis == "space":
        least = max(kappa, 1e-6)
        first = 1 / np.tanh(least) - 1 / least if least > 1e-3 else least / 3
        moments = [(cosine**2, 1 - 2 * first / least)]
    else:
        moments = [(np.cos(m * np.arccos(cosine)), ive(m, kappa) / ive(0, kappa)) for m in (2, 4)]
    for values, expected in moments:
        assert abs(values.mean() - expected) < 5 * values.std() / np.sqrt(number) + 1e-12


def test_rates_by_place():
    """Of an atom-style variable, at the last step; one that is no rate is refused."""
    x = [[-2.0, 0.0], [0.0, 0.0], [2.0, 0.0]]
    variable = "variable rate atom exp(x/2)\n"
    still = "fix still all move linear 0 0 0\n"
    scene = Scene(x, ["any"] * 3, BOX, STYLE, radii=[0.4] * 3)
    scene.run(variable + still + grows("v_rate", 9.0) + "run 20")
    expected = 0.4 * np.exp(0.1 * np.exp([-1.0, 0.0, 1.0]))
    np.testing.assert_allclose(scene.radii, expected, rtol=1e-13)
    scene.run("variable rate delete\nvariable rate equal 2.0\nrun 10")
    np.testing.assert_allclose(scene.radii, expected * np.exp(0.1), rtol=1e-13)
    scene.run("variable rate delete\nvariable rate atom x")
    with refuses("v_rate gives atom 1 the rate -2: it must be finite and not negative"):
        scene.run("run 10")
    scene.run("variable rate delete")
    with refuses("v_rate needs an atom-style variable: use 'variable rate atom ...'"):
        scene.run("run 10")


@pytest.mark.parametrize("axis", ["stress", "long"])
def test_a_free_particle_divides_in_any_direction(axis):
    scene = Scene([[0.3, 0.4]], ["any"], BOX, STYLE, radii=[0.5], commands=grows(0.0, 0.7))
    other = Scene(
        [[0.3, 0.4]], ["any"], BOX, STYLE, radii=[0.5], commands=grows(0.0, 0.7, f"axis {axis}")
    )
    for each in (scene, other):
        each.run("run 10")
    np.testing.assert_allclose(other.x, scene.x, rtol=0, atol=1e-14)


def test_axis_of_a_droplet(tmp_path):
    """In space, pressed along z and less along y: along x."""
    (tmp_path / "species").write_text("# UNITS: lj\ndrop 0.6 inf 0 tension 1\n")
    droplet = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    droplet.commands_string(
        f"""
        units lj
        boundary f f f
        atom_style sphere
        region box block -3 3 -3 3 -3 3
        create_box 1 box
        create_atoms 1 single 0 0 0
        set atom 1 diameter 1.0 mass 1.0
        pair_style deformable/droplet radius atom
        pair_coeff * * {tmp_path}/species drop
        fix slit all deformable/wall plane 0 0 -0.46 0 0 1 plane 0 0 0.46 0 0 -1 &
            plane 0 -0.48 0 0 1 0 plane 0 0.48 0 0 -1 0
        {grows(0.0, 0.5, "axis stress")}
        run 10"""
    )
    x = np.array(droplet.gather("x", 1, 3)).reshape(-1, 3)
    np.testing.assert_allclose(x[:, 1:], 0.0, atol=1e-12)
    assert abs(x[1, 0] - x[0, 0]) == pytest.approx(0.8 * 2.0 ** (-1.0 / 3.0), rel=1e-12)


def test_what_a_new_particle_has():
    """Group, spin and properties of the mother; fixes take it for a new one."""
    style = STYLE + " kA atom"
    x = [[0, 0], [-2, -2]]
    commands = """
        fix own all property/atom i_clone d_kA i2_two 2 d2_three 3 mol q
        set atom 1 i_clone 7 i2_two[1] 11 i2_two[2] 12 d2_three[2] 0.5 mol 3 charge -0.25
        set atom 1 omega 0.1 0.2 0.3
        set atom 2 i_clone 8
        set group all d_kA 3.5
        group some id 1
        fix crawl all deformable/propel 0.1 inf 4711
    """
    scene = Scene(x, ["any"] * 2, BOX, style, radii=[0.5, 0.4], commands=commands)
    scene.run(grows(0.0, 0.7, "", "some") + "run 10")
    assert list(scene.lmp.gather("i_clone", 0, 1)) == [7, 8, 7]
    assert scene.gather("d_kA", 1)[:, 0].tolist() == [3.5] * 3
    for name, kind, columns in (
        ("i2_two", 0, 2), ("d2_three", 1, 3), ("molecule", 0, 1), ("q", 1, 1), ("omega", 1, 3),
    ):  # fmt: skip
        mother, _, daughter = np.reshape(scene.lmp.gather(name, kind, columns), (3, columns))
        assert mother.any(), name
        assert (daughter == mother).all(), name
    angle = 2.0 * np.pi * uniforms(4711, np.array([1, 2, 3]), 2**64 - 1, 1)[0]
    directions = scene.gather("f_crawl", 2)
    np.testing.assert_allclose(
        directions, np.column_stack([np.cos(angle), np.sin(angle)]), atol=1e-14
    )
    scene.run("run 10")
    assert scene.lmp.get_natoms() == 3  # too small


def test_dipoles():
    """The daughter's is that of the mother."""
    commands = HEADER.format(boundary="p p p").replace("atomic", "hybrid sphere 1 dipole")
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(
        f"""{commands}
        region box block -3 3 -3 3 -0.5 0.5
        create_box 1 box
        create_atoms 1 single 0 0 0
        mass 1 1.0
        set atom 1 diameter 1.0 mass 1.0 dipole 0.3 0.4 0
        pair_style {STYLE}
        pair_coeff * * {SPECIES} any
        {grows(0.0, 0.7)}
        run 10"""
    )
    np.testing.assert_array_equal(
        np.reshape(lmp.gather("mu", 1, 4), (2, 4)), [[0.3, 0.4, 0, 0.5]] * 2
    )


def delete(scene, number):
    scene.run(f"group last id {number}\ndelete_atoms group last compress no\ngroup last delete")


def test_ids_do_not_come_again(tmp_path):
    """After the atom of the largest ID was deleted, with several fixes, and after a restart."""
    x = [[0, 0], [-2, -2], [2, 2]]
    scene = Scene(x, ["any"] * 3, BOX, STYLE, radii=[0.5, 0.4, 0.4], commands="group first id 1")
    scene.run(grows(0.0, 0.7, group="first") + "group second id 2\nrun 1")
    scene.run(grows(0.0, 0.7, group="second").replace("fix grow", "fix other"))
    delete(scene, 3)
    scene.run("run 9")
    delete(scene, 4)
    scene.run("set atom 2 diameter 1.0\nrun 10")
    assert sorted(scene.lmp.numpy.extract_atom("id")[:3]) == [1, 2, 5]
    delete(scene, 5)
    scene.run(f"write_restart {tmp_path / 'ids'}")
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(
        f"""
        read_restart {tmp_path / "ids"}
        pair_style {STYLE}
        pair_coeff * * {SPECIES} any
        neighbor 0.3 bin
        {grows(0.0, 0.3)}
        run 10"""
    )
    assert sorted(lmp.numpy.extract_atom("id")[:4]) == [1, 2, 6, 7]


TISSUE = """
units lj
dimension 2
boundary f f p
atom_style sphere
atom_modify map yes
processors {grid}
region box block -4 4 -4 4 -0.5 0.5
create_box 1 box
{balance}
create_atoms 1 single -0.6 0.1 0
create_atoms 1 single 0.6 -0.1 0
set group all diameter 1.0
set group all mass 1.0
pair_style deformable/ring radius atom{law}
pair_coeff * * {species} cell
neighbor 0.3 bin
region dish cylinder z 0 0 2 -1 1
fix dish all deformable/wall dish
fix grow all deformable/proliferate 50 2.0 1.2 4711 pressure 2.0 axis stress kappa 3.0 asymmetry 0.3
fix move all brownian 1e-9 1 gamma_t 1.0 rng none
fix plane all enforce2d
timestep 0.001
"""
SPECIES_OF_TISSUE = "# UNITS: lj\ncell 0.8 20.0 2.0 tension 1.0\n"
COLUMNS = "x y radius mass"


def test_ranks(tmp_path):
    species = tmp_path / "species"
    species.write_text(SPECIES_OF_TISSUE)
    script = TISSUE + report(800, "atoms f_grow pe", COLUMNS)
    law = " contact radical"  # which ranks need not balance: quick on more ranks than cores
    grids = *TWO, TILED  # whose fix balance comes before the fix
    found = reported(on_grids(script, tmp_path, grids, species=species, law=law), 800)
    scalars, rows = found["1 1 1"]
    assert scalars[0] == scalars[1] + 2 == len(rows) > 5
    for grid, (theirs, of_atoms) in found.items():
        np.testing.assert_allclose(theirs, scalars, rtol=1e-6, err_msg=grid)
        np.testing.assert_allclose(of_atoms[:, 2:], rows[:, 2:], rtol=0, atol=1e-6)
        assert (of_atoms[:, 0] == np.arange(1, len(rows) + 1)).all()


def test_restart(tmp_path):
    """A run goes on: with the numbers of divisions, and the same random numbers."""
    species = tmp_path / "species"
    species.write_text(SPECIES_OF_TISSUE)
    begin = TISSUE.format(grid="* * *", balance="", species=species, law="")
    end = report(800, "atoms f_grow pe", COLUMNS)
    finished(
        1, begin + "run 375\nwrite_restart half.restart\n" + end.replace("800", "425"), tmp_path
    )
    again = begin[begin.index("pair_style") :]
    start = "atom_modify map yes\nread_restart half.restart\n"
    for word in ("scalars425", "atoms425"):
        (tmp_path / word).rename(tmp_path / f"{word}.first")
    finished(1, start + again + end.replace("800", "425"), tmp_path)
    for word, skip in (("scalars425", 0), ("atoms425", 9)):
        first, then = (np.loadtxt(tmp_path / f"{word}{s}", skiprows=skip) for s in (".first", ""))
        np.testing.assert_allclose(then, first, rtol=1e-6, atol=1e-9)


def test_beside_adhesion_and_evaporation(tmp_path):
    """Films and springs follow who is there; LAMMPS' own fix takes particles away."""
    species = tmp_path / "species"
    species.write_text(SPECIES_OF_TISSUE + "adhesion cell cell 0.2\n")
    script = TISSUE.format(grid="* * *", balance="", species=species, law=" contact curved")
    script += "fix die all evaporate 400 1 dish 4711\nrun 800\n"
    script += 'print "$(atoms) $(f_grow) $(f_die)" file counts\n'
    finished(1, script, tmp_path)
    atoms, born, died = np.loadtxt(tmp_path / "counts")
    assert died > 0
    assert atoms == 2 + born - died > 0


def test_refusals():
    scene = Scene([[0, 0]], ["any"], BOX, STYLE, radii=[0.4])
    for words, message in (
        ("10 1 1", "Illegal fix deformable/proliferate command: missing argument"),
        ("0 1 1 1", "N is '0': it must be positive"),
        ("10 -1 1 1", "the rate is '-1': it must not be negative"),
        ("10 1 0 1", "the division size is '0': it must be positive"),
        ("10 1 1 -1", "the seed is '-1': it must not be negative"),
        ("10 1 1 1 x", "keyword 'x': it must be 'pressure', 'axis', 'kappa' or 'asymmetry'"),
        ("10 1 1 1 axis long kappa -1", "kappa is '-1': it must not be negative"),
        ("10 1 1 1 kappa 1", "kappa is that of directions about an axis: use 'axis stress'"),
        ("10 1 1 1 axis", "Illegal fix deformable/proliferate axis command: missing argument"),
        ("10 1 1 1 axis x", "axis 'x' is not 'random', 'stress' or 'long'"),
        ("10 1 1 1 pressure 0", "the pressure is '0': it must be positive"),
        ("10 1 1 1 asymmetry 1", "the asymmetry is '1': it must be at least 0 and below 1"),
    ):
        with refuses(message):
            scene.run(f"fix grow all deformable/proliferate {words}")
    scene.run(grows(1.0, 9.0) + "run_style respa 1")
    with refuses("Fix grow deformable/proliferate cannot be used with run_style respa"):
        scene.run("run 1")
    scene.run("run_style verlet\npair_style deformable/ring")
    scene.run(f"pair_coeff * * {SPECIES} any")
    with refuses("needs radii that grow: use 'radius atom' in pair_style deformable/ring"):
        scene.run("run 1")
    scene.run("unfix shape\nuncompute pair\nthermo_style custom step pe")
    scene.run("pair_style zero 1.0\npair_coeff * *")
    with refuses("needs pair_style deformable/ring, deformable/sector or .*, but pair_style is ze"):
        scene.run("run 1")
    with refuses("needs atoms that have radii: use 'atom_style sphere', not atomic"):
        two_particles().command("fix grow all deformable/proliferate 10 1 1 1")


def test_sides_that_follow():
    """A box that shrinks around its particles grows with them; new IDs go by those of mothers."""
    scene = Scene(FOUR, ["any"] * 4, BOX, STYLE, boundary="s s p", radii=[0.5] * 4)
    scene.run(grows(0.0, 0.7) + "run 10")
    assert scene.lmp.get_natoms() == 8
    apart = np.linalg.norm(scene.x[:4] - scene.x[4:], axis=1)
    np.testing.assert_allclose(apart, 0.5 / np.sqrt(2.0), rtol=1e-12)
    low, high = scene.lmp.extract_box()[:2]
    assert (scene.x >= low[:2]).all()
    assert (scene.x <= high[:2]).all()


TOO_LARGE = "2.0 1.2", "10.0 9.0", "Atom . has a radius of .*, but species cell allows 0.8 at most"
OUTSIDE = (
    *("2.0 1.2 4711", "0.0 0.7 11"),
    "Fix grow deformable/proliferate: atom . would divide across a side of the box: keep atoms",
)


@pytest.mark.parametrize("case", [TOO_LARGE, OUTSIDE], ids=["large", "outside"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_all_ranks_stop(ranks, case, tmp_path):
    species = tmp_path / "species"
    species.write_text(SPECIES_OF_TISSUE)
    old, new, message = case
    script = TISSUE.format(grid="* * *", balance="", species=species, law="")
    if case is OUTSIDE:  # one particle at each side of the box
        script = script.replace("fix dish", "#").replace("0.6 ", "3.999 ")
    done = lmp(ranks, script.replace(old, new) + "run 1000\n", tmp_path)
    assert done.returncode != 0
    assert len(re.findall(f"ERROR: {message}", done.stdout + done.stderr)) == 1
