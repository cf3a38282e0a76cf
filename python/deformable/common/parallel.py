"""Independent calls over the cores of one machine, with results that survive interruptions."""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, TypeVar

from mpi4py import MPI

from .. import core
from .errors import ParameterError
from .files import make_folder, write_whole
from .progress import progress

T = TypeVar("T")


def parallel_map(
    function: Callable[..., T],
    arguments: Sequence[tuple[Any, ...]],
    workers: int | None = None,
    description: str = "running",
    each: Callable[[T], object] = lambda result: None,
    keep: Path | None = None,
) -> list[T]:
    """Call a function with each tuple of arguments, several at a time in processes of their own.

    A script that calls this needs the guard `if __name__ == "__main__":`, because each process
    imports it again. Under `mpiexec`, where the cores are taken, and with one worker, the calls are
    made here one after another.

    Args:
        function: at the top level of a module; it and its results must pickle.
        arguments: of each call.
        workers: number of processes; by default one per core.
        description: of the progress bar.
        each: called here with each result as soon as it is there, in any order.
        keep: folder for the results, see `call_once`: the same calls after an interruption only
            compute what it lacks.

    Returns:
        The results in the order of the arguments.

    Raises:
        ParameterError: fewer than one worker.
        BrokenProcessPool: a process died.
        Exception: the first one that a call raises; calls that have not begun are given up.
    """
    workers = min(len(os.sched_getaffinity(0)) if workers is None else workers, len(arguments) or 1)
    if workers < 1:
        raise ParameterError(f"workers must be at least 1, not {workers}")
    call = function if keep is None else partial(call_once, keep, function)
    with progress(description, unit="run", total=len(arguments)) as bar:
        if workers == 1 or launched():
            results = []
            for these in arguments:
                results.append(call(*these))
                each(results[-1])
                bar.update()
            return results
        # a process that has initialized MPI must not fork
        with _one_thread(), ProcessPoolExecutor(workers, get_context("spawn")) as pool:
            futures = [pool.submit(call, *these) for these in arguments]
            try:
                for future in as_completed(futures):
                    each(future.result())
                    bar.update()
            except BrokenProcessPool:
                raise BrokenProcessPool(
                    f"a process of {function.__name__} died: it was killed, or memory ran out, or "
                    'the script lacks the guard `if __name__ == "__main__":`; workers=1 runs '
                    "without processes"
                ) from None
            finally:
                pool.shutdown(cancel_futures=True)
            return [future.result() for future in futures]


def call_once(folder: Path, function: Callable[..., T], /, *arguments: Any, **keywords: Any) -> T:
    """The result of a call: from a folder that has it, or computed and kept there.

    Args:
        folder: made if missing. It has one file per call, <function>-<digest>.pickle, written
            whole.
        function: its result must pickle.
        arguments: of the call; they must pickle. Arguments with other pickles are computed anew.
        keywords: of the call, as `arguments`.
    """
    name = function.__qualname__
    asked = (core.version, function.__module__, name, arguments, sorted(keywords.items()))
    digest = hashlib.sha256(pickle.dumps(asked)).hexdigest()[:16]  # repr cuts large arrays short
    path = folder / f"{name}-{digest}.pickle"
    if path.exists():
        kept: T = pickle.loads(path.read_bytes())
        return kept
    result = function(*arguments, **keywords)
    make_folder(folder)
    write_whole(path, pickle.dumps(result))
    return result


def launched() -> bool:
    """Whether mpiexec started this process: processes that it starts would inherit its rank."""
    return MPI.COMM_WORLD.size > 1 or any(name.startswith("PMI") for name in os.environ)


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
