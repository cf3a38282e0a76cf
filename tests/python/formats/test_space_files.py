"""Files of packings in three dimensions: what goes out comes back, and a plane stays a plane."""

from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lammps_deformable import Packing
from refusals import refused
from test_round_trips import SINGLE, TEXTS, check_equal, lengths


@st.composite
def packings(draw: st.DrawFn) -> Packing:
    """Any radii, boxes and species, and images outside."""
    number = draw(st.integers(1, 8))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    box = np.diag([draw(lengths), draw(lengths), draw(lengths)])
    tilts = draw(st.sampled_from([0.0, 29.0]))
    for lower, upper in ((1, 0), (2, 0), (2, 1)):
        box[lower, upper] = rng.uniform(-1.0, 1.0) * tilts * box[upper, upper]
    radii = draw(lengths) * rng.uniform(0.5, 1.5, 3)
    species = rng.integers(0, draw(st.integers(1, 3)), number)
    own = radii[species] * (rng.uniform(0.5, 1.0, number) if draw(st.booleans()) else 1.0)
    return Packing(rng.uniform(-2.0, 3.0, (number, 3)) @ box, own, box, species=species)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("files")


@pytest.mark.parametrize("suffix", TEXTS)
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.differing_executors])
@given(packing=packings())
def test_texts_keep_every_bit(suffix: str, folder: Path, packing: Packing) -> None:
    path = folder / f"any{suffix}"
    packing.export(path, mode="w")
    check_equal(Packing.from_file(path, dimension=3), packing)


@settings(max_examples=25, deadline=None)
@given(packing=packings())
def test_gsd_keeps_single_precision(folder: Path, packing: Packing) -> None:
    """Of lengths, of tilts over heights, and of positions, up to three boxes away."""
    pytest.importorskip("gsd")
    packing.export(folder / "any.gsd", mode="w")
    found = Packing.from_file(folder / "any.gsd", dimension=3)
    sizes = np.abs(packing.box).sum(axis=0)
    assert (np.abs(found.box - packing.box) <= 4.0 * SINGLE * sizes).all()
    assert (np.abs(found.positions - packing.positions) <= 30.0 * SINGLE * sizes).all()
    np.testing.assert_allclose(found.radii, packing.radii, rtol=2.0 * SINGLE)


@pytest.mark.parametrize("suffix", [".data", ".gsd"])
def test_a_plane_is_not_taken_from_space(suffix: str, tmp_path: Path) -> None:
    if suffix == ".gsd":
        pytest.importorskip("gsd")
    path = tmp_path / f"spheres{suffix}"
    ld.crystal("fcc", 2).export(path)
    with pytest.raises(ld.FileError, match=r"atoms fill space, z goes .* dimension=3"):
        Packing.from_file(path)


def test_lammps_reads_and_writes_the_same(tmp_path: Path) -> None:
    """Its own data file and dump of a tilted box."""
    box = [[4.0, 0.0, 0.0], [1.1, 3.5, 0.0], [-0.9, 0.6, 4.2]]
    places = np.random.default_rng(1).random((9, 3)) @ box
    packing = Packing(places, np.linspace(0.3, 0.5, 9), box)
    with ld.Simulation(packing, ld.SoftContact()) as spheres:
        columns = "id type xs ys zs radius"
        dump = tmp_path / "lammps.dump"
        spheres.lmp.command(f"write_data {tmp_path / 'lammps.data'}")
        spheres.lmp.command(
            f"write_dump all custom {dump} {columns} modify format float %.17g sort id"
        )
    for path in (tmp_path / "lammps.data", dump):
        found = Packing.from_file(path, dimension=3)
        assert found.box == pytest.approx(packing.box, rel=1e-12)
        assert found.positions == pytest.approx(packing.positions, abs=1e-12)
        assert found.radii == pytest.approx(packing.radii, rel=1e-12)


def test_mdanalysis_has_the_same_distances() -> None:
    """Its own search for neighbors finds the contacts of a crystal, and a tilted box is one."""
    from MDAnalysis.lib.distances import self_capped_distance

    crystal = ld.crystal("bcc", 3)
    universe = crystal.to_mdanalysis()
    pairs = self_capped_distance(
        universe.atoms.positions, 1.001, box=universe.dimensions, return_distances=False
    )
    assert len(pairs) == 4 * len(crystal)
    tilted = crystal.box + np.tril(np.full((3, 3), 0.7), -1)
    leaning = Packing(crystal.positions, crystal.radii, tilted, species=crystal.species)
    found = leaning.to_mdanalysis().trajectory.ts.triclinic_dimensions
    assert found == pytest.approx(tilted, abs=1e-5)


def test_bad_boxes(tmp_path: Path) -> None:
    for change, told in (
        (
            ("pp pp pp", "pp pp ff"),
            r"along z: give the walls there, such as walls=BoxWall\(\(lx, ly, lz\)\), or a p",
        ),
        (("0.0 2.8", "0.0 -2.8"), "its box is"),
    ):
        path = tmp_path / "spheres.dump"
        ld.crystal("fcc", 2, phi=np.pi / np.sqrt(18.0)).export(path, mode="w")
        text = path.read_text()
        assert change[0] in text
        path.write_text(text.replace(*change))
        with refused(told, ld.FileError):
            Packing.from_file(path, dimension=3)
