"""MPI ranks: all of them in one simulation, or each in simulations of its own.

A simulation is in one call at a time: of one thread, and of all of its ranks. Progress is shown by
rank 0 alone: a bar on a terminal, elsewhere a line a minute.
"""

from __future__ import annotations

import os
import sys
import time
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import fields, is_dataclass
from functools import cache, wraps
from hashlib import blake2b
from inspect import isfunction
from io import StringIO
from multiprocessing import parent_process
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np
from tqdm import tqdm

from .checks import expect
from .errors import CallError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mpi4py import MPI


P = ParamSpec("P")
T = TypeVar("T")

# Letters of the name of a call, bytes that tell its arguments apart, and tag of the message of a
# rank that ends.
_LETTERS, _DIGEST, _ENDED = 60, 16, 7411

# A rank that has waited for so many polls looks less often, at intervals [s].
_BUSY, _PAUSE = 1000, 1e-3

# What a rank has sent before it ended arrives in this time [s].
_ON_ITS_WAY = 1.0

_WAY_OUT = (
    "all ranks make the same calls of a simulation, or it is one rank's own by comm=MPI.COMM_SELF"
)

# Whether this is one of the independent calls of `parallel_map`.
_independent: ContextVar[bool] = ContextVar("independent", default=False)


# Variables that mpiexec and srun give to the processes that they start begin with these.
LAUNCHERS = ("PMI", "HYDI_", "MPI_LOCAL", "MV2_", "OMPI_", "PALS_")


class OneRank:
    """A process that has not started MPI, in the place of a communicator."""

    rank, size = 0, 1

    def barrier(self) -> None:
        """Nobody is waited for."""

    def bcast(self, value: T) -> T:
        """The value itself."""
        return value


def world() -> MPI.Intracomm:
    """The ranks that make the same calls: all, or this one alone in a call of `parallel_map`.

    MPI starts with the first simulation, or where a launcher has started the process: to read a run
    and to analyze it needs none.
    """
    launched = any(name.startswith(LAUNCHERS) for name in os.environ)
    if "mpi4py.MPI" not in sys.modules and not launched:
        return OneRank()  # type: ignore[return-value]
    return alone() if _independent.get() else everyone()


def everyone() -> MPI.Intracomm:
    """All ranks, which share the work of a simulation; MPI starts."""
    from mpi4py import MPI

    return MPI.COMM_WORLD


def alone() -> MPI.Intracomm:
    """This rank, which computes by itself; MPI starts."""
    from mpi4py import MPI

    return MPI.COMM_SELF


def _told(value: Any) -> object:
    """What all ranks must give alike in an argument: numbers, words and settings, or its kind.

    States and packings are those of rank 0, whose digits may differ on other machines, and
    functions are each rank's own.
    """
    if isinstance(value, dict):
        return {name: _told(each) for name, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_told(each) for each in value]
    plain = value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
    if is_dataclass(plain) and not hasattr(plain, "positions"):
        each = {field.name: getattr(plain, field.name) for field in fields(plain) if field.repr}
        return type(plain).__name__, _told(each)
    alike = isinstance(plain, (str, int, float, list, Path, type(None)))
    return plain if alike else type(plain).__name__


def agree(comm: MPI.Comm, call: str, arguments: object = None) -> None:
    """Wait until all ranks make the same call: if one does not, the others would wait for ever.

    A rank that ends tells the others so. One that is busy may let them wait.

    Args:
        comm: the ranks.
        call: its name.
        arguments: of the call; those that are no numbers, words or settings may differ.

    Raises:
        CallError: a rank makes another call, gives other arguments, or has ended.
    """
    if comm.size == 1:
        return
    from mpi4py import MPI

    digest = blake2b(repr(_told(arguments)).encode(), digest_size=_DIGEST).digest()
    mine = np.frombuffer(call.encode()[:_LETTERS].ljust(_LETTERS) + digest, np.uint8)
    calls = np.empty((comm.size, _LETTERS + _DIGEST), np.uint8)
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
    names = [row[:_LETTERS].tobytes().decode(errors="ignore").strip() for row in calls]
    for rank, other in enumerate(names):
        if other != names[0]:
            raise CallError(f"rank 0 calls {names[0]} and rank {rank} {other}: {_WAY_OUT}")
        if (calls[rank] != calls[0]).any():
            raise CallError(f"ranks 0 and {rank} give other arguments to {other}: {_WAY_OUT}")


