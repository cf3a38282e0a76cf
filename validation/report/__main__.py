"""Write a report: index.html, its pictures and report.json."""

from __future__ import annotations

import argparse
import importlib.util
import json
import shutil
import time
from typing import TYPE_CHECKING, Any

from lammps_deformable._files import make_folder
from lammps_deformable.errors import FileError, ParameterError
from lammps_deformable.progress import print_once
from lammps_deformable.store import holds, refuse
from lammps_deformable.versions import machine, versions

from validation.report.page import page
from validation.report.plan import FULL, QUICK
from validation.report.results import measure

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

# Folders of the results of a report that is not complete, within the folder of the report.
_FULL_PARTS, _QUICK_PARTS = "parts", "quick_parts"


def write_report(
    folder: str | Path,
    quick: bool = False,
    resume: bool = False,
    overwrite: bool = False,
    print_once: Callable[[str], None] = lambda line: None,
) -> dict[str, Any]:
    """Measure everything, and write index.html, its pictures and report.json.

    Results of single calls are kept in `parts` or `quick_parts` of the folder until the report is
    complete.

    Args:
        folder: made if missing.
        quick: smaller and coarser, in minutes.
        resume: finish the interrupted report in the folder, whether quick or not.
        overwrite: replace the report in the folder, at the end, and drop the parts of another one.
        print_once: called with a line after each part.

    Returns:
        The content of report.json: lists of rows `smooth`, `pareto`, `friction`, `hysteresis`,
        `crystal`, `packing`, `stiffness_packing`, `single`, `limit`, `ablation`, `stability`, and
        `machine`, `versions`, `quick`.

    Raises:
        ParameterError: matplotlib is missing, there is nothing to resume, or quick is asked for
            where a full report was interrupted.
        FileError: the folder holds something else than a report; or it holds one, and neither
            `resume` nor `overwrite` is given.
    """
    if not importlib.util.find_spec("matplotlib"):
        raise ParameterError("a report needs pictures: pip install lammps-deformable[plot]")
    folder, quick = _check(folder, quick, resume, overwrite)
    full_parts, quick_parts = folder / _FULL_PARTS, folder / _QUICK_PARTS
    if overwrite:
        _discard(full_parts)
        _discard(quick_parts)
    parts = make_folder(quick_parts if quick else full_parts)  # or fail before the work
    results = measure(QUICK if quick else FULL, parts, print_once)
    content = results.rows() | {"machine": machine(), "versions": versions(), "quick": quick}

    from validation.report.sections import pictures, sections  # needs matplotlib

    for name, figure in pictures(results).items():
        figure.savefig(folder / name, dpi=150)
    title = "Contact laws against smooth polygons"
    (folder / "index.html").write_text(page(title, _lead(content), sections(results)))
    (folder / "report.json").write_text(json.dumps(content, indent=1, allow_nan=False) + "\n")
    _discard(parts)
    return content


def _check(folder: str | Path, quick: bool, resume: bool, overwrite: bool) -> tuple[Path, bool]:
    """The folder, if it allows what is asked for, and whether the report is a quick one."""
    if resume and overwrite:
        raise ParameterError("give one of --resume and --overwrite")
    folder = refuse(folder, but="report")
    begun = [name for name in (_FULL_PARTS, _QUICK_PARTS) if any(folder.glob(f"{name}/*/joblib"))]
    if resume:
        if not begun:
            raise ParameterError(f"nothing to resume: '{folder}' holds no parts of a report")
        if quick and _QUICK_PARTS not in begun:
            raise ParameterError(
                f"'{folder}' holds parts of a full report: finish it without --quick, or replace "
                "it with --overwrite"
            )
        return folder, _QUICK_PARTS in begun
    if begun and not overwrite:
        raise FileError(
            f"'{folder}' holds parts of an interrupted report: finish it with --resume, replace it "
            "with --overwrite, or name another folder"
        )
    if holds(folder) and not overwrite:
        raise FileError(
            f"'{folder}' holds a report: replace it with --overwrite, or name another folder"
        )
    return folder, quick


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
    for part in parts.glob("*/joblib"):
        shutil.rmtree(part.parent)
    if parts.is_dir() and not any(parts.iterdir()):
        parts.rmdir()


def main() -> None:
    parser = argparse.ArgumentParser("validation.report", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="measure less, in a few minutes")
    parser.add_argument("--out", default="report", help="folder")
    parser.add_argument("--resume", action="store_true", help="finish an interrupted report")
    parser.add_argument("--overwrite", action="store_true", help="replace the report in the folder")
    options = parser.parse_args()
    began = time.perf_counter()
    write_report(options.out, options.quick, options.resume, options.overwrite, print_once)
    print_once(f"wrote {options.out} ({time.perf_counter() - began:.0f} s)")


if __name__ == "__main__":
    main()
