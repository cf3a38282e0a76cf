"""Packings: properties of what the builders return, and errors for wrong values."""

import dataclasses
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import output
from refusals import refused
from scipy import stats

BUILDER = st.fixed_dictionaries(
    {
        "number": st.integers(1, 60),
        "sizes": st.tuples(st.floats(0.01, 10.0), st.floats(0.01, 10.0)),
        "fraction_large": st.floats(0.0, 1.0),
        "phi": st.floats(0.01, 1.2),
        "aspect": st.floats(0.1, 10.0),
        "tilt": st.floats(-2.0, 2.0),
        "seed": st.integers(0, 2**32),
    }
)


@given(BUILDER)
def test_builder_gives_what_was_asked_for(asked: dict[str, Any]) -> None:
    packing = ld.bidisperse(**asked)
    (lx, zero), (xy, ly) = packing.box
    assert len(packing) == asked["number"]
    assert packing.phi == pytest.approx(asked["phi"])
    assert zero == 0.0
    assert ly / lx == pytest.approx(asked["aspect"])
    assert xy / ly == pytest.approx(asked["tilt"])
    assert packing.species.sum() == round(asked["fraction_large"] * asked["number"])
    assert np.array_equal(packing.radii, np.array(asked["sizes"])[packing.species])
    inside = packing.positions @ np.linalg.inv(packing.box)
    assert (inside > -1e-9).all()
    assert (inside < 1 + 1e-9).all()


def test_a_drawn_seed_is_kept() -> None:
    """And decides; each call draws another one."""
    for build in (ld.bidisperse, lambda n, **k: ld.polydisperse(n, [0.5] * n, **k)):
        first, second = build(6), build(6)
        assert not np.array_equal(first.positions, second.positions)
        assert first.at(0.8).seed == first.seed
        assert repr(first).endswith(f", seed {first.seed}>")
        assert np.array_equal(build(6, seed=first.seed).positions, first.positions)


def test_a_generator_draws_the_seed() -> None:
    one, other = np.random.default_rng(5), np.random.default_rng(5)
    first, second = ld.bidisperse(6, seed=one), ld.polydisperse(6, [0.5] * 6, seed=one)
    assert first.seed == ld.bidisperse(6, seed=other).seed != second.seed
    assert np.array_equal(ld.bidisperse(6, seed=first.seed).positions, first.positions)
    walls = ld.BoxWall((8, 8))
    places = [first.between(walls, seed=each).positions for each in (one, one, first.seed)]
    assert not np.array_equal(places[0], places[1])
    with pytest.raises(ld.ParameterError, match="seed must be a whole number, not Generator"):
        first.replace(seed=one)


def test_at_scales_box_and_centers_by_one_factor() -> None:
    packing = ld.bidisperse(20, phi=0.3, tilt=0.4, seed=1)
    denser = packing.at(0.6)
    assert denser.phi == pytest.approx(0.6)
    assert denser.positions / np.sqrt(0.5) == pytest.approx(packing.positions)
    assert np.array_equal(denser.radii, packing.radii)


def test_packing_cannot_be_changed() -> None:
    packing = ld.bidisperse(4, seed=1)
    with pytest.raises(dataclasses.FrozenInstanceError):
        packing.box = np.eye(2)  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        packing.positions[0, 0] = 1.0


def test_builder_names_the_bad_value() -> None:
    for wrong, message in (
        ({"sizes": (0.5, -0.7)}, "sizes must be a positive number, not -0.7"),
        ({"sizes": (0.5,)}, "sizes must be two numbers"),
        ({"fraction_large": 1.5}, "fraction_large must lie between 0 and 1, not 1.5"),
        ({"phi": 84.0}, "phi is a fraction.* not 84"),
        ({"aspect": float("nan")}, "aspect must be a positive number, not nan"),
        ({"tilt": float("inf")}, "tilt must be a finite number, not inf"),
        ({"tilt": 1e9}, r"tilted by at most 30 .*not 1e\+09"),
        ({"number": 2.5}, "number must be a whole number, not 2.5"),
        ({"seed": -1}, "seed must not be negative, not -1"),
    ):
        with refused(message):
            ld.bidisperse(**({"number": 8} | wrong))


