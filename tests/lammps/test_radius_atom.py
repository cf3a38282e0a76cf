"""Radii of atom_style sphere: pair_style deformable/... radius atom."""

import numpy as np
import pytest
from scene import PACKINGS, SPECIES, Scene, box_walls
from test_contacts import CONTACTS, contacts
from test_forces import BOX, assert_forces
from test_parallel import GRIDS
from test_parallel import run as run_ranks
from test_refusals import refuses
from test_restart import FILES, RUN, Continued
from test_soft_rings import pushed

BALANCED = "ring contact balanced reach 0.3 balance 1e-12 100"
STYLES = "sector", "ring contact radical", BALANCED
styles = pytest.mark.parametrize("style", STYLES)


def of_types(case):
    """Radius of each particle of one of PACKINGS."""
    return np.array([0.5, 0.7])[np.array(case["type"]) - 1]


def spread(case):
    """A continuous distribution about it."""
    factor = np.random.default_rng(2).lognormal(0.0, 0.01, case["N"])
    return of_types(case) * factor


def by_atom(case, style, radii, species=("any", "any"), **options):
    style = f"deformable/{style} radius atom"
    return Scene.packing(case, style, species, radii=radii, **options)


def assert_alike(found, expected, tolerance, style=""):
    """Two states, apart by a part of the largest value of each kind; 0: to the last bit.

    Counts of contacts need not agree otherwise: some barely press. Forces of balanced contacts are
    known to 1e-12 of the largest. They go as the cube of the length, so that lengths may be off by
    the cube root of that.
    """
    for name in ("energy", "virial", "force", "atom_energy", "atom_virial", "bulge"):
        a, b = (np.asarray(getattr(state, name)) for state in (found, expected))
        np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * np.abs(b).max(), err_msg=name)
    for name, values in expected.shape.items():
        if name == "contacts" and tolerance > 0.0:
            continue
        atol = (1e-4 if style == BALANCED else tolerance) * np.abs(values).max()
        np.testing.assert_allclose(found.shape[name], values, rtol=0, atol=atol, err_msg=name)


# ---- a mixture of types is one of atoms ----

PAIRS = {
    "sector": ("sector", ("small", "large")),
    "sector, area conserved": ("sector", ("fixed", "fixedlarge")),
    "radical": ("ring contact radical", ("small", "large")),
    "radical, finite stiffness": ("ring contact radical", ("both", "bothlarge")),
    "radical, a skin beside kP = inf": ("ring contact radical", ("small", "skinned")),
    "balanced": (BALANCED, ("small", "skinned")),
}


@pytest.mark.parametrize(("style", "species"), PAIRS.values(), ids=PAIRS)
def test_radii_of_the_types(style, species):
    """The same cutoffs and thus the same sums, to the last bit."""
    case = PACKINGS[1]
    expected = Scene.packing(case, f"deformable/{style}", species, commands=CONTACTS)
    found = by_atom(case, style, of_types(case), species, commands=CONTACTS)
    assert_alike(found.evaluate(), expected.evaluate(), 0.0)
    rows, known = contacts(found), contacts(expected)
    for name, column in known.items():
        np.testing.assert_array_equal(rows[name], column)


@styles
def test_one_type_for_all(style):
    """Neighbors are sought further out and come in another order.

    Indentations of 0.01 are known to 1e-14 of themselves, sums of canceling forces to 1e-13.
    """
    case = PACKINGS[1]
    expected = Scene.packing(case, f"deformable/{style}").evaluate()
    found = by_atom(case, style, of_types(case)).evaluate()
    assert_alike(found, expected, 1e-10 if style == BALANCED else 1e-12, style)


def test_small_atoms_narrow_the_reach():
    """A tiny particle far away, by type, by atom, and none."""
    x = np.array([[0.0, 0.0], [1.36, 0.0], [0.5, 2.0]])
    bulges = [
        Scene(x, species, BOX, f"deformable/ring contact radical{words}", radii=radii)
        .evaluate()
        .bulge
        for words, species, radii in (
            ("", ["large", "large", "tiny"], None),
            (" radius atom", ["any"] * 3, [0.7, 0.7, 0.12]),
            (" radius atom", ["any"] * 3, [0.7, 0.7, 0.7]),
        )
    ]
    assert bulges[0] == bulges[1] > bulges[2] > 0


