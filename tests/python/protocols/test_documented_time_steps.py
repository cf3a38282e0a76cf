"""Time steps of docs/units.md: accurate ones keep the energy, those beyond the limit do not."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest

PAGE = Path(__file__).parents[3] / "docs" / "units.md"
ROW = re.compile(
    r"^\| (Ring without|Ring with|Droplet).*? \| ([\d.]+) sqrt.*? \| ([\d.]+) sqrt", re.M
)
STEPS = {name: (float(fine), float(limit)) for name, fine, limit in ROW.findall(PAGE.read_text())}
LAWS: dict[str, tuple[ld.Ring | ld.Droplet, float]] = {
    "Ring without": (ld.Ring(kA=1.0), 0.9),
    "Ring with": (ld.Ring(kA=np.inf, kP=0.0, tension=1.0), 0.9),
    "Droplet": (ld.Droplet(tension=1.0), 0.75),
}
RUN = """
velocity all create 1e-8 4711 loop all
fix go all nve
thermo_style custom step pe ke etotal
thermo_modify norm no
timestep {}
run 0 post no
"""


@contextmanager
def packing(name: str) -> Iterator[tuple[ld.Simulation, ld.State]]:
    law, phi = LAWS[name]
    dimension = 3 if name == "Droplet" else 2
    start = ld.bidisperse(48, sizes=(1.0, 1.2), dimension=dimension, seed=1)
    with ld.Simulation(ld.jam(start), law) as sim:
        yield sim, sim.compress(phi=phi, steps=3)[-1]


def gained(name: str, step: float) -> float:
    """Energy that a packing gains in a run, over its kinetic energy; inf if the run is stopped."""
    dimension = 3 if name == "Droplet" else 2
    with packing(name) as (sim, state):
        unit = 1.0 if dimension == 3 else state.pressures.max() ** -0.5
        sim.lmp.commands_string(RUN.format(step * unit))
        before, kinetic = (sim.lmp.get_thermo(name) for name in ("etotal", "ke"))
        try:
            sim.lmp.command("run 1500 post no")
        except Exception:
            return np.inf
        return abs(sim.lmp.get_thermo("etotal") - before) / kinetic


@pytest.mark.parametrize("name", LAWS)
def test_time_steps(name: str) -> None:
    accurate, limit = STEPS[name]
    assert gained(name, accurate) < 0.02
    assert gained(name, 0.8 * limit) < 1.0
    assert gained(name, 1.3 * limit) > 1e3


OVERDAMPED = """
thermo_style custom step pe
thermo_modify norm no
displace_atoms all random 1e-4 1e-4 {} 4711
fix go all brownian 1.0 4711 gamma_t 1.0 rng none
timestep {}
run 0 post no
"""


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("part", "settles"), [(0.8, True), (1.5, False)])
def test_overdamped_steps(name: str, part: float, settles: bool) -> None:
    """Particles beside their places go back, or farther and farther away."""
    text = " ".join(PAGE.read_text().split())
    found = re.search(r"from about ([\d.]+) g/p in the plane and ([\d.]+) g/γ in space", text)
    assert found is not None
    in_space = name == "Droplet"
    step = part * float(found[2 if in_space else 1])
    with packing(name) as (sim, state):
        unit = 1.0 if in_space else 1.0 / float(state.pressures.max())
        sim.lmp.commands_string(OVERDAMPED.format(1e-4 if in_space else 0, step * unit))
        begin = sim.lmp.get_thermo("pe") - state.energy
        try:
            sim.lmp.command("run 400 post no")
        except Exception:
            assert not settles
        else:
            end = sim.lmp.get_thermo("pe") - state.energy
            assert end < 1e-3 * begin if settles else end > 10 * begin
