"""A protocol that is interrupted and resumed gives the files of a whole one, byte for byte."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from protocol_helpers import Stop, stop_after

FLOW = {"drag": 1.0, "temperature": 1e-6, "seed": 3}

# Through rearrangements, so that other last digits would show, and flips of the box.
PROTOCOLS: dict[str, Callable[..., Any]] = {
    "strain": lambda sim, **how: sim.compress(strain=0.02, steps=3, **how),
    "phi": lambda sim, **how: sim.compress(phi=0.9, steps=3, **how),
    "pressure": lambda sim, **how: sim.compress(pressure=1e-3, steps=3, **how),
    "grow": lambda sim, **how: sim.grow(factor=1.03, steps=3, **how),
    "shear": lambda sim, **how: sim.shear(0.8, steps=5, **how),
    "flow": lambda sim, **how: sim.shear(0.8, steps=3, rate=0.1, **FLOW, **how),
    "cycle": lambda sim, **how: sim.oscillate(0.02, period=math.inf, steps=8, **how),
    "oscillate": lambda sim, **how: sim.oscillate(0.02, period=20.0, steps=8, **FLOW, **how),
    "creep": lambda sim, **how: sim.creep(1e-3, time=30.0, steps=3, **FLOW, **how),
    "coarsen": lambda sim, **how: sim.coarsen(1e5, time=5e-3, steps=3, border=1.0, **how),
    "proliferate": lambda sim, **how: sim.proliferate(
        1.0, division=1.3, time=0.3, steps=3, death=0.3, seed=2, **how
    ),
    "nve": lambda sim, **how: sim.run(700, every=200, temperature=1e-4, seed=2, **how),
    "bath": lambda sim, **how: sim.run(700, every=200, temperature=1e-4, drag=0.1, seed=2, **how),
    "active": lambda sim, **how: sim.run(
        300,
        every=100,
        inertia=False,
        drag=1.0,
        seed=2,
        propulsion=1e-3,
        persistence=10.0,
        alignment=ld.Alignment(velocity=0.1, neighbors=0.1, free=0.1),
        **how,
    ),
    "soft contacts": lambda sim, **how: sim.shear(0.8, steps=5, **how),
    "rest": lambda sim, **how: sim.run(
        4000, every=1000, pressure=1e-3, inertial_number=0.02, seed=2, **how
    ),
}


@pytest.fixture(scope="module")
def start() -> ld.Packing:
    jammed = ld.jam(ld.bidisperse(16, seed=4)).packing
    with ld.Simulation(jammed.at(jammed.phi + 0.03), ld.Ring()) as sim:
        return sim.relax().packing


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.filterwarnings("ignore::lammps_deformable.StalledWarning")
@pytest.mark.filterwarnings("ignore::lammps_deformable.UnjammedWarning")
@pytest.mark.parametrize("name", PROTOCOLS)
def test_the_files_of_a_whole_run(name: str, start: ld.Packing, tmp_path: Path) -> None:
    law = ld.SoftContact(k=2.0) if name == "soft contacts" else ld.Ring()
    whole = PROTOCOLS[name](ld.Simulation(start, law), record=tmp_path / "whole")
    assert len(whole) > 3
    folder = tmp_path / "broken"
    with pytest.raises(Stop):
        PROTOCOLS[name](ld.Simulation(start, law), record=folder, callback=stop_after(2))
    run = ld.Run(folder)
    assert (len(run), run.steps_done) == (3, 2)
    seen: list[ld.State] = []
    assert run.resume(callback=seen.append) is run
    assert (len(run), len(seen)) == (len(whole), len(whole) - 3)
    assert contents(folder) == contents(tmp_path / "whole")
    run.resume(callback=seen.append)
    assert len(seen) == len(whole) - 3


def test_it_is_the_protocol_in_memory(start: ld.Packing, tmp_path: Path) -> None:
    """Up to what rounding does in a step."""
    folder = tmp_path / "run"
    memory = PROTOCOLS["shear"](ld.Simulation(start, ld.Ring()))
    recorded = PROTOCOLS["shear"](ld.Simulation(start, ld.Ring()), record=folder)
    assert len(memory) == len(recorded)
    assert recorded[1].energy == pytest.approx(memory[1].energy, rel=1e-6)
    assert recorded[1].time == memory[1].time
    assert recorded[1].shear_strain == memory[1].shear_strain


def test_a_run_that_was_stopped_is_complete(start: ld.Packing, tmp_path: Path) -> None:
    """By its callback, which no one has when it is resumed."""
    with ld.Simulation(start, ld.Ring()) as sim:
        run = sim.shear(
            0.02, steps=4, record=tmp_path, callback=lambda state: state.shear_strain > 0.008
        )
        assert [state.shear_strain for state in run] == [0.0, 0.005, 0.01]
        assert len(run.resume()) == 3
        assert len(sim.shear(0.02, record=tmp_path, mode="a")) == 2
    assert len(ld.Run(tmp_path)) == 4


def test_commands_of_a_user_stay(start: ld.Packing, tmp_path: Path) -> None:
    """Which a new LAMMPS would lack: their run is not begun anew, and cannot be resumed."""
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.lmp.command("fix down all addforce 1e-4 0 0")
        run = sim.run(200, every=100, timestep=0.1, record=tmp_path)
        assert sim.lmp.has_id("fix", "down")
    assert run[-1].velocities[:, 0].mean() == pytest.approx(1e-4 * 20.0, rel=1e-3)
    with pytest.raises(ld.FileError, match=r"cannot be resumed: .* commands were given to its lmp"):
        run.resume()
    again = ld.Run(tmp_path).simulation()
    assert len(again.run(10, record=tmp_path, mode="a")) == 2


def test_one_lammps_for_all_steps(
    start: ld.Packing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = []
    from lammps_deformable.engine import lammps

    whole = lammps.guarded_lammps()
    monkeypatch.setattr(
        lammps,
        "guarded_lammps",
        lambda: lambda *given: opened.append(1) or whole(*given),
    )
    with ld.Simulation(start, ld.Ring()) as sim:
        sim.compress(strain=0.01, steps=5, record=tmp_path)
        list(ld.Run(tmp_path))
    assert len(opened) == 1


def test_later_calls_draw_other_noise(start: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(start.at(0.4), ld.Ring()) as sim:
        for _ in range(3):
            sim.run(20, drag=1.0, temperature=1e-4, seed=1, record=tmp_path, mode="a")
    first, *others = np.diff(ld.Run(tmp_path).unwrapped(), axis=0)
    for other in others:
        assert not np.allclose(first, other, rtol=0.1)


def test_seeds(start: ld.Packing) -> None:
    with ld.Simulation(start, ld.Ring()) as sim:
        assert sim.seed is None
        run = sim.run(1, temperature=1e-6)
        assert run.parameters["seed"] == sim.seed > 0
        drawn = sim.seed
        sim.run(1, temperature=1e-6, seed=5)
        assert sim.seed == 5
        sim.reset(start)
        again = sim.run(1, temperature=1e-6, seed=drawn)
    assert np.array_equal(again[0].velocities, run[0].velocities)


def test_refusals(start: ld.Packing, tmp_path: Path) -> None:
    place = tmp_path / "run"
    with ld.Simulation(start, ld.Ring()) as sim:
        for values, word in (
            ({"steps": 0}, "steps"),
            ({"tolerance": 0.5}, r"tolerance .* 0\.5"),
            ({"mode": "r"}, "mode must be 'x', 'w' or 'a', not 'r'"),
            ({"callback": 3}, "callback must be a function of a state"),
            ({"keep": 3}, "keep must be"),
            ({"parameters": {"seed": {3}}}, r"parameters\['seed'\]"),
        ):
            with pytest.raises(ld.ParameterError, match=word):
                sim.shear(0.02, **{"record": place} | values)
        assert not place.exists()
        sim.shear(0.02, record=place)
        told = r"holds a run: .*resume\(\), .*mode='a'\), .*shear\(\.\.\., record='.*', mode='w'\)"
        with pytest.raises(ld.FileError, match=told):
            sim.shear(0.02, record=place)
        sim.shear(0.02, record=place, mode="w")
        with pytest.raises(Stop):
            sim.shear(0.02, record=place, mode="w", steps=2, callback=stop_after(1))
        with pytest.raises(ld.FileError, match="interrupted at step 1 of 2: finish it first"):
            sim.shear(0.02, record=place, mode="a")
        assert ld.Run.exists(place)
        assert not ld.Run.exists(tmp_path / "none")
    apart = ld.Packing([[1, 1], [3, 1]], 0.5, (4, 2))
    with (
        ld.Simulation(apart, ld.DeformablePolygon()) as polygons,
        pytest.raises(ld.ParameterError, match="cannot be written yet"),
    ):
        polygons.shear(0.1, record=tmp_path / "polygons")
