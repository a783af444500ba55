"""Files made wrong: bytes turned, cut and mixed, and parts changed by somebody who knows the form.

Every function takes bytes and a random.Random and returns bytes; the same state, the same bytes.
"""

from __future__ import annotations

import binascii
import copy
import gzip
import io
import json
import re
import struct
import zipfile
from collections.abc import Callable, Sequence
from random import Random
from typing import Any

Mutator = Callable[[bytes, Random], bytes]

LARGEST_BYTES = 8 * 2**20

NUMBERS = (
    "0", "-0", "-1", "1", "0.5", "1e-300", "1e300", "-1e300", "1e308", "1e999", "-1e999", "nan",
    "inf",
    "-inf", "NaN", "Infinity", "2147483647", "2147483648", "-2147483649", "4294967296",
    "9223372036854775807", "18446744073709551616", "1" * 40, "1" * 400, "0x10", "1e-9", "100000",
    "1000000000", "65535", "256", "3.4e38", "1,5", "1.2.3", "", "--1", "٣",
)  # fmt: skip
TEXTS = (
    "", " ", "\x00", "\n", "a" * 300, "é", "\u202e", "\ufeff", "../../stranger/thesis.txt", "/",
    ".", "..",
    "stranger/thesis.txt", "file:///etc/hostname", "https://example.invalid/x", "%s%n", "${HOME}",
    "\ud800", "null", "None", "wall", "door", "bedroom", "House", "CON", "a\tb", "@", "\\", '"',
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 0.5, 1e308, -1e308, 1e-300, float("nan"), float("inf"), 2**31, 2**63,
    10**40, [], {}, [[]], [0], [None], {"a": 1}, [[0, 0], [0, 0], [0, 0]], *TEXTS[:-8],
)  # fmt: skip

_NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")


def generic(data: bytes, rng: Random) -> bytes:
    """One to four blind changes."""
    for _ in range(rng.choice((1, 1, 2, 4))):
        data = rng.choice((flip, flip, truncate, double, delete, insert, number, splice))(data, rng)
    return data[:LARGEST_BYTES]


def flip(data: bytes, rng: Random) -> bytes:
    """A few bits turned."""
    changed = bytearray(data)
    for _ in range(rng.choice((1, 2, 8, 32)) if changed else 0):
        changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def truncate(data: bytes, rng: Random) -> bytes:
    """The end cut off, or the start."""
    at = rng.randrange(len(data) + 1)
    return data[:at] if rng.random() < 0.8 else data[at:]


def _span(data: bytes, rng: Random) -> tuple[int, int]:
    start = rng.randrange(len(data) + 1)
    return start, min(len(data), start + rng.choice((1, 4, 16, 64, 256, 4096)))


