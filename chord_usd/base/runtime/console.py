"""Standard output and error belong to us: what libraries print to them is dropped.

Python's streams are not enough of a gate: USD, Blender's libraries and child processes write to the
file descriptors themselves.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from typing import TextIO

_err: TextIO | None = None
"""Our way to standard error while libraries have none."""
_out: TextIO | None = None


def stderr() -> TextIO:
    """The stream for messages to a user; inside reserved() and outside."""
    return _err or sys.stderr


def stdout() -> TextIO:
    """Our way to standard output, for a verb that talks to a program through it while it runs."""
    return _out or sys.stdout


@contextmanager
def reserved(*, debug: bool = False) -> Iterator[None]:
    """While the block runs, only stderr() reaches the user.

    With debug what libraries print, on either stream, goes to standard error.
    """
    global _err, _out
    before, out, err = (_err, _out), sys.stdout, sys.stderr
    with ExitStack() as stack:
        if debug:
            _out = _redirect(stack, out, err) or out
            sys.stdout = err
        else:
            _err = _redirect(stack, err, _nowhere()) or err
            _out = _redirect(stack, out, _nowhere()) or out
            sys.stdout = sys.stderr = _nowhere()
        try:
            yield
        finally:
            sys.stdout, sys.stderr = out, err
            _err, _out = before


def _redirect(stack: ExitStack, stream: TextIO, target: TextIO) -> TextIO | None:
    """Let the descriptor of stream lead to target until stack ends; returns the stream as it was.

    None, and nothing done, where either is none of the operating system's, as under a test.
    """
    number, goal = _descriptor(stream), _descriptor(target)
    if number not in (1, 2) or goal is None:
        return None
    stream.flush()
    copy = stack.enter_context(
        os.fdopen(os.dup(number), "w", 1, stream.encoding, "backslashreplace")
    )
    stack.callback(os.dup2, copy.fileno(), number)
    # Else what C code has printed and not yet written would come out later.
    stack.callback(_flush_c)
    os.dup2(goal, number)
    return copy


def _descriptor(stream: TextIO) -> int | None:
    try:
        return stream.fileno()
    except (OSError, ValueError, AttributeError):
        return None


def _flush_c() -> None:
    import ctypes

    with suppress(OSError, TypeError):
        ctypes.CDLL(None).fflush(None)


@cache
def _nowhere() -> TextIO:
    """Never closed: loggers that libraries set up keep it until the process ends."""
    return open(os.devnull, "w")  # noqa: PTH123
