"""XML from strangers: no entities, no outside references, no bombs.

Expat opens no file and no address that a document names.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, cast
from xml.etree import ElementTree

from chord_usd.base.errors import PlanError

_Events = Iterator[tuple[str, ElementTree.Element]]

LARGEST_BYTES = 64 * 2**20
_DEEPEST = 200
_MOST_ELEMENTS = 400_000
_ENCODING = re.compile(rb"""\s*<\?xml[^>]*?\bencoding\s*=\s*["']([^"']*)["']""")
_ASCII_AT_HEART = re.compile(
    r"utf-?8|us-ascii|ascii|latin-?1|iso-8859-\d+|windows-125\d|cp125\d", re.I
)
"""Encodings in which a declaration of an entity looks as it does in ASCII."""


def parse_xml(data: bytes, where: str, expected: str) -> ElementTree.Element:
    """The root element. Raises PlanError for what is no XML, too large, or declares entities."""
    if len(data) > LARGEST_BYTES:
        raise PlanError(
            f"is larger than {LARGEST_BYTES // 2**20} MiB", where=where, expected=expected
        )
    _refuse_encoding(data, where, expected)
    # Without this, a wide encoding could hide a declaration from the search below.
    if b"\x00" in data[:4096] or b"\x00" in data:
        raise PlanError("is not text in UTF-8", where=where, expected=expected)
    if b"<!ENTITY" in data:
        raise PlanError(
            "declares XML entities, which are not read", where=where, expected=expected,
            try_="save it again as plain SVG",
        )  # fmt: skip
    parser: ElementTree.XMLPullParser[Any] = ElementTree.XMLPullParser(("start", "end"))
    depth = count = 0
    root: ElementTree.Element | None = None
    try:
        for start in range(0, max(len(data), 1), 2**16):
            parser.feed(data[start : start + 2**16])
            for event, element in cast(_Events, parser.read_events()):
                root = element if root is None else root
                depth += 1 if event == "start" else -1
                count += event == "start"
                if depth > _DEEPEST or count > _MOST_ELEMENTS:
                    raise PlanError("is nested too deeply or too large", where=where)
        parser.close()
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise PlanError(f"is damaged ({error})", where=where, expected=expected) from error
    if root is None:
        raise PlanError("is empty", where=where, expected=expected)
    return root


def _refuse_encoding(data: bytes, where: str, expected: str) -> None:
    declared = _ENCODING.match(data.removeprefix(b"\xef\xbb\xbf")[:1000])
    name = declared[1].decode("ascii", "replace") if declared else "utf-8"
    if not _ASCII_AT_HEART.fullmatch(name):
        raise PlanError(
            f"is written in the encoding {name[:40]!r}", where=where, expected=expected,
            try_="save it again in UTF-8",
        )  # fmt: skip


def local_name(element: ElementTree.Element) -> str:
    """The tag without its namespace."""
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""
