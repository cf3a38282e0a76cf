"""Write a report: index.html, its pictures and report.json."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..common.errors import ParameterError
from ..common.files import make_folder
from ..common.ranks import led
from ..common.versions import machine, versions
from ..io.run_folder import refuse
from .page import page
from .plan import FULL, QUICK
from .results import measure


@led
def write_report(
    folder: str | Path,
    quick: bool = False,
    resume: bool = False,
    print_once: Callable[[str], None] = lambda line: None,
) -> dict[str, Any]:
    """Measure everything, and write index.html, its pictures and report.json.

    Results of single calls are kept in `parts` of the folder until the report is complete. Under
    `mpiexec` rank 0 writes, and all ranks measure.

    Args:
        folder: made if missing; a report in it is replaced at the end.
        quick: smaller and coarser, in minutes.
        resume: use the results that an interrupted report has left in the folder.
        print_once: called with a line after each part.

    Returns:
        The content of report.json: lists of rows `smooth`, `pareto`, `friction`, `hysteresis`,
        `crystal`, `packing`, `stiffness_packing`, `single`, `limit`, `ablation`, `stability`, and
        `machine`, `versions`, `quick`.

    Raises:
        ParameterError: matplotlib is missing, or there is nothing to resume.
        FileError: the folder holds something else than a report.
    """
    if not importlib.util.find_spec("matplotlib"):
        raise ParameterError("a report needs pictures: pip install lammps-deformable[plot]")
    folder = refuse(folder, but="report")
    parts = folder / "parts"
    if resume and not any(parts.glob("*.pickle")):
        raise ParameterError(f"nothing to resume: '{folder}' holds no parts of a report")
    if not resume:
        _discard(parts)
    make_folder(parts)  # or fail before the work
    results = measure(QUICK if quick else FULL, parts, print_once)
    content = results.rows() | {"machine": machine(), "versions": versions(), "quick": quick}

    from .sections import pictures, sections  # needs matplotlib

    for name, figure in pictures(results).items():
        figure.savefig(folder / name, dpi=150)
    title = "Contact laws against smooth rings"
    (folder / "index.html").write_text(page(title, _lead(content), sections(results)))
    (folder / "report.json").write_text(json.dumps(content, indent=1, allow_nan=False) + "\n")
    _discard(parts)
    return content


def _lead(content: dict[str, Any]) -> str:
    quick = " --quick" if content["quick"] else ""
    machine_, lammps = content["machine"], content["versions"]["lammps"]
    return (
        f"Written by `deformable report{quick}` on {machine_['cores']} cores "
        f"({machine_['processor']}) with LAMMPS {lammps}. All seconds are seconds of processor "
        "time. The full rows of all tables are in `report.json` beside this page."
    )


def _discard(parts: Path) -> None:
    """Remove the results of calls, and their folder if it is then empty."""
    for part in parts.glob("*.pickle*"):  # also of a killed write
        part.unlink()
    if parts.is_dir() and not any(parts.iterdir()):
        parts.rmdir()
