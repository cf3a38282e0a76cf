"""What states should be: by the kernels, from all pairs, and by differences of the energy."""

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable import core


def shapes(state: ld.State) -> list[core.Shape]:
    """What the kernel makes of each particle."""
    return [
        core.ring(radius, seen["angle"], seen["indentation"])
        for radius, seen in zip(state.packing.radii, state._contacts_of_each, strict=True)
    ]


def brute_force_contacts(state: ld.State) -> dict[tuple[int, int, int, int], bool]:
    """Pairs (i, j, image) in range and whether either side presses, by looking at all images."""
    packing, found = state.packing, {}
    for i in range(len(packing)):
        keys, angle, indentation = [], [], []
        for j in range(len(packing)):
            for a in range(-3, 4):
                for b in range(-3, 4):
                    apart = packing.positions[j] - packing.positions[i] + (a, b) @ packing.box
                    distance = float(np.hypot(*apart))
                    reach = (1.0 + 0.3) * (packing.radii[i] + packing.radii[j])
                    if (i, 0, 0) != (j, a, b) and distance <= reach:
                        keys.append((i, j, a, b))
                        angle.append(np.arctan2(apart[1], apart[0]))
                        indentation.append(
                            core.contact_line(distance, packing.radii[i], packing.radii[j])
                        )
        shape = core.ring(packing.radii[i], np.array(angle), np.array(indentation))
        found.update(zip(keys, shape.contact_length > 0, strict=True))
    return {(i, j, a, b): found[i, j, a, b] or found[j, i, -a, -b] for i, j, a, b in found}


def brute_force_rattlers(contacts: dict[tuple[int, int, int, int], bool], number: int) -> set[int]:
    rattlers: set[int] = set()
    while True:
        z = [
            sum(
                bears and i == n and j not in rattlers and i not in rattlers
                for (i, j, _, _), bears in contacts.items()
            )
            for n in range(number)
        ]
        now = {n for n in range(number) if z[n] < 3}
        if now == rattlers:
            return rattlers
        rattlers = now


def check_pressure(packing: ld.Packing) -> None:
    """The pressure is -dE/d(area of the box)."""
    energy = []
    for factor in (1.0 - 1e-6, 1.0 + 1e-6):
        scaled = packing.replace(positions=packing.positions * factor, box=packing.box * factor)
        with ld.Simulation(scaled, ld.Ring()) as sim:
            energy.append(sim.state().energy)
    with ld.Simulation(packing, ld.Ring()) as sim:
        pressure = sim.state().pressure
    area = np.prod(packing.box.diagonal())
    assert pressure == pytest.approx(-(energy[1] - energy[0]) / (4e-6 * area), rel=1e-6)
