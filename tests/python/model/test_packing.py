"""Packings: properties of what the builders return, and errors for wrong values."""

import dataclasses
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

BUILDER = st.fixed_dictionaries(
    {
        "number": st.integers(1, 60),
        "radii": st.tuples(st.floats(0.01, 10.0), st.floats(0.01, 10.0)),
        "fraction": st.floats(0.0, 1.0),
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
    assert packing.species.sum() == round(asked["fraction"] * asked["number"])
    assert np.array_equal(packing.radius, np.array(asked["radii"])[packing.species])
    inside = packing.positions @ np.linalg.inv(packing.box)
    assert (inside > -1e-9).all()
    assert (inside < 1 + 1e-9).all()


def test_seed_decides() -> None:
    first, again, other = (ld.bidisperse(20, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(first.positions, again.positions)
    assert not np.array_equal(first.positions, other.positions)


def test_ratio_in_place_of_radii() -> None:
    assert ld.bidisperse(4).radii == pytest.approx([0.5, 0.7])
    assert ld.bidisperse(4, ratio=1.2).radii == pytest.approx([0.5, 0.6])


def test_at_scales_box_and_centers_by_one_factor() -> None:
    packing = ld.bidisperse(20, phi=0.3, tilt=0.4)
    denser = packing.at(0.6)
    assert denser.phi == pytest.approx(0.6)
    assert denser.positions / np.sqrt(0.5) == pytest.approx(packing.positions)


def test_packing_cannot_be_changed() -> None:
    packing = ld.bidisperse(4)
    with pytest.raises(dataclasses.FrozenInstanceError):
        packing.box = np.eye(2)  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        packing.positions[0, 0] = 1.0


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"number": 0}, "number must be at least 1, not 0"),
        ({"radii": (0.5, -0.7)}, "radii must be a positive number, not -0.7"),
        ({"radii": (0.5,)}, "radii must be two numbers"),
        ({"ratio": -1.4}, "ratio must be a positive number, not -1.4"),
        ({"radii": (0.5, 0.7), "ratio": 1.4}, "give radii or a ratio, not both"),
        ({"radii": (0.5, float("nan"))}, "radii must be finite numbers"),
        ({"fraction": 1.5}, "fraction must lie between 0 and 1, not 1.5"),
        ({"phi": 0.0}, "phi must be a positive number, not 0.0"),
        ({"phi": 84.0}, "phi is a fraction.* not 84"),
        ({"aspect": float("nan")}, "aspect must be a positive number, not nan"),
        ({"tilt": float("inf")}, "tilt must be a finite number, not inf"),
        ({"tilt": 1e9}, r"tilted by at most 30 .*not 1e\+09"),
        ({"number": 2**31}, "number must be at most 2147483647 .*not 2147483648"),
        ({"number": 2.5}, "number must be a whole number, not 2.5"),
        ({"seed": None}, "seed must be a whole number, not None"),
        ({"fraction": "half"}, "fraction must be a finite number, not 'half'"),
        ({"seed": -1}, "seed must not be negative, not -1"),
    ],
)
def test_builder_names_the_bad_value(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ld.ParameterError, match=message):
        ld.bidisperse(**({"number": 8} | wrong))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"positions": np.zeros((3, 2))}, "positions must have shape"),
        ({"positions": None}, "positions must be finite numbers, not None"),
        ({"positions": np.full((2, 2), np.nan)}, "positions must be finite"),
        ({"positions": [[0.0, 0.0], [0.0, 2.7e15]]}, "positions of particle 1, .* boxes away"),
        ({"species": np.array([0, 2])}, "species must lie in 0..1"),
        ({"radii": np.array([0.5, 0.0])}, "radii must be positive"),
        ({"box": np.array([[1.0, 0.5], [0.0, 1.0]])}, "box must be"),
    ],
)
def test_packing_refuses_nonsense(wrong: dict[str, Any], message: str) -> None:
    good = {
        "positions": np.zeros((2, 2)),
        "species": np.array([0, 1]),
        "radii": np.array([0.5, 0.7]),
        "box": np.eye(2),
    }
    ld.Packing(**good)
    with pytest.raises(ld.ParameterError, match=message):
        ld.Packing(**(good | wrong))


