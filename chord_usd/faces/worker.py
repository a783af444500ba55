"""A process that loads the program, waits for one command line, runs it, and ends (resident.py)."""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import select
import signal
import socket
import struct
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from chord_usd import cli
from chord_usd.base.runtime import interrupts, resident
from chord_usd.base.runtime.locations import keep_caches
from chord_usd.base.runtime.offline import stay_offline
from chord_usd.faces.standby import PARTS, load

IDLE_S = 600.0
ANSWER_S = 10.0
MOST_BYTES = 2**24
"""Of a request."""


def main() -> int:
    """Serve one command line; returns the exit code of this process."""
    place = resident.address()
    with place.with_suffix(".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return 0  # another worker waits
        stay_offline()
        keep_caches()
        version, environment = resident.version(), {**os.environ}
        interrupts.obey()
        interrupts.watch()
        try:
            with _listening(place) as door:
                link = _called(door)
        except interrupts.Interrupted:
            return 0
    if link is None:
        return 0
    with link:
        _serve(link, version, environment)
    return 0


@contextlib.contextmanager
def _listening(place: Path) -> Any:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as door:
        place.unlink(missing_ok=True)
        door.bind(str(place))
        door.listen(1)
        try:
            yield door
        finally:
            place.unlink(missing_ok=True)


def _called(door: socket.socket) -> socket.socket | None:
    """The first connection of this user; None after IDLE_S. Parts of the program are loaded one
    after the other until then."""
    left = list(PARTS)
    end = time.monotonic() + IDLE_S
    while time.monotonic() < end:
        wait = 0.0 if left else end - time.monotonic()
        if select.select([door], [], [], max(wait, 0.0))[0]:
            link, _ = door.accept()
            if resident.peer_uid(link) == os.getuid():
                return link
            link.close()
        elif left:
            load(left.pop(0))
    return None


def _serve(link: socket.socket, version: str, environment: Mapping[str, str]) -> None:
    link.settimeout(ANSWER_S)
    try:
        request = _request(link)
        is_current = request is not None and request["version"] == version
        link.sendall(resident.READY if is_current else resident.STALE)
        if request is None or not is_current or link.recv(1) != resident.GO:
            return
        link.settimeout(None)
        _take_place(request, environment)
    except OSError:
        return  # the command line has given up, or its folder is gone
    for number in request["ignored"]:
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_pass_signals, args=(link,), daemon=True).start()
    try:
        code = cli.main(request["words"])
    except SystemExit as done:
        code = done.code if isinstance(done.code, int) else cli.UNUSABLE
    interrupts.ignore()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    with contextlib.suppress(OSError):
        link.sendall(f"{code}\n".encode())


def _request(link: socket.socket) -> Mapping[str, Any] | None:
    """What a command line sends, its streams taken over; None for half a request."""
    head, streams, _, _ = socket.recv_fds(link, 4, 3)
    if len(head) < 4 or len(streams) != 3:
        return None
    (size,) = struct.unpack("<I", head)
    if size > MOST_BYTES:
        return None
    text = b""
    while len(text) < size:
        more = link.recv(min(size - len(text), 2**16))
        if not more:
            return None
        text += more
    request: dict[str, Any] = json.loads(text)
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
        os.close(stream)
    return request


def _take_place(request: Mapping[str, Any], before: Mapping[str, str]) -> None:
    """Work where the command line does. What libraries added to the environment stays."""
    for out in (sys.stdout, sys.stderr):
        out.reconfigure(line_buffering=out is sys.stderr or os.isatty(out.fileno()))  # type: ignore[union-attr]
    for name in before.keys() - request["environment"].keys():
        os.environ.pop(name, None)
    os.environ.update(request["environment"])
    os.umask(request["mask"])
    os.chdir(request["folder"])


def _pass_signals(link: socket.socket) -> None:
    """Signals that the command line received; one that is gone ends the run."""
    while True:
        try:
            numbers = link.recv(16)
        except OSError:
            return
        for number in numbers or (signal.SIGTERM,):
            os.kill(os.getpid(), number)
        if not numbers:
            return


if __name__ == "__main__":
    sys.exit(main())
