"""Packings of many kinds of particles. A new kind is a line of STIFFNESS and one of MATERIALS."""

import numpy as np
from laws import RADICAL
from scene import Scene

# kA, kP, skin and tension of the species file
STIFFNESS = {
    "small": (1.0, np.inf, 0.0, 0.0),
    "large": (1.0, np.inf, 0.0, 0.0),
    "soft": (0.3, np.inf, 0.0, 0.0),
    "both": (1.0, 1.0, 0.0, 0.0),
    "bothlarge": (1.0, 0.1, 0.0, 0.0),
    "fixed": (np.inf, 1.0, 0.0, 0.0),
    "fixedlarge": (np.inf, 2.0, 0.0, 0.0),
    "skinned": (2.0, 0.3, 0.05, 0.0),
    "thick": (1.0, np.inf, 0.1, 0.0),
    "drop": (np.inf, 0.0, 0.0, 0.02),
    "droplarge": (np.inf, 0.0, 0.0, 0.03),
    "firm": (np.inf, 0.3, 0.0, 0.01),
    "bubble": (1.0, 0.0, 0.0, 0.05),
    "full": (0.7, 0.2, 0.05, 0.02),
    "strong": (2.0, 0.1, 0.03, 0.04),
}
# species of the small and of the large particles, which these take in turn
MATERIALS = {
    "perimeter conserved": ("small", "large"),
    "two stiffnesses": ("small", "soft"),
    "area conserved": ("fixed", "fixedlarge"),
    "one of each": ("fixed", "large"),
    "finite stiffness": ("both", "bothlarge"),
    "some of finite stiffness": ("both", "large"),
    "a skin beside kP = inf": ("small", "skinned"),
    "rings": ("small both fixed thick", "skinned fixedlarge large bothlarge"),
    "droplets": ("drop", "droplarge"),
    "all species": ("drop small firm strong both", "droplarge bubble large full skinned"),
    "radii of atoms": ("any", "any"),
    "soft radii of atoms": ("anysoft", "anysoft"),
}
KINDS = "rings", "droplets", "all species"


def radii_of(case):
    """Radius of each particle of one of PACKINGS."""
    return np.array([0.5, 0.7])[np.array(case["type"]) - 1]


def spread(case):
    """A continuous distribution about it."""
    return radii_of(case) * np.random.default_rng(2).lognormal(0.0, 0.01, case["N"])


def species_of(case, material="rings"):
    """Species of each particle of one of PACKINGS."""
    of_type = [words.split() for words in MATERIALS[material]]
    return [of_type[t - 1][i // 2 % len(of_type[t - 1])] for i, t in enumerate(case["type"])]


def packing(case, style=RADICAL, material="rings", **options):
    """One of PACKINGS, of a material."""
    if material.endswith("radii of atoms"):
        style, options = f"{style} radius atom", {"radii": spread(case)} | options
    box = (0, case["L"], 0, case["L"])
    return Scene(case["x"], species_of(case, material), box, style, **options)


def pushed(case):
    """Particles pushed off their places by up to a per cent of their size."""
    push = np.random.default_rng(1).uniform(-0.005, 0.005, (case["N"], 2))
    return np.array(case["x"]) + push
