"""Smooth polygons in LAMMPS: the packing of smooth_packing.json, and a scene of two polygons."""

import json
from pathlib import Path

import numpy as np
from polygons import Polygons, lattice, regular

DATA = json.loads((Path(__file__).parents[1] / "data" / "smooth_packing.json").read_text())
STATES = {state["state"].split(":")[0]: state for state in DATA["states"]}
KR, C = DATA["kr"], DATA["c"]
LONGEST = 0.12  # the longest edge of the three states is 0.113, at rest it is 0.075
HEADER = """
units lj
dimension 2
atom_style bond
newton on
neighbor 0.02 bin
"""
CONTACTS = f"pair_style deformable/edge {LONGEST}\npair_coeff * * {KR} {C}\n"
# LAMMPS' springs and contacts have no factor 1/2
ROUGH = f"pair_style harmonic/cut\npair_coeff * * {KR / 2} {C}\n"
SPRINGS = "bond_style harmonic\n" + "".join(
    f"bond_coeff {kind} {kL / 2!r} {l0!r}\n"
    for kind, (kL, l0) in enumerate(zip(DATA["kL"], DATA["l0"], strict=True), start=1)
)
AREAS = "".join(
    f"group kind{kind} type {kind}\n"
    f"fix area{kind} kind{kind} deformable/polygon {kA!r} rest {A0!r}\n"
    for kind, (kA, A0) in enumerate(zip(DATA["kA"], DATA["A0"], strict=True), start=1)
)
EXCLUDE = "neigh_modify exclude molecule/intra all\n"
NO_SPRINGS = "bond_style zero\nbond_coeff *\n"
PAIR = "compute contacts all pair deformable/edge\n"


def centered(state):
    """Outlines of a state of the file, in a box around the origin."""
    return [np.array(v) - np.array(DATA["box"]) / 2 for v in STATES[state]["vertices"]]


def packing(state, shift=(0.0, 0.0), pair=CONTACTS, **options):
    options = {"header": HEADER, "commands": EXCLUDE + AREAS} | options
    return Polygons(
        [outline + shift for outline in centered(state)],
        box=DATA["box"],
        types=[kind + 1 for kind in DATA["species"]],
        springs=pair + SPRINGS,
        **options,
    )


# Two polygons in contact across a corner of a box of 4 x 4. The second one is clockwise.
BOX, TILT = (4.0, 4.0), 0.9
FIRST = regular(11, 0.6, (1.7, 1.8))
SECOND = regular(17, 0.9, (1.7 + 1.46, 1.8 + 0.47))[::-1]
TWO = "pair_style deformable/edge 0.4\npair_coeff * * 3.0 0.15\n"


def two_polygons(outlines=(FIRST, SECOND), tilt=0.0, pair=TWO, commands="", **options):
    return Polygons(
        outlines,
        box=BOX,
        tilt=tilt,
        header=HEADER,
        springs=pair + NO_SPRINGS,
        commands=(PAIR if "deformable" in pair else "") + commands,
        **options,
    )


def of_contacts(polygons):
    """The energy of the contacts in the last call."""
    return polygons.lmp.extract_compute("contacts", 0, 0)


def expected_energy(outlines, cell, parameters):
    """Sum over vertices a and edges k of other polygons of phi(dist(a, edge)) - phi(|a - v_k|).

    Over all images within one box; parameters(m, n): kr and c of the polygons m and n.
    """

    def phi(d, kr, c):
        return (kr / 2 * np.maximum(c - d, 0) ** 2).sum()

    energy = 0.0
    for m, polygon in enumerate(outlines):
        for n, other in enumerate(outlines):
            if m == n:
                continue
            kr, c = parameters(m, n)
            apart = polygon.mean(0) - other.mean(0)
            nearest = np.round(apart @ np.linalg.inv(cell))
            size = sum(np.hypot(*(v - v.mean(0)).T).max() for v in (polygon, other))
            e = np.roll(other, -1, axis=0) - other
            for image in np.ndindex(3, 3):
                shift = (np.array(image) - 1 - nearest) @ cell
                if np.hypot(*(apart + shift)) > size + c:
                    continue
                p = polygon[:, None] + shift - other
                t = np.clip((p * e).sum(2) / (e * e).sum(1), 0, 1)
                foot = p - t[..., None] * e
                energy += phi(np.hypot(*np.moveaxis(foot, 2, 0)), kr, c)
                energy -= phi(np.hypot(*np.moveaxis(p, 2, 0)), kr, c)
    return energy


def expected_of_two(outlines=(FIRST, SECOND), tilt=0.0, kr=3.0, c=0.15):
    return expected_energy(outlines, lattice(BOX, tilt), lambda *_: (kr, c))