def test_packing_refuses_nonsense() -> None:
    for wrong, message in (
        ({"positions": np.zeros(2)}, "positions must have shape"),
        ({"positions": np.zeros((3, 2))}, "one for each of 3 particles"),
        ({"positions": [[0.0, 0.0], [0.0, 2.7e15]]}, "positions of particle 1, .* boxes away"),
        ({"species": [0, 1e10]}, "species must be numbers below 10000, not 10000000000"),
        ({"species": np.array([0, -2])}, "species must be 2 whole numbers from 0"),
        ({"species": [0.0, 0.9]}, r"species must be 2 whole numbers from 0, not \[0.0, 0.9\]"),
        ({"radii": np.array([0.5, 0.0])}, r"radii must be positive, not \[0.0\]"),
        (
            {"radii": 1e60},
            r"radii must be between 1e-50 and 1e\+50, not 1e\+60 to 1e\+60: choose another",
        ),
        ({"radii": [0.5, float("nan")]}, "radii must be finite"),
        ({"box": np.array([[1.0, 0.5], [0.0, 1.0]])}, "box must be"),
        ({"box": (2, 3, 4)}, "positions have 2 columns, so that the box must .* not 3"),
    ):
        good = {
            "positions": np.zeros((2, 2)),
            "species": np.array([0, 1]),
            "radii": np.array([0.5, 0.7]),
            "box": np.eye(2),
        }
        ld.Packing(**good)
        with refused(message):
            ld.Packing(**(good | wrong))


@pytest.mark.parametrize("unit", [2.0**-20, 2.0**7, 2.0**20])
def test_lengths_may_have_any_unit(unit: float, tmp_path: Path) -> None:
    """A power of two leaves all digits of disks as they are, and files are those of LAMMPS too."""
    start = ld.jam(ld.bidisperse(16, seed=1)).packing.at(0.9)

    def scaled(by: float) -> ld.Packing:
        lengths = {name: getattr(start, name) * by for name in ("positions", "radii", "box")}
        return start.replace(**lengths)

    assert scaled(unit).at(0.7).push_off().phi == start.at(0.7).push_off().phi
    with ld.Simulation(start, ld.Ring()) as usual, ld.Simulation(scaled(unit), ld.Ring()) as sim:
        state = sim.relax()
        assert state.energy / unit**4 == pytest.approx(usual.relax().energy, rel=1e-8)
    beads = ld.DeformablePolygon(20, radius=0.05 * unit, kL=unit**2, kr=unit**2)
    with ld.Simulation(scaled(unit).at(0.7).push_off(), beads) as polygons:
        assert polygons.state().phi == pytest.approx(0.7, rel=0.02)
    state.save(tmp_path / "state")
    for suffix in (".data", ".dump"):
        state.packing.export(tmp_path / f"packing{suffix}")
        again = ld.Packing.from_file(tmp_path / f"packing{suffix}")
        assert np.array_equal(again.positions, state.packing.positions)
    output("lmp", "-in", "in.lammps", cwd=tmp_path / "state")


# ---- radii of their own ----


def test_polydisperse_takes_radii_as_they_are() -> None:
    """Of two sizes, it is the packing of `bidisperse`."""
    two = ld.bidisperse(20, aspect=0.7, tilt=0.2, seed=3)
    many = ld.polydisperse(20, two.radii, aspect=0.7, tilt=0.2, seed=3)
    assert np.array_equal(many.positions, two.positions)
    assert np.array_equal(many.box, two.box)
    assert np.array_equal(many.radii, two.radii)
    assert many.phi == two.phi


