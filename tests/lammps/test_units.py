"""One scene in several units: the same physics, guards and numbers in messages."""

import numpy as np
import pytest
from test_refusals import refuses
from turns import in_turn
from units import CASES, LJ, Units, quiet

PLANE = """
units {style}
dimension 2
atom_style sphere 1
atom_modify map yes
boundary p f p
neighbor <0.3 L> bin
region box block <0 L> <4.2 L> <-0.5 L> <5.5 L> <-0.5 L> <0.5 L>
create_box 2 box
create_atoms 1 single <0.5 L> <0.93 L> 0
create_atoms 1 single <2.4 L> <0.96 L> 0
create_atoms 2 single <1.45 L> <2.5 L> 0
create_atoms 1 single <3.4 L> <2.6 L> 0
create_atoms 2 single <2.45 L> <4.13 L> 0
set type 1 diameter <2 L>
set type 2 diameter <1.9 L>
set group all mass <1.3 M>
velocity all set 0 0 0
set atom 1 vx <0.05 L T-1> vy <-0.03 L T-1>
set atom 5 vx <-0.1 L T-1> vy <-0.05 L T-1>
pair_style deformable/{law} radius atom
pair_coeff * * {species} a b
variable fall equal <-0.02 L T-1>*step*dt
region lid plane 0 <5 L> 0 0 -1 0 move NULL v_fall NULL
fix floor all deformable/wall plane 0 0 0 1 disk <3.4 L> <0.3 L> <0.4 L>
fix lid all deformable/wall lid
fix move all nve/sphere disc
timestep <0.02 T>
neigh_modify every 1 delay 0 check yes
compute rows all deformable/contact
compute pair all pair deformable/{name}
compute turning all erotate/sphere
fix shape all pair 1 deformable/{name} area 0 pressure 0
thermo_style custom step pe ke press pxy econserve
thermo_modify norm no
"""
RUB = "fix rub all deformable/friction 0.4 <3 E L-2> <0.1 E T L-2> damp <0.2 E T L-2>\n"
PUSH = "fix push all deformable/propel <0.1 E L-1> <0.5 T> 4711\n"
STICK = (
    "fix_modify deformable_films attached none\nfix sticky all deformable/wall plane 0 0 0 1 "
    "adhesion <0.15 E L-1>\n"
)
DROPS = "a <1 L> inf 0 tension <1 E L-1>\nb <1 L> inf <0.1 E L-2> tension <0.7 E L-1>\n"
BUBBLES = "a <1 L> <2 E L-4> <0.5 E L-2> tension <0.4 E L-1> skin <0.03 L>\nb <1 L> <1 E L-4> inf\n"
STICKY = DROPS + "adhesion a b <0.2 E L-1>\n"
RINGS = "a <1 L> <30 E L-4> inf\nb <1 L> <40 E L-4> inf\n"
EXACT = "ring contact {} balance 1e-12 300"
# law, species, more commands, steps
PLANES = {
    "droplets that rub": (EXACT.format("balanced"), DROPS, RUB, 60),
    "soft rings that rub": (EXACT.format("curved"), BUBBLES, RUB, 60),
    "droplets that stick": (EXACT.format("curved"), STICKY, STICK + RUB, 60),
    "rings": ("ring contact radical", RINGS, RUB + PUSH, 60),
    "sectors": ("sector", RINGS, PUSH, 10),  # until one has a single contact
}

SPACE = """
units {style}
atom_style sphere 1
atom_modify map yes
boundary p p f
neighbor <0.3 L> bin
region box block <0 L> <4.2 L> <0 L> <4.2 L> <-1 L> <5 L>
create_box 1 box
create_atoms 1 single <0.9 L> <0.9 L> <0.95 L>
create_atoms 1 single <2.85 L> <2.7 L> <0.93 L>
create_atoms 1 single <0.95 L> <2.8 L> <2.3 L>
create_atoms 1 single <2.8 L> <0.8 L> <2.4 L>
set group all diameter <2 L>
set group all mass <1.3 M>
velocity all set <0.01 L T-1> <-0.02 L T-1> <0.05 L T-1>
pair_style deformable/droplet balance 1e-12 300
pair_coeff * * {species} a
variable fall equal <-0.02 L T-1>*step*dt
region lid plane 0 0 <3.35 L> 0 0 -1 move NULL NULL v_fall
fix floor all deformable/wall zlo 0 ball <5.15 L> <2.8 L> <0.85 L> <0.5 L>
fix lid all deformable/wall lid
fix move all nve
timestep <0.02 T>
neigh_modify every 1 delay 0 check yes
compute rows all deformable/contact
compute pair all pair deformable/droplet
fix shape all pair 1 deformable/droplet area 0 pressure 0
thermo_style custom step pe ke press pxy econserve
thermo_modify norm no
"""


