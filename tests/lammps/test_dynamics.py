"""Energy along trajectories: conserved by ring laws, with known jumps in the sector law."""

import sys
from pathlib import Path

import lammps_deformable as ld
import numpy as np
import pytest
from laws import LAWS
from scene import PACKINGS, Scene, box_walls

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import conservation
import nve
import sector_stall


@pytest.fixture(scope="module")
def jammed():
    return {n: ld.jam(ld.bidisperse(n, seed=1)).packing for n in (16, 64)}


def test_energy_error_falls_with_the_square_of_the_time_step(jammed):
    row = nve.measure(jammed[16], 0.9, time=100.0)
    # five points of a chaotic trajectory scatter about 2
    assert 1.7 < row["order"] < 2.3
    assert row["energy_error"][-1] < 1e-5 * row["kinetic_energy"]


@pytest.mark.slow
@pytest.mark.parametrize("phi", [0.80, 0.88, 0.92])
def test_energy_of_a_large_packing(jammed, phi):
    """The rows of benchmarks/results/nve.json."""
    row = nve.measure(jammed[64], phi)
    assert 1.7 < row["order"] < 2.3
    # what kinks add at random grows by a factor 4, a drift would by 16
    assert nve.growth(jammed[64], row) < 0.5 * nve.LONGER


@pytest.mark.slow
def test_balanced_contacts_do_not_heat(jammed):
    """As in benchmarks/results/conservation.json. Quadratic predictions made it 8e-5."""
    packing = jammed[64].at(0.9)
    runs = [conservation.error_and_drift(packing, 1e-8, 0.05, 10**6, seed) for seed in range(1, 5)]
    assert abs(np.mean([drift for _, drift in runs])) < 3e-5


def between_walls(law, top):
    """Energy of a particle of radius 1 between walls at -0.97, 0.97 and, above it, at `top`."""
    faces = {"left": (-0.97, 0), "right": (0.97, 0), "top": (0, top)}
    walls = "\n".join(
        f"region {name} plane {px:.17g} {py:.17g} 0 {-px:.17g} {-py:.17g} 0\n"
        f"fix {name} all deformable/wall {name}"
        for name, (px, py) in faces.items()
    )
    options = {"boundary": "f f p", "commands": walls}
    return Scene(np.zeros((1, 2)), ["unit"], (-2, 2, -2, 2), LAWS[law], **options).energy()


def test_jump_of_the_sector_law():
    """A third contact at no indentation cuts off what bulged between two walls, at once.

    Between the walls S = pi a^2. The third contact halves one sector of pi: each half has an
    alpha = 1/(2 - pi/2) and no indentation at its other end, so S = pi a^2/2 + alpha a^2.
    """
    a, apart = 0.03, 1e-15
    before, after = (between_walls("sector", 1 + s * apart) for s in (1, -1))
    assert before == pytest.approx((np.pi * a**2) ** 2 / 2, rel=1e-12)
    assert after == pytest.approx((np.pi / 2 * a**2 + a**2 / (2 - np.pi / 2)) ** 2 / 2, rel=1e-12)
    assert after / before == pytest.approx(1.54, abs=5e-3)  # as the manual page says

    # the ring bulges, so the third wall is active before; S is linear in so small a step
    before, after = (between_walls("radical", 1 + s * apart) for s in (1, -1))
    assert after == pytest.approx(before, rel=1e-12)


@pytest.mark.parametrize(("law", "stalls"), [("sector", True), ("radical", False)])
def test_fire_stalls_with_the_sector_law_only(jammed, law, stalls):
    """A row of benchmarks/results/sector_stall.json."""
    row = sector_stall.measure(jammed[64], law, 0.88)
    assert row["stalled"] == stalls
    residual = row["largest_force_over_mean_contact_force"]
    assert residual > 0.1 if stalls else residual <= 1e-6


@pytest.mark.parametrize(
    ("law", "species", "walls"),
    [
        ("sector", "small large", False),
        ("ring contact radical", "small large", True),
        ("ring contact radical", "both skinned", False),
    ],
)
def test_forces_of_a_motion_are_those_of_a_first_call(law, species, walls):
    """Active contacts are remembered as long as a neighbor list lasts; a new list forgets them."""
    case = PACKINGS[0]
    low, high = (-0.45, case["L"] + 0.45) if walls else (0.0, case["L"])
    scene = Scene(
        case["x"],
        [species.split()[t - 1] for t in case["type"]],
        (low, high, low, high),
        f"deformable/{law}",
        boundary="f f p" if walls else "p p p",
        commands=box_walls(low, high, low, high) if walls else "",
    )
    scene.run("neighbor 1.0 bin\nvelocity all create 1e-3 4711 loop all\nfix nve all nve")
    scene.run("timestep 0.05")
    contacts = []
    for _ in range(8):
        scene.run("run 25 post no")
        moved = scene.gather("f", 3)[:, :2]
        first = scene.evaluate()
        assert np.abs(moved - first.force).max() <= 1e-12 * np.abs(first.force).max()
        contacts.append(first.shape["contacts"])
    assert (np.ptp(contacts, axis=0) > 0).mean() > 0.5  # they open and close
