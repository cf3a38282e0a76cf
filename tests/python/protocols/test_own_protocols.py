"""Protocols of users are recorded, resumed and told like ours."""

import json
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import lammps_deformable as ld
import numpy as np
import pytest
from lammps_deformable.protocols.coarsening import Coarsen
from lammps_deformable.protocols.compression import Compress, Grow
from lammps_deformable.protocols.motion import Move
from lammps_deformable.protocols.proliferation import Proliferate
from lammps_deformable.protocols.protocol import KNOWN
from lammps_deformable.protocols.recording import protocol_in
from lammps_deformable.protocols.shearing import Creep, Oscillate, Shear


@dataclass(frozen=True, kw_only=True)
class Tap(ld.Protocol):
    """The box shrinks and relaxes, and grows again."""

    amplitude: float

    def step(self, sim: ld.Simulation, n: int) -> ld.State:
        box = sim.box
        sim.deform(box * (1.0 - self.amplitude))
        sim.relax()
        sim.deform(box)
        return sim.relax()


FirstTap = Tap


@pytest.fixture(scope="module")
def packing() -> ld.Packing:
    return ld.jam(ld.bidisperse(12, seed=5)).packing


def test_it_is_played_and_recorded(packing: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(packing, ld.Ring()) as sim:
        run = sim.play(Tap(amplitude=0.01, steps=3), record=tmp_path / "taps", parameters={"a": 1})
    assert len(run) == 4
    assert run.parameters["protocol"] == "tap"
    assert {"amplitude": 0.01, "steps": 3, "a": 1}.items() <= run.parameters.items()
    assert protocol_in(run.parameters) == Tap(amplitude=0.01, steps=3)


def test_it_is_resumed(packing: ld.Packing, tmp_path: Path) -> None:
    """The files are those of a run in one go, to the last bit."""

    class Killed(Exception):
        pass

    def kill(state: ld.State) -> None:
        seen.append(state)
        if len(seen) == 2:
            raise Killed

    seen: list[ld.State] = []
    for folder, callback in (("whole", None), ("killed", kill)):
        with ld.Simulation(packing, ld.Ring()) as sim, suppress(Killed):
            sim.play(Tap(amplitude=0.02, steps=4), record=tmp_path / folder, callback=callback)
    killed = ld.Run(tmp_path / "killed")
    assert killed.steps_done == 2
    assert len(killed.resume()) == 5
    for name in ("series.csv", "trajectory.lammpstrj", "setups.jsonl", "packing.data"):
        assert (tmp_path / "killed" / name).read_text() == (tmp_path / "whole" / name).read_text()


def test_a_class_that_is_not_there(packing: ld.Packing, tmp_path: Path) -> None:
    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.play(Tap(amplitude=0.02, steps=3), record=tmp_path, callback=lambda _: None)
    summary = json.loads((tmp_path / "summary.json").read_text())
    summary["parameters"] |= {"protocol": "knock"}
    summary["parameters"]["start"]["states"] = 4
    (tmp_path / "summary.json").write_text(json.dumps(summary))
    with pytest.raises(ld.FileError, match=r"^there is no protocol 'knock': import the module"):
        ld.Run(tmp_path).resume()


def test_what_is_no_protocol(packing: ld.Packing, tmp_path: Path) -> None:
    @dataclass(frozen=True, kw_only=True)
    class Lazy(ld.Protocol):
        values: object = None

    with ld.Simulation(packing, ld.Ring()) as sim:
        with pytest.raises(ld.ParameterError, match=r"^protocol must be of the kind Protocol"):
            sim.play("compress")  # type: ignore[arg-type]
        with pytest.raises(NotImplementedError, match=r"Lazy has no method step"):
            sim.play(Lazy())
        with pytest.raises(ld.ParameterError, match=r"the settings of lazy\['values'\] must be"):
            sim.play(Lazy(values=np.cos), record=tmp_path / "none")
        with pytest.raises(ld.ParameterError, match=r"steps must be"):
            Lazy(steps=0)
    assert not (tmp_path / "none").exists()


def test_a_name_of_two_classes(packing: ld.Packing, tmp_path: Path) -> None:
    @dataclass(frozen=True, kw_only=True)
    class Tap(ld.Protocol):
        def step(self, sim: ld.Simulation, n: int) -> ld.State:
            return sim.state()

    with ld.Simulation(packing, ld.Ring()) as sim:
        sim.play(Tap(), record=tmp_path / "one")
        try:
            with pytest.raises(ld.ParameterError, match=r"Tap is a protocol of the name 'tap' too"):
                sim.play(FirstTap(amplitude=0.01), record=tmp_path / "other")
        finally:
            KNOWN["tap"] = FirstTap
        assert not (tmp_path / "other").exists()
        sim.play(FirstTap(amplitude=0.01), record=tmp_path / "other")


def test_steps_by_go(packing: ld.Packing, tmp_path: Path) -> None:
    """They may be any iterator; each is a state."""

    @dataclass(frozen=True, kw_only=True)
    class Still(ld.Protocol):
        result: str = "state"

        def go(
            self, sim: ld.Simulation, start: dict[str, Any], done: int, before: ld.State | None
        ) -> Iterator[ld.State]:
            state = sim.state() if self.result == "state" else None
            return iter([state] * (start["states"] - done))  # type: ignore[list-item]

    with ld.Simulation(packing, ld.Ring()) as sim:
        assert len(sim.play(Still(steps=2))) == 3
        assert len(sim.play(Still(steps=2), record=tmp_path / "still")) == 3
        with pytest.raises(ld.ParameterError, match=r"^the result of a step of still must be"):
            sim.play(Still(result="none"))


def test_a_generator_draws_a_seed_that_is_recorded(packing: ld.Packing, tmp_path: Path) -> None:
    hot: dict[str, Any] = {"temperature": 1e-6, "every": 5}
    with ld.Simulation(packing, ld.Ring()) as sim:
        run = sim.run(5, **hot, seed=np.random.default_rng(3), record=tmp_path / "drawn")
    seed = run.parameters["seed"]
    assert seed == np.random.default_rng(3).integers(1, 2**31)
    with ld.Simulation(packing, ld.Ring()) as sim:
        again = sim.run(5, **hot, seed=seed, record=tmp_path / "given")
    assert np.array_equal(again[-1].velocities, run[-1].velocities)


def test_settings_stand_in_json() -> None:
    every = (
        Compress(phi=0.9, steps=3),
        Grow(factor=1.1),
        Shear(strain=0.1, rate=1e-3, drag=1.0, seed=4),
        Oscillate(amplitude=1e-3, period=float("inf"), cycles=2),
        Creep(shear_stress=1e-3, time=2.0, drag=1.0),
        Coarsen(permeability=1.0, time=2.0),
        Proliferate(rate=[1.0, 2.0], division=2.0, time=1.0, pressure=float("inf")),
        Move(steps=10, every=5, temperature=1e-6, inertia=False, drag=1.0),
    )
    for each in every:
        told = json.loads(json.dumps(asdict(each)))
        assert protocol_in(told | {"protocol": each.name, "start": {}}) == each
        assert {field.name for field in fields(each)} == set(told)


def test_older_parameters_are_read() -> None:
    """They lack settings that were not given, and have others."""
    assert protocol_in({"protocol": "compress", "strain": 0.1, "steps": 2, "tolerance": None}) == (
        Compress(strain=0.1, steps=2)
    )
    old = {"protocol": "run", "steps": 9, "every": 3, "look": 3, "inertia": True, "seed": 1}
    assert protocol_in(old | {"timestep": None, "drag": None}) == Move(steps=9, every=3, seed=1)
    assert protocol_in(old | {"every": 9, "look": None}) == Move(steps=9, seed=1)


@pytest.mark.parametrize(
    ("call", "lacks", "has"),
    [
        (
            lambda sim, **how: sim.compress(strain=0.03, steps=3, **how),
            ("phi", "pressure"),
            {},
        ),
        (
            lambda sim, **how: sim.run(30, every=10, temperature=1e-6, seed=1, **how),
            ("propulsion", "persistence", "alignment", "pressure", "inertial_number", "tolerance"),
            {"look": 10},
        ),
    ],
    ids=["compress", "run"],
)
def test_an_older_folder_is_resumed(
    packing: ld.Packing,
    tmp_path: Path,
    call: Callable[..., ld.Run],
    lacks: tuple[str, ...],
    has: dict[str, Any],
) -> None:
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    for folder, callback in ((whole, None), (killed, lambda _: 1 // 0)):
        with ld.Simulation(packing, ld.Ring()) as sim, suppress(ZeroDivisionError):
            call(sim, record=folder, callback=callback)
    summary = json.loads((killed / "summary.json").read_text())
    told = summary["parameters"]
    for name in lacks:
        assert told.pop(name) is None
    summary["parameters"] = told | has
    (killed / "summary.json").write_text(json.dumps(summary))
    assert ld.Run(killed).steps_done == 1
    assert len(ld.Run(killed).resume()) == 4
    for name in ("series.csv", "trajectory.lammpstrj"):
        assert (killed / name).read_text() == (whole / name).read_text()