def double(data: bytes, rng: Random) -> bytes:
    """A part several times."""
    start, end = _span(data, rng)
    times = rng.choice((1, 2, 10, 1000))
    times = min(times, LARGEST_BYTES // max(1, end - start))
    return data[:end] + data[start:end] * times + data[end:]


def delete(data: bytes, rng: Random) -> bytes:
    """A part left out."""
    start, end = _span(data, rng)
    return data[:start] + data[end:]


def insert(data: bytes, rng: Random) -> bytes:
    """A part that is noise, zeros or a text."""
    at = rng.randrange(len(data) + 1)
    part = rng.choice((
        rng.randbytes(rng.choice((1, 4, 64))), bytes(rng.choice((1, 64, 100_000))),
        rng.choice(TEXTS).encode("utf-8", "surrogatepass"),
    ))  # fmt: skip
    return data[:at] + part + data[at:]


def splice(data: bytes, rng: Random) -> bytes:
    """Two parts that changed places."""
    if len(data) < 4:
        return data
    a, b, c = sorted(rng.randrange(len(data) + 1) for _ in range(3))
    return data[:a] + data[b:c] + data[a:b] + data[c:]


def number(data: bytes, rng: Random) -> bytes:
    """A number in digits replaced by an extreme one."""
    found = list(_NUMBER.finditer(data[: 2**20]))
    if not found:
        return data
    one = rng.choice(found)
    return data[: one.start()] + rng.choice(NUMBERS).encode() + data[one.end() :]


def lines(data: bytes, rng: Random) -> bytes:
    """A text by its lines: doubled, left out, swapped, with extreme numbers or other words."""
    parts = data.split(b"\n")
    for _ in range(rng.choice((1, 1, 2, 5))):
        at, other = rng.randrange(len(parts)), rng.randrange(len(parts))
        how = rng.randrange(7)
        if how == 0:
            parts[at:at] = parts[at:other][:200] or [parts[other]]
        elif how == 1:
            del parts[at : at + rng.choice((1, 1, 3, 20))]
            parts = parts or [b""]
        elif how == 2:
            parts[at], parts[other] = parts[other], parts[at]
        elif how == 3:
            words = parts[at].split(b" ")
            words[rng.randrange(len(words))] = rng.choice(
                (
                    rng.choice(TEXTS).encode("utf-8", "surrogatepass"),
                    rng.choice(data.split() or [b""]),
                )
            )
            parts[at] = b" ".join(words)
        else:
            parts[at] = number(parts[at], rng)
    return b"\n".join(parts)[:LARGEST_BYTES]


# JSON ---------------------------------------------------------------------------------------------


def json_text(data: bytes, rng: Random) -> bytes:
    """Values, keys and parts of a JSON text changed; now and then its letters."""
    try:
        parsed = json.loads(data)
    except ValueError:
        return generic(data, rng)
    if rng.random() < 0.15:
        return generic(data, rng)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        parsed = _json_change(parsed, rng)
    text = json.dumps(parsed, ensure_ascii=rng.random() < 0.5)
    return text.encode("utf-8", "surrogatepass")[:LARGEST_BYTES]


def _json_change(root: Any, rng: Random) -> Any:
    holders = [one for one in _containers(root) if one]
    if not holders:
        return copy.deepcopy(rng.choice(VALUES))
    holder = rng.choice(holders)
    key = rng.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
    value = holder[key]
    how = rng.randrange(10)
    if how == 0:
        del holder[key]
    elif how == 1 and isinstance(holder, dict):
        holder[rng.choice(TEXTS)] = holder.pop(key)
    elif how == 2 and isinstance(holder, list):
        holder[key:key] = [value] * rng.choice((1, 2, 50, 3000))
    elif how == 3:
        other = rng.choice(holders)
        holder[key] = json.loads(json.dumps(other)) if rng.random() < 0.7 else value
    elif how == 4:
        for _ in range(rng.choice((1, 20, 90, 99, 150))):
            value = [value] if rng.random() < 0.5 else {"a": value}
        holder[key] = value
    elif isinstance(value, int | float) and how < 8:
        factor = rng.choice((-1, 0, 0.001, 10, 1000, 1e6, 1e200, 1e300, float("inf")))
        holder[key] = value * factor
    else:
        holder[key] = copy.deepcopy(rng.choice(VALUES))
    return root


def _containers(root: Any) -> list[Any]:
    found, level = [], [root]
    while level:
        one = level.pop()
        if isinstance(one, dict | list):
            found.append(one)
            level += one.values() if isinstance(one, dict) else one
    return found


def json_lines(data: bytes, rng: Random) -> bytes:
    """JSON lines, gzipped or not: one of them, all of them, or their packing changed."""
    packed = data.startswith(b"\x1f\x8b")
    text = gzip.decompress(data) if packed else data
    how = rng.randrange(8)
    if how == 0:
        return generic(data, rng)
    if how == 1:
        text = lines(text, rng)
    elif how == 2:
        text = (
            rng.choice((b"\n", b" ", b"[", b"{", b"0", b"[],")) * rng.choice((10**5, 10**7)) + text
        )
    else:
        rows = text.splitlines() or [b""]
        at = rng.randrange(len(rows))
        rows[at] = json_text(rows[at], rng)
        text = b"\n".join(rows)
    return gzip.compress(text, mtime=0) if packed != (rng.random() < 0.1) else text


# XML and the other texts --------------------------------------------------------------------------

_ATTRIBUTE = re.compile(rb"""([\w:-]+)=(["'])(.*?)\2""", re.DOTALL)
_ELEMENT = re.compile(rb"<(\w+)\b[^>]*?(?:/>|>.*?</\1>)", re.DOTALL)
_HEADS = (
    b'<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]>',
    b'<!DOCTYPE a SYSTEM "file:///etc/hostname">', b'<?xml version="1.0" encoding="utf-16"?>',
    b'<?xml version="1.0" encoding="rot13"?>', b"\xff\xfe", b"\x00",
)  # fmt: skip


def xml(data: bytes, rng: Random) -> bytes:
    """Attributes and elements changed, doubled, left out; headers of other kinds."""
    for _ in range(rng.choice((1, 1, 2, 4))):
        how = rng.randrange(8)
        if how == 0:
            data = generic(data, rng)
        elif how == 1:
            body = data[data.find(b"?>") + 2 :] if data.startswith(b"<?xml") else data
            data = rng.choice(_HEADS) + body
        elif how in (2, 3):
            data = _element(data, rng)
        else:
            data = _attribute(data, rng)
    return data[:LARGEST_BYTES]


def _attribute(data: bytes, rng: Random) -> bytes:
    found = list(_ATTRIBUTE.finditer(data))
    if not found:
        return generic(data, rng)
    one, other = rng.choice(found), rng.choice(found)
    value = rng.choice((
        number(one[3], rng), number(one[3], rng), other[3], rng.choice(TEXTS).encode("utf-8",
        "replace"),
        one[3] * rng.choice((2, 100, 10_000 // (len(one[3]) + 1) + 1)),
    ))  # fmt: skip
    return data[: one.start(3)] + value + data[one.end(3) :]


def _element(data: bytes, rng: Random) -> bytes:
    found = list(_ELEMENT.finditer(data))
    if not found:
        return generic(data, rng)
    one, other = rng.choice(found), rng.choice(found)
    how = rng.randrange(4)
    if how == 0:
        return data[: one.start()] + data[one.end() :]
    if how == 1:
        times = min(rng.choice((2, 20, 2000)), LARGEST_BYTES // len(one[0]) + 1)
        return data[: one.start()] + one[0] * times + data[one.end() :]
    if how == 2:
        return data[: one.start()] + other[0] + data[one.end() :]
    deep = rng.choice((10, 300, 5000))
    return data[: one.start()] + b"<g>" * deep + one[0] + b"</g>" * deep + data[one.end() :]


# Containers ---------------------------------------------------------------------------------------


def png(data: bytes, rng: Random) -> bytes:
    """Chunks changed, their check sums put right, so that readers see what is in them."""
    if rng.random() < 0.2 or not data.startswith(b"\x89PNG"):
        return generic(data, rng)
    chunks = _chunks(data)
    for _ in range(rng.choice((1, 1, 2))):
        at = rng.randrange(len(chunks))
        kind, body = chunks[at]
        how = rng.randrange(6)
        if kind == b"iTXt" or kind == b"tEXt":
            head, mark, text = body.partition(b"{")
            chunks[at] = kind, head + json_text(mark + text, rng)
        elif kind == b"IHDR":
            fields = bytearray(body)
            fields[rng.randrange(len(fields))] = rng.choice((0, 1, 2, 3, 8, 16, 127, 255))
            chunks[at] = kind, bytes(fields)
        elif how == 0:
            del chunks[at]
        elif how == 1:
            chunks[at:at] = [chunks[at]] * rng.choice((1, 100))
        elif how == 2:
            chunks[at:at] = [(rng.choice((b"tEXt", b"zTXt", b"iTXt", b"eXIf", b"PLTE", b"tRNS",
            b"acTL")),
                              rng.randbytes(rng.choice((0, 3, 50))))]  # fmt: skip
        else:
            chunks[at] = kind, generic(body, rng)
    return data[:8] + b"".join(_chunk(kind, body) for kind, body in chunks)


def _chunks(data: bytes) -> list[tuple[bytes, bytes]]:
    found, at = [], 8
    while at + 8 <= len(data):
        length = struct.unpack_from(">I", data, at)[0]
        found.append((data[at + 4 : at + 8], data[at + 8 : at + 8 + length]))
        at += 12 + length
    return found


def _chunk(kind: bytes, body: bytes) -> bytes:
    return (
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", binascii.crc32(kind + body))
    )


_NAMES = (
    "../stranger/thesis.txt", "/etc/hostname", "a/../../b", "C:\\x", "x\x00y", "a" * 300, "é.usda",
    "link", "a//b", "./a", "HOME.XML", "",
)  # fmt: skip


def zipped(inner: Callable[[str], Mutator]) -> Mutator:
    """A mutator of archives; inner: what changes a file of this name."""

    def change(data: bytes, rng: Random) -> bytes:
        if rng.random() < 0.2:
            return generic(data, rng)
        try:
            with zipfile.ZipFile(io.BytesIO(data)) as archive:
                entries = [(one.filename, archive.read(one), one.compress_type, 0)
                           for one in archive.infolist()]  # fmt: skip
        except (zipfile.BadZipFile, ValueError):
            return generic(data, rng)
        at = rng.randrange(len(entries))
        name, body, packing, mode = entries[at]
        how = rng.randrange(10)
        if how == 0:
            entries[at] = rng.choice(_NAMES), body, packing, mode
        elif how == 1:
            entries.append(entries[at])
        elif how == 2:
            del entries[at]
        elif how == 3:
            entries[at] = name, bytes(rng.choice((0, 10**6, 3 * 10**7))), 8, mode
        elif how == 4:
            entries[at] = name, body, packing, rng.choice((0o120777, 0o010644, 0o040755)) << 16
        elif how == 5:
            entries[at] = name, body, rng.choice((0, 8, 12, 14)), mode
        else:
            entries[at] = name, inner(name)(body, rng), packing, mode
        return _zip(entries)

    return change


def _zip(entries: Sequence[tuple[str, bytes, int, int]]) -> bytes:
    import warnings

    out = io.BytesIO()
    with warnings.catch_warnings(), zipfile.ZipFile(out, "w") as archive:
        warnings.simplefilter("ignore")  # of names that are there twice
        for name, body, packing, mode in entries:
            info = zipfile.ZipInfo(name)
            info.compress_type, info.external_attr = packing, mode
            archive.writestr(info, body)
    return out.getvalue()


def glb(data: bytes, rng: Random) -> bytes:
    """The JSON of a binary glTF changed, its lengths put right."""
    if rng.random() < 0.3 or len(data) < 20:
        return generic(data, rng)
    length = struct.unpack_from("<I", data, 12)[0]
    text, rest = json_text(data[20 : 20 + length], rng), data[20 + length :]
    text += b" " * (-len(text) % 4)
    if rng.random() < 0.3:
        rest = generic(rest, rng)
    whole = data[:4] + struct.pack("<II", 2, 20 + len(text) + len(rest))
    return whole + struct.pack("<I", len(text)) + data[16:20] + text + rest


# USD ----------------------------------------------------------------------------------------------

_ASSET = re.compile(rb"@([^@\n]*)@")
_TARGETS = (
    "../stranger/house.usda", "../../stranger/private.png", "/etc/hostname", "./house.usda", "",
    "a.usdz[x.usda]",
    "house.usda", "http://example.invalid/a.usda", "a" * 5000, "../stranger/pipe", "/dev/zero",
)  # fmt: skip
_PARTS = (
    'def Xform "More"\n{\n    double3 xformOp:translate = (1e308, nan, 0)\n}\n',
    'over "House" (\n    references = </House>\n)\n{\n}\n',
    'def "A" (\n    references = </B>\n)\n{\n}\ndef "B" (\n    references = </A>\n)\n{\n}\n',
    'def Mesh "M"\n{\n    int[] faceVertexCounts = [2147483647, -1]\n'
    "    int[] faceVertexIndices = [99999, -5]\n    point3f[] points = [(nan, inf, 1e38)]\n}\n",
    'def Xform "Deep"\n{\n' * 400 + "}\n" * 400,
    'def Camera "Cam"\n{\n    float focalLength = 0\n    float2 clippingRange = (nan, -1)\n}\n',
    'class "C" (\n    inherits = </C>\n)\n{\n}\n',
    'def Scope "S" (\n    variants = {\n        string v = "x"\n    }\n'
    '    prepend variantSets = "v"\n)\n{\n'
    '    variantSet "v" = {\n        "x" {\n        }\n    }\n}\n',
)  # fmt: skip


def usda(data: bytes, rng: Random) -> bytes:
    """A layer in text: asset paths turned elsewhere, prims added, lines changed."""
    how = rng.randrange(6)
    if how == 0:
        return generic(data, rng)
    found = list(_ASSET.finditer(data))
    if how == 1 and found:
        one = rng.choice(found)
        return data[: one.start(1)] + rng.choice(_TARGETS).encode() + data[one.end(1) :]
    if how == 2:
        return data + b"\n" + rng.choice(_PARTS).encode()
    return lines(data, rng)
