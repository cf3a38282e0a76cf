"""Packings whose contact lines tilt and bend, known from an independent code, in LAMMPS."""

import json
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
from laws import EXACT
from scene import Scene

DATA = Path(__file__).parents[1] / "data" / "curved_cases.json"
CASES = json.loads(DATA.read_text())


def known(case, folder, style=EXACT["curved"], scale=1.0, **options):
    """The scene of a case, all lengths between centers times `scale`; `folder` has its species."""
    rows = list(
        zip(*(case[name] for name in ("radius", "kA", "kP", "skin", "tension")), strict=True)
    )
    kinds = list(dict.fromkeys(rows))
    lines = [
        f"kind{n} {radius} {kA} {kP} {skin}" + f" tension {tension}" * (tension > 0)
        for n, (radius, kA, kP, skin, tension) in enumerate(kinds)
    ]
    if case["adhesion"]:
        pairs = combinations_with_replacement(range(len(kinds)), 2)
        lines += [f"adhesion kind{a} kind{b} {case['adhesion']}" for a, b in pairs]
    (folder / "species").write_text("\n".join(["# UNITS: lj", *lines, ""]))
    names = [f"kind{kinds.index(row)}" for row in rows]
    box = scale * np.array(case["box"])
    x = scale * np.array(case["x"]) % box
    coeff = f"pair_coeff * * {folder / 'species'} {' '.join(dict.fromkeys(names))}"
    return Scene(x, names, (0, box[0], 0, box[1]), style, coeff=coeff, **options)
