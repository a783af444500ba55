"""Files of JSON lines, gzipped or not, read a line at a time: what they unpack to has limits."""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from chord_usd.base.errors import ChordError, reason_of
from chord_usd.base.runtime.inputs import refuse_odd_file

MOST_LINE_BYTES = 64 * 2**20
"""The largest house of 3D-FRONT, with its meshes, takes less."""

MOST_RATIO = 300
"""Unpacked against packed. Lines of numbers shrink to a tenth, zeros to a thousandth."""

_RATIO_FROM_BYTES = 10 * 2**20
_GZIP = b"\x1f\x8b"


def read_lines(path: Path, error: type[ChordError]) -> Iterator[tuple[int, bytes]]:
    """(number, bytes) of every line that is not empty; numbers count from 1.

    Raises error where the file cannot be read or unpacked, has a line of more than
    MOST_LINE_BYTES, or unpacks to more than MOST_RATIO times its size.
    """
    refuse_odd_file(path, error)
    try:
        with path.open("rb") as packed:
            is_packed = packed.peek(len(_GZIP)).startswith(_GZIP)
            stream: IO[bytes] = gzip.GzipFile(fileobj=packed) if is_packed else packed  # type: ignore[assignment]
            yield from _lines(stream, path, error)
    except (OSError, EOFError, zlib.error) as problem:
        reason = reason_of(problem) if isinstance(problem, OSError) else str(problem)
        raise error(
            f"cannot be read: {reason}", where=str(path), expected="JSON lines, gzipped or not"
        ) from None


def _lines(stream: IO[bytes], path: Path, error: type[ChordError]) -> Iterator[tuple[int, bytes]]:
    most = max(_RATIO_FROM_BYTES, MOST_RATIO * path.stat().st_size)
    number = unpacked = 0
    while line := stream.readline(MOST_LINE_BYTES + 1):
        number += 1
        unpacked += len(line)
        if len(line) > MOST_LINE_BYTES:
            raise error(
                f"has a line of more than {MOST_LINE_BYTES // 2**20} MiB",
                where=f"{path} line {number}",
                expected="one record a line",
            )
        if unpacked > most:
            raise error(
                f"unpacks to more than {MOST_RATIO} times its size",
                where=str(path),
                expected="JSON lines; this looks like a bomb",
            )
        if line.strip():
            yield number, line
