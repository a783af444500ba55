"""What libraries say where the machine fails them, in the program's words."""

from __future__ import annotations

import errno
import os

from chord_usd.base.errors import ChordError, DiskFullError
from chord_usd.base.runtime.targets import FREE_SPACE

_FULL = (os.strerror(errno.ENOSPC).lower(), os.strerror(errno.EDQUOT).lower())
_NO_MEMORY = ("not enough memory", "can't allocate memory", "out of memory")
"""What torch's CPU allocator and other back ends say in a plain RuntimeError."""
_LOST_DEVICE = ("cuda error", "cudnn_status_execution_failed")


def machine_error(error: Exception, where: str = "") -> ChordError | None:
    """The error of a full disk, of memory that ended or of a device that went; None for others.

    Libraries raise such errors as types of their own; their words are what they have in common.
    where: what was written.
    """
    said = str(error).lower()
    if any(words in said for words in _FULL):
        return DiskFullError("the disk is full", where=where, try_=FREE_SPACE)
    if is_out_of_memory(error):
        return ChordError(
            "out of memory", try_=("a machine with more memory", "a smaller job", "<device=cpu>")
        )
    if any(words in said for words in _LOST_DEVICE):
        return ChordError(
            "the CUDA device can no longer be used",
            where=where,
            try_=("the same again", "<device=cpu>; a training goes on from its state"),
        )
    return None


def is_out_of_memory(error: BaseException) -> bool:
    """Whether an error of torch or Python says that memory ended."""
    return isinstance(error, MemoryError) or any(sign in str(error).lower() for sign in _NO_MEMORY)
