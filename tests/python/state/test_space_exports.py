"""Exports in three dimensions, read back by their programs, with the numbers of the state."""

import json
from itertools import pairwise
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import State
from lammps_deformable.pictures.plot3d import WHOLE, Facets, Surfaces, facets_of, surfaces_of
from lammps_deformable.state.recorded import particle_values


@pytest.fixture(scope="module")
def state() -> State:
    """Of two species, in a box that leans all ways."""
    start = ld.bidisperse(24, sizes=(0.5, 0.6), dimension=3, aspect=1.4, tilt=0.3, seed=2)
    box = start.box + np.array([[0.0] * 3, [0.0] * 3, [0.7, -0.4, 0.0]])
    leaning = start.replace(box=box, positions=start.positions @ np.linalg.inv(start.box) @ box)
    packing = leaning.at(0.7).push_off()
    with ld.Simulation(packing, ld.Droplet([1.0, 1.5])) as sim:
        return sim.relax(1e-3)


def triangles(found: Surfaces) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the triangles of all polygons, shape (T, 3), and the polygon of each."""
    parts = np.split(found.corners, found.ends[:-1])
    fans = [[part[0], a, b] for part in parts for a, b in pairwise(part[1:])]
    return np.array(fans), np.repeat(np.arange(len(parts)), [len(part) - 2 for part in parts])


def volume(found: Surfaces) -> float:
    a, b, c = found.points[triangles(found)[0].T]
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def areas(found: Surfaces, count: int) -> np.ndarray:
    """Of the sphere, and of each facet."""
    corners, polygon = triangles(found)
    a, b, c = found.points[corners.T]
    each = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0
    return np.bincount(found.facet[polygon] + 1, each, minlength=count + 1)


def cut(radius: float, normals: list[list[float]], heights: list[float]) -> Surfaces:
    normal = np.array(normals, float)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    facets = Facets(np.zeros(len(normal), np.int64), normal, np.array(heights))
    return surfaces_of(np.zeros((1, 3)), np.array([radius]), facets)


def test_a_whole_sphere() -> None:
    """A polyhedron of 120 corners within it has 5 % less volume."""
    found = surfaces_of(np.ones((1, 3)), np.array([2.0]), WHOLE)
    assert np.linalg.norm(found.points - 1.0, axis=1) == pytest.approx(2.0)
    assert found.normals == pytest.approx((found.points - 1.0) / 2.0)
    assert 0.94 < volume(found) / (4.0 / 3.0 * np.pi * 8.0) < 1.0
    assert (found.facet == -1).all()


def test_a_cap_is_cut_off() -> None:
    """The facet is a polygon of twelve corners on its circle."""
    found = cut(1.0, [[1.0, 2.0, 2.0]], [0.8])
    dodecagon = 3.0 * (1.0 - 0.8**2)
    assert areas(found, 1)[1] == pytest.approx(dodecagon)
    assert found.facet[-1] == 0
    assert found.normals[found.corners[-12:]] == pytest.approx(np.tile([1, 2, 2], (12, 1)) / 3.0)
    cap = np.pi * 0.2**2 * (3.0 - 0.2) / 3.0
    whole = volume(surfaces_of(np.zeros((1, 3)), np.ones(1), WHOLE))
    assert whole - volume(found) == pytest.approx(cap, abs=0.03)  # of a polyhedron
    assert cut(1.0, [[0.0, 0.0, 1.0]], [1.1]).facet.max() == -1  # it misses the sphere


def test_facets_that_meet_leave_a_polyhedron() -> None:
    """Far beyond the model: the cells of fcc, bcc and sc."""
    cube = (
        [[x, 0, 0] for x in (1, -1)] + [[0, x, 0] for x in (1, -1)] + [[0, 0, x] for x in (1, -1)]
    )
    edges = [[a, b, 0] for a in (1, -1) for b in (1, -1)]
    dodecahedron = [turned for n in edges for turned in (n, n[::-1], [n[0], 0, n[1]])]
    octahedron = [[a, b, c] for a in (1, -1) for b in (1, -1) for c in (1, -1)]
    truncated = cut(2.0, octahedron + cube, [0.75**0.5] * 8 + [1.0] * 6)
    for found, expected, corners in (
        (cut(1.8, cube, [1.0] * 6), 8.0, 8),
        (cut(1.5, dodecahedron, [1.0] * 12), 4.0 * np.sqrt(2.0), 14),
        (truncated, 4.0, 24),
    ):
        assert volume(found) == pytest.approx(expected, rel=1e-9)
        assert len(np.unique(found.points.round(6), axis=0)) == corners
        assert found.facet.min() == 0
    # where two facets meet within the sphere they have one edge
    pair = cut(1.0, [[1, 0, 0], [0, 1, 0]], [0.6, 0.6])
    ends = np.unique(
        pair.points[(np.abs(pair.points[:, :2] - 0.6) < 1e-9).all(axis=1)].round(6), axis=0
    )
    assert ends == pytest.approx(
        np.array([[0.6, 0.6, -np.sqrt(0.28)], [0.6, 0.6, np.sqrt(0.28)]]), abs=1e-6
    )


def test_surfaces_are_closed(state: State) -> None:
    """Each edge of a polygon is that of another one the other way round."""
    found = surfaces_of(state.packing.positions, state.packing.radii, facets_of(state))
    _, point = np.unique(found.points.round(9), axis=0, return_inverse=True)
    parts = np.split(point.ravel()[found.corners], found.ends[:-1])
    edges = np.concatenate([np.column_stack([part, np.roll(part, -1)]) for part in parts])
    assert {*map(tuple, edges.tolist())} == {*map(tuple, edges[:, ::-1].tolist())}


def read_vtp(path: Path) -> tuple[object, dict[str, np.ndarray]]:
    pytest.importorskip("vtkmodules")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    data = reader.GetOutput()
    cells = data.GetCellData()
    names = [cells.GetArrayName(n) for n in range(cells.GetNumberOfArrays())]
    return data, {name: vtk_to_numpy(cells.GetArray(name)) for name in names}


def test_vtk_has_droplets_with_facets(state: State, tmp_path: Path) -> None:
    state.export(tmp_path / "droplets.vtp")
    data, values = read_vtp(tmp_path / "droplets.vtp")
    owner = values["id"] - 1
    for name in ("load", "pressure", "contacts", "radius"):
        assert np.array_equal(values[name], particle_values(state)[name][owner])
    assert np.array_equal(values["type"], state.packing.species[owner] + 1)
    table = state.contacts[state.contacts["indentation"] > 1e-3]
    on = values["neighbor"] > 0
    pairs = set(zip(values["id"][on].tolist(), values["neighbor"][on].tolist(), strict=True))
    assert {(i + 1, j + 1) for i, j in table[["i", "j"]].tolist()} <= pairs
    assert set(values["force"][on]) <= set(state.contacts["force"])
    assert (values["force"][~on] == 0.0).all()
    assert data.GetPointData().GetNormals() is not None


def test_vtk_has_the_network(state: State, tmp_path: Path) -> None:
    state.export(tmp_path / "network.vtp", forces=True)
    data, values = read_vtp(tmp_path / "network.vtp")
    half = len(state.contacts) // 2
    assert data.GetNumberOfLines() == data.GetNumberOfCells() == half
    assert np.sort(values["force"]) == pytest.approx(
        np.sort(state.contacts["force"])[::2], rel=1e-6
    )
    for n in (0, half - 1):
        points = data.GetCell(n).GetPoints()
        begin, end = (np.array(points.GetPoint(k)) for k in (0, 1))
        assert begin == pytest.approx(state.packing.positions[values["i"][n] - 1])
        assert np.linalg.norm(end - begin) == pytest.approx(values["distance"][n])


def test_networks_have_friction(tmp_path: Path) -> None:
    """In space it is a vector along the contact, the same in the table, the graph and the file."""
    loose = ld.bidisperse(12, dimension=3, seed=1).at(0.68).push_off()
    rough = ld.Friction(0.3, kt=0.3)
    with ld.Simulation(loose, ld.Droplet(), friction=rough) as sim:
        state = sim.run(50, temperature=1e-2, seed=1)[-1]
    table = state.contacts
    first = table[table["i"] < table["j"]]
    edges = [edge for *_, edge in state.graph().edges(data=True)]
    assert np.abs(first["friction"]).max() > 0.0
    state.export(tmp_path / "network.vtp", forces=True)
    _, values = read_vtp(tmp_path / "network.vtp")
    for found in (np.array([edge["friction"] for edge in edges]), values["friction"]):
        assert sorted(found.tolist()) == sorted(first["friction"].tolist())
    assert (
        sum(edge["sliding"] for edge in edges) == values["sliding"].sum() == first["sliding"].sum()
    )


def test_networks_in_the_plane(tmp_path: Path) -> None:
    """With a wall, as lines of both formats."""
    loose = ld.bidisperse(12, seed=1).between(ld.BoxWall((6.0, 6.0)))
    with ld.Simulation(loose.at(0.85).push_off(), ld.Ring()) as sim:
        state = sim.state()
    state.export(tmp_path / "network.vtp", forces=True)
    _, values = read_vtp(tmp_path / "network.vtp")
    graph = state.graph()
    assert len(values["i"]) == graph.number_of_edges()
    assert (values["j"] == -1).sum() == graph.degree(-1) > 0
    state.export(tmp_path / "network.geojson", forces=True)
    features = json.loads((tmp_path / "network.geojson").read_text())["features"]
    assert {feature["geometry"]["type"] for feature in features} == {"LineString"}
    assert sum(feature["properties"]["force"] for feature in features) == pytest.approx(
        graph.size("force")
    )


def test_tables(state: State) -> None:
    pytest.importorskip("pandas")
    particles, contacts = state.to_pandas(), state.to_pandas("contacts")
    assert np.array_equal(particles[["x", "y", "z"]], state.packing.positions)
    assert np.array_equal(particles["load"], state.loads)
    assert contacts.groupby("i")["force"].size().reindex(range(24), fill_value=0).tolist() == [
        *state.n_contacts
    ]
    image = contacts[["image_a", "image_b", "image_c"]].to_numpy() @ state.packing.box
    here, there = (particles.loc[contacts[side], ["x", "y", "z"]].to_numpy() for side in "ij")
    normal = contacts[["nx", "ny", "nz"]].to_numpy() * contacts["distance"].to_numpy()[:, None]
    assert there + image - here == pytest.approx(normal, abs=1e-6)
    assert {"fx", "fy", "fz", "facet_radius", "indentation"} <= set(contacts.columns)


def test_mdanalysis(state: State) -> None:
    universe = state.to_mdanalysis()
    frame = universe.trajectory.ts
    assert universe.atoms.positions == pytest.approx(state.packing.positions, abs=1e-5)
    assert frame.triclinic_dimensions == pytest.approx(state.packing.box, abs=1e-5)
    assert np.array_equal(frame.data["load"], state.loads)
    assert universe.atoms.velocities == pytest.approx(state.velocities)


def test_freud(state: State) -> None:
    freud = pytest.importorskip("freud")
    box, points = state.to_freud()
    assert box.to_matrix() == pytest.approx(state.packing.box.T, rel=1e-6)
    found = state.to_freud("contacts")
    assert len(found) == len(state.contacts)
    assert np.array_equal(found.neighbor_counts, state.n_contacts)
    assert found.weights.sum() == pytest.approx(state.contacts["force"].sum(), rel=1e-6)
    between = box.wrap(points[found.point_indices] - points[found.query_point_indices])
    assert between == pytest.approx(box.wrap(found.vectors), abs=1e-4)
    order = freud.order.Steinhardt(6).compute(state.to_freud(), neighbors=found)
    assert order.particle_order.shape == (24,)


def test_refusals(state: State, tmp_path: Path) -> None:
    with pytest.raises(ld.ParameterError, match=r"in space are written as \.vtp, not"):
        state.export(tmp_path / "droplets.geojson")
    with pytest.raises(ld.ParameterError, match="forces must be of the kind bool"):
        state.export(tmp_path / "droplets.vtp", forces=1)  # type: ignore[arg-type]
    with pytest.raises(ld.ParameterError, match="what must be points or contacts, not 3"):
        state.to_freud(3)  # type: ignore[arg-type]
    with pytest.raises(ld.ParameterError, match="table must be particles or contacts"):
        state.to_pandas("facets")
    assert not list(tmp_path.iterdir())


def test_a_loose_state_has_no_contacts(tmp_path: Path) -> None:
    packing = ld.crystal("sc", 2, phi=0.3)
    with ld.Simulation(packing, ld.Droplet()) as sim:
        loose = sim.state()
    loose.export(tmp_path / "droplets.vtp")
    _, values = read_vtp(tmp_path / "droplets.vtp")
    assert (values["neighbor"] == 0).all()
    loose.export(tmp_path / "network.vtp", forces=True)
    data, _ = read_vtp(tmp_path / "network.vtp")
    assert data.GetNumberOfLines() == 0
    assert len(loose.to_pandas("contacts")) == 0
    assert len(loose.to_freud("contacts")) == 0
    assert loose.steinhardt() == pytest.approx(np.full(8, np.sqrt(1.0 / 8.0)))
    for settings in ({}, {"forces": True}, {"slice": 0.0, "contacts": True}):
        assert loose.plot(**settings)


def test_facets_at_walls_have_the_neighbor_minus_one(tmp_path: Path) -> None:
    walls = ld.BoxWall((0.98, 3.0, 3.0))
    packing = ld.Packing([[0.49, 1.5, 1.5]], 0.5, walls.lengths, walls=walls)
    with ld.Simulation(packing, ld.Droplet()) as sim:
        sim.state().export(tmp_path / "droplet.vtp")
    _, values = read_vtp(tmp_path / "droplet.vtp")
    assert values["neighbor"][values["force"] > 0.0].tolist() == [-1, -1]
    assert {*values["neighbor"][values["force"] == 0.0].tolist()} == {0}
