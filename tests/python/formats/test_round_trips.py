"""Packings that go out to a file come back equal, to the last bit where the format allows."""

import warnings
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lammps_deformable import Packing

TEXTS = (".data", ".lammpstrj", ".xyz")
SINGLE = 2.0**-24

lengths = st.floats(1e-3, 1e3)


@st.composite
def packings(draw: st.DrawFn) -> Packing:
    """Any radii, boxes and species, some of which have no particles, and images outside."""
    number = draw(st.integers(1, 12))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    lx, ly = draw(lengths), draw(lengths)
    box = np.array([[lx, 0.0], [draw(st.floats(-29.0, 29.0)) * lx, ly]])
    radii = draw(lengths) * rng.uniform(0.5, 1.5, 3)
    species = rng.integers(0, draw(st.integers(1, 3)), number)
    own = radii[species] * (rng.uniform(0.5, 1.0, number) if draw(st.booleans()) else 1.0)
    return Packing(rng.uniform(-2.0, 3.0, (number, 2)) @ box, own, box, species=species)


def check_equal(found: Packing, packing: Packing) -> None:
    for name in ("positions", "radii", "species", "box"):
        np.testing.assert_array_equal(getattr(found, name), getattr(packing, name), name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("files")


@pytest.mark.parametrize("suffix", TEXTS)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.differing_executors])
@given(packing=packings())
def test_texts_keep_every_bit(suffix: str, folder: Path, packing: Packing) -> None:
    path = folder / f"any{suffix}"
    packing.export(path, mode="w")
    found = Packing.from_file(path)
    check_equal(found, packing)


@settings(max_examples=40, deadline=None)
@given(packing=packings())
def test_gsd_keeps_single_precision(folder: Path, packing: Packing) -> None:
    """Of the numbers in the file: lengths, tilt over height, and positions about the center."""
    pytest.importorskip("gsd")
    packing.export(folder / "any.gsd", mode="w")
    found = Packing.from_file(folder / "any.gsd")
    sizes = np.abs(packing.box).sum(axis=0)
    np.testing.assert_array_equal(found.species, packing.species)
    np.testing.assert_allclose(found.radii, packing.radii, rtol=2.0 * SINGLE)
    assert (np.abs(found.box - packing.box) <= 4.0 * SINGLE * sizes).all()
    # images up to three boxes away, and the center
    assert (np.abs(found.positions - packing.positions) <= 20.0 * SINGLE * sizes).all()


@pytest.mark.parametrize("suffix", [".xyz", ".gsd"])
def test_walls_are_told_and_given_again(suffix: str, tmp_path: Path) -> None:
    channel = [ld.Plane((0, -3), (0, 1)), ld.Plane((0, 4), (0, -1))]
    for walls in ([ld.Sphere(7.0, (1.0, -2.0))], channel):
        walled, path = ld.bidisperse(20, seed=1).between(walls), tmp_path / f"walled{suffix}"
        with pytest.warns(ld.UnsavedWarning, match="lacks the walls"):
            walled.export(path, mode="w")
        found = Packing.from_file(path, walls=walls)
        assert found.walls == walled.walls
        np.testing.assert_allclose(found.box, walled.box, rtol=2.0 * SINGLE)
        if suffix != ".gsd":
            np.testing.assert_array_equal(found.positions, walled.positions)


def test_a_box_that_ends_needs_walls(tmp_path: Path) -> None:
    walled = ld.bidisperse(9, seed=1).between(ld.BoxWall((8, 9)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        walled.export(tmp_path / "walled.xyz")
    with pytest.raises(ld.FileError, match=r"not periodic along x: give the walls"):
        Packing.from_file(tmp_path / "walled.xyz")
    assert Packing.from_file(tmp_path / "walled.xyz", box=(8, 9)).walls == ()


def test_a_saved_packing_has_no_radii_but_takes_them(state: ld.State, tmp_path: Path) -> None:
    state.save(tmp_path)
    with pytest.raises(ld.FileError, match="it has no radii"):
        Packing.from_file(tmp_path / "packing.data")
    radii = {1: 0.5, 2: 0.7}
    check_equal(Packing.from_file(tmp_path / "packing.data", radii=radii), state.packing)


def test_a_box_is_two_lengths_wherever_it_is_asked_for(jammed: Packing) -> None:
    lx, ly = (1.01 * jammed.box.diagonal()).tolist()
    with ld.Simulation(jammed, ld.Ring()) as sim:
        sim.deform((lx, ly))
        np.testing.assert_allclose(sim.box, np.diag([lx, ly]), rtol=1e-15)


def test_suffixes(jammed: Packing, tmp_path: Path) -> None:
    with pytest.raises(ld.ParameterError, match=r"suffix of '.*pdb' must be one of \.data"):
        jammed.export(tmp_path / "packing.pdb")
    with pytest.raises(ld.FileError, match=r"nowhere/packing\.data' cannot be written"):
        jammed.export(tmp_path / "nowhere" / "packing.data")
    with pytest.raises(ld.FileError, match=r"nowhere/packing\.gsd' cannot be written"):
        jammed.export(tmp_path / "nowhere" / "packing.gsd")
