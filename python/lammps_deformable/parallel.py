"""Independent calls over the cores of one machine, or over MPI ranks on any number of machines.

Fits, and errors of what follows from several packings.
"""

from __future__ import annotations

import math
import os
import pickle
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import linear_regression
from typing import Any, Generic, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from . import core
from ._checks import count, expect, shown
from ._files import make_folder
from .errors import ParameterError
from .progress import progress
from .ranks import helpers, independent, independently, led

T = TypeVar("T")

# What new processes run first. mpiexec and srun tell a process its rank by such variables, which
# its children inherit: with them MPI would take each child for that rank. And a lock of tqdm's for
# several processes outlives one that is killed.
_ALONE = """
import os, threading, tqdm
for name in [*os.environ]:
    if name.startswith(("PMI", "HYDI_", "MPI_LOCAL", "OMPI_", "PALS_")):
        del os.environ[name]
tqdm.tqdm.set_lock(threading.RLock())
"""


@led
def parallel_map(
    function: Callable[..., T],
    arguments: Iterable[tuple[Any, ...]],
    workers: int | None = None,
    description: str = "running",
    each: Callable[[T], object] = lambda result: None,
    keep: str | Path | None = None,
) -> list[T]:
    """Call a function with each tuple of arguments, several at a time, independent of each other.

    Several ranks of `mpiexec` share the calls, and all of them must call this. Else processes on
    the cores of this machine do, by joblib's loky, from scripts and notebooks. In a call each
    simulation belongs to one rank, and a further `parallel_map` makes its calls one after another.

    Args:
        function: of any kind, also a lambda. What it names is copied for each call, so that a
            simulation must be made in it.
        arguments: of each call, as in a list or zip(seeds). They and the results must pickle.
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
        ParameterError: fewer than one worker, no function, arguments that are no tuples, or what is
            called does not pickle.
        BrokenProcessPool: a process died.
        Exception: the first one that a call raises, with a note that has its arguments, once the
            calls that have begun are done; others are given up.
    """
    workers = None if workers is None else count("workers", workers)
    if not callable(function):
        raise ParameterError(f"function must be one, not {shown(function)}")
    expect("arguments", arguments, Iterable)
    arguments = list(arguments)
    for these in arguments:
        if not isinstance(these, tuple):
            raise ParameterError(
                f"arguments of each call must be a tuple, such as (seed,), not {shown(these)}"
            )
    call = _Call(function, None if keep is None else Path(keep))
    with progress(description, unit="run", total=len(arguments)) as bar:

        def done(result: T) -> None:
            each(result)
            bar.update()

        with _places(workers, len(arguments)) as places:
            if places:
                return _spread(call, arguments, places, done)
        results = []
        for these in arguments:
            results.append(call(these))
            done(results[-1])
        return results


class _Call(Generic[T]):
    """Calls of a function, each made alone; results may be kept in a folder."""

    def __init__(self, function: Callable[..., T], keep: Path | None) -> None:
        self.name = getattr(function, "__name__", repr(function))
        # the copy of a function of a script or a notebook does not know where it stands
        self._file = getattr(getattr(function, "__code__", None), "co_filename", None)
        if helpers() is not None and not _has_name(function):
            from joblib import wrap_non_picklable_objects

            function, self._file = wrap_non_picklable_objects(function), None
        self._function, self._keep = function, keep

    def __call__(self, these: tuple[Any, ...]) -> T:
        """The result of one call; its error notes what was called."""
        function: Any = self._function
        if self._file and function.__code__.co_filename != self._file:
            own = getattr(function, "__func__", function)  # of a method
            own.__code__ = own.__code__.replace(co_filename=self._file)
        if self._keep:
            function = partial(call_once, self._keep, function)
        try:
            result: T = independently(function, *these)
            return result
        except Exception as error:
            if hasattr(error, "add_note"):  # Python 3.11
                error.add_note(f"in the call {self.name}({', '.join(map(shown, these))})")
            raise

    def elsewhere(self, these: tuple[Any, ...]) -> T:
        """The same, with an error that reaches other processes."""
        from joblib.externals.loky.backend.reduction import dumps

        try:
            return self(these)
        except Exception as error:
            try:
                pickle.loads(dumps(error))
            except Exception:
                plain = RuntimeError(f"{type(error).__name__}: {error}")
                vars(plain).update(__notes__=getattr(error, "__notes__", []))
                raise plain from error
            raise


def _has_name(function: Callable[..., Any]) -> bool:
    """Whether other ranks, which run the same script, find a function by its name."""
    try:
        return bool(pickle.dumps(function))
    except Exception:
        return False


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
    if count < 2 or independent():
        yield []
        return
    from joblib.externals.loky import ProcessPoolExecutor

    # one thread each: OpenMP reads its variable when it is loaded
    pool = ProcessPoolExecutor(
        count, initializer=exec, initargs=(_ALONE,), env={"OMP_NUM_THREADS": "1"}
    )
    interrupted = True
    try:
        yield [pool] * count
        interrupted = False
    except Exception:  # once all calls are done
        interrupted = False
        raise
    finally:
        pool.shutdown(kill_workers=interrupted)


def _spread(
    call: _Call[T],
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
            running[place.submit(call.elsewhere, these)] = n, place
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            n, place = running.pop(future)
            places.append(place)
            try:
                results[n] = future.result()
            except BrokenProcessPool as error:
                codes = ", ".join(re.findall(r"[A-Z]+\(-?\d+\)", str(error)))
                what = f"a process of {call.name} died, {codes}: it crashed, or was killed, as "
                what += "where memory runs out; workers=1 runs without processes"
                errors.append(BrokenProcessPool(what))
            except pickle.PicklingError as error:  # its cause is a traceback
                reason = str(error.__cause__ or error).strip('"\n').splitlines()[-1]
                reason = reason.removeprefix(f"{ParameterError.__module__}.ParameterError: ")
                errors.append(
                    ParameterError(f"{call.name} cannot be called in other processes: {reason}")
                )
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


def power_law(x: Iterable[float], y: Iterable[float]) -> float:
    """n of y ~ x^n: the slope of log |y| over log x by least squares, with equal weights."""
    log_x, log_y = ([math.log(abs(value)) for value in values] for values in (x, y))
    return linear_regression(log_x, log_y).slope


def jackknife(
    value: Callable[[Sequence[T]], ArrayLike], samples: Sequence[T]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A value of all samples, and its standard error from leaving out one after another.

        error^2 = (n - 1)/n sum (v_k - mean v)^2,    v_k without sample k

    It is right for fits too, whose points share their packings. For a mean it is the standard error
    of the mean.

        fit, error = ld.jackknife(lambda some: np.polyfit(x, mean_of(some), 1), packings)

    Args:
        value: of a sequence of samples; a number or an array.
        samples: independent of each other, such as packings; two or more.

    Returns:
        Value and error, of the same shape; the error is nan where one of the v_k is.

    Raises:
        ParameterError: there are fewer than two samples.

    Source: Efron and Stein, Ann. Stat. 9, 586 (1981).
    """
    count = len(samples)
    if count < 2:
        raise ParameterError(f"samples must be at least 2 for an error, not {count}")
    without = np.array([value([*samples[:n], *samples[n + 1 :]]) for n in range(count)], float)
    spread = np.sum((without - without.mean(axis=0)) ** 2, axis=0)
    return np.asarray(value(samples), float), np.sqrt((count - 1) / count * spread)
