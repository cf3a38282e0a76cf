"""Independent calls over the cores of one machine, or over MPI ranks on any number of machines."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

from mpi4py import MPI

from .. import core
from .errors import ParameterError
from .files import make_folder
from .progress import progress
from .ranks import helpers, independent, independently, launched, led
from .validate import expect

T = TypeVar("T")


@led
def parallel_map(
    function: Callable[..., T],
    arguments: Sequence[tuple[Any, ...]],
    workers: int | None = None,
    description: str = "running",
    each: Callable[[T], object] = lambda result: None,
    keep: str | Path | None = None,
) -> list[T]:
    """Call a function with each tuple of arguments, several at a time, independent of each other.

    Under `mpiexec` the ranks share the calls, and all of them must call this. Else processes on
    the cores of this machine do; the script then needs the guard `if __name__ == "__main__":`,
    because each process imports it again. In a call each simulation belongs to one rank, and a
    further `parallel_map` makes its calls one after another.

    Args:
        function: at the top level of a module; it and its results must pickle.
        arguments: of each call.
        workers: number of calls at a time; by default one per core or rank. One worker makes them
            one after another in this process.
        description: of the progress bar.
        each: called with each result as soon as it is there, in any order; on rank 0 alone.
        keep: folder for the results: the same calls after an interruption only compute what it
            lacks. They are pickles, and reading a pickle runs the code in it: give a folder that
            only you write to. Runs and saved states never are pickles.

    Returns:
        The results in the order of the arguments, on every rank. They do not depend on the number
        of workers.

    Raises:
        ParameterError: fewer than one worker, arguments that are no tuples, or a function that
            other processes cannot import.
        BrokenProcessPool: a process died.
        Exception: the first one that a call raises, once the calls that have begun are done; others
            are given up.
    """
    if workers is not None and workers < 1:
        raise ParameterError(f"workers must be at least 1, not {workers}")
    for these in arguments:
        expect("arguments of each call", these, tuple)
    kept = function if keep is None else partial(call_once, Path(keep), function)
    call = partial(independently, kept)
    with progress(description, unit="run", total=len(arguments)) as bar:

        def done(result: T) -> None:
            each(result)
            bar.update()

        with _places(workers, len(arguments)) as places:
            if places:
                _check_importable(function)
                try:
                    return _spread(call, arguments, places, done)
                except BrokenProcessPool:
                    name = getattr(function, "__name__", function)
                    raise BrokenProcessPool(
                        f"a process of {name} died: it was killed, or memory ran out, or the "
                        'script lacks the guard `if __name__ == "__main__":`; workers=1 runs '
                        "without processes"
                    ) from None
        results = []
        for these in arguments:
            results.append(call(*these))
            done(results[-1])
        return results


def _check_importable(function: Callable[..., Any]) -> None:
    """Refuse functions that pickle does not find by their names, such as a lambda."""
    try:
        pickle.dumps(function)
    except (pickle.PicklingError, AttributeError, TypeError):
        raise ParameterError(
            f"{function!r} cannot be called in other processes: define it at the top level of a "
            "module or script, or take workers=1"
        ) from None


@contextmanager
def _places(workers: int | None, calls: int) -> Iterator[list[Executor]]:
    """Where calls can be made, each place one at a time; none if only here, one after another."""
    others = helpers()
    if others is not None:
        count = min(workers or MPI.COMM_WORLD.size, calls)
        # the thread that serves the other ranks needs MPI while a call here has it
        shared = MPI.Query_thread() == MPI.THREAD_MULTIPLE
        with ThreadPoolExecutor(1) as here:
            yield [here, *[others] * (count - 1)] if shared else [others] * count
        return
    count = min(workers or len(os.sched_getaffinity(0)), calls)
    if count < 2 or independent() or launched():
        yield []
        return
    # a process that has initialized MPI must not fork
    with _one_thread(), ProcessPoolExecutor(count, get_context("spawn")) as pool:
        yield [pool] * count


def _spread(
    call: Callable[..., T],
    arguments: Sequence[tuple[Any, ...]],
    places: list[Executor],
    done: Callable[[T], object],
) -> list[T]:
    """The results of calls, in order. After an error no call begins, those that have are kept."""
    todo = list(enumerate(arguments))[::-1]
    running: dict[Future[T], tuple[int, Executor]] = {}
    results: dict[int, T] = {}
    errors: list[Exception] = []
    while running or (todo and not errors):
        while places and todo and not errors:
            place, (n, these) = places.pop(0), todo.pop()
            running[place.submit(call, *these)] = n, place
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            n, place = running.pop(future)
            places.append(place)
            try:
                results[n] = future.result()
            except Exception as error:
                errors.append(error)
            else:
                done(results[n])
    if errors:
        raise errors[0]
    return [results[n] for n in range(len(arguments))]


def call_once(folder: Path, function: Callable[..., T], /, *arguments: Any, **keywords: Any) -> T:
    """The result of a call: from a folder that has it, or computed and kept there by joblib.

    Results are pickles, and reading a pickle runs the code in it: give folders that only you
    write to. Runs and saved states never are pickles.

    Args:
        folder: made if missing. It has a folder for each version of this package.
        function: its result must pickle. If its code changes, its results are computed anew.
        arguments: of the call; they must pickle.
        keywords: of the call, as `arguments`.
    """
    from joblib import Memory  # loads in a sixth of a second, which most calls need not wait for

    memory = Memory(str(make_folder(folder) / core.version), verbose=0)
    result: T = memory.cache(function)(*arguments, **keywords)
    return result


@contextmanager
def _one_thread() -> Iterator[None]:
    """Let new processes use one OpenMP thread each: OpenMP reads the variable when it is loaded."""
    before = os.environ.get("OMP_NUM_THREADS")
    os.environ["OMP_NUM_THREADS"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["OMP_NUM_THREADS"]
        else:
            os.environ["OMP_NUM_THREADS"] = before
