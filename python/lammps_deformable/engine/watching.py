"""What a user's function sees of a relaxation while it goes on."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from mpi4py import MPI

from ..common.errors import ParameterError
from ..common.validate import shown


class Iteration(NamedTuple):
    """A moment of `Simulation.relax`, `jam` or `polish`.

    Attributes:
        protocol: its name, `relax`, `jam` or `polish`.
        iterations: of the minimizer so far in this call; `jam` counts those of soft disks by
            twenties, and relaxations of particles, `polish` its steps.
        phi: packing fraction.
        pressure: of the packing [energy/length^2]; in `jam` in units of its `pressure`, those of
            soft disks while it compresses these.
        residual: largest force on a particle over the mean contact force, or about that.
        root: whether this process should print and write, as that of a state.
    """

    protocol: str
    iterations: int
    phi: float
    pressure: float
    residual: float
    root: bool


Callback = Callable[[Iteration], object]


def check_callback(callback: Callback | None) -> None:
    """Refuse a callback that cannot be called."""
    if callback is not None and not callable(callback):
        raise ParameterError(
            "callback must be a function of an Iteration, such as lambda seen: "
            f"print(seen.residual), or None, not {shown(callback)}"
        )


def tell(callback: Callback, seen: Iteration, comm: MPI.Comm | None) -> None:
    """Call a user's function; its exception is raised here, on all ranks.

    Args:
        callback: the function.
        seen: what it is told.
        comm: ranks that share the work and make this call too; None if this one is alone.

    Raises:
        RuntimeError: it has failed on other ranks only.
    """
    error: BaseException | None = None
    try:
        callback(seen)
    except BaseException as raised:
        error = raised
    if comm is not None and comm.size > 1:
        failed = [rank for rank, each in enumerate(comm.allgather(error is not None)) if each]
        if failed and error is None:
            raise RuntimeError(f"the callback of {seen.protocol} failed on rank {failed[0]}")
    if error is not None:
        raise error


class Watched:
    """A simulation whose relaxations may be watched."""

    _callback: Callback | None = None

    @property
    def callback(self) -> Callback | None:
        """Called with an `Iteration` where a relaxation begins, and after each call of FIRE.

        The last one is that of the relaxed state. Calls of FIRE take 2000 iterations or
        more, unless forces are small enough before. The function must leave the simulation as it
        is. Its exception ends the relaxation where it is, at rest. None calls nothing.

            sim.callback = lambda seen: print(seen.iterations, seen.residual)

        Raises:
            ParameterError: it cannot be called.
        """
        return self._callback

    @callback.setter
    def callback(self, callback: Callback | None) -> None:
        check_callback(callback)
        self._callback = callback
