"""All of the paper's results in full, as figures and numbers.

python -m deformable.paper_run FOLDER
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from . import paper, paper_figures


def main(folder: Path) -> None:
    """Run everything; figures and `paper.json` go to the folder, which is made if missing."""
    folder.mkdir(parents=True, exist_ok=True)
    shapes, sweep, numbers = paper.shapes(), paper.stiffness_sweep(), paper.number_sweep()
    limits = [paper.limit(sides) for sides in (3, 4, 6)]
    packing = paper.packing()
    for name, figure in {
        "shapes_stick": paper_figures.shapes(shapes, stick=True),
        "shapes_slip": paper_figures.shapes(shapes, stick=False),
        "deviation": paper_figures.deviation(sweep),
        "error_by_indentation": paper_figures.error_by_indentation(sweep),
        "error_by_number": paper_figures.error_by_number(numbers),
        "limit": paper_figures.limits(limits),
        "packing": paper_figures.packing(packing),
    }.items():
        figure.savefig(folder / f"{name}.png")
    results = {
        "single": [paper.single_row(each) for each in (*shapes, *sweep, *numbers)],
        "steiner": [_steiner_row(each) for each in shapes if not each.walls.stick],
        "limit": [_limit_row(each) for each in limits],
        "packing": [
            {
                "model": each.state.model.law,
                "I": float(each.shape_error.mean()),
                "S_rms": each.area_deficit_error,
                "energy_ratio": each.energy_ratio,
                "pressure_ratio": each.pressure_ratio,
            }
            for each in packing
        ],
    }
    (folder / "paper.json").write_text(json.dumps(results, indent=1) + "\n")


def _steiner_row(result: paper.Squeezed) -> dict[str, Any]:
    """I of the ring law about the Steiner point, beside what tells the measurement."""
    row = paper.single_row(result)
    kept = {key: row[key] for key in ("polygon", "sides", "beads", "kL", "a_over_R")}
    return {**kept, "I_ring": paper.steiner_error(result)}


def _limit_row(limit: paper.Limit) -> dict[str, Any]:
    return {
        "sides": limit.sides,
        "a_over_R": limit.indentation,
        "beads": limit.numbers.tolist(),
        "error_beads": limit.number_error.tolist(),
        "rate_beads": limit.number_rate,
        "kP": limit.stiffness.tolist(),
        "error_kP": limit.stiffness_error.tolist(),
        "rate_kP": limit.stiffness_rate,
    }


if __name__ == "__main__":
    main(Path(sys.argv[1]))
