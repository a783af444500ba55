"""Command lines in forks of a process that has loaded the program.

To start an interpreter, to import and to load networks takes more than a second of processor time
for each command line. A fork starts as the loaded process stands: no thread, no signal handler, no
command line before it. It shares what a process decides when it starts, such as the order of sets:
whoever compares two processes starts them (`fresh=True` of `run_cli`).
"""

from __future__ import annotations

import gc
import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

THREADS = {"OMP_NUM_THREADS": "1"}
"""Networks that compute in one thread start none, and no lock is held at a fork."""


class LoadedProgram:
    """A process that forks for each command line."""

    def __init__(self, environment: Mapping[str, str], folder: Path) -> None:
        """folder: where streams are written."""
        self._given = environment
        self._streams = [folder / "stdout", folder / "stderr"]
        self._server = subprocess.Popen(
            [sys.executable, __file__],
            env={**environment, **THREADS},
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True,
        )  # fmt: skip
        assert self._server.stdout
        self._has = json.loads(self._server.stdout.readline())

    def serves(self, environment: Mapping[str, str]) -> bool:
        """Whether an environment is that of the process, or one with variables that the program
        sets, as it has done in the process of the tests."""
        return self._given.items() <= environment.items() <= {**self._has, **self._given}.items()

    def run(
        self, words: Sequence[str], cwd: Path | None, timeout_s: float
    ) -> subprocess.CompletedProcess[str]:
        """What a command line did, run in a folder."""
        server = self._server
        assert server.stdin
        assert server.stdout
        request = {"words": [*words], "folder": str(cwd or Path.cwd()),
                   "streams": [*map(str, self._streams)]}  # fmt: skip
        server.stdin.write(json.dumps(request).encode() + b"\n")
        server.stdin.flush()
        if not select.select([server.stdout], [], [], timeout_s)[0]:
            os.killpg(server.pid, signal.SIGKILL)
            raise subprocess.TimeoutExpired([*words], timeout_s)
        code = int(server.stdout.readline())
        return subprocess.CompletedProcess(
            [*words], code, *(path.read_text(encoding="utf-8") for path in self._streams)
        )

    def close(self) -> None:
        """End the process."""
        self._server.communicate()


def main() -> int:
    """The loaded process; in a fork, the exit code of its command line."""
    del sys.path[0]  # the folder of this file
    from chord_usd import cli
    from chord_usd.base.runtime.locations import keep_caches
    from chord_usd.base.runtime.offline import stay_offline
    from chord_usd.faces.standby import PARTS, load

    stay_offline()
    keep_caches()
    for part in PARTS:
        load(part)
    threads = len([*Path("/proc/self/task").iterdir()])
    assert threads == 1, f"{threads} threads: a fork copies their locks as they happen to be"
    gc.freeze()
    os.write(1, json.dumps({**os.environ}).encode() + b"\n")
    while line := sys.stdin.buffer.readline():
        child = os.fork()
        if child == 0:
            request = json.loads(line)
            sys.argv = ["chord-usd", *request["words"]]
            os.chdir(request["folder"])
            for number, place in enumerate([os.devnull, *request["streams"]]):
                flags = os.O_RDWR | os.O_CREAT | os.O_TRUNC
                os.dup2(os.open(place, flags if number else os.O_RDONLY), number)
            gc.unfreeze()
            return cli.main()
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        os.write(1, f"{code}\n".encode())
    return 0


if __name__ == "__main__":
    sys.exit(main())