# ---- forces ----


@pytest.mark.parametrize(
    ("style", "species"), [*((style, "any") for style in STYLES), (BALANCED, "anysoft")]
)
def test_forces_of_a_continuous_distribution(style, species):
    case = PACKINGS[1]
    scene = by_atom(case, style, spread(case), (species, species))
    assert len(np.unique(scene.radii)) == case["N"]
    assert_forces(scene, pushed(case))


@styles
def test_walls(style):
    """Four particles of four sizes that touch each other and the wall."""
    x = np.array([[-0.481, -0.477], [0.483, -0.479], [0.478, 0.482], [-0.479, 0.479]])
    radii = np.array([0.5, 0.49, 0.505, 0.497])
    scene = Scene(
        x,
        ["any"] * 4,
        BOX,
        f"deformable/{style} radius atom",
        boundary="f f p",
        commands=box_walls(-0.965, 0.97, -0.96, 0.967) + CONTACTS,
        radii=radii,
    )
    state = scene.evaluate()
    assert (state.shape["contacts"] > 2).all()
    found = contacts(scene)
    wall = found["partner"] == 0
    assert wall.sum() == 8
    i, turn = found["atom"][wall].astype(int) - 1, np.rint(found["angle"][wall] / (np.pi / 2))
    side = turn.astype(int) % 4  # right, up, left, down
    height = np.array([0.97, 0.967, 0.965, 0.96])[side] - np.abs(x[i, side % 2])
    np.testing.assert_allclose(found["indentation"][wall], radii[i] - height, rtol=0, atol=1e-15)
    np.testing.assert_allclose(scene.force_on_wall("walls"), -state.force.sum(0), rtol=1e-11)
    assert_forces(scene, x)


@styles
def test_virial_by_pairs_is_virial_by_positions(style):
    case = PACKINGS[1]
    by_positions = by_atom(case, style, spread(case)).evaluate().virial
    by_pairs = by_atom(case, style, spread(case), commands="pair_modify nofdotr").evaluate().virial
    atol = 1e-13 * np.abs(by_positions).max()
    np.testing.assert_allclose(by_pairs, by_positions, rtol=0, atol=atol)


@styles
def test_sums_over_atoms(style):
    state = by_atom(PACKINGS[0], style, spread(PACKINGS[0])).evaluate()
    assert state.atom_energy.sum() == pytest.approx(state.energy, rel=1e-14)
    atol = 1e-13 * np.abs(state.atom_virial).max()
    np.testing.assert_allclose(state.atom_virial.sum(0), state.virial, rtol=0, atol=atol)


# ---- beside others ----


def test_types_of_another_style_need_no_radius():
    case, style = PACKINGS[0], "deformable/ring contact radical"
    coeff = (
        f"pair_coeff * * {style.split()[0]} {SPECIES} {{}} NULL\n"
        f"pair_coeff * 2 harmonic/cut 0.02 1.2"
    )
    expected, found = (
        Scene.packing(
            case, f"hybrid {style} {words} harmonic/cut", coeff=coeff.format(name), radii=radii
        ).evaluate()
        for words, name, radii in (
            ("", "small", None),
            ("radius atom", "any", np.where(np.array(case["type"]) == 1, 0.5, 0.0)),
        )
    )
    assert_alike(found, expected, 1e-12)


def test_radii_of_types_are_the_default():
    """atom_style sphere alone changes nothing."""
    case = PACKINGS[0]
    expected = Scene.packing(case, "deformable/ring contact radical").evaluate()
    for words in ("", " radius type"):
        scene = Scene.packing(
            case, f"deformable/ring contact radical{words}", radii=np.full(case["N"], 0.1)
        )
        assert_alike(scene.evaluate(), expected, 0.0)
    scene.run("pair_style deformable/ring contact radical radius atom")
    scene.run(f"pair_coeff * * {SPECIES} small large")
    assert scene.energy() == 0.0
    scene.run(f"pair_style deformable/ring contact radical\npair_coeff * * {SPECIES} small large")
    assert scene.energy() == expected.energy


# ---- radii that change ----


