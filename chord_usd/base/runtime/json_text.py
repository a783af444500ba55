"""JSON from anywhere -> Python values that the rest of the program can rely on.

The standard library's parser lets through what no other program could read back, or what breaks
later: halves of characters, one key twice, nesting without end. NaN and Infinity are let through
here, too, for whoever knows their key to name it.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

from chord_usd.base.errors import ChordError

MOST_NESTED = 100
"""Lists and objects in one another; a scene graph has ten."""

MOST_VALUES = 6_000_000
"""In one text. Python takes up to 120 bytes for each, where the text has two."""

_MOST_DIGITS = 309
"""Of a whole number; longer ones are beyond a double and read as infinite."""

_PLAIN = "plain JSON, without comments"


def parse_json(data: bytes | str, where: str, error: type[ChordError] = ChordError) -> Any:
    """The values in a JSON text; bytes are UTF-8, with a byte order mark or without.

    where: what messages call it. Raises error for what is no JSON, for keys that
    stand twice in an object, texts that are no Unicode, what is nested more than MOST_NESTED
    deep, and more than MOST_VALUES values.
    """
    try:
        text = data if isinstance(data, str) else data.decode("utf-8-sig")
        _refuse_many(text)
        parsed = json.loads(text, object_pairs_hook=_no_doubles, parse_int=_whole)
        _refuse_odd(parsed)
    except UnicodeDecodeError as problem:
        raise error("is not text", where=where, expected="JSON in UTF-8") from problem
    except json.JSONDecodeError as problem:
        spot = f"{problem.msg[:1].lower()}{problem.msg[1:]}, line {problem.lineno}"
        raise error(
            f"is not JSON ({spot}, column {problem.colno})", where=where, expected=_PLAIN
        ) from problem
    except RecursionError as problem:
        raise error("is nested too deeply", where=where, expected=_NESTING) from problem
    except _OddError as problem:
        raise error(problem.what, where=where, expected=problem.expected) from problem
    return parsed


_NESTING = f"at most {MOST_NESTED} levels"


class _OddError(ValueError):
    """JSON by the letter, or nearly, and no use."""

    def __init__(self, what: str, expected: str) -> None:
        self.what, self.expected = what, expected
        super().__init__(what)


def _no_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        seen: set[str] = set()
        double = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise _OddError(f"has the key '{double[:60]}' twice in one object", "each key once")
    return made


def _whole(digits: str) -> float:
    # Python refuses to read thousands of digits; no number has them.
    return int(digits) if len(digits) <= _MOST_DIGITS else math.inf


def _refuse_many(text: str) -> None:
    # Marks inside of texts count too: nobody writes millions of those either.
    if len(text) > MOST_VALUES and sum(map(text.count, ",:[{")) > MOST_VALUES:
        raise _OddError("holds too many values", f"at most {MOST_VALUES:,}")


def _refuse_odd(parsed: object) -> None:
    """Level by level, since a walk that calls itself could be driven too deep."""
    level = [parsed]
    for _ in range(MOST_NESTED + 1):
        inner: list[object] = []
        for value in level:
            if isinstance(value, str):
                _refuse_half_characters(value)
            elif isinstance(value, list):
                inner += value
            elif isinstance(value, dict):
                inner += [*value, *value.values()]
        if not inner:
            return
        level = inner
    raise _OddError("is nested too deeply", _NESTING)


def _refuse_half_characters(text: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError as problem:
        raise _OddError(
            f"holds half a character (a lone surrogate) in a text of {len(text)} characters",
            "Unicode",
        ) from problem


def json_text(data: Mapping[str, Any]) -> str:
    """Indented JSON with points on one line; the same data gives the same text."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)
    # Raw line breaks never occur inside JSON texts, so only lists of numbers can match.
    return re.sub(r"\[\n\s*([-+.\deE,\s]+?)\s*\]", _on_one_line, text) + "\n"


def _on_one_line(match: re.Match[str]) -> str:
    return "[" + ", ".join(part.strip() for part in match[1].split(",")) + "]"
