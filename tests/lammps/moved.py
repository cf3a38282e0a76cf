"""Many rings with balanced contacts that have moved, on one or more ranks."""

import numpy as np
from laws import BALANCED
from parallel import finished
from scene import HEADER, PACKINGS, SPECIES, Scene

SCRIPT = (
    HEADER.format(boundary="p p p")
    + f"""
processors {{grid}}
read_data {{data}}
replicate {{copies}} {{copies}} 1
pair_style {BALANCED} balance {{tolerance}} 100
pair_coeff * * {SPECIES} small large
neighbor 0.3 bin
group movers id {{movers}}
velocity movers create {{temperature}} 4711 loop geom
fix move movers nve
timestep 0.05
compute contact all deformable/contact
compute largest all reduce max c_contact[5] inputs local
compute pair all pair deformable/ring
thermo_style custom step c_pair[3] c_largest
thermo_modify norm no format float %.17g
thermo 1
run {{steps}}
write_dump all custom moved.atoms id fx fy modify sort id format float %.17g
pair_style {BALANCED} balance 1e-12 100
pair_coeff * * {SPECIES} small large
run 0
write_dump all custom exact.atoms id fx fy modify sort id format float %.17g
"""
)


class Moved:
    """Copies of a packing of which some rings, by their numbers, have moved.

    Attributes:
        evaluations: of each step.
        error: of the forces against those of the same places from scratch, over the largest force
            of a contact.
    """

    def __init__(self, ranks, folder, **fields):
        Scene.packing(PACKINGS[0], BALANCED).run(f"write_data {folder}/data nofix")
        said = finished(ranks, SCRIPT.format(data=folder / "data", **fields), folder)
        report = [line.split() for line in said.splitlines()]
        steps = np.array([row for row in report if len(row) == 3 and row[0].isdigit()], float)
        self.evaluations = steps[:-1, 1]
        moved, exact = (
            np.loadtxt(folder / f"{name}.atoms", skiprows=9)[:, 1:] for name in ("moved", "exact")
        )
        self.error = np.abs(moved - exact).max() / steps[-1, 2]
