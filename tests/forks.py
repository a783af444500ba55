"""Command lines and readers in forks of processes that have loaded what they need.

To start an interpreter, to import and to load networks takes more than a second of processor time
for each command line, and a third of a second for each file that is read. A fork starts as the
loaded process stands: no thread, no signal handler, no call before it. It shares what a process
decides when it starts, such as the order of sets: whoever compares two processes starts them
(`fresh=True` of `run_cli`, the fixture `fresh_readers`).
"""

from __future__ import annotations

import gc
import json
import os
import pickle
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
"""Networks that compute in one thread start none, and no lock is held at a fork."""


class Loaded:
    """A process that forks for each request, in the folder of the request."""

    def __init__(self, kind: str, environment: Mapping[str, str], folder: Path) -> None:
        """kind: of LOADERS. folder: where streams are written."""
        self.has_ended = False
        self._given = environment
        self._streams = [folder / name for name in ("stdin", "stdout", "stderr")]
        self._streams[0].touch()
        self._server = subprocess.Popen(
            [sys.executable, __file__, kind],
            env={**environment, **THREADS},
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True,
        )  # fmt: skip
        assert self._server.stdout
        self._has = json.loads(self._server.stdout.readline())

    def close(self) -> None:
        """End the process."""
        self._server.communicate()

    def _asked(
        self, timeout_s: float, meanwhile: Callable[[], object] | None = None, **request: Any
    ) -> int:
        """The exit code of a fork. Raises TimeoutExpired; any exception ends the process."""
        server = self._server
        assert server.stdin
        assert server.stdout
        request["streams"] = [*map(str, self._streams)]
        try:
            server.stdin.write(json.dumps(request).encode() + b"\n")
            server.stdin.flush()
            if meanwhile:
                meanwhile()
            if not select.select([server.stdout], [], [], timeout_s)[0]:
                raise subprocess.TimeoutExpired(self._server.args, timeout_s)
        except BaseException:  # its answer is not taken for that to the next request
            os.killpg(server.pid, signal.SIGKILL)
            self.has_ended = True
            raise
        return int(server.stdout.readline())


class LoadedProgram(Loaded):
    """The program, with its networks."""

    def __init__(self, environment: Mapping[str, str], folder: Path) -> None:
        """folder: where streams are written."""
        super().__init__("program", environment, folder)

    def serves(self, environment: Mapping[str, str]) -> bool:
        """Whether an environment is that of the process, or one with variables that the program
        sets, as it has done in the process of the tests."""
        return self._given.items() <= environment.items() <= {**self._has, **self._given}.items()

    def run(
        self, words: Sequence[str], cwd: Path | None, timeout_s: float
    ) -> subprocess.CompletedProcess[str]:
        """What a command line did, run in a folder."""
        code = self._asked(timeout_s, words=[*words], folder=str(cwd or Path.cwd()))
        told = (path.read_text(encoding="utf-8") for path in self._streams[1:])
        return subprocess.CompletedProcess([*words], code, *told)


class LoadedReaders(Loaded):
    """The libraries that read strangers' files."""

    def __init__(self, folder: Path) -> None:
        """folder: where streams are written."""
        super().__init__("readers", os.environ, folder)
        self._turn = threading.Lock()

    def run(
        self, payload: bytes, wall_s: float, meanwhile: Callable[[], object] | None
    ) -> tuple[int, bytes]:
        """As confined._run: exit code and answer of a reader. Raises TimeoutExpired."""
        with self._turn:
            self._streams[0].write_bytes(payload)
            request = {"folder": str(Path.cwd()), "environment": {**os.environ}}
            code = self._asked(wall_s, meanwhile, **request)
            return code, self._streams[1].read_bytes()


def _load_program() -> Callable[[dict[str, Any]], int]:
    from chord_usd import cli
    from chord_usd.base.runtime.locations import keep_caches
    from chord_usd.base.runtime.offline import stay_offline
    from chord_usd.faces.standby import PARTS, load

    stay_offline()
    keep_caches()
    for part in PARTS:
        load(part)

    def run(request: dict[str, Any]) -> int:
        sys.argv = ["chord-usd", *request["words"]]
        return cli.main()

    return run


def _load_readers() -> Callable[[dict[str, Any]], int]:
    from chord_usd.base.runtime import confined

    for row in confined.DECODERS.values():
        _load(f"chord_usd.{row.reader.partition(':')[0]}")
        for name in " ".join(row.calls.values()).split():
            _load(name)
    # Its parent is this process, which ends with that of the tests.
    confined._die_with = lambda _: None

    def run(request: dict[str, Any]) -> int:
        os.environ.clear()
        os.environ.update({**request["environment"], **THREADS})
        sys.path[:] = pickle.load(sys.stdin.buffer)
        confined.serve()
        return 0

    return run


def _load(name: str) -> None:
    """Import the module that a dotted name is in; what is not installed stays out."""
    while name:
        with suppress(ImportError):
            import_module(name)
            return
        name = name.rpartition(".")[0]


LOADERS = {"program": _load_program, "readers": _load_readers}


def main() -> int:
    """The loaded process; in a fork, the exit code of what it was asked for."""
    del sys.path[0]  # the folder of this file
    run = LOADERS[sys.argv[1]]()
    threads = len([*Path("/proc/self/task").iterdir()])
    assert threads == 1, f"{threads} threads: a fork copies their locks as they happen to be"
    gc.freeze()
    os.write(1, json.dumps({**os.environ}).encode() + b"\n")
    while line := sys.stdin.buffer.readline():
        child = os.fork()
        if child == 0:
            request = json.loads(line)
            os.chdir(request["folder"])
            for number, place in enumerate(request["streams"]):
                flags = os.O_RDWR | os.O_CREAT | os.O_TRUNC
                os.dup2(os.open(place, flags if number else os.O_RDONLY), number)
            gc.unfreeze()
            return run(request)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        os.write(1, f"{code}\n".encode())
    return 0


if __name__ == "__main__":
    sys.exit(main())
