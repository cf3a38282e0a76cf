"""Independent calls over the cores of one machine, or over MPI ranks on any number of machines."""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures.process import BrokenProcessPool
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from .checks import count, expect, expect_function, shown
from .errors import ParameterError
from .ranks import LAUNCHERS, agree, independent, independently, progress, world

if TYPE_CHECKING:
    from mpi4py import MPI

T = TypeVar("T")
Item = TypeVar("Item")

# What a new process runs first. mpiexec and srun tell a process its rank by such variables, which
# its children inherit: with them MPI would take each child for that rank. And a lock of tqdm's for
# several processes outlives one that is killed.
_ALONE = f"""
import os, threading, tqdm
for name in [*os.environ]:
    if name.startswith({LAUNCHERS!r}):
        del os.environ[name]
tqdm.tqdm.set_lock(threading.RLock())
"""


def parallel_map(
    f: Callable[[Item], T], items: Iterable[Item], *, workers: int | None = None
) -> list[T]:
    """[f(item) for item in items], several calls at a time.

    Processes on the cores of this machine make the calls, by joblib, also for lambdas and for
    functions of scripts and notebooks. Several ranks of `mpiexec` or `srun` share them: all run
    the script, and call this with the same items. In a call each simulation belongs to one rank,
    and a further `parallel_map` makes its calls one after another.

    Args:
        f: of one item. What it names is copied to the processes, so a simulation must be made in
            it. Several arguments: `lambda item: f(*item)`, or `functools.partial`.
        items: they and the results must pickle.
        workers: calls at a time; by default one for each core or rank. One worker makes them one
            after another in this process.

    Returns:
        The results in the order of the items, on every rank. They do not depend on the number of
        workers. To keep them for a second run give `joblib.Memory("folder").cache(f)` as f; it
        must be a function of a module.

    Raises:
        ParameterError: fewer than one worker, f is no function or cannot be copied to processes, or
            items are none.
        BrokenProcessPool: a process died.
        Exception: the first one of a call, with a note that has its item. Other calls are given up.
    """
    expect_function(f, "of an item")
    expect("items", items, Iterable)
    items, comm = list(items), world()
    workers = None if workers is None else count("workers", workers)
    if comm.size > 1:
        return _over_ranks(comm, f, items, workers or comm.size)
    import joblib

    workers = min(workers or joblib.cpu_count(), len(items))
    name = getattr(f, "__name__", "parallel_map")
    with progress(name, unit="call", total=len(items)) as bar:
        if workers < 2 or independent():
            calls = (_alone(f, item) for item in items)
        else:
            # one thread each; large arrays are copied as small ones are
            settings = {"inner_max_num_threads": 1, "initializer": exec, "initargs": (_ALONE,)}
            with joblib.parallel_config("loky", n_jobs=workers, max_nbytes=None, **settings):
                pool = joblib.Parallel(return_as="generator")
                calls = pool(joblib.delayed(_alone)(f, item) for item in items)
        results = []
        try:
            for result in calls:
                results.append(result)
                bar.update()
        except pickle.PicklingError as error:
            reason = str(error.__cause__ or error).strip('"\n').splitlines()[-1]
            raise ParameterError(
                f"{name} or an item cannot be copied to other processes ({reason}): make "
                "simulations in the function, or take workers=1"
            ) from error
        except BrokenProcessPool as error:
            codes = ", ".join(re.findall(r"[A-Z]+\(-?\d+\)", str(error)))
            raise BrokenProcessPool(
                f"a process of {name} died, {codes}: it crashed, or was killed, as where memory "
                "runs out; workers=1 runs without processes"
            ) from error
        return results


def _alone(f: Callable[[Item], T], item: Item) -> T:
    """The result of one call. Its error notes the item, and pickles."""
    try:
        return independently(f, item)
    except Exception as error:
        found = error
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:
            found = RuntimeError(f"{type(error).__name__}: {error}")
        if hasattr(found, "add_note"):  # Python 3.11
            found.add_note(f"in the call {getattr(f, '__name__', f)}({shown(item)})")
        raise found from (None if found is error else error)


def _over_ranks(
    comm: MPI.Intracomm, f: Callable[[Item], T], items: Sequence[Item], workers: int
) -> list[T]:
    """The same over ranks. Each takes the next item, which a counter on rank 0 names."""
    agree(comm, f"parallel_map of {len(items)} items")
    from mpi4py import MPI

    counter = MPI.Win.Allocate(8 if comm.rank == 0 else 0, 8, comm=comm)
    if comm.rank == 0:
        counter.tomemory().cast("q")[0] = 0
    comm.Barrier()
    counter.Lock_all()

    def take(step: int) -> int:
        taken = np.empty(1, np.int64)
        counter.Fetch_and_op(np.array([step], np.int64), taken, 0)
        counter.Flush(0)
        return int(taken[0])

    results: dict[int, bytes] = {}
    errors: dict[int, Exception] = {}
    while comm.rank < workers and (n := take(1)) < len(items):
        try:
            results[n] = pickle.dumps(_alone(f, items[n]))
        except Exception as error:
            errors[n] = error
            take(len(items))
    counter.Unlock_all()
    gathered = comm.allgather((results, errors))
    counter.Free()
    for found, failed in gathered:
        results.update(found)
        errors.update(failed)
    if errors:
        raise errors[min(errors)]
    return [pickle.loads(results[n]) for n in range(len(items))]
