"""Independent runs over the cores of one machine."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any, TypeVar

from mpi4py import MPI

from .errors import ParameterError
from .progress import progress

T = TypeVar("T")


def parallel_map(
    function: Callable[..., T],
    arguments: Sequence[tuple[Any, ...]],
    workers: int | None = None,
    description: str = "running",
    each: Callable[[T], object] = lambda result: None,
) -> list[T]:
    """Call a function with each tuple of arguments, several at a time in processes of their own.

    A script that calls this needs the guard `if __name__ == "__main__":`, because each process
    imports it again. Under `mpiexec`, where the cores are taken, and with one worker, the calls are
    made here one after another.

    Args:
        function: at the top level of a module; it and its results must pickle.
        arguments: of each call.
        workers: processes; as many as cores may be used if not given.
        description: of the progress bar.
        each: called here with each result as it comes, in any order, to keep it.

    Returns:
        The results in the order of the arguments.

    Raises:
        ParameterError: fewer than one worker.
        BrokenProcessPool: a process died.
        Exception: the first one that a call raises; calls not yet begun are given up.
    """
    workers = min(len(os.sched_getaffinity(0)) if workers is None else workers, len(arguments) or 1)
    if workers < 1:
        raise ParameterError(f"workers must be at least 1, not {workers}")
    with progress(description, unit="run", total=len(arguments)) as bar:
        if workers == 1 or launched():
            results = []
            for these in arguments:
                results.append(function(*these))
                each(results[-1])
                bar.update()
            return results
        # a process that has initialized MPI must not fork
        with _one_thread(), ProcessPoolExecutor(workers, get_context("spawn")) as pool:
            futures = [pool.submit(function, *these) for these in arguments]
            try:
                for future in as_completed(futures):
                    each(future.result())
                    bar.update()
            except BrokenProcessPool:
                raise BrokenProcessPool(
                    f"a process of {function.__name__} died, killed or for want of memory; or a "
                    'script that farms lacks the guard `if __name__ == "__main__":`; workers=1 '
                    "runs without processes"
                ) from None
            finally:
                pool.shutdown(cancel_futures=True)
            return [future.result() for future in futures]


def launched() -> bool:
    """Whether mpiexec started this process: others would inherit its place in the run."""
    return MPI.COMM_WORLD.size > 1 or any(name.startswith("PMI") for name in os.environ)


@contextmanager
def _one_thread() -> Iterator[None]:
    """Let new processes use one OpenMP thread each; the library reads this when it is loaded."""
    before = os.environ.get("OMP_NUM_THREADS")
    os.environ["OMP_NUM_THREADS"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["OMP_NUM_THREADS"]
        else:
            os.environ["OMP_NUM_THREADS"] = before
