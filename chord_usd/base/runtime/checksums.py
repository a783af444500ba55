"""SHA256SUMS: the hashes of a checkpoint's files, written beside them and checked as they are read.

A flipped bit in the weights changes a house a little and says nothing. `sha256sum -c SHA256SUMS` in
the folder checks the same by hand. Folders without the file are taken as they are.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path

from chord_usd.base.errors import CheckpointError, reason_of
from chord_usd.base.runtime.files import hash_file, write_atomic

SUMS_FILE = "SHA256SUMS"
SUMMED_FILES = ("config.json", "network.onnx", "tokenizer.json", "weights.safetensors")
"""What runs; a card or a picture may be edited."""

_LINE = re.compile(r"([0-9a-f]{64}) [ *](\S+)")


@contextmanager
def checkpoint_files(folder: Path) -> Iterator[None]:
    """Around whatever writes a checkpoint's files; their hashes are written when the block ends.

    Until then, and after a crash, there are none: a folder half written is not called damaged.
    """
    (folder / SUMS_FILE).unlink(missing_ok=True)
    yield
    files = [folder / name for name in SUMMED_FILES if (folder / name).is_file()]
    write_atomic(folder / SUMS_FILE, "".join(f"{hash_file(f)}  {f.name}\n" for f in files))


def check_file(path: Path) -> None:
    """Raises CheckpointError where a file is not the one that the hashes beside it are of."""
    sums = path.parent / SUMS_FILE
    if not sums.is_file():
        return
    expected = _read_sums(sums).get(path.name)
    if expected is not None and checkpoint_hash(path) != expected:
        raise CheckpointError(
            "the file is damaged or was changed",
            where=str(path),
            expected=f"the SHA-256 that {SUMS_FILE} beside it gives, {expected[:16]}…",
            try_=f"copy the checkpoint again, or remove {SUMS_FILE} if you changed it yourself",
        )


def checkpoint_hash(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal; a file that has not changed is read once."""
    try:
        there = path.stat()
        return _hash_of(path, there.st_size, there.st_mtime_ns)
    except OSError as error:
        raise CheckpointError(f"cannot be read ({reason_of(error)})", where=str(path)) from error


@lru_cache(maxsize=64)
def _hash_of(path: Path, size: int, changed_ns: int) -> str:
    return hash_file(path)


def _read_sums(path: Path) -> dict[str, str]:
    try:
        lines = path.read_text(encoding="ascii").splitlines()
    except (OSError, UnicodeDecodeError):
        lines = [""]
    matches = [_LINE.fullmatch(line) for line in lines]
    if not all(matches):
        raise CheckpointError(
            "the hashes are damaged",
            where=str(path),
            expected="lines such as sha256sum writes",
            try_="copy the checkpoint again",
        )
    return {match[2]: match[1] for match in matches if match}
