"""Objects of a wrong kind, where they come in: one line that says what is wanted."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import deformable
import numpy as np
import pytest
from deformable import Ring

P = deformable.bidisperse(4, seed=1)

CASES: dict[str, tuple[Callable[[], Any], str]] = {
    "name of a law": (
        lambda: deformable.Simulation(P, "ring"),
        "model must be of the kind Ring or Sector, not 'ring'",
    ),
    "class of a law": (
        lambda: deformable.Simulation(P, Ring),
        "model must be of the kind Ring or Sector, not the class Ring itself: call it, Ring(...)",
    ),
    "name of a packing": (
        lambda: deformable.Simulation("base", Ring()),
        "packing must be of the kind Packing, not 'base'",
    ),
    "disks": (lambda: deformable.Disks(3), "packing must be of the kind Packing, not 3"),
    "jam": (lambda: deformable.jam("x"), "packing must be of the kind Packing, not 'x'"),
    "jam a law": (
        lambda: deformable.jam(P, "ring"),
        "model must be of the kind Ring or Sector, not 'ring'",
    ),
    "push_off": (lambda: deformable.push_off("x"), "packing must be of the kind Packing, not 'x'"),
    "compress": (
        lambda: deformable.compress(P, 0.01, 1),
        "sim must be of the kind Simulation or Disks or BeadReference, not a Packing",
    ),
    "shear": (
        lambda: deformable.shear(P, 0.01, 1),
        "sim must be of the kind Simulation or Disks, not a Packing",
    ),
    "move": (
        lambda: deformable.move(P, 1),
        "sim must be of the kind Simulation, not a Packing",
    ),
    "shear_modulus": (
        lambda: deformable.shear_modulus(P, 0.01),
        "state must be of the kind State or DiskState, not a Packing",
    ),
    "bulk_modulus": (
        lambda: deformable.bulk_modulus(P, 0.01),
        "state must be of the kind State or DiskState, not a Packing",
    ),
    "load": (lambda: deformable.load(3), "folder must be of the kind str or Path, not 3"),
    "number in quotes": (
        lambda: deformable.bidisperse("16"),
        "number must be a whole number, not '16'",
    ),
    "stiffness in quotes": (
        lambda: Ring(kA="1"),
        "kA must be a number, or one number a species, not '1'",
    ),
    "one stiffness": (lambda: Ring(kA=-1), "kA must be positive, not -1.0"),
    "two stiffnesses": (lambda: Ring(kA=[1, -1]), "kA must be positive, not [1.0, -1.0]"),
    "skin": (lambda: Ring(skin=-0.1), "skin must not be negative, not -0.1"),
    "contact": (lambda: Ring(contact=2), "contact must be radical or balanced, not 2"),
    "scalar of numpy": (
        lambda: P.at(np.float64(-0.5)),
        "phi must be a positive number, not -0.5",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_one_line_says_what_is_wanted(case: str) -> None:
    call, message = CASES[case]
    with pytest.raises(deformable.ParameterError) as caught:
        call()
    assert str(caught.value) == message


def test_shear_strain_in_quotes() -> None:
    with (
        deformable.Disks(P) as sim,
        pytest.raises(deformable.ParameterError, match="strain must be a finite number, not 'a'"),
    ):
        deformable.shear(sim, "a", 2)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "kind", [lambda: deformable.Simulation(P, Ring()), lambda: deformable.Disks(P)]
)
def test_a_closed_simulation_says_so(kind: Callable[[], Any], tmp_path: Path) -> None:
    sim = kind()
    calls: list[Callable[[], Any]] = [
        sim.relax,
        sim.state,
        lambda: sim.box,
        lambda: sim.lmp,
        lambda: sim.deform(P.box),
        lambda: deformable.compress(sim, 0.01, 1),
        lambda: next(deformable.shear(sim, 0.01, 1)),
    ]
    if isinstance(sim, deformable.Simulation):
        calls += [lambda: deformable.move(sim, 1, temperature=1.0), lambda: sim.restart(P)]
        calls += [lambda: deformable.compress_in(tmp_path, sim, 0.01, 1)]
    assert not sim.closed
    sim.close()
    sim.close()  # which changes nothing
    assert sim.closed
    for call in calls:
        with pytest.raises(deformable.ParameterError, match=f"this {type(sim).__name__} is closed"):
            call()
