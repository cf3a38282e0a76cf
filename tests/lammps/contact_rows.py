"""The rows of compute deformable/contact, and what the solver of contacts says."""

import numpy as np
from lammps import LMP_STYLE_LOCAL, LMP_TYPE_ARRAY

COLUMNS = (
    *("atom", "partner", "indentation", "length", "force", "x", "y"),
    *("angle", "distance", "tilt", "half_angle", "fx", "fy", "contact_angle", "attached"),
)
CONTACTS = "compute contacts all deformable/contact\n"


def contacts(scene):
    scene.energy()
    rows = np.array(scene.lmp.numpy.extract_compute("contacts", LMP_STYLE_LOCAL, LMP_TYPE_ARRAY))
    return dict(zip(COLUMNS, rows.T, strict=True))


def of_compute_pair(scene):
    """Evaluations and imbalance of the last call."""
    return scene.vector("pair", 4)[2:]
