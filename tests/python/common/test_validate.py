"""Objects of a wrong kind, where they come in: one line that says what is wanted."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import deformable
import numpy as np
import pytest
from deformable import Ring

P = deformable.bidisperse(4, seed=1)

# A call, the argument that is wrong, and its value as the message shows it.
CASES: list[tuple[Callable[[], Any], str, str]] = [
    (lambda: deformable.Simulation(P, "ring"), "law", "'ring'"),
    (lambda: deformable.Simulation(P, Ring), "law", "call it, Ring(...)"),
    (lambda: deformable.Simulation("base", Ring()), "packing", "'base'"),
    (lambda: deformable.Disks(3), "packing", "3"),
    (lambda: deformable.jam("x"), "packing", "'x'"),
    (lambda: deformable.jam(P, "ring"), "law", "'ring'"),
    (lambda: deformable.push_off("x"), "packing", "'x'"),
    (lambda: deformable.compress(P, 0.01, 1), "sim", "a Packing"),
    (lambda: deformable.shear(P, 0.01, 1), "sim", "a Packing"),
    (lambda: deformable.move(P, 1), "sim", "a Packing"),
    (lambda: deformable.shear_modulus(P, 0.01), "state", "a Packing"),
    (lambda: deformable.bulk_modulus(P, 0.01), "state", "a Packing"),
    (lambda: deformable.load(3), "folder", "3"),
    (lambda: deformable.bidisperse("16"), "number", "'16'"),
    (lambda: Ring(kA="1"), "kA", "'1'"),
    (lambda: Ring(kA=[1, -1]), "kA", "-1"),
    (lambda: Ring(contact=2), "contact", "2"),
    (lambda: P.at(np.float64(-0.5)), "phi", "-0.5"),
]


@pytest.mark.parametrize(("call", "name", "value"), CASES)
def test_one_line_names_argument_and_value(call: Callable[[], Any], name: str, value: str) -> None:
    with pytest.raises(deformable.ParameterError) as caught:
        call()
    line = str(caught.value)
    assert line.startswith(f"{name} must be ")
    assert line.endswith(value)
    assert "\n" not in line


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
