"""One batch at a time in a folder."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
from collections.abc import Iterator
from pathlib import Path

from chord_usd.base.errors import OutputError, reason_of

LOCK_FILE = ".batch.lock"


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder for this process; the kernel lets go of it when the process dies.

    Raises OutputError where another process holds it.
    """
    path = folder / LOCK_FILE
    with _opened(path) as handle:
        os.truncate(handle, 0)
        os.write(handle, f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        try:
            yield
        finally:
            # While it is still held: whoever waits for this file will see that it is gone.
            path.unlink(missing_ok=True)


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[int]:
    while True:
        handle = _open(path)
        try:
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise OutputError(
                    f"another batch is at work here ({_holder(path)})",
                    where=str(path.parent),
                    expected="one batch at a time in a folder",
                    try_="wait for it, or another -o",
                ) from None
            if _is_at(handle, path):
                yield handle
                return
        finally:
            os.close(handle)


def _open(path: Path) -> int:
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise OutputError(
            f"cannot be written to ({reason_of(error)})",
            where=str(path.parent),
            expected="a folder for houses",
            try_="another -o",
        ) from error


def _is_at(handle: int, path: Path) -> bool:
    """Whether the file that is held is the one others would try to hold."""
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False


def _holder(path: Path) -> str:
    try:
        return path.read_text().strip() or "it does not say which"
    except OSError:
        return "it does not say which"
