"""Forces of given places have the committed bits on every processor, AArch64 too.

Places are sums and products of few digits, so that no library has a part in them: packages that
relax or jam, such as SciPy, may fuse products and sums where a processor can.
"""

import hashlib
import math

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.engine.lammps import gather

EMULSION = {"kA": math.inf, "kP": 0.0, "tension": (1.0, 1.25)}
SCENES: dict[str, tuple[object, int, dict[str, object]]] = {
    "sector": (ld.Sector(kA=1.0), 2, {}),
    "radical": (ld.Ring(kA=(1.0, 2.0), contact="radical"), 2, {}),
    "balanced": (ld.Ring(kA=(1.0, 2.0)), 2, {}),
    "soft": (ld.Ring(kA=1.0, kP=0.25, skin=0.03125), 2, {}),
    "curved": (ld.Ring(**EMULSION, contact="curved"), 2, {}),
    "sticking": (ld.Ring(**EMULSION, contact="curved", adhesion=0.125), 2, {}),
    "friction": (ld.Ring(kA=1.0), 2, {"friction": ld.Friction(0.5, kt=0.03125)}),
    "droplets": (ld.Droplet(tension=(1.0, 1.25)), 3, {}),
    "sticking droplets": (ld.Droplet(tension=1.0, adhesion=0.125), 3, {}),
}
BITS = {
    "sector": "b374314af56d",
    "radical": "60427272a531",
    "balanced": "6bf8a5f0188e",
    "soft": "bd21fb6d580f",
    "curved": "54f2f64aa612",
    "sticking": "14ac35ab6439",
    "friction": "09d8653ad7ca",
    "droplets": "651de3929148",
    "sticking droplets": "e02532e269c9",
}


def lattice(dimension: int) -> ld.Packing:
    """A crystal of 36 or 27 particles of two sizes that have moved a little."""
    side = 6 if dimension == 2 else 3
    place = np.stack(np.meshgrid(*[np.arange(side)] * dimension, indexing="ij"), axis=-1)
    number = np.arange(dimension * side**dimension, dtype=float).reshape(-1, dimension)
    moved = 0.125 * np.remainder(0.625 * number * number + 0.375 * number, 1.0)
    x = 1.875 * place.reshape(-1, dimension) + moved
    species = np.arange(len(x)) % 2
    box = 1.875 * side * np.eye(dimension)
    return ld.Packing(x, np.array([1.0, 1.0625])[species], box, species=species)


def digest(name: str) -> str:
    """Of forces, energy and contact forces."""
    law, dimension, more = SCENES[name]
    with ld.Simulation(lattice(dimension), law, **more) as sim:
        state = sim.state()
        found = [gather(sim.lmp, "f", 3), state.energy, np.sort(state.contacts["force"])]
    assert np.abs(found[0]).max() > 0.0
    total = hashlib.sha256()
    for values in found:
        total.update(np.ascontiguousarray(values, dtype=np.float64).tobytes())
    return total.hexdigest()[:12]


@pytest.mark.parametrize("name", SCENES)
def test_forces_have_the_committed_bits(name: str) -> None:
    assert digest(name) == BITS[name]