def test_polydisperse_draws_from_distributions() -> None:
    frozen = stats.lognorm(0.2, scale=0.5)
    packing = ld.polydisperse(4000, frozen, phi=0.6, seed=2)
    assert packing.phi == pytest.approx(0.6)
    # median and width of log R are known to 0.2/sqrt(N) and 0.2/sqrt(2 N), 0.003 and 0.002
    assert np.log(packing.radii).mean() == pytest.approx(np.log(0.5), abs=0.015)
    assert np.log(packing.radii).std() == pytest.approx(0.2, abs=0.01)
    again = ld.polydisperse(4000, frozen, phi=0.6, seed=2)
    assert np.array_equal(again.radii, packing.radii)
    assert not np.array_equal(ld.polydisperse(4000, frozen, seed=1).radii, packing.radii)

    uniform = ld.polydisperse(50, lambda rng, n: rng.uniform(0.4, 0.6, n), seed=1)
    assert ((uniform.radii > 0.4) & (uniform.radii < 0.6)).all()
    assert len(np.unique(uniform.radii)) == 50


def test_polydisperse_names_the_bad_value() -> None:
    for radii, message in (
        ([0.5, 0.5], r"radii must be 3 numbers, shape \(3,\), not \(2,\); or a distribution"),
        ([0.5, 0.0, -1.0], "radii must be positive, but 2 of 3 are not, such as 0: "),
        (lambda rng, n: None, "radii must be 3 numbers|radii must be finite numbers"),
    ):
        with refused(message):
            ld.polydisperse(3, radii, seed=1)


def test_arrays_of_tables() -> None:
    """Columns of a table that also has words are arrays of objects."""
    rows = np.array([["a", 1.0, 1], ["b", 2.0, np.float32(2.5)]], dtype=object)
    found = ld.Packing(rows[:, 1:], 0.5, (5, 5)).positions
    np.testing.assert_array_equal(found, [[1.0, 1.0], [2.0, 2.5]])
    for wrong in (rows, np.array([["1", "1"]], dtype=object), [[None, 1.0]], [[10**400, 1.0]]):
        with refused("positions must be finite numbers, not "):
            ld.Packing(wrong, 0.5, (5, 5))


def test_a_dimension_that_is_a_float() -> None:
    for build in (ld.bidisperse, lambda n, **given: ld.polydisperse(n, np.full(n, 0.5), **given)):
        found, known = build(4, dimension=3.0, seed=1), build(4, dimension=3, seed=1)
        np.testing.assert_array_equal(found.positions, known.positions)


def test_particles_far_larger_than_their_box_are_refused() -> None:
    crushed = ld.Packing([[1.0, 1.0], [2.0, 2.0]], 100.0, (3.0, 3.0))
    with refused("phi = 6.98e\\+03: particles of the radius 100 are far too large for their box"):
        ld.Simulation(crushed, ld.Ring())


def test_masked_values_are_refused() -> None:
    hidden = np.ma.masked_greater([[1.0, 1.0], [2.0, 9.0]], 5.0)
    with refused("positions has masked values: "):
        ld.Packing(hidden, 0.5, (5, 5))
    ld.Packing(hidden[:1], 0.5, (5, 5))


@pytest.mark.parametrize("walled", [False, True])
def test_radii_grow_in_place_of_a_shrinking_box(walled: bool) -> None:
    """The same packing up to its scale; box, walls and centers stay."""
    start = ld.polydisperse(9, lambda rng, n: rng.uniform(0.4, 0.6, 9), tilt=0.0, seed=1)
    if walled:
        start = start.between([ld.BoxWall((6, 7)), ld.Sphere(1, (3, 3), inside=False)], seed=1)
    grown, shrunk = start.at(0.7, grow=True), start.at(0.7)
    assert grown.phi == pytest.approx(0.7, rel=1e-12)
    np.testing.assert_array_equal(grown.positions, start.positions)
    np.testing.assert_array_equal(grown.box, start.box)
    assert grown.walls == start.walls
    scale = grown.box[0, 0] / shrunk.box[0, 0]
    np.testing.assert_allclose(grown.radii, scale * shrunk.radii, rtol=1e-12)
    np.testing.assert_allclose(grown.positions, scale * shrunk.positions, rtol=1e-12)