def test_species_are_whole_numbers() -> None:
    packing = ld.bidisperse(4)
    with pytest.raises(ld.ParameterError, match="species must be whole numbers"):
        dataclasses.replace(packing, species=np.array([0.0, 0.9, 1.0, 1.0]))


def test_radii_far_from_one_need_another_unit() -> None:
    small, large = (ld.jam(ld.bidisperse(8, radii=(r, r))).packing for r in (1e-3, 50.0))
    assert small.phi == pytest.approx(large.phi, rel=0.05)
    with pytest.raises(ld.ParameterError, match=r"radius of 700 is too large.*unit"):
        ld.push_off(ld.bidisperse(8, radii=(500.0, 700.0)))


# ---- radii of their own ----


def test_polydisperse_takes_radii_as_they_are() -> None:
    """Of two sizes, it is the packing of `bidisperse`."""
    two = ld.bidisperse(20, aspect=0.7, tilt=0.2, seed=3)
    many = ld.polydisperse(20, two.radius, aspect=0.7, tilt=0.2, seed=3)
    assert np.array_equal(many.positions, two.positions)
    assert np.array_equal(many.box, two.box)
    assert np.array_equal(many.radius, two.radius)
    assert many.radii.tolist() == [0.7]
    assert many.phi == two.phi


def test_polydisperse_draws_from_distributions() -> None:
    frozen = stats.lognorm(0.2, scale=0.5)
    packing = ld.polydisperse(4000, frozen, phi=0.6, seed=2)
    assert packing.phi == pytest.approx(0.6)
    # median and width of log R are known to 0.2/sqrt(N) and 0.2/sqrt(2 N), 0.003 and 0.002
    assert np.log(packing.radius).mean() == pytest.approx(np.log(0.5), abs=0.015)
    assert np.log(packing.radius).std() == pytest.approx(0.2, abs=0.01)
    again = ld.polydisperse(4000, frozen, phi=0.6, seed=2)
    assert np.array_equal(again.radius, packing.radius)
    assert not np.array_equal(ld.polydisperse(4000, frozen).radius, packing.radius)

    uniform = ld.polydisperse(50, lambda rng: rng.uniform(0.4, 0.6, 50))
    assert ((uniform.radius > 0.4) & (uniform.radius < 0.6)).all()
    assert len(np.unique(uniform.radius)) == 50


def test_at_keeps_the_sizes() -> None:
    packing = ld.polydisperse(3, [0.4, 0.5, 0.6])
    assert packing.at(0.5).phi == pytest.approx(0.5)
    assert packing.at(0.5).radius.tolist() == [0.4, 0.5, 0.6]


@pytest.mark.parametrize(
    ("radii", "message"),
    [
        ([0.5, 0.5], r"radii must be 3 numbers, shape \(3,\), not \(2,\)"),
        (0.5, r"radii must be 3 numbers, shape \(3,\), not \(\)"),
        ([0.5, 0.0, -1.0], "radii must be positive, but 2 of 3 are not, such as 0: "),
        ([0.5, float("nan"), 0.5], "radii must be finite numbers, not"),
        ([0.5, float("inf"), 0.5], "radii must be finite numbers, not"),
        (["a", "b", "c"], "radii must be finite numbers, not"),
        (stats.norm(-5.0, 0.1), "radii must be positive, but 3 of 3 are not"),
        (lambda rng: rng.uniform(0.4, 0.6, 4), "radii must be 3 numbers"),
        (lambda rng: None, "radii must be 3 numbers|radii must be finite numbers"),
    ],
)
def test_polydisperse_names_the_bad_value(radii: Any, message: str) -> None:
    with pytest.raises(ld.ParameterError, match=message):
        ld.polydisperse(3, radii)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"number": 0}, "number must be at least 1, not 0"),
        ({"phi": -1.0}, "phi must be a positive number, not -1"),
        ({"phi": 84}, "phi is a fraction.* not 84"),
        ({"aspect": 0.0}, "aspect must be a positive number, not 0"),
        ({"tilt": float("nan")}, "tilt must be a finite number, not nan"),
        ({"seed": -1}, "seed must not be negative, not -1"),
    ],
)
def test_polydisperse_checks_the_rest(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ld.ParameterError, match=message):
        ld.polydisperse(**({"number": 2, "radii": [0.5, 0.6]} | wrong))


