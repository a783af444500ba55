"""A limit to the time that a unit may take. Runs in the workers."""

from __future__ import annotations

import faulthandler
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from types import FrameType
from typing import NoReturn

from chord_usd.base.errors import ChordError
from chord_usd.faces.batch.engine import Load
from chord_usd.faces.batch.make import Make
from chord_usd.faces.batch.work_units import Unit

_GRACE_S = 60.0
"""What a library that hears no signal gets more; then the worker ends, with a traceback."""


class _Late(BaseException):
    """Not an Exception, which somebody on the way could take for another error."""


def limited(load: Load, seconds: float) -> Make:
    """What load makes, for as long as a unit takes no more than this. Picklable in part."""
    return partial(_make_in_time, load(), seconds)


def _make_in_time(make: Make, seconds: float, unit: Unit) -> None:
    try:
        with _alarm(seconds):
            make(unit)
    except _Late:
        raise ChordError(
            f"took longer than {seconds / 60:g} minutes", where=unit.name, try_="--timeout MINUTES"
        ) from None


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    stderr = sys.__stderr__ or sys.stderr
    faulthandler.dump_traceback_later(seconds + _GRACE_S, exit=True, file=stderr)
    before = signal.signal(signal.SIGALRM, _ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        faulthandler.cancel_dump_traceback_later()


def _ring(number: int, frame: FrameType | None) -> NoReturn:
    raise _Late
