"""The area term of bead polygons: energy, forces, virial, images, ranks, dynamics, files."""

import numpy as np
import pytest
from polygons import (
    ALONE,
    AREA,
    BOX,
    DIAMETER,
    FIVE,
    KA,
    KL,
    REST,
    SEVEN,
    SPRINGS,
    Polygons,
    lattice,
    perimeter,
    regular,
    shoelace,
)

TILT = 0.9
tilts = pytest.mark.parametrize("tilt", [0.0, TILT], ids=["orthogonal", "tilted"])

# Coordinates of up to 4 are known to half a spacing of numbers, 4.4e-16, areas of polygons to that
# times the perimeter, 5: 2e-15.
ULP, AREA_ULP = 4.4e-16, 2e-15


def area_energy(outlines, rest=1.4):
    return sum(KA / 2 * (abs(shoelace(outline)) - rest) ** 2 for outline in outlines)


# ---- energy, forces, virial ----


@tilts
def test_energy_and_table(tilt):
    polygons = Polygons(tilt=tilt, commands=REST, springs=ALONE)
    assert polygons.energy() == pytest.approx(area_energy([SEVEN, FIVE]), rel=1e-14)
    assert polygons.area_energy == polygons.lmp.get_thermo("pe")
    expected = [
        [abs(shoelace(outline)), perimeter(outline), 1.4, *outline.mean(axis=0)]
        for outline in (SEVEN, FIVE)
    ]
    np.testing.assert_allclose(polygons.table, expected, rtol=1e-14, atol=ULP)


def test_table_before_and_between_runs():
    """Before the first run as the polygons are, and then as the last run left them."""
    polygons = Polygons(commands=REST)
    before = polygons.table
    polygons.energy()
    np.testing.assert_allclose(before, polygons.table, rtol=1e-14, atol=ULP)
    polygons.energy()
    polygons.run("displace_atoms all random 0.1 0.1 0 1\ngroup gone id 1\ndelete_atoms group gone")
    np.testing.assert_allclose(before, polygons.table, rtol=1e-14, atol=ULP)


def test_rows_are_in_the_order_of_molecules():
    polygons = Polygons(molecules=[30, 7])
    np.testing.assert_allclose(
        polygons.table[:, 0], np.abs([shoelace(FIVE), shoelace(SEVEN)]), rtol=1e-14
    )


def test_initial_area_is_at_rest():
    polygons = Polygons(springs=ALONE)
    assert polygons.energy() == pytest.approx(0, abs=2 * KA / 2 * AREA_ULP**2)
    assert np.abs(polygons.force).max() <= KA * AREA_ULP
    scaled = np.vstack([SEVEN * 1.02, FIVE * 0.97])
    strain = np.array([1.02**2 - 1, 0.97**2 - 1]) * [shoelace(SEVEN), shoelace(FIVE)]
    assert polygons.energy(scaled) == pytest.approx(KA / 2 * np.sum(strain**2), rel=1e-12)


@tilts
def test_area_forces_are_the_gradient(tilt):
    """Quadratic in the place of each bead: differences are exact but for rounding."""
    polygons = Polygons(tilt=tilt, commands=REST, springs=ALONE)
    polygons.energy()
    force, step = polygons.force, 1e-2
    assert np.abs(force).min() > 1e-3
    # U changes by kA (A - A0) dA, with |A - A0| < 0.4; weights add up to 1.5/step
    rounding = 1.5 * KA * 0.4 * AREA_ULP / step
    assert rounding < 1e-7 * np.abs(force).min()
    np.testing.assert_allclose(polygons.gradient(step), -force, rtol=0, atol=rounding)


@tilts
def test_forces_of_whole_polygons_are_the_gradient(tilt):
    """With springs and contacts."""
    polygons = Polygons(tilt=tilt, commands=REST)
    energy = polygons.energy()
    force, step = polygons.force, 2e-4
    apart = SEVEN[:, None] - FIVE
    assert np.hypot(*np.moveaxis(apart, -1, 0)).min() < DIAMETER - 0.05

    # h^4/20 of fifth derivatives, 100 k/r^3, and the rounding of each sum of 20 energies
    error = 5 * 100 * 10 * step**4 + 20 * ULP * energy / step
    assert error < 1e-7 * np.abs(force).max()
    np.testing.assert_allclose(polygons.gradient(step), -force, rtol=0, atol=error)


