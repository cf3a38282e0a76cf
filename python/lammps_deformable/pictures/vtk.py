"""Outlines and contacts with their values in files of VTK and GeoJSON, for other programs.

Source: VTK's XML formats, docs.vtk.org; binary data inline, which ParaView and OVITO read.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..common.box import in_space
from ..common.checks import expect
from ..common.errors import ParameterError
from ..common.files import at_home, refuse_present, replaces, write_whole
from ..state.contacts import forces_of

if TYPE_CHECKING:
    from ..particles.packing import Packing
    from ..state.contacts import ContactForces
    from ..state.state import State
from ..formats.surface_evolver import datafile
from ..state.conversions import values_of

# VTK's names of the numbers in its files, by numpy's kinds of numbers; OVITO reads no others.
_TYPES = {"i": ("Int64", "<i8"), "f": ("Float64", "<f8")}


class Shapes(NamedTuple):
    """Polygons, or lines.

    Attributes:
        points: shape (P, d) [length].
        corners: points of all shapes, one after the other, shape (K,).
        ends: where each shape ends in them, shape (M,).
        lines: whether they are lines.
        normals: at the points, if surfaces are to look round, shape (P, 3).
    """

    points: NDArray[np.float64]
    corners: NDArray[np.int64]
    ends: NDArray[np.int64]
    lines: bool = False
    normals: NDArray[np.float64] | None = None


def polydata(shapes: Shapes, values: Mapping[str, NDArray[Any]], numbers: Mapping[str, Any]) -> str:
    """Text of a .vtp: values of the shapes as cell data, numbers of the packing as field data."""
    file = ElementTree.Element(
        "VTKFile", type="PolyData", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    data = ElementTree.SubElement(file, "PolyData")
    field = ElementTree.SubElement(data, "FieldData")
    for name, number in numbers.items():
        array = np.atleast_1d(number)
        count = {"NumberOfTuples": str(len(array)), "NumberOfComponents": str(array[0].size)}
        _add(field, name, array, **count)
    points, kind = shapes.points, "Lines" if shapes.lines else "Polys"
    counts = {"NumberOfPoints": str(len(points)), f"NumberOf{kind}": str(len(shapes.ends))}
    piece = ElementTree.SubElement(data, "Piece", counts)
    if shapes.normals is not None:
        of_points = ElementTree.SubElement(piece, "PointData", Normals="Normals")
        _add(of_points, "Normals", shapes.normals)
    _add(ElementTree.SubElement(piece, "Points"), "Points", in_space(points))
    cells = ElementTree.SubElement(piece, kind)
    _add(cells, "connectivity", shapes.corners)
    _add(cells, "offsets", shapes.ends)
    of_cells = ElementTree.SubElement(piece, "CellData")
    for name, array in values.items():
        _add(of_cells, name, array)
    ElementTree.indent(file)
    return ElementTree.tostring(file, encoding="unicode", xml_declaration=True) + "\n"


def _add(parent: ElementTree.Element, name: str, array: NDArray[Any], **attributes: str) -> None:
    """Add an array to an XML element: its number of bytes, then the bytes, in base64.

    Rows of a matrix are vectors, which VTK calls tuples of components.
    """
    if array.ndim == 2:
        attributes = {"NumberOfComponents": str(array.shape[1])} | attributes
    word, layout = _TYPES["f" if array.dtype.kind == "f" else "i"]
    content = array.astype(layout).tobytes()
    element = ElementTree.SubElement(
        parent, "DataArray", {"type": word, "Name": name, "format": "binary"} | attributes
    )
    element.text = base64.b64encode(np.uint64(len(content)).tobytes() + content).decode()


def collection(files: Sequence[str], times: Sequence[float]) -> str:
    """Text of a ParaView file, .pvd, that lists the files of a series in order.

    Files have their times, or their numbers where time does not grow from each to the next.
    """
    grows = all(before < after for before, after in pairwise(times))
    steps = times if len(times) > 1 and grows else range(len(files))
    file = ElementTree.Element("VTKFile", type="Collection", version="1.0")
    listed = ElementTree.SubElement(file, "Collection")
    for step, name in zip(steps, files, strict=True):
        ElementTree.SubElement(listed, "DataSet", timestep=str(step), part="0", file=name)
    ElementTree.indent(file)
    return ElementTree.tostring(file, encoding="unicode", xml_declaration=True) + "\n"


_Values = Mapping[str, NDArray[Any]]


def write_shapes(
    path: str | Path, shapes: Shapes, values: _Values, numbers: Mapping[str, Any]
) -> None:
    """Write polygons or lines into a file, .vtp or, in the plane, .geojson.

    Args:
        path: of the file; its suffix names the format.
        shapes: with points of shape (P, 2) in the plane.
        values: of the shapes by name, arrays of shape (M,).
        numbers: of the whole packing by name.

    Raises:
        ParameterError: the suffix is another.
    """
    path, plane = Path(path), shapes.points.shape[1] == 2
    texts = {".vtp": polydata} | ({".geojson": feature_collection} if plane else {})
    if path.suffix not in texts:
        kinds = "shapes in the plane are written as" if plane else "shapes in space are written as"
        raise ParameterError(
            f"{kinds} {' or '.join(texts)}, not as '{path}': packing.export writes the centers"
        )
    write_whole(path, texts[path.suffix](shapes, values, numbers))


def polygons_of(outlines: Sequence[NDArray[np.float64]]) -> Shapes:
    """Closed outlines as polygons."""
    points = np.concatenate(outlines)
    return Shapes(points, np.arange(len(points)), np.cumsum([len(each) for each in outlines]))


def feature_collection(shapes: Shapes, values: _Values, numbers: Mapping[str, Any]) -> str:
    """Text of a GeoJSON file: a polygon or a line for each shape, with its values as properties.

    Lengths stand in the place of degrees, as programs for plane geometry take them. The numbers of
    the packing are members of the collection.

    Source: RFC 7946.
    """
    rows = zip(*(array.tolist() for array in values.values()), strict=True)
    parts = np.split(shapes.points[shapes.corners], shapes.ends[:-1])
    features = [
        {
            "type": "Feature",
            "geometry": _geometry(part.tolist(), shapes.lines),
            "properties": dict(zip(values, row, strict=True)),
        }
        for part, row in zip(parts, rows, strict=True)
    ]
    plain = {name: np.asarray(number).tolist() for name, number in numbers.items()}
    return json.dumps({"type": "FeatureCollection", **plain, "features": features}) + "\n"


def _geometry(part: list[list[float]], line: bool) -> dict[str, Any]:
    if line:
        return {"type": "LineString", "coordinates": part}
    return {"type": "Polygon", "coordinates": [[*part, part[0]]]}


def export(state: State, path: str | Path, forces: bool, mode: str) -> None:
    """See `State.export`."""
    expect("path", path, str, Path)
    expect("forces", forces, bool)
    if not state._root:
        return
    path = at_home(path)
    refuse_present(path, replaces(mode))
    if path.suffix == ".fe":
        if forces:
            raise ParameterError("Surface Evolver takes no network of forces: leave out forces")
        write_whole(path, datafile(state))
        return
    packing = state.packing
    numbers = {"box": packing.box, "phi": state.phi, "pressure": state.pressure}
    if forces:
        shapes, values = _network(packing, forces_of(state))
    else:
        names = {"id": np.arange(1, len(packing) + 1), "type": packing.species + 1}
        shapes, particle, further = _bodies(state)
        every = names | values_of(state)
        values = {name: each[particle] for name, each in every.items()} | further
    write_shapes(path, shapes, values, numbers)


def _bodies(state: State) -> tuple[Shapes, NDArray[np.int64], dict[str, NDArray[Any]]]:
    """Shapes of the particles, the particle of each, and further values of the shapes."""
    packing = state.packing
    if packing.dimension == 2:
        return polygons_of(state.outlines), np.arange(len(packing)), {}
    from .plot3d import facets_of, surfaces_of

    found = surfaces_of(packing.positions, packing.radii, facets_of(state))
    shapes = Shapes(found.points, found.corners, found.ends, normals=found.normals)
    j, force = state.contacts["j"], state.contacts["force"]
    # of what is no facet, -1, both are 0
    partners = np.where(j < 0, -1, j + 1)
    values = {"neighbor": np.append(partners, 0), "force": np.append(force, 0.0)}
    return shapes, found.body, {name: each[found.facet] for name, each in values.items()}


def _network(packing: Packing, contacts: ContactForces) -> tuple[Shapes, dict[str, NDArray[Any]]]:
    """Contacts as lines, and their values."""
    begin = packing.positions[contacts.i]
    points = np.stack([begin, begin + contacts.vector], axis=1).reshape(-1, packing.dimension)
    both = np.arange(len(points))
    ids = {name: np.where(n < 0, -1, n + 1) for name, n in zip("ij", contacts[:2], strict=True)}
    values = {**ids, "force": contacts.push, "distance": contacts.distance, **contacts.rubbing}
    return Shapes(points, both, both[1::2] + 1, lines=True), values