def scene(units, text, folder, species, **words):
    (folder / "species").write_text(units.written(species))
    lmp = quiet()
    text = text.format(species=folder / "species", style=units.style, **words)
    lmp.commands_string(units.written(text))
    return lmp


def results(lmp, units, dimension, fixes):
    """Everything that a user may read, in the units of the scene."""
    E, L, T = units.E, units.L, units.T
    pressure = units.one(f"P E L-{dimension}")
    found = {key: lmp.get_thermo(key) / E for key in ("pe", "ke", "econserve")}
    found |= {key: lmp.get_thermo(key) / pressure for key in ("press", "pxy")}
    found["evaluations"] = lmp.extract_compute("pair", 0, 1)[0]
    columns = {"x": L, "v": L / T, "f": E / L, "omega": 1 / T, "torque": E}
    for name, one in columns.items():
        found[name] = np.array(lmp.gather(name, 1, 3)) / one
    shape = np.array(lmp.gather("f_shape", 1, 2)).reshape(-1, 2)
    found["shape"] = shape / [L**2, E / L**dimension]
    rows = np.array(lmp.numpy.extract_compute("rows", 2, 2))
    F = E / L
    of_plane = [1, 1, L, L, F, L, L, 1, L, 1, 1, F, F, 1, 1]
    of_space = [1, 1, L, L, F, L, L, L, 1, 1, 1, L, F, F, F, 1, 1, 1, 1 / L, 1, 1]
    rows = rows / (of_plane if dimension == 2 else of_space)
    found["rows"] = rows[np.lexsort(rows[:, :2].T)]
    for fix, ones in fixes.items():
        found[fix] = lmp.extract_fix(fix, 0, 0) / E
        found[f"{fix}[]"] = [
            lmp.extract_fix(fix, 0, 1, k) / one for k, one in enumerate(ones(F, E))
        ]
    return found


def wall(F, E):
    return [F] * 3


def rub(F, E):
    return [E] * 4 + [1, 1]


def assert_same(found, expected, rounding):
    for name, value in expected.items():
        scale = np.abs(value).max()
        np.testing.assert_allclose(
            found[name], value, rtol=0, atol=rounding * max(scale, 1e-3), err_msg=name
        )


def run_in(units, kind, folder):
    if kind == "space":
        lmp = scene(units, SPACE, folder, "a <1 L> inf 0 tension <1 E L-2>\n")
        fixes, steps = {"floor": wall, "lid": wall}, 60
    else:
        law, species, more, steps = PLANES[kind]
        name = law.split()[0]
        lmp = scene(units, PLANE, folder, species, law=law, name=name)
        lmp.commands_string(units.written(more))
        fixes = {"floor": wall, "lid": wall} | ({"rub": rub} if "rub" in more else {})
    lmp.command(f"run {steps}")
    return results(lmp, units, 3 if kind == "space" else 2, fixes)


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    known = {}

    def of(kind):
        if kind not in known:
            known[kind] = run_in(Units(*LJ), kind, tmp_path_factory.mktemp("lj"))
        return known[kind]

    return of


@pytest.mark.parametrize(("units", "kind"), in_turn(CASES, [*PLANES, "space"]))
def test_runs(units, kind, reference, tmp_path):
    units, expected = Units(*CASES[units]), reference(kind)
    solved = 100.0 if "stick" in kind else 1.0  # films are balanced to fewer digits
    assert_same(run_in(units, kind, tmp_path), expected, solved * units.rounding)
    assert expected["ke"] > 0
    assert np.abs(expected["lid[]"]).max() > 0


