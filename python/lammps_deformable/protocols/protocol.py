"""What a protocol is: settings that are recorded, a start, and a state after each step.

A user's own is a frozen dataclass with a method `step`, see `Protocol`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ..common.checks import count, positive
from ..common.errors import ParameterError

if TYPE_CHECKING:
    from typing_extensions import Self

    from ..engine.simulation import Simulation
    from ..state.state import State

# With a larger one the forces on a particle are far from balanced.
LARGEST_TOLERANCE = 1e-2

# Protocols by the names that runs have of them.
KNOWN: dict[str, type[Protocol]] = {}


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """Steps of a simulation that `Simulation.play` takes, shows, records and resumes.

        @dataclass(frozen=True, kw_only=True)
        class Tap(ld.Protocol):
            amplitude: float

            def step(self, sim, n):
                sim.deform(sim.box * (1.0 - self.amplitude))
                sim.deform(sim.box / (1.0 - self.amplitude))
                return sim.relax()

        run = sim.play(Tap(amplitude=0.01, steps=20), record="taps")

    The fields are the settings: what JSON can hold. A recorded run has them, with the name of the
    class in small letters, among its `parameters`. `Run.resume` makes the protocol from them again
    where the class is defined. A step that is recorded begins anew from the state before: all that
    it needs is in the simulation, the settings and its number.

    Args:
        steps: number of steps, of which each gives a state.

    Attributes:
        name: of the protocol in runs.

    Raises:
        ParameterError: `steps` is no number of steps.
    """

    steps: int = 1

    name: ClassVar[str] = ""

    def __init_subclass__(cls, name: str | None = None) -> None:
        super().__init_subclass__()
        cls.name = cls.__name__.lower() if name is None else name
        if cls.name:
            KNOWN[cls.name] = cls

    def __post_init__(self) -> None:
        count("steps", self.steps)

    def check(self, sim: Simulation, recorded: bool) -> Self:
        """The protocol for a simulation, with defaults that depend on it; nothing is changed yet.

        Args:
            sim: that will take the steps.
            recorded: whether they are written.

        Raises:
            ParameterError: a setting is out of range, or the simulation cannot do it.
        """
        return self

    def begin(self, sim: Simulation) -> tuple[State, dict[str, Any]]:
        """The state before the first step, and what steps must know of the start.

        The latter is what JSON can hold; `states` is the number of states to come at most, `steps`
        if not given.
        """
        return sim.state(), {}

    def step(self, sim: Simulation, n: int) -> State:
        """Take a step.

        Args:
            sim: in the state before; it ends in the state after the step.
            n: its number, from 1.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method step(self, sim, n)")

    def go(
        self, sim: Simulation, start: dict[str, Any], done: int, before: State | None
    ) -> Iterator[State]:
        """The states after the steps that remain.

        Args:
            sim: in the state before.
            start: what `begin` has told; what later steps must know may be written into it.
            done: number of steps before.
            before: the last state; None if it is not known.
        """
        for n in range(done + 1, start["states"] + 1):
            yield self.step(sim, n)

    @property
    def settings(self) -> dict[str, Any]:
        """The fields by name, as they are recorded."""
        return asdict(self)


def check_tolerance(tolerance: float | None, recorded: bool = True) -> float | None:
    """The tolerance of relaxations, if given.

    Raises:
        ParameterError: it is not positive; or it is larger than that of states worth keeping.
    """
    if tolerance is None:
        return None
    if positive("tolerance", tolerance) > LARGEST_TOLERANCE and recorded:
        raise ParameterError(f"tolerance must be at most {LARGEST_TOLERANCE}, not {tolerance}")
    return float(tolerance)