@pytest.mark.parametrize(
    ("particle_radii", "message"),
    [
        ([0.5, 0.5, 0.5], r"particle_radii must have shape \(2,\), not \(3,\)"),
        ([0.5, 0.0], "at most the radius of the species, 0.7 for particle 1, not 0"),
        ([0.6, 0.6], "at most the radius of the species, 0.5 for particle 0, not 0.6"),
        ([0.5, float("nan")], "particle_radii must be finite"),
    ],
)
def test_packing_refuses_wrong_particle_radii(particle_radii: list[float], message: str) -> None:
    packing = ld.bidisperse(2)
    assert dataclasses.replace(packing, particle_radii=[0.5, 0.6]).radius.tolist() == [0.5, 0.6]
    rounded = [0.5, np.nextafter(0.7, 1.0)]  # 0.7 as LAMMPS writes it
    dataclasses.replace(packing, particle_radii=rounded)
    with pytest.raises(ld.ParameterError, match=message):
        dataclasses.replace(packing, particle_radii=particle_radii)


@pytest.mark.parametrize("walled", [False, True])
def test_radii_grow_in_place_of_a_shrinking_box(walled: bool) -> None:
    """The same packing up to its scale; box, walls and centers stay."""
    start = ld.polydisperse(9, lambda rng: rng.uniform(0.4, 0.6, 9), tilt=0.0)
    if walled:
        start = start.between([*ld.rectangle(6, 7), ld.Disk((3, 3), 1)], seed=1)
    grown, shrunk = start.at(0.7, grow=True), start.at(0.7)
    assert grown.phi == pytest.approx(0.7, rel=1e-12)
    np.testing.assert_array_equal(grown.positions, start.positions)
    np.testing.assert_array_equal(grown.box, start.box)
    assert grown.walls == start.walls
    scale = grown.box[0, 0] / shrunk.box[0, 0]
    np.testing.assert_allclose(grown.radius, scale * shrunk.radius, rtol=1e-12)
    np.testing.assert_allclose(grown.positions, scale * shrunk.positions, rtol=1e-12)


@pytest.mark.parametrize("species", [[0, 0, 0], [0, 0, 1], [2, 2, 0]])
def test_radii_of_particles_are_not_left_out(species: list[int]) -> None:
    """As many radii as particles, of which the species do not take all: told how to give them."""
    places, radii, box = [[1.0, 1.0], [3.0, 1.0], [2.0, 3.0]], [0.5, 0.6, 0.7], (4.0, 4.0)
    told = r"\Aradii are those of species, and the 3 particles .* Packing\.from_arrays\(positions, "
    with pytest.raises(ld.ParameterError, match=told) as error:
        ld.Packing(places, species, radii, box)
    assert "\n" not in str(error.value)
    packing = ld.Packing.from_arrays(places, radii, box, species)
    assert packing.radius.tolist() == radii
    assert packing.species.tolist() == species
    with ld.Simulation(packing, ld.SoftContact()) as disks:
        assert disks.state().packing.radius.tolist() == radii
    # each radius is that of a species, or all are the same
    assert ld.Packing(places, [2, 0, 1], radii, box).radius.tolist() == [0.7, 0.5, 0.6]
    assert ld.Packing(places, species, [0.5] * 3, box).radius.tolist() == [0.5] * 3