@pytest.mark.parametrize(
    ("tilt", "springs"), [(0.0, SPRINGS), (TILT, ALONE)], ids=["whole", "area, tilted"]
)
def test_virial_is_the_strain_derivative(tilt, springs):
    step = 2e-4

    def strained(xx, yy, xy):
        polygons = Polygons(tilt=tilt, commands=REST, springs=springs)
        polygons.run(
            f"change_box all triclinic x scale {1 + xx} y scale {1 + yy} "
            f"xy final {(1 + xx) * tilt + xy * BOX[1]} remap"
        )
        return polygons

    def slope(strain):
        return (strained(*strain).energy() - strained(*-strain).energy()) / (2 * step)

    reference = Polygons(tilt=tilt, commands=REST, springs=springs)
    virial, of_beads = reference.virial()
    # h^4/20 of fifth derivatives; U, of size 1, from coordinates that a change of box rounds
    error = 100 * step**4 + 20 * ULP / step
    for component, direction in enumerate(step * np.eye(3)):
        extrapolated = (4 * slope(direction) - slope(2 * direction) / 2) / 3
        assert virial[component] == pytest.approx(-extrapolated, abs=error)
    assert error < 1e-7 * np.abs(virial).max()
    np.testing.assert_allclose(of_beads, virial, atol=1e-14)
    reference.run("fix_modify area virial no")
    if springs is ALONE:
        np.testing.assert_array_equal(reference.virial()[0], 0)


def test_no_net_force_and_no_torque():
    tilt = TILT
    polygons = Polygons(tilt=tilt, commands=REST, springs=ALONE)
    polygons.energy()
    forces = np.split(polygons.force, [7])
    for outline, force in zip(polygons.outlines, forces, strict=True):
        scale = 7 * np.abs(force).max()
        assert np.abs(force.sum(0)).max() <= ULP * scale
        x, y = (outline - outline.mean(0)).T
        assert abs(np.sum(x * force[:, 1] - y * force[:, 0])) <= 2 * ULP * scale


# ---- a regular polygon: the corrected formulas ----


def test_regular_polygon_is_at_rest():
    """A0 = Nv/2 r^2 sin(2 pi/Nv) and L0 = 2 r sin(pi/Nv)."""
    number, radius = 24, 1.2
    rest = number / 2 * radius**2 * np.sin(2 * np.pi / number)
    length = 2 * radius * np.sin(np.pi / number)
    springs = SPRINGS.replace("0.8", repr(float(length)))
    commands = AREA.replace("\n", f" rest {float(rest)!r}\n")
    polygons = Polygons([regular(number, radius)], springs=springs, commands=commands)
    assert polygons.energy() <= KA / 2 * (2 * AREA_ULP) ** 2 + KL / 2 * number * ULP**2
    assert np.abs(polygons.force).max() <= 2 * KA * AREA_ULP + 2 * KL * ULP

    stretch = 1.01
    energy = polygons.energy(stretch * regular(number, radius))
    assert polygons.area_energy == pytest.approx(
        KA / 2 * (stretch**2 - 1) ** 2 * rest**2, rel=1e-12
    )
    bonds = energy - polygons.area_energy
    # the perimeter, and what it is longer by, is known to 1e-16 of itself
    excess = polygons.table[0, 1] - number * length
    assert bonds == pytest.approx(KL / 2 * number * (stretch - 1) ** 2 * length**2, rel=1e-11)
    assert bonds == pytest.approx(KL / number / 2 * excess**2, rel=1e-11)


# ---- images ----


@tilts
def test_periodic_images(tilt):
    """Polygons may be given in any image, and each in its own."""
    h = lattice(tilt=tilt)
    reference = Polygons(tilt=tilt, commands=REST)
    energy = reference.energy()
    for n1, n2 in [((1, 0), (0, 0)), ((-1, 2), (3, 1)), ((0, -2), (-1, -1))]:
        moved = Polygons([SEVEN + n1 @ h, FIVE + n2 @ h], tilt=tilt, commands=REST)
        assert moved.energy() == pytest.approx(energy, rel=1e-13)
        np.testing.assert_allclose(moved.force, reference.force, atol=1e-13)
        centers = reference.table[:, 3:] + np.array([n1, n2]) @ h
        np.testing.assert_allclose(moved.table[:, 3:], centers, rtol=1e-13)


@tilts
def test_any_image_flags_give_the_same_digits(tilt):
    """Nothing is lost far away, nor where flags overflow in the middle of a polygon."""
    reference = Polygons(tilt=tilt, commands=REST)
    energy = reference.energy()
    flags = reference.gather("image", 3, 0).astype(int)
    assert len(np.unique(flags[:7, 0])) == len(np.unique(flags[7:, 1])) == 2
    for far in ([300, -300], [511, 511], [-512, -513]):
        polygons = Polygons(tilt=tilt)
        for i, (nx, ny) in enumerate((flags + far + 512) % 1024 - 512, start=1):
            polygons.run(f"set atom {i} image {nx} {ny} NULL")
        polygons.run("unfix area\n" + REST)
        assert polygons.energy() == energy
        np.testing.assert_array_equal(polygons.force, reference.force)
        np.testing.assert_array_equal(polygons.table[:, :3], reference.table[:, :3])


def test_polygon_that_touches_itself_across_the_box():
    """Polygons may be larger than half the box, bonds may not."""
    outline = regular(12, 1.7, (0.3, -0.2))
    polygons = Polygons([outline], commands=REST, springs=ALONE)
    assert polygons.energy() == pytest.approx(area_energy([outline]), rel=1e-14)
