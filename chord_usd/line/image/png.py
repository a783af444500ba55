"""PNG files chunk by chunk: the same pixels with other notes."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Mapping

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_NOTES = (b"tEXt", b"zTXt", b"iTXt", b"tIME", b"eXIf")


def with_notes(png: bytes, notes: Mapping[str, str]) -> bytes:
    """The picture with these notes (Latin-1 text by keyword) instead of those that it has.

    Blender notes date and render time, so that two runs would differ. Raises ValueError for what is
    no PNG, or is cut short.
    """
    chunks = list(_chunks(png))
    texts = [(b"tEXt", f"{key}\0{text}".encode("latin-1")) for key, text in notes.items()]
    kept = [chunk for chunk in chunks if chunk[0] not in _NOTES]
    # The header comes first, notes may follow anywhere.
    return _SIGNATURE + b"".join(_written(*chunk) for chunk in (kept[0], *texts, *kept[1:]))


def _chunks(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    """(kind, data) of each. Raises ValueError."""
    if not png.startswith(_SIGNATURE):
        raise ValueError("no PNG")
    at, kind = len(_SIGNATURE), b""
    while kind != b"IEND":
        if at + 12 > len(png):
            raise ValueError("a PNG that is cut short")
        length, kind = struct.unpack_from(">I4s", png, at)
        yield kind, png[at + 8 : at + 8 + length]
        at += length + 12


def _written(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
