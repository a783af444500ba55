"""Where libraries keep what they find out about fonts."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from chord_usd.base.runtime.locations import cache_folder


@contextmanager
def fonts_kept() -> Iterator[None]:
    """While ezdxf is imported: its list of fonts goes to our cache, not into the user's home."""
    before = os.environ.get("XDG_CACHE_HOME")
    os.environ["XDG_CACHE_HOME"] = str(cache_folder())
    try:
        yield
    finally:
        del os.environ["XDG_CACHE_HOME"]
        if before is not None:
            os.environ["XDG_CACHE_HOME"] = before
