"""A process that runs LAMMPS cases and returns their answers."""

import json
import subprocess
import sys
import threading
from pathlib import Path

import pytest

HOST = Path(__file__).with_name("host.py")
SECONDS = 60  # a case takes milliseconds


class Host:
    """The process of host.py, started anew after a crash."""

    def __init__(self, folder):
        self.folder = folder
        self.process = None

    def answer(self, commands, files=None, **more):
        """LAMMPS' answer to commands and files; a crash or a hang fails the test and shows them."""
        if self.process is None:
            self.process = subprocess.Popen(
                [sys.executable, HOST],
                cwd=self.folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
            )
        clock = threading.Timer(SECONDS, self.process.kill)
        clock.start()
        try:
            case = json.dumps({"files": files or {}, "commands": commands} | more)
            self.process.stdin.write(case + "\n")
            self.process.stdin.flush()
            line = self.process.stdout.readline()
        finally:
            clock.cancel()
        if line == "":
            code, self.process = self.process.wait(), None
            hung = "hung" if code == -9 else f"crashed (exit {code})"
            pytest.fail(f"LAMMPS {hung}: {case}")
        return json.loads(line)

    def close(self):
        if self.process is not None:
            self.process.stdin.close()
            self.process.wait()


@pytest.fixture(scope="session")
def host(tmp_path_factory):
    host = Host(tmp_path_factory.mktemp("fuzz"))
    (host.folder / "folder").mkdir()
    yield host
    host.close()
