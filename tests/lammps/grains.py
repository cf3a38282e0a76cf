"""Droplets and rings that rub and spin: disks of mass 1, of atom_style sphere."""

from ctypes import c_double

import numpy as np
from laws import EXACT
from scene import Scene

BOX = (-6, 6, -6, 6)
TERMS = "stored", "sliding", "dashpots", "damping", "contacts", "slide"
OUTPUT = """
thermo_style custom step pe ke econserve f_rub f_rub[*]
thermo_modify norm no
compute spin all erotate/sphere
"""
SPECIES = """# UNITS: lj
drop {radius} inf 0 tension 1
ring {radius} 1 inf
"""


class Grains(Scene):
    """Particles with the fix `rub`, whose velocities and spins are given.

    Args:
        x, radii: of the particles.
        friction: mu kt gt and more words of the fix.
        v, spin: velocities (N, 2) and angular velocities (N,).
        law: of laws.EXACT. kind: drop, a droplet of tension 1, or ring; of all, or of each.
        commands: after the fix, before fix nve/sphere.
    """

    def __init__(
        self, x, radii, friction, folder, v=0.0, spin=0.0, *, law="balanced", kind="drop",
        commands="", dt=0.01, move="fix move all nve/sphere disc", **options,
    ):  # fmt: skip
        radii = np.broadcast_to(np.asarray(radii, float), len(x))
        (folder / "species").write_text(SPECIES.format(radius=radii.max()))
        kinds = [kind] * len(x) if isinstance(kind, str) else kind
        options = {"box": BOX, **options}
        super().__init__(
            np.asarray(x, float),
            kinds,
            style=f"{EXACT[law]} radius atom",
            coeff=f"pair_coeff * * {folder / 'species'} {' '.join(dict.fromkeys(kinds))}",
            radii=radii,
            commands=f"fix rub all deformable/friction {friction}\n{commands}\n{move}\n",
            **options,
        )
        self.run(OUTPUT + f"timestep {dt}")
        self.v, self.spin = v, spin

    def scatter(self, name, columns):
        flat = np.ascontiguousarray(columns, float).ravel()
        self.lmp.scatter(name, 1, columns.shape[1], (c_double * len(flat))(*flat))

    @property
    def v(self):
        return self.gather("v", 3)[:, :2]

    @v.setter
    def v(self, v):
        n = self.lmp.get_natoms()
        self.scatter("v", np.column_stack([np.broadcast_to(v, (n, 2)), np.zeros(n)]))

    @property
    def spin(self):
        return self.gather("omega", 3)[:, 2]

    @spin.setter
    def spin(self, spin):
        n = self.lmp.get_natoms()
        self.scatter("omega", np.outer(np.broadcast_to(spin, n), [0, 0, 1]))

    @property
    def inertia(self):
        return 0.5 * self.radii**2

    @property
    def terms(self):
        """The outputs of the fix, by name."""
        values = [self.lmp.extract_fix("rub", 0, 1, k) for k in range(len(TERMS))]
        return dict(zip(TERMS, values, strict=True))

    @property
    def rows(self):
        """Its contacts: two IDs, x, y, normal, force, friction, damping, xi, slides."""
        return self.rows_and_films[:, :10]

    @property
    def rows_and_films(self):
        """And the number of a wall, the force of the film along the contact and across it."""
        pointer = self.lmp.extract_fix("rub", 2, 2)
        count = self.lmp.extract_fix("rub", 2, 4) if pointer else 0
        return np.array([[pointer[r][c] for c in range(13)] for r in range(count)]).reshape(-1, 13)

    def balance(self):
        """Kinetic, potential, stored and lost energy together."""
        rotation = 0.5 * np.sum(self.inertia * self.spin**2)
        return self.lmp.get_thermo("econserve") + rotation

    def angular_momentum(self):
        """About the origin, of motion and spins."""
        x, v = self.x, self.v
        return np.sum(x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) + np.sum(self.inertia * self.spin)
