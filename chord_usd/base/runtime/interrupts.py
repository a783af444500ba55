"""Ctrl-C and a farm's kill: every verb ends soon, in order, and with a true word about it."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import NoReturn

from chord_usd.base.runtime import console

INTERRUPTED, TERMINATED = 130, 143
"""Exit codes: 128 and the number of the signal."""

STUBBORN_S = 1.2
"""A library that computes for longer than this without letting Python run is not waited for."""

_DEAF_S = 5.0
"""A signal that no thread of Python took up for so long is one that none can."""

delivered: list[Path] = []
"""Files that this process has written so far, for the message of an interrupt."""

on_hard_end: list[Callable[[], None]] = []
"""What is still to be cleaned up when the process must end in the middle of a library's call."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C.

    CPython 3.11 dies of SIGINT in place of returning our exit code when a KeyboardInterrupt, of
    that very type, once left an `exec` of source text: the way every dataclass is made.
    """

    code = INTERRUPTED
    word = "interrupted"


class Terminated(Interrupted):
    """SIGTERM, as farms and `kill` send it."""

    code = TERMINATED
    word = "terminated"


def message(reason: type[Interrupted], said: str = "") -> str:
    """The line that says what an interrupt left behind."""
    if said:
        left = said
    elif delivered:
        left = f"after {', '.join(map(str, delivered))} was written"
    else:
        left = "nothing was written"
    return f"error: {reason.word}, {left}\n"


def obey() -> None:
    """From now on SIGINT and SIGTERM raise Interrupted and Terminated in the main thread.

    Where a library keeps the main thread for too long, a second thread ends the process in its
    place. A process that starts with Ctrl-C ignored (nohup, a script's background) keeps it so.
    """
    signal.signal(signal.SIGTERM, _raise)
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, _raise)


def watch() -> None:
    """Start the thread that ends a process whose main thread does not answer, and the process that
    ends it where a library lets no thread of Python run.

    For a process of our own; in a host's process (tests, notebooks) obey() is enough.
    """
    ours, kernels = socket.socketpair()
    kernels.setblocking(False)
    signal.set_wakeup_fd(kernels.fileno(), warn_on_full_buffer=False)
    guarded = os.getpid()
    if os.fork() == 0:
        _guard(guarded, ours, kernels)
    threading.Thread(target=_wait_and_end, args=(ours, kernels), daemon=True).start()


def ignore() -> None:
    """Ignores signals from now on: all is done and reported, and the process ends."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


@contextlib.contextmanager
def held() -> Iterator[None]:
    """Put off interrupts for the moment in which an output takes its place, all of it or none."""
    if threading.current_thread() is not threading.main_thread():
        yield  # signals are handled in the main thread only
        return
    put_off: list[int] = []
    before = {}
    with _holding:
        for number in (signal.SIGINT, signal.SIGTERM):
            handler = signal.getsignal(number)
            if callable(handler):
                before[number] = handler
                signal.signal(number, lambda signum, frame: put_off.append(signum))
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
    for signum in put_off[:1]:
        signal.raise_signal(signum)


_holding = threading.Lock()
"""Taken while an output takes its place, so that the watching thread does not end it there."""


_came: list[type[Interrupted]] = []


def came() -> type[Interrupted] | None:
    """The interrupt that came, also where a library has made another exception of it."""
    return _came[0] if _came else None


def _raise(signum: int, frame: FrameType | None) -> NoReturn:
    _came.append(Terminated if signum == signal.SIGTERM else Interrupted)
    raise _came[-1]


def _wait_and_end(ours: socket.socket, kernels: socket.socket) -> None:
    """kernels: held here, since a closed socket wakes nobody."""
    while True:
        ours.recv(1, socket.MSG_PEEK)  # comes back to Python later where a library keeps it
        numbers = ours.recv(64)
        for number in numbers:
            if number not in (signal.SIGINT, signal.SIGTERM):
                continue
            time.sleep(STUBBORN_S)
            with _holding:
                if signal.getsignal(number) is _raise:  # and neither done nor set to ignore it
                    _end_hard(Terminated if number == signal.SIGTERM else Interrupted)


def _guard(guarded: int, ours: socket.socket, kernels: socket.socket) -> NoReturn:
    """In a process of this alone: kill the other where a signal lies unread, which a thread of
    Python would have taken; leave when it ends, since its end of the socket closes then."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    signal.set_wakeup_fd(-1)
    kernels.close()
    kept = ours.fileno()
    os.closerange(0, kept)
    os.closerange(kept + 1, os.sysconf("SC_OPEN_MAX"))
    with contextlib.suppress(OSError):
        while ours.recv(1, socket.MSG_PEEK):
            time.sleep(_DEAF_S)
            with contextlib.suppress(BlockingIOError):
                unread = ours.recv(64, socket.MSG_PEEK | socket.MSG_DONTWAIT)
                if {signal.SIGINT, signal.SIGTERM}.intersection(unread):
                    for pid in (guarded, *_children(guarded)):
                        if pid != os.getpid():
                            os.kill(pid, signal.SIGKILL)
    os._exit(0)


def _end_hard(reason: type[Interrupted]) -> NoReturn:
    for clean_up in list(on_hard_end):
        with contextlib.suppress(Exception):
            clean_up()
    for child in _children(os.getpid()):
        with contextlib.suppress(OSError):
            os.kill(child, signal.SIGKILL)
    with contextlib.suppress(Exception):
        console.stderr().write(message(reason))
        console.stderr().flush()
    os._exit(reason.code)


def _children(pid: int) -> list[int]:
    """Processes that another started, where the system lists them."""
    pids: list[int] = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError, ValueError):
            pids += map(int, task.read_text().split())
    return pids
