"""Each export is read back by its program, with the numbers of the state."""

import json
import sys
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
import shapely
from lammps_deformable.state.recorded import particle_values

MDAnalysis = pytest.importorskip("MDAnalysis")


@pytest.fixture(scope="module")
def moving() -> ld.State:
    """A packing with velocities, in a tilted box."""
    jammed = ld.jam(ld.bidisperse(24, aspect=1.3, tilt=-0.4, seed=2)).packing
    with ld.Simulation(jammed, ld.Ring(kP=2.0, skin=0.02)) as sim:
        sim.compress(strain=0.02)
        last = sim.run(40, temperature=1e-5, every=20, seed=1)[-1]
    return last


def neighbors(packing: ld.Packing, reach: float) -> set[tuple[int, int]]:
    """Pairs whose nearest images are closer than this; the box must be wider than twice that."""
    i, j = np.triu_indices(len(packing), k=1)
    apart = (packing.positions[j] - packing.positions[i]) @ np.linalg.inv(packing.box)
    images = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 1, 2)
    vectors = (apart - np.rint(apart) + images) @ packing.box
    near = np.linalg.norm(vectors, axis=2).min(axis=0) < reach
    return set(zip(i[near].tolist(), j[near].tolist(), strict=True))


def test_mdanalysis(moving: ld.State) -> None:
    universe, packing = moving.to_mdanalysis(), moving.packing
    atoms = universe.atoms
    assert atoms.positions == pytest.approx(np.pad(packing.positions, ((0, 0), (0, 1))), abs=1e-5)
    assert atoms.velocities[:, :2] == pytest.approx(moving.velocities, rel=1e-5)
    assert np.array_equal(atoms.radii, packing.radii)
    assert atoms.types.astype(int) - 1 == pytest.approx(packing.species)
    assert (atoms.ids[0], atoms.ids[-1], set(atoms.masses)) == (1, 24, {1.0})
    frame = universe.trajectory[0]
    assert frame.triclinic_dimensions[:2, :2] == pytest.approx(packing.box, rel=1e-6)
    for name, values in particle_values(moving).items():
        assert np.array_equal(frame.data[name], values)


def test_mdanalysis_finds_neighbors_in_the_plane_only(moving: ld.State) -> None:
    from MDAnalysis.lib.distances import self_capped_distance

    universe = moving.to_mdanalysis()
    pairs = self_capped_distance(
        universe.atoms.positions, 1.4, box=universe.dimensions, method="nsgrid"
    )[0]
    found = [(min(pair), max(pair)) for pair in pairs.tolist()]
    assert len(found) == len(set(found))
    assert set(found) == neighbors(moving.packing, 1.4)


def test_freud(moving: ld.State) -> None:
    freud = pytest.importorskip("freud")
    box, points = moving.to_freud()
    assert box.is2D
    assert box.volume == pytest.approx(np.prod(moving.packing.box.diagonal()))
    assert box.to_matrix()[:2, :2] == pytest.approx(moving.packing.box.T, rel=1e-6)
    assert box.wrap(points) == pytest.approx(points, abs=1e-6)
    query = freud.locality.AABBQuery(box, points)
    near = query.query(points, {"r_max": 1.4, "exclude_ii": True}).toNeighborList()
    found = {(min(pair), max(pair)) for pair in np.asarray(near[:]).tolist()}
    assert found == neighbors(moving.packing, 1.4)
    order = freud.order.Hexatic().compute(moving.to_freud()).particle_order
    assert order.shape == (24,)


def test_between_walls_no_neighbors_are_across() -> None:
    freud = pytest.importorskip("freud")
    room = ld.BoxWall((6.0, 6.0), (-2.0, 1.0)).parts
    packing = ld.bidisperse(12, seed=1).between(room).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        state = sim.state()
    query = freud.locality.AABBQuery(*state.to_freud())
    near = query.query(query.points, {"r_max": 2.9, "exclude_ii": True}).toNeighborList()
    apart = np.linalg.norm(packing.positions[:, None] - packing.positions, axis=2)
    np.fill_diagonal(apart, np.inf)
    assert len(near) == (apart < 2.9).sum()
    expected = np.pad(packing.positions - packing.origin, ((0, 0), (0, 1)))
    assert state.to_mdanalysis().atoms.positions == pytest.approx(expected, abs=1e-5)


def test_pandas(moving: ld.State) -> None:
    pytest.importorskip("pandas")
    particles, contacts = moving.to_pandas(), moving.to_pandas("contacts")
    packing = moving.packing
    assert np.array_equal(particles[["x", "y"]], packing.positions)
    assert np.array_equal(particles["area_deficit"], moving.area_deficit)
    assert particles.groupby("species")["radius"].max().tolist() == [0.5, 0.7]
    assert len(contacts) == len(moving.contacts)
    assert contacts.groupby("i").size().to_dict() == {
        n: count for n, count in enumerate(moving.n_contacts) if count
    }
    # from a center to the contact line of its neighbor's center, in the image that it touches
    image = contacts[["image_a", "image_b"]].to_numpy() @ packing.box
    here, there = (particles.loc[contacts[side], ["x", "y"]].to_numpy() for side in "ij")
    assert np.linalg.norm(there + image - here, axis=1) == pytest.approx(contacts["distance"])
    with pytest.raises(ld.ParameterError, match="'bubbles'"):
        moving.to_pandas("bubbles")


