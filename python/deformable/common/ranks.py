"""MPI ranks: together in one simulation, or rank 0 with the others as its helpers."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from mpi4py import MPI

P = ParamSpec("P")
T = TypeVar("T")

# On rank 0 in a call that it leads: the other ranks.
_helpers: ContextVar[Executor | None] = ContextVar("helpers", default=None)

# Whether this is one of the independent calls of `parallel_map`.
_independent: ContextVar[bool] = ContextVar("independent", default=False)


def world() -> MPI.Intracomm:
    """The ranks that make the same calls: all, or this one alone.

    It is alone where rank 0 leads, in the calls of `parallel_map`, and if `python -m
    mpi4py.futures` started the script, which only rank 0 then runs.
    """
    alone = _helpers.get() is not None or _independent.get()
    return MPI.COMM_SELF if alone or _served() else MPI.COMM_WORLD


def led(function: Callable[P, T]) -> Callable[P, T]:
    """Let rank 0 make a call, with the other ranks as helpers for its `parallel_map`.

    All ranks must make the call, and get its result or its exception. Both must pickle. Nothing
    changes on one rank, and in calls that rank 0 makes alone.
    """

    @wraps(function)
    def call(*arguments: P.args, **keywords: P.kwargs) -> T:
        comm, message = world(), None
        with _lead() as leading:
            if leading and comm.size == 1:
                return function(*arguments, **keywords)
            if leading:
                result, error, message = _outcome(lambda: function(*arguments, **keywords))
        message = comm.bcast(message)
        if comm.rank > 0:
            result, error = pickle.loads(message)
        if error is not None:
            raise error
        return result

    return call


@contextmanager
def _lead() -> Iterator[bool]:
    """True on rank 0; the other ranks help until it leaves, and get False then."""
    served = _served() and MPI.COMM_WORLD.rank > 0
    if MPI.COMM_WORLD.size == 1 or _helpers.get() is not None or _independent.get() or served:
        yield True
        return
    from mpi4py.futures import MPICommExecutor

    with MPICommExecutor(MPI.COMM_WORLD) as entered:
        pool: Any = entered  # an executor, which mpi4py declares otherwise
        if pool is None:
            yield False
            return
        before = _helpers.set(pool)
        try:
            yield True
        finally:
            _helpers.reset(before)


def _outcome(call: Callable[[], T]) -> tuple[Any, BaseException | None, bytes]:
    """Result and exception of a call, and both as a pickle, without which others would wait."""
    result, error = None, None
    try:
        result = call()
    except BaseException as raised:
        error = raised
    try:
        return result, error, pickle.dumps((result, error))
    except Exception as unfit:
        error = error or unfit
        return None, error, pickle.dumps((None, RuntimeError(f"rank 0 failed: {error}")))


def helpers() -> Executor | None:
    """The other ranks, on rank 0 in a call that it leads."""
    return _helpers.get()


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


def _served() -> bool:
    """Whether only rank 0 runs the script, and the others wait for calls of mpi4py.futures."""
    return MPI.COMM_WORLD.size > 1 and "mpi4py.futures" in sys.orig_argv
