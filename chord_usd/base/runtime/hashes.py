"""SHA-256 of files."""

from __future__ import annotations

import hashlib
from pathlib import Path


def hash_file(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal. Raises OSError."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def same_bytes(first: Path, second: Path) -> bool:
    """Whether two files hold the same. Raises OSError."""
    if first.stat().st_size != second.stat().st_size:
        return False
    return hash_file(first) == hash_file(second)
