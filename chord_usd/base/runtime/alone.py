"""One change of a file at a time: the second process gets an error, and nothing is lost."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from chord_usd.base.errors import OutputError


@contextmanager
def alone_with(path: Path) -> Iterator[None]:
    """Hold a file for as long as it is read, changed and replaced.

    Raises OutputError where another process holds it. A file system without locks holds nothing.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        yield
        return
    with path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise _in_use(path) from error
        except OSError:
            yield
            return
        # Whoever held it until now may have put another file in its place.
        if not os.path.samestat(os.fstat(file.fileno()), path.stat()):
            raise _in_use(path)
        yield


def _in_use(path: Path) -> OutputError:
    return OutputError(
        "is being changed by somebody else", where=str(path), try_="again in a moment"
    )
