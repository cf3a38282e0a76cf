"""What is seen of `jam` while it works: a bar of progress, and a function of the user."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI
from tqdm import tqdm

from ..common.ranks import world
from ..engine.watching import Callback, Iteration, tell


class Watch:
    """Tells a bar and a callback how jamming goes on.

    Args:
        bar: of progress.
        callback: of the user, if any.
        comm: ranks that share the work, if any.
    """

    def __init__(self, bar: tqdm[Any], callback: Callback | None, comm: MPI.Comm | None) -> None:
        self._bar, self._callback, self._comm, self._iterations = bar, callback, comm, 0
        self._root = (comm or world()).rank == 0

    def begin(self, stage: str) -> None:
        """A stage begins, in words."""
        self._bar.set_description_str(f"jamming, {stage}", refresh=False)

    def tell(self, iterations: int, phi: float, pressure: float, residual: float) -> None:
        """So many iterations were done; see `Report` and `Iteration`."""
        shown = {"phi": f"{phi:.6f}", "pressure": f"{pressure:.1e}", "residual": f"{residual:.1e}"}
        self._bar.set_postfix(**shown)
        self._bar.update(iterations)
        self._iterations += iterations
        if self._callback:
            seen = Iteration("jam", self._iterations, phi, pressure, residual, self._root)
            tell(self._callback, seen, self._comm)
