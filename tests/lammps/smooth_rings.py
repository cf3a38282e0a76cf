"""Smooth rings in LAMMPS: the packing of smooth_packing.json, and small scenes."""

import json
from pathlib import Path

import numpy as np
from rings import Rings, regular

DATA = json.loads((Path(__file__).parents[1] / "data" / "smooth_packing.json").read_text())
STATES = {state["state"]: state for state in DATA["states"]}
KR, C = DATA["kr"], DATA["c"]
LONGEST = 0.12  # the longest edge of the three states is 0.113, at rest it is 0.075
HEADER = """
units lj
dimension 2
atom_style bond
newton on
neighbor 0.02 bin
"""
EDGES = f"pair_style deformable/edge {LONGEST}\npair_coeff * * {KR} {C}\n"
ALONE = "bond_style zero\nbond_coeff *\n"  # no springs
SQUARES = (4.0, 4.0)


def springs(exclude=True, pair=EDGES):
    """Contacts and springs of the packing."""
    bonds = [
        f"bond_coeff {kind} {kL / 2!r} {l0!r}"
        for kind, (kL, l0) in enumerate(zip(DATA["kL"], DATA["l0"], strict=True), start=1)
    ]
    intra = "neigh_modify exclude molecule/intra all\n" if exclude else ""
    return "\n".join([intra, pair, "bond_style harmonic", *bonds, ""])


def areas():
    return "".join(
        f"group kind{n} type {n}\nfix area{n} kind{n} deformable/polygon {kA!r} rest {A0!r}\n"
        for n, (kA, A0) in enumerate(zip(DATA["kA"], DATA["A0"], strict=True), start=1)
    )


def packing(state, shift=(0.0, 0.0), **options):
    """A state of the file, shifted, in a box around the origin."""
    box = DATA["box"]
    outlines = [np.array(v) - np.array(box) / 2 + shift for v in STATES[state]["vertices"]]
    types = [kind + 1 for kind in DATA["species"]]
    options = {"header": HEADER, "springs": springs(), "commands": areas()} | options
    return Rings(outlines, box=box, types=types, **options)


# Two rings of unlike types and sizes that touch at one corner of the box
def pair_of_rings(gap=0.04, tilt=0.0, **options):
    first = regular(11, 0.6, (0.4, 0.3))
    second = regular(17, 0.9, (0.4, 0.3)) + (1.5 + gap, 0.1)
    return [first, second]