def polygon_area(outline: np.ndarray) -> float:
    x, y = outline.T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2.0)


def test_vtk_draws_shapes(moving: ld.State, tmp_path: Path) -> None:
    pytest.importorskip("vtkmodules")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    moving.export(tmp_path / "outlines.vtp")
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "outlines.vtp"))
    reader.Update()
    assert reader.GetErrorCode() == 0
    data = reader.GetOutput()
    assert data.GetNumberOfPolys() == data.GetNumberOfCells() == 24
    values = data.GetCellData()
    for name, expected in (
        ("id", np.arange(1, 25)),
        ("type", moving.packing.species + 1),
        ("pressure", moving.pressures),
        ("area_deficit", moving.area_deficit),
        ("shape_parameter", moving.shape_parameter),
    ):
        assert np.array_equal(vtk_to_numpy(values.GetArray(name)), expected)
    for n, outline in enumerate(moving.outlines):
        points = vtk_to_numpy(data.GetCell(n).GetPoints().GetData())
        assert np.array_equal(points[:, :2], outline)
        assert (points[:, 2] == 0.0).all()
    sizes = vtkCellSizeFilter()
    sizes.SetInputData(data)
    sizes.Update()
    areas = vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Area"))
    assert areas == pytest.approx([polygon_area(outline) for outline in moving.outlines])
    field = data.GetFieldData()
    assert vtk_to_numpy(field.GetArray("phi")).tolist() == [moving.phi]
    assert np.array_equal(vtk_to_numpy(field.GetArray("box")), moving.packing.box)


def test_geojson(moving: ld.State, tmp_path: Path) -> None:
    moving.export(str(tmp_path / "outlines.geojson"))
    text = (tmp_path / "outlines.geojson").read_text()
    found = json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))
    assert found["box"] == moving.packing.box.tolist()
    polygons = shapely.from_geojson(text).geoms
    assert len(polygons) == len(found["features"]) == 24
    areas = np.array([polygon.area for polygon in polygons])
    assert areas == pytest.approx([polygon_area(outline) for outline in moving.outlines])
    assert all(polygon.is_valid and polygon.exterior.is_ccw for polygon in polygons)
    # areas of the outlines: chords of 180 points a turn lose 2e-4, skins are outside of `area`
    skin = moving.law.skin
    filled = moving.results["area"] + skin * moving.perimeters + np.pi * skin**2
    assert areas == pytest.approx(filled, rel=3e-4)
    assert moving.volumes == pytest.approx(filled, rel=1e-14)
    for n, feature in enumerate(found["features"]):
        assert feature["properties"]["id"] == n + 1
        assert feature["properties"]["pressure"] == moving.pressures[n]


def test_other_suffixes_are_refused(state: ld.State, tmp_path: Path) -> None:
    with pytest.raises(ld.ParameterError, match=r"\.vtp or \.geojson, not .*a\.obj.*\.export"):
        state.export(tmp_path / "a.obj")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("package", "extra", "method"),
    [
        ("pandas", "pandas", "to_pandas"),
        ("matplotlib", "plot", "plot"),
    ],
)
def test_missing_packages_are_named(
    package: str, extra: str, method: str, state: ld.State, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    way_out = rf"^this needs {package}: pip install 'lammps-deformable\[{extra}\]'$"
    with pytest.raises(ImportError, match=way_out):
        getattr(state, method)()


def test_notebooks_show_the_picture(state: ld.State, monkeypatch: pytest.MonkeyPatch) -> None:
    html = state._repr_html_()
    assert html is not None
    assert html.startswith('<img src="data:image/png;base64,iVBORw0KGgo')
    assert "State: 32 particles, law Ring(kA=2.0), phi = 0.8" in html
    monkeypatch.setattr("lammps_deformable.pictures.plot.find_spec", lambda name: None)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert state._repr_html_() is None


def test_old_names_tell_the_new_ones() -> None:
    packing = ld.bidisperse(4, phi=0.1, seed=1).push_off()
    with ld.Simulation(packing, ld.Ring()) as sim:
        state = sim.state()
    for owner, old, new in (
        (packing, "to_file", "export"),
        (state, "to_surface_evolver", "export"),
    ):
        name = type(owner).__name__
        with pytest.raises(AttributeError, match=rf"^{name}\.{old} is {name}\.{new} now$"):
            getattr(owner, old)
        assert not hasattr(owner, old)
