"""Outlines as polygons, with values of the particles: VTK (ParaView, OVITO) and GeoJSON."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.files import write_whole

_Outlines = Sequence[NDArray[np.float64]]
_Values = Mapping[str, NDArray[Any]]

# VTK's names of the numbers in its files, by numpy's kinds of numbers; OVITO reads no others.
_TYPES = {"i": ("Int64", "<i8"), "f": ("Float64", "<f8")}


def write_outlines(
    path: str | Path, outlines: _Outlines, values: _Values, numbers: Mapping[str, Any]
) -> None:
    """Write the outlines of a packing into a file, .vtp or .geojson.

    Args:
        path: of the file; its suffix names the format.
        outlines: counterclockwise polygons, arrays (m, 2) [length].
        values: of the particles by name, arrays of shape (N,).
        numbers: of the whole packing by name.

    Raises:
        ParameterError: the suffix is another.
    """
    texts = {".vtp": polydata, ".geojson": feature_collection}
    path = Path(path)
    if path.suffix not in texts:
        raise ParameterError(f"outlines are written as .vtp or .geojson, not as '{path}'")
    write_whole(path, texts[path.suffix](outlines, values, numbers))


def polydata(outlines: _Outlines, values: _Values, numbers: Mapping[str, Any]) -> str:
    """Text of a VTK file of polygons: values as cell data, numbers as field data.

    Source: VTK's XML formats, docs.vtk.org; binary data inline, which OVITO reads too.
    """
    points = np.concatenate(outlines)
    file = ElementTree.Element(
        "VTKFile", type="PolyData", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    data = ElementTree.SubElement(file, "PolyData")
    field = ElementTree.SubElement(data, "FieldData")
    for name, number in numbers.items():
        array = np.atleast_1d(number)
        count = {"NumberOfTuples": str(len(array)), "NumberOfComponents": str(array[0].size)}
        _add(field, name, array, **count)
    piece = ElementTree.SubElement(
        data, "Piece", NumberOfPoints=str(len(points)), NumberOfPolys=str(len(outlines))
    )
    place = ElementTree.SubElement(piece, "Points")
    in_space = np.column_stack([points, np.zeros(len(points))])
    _add(place, "Points", in_space, NumberOfComponents="3")
    polygons = ElementTree.SubElement(piece, "Polys")
    _add(polygons, "connectivity", np.arange(len(points)))
    _add(polygons, "offsets", np.cumsum([len(outline) for outline in outlines]))
    cells = ElementTree.SubElement(piece, "CellData")
    for name, array in values.items():
        _add(cells, name, array)
    ElementTree.indent(file)
    return ElementTree.tostring(file, encoding="unicode", xml_declaration=True) + "\n"


def _add(parent: ElementTree.Element, name: str, array: NDArray[Any], **attributes: str) -> None:
    """Add an array to an XML element: its number of bytes, then the bytes, in base64."""
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


def feature_collection(outlines: _Outlines, values: _Values, numbers: Mapping[str, Any]) -> str:
    """Text of a GeoJSON file: a polygon for each particle, with its values as properties.

    Lengths stand in the place of degrees, as programs for plane geometry take them. The numbers of
    the packing are members of the collection.

    Source: RFC 7946.
    """
    rows = zip(*(array.tolist() for array in values.values()), strict=True)
    features = [
        {
            "type": "Feature",
            "geometry": {"type": "Polygon", "coordinates": [[*ring, ring[0]]]},
            "properties": dict(zip(values, row, strict=True)),
        }
        for ring, row in zip((outline.tolist() for outline in outlines), rows, strict=True)
    ]
    plain = {name: np.asarray(number).tolist() for name, number in numbers.items()}
    return json.dumps({"type": "FeatureCollection", **plain, "features": features}) + "\n"
