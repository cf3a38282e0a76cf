"""Outlines and contacts of a packing, with their values: VTK (ParaView, OVITO) and GeoJSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..common.errors import ParameterError
from ..common.files import write_whole
from .vtk_files import Shapes, polydata

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
        raise ParameterError(f"{kinds} {' or '.join(texts)}, not as '{path}'")
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