@pytest.mark.parametrize("species", [None, [2, 2, 0]])
def test_each_particle_has_its_radius(species: list[int] | None) -> None:
    """Whatever its species: soft disks of LAMMPS have them, and give them back."""
    places, radii, box = [[1.0, 1.0], [3.0, 1.0], [2.0, 3.0]], [0.5, 0.6, 0.7], (4.0, 4.0)
    packing = ld.Packing(places, radii, box, species=species)
    assert packing.radii.tolist() == radii
    assert packing.species.tolist() == (species or [0, 0, 0])
    assert ld.Packing(places, 0.5, box).radii.tolist() == [0.5] * 3
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        again = disks.state().packing
    assert again.radii.tolist() == radii
    assert again.replace(radii=[0.6] * 3).radii.tolist() == [0.6] * 3


def test_replicate() -> None:
    """As many images, each beside the others; where walls close the box there are none."""
    one = ld.bidisperse(5, tilt=0.3, seed=1)
    many = one.replicate(2, 3)
    assert many.phi == pytest.approx(one.phi)
    assert many.box == pytest.approx(one.box * [[2.0], [3.0]])
    assert many.positions[:5] == pytest.approx(one.positions)
    assert many.positions[5:10] == pytest.approx(one.positions + one.box[1])
    assert many.species.tolist() == 6 * one.species.tolist()
    assert ld.crystal("sc", 1).replicate(2, 3, 4).positions == pytest.approx(
        ld.crystal("sc", (2, 3, 4)).positions
    )
    walled = one.at(0.1).replace(box=(5, 5)).between(ld.BoxWall((5, 5)).parts[2:])
    assert len(walled.replicate(3, 1)) == 15
    for call, message in (
        (lambda: one.replicate(1, 1, 2), "no images along z: nz must be 1, not 2"),
        (lambda: walled.replicate(1, 2), "no images along y: ny must be 1, not 2"),
        (lambda: one.replicate(0, 1), "nx must be at least 1"),
        (lambda: one.between(ld.Sphere(0.1, (1, 1), inside=False)).replicate(2, 1), "no obstacles"),
    ):
        with pytest.raises(ld.ParameterError, match=message):
            call()


def test_walls_that_stay_refuse_another_box() -> None:
    places = np.random.default_rng(1).random((10, 2)) * 8.0 + 1.0
    walled = ld.Packing(places, 0.5, (10.0, 10.0), periodic=False)
    for changes in ({"periodic": True}, {"box": (20.0, 20.0)}, {"periodic": (True, False)}):
        with pytest.raises(ld.ParameterError, match=r"those of the 4 walls .* give `walls` too"):
            walled.replace(**changes)
    assert walled.replace(periodic=False, box=(10.0, 10.0)).walls == walled.walls
    assert walled.replace(walls=(), box=(20.0, 20.0)).box.tolist() == [[20.0, 0.0], [0.0, 20.0]]


def test_words_are_no_truth_values() -> None:
    state = ld.jam(ld.bidisperse(8, seed=1))
    with ld.Simulation(state, ld.Ring()) as sim:
        for call in (
            lambda: state.packing.at(0.8, grow="no"),
            lambda: ld.jam(state.packing.at(0.4), grow="no"),
            lambda: state.hessian("no"),
            lambda: state.modes(vectors="no"),
            lambda: state.plot(contacts="no"),
            lambda: state.packing.plot(colorbar="no"),
            lambda: sim.run(1, inertia="no"),
            lambda: sim.compress(strain=0.1, keep="no"),
            lambda: ld.DeformablePolygon(20, smooth="no"),
        ):
            with pytest.raises(ld.ParameterError, match="must be of the kind bool, not 'no'"):
                call()
