"""Packings whose contact lines tilt, known from an independent code, in LAMMPS."""

import json
from pathlib import Path

import numpy as np
from scene import Scene

CASES = json.loads((Path(__file__).parents[1] / "data" / "tilt_cases.json").read_text())["cases"]
DEFAULT = "deformable/ring contact tilted reach 0.3"
EXACT = f"{DEFAULT} balance 1e-12 100"
NAMES = np.array(["one", "two"])


def packing(case, folder, style=EXACT, scale=1.0, **options):
    """The scene of a case, all lengths between centers times `scale`; `folder` has its species."""
    rows = zip(NAMES, *(case[name] for name in ("radii", "kA", "kP", "skin")), strict=True)
    lines = [" ".join(map(str, row)) for row in rows]
    (folder / "species").write_text("\n".join(["# UNITS: lj", *lines, ""]))
    names = NAMES[case["species"]].tolist()
    box = scale * np.array(case["box"])
    x = scale * np.array(case["centres"]) % box
    coeff = f"pair_coeff * * {folder / 'species'} {' '.join(dict.fromkeys(names))}"
    return Scene(x, names, (0, box[0], 0, box[1]), style, coeff=coeff, **options)