@styles
def test_radii_set_between_runs(style):
    case = PACKINGS[1]
    scene = by_atom(case, style, spread(case))
    scene.evaluate()
    scene.run("\n".join(f"set atom {n} diameter {2 * r}" for n, r in enumerate(of_types(case), 1)))
    expected = by_atom(case, style, of_types(case)).evaluate()
    # what a balanced call begins with is not the same
    assert_alike(scene.evaluate(), expected, 1e-10 if style == BALANCED else 1e-14, style)


GROWTH = """
variable growth equal 1+0.001*step
fix grow all adapt 1 atom diameter v_growth scale yes
run 10 post no
"""


@styles
def test_radii_that_grow(style):
    """fix adapt: every step sees the radii of that step, also those of ghosts."""
    case, start = PACKINGS[0], 0.99 * of_types(PACKINGS[0])
    scene = by_atom(case, style, start)
    scene.run(GROWTH)
    energy, force = scene.lmp.get_thermo("pe"), scene.gather("f", 3)[:, :2]
    expected = by_atom(case, style, 1.01 * start).evaluate()
    assert energy == pytest.approx(expected.energy, rel=1e-10)
    atol = 1e-10 * np.abs(force).max()
    np.testing.assert_allclose(force, expected.force, rtol=0, atol=atol)


def test_radii_that_outgrow_their_species():
    """Not before they do, in the second step."""
    scene = by_atom(PACKINGS[0], "ring contact radical", np.where(np.arange(24) == 16, 0.799, 0.2))
    with refuses("Atom 17 .*0.800598.*species any.*0.8 at most"):
        scene.run(GROWTH)
    assert scene.lmp.get_thermo("step") == 2


# ---- files and ranks ----


@styles
@pytest.mark.parametrize(("write", "read"), FILES.values(), ids=FILES)
def test_round_trip(style, write, read, tmp_path):
    file, case = tmp_path / "file", PACKINGS[0]
    scene = by_atom(case, style, spread(case), commands=RUN)
    scene.run("velocity all create 1e-4 4711 loop all\nrun 20")
    scene.run(write.format(file=file))
    scene.run("run 20")
    read = read.replace("atomic", "sphere").format(file=file)
    continued = Continued(read, f"deformable/{style} radius atom", "any")
    # LAMMPS writes 16 digits into data files
    np.testing.assert_allclose(continued.radii, spread(case), rtol=1e-15)
    continued.run("run 20")
    expected, found = scene.evaluate(), continued.evaluate()
    np.testing.assert_allclose(continued.x, scene.x, rtol=0, atol=1e-13)
    assert_alike(found, expected, 1e-10, style)


@styles
def test_ranks_and_grids(style, tmp_path):
    """A drift across the borders of the ranks, with new neighbor lists in each step."""
    scene = by_atom(PACKINGS[0], style, spread(PACKINGS[0]))
    scene.run("velocity all create 1e-4 4711 loop all\nvelocity all set 3.0 2.0 0.0 sum yes")
    scene.run(f"write_data {tmp_path / 'data'} nofix")
    few = {1: ["1 1 1"], 2: ["2 1 1"]}  # balance takes long on ranks that share a core
    runs = {
        (ranks, grid): run_ranks(
            ranks,
            grid,
            tmp_path / grid.replace(" ", ""),
            atoms="sphere",
            style=f"deformable/{style} radius atom",
            name=f"deformable/{style.split()[0]}",
            species=f"{SPECIES} any",
            data=tmp_path / "data",
            boundary="p p p",
            commands="neigh_modify every 1 delay 0 check no",
        )
        for ranks, grids in (few if style == BALANCED else GRIDS).items()
        for grid in grids
    }
    reference = runs.pop((1, "1 1 1"))
    assert reference[0][0][0] > 1e-6
    for grid, found in runs.items():
        for steps, (scalars, atoms) in reference.items():
            name = f"{grid} after {steps} steps"
            np.testing.assert_allclose(found[steps][0][:4], scalars[:4], rtol=1e-12, err_msg=name)
            scale = 1e-12 * np.abs(atoms).max(axis=0)
            assert (np.abs(found[steps][1] - atoms) <= scale).all(), name