def test_sectors_say_that_one_contact_has_no_unit(tmp_path):
    """Its stiffness is the number of kA, as in the paper."""
    for style, count in (("lj", 0), ("metal", 1)):
        lmp = quiet()
        lmp.commands_string(f"log {tmp_path}/log\nunits {style}\npair_style deformable/sector")
        lmp.close()
        said = (tmp_path / "log").read_text()
        assert said.count("WARNING: Pair style deformable/sector: the energy of a contact") == count


POLYGONS = """
units {style}
dimension 2
atom_style bond
neighbor <0.1 L> bin
region box block <-2 L> <2 L> <-2 L> <2 L> <-0.5 L> <0.5 L>
create_box 1 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
{atoms}
mass 1 <1.3 M>
pair_style deformable/edge <0.6 L>
pair_coeff * * <3 E L-2> <0.2 L>
neigh_modify exclude molecule/intra all
bond_style harmonic
bond_coeff * <5 E L-2> <0.45 L>
{bonds}
special_bonds lj 1 1 1
region floor plane 0 <-1 L> 0 0 1 0
fix floor all deformable/stick floor <4 E L-2> radius <0.1 L>
fix area all deformable/polygon <2 E L-4>
fix move all nve
velocity all set <0.3 L T-1> <-0.1 L T-1> 0
timestep <0.02 T>
thermo_style custom step pe ke press pxy
thermo_modify norm no
"""


def polygons(units):
    """Two octagons on a floor, one on the other."""
    atoms, bonds = "", ""
    for m, middle in enumerate([(0.0, -0.33), (0.2, 0.95)]):
        for k in range(8):
            x, y = np.array(middle) + 0.6 * np.array([np.cos(k * np.pi / 4), np.sin(k * np.pi / 4)])
            atom = 8 * m + k + 1
            atoms += f"create_atoms 1 single <{x} L> <{y} L> 0\nset atom {atom} mol {m + 1}\n"
            bonds += f"create_bonds single/bond 1 {atom} {8 * m + (k + 1) % 8 + 1}\n"
    lmp = quiet()
    lmp.commands_string(
        units.written(POLYGONS.format(style=units.style, atoms=atoms, bonds=bonds)) + "run 100\n"
    )
    found = {key: lmp.get_thermo(key) / units.E for key in ("pe", "ke")}
    found |= {key: lmp.get_thermo(key) / units.one("P E L-2") for key in ("press", "pxy")}
    found["stick"] = lmp.extract_fix("floor", 0, 0) / units.E
    found["force"] = [lmp.extract_fix("floor", 0, 1, k) / units.one("E L-1") for k in range(2)]
    found["area"] = lmp.extract_fix("area", 0, 0) / units.E
    found["x"] = np.array(lmp.gather("x", 1, 3)) / units.L
    return found


@pytest.mark.parametrize("units", ["si", "small"])
def test_polygons(units):
    units, expected = Units(*CASES[units]), polygons(Units(*LJ))
    assert_same(polygons(units), expected, units.rounding)
    assert min(abs(expected[key]) for key in ("stick", "area", "pe")) > 1e-4


@pytest.mark.parametrize(
    ("units", "words", "longest"),
    [
        ("lj", "0.5 <2 E L-2> 0", np.sqrt(1.3 / 7 / 2)),  # kt dt^2 = m/7
        ("si", "0.5 <2 E L-2> 0", np.sqrt(1.3 / 7 / 2)),
        ("metal", "0.5 0 <2 E T L-2>", 1.3 / 28),  # 2 gt dt = m/7
        ("real", "0 0 0 damp <2 E T L-2>", 1.3 / 8),  # 2 gn dt = m/2
    ],
)
def test_longest_time_step(units, words, longest, tmp_path):
    """Of friction: the message names it, in the units of the run; it is the same for all."""
    units = Units(*CASES.get(units, LJ))
    lmp = scene(units, PLANE, tmp_path, DROPS, law=EXACT.format("balanced"), name="ring")
    lmp.commands_string(units.written(f"fix rub all deformable/friction {words}"))
    longest = float(longest * units.T)
    with refuses(f"the time step .* mass {1.3 * units.M:.6g}.*: use .* or less") as error:
        lmp.commands_string(f"timestep {1.01 * longest!r}\nrun 0")
    told = float(str(error.value).split("use ")[1].split()[0])
    assert told == pytest.approx(longest, rel=5e-3)  # of three digits
    lmp.commands_string(f"timestep {0.99 * longest!r}\nrun 0")


