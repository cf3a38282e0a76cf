"""Files of VTK, which ParaView and OVITO read: polygons or lines with values, and series of them.

Source: VTK's XML formats, docs.vtk.org; binary data inline, which OVITO reads too.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

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
        _add(of_points, "Normals", shapes.normals, NumberOfComponents="3")
    place = ElementTree.SubElement(piece, "Points")
    in_space = np.column_stack([points, np.zeros((len(points), 3 - points.shape[1]))])
    _add(place, "Points", in_space, NumberOfComponents="3")
    cells = ElementTree.SubElement(piece, kind)
    _add(cells, "connectivity", shapes.corners)
    _add(cells, "offsets", shapes.ends)
    of_cells = ElementTree.SubElement(piece, "CellData")
    for name, array in values.items():
        _add(of_cells, name, array)
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
