"""A folder with the errors and run times of contact laws and polygons for one packing."""

from __future__ import annotations

import csv
import importlib.util
import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..common.errors import FileError
from ..common.versions import machine, versions
from ..formats.store import refuse
from ..particles.packing import Packing
from .comparison import COLUMNS, Comparison, compare

# Results of methods that are complete, until the report is.
PARTS = "parts"


def write_report(
    folder: str | Path,
    start: Packing,
    *,
    overwrite: bool = False,
    parameters: Mapping[str, Any] | None = None,
    **settings: Any,
) -> Comparison:
    """Compare methods for a packing, and write report.json, report.csv and a picture.

    Methods that are complete are kept in the folder `parts` until all are: the same call goes on
    after an interruption.

    Args:
        folder: made if missing.
        start: a packing at the onset of jamming.
        overwrite: replace the report in the folder.
        parameters: stored in report.json, such as where the packing is from.
        settings: of `compare`.

    Raises:
        FileError: the folder holds something else than a report, or a complete one and `overwrite`
            is not given.
        ParameterError: see `compare`.
    """
    folder = refuse(folder, but="report")
    if (folder / "report.json").exists() and not overwrite:
        raise FileError(
            f"'{folder}' holds a report: replace it with --overwrite, or name another folder"
        )
    found = compare(start, keep=folder / PARTS, **settings)
    content = {
        "rows": found.rows,
        "steps": found.steps,
        "parameters": dict(parameters or {}),
        "machine": machine(),
        "versions": versions(),
    }
    (folder / "report.json").write_text(json.dumps(content, indent=1, allow_nan=False) + "\n")
    with (folder / "report.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(found.rows)
    if importlib.util.find_spec("matplotlib"):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(10.0, 4.6), layout="constrained")
        for ax, quantity in zip(figure.subplots(1, 2), ("energy_error", "area_error"), strict=True):
            found.plot(ax, quantity)
        figure.savefig(folder / "error_against_time.png", dpi=150)
    shutil.rmtree(folder / PARTS)
    return found
