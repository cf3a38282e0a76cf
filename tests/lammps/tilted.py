"""Packings whose contact lines tilt, known from an independent code, in LAMMPS."""

import json
from pathlib import Path

import numpy as np
from laws import EXACT
from scene import Scene

CASES = json.loads((Path(__file__).parents[1] / "data" / "tilt_cases.json").read_text())["cases"]
NAMES = np.array(["one", "two"])


def known(case, folder, style=EXACT["curved"], scale=1.0, **options):
    """The scene of a case, all lengths between centers times `scale`; `folder` has its species."""
    rows = zip(NAMES, *(case[name] for name in ("radii", "kA", "kP", "skin")), strict=True)
    lines = [" ".join(map(str, row)) for row in rows]
    (folder / "species").write_text("\n".join(["# UNITS: lj", *lines, ""]))
    names = NAMES[case["species"]].tolist()
    box = scale * np.array(case["box"])
    x = scale * np.array(case["centres"]) % box
    coeff = f"pair_coeff * * {folder / 'species'} {' '.join(dict.fromkeys(names))}"
    return Scene(x, names, (0, box[0], 0, box[1]), style, coeff=coeff, **options)
