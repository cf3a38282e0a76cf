"""What tests do with protocols: end them by an error, write states, measure G' and G''."""

import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from contact_laws import simulate
from lammps_deformable.formats import store
from lammps_deformable.protocols.recording import write_frame


class Stop(Exception):
    """Ends a protocol as a signal does: nothing is written any more."""


def stop_after(number: int) -> Callable[[Any], None]:
    """A callback that fails at the state after so many steps."""
    seen = []

    def callback(state: Any) -> None:
        seen.append(state)
        if len(seen) == number:
            raise Stop

    return callback


def written(
    states: Iterable[Any], folder: Path, parameters: Mapping[str, Any] | None = None
) -> None:
    """Write any states as the frames of a run."""
    folder.mkdir(exist_ok=True, parents=True)
    store.drop_frames(folder)
    for number, state in enumerate(states):
        write_frame(folder, number, state, parameters or {})


def dynamic_modulus(
    state: Any,
    amplitude: float,
    period: float = math.inf,
    cycles: int = 3,
    skip: int = 1,
    **how: Any,
) -> Any:
    """G' and G'' of a state."""
    with simulate(state, state.law) as sim:
        run = sim.oscillate(amplitude, period=period, cycles=cycles + skip, **how)
    return run.complex_modulus(skip)