# near a droplet of radius 1 at (1.2, 0.9, 0)
REGIONS = {
    "container": "region w block <0.25 L> <8 L> <0 L> <7 L> INF INF",
    "leaning": "region w prism <0 L> <9 L> <0 L> <7 L> INF INF <1 L> 0 0",
    "round": "region w cylinder z <3.2 L> <1.5 L> <3 L> INF INF",
    "block": "region w block <2.1 L> <3 L> <0.7 L> <4 L> INF INF side out",
    "prism": "region w prism <-1.7 L> <0.5 L> <0 L> <0.8 L> INF INF <-0.2 L> 0 0 side out",
    "disk": "region w cylinder z <2.2 L> <2 L> <0.6 L> INF INF side out",
    "sphere": "region w sphere <2.1 L> <1.9 L> 0 <0.5 L> side out",
    "planes": "region a plane <0.3 L> 0 0 1 0 0\nregion b plane <1.5 L> 0 0 -0.3 1 0\n"
    "region w intersect 2 a b",
    "box": "region w block <0.25 L> <8 L> <0 L> <7 L> <-0.95 L> <4 L>",
    "tube": "region w cylinder z <3.2 L> <1.5 L> <3 L> <-0.97 L> <5 L>",
    "funnel": "region w cone z <3.2 L> <1.5 L> <2.8 L> <3.3 L> <-2 L> <4 L>",
    "post": "region w cylinder y <2.1 L> <0.3 L> <0.4 L> <-1 L> <3 L> side out",
    "ball": "region w sphere <2.1 L> <1.9 L> <0.1 L> <0.5 L> side out",
    "wedge": "region w prism <-1.7 L> <0.5 L> <0 L> <0.8 L> <-2 L> <1 L> 0 <0.1 L> 0 side out",
}
ALONE = """
units {style}
dimension {dimension}
boundary f f {z}
region box block <-10 L> <10 L> <-10 L> <10 L> {depth}
create_box 1 box
create_atoms 1 single <1.2 L> <0.9 L> 0
mass 1 <1 M>
neighbor <0.3 L> bin
pair_style deformable/{law}
pair_coeff * * {species} a
{region}
fix w all deformable/wall w
thermo_style custom step pe
"""


def force_of_region(units, name, folder):
    dimension = 3 if list(REGIONS).index(name) >= list(REGIONS).index("box") else 2
    words = {"law": "droplet", "z": "f", "depth": "<-10 L> <10 L>"}
    if dimension == 2:
        words = {"law": "ring", "z": "p", "depth": "<-0.5 L> <0.5 L>"}
    species = f"a <1 L> inf 0 tension <1 E L-{dimension - 1}>\n"
    lmp = scene(units, ALONE, folder, species, region=REGIONS[name], dimension=dimension, **words)
    lmp.command("run 0")
    force = [lmp.extract_fix("w", 0, 1, k) for k in range(3)]
    return np.array(force) / units.one("E L-1"), lmp.get_thermo("pe") / units.E


@pytest.mark.parametrize(("name", "units"), in_turn(REGIONS, ["si", "tiny", "small"]))
def test_regions_of_any_size(units, name, tmp_path):
    """Walls are read from LAMMPS' regions by points around them."""
    force, energy = force_of_region(Units(*LJ), name, tmp_path)
    found = force_of_region(Units(*CASES[units]), name, tmp_path)
    np.testing.assert_allclose(found[0], force, rtol=0, atol=1e-8 * np.abs(force).max())
    assert found[1] == pytest.approx(energy, rel=1e-7)
    assert energy > 1e-4
