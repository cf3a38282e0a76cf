"""Packings of droplets, bubbles and rings side by side."""

import numpy as np
from scene import Scene

# kA, kP, skin and tension of the species file
STIFFNESS = {
    "drop": (np.inf, 0.0, 0.0, 0.02),
    "droplarge": (np.inf, 0.0, 0.0, 0.03),
    "firm": (np.inf, 0.3, 0.0, 0.01),
    "bubble": (1.0, 0.0, 0.0, 0.05),
    "full": (0.7, 0.2, 0.05, 0.02),
    "strong": (2.0, 0.1, 0.03, 0.04),
    "small": (1.0, np.inf, 0.0, 0.0),
    "large": (1.0, np.inf, 0.0, 0.0),
    "both": (1.0, 1.0, 0.0, 0.0),
    "skinned": (2.0, 0.3, 0.05, 0.0),
}
OF_RADIUS = {
    0.5: ("drop", "small", "firm", "strong", "both"),
    0.7: ("droplarge", "bubble", "large", "full", "skinned"),
}
RADICAL = "deformable/ring contact radical"
BALANCED = "deformable/ring contact balanced"
TILTED = "deformable/ring contact tilted"


def droplets(case, style, **options):
    """Of two sizes; pressures at rest 0.04 and 0.043."""
    return Scene.packing(case, style, ("drop", "droplarge"), **options)


def tense_mixture(case, style, **options):
    """A packing with all species of the sizes of its particles in turn; and species and radii."""
    radius = np.array([0.5, 0.7])[np.array(case["type"]) - 1]
    species = [OF_RADIUS[r][i // 2 % 5] for i, r in enumerate(radius)]
    box = (0, case["L"], 0, case["L"])
    return Scene(case["x"], species, box, style, **options), species, radius