def wait_for_all() -> None:
    """Wait until all ranks are here, as rank 0 may still be writing.

    Raises:
        CallError: a rank is elsewhere.
    """
    comm = world()
    agree(comm, "a simulation or a Run")
    comm.barrier()


def together(call: Callable[[], bool], comm: MPI.Comm, name: str) -> bool:
    """Whether a user's function says yes on any rank; its exception is raised here, on all ranks.

    Args:
        call: of the function.
        comm: ranks that make the call too.
        name: of the function, for an error.

    Raises:
        RuntimeError: it has failed on other ranks only.
    """
    error: BaseException | None = None
    answer = False
    try:
        answer = call()
    except BaseException as raised:
        error = raised
    if comm.size > 1:
        failed, answers = zip(*comm.allgather((error is not None, answer)), strict=True)
        if any(failed) and error is None:
            raise RuntimeError(f"{name} failed on rank {failed.index(True)}")
        answer = any(answers)
    if error is not None:
        raise error
    return answer


def end() -> None:
    """Tell all ranks that this one ends; nobody waits for that.

    MPI may fail to end with messages that nobody has taken. So a rank that has told this one is not
    told, and those that end at the same time are heard.
    """
    from mpi4py import MPI

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


# Plugins are those of all instances of LAMMPS in a process, which open, clear and close one by one.
OPENING = RLock()


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
    def one(self, name: str, arguments: object = None) -> Iterator[None]:
        """Let this thread alone make a call, which the other ranks make too, of these arguments.

        Raises:
            CallError: another thread is in a call, or other ranks make another one, or none.
        """
        with self.of_one_thread(name):
            if self._depth == 0 and self.begun:
                agree(self._comm, name, arguments)
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
        name = f"{type(self).__name__}.{method.__name__}"
        with self._lmp.calls.one(name, (given, words)):
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
            with OPENING:
                super().__init__(cmdargs=cmdargs, comm=comm)

        def close(self) -> None:
            with OPENING:
                super().close()

        def command(self, cmd: str) -> None:
            with self.calls.one(" ".join(["the command", *cmd.split()[:1]]), cmd):
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


# Seconds between lines of progress where there is no terminal.
_LINES = 60.0

# Whether progress is shown.
_shown = True


def show_progress(shown: bool = True) -> None:
    """Show progress of protocols, `jam` and others from now on, or hide it.

    An environment variable TQDM_DISABLE that is not empty hides it, too.

    Raises:
        ParameterError: `shown` is neither True nor False.
    """
    global _shown
    expect("shown", shown, bool)
    _shown = shown


class _Lines(tqdm):  # type: ignore[misc]
    """Progress as lines of text, for logs."""

    def display(self, msg: str | None = None, pos: int | None = None) -> bool:
        """Print a line; an empty message would clear a bar."""
        if msg is None:
            print(self, file=sys.stderr, flush=True)
        return False

    def set_postfix(self, *values: Any, **named: Any) -> None:
        """Show these values from the next line on, not at once."""
        super().set_postfix(*values, **named | {"refresh": False})


def progress(description: str, unit: str, total: int | None = None, initial: int = 0) -> tqdm[Any]:
    """Progress on stderr: a bar on a terminal, elsewhere a line a minute after the first minute."""
    hidden = world().rank > 0 or independent() or parent_process() is not None
    hidden = hidden or not _shown or bool(os.environ.get("TQDM_DISABLE"))
    shared = {"desc": description, "unit": unit, "total": total, "initial": initial}
    if total is None:
        shared["bar_format"] = "{desc}: {n_fmt} {unit}s [{elapsed}{postfix}]"
    if sys.stderr.isatty():
        return tqdm(**shared, leave=False, disable=hidden)
    lines = {"mininterval": _LINES, "delay": _LINES, "miniters": 1}
    # `tqdm.write` refreshes bars on stderr, but a line that is printed stays
    return _Lines(**shared, leave=False, disable=hidden, file=StringIO(), **lines)


def print_once(line: str) -> None:
    """Print a line once, above any progress bar."""
    if world().rank == 0:
        tqdm.write(line, file=sys.stdout)
